/* Mean light under broken cloud: limits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "shared/shade.h"

static const velum_slot_fields cloud = {.coverage = 0.4f, .base_m = 1000.0f, .top_m = 1800.0f, .extinction_1_m = 0.05f};

static void flux_falls_from_all_to_none(void **state) {
    (void)state;
    const float suns[] = {0.03f, 0.2f, 0.6f, 1.0f};
    for (int i = 0; i < 4; i++) {
        assert_float_equal((double)velum_flux_through(0.0f, suns[i]), 1.0, 1e-6);
        float last = 1.0f;
        for (float depth = 0.1f; depth < 1e4f; depth *= 1.3f) {
            const float through = velum_flux_through(depth, suns[i]);
            assert_true(through > 0.0f && through < last);
            last = through;
        }
        assert_true(last < 0.002f);
    }
    /* What turns goes on falling as 1 / depth: two streams. */
    assert_float_equal((double)(velum_flux_through(2000.0f, 0.6f) / velum_flux_through(1000.0f, 0.6f)), 0.5, 0.01);
}

static void free_lines_are_what_coverage_leaves(void **state) {
    (void)state;
    assert_float_equal((double)velum_free_lines(0.3f, 1.0f, 0.0f, 800.0f), 0.7, 1e-6);
    assert_true(velum_free_lines(0.0f, 1.0f, 1e6f, 800.0f) == 1.0f);
    assert_true(velum_free_lines(1.0f, 1.0f, 0.0f, 800.0f) < 1e-5f);
    /* As independent stretches: their shares multiply. */
    const float both = velum_free_lines(0.3f, 1.0f, 900.0f, 800.0f);
    assert_float_equal(
        (double)both,
        (double)(velum_free_lines(0.3f, 1.0f, 0.0f, 800.0f) * velum_free_lines(0.3f, 0.0f, 900.0f, 800.0f)), 1e-6);
}

static void layers_shade_what_is_under_them(void **state) {
    (void)state;
    const velum_layer_light over = velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 1800.0f, 0.6f, 0.0f, 800.0f);
    assert_float_equal((double)over.open, 1.0, 1e-6);
    assert_float_equal((double)over.through, 0.0, 1e-6);
    const velum_layer_light under = velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, 1.0f, 0.0f, 800.0f);
    assert_float_equal((double)under.open, 0.6, 0.001);
    float last = 1.0f;
    for (float mu = 1.0f; mu > 0.005f; mu *= 0.8f) {
        const velum_layer_light light = velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, mu, 0.0f, 800.0f);
        assert_true(light.open >= 0.0f && light.open <= last && light.through >= 0.0f);
        assert_true(light.aside >= 0.0f && light.sides >= 0.0f);
        assert_true(light.open + light.through + light.aside + light.sides <= 1.0f + 1e-6f);
        last = light.open;
    }
    assert_true(last < 1e-4f);
    /* Nothing comes down beside clouds where there is no gap, nor from a sun that has set. */
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, 0.6f, 0.0f, 800.0f).aside > 0.05f);
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, -0.1f, 0.0f, 800.0f).aside == 0.0f);
    velum_slot_fields deck = cloud;
    deck.coverage = 1.0f;
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, deck, 200.0f, 0.6f, 0.0f, 800.0f).aside < 1e-4f);
    /* A low sun's light comes down from the sides of clouds that have any, a high sun's otherwise. */
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, 0.05f, 0.0f, 800.0f).sides > 0.05f);
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, 0.31f, 0.0f, 800.0f).sides == 0.0f);
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 200.0f, -0.1f, 0.0f, 800.0f).sides == 0.0f);
    assert_true(velum_layer_light_at(VELUM_SLOT_CUMULUS, deck, 200.0f, 0.05f, 0.0f, 800.0f).sides == 0.0f);
    /* Thin cloud takes nothing, and where the way is known nothing is taken twice. */
    velum_slot_fields veil = cloud;
    veil.extinction_1_m = 1e-7f;
    const velum_layer_light veiled = velum_layer_light_at(VELUM_SLOT_CUMULUS, veil, 200.0f, 0.6f, 0.0f, 800.0f);
    assert_float_equal((double)(veiled.open + veiled.through), 1.0, 1e-3);
    assert_float_equal((double)velum_layer_light_at(VELUM_SLOT_CUMULUS, cloud, 1200.0f, 0.6f, 5000.0f, 800.0f).open,
                       1.0, 1e-6);
}

static void uneven_cloud_leaks(void **state) {
    (void)state;
    static const struct {
        int slot;
        float sheet, uneven; /* kinds */
    } kinds[] = {{VELUM_SLOT_LOW, VELUM_KIND_ST, VELUM_KIND_SC},
                 {VELUM_SLOT_MIDDLE, VELUM_KIND_NS, VELUM_KIND_AC},
                 {VELUM_SLOT_HIGH, VELUM_KIND_CS, VELUM_KIND_CC}};
    velum_slot_fields deck = cloud;
    deck.coverage = 1.0f;
    const float depth = deck.extinction_1_m * (deck.top_m - deck.base_m);
    for (int i = 0; i < 3; i++) {
        deck.kind = kinds[i].sheet;
        const velum_layer_light sheet = velum_layer_light_at(kinds[i].slot, deck, 200.0f, 0.6f, 0.0f, 800.0f);
        assert_float_equal((double)(sheet.open + sheet.through), (double)velum_flux_through(depth, 0.6f), 1e-5);
        deck.kind = kinds[i].uneven;
        const velum_layer_light uneven = velum_layer_light_at(kinds[i].slot, deck, 200.0f, 0.6f, 0.0f, 800.0f);
        assert_true(uneven.through > 1.05f * sheet.through && uneven.open == sheet.open);
    }
}

static void levels_are_finer_below(void **state) {
    (void)state;
    assert_float_equal((double)velum_shade_level_of(-50.0f), 0.0, 0.0);
    assert_float_equal((double)velum_shade_level_of(VELUM_SHADE_TOP_M), VELUM_SHADE_LEVELS - 1.0, 1e-5);
    assert_float_equal((double)velum_shade_level_of(1e6f), VELUM_SHADE_LEVELS - 1.0, 1e-5);
    assert_true(velum_shade_level_of(200.0f) - velum_shade_level_of(100.0f) >
                velum_shade_level_of(10100.0f) - velum_shade_level_of(10000.0f));
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(flux_falls_from_all_to_none),
                                       cmocka_unit_test(free_lines_are_what_coverage_leaves),
                                       cmocka_unit_test(layers_shade_what_is_under_them),
                                       cmocka_unit_test(uneven_cloud_leaks), cmocka_unit_test(levels_are_finer_below)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
