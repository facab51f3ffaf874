/* Mean light under clouds: limits and conservation. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "plugin/shades.h"

enum { BEAM, TURNED, REFLECTED, SKY };
typedef float table[VELUM_SHADE_LEVELS][4];

static const float suns[] = {-0.02f, 0.0f, 0.03f, 0.05f, 0.2f, 0.6f, 1.0f};
#define SUNS (sizeof suns / sizeof suns[0])

static core_column column_of(float coverage) {
    core_column column = {0};
    column.mask = coverage > 0.0f ? 1u << VELUM_SLOT_LOW : 0u;
    column.slot[VELUM_SLOT_LOW] =
        (velum_slot_fields){.coverage = coverage, .base_m = 1000.0f, .top_m = 2400.0f, .extinction_1_m = 0.05f};
    return column;
}

static void make(float coverage, float mu_sun, float albedo, table out) {
    core_column column = column_of(coverage);
    memset(out, 0, sizeof(table));
    shades_add(&column, mu_sun, albedo, 1.0f, out);
}

static void without_cloud_all_light_comes(void **state) {
    (void)state;
    for (size_t s = 0; s < SUNS; s++) {
        table got;
        make(0.0f, suns[s], 0.3f, got);
        for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
            assert_true(got[k][BEAM] == 1.0f && got[k][TURNED] == 0.0f && got[k][REFLECTED] == 0.0f);
            assert_true(got[k][SKY] == 1.0f);
        }
    }
}

static void over_black_ground_nothing_is_gained(void **state) {
    (void)state;
    for (int i = 1; i <= 20; i++) {
        const float coverage = (float)i / 20.0f;
        for (size_t s = 0; s < SUNS; s++) {
            table got;
            make(coverage, suns[s], 0.0f, got);
            for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
                for (int n = 0; n < 4; n++) {
                    assert_true(isfinite(got[k][n]) && got[k][n] >= 0.0f);
                }
                /* Among clouds those below add what they send back. */
                if (velum_shade_height_m(k) <= 1000.0f) {
                    assert_true(got[k][BEAM] + got[k][TURNED] <= 1.0f + 1e-5f && got[k][SKY] <= 1.0f + 1e-5f);
                }
            }
            assert_true(got[VELUM_SHADE_LEVELS - 1][BEAM] == 1.0f);
            assert_float_equal((double)got[VELUM_SHADE_LEVELS - 1][SKY], 1.0, 1e-6);
        }
    }
}

/* Cloud absorbs nothing: over black ground what one layer does not send back has come through it. */
static void what_is_not_sent_back_comes_through(void **state) {
    (void)state;
    for (int i = 1; i <= 20; i++) {
        for (size_t s = 0; s < SUNS; s++) {
            table got;
            make((float)i / 20.0f, suns[s], 0.0f, got);
            const float *under = got[0], *over = got[VELUM_SHADE_LEVELS - 1];
            assert_float_equal((double)(over[REFLECTED] + under[BEAM] + under[TURNED]), 1.0, 1e-5);
        }
    }
}

static void more_cloud_leaves_less(void **state) {
    (void)state;
    for (size_t s = 0; s < SUNS; s++) {
        table last;
        make(0.0f, suns[s], 0.1f, last);
        for (int i = 1; i <= 20; i++) {
            const float coverage = (float)i / 20.0f;
            table got;
            make(coverage, suns[s], 0.1f, got);
            assert_true(got[0][BEAM] <= last[0][BEAM] && got[0][SKY] <= last[0][SKY]);
            memcpy(last, got, sizeof last);
        }
    }
}

/* The sky's light comes from high up, more of it than from beside a low sun: of it a broken field still lets much
 * through. */
static void a_low_sun_does_not_shut_out_the_sky(void **state) {
    (void)state;
    table noon, dusk;
    make(0.4f, 0.85f, 0.1f, noon);
    make(0.4f, 0.05f, 0.1f, dusk);
    assert_true(dusk[0][SKY] > 0.5f * noon[0][SKY]);
    assert_true(dusk[0][BEAM] + dusk[0][TURNED] < 0.5f * (noon[0][BEAM] + noon[0][TURNED]));
}

static void columns_add_by_their_weight(void **state) {
    (void)state;
    core_column few = column_of(0.2f), many = column_of(0.7f);
    table both = {{0}}, a, b;
    make(0.2f, 0.4f, 0.1f, a);
    make(0.7f, 0.4f, 0.1f, b);
    shades_add(&few, 0.4f, 0.1f, 0.25f, both);
    shades_add(&many, 0.4f, 0.1f, 0.75f, both);
    for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
        for (int i = 0; i < 4; i++) {
            assert_float_equal((double)both[k][i], (double)(0.25f * a[k][i] + 0.75f * b[k][i]), 1e-6);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(without_cloud_all_light_comes),       cmocka_unit_test(over_black_ground_nothing_is_gained),
        cmocka_unit_test(what_is_not_sent_back_comes_through), cmocka_unit_test(more_cloud_leaves_less),
        cmocka_unit_test(a_low_sun_does_not_shut_out_the_sky), cmocka_unit_test(columns_add_by_their_weight),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
