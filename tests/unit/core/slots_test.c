#include "synthetic.h"

#include "core/slots.h"

#include <math.h>

static void extinction_follows_from_water(void **unused) {
    (void)unused;
    /* 0.3 g/m3 of drops of 10 um: 3 x 3e-4 / (2 x 1000 x 1e-5) = 0.045 1/m, in the 0.04..0.12 of Hess et al. 1998. */
    assert_float_equal(core_extinction_1_m(0.3f, 10.0f, VELUM_WATER_LIQUID), 0.045f, 1e-7f);
    assert_float_equal(core_extinction_1_m(0.02f, 40.0f, VELUM_WATER_ICE), 3.0f * 2e-5f / (2.0f * 917.0f * 4e-5f),
                       1e-8f);
    velum_layer layer = layer_of(VELUM_GENUS_SC, 1.0f, 0.0f, 100.0f);
    assert_float_equal(core_layer_extinction_1_m(&layer), 0.045f, 1e-7f);
    layer.flags = VELUM_LAYER_EXTINCTION;
    layer.extinction_1_m = 0.01f;
    assert_float_equal(core_layer_extinction_1_m(&layer), 0.01f, 0.0f);
}

static void genera_and_kinds_are_inverse(void **unused) {
    (void)unused;
    for (int32_t genus = VELUM_GENUS_CI; genus <= VELUM_GENUS_CB; genus++) {
        uint32_t slot;
        float kind;
        assert_true(core_slot_of_genus(genus, &slot, &kind));
        assert_int_equal(core_genus_of_slot(slot, kind), genus);
    }
    uint32_t slot;
    float kind;
    assert_false(core_slot_of_genus(0, &slot, &kind));
    assert_false(core_slot_of_genus(11, &slot, &kind));
    assert_false(core_slot_of_genus(INT32_MIN, &slot, &kind));
    assert_int_equal(core_genus_of_slot(VELUM_SLOT_UNIFORM, 0.0f), 0);
}

static void low_layers_stand_from_below(void **unused) {
    (void)unused;
    const velum_layer layers[] = {
        layer_of(VELUM_GENUS_SC, 0.5f, 2000.0f, 2300.0f), layer_of(VELUM_GENUS_CI, 0.3f, 9000.0f, 9500.0f),
        layer_of(VELUM_GENUS_ST, 0.9f, 200.0f, 400.0f), layer_of(VELUM_GENUS_CB, 0.1f, 800.0f, 12000.0f),
        layer_of(VELUM_GENUS_CU, 0.2f, 700.0f, 1500.0f)};
    core_slot_layers out;
    core_slots_assign(layers, 5, &out);
    assert_int_equal(out.merged, 0);
    assert_int_equal(out.mask, 1u << VELUM_SLOT_LOW | 1u << VELUM_SLOT_LOW_2 | 1u << VELUM_SLOT_HIGH |
                                   1u << VELUM_SLOT_STORM | 1u << VELUM_SLOT_CUMULUS);
    assert_float_equal(out.slot[VELUM_SLOT_LOW].base_m, 200.0f, 0.0f);
    assert_float_equal(out.slot[VELUM_SLOT_LOW].kind, VELUM_KIND_ST, 0.0f);
    assert_float_equal(out.slot[VELUM_SLOT_LOW_2].base_m, 2000.0f, 0.0f);
    assert_float_equal(out.slot[VELUM_SLOT_LOW_2].kind, VELUM_KIND_SC, 0.0f);
}

static void layers_beyond_the_slots_are_joined_and_counted(void **unused) {
    (void)unused;
    velum_layer layers[16];
    float clear = 1.0f;
    float path = 0.0f;
    for (uint32_t i = 0; i < 16; i++) {
        layers[i] = layer_of(VELUM_GENUS_AC, 0.05f + 0.02f * (float)i, 3000.0f + 100.0f * (float)i,
                             3200.0f + 110.0f * (float)i);
        clear *= 1.0f - layers[i].coverage;
        path += layers[i].coverage * 0.045f * (layers[i].top_m - layers[i].base_m);
    }
    core_slot_layers out;
    core_slots_assign(layers, 16, &out);
    const core_slot_layer *one = &out.slot[VELUM_SLOT_MIDDLE];
    assert_int_equal(out.mask, 1u << VELUM_SLOT_MIDDLE);
    assert_int_equal(out.merged, 15);
    assert_float_equal(one->coverage, 1.0f - clear, 1e-5f);
    assert_float_equal(one->base_m, 3000.0f, 0.0f);
    assert_float_equal(one->top_m, 3200.0f + 110.0f * 15.0f, 1e-3f);
    assert_float_equal(one->coverage * one->extinction_1_m * (one->top_m - one->base_m), path, path * 1e-4f);
}

static void uniform_layers_are_whole_and_their_own(void **unused) {
    (void)unused;
    velum_layer layers[3] = {layer_of(VELUM_GENUS_SC, 0.0f, 1000.0f, 2000.0f),
                             layer_of(VELUM_GENUS_SC, 0.3f, 3000.0f, 4000.0f),
                             layer_of(VELUM_GENUS_SC, 0.0f, 500.0f, 700.0f)};
    layers[0].flags = VELUM_LAYER_UNIFORM | VELUM_LAYER_PHASE_HG | VELUM_LAYER_ALBEDO;
    layers[0].hg_asymmetry = 0.85f;
    layers[0].albedo = 0.9f;
    layers[1].flags = VELUM_LAYER_UNIFORM;
    core_slot_layers out;
    core_slots_assign(layers, 3, &out); /* the third has no coverage */
    assert_int_equal(out.mask, 1u << VELUM_SLOT_UNIFORM | 1u << VELUM_SLOT_UNIFORM_2);
    assert_float_equal(out.slot[VELUM_SLOT_UNIFORM].coverage, 1.0f, 0.0f);
    assert_float_equal(out.slot[VELUM_SLOT_UNIFORM].hg_asymmetry, 0.85f, 0.0f);
    assert_float_equal(out.slot[VELUM_SLOT_UNIFORM].albedo, 0.9f, 0.0f);
    assert_float_equal(out.slot[VELUM_SLOT_UNIFORM_2].albedo, 1.0f, 0.0f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(extinction_follows_from_water),
        cmocka_unit_test(genera_and_kinds_are_inverse),
        cmocka_unit_test(low_layers_stand_from_below),
        cmocka_unit_test(layers_beyond_the_slots_are_joined_and_counted),
        cmocka_unit_test(uniform_layers_are_whole_and_their_own),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
