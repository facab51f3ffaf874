/* What is asked for is what is there, over 50 km squares of constant input. A part of what velum-coverage
 * (tests/accuracy) goes through. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "columns.h"

/* The equator, middle latitudes, a pole, the antimeridian. */
static const double places[4][2] = {{0.3, 10.2}, {45.0, 8.0}, {90.0, 0.0}, {20.0, 180.0}};
static const int oktas[5] = {1, 3, 5, 7, 8};

static int find_noise(void **state) {
    *state = (void *)(uintptr_t)core_noise_built();
    return 0;
}

static void squares_hold_what_was_asked_for(void **state) {
    for (int k = 0; k < COLUMN_CASES; k++) {
        const column_case *of = &column_cases[k];
        const bool storm = of->slot == VELUM_SLOT_STORM;
        for (int o = 0; o < 5; o++) {
            const float coverage = (float)oktas[o] / 8.0f;
            const double *place = places[(k + o) % 4];
            column_stats s;
            /* A square of 50 km holds but a few storms. */
            const double side_m = storm ? 150000.0 : 50000.0;
            assert_true(columns_measure(*state, of, coverage, place[0], place[1], side_m, 110, 32, &s));
            /* The towers of a storm are large against the square: see velum-coverage. */
            const double water_bound = storm || oktas[o] == 1 ? 0.10 : 0.05;
            const bool good = fabs(s.coverage - (double)coverage) < 0.02 && fabs(s.water - 1.0) < water_bound &&
                              fabs(s.base_error_m) < 10.0 && fabs(s.top_error_m) < 10.0;
            if (!good) {
                print_message("%s, %d oktas at %g, %g: coverage %.4f, water %.3f, base %+.1f m, top %+.1f m\n",
                              of->name, oktas[o], place[0], place[1], s.coverage, s.water, s.base_error_m,
                              s.top_error_m);
            }
            assert_true(good);
        }
    }
}

/* Water at low cover is in few clouds: a square has its own share of tall ones. Over the whole noise it is exact. */
static void noise_as_a_whole_holds_what_was_asked_for(void **state) {
    for (int k = 0; k < COLUMN_CASES; k++) {
        for (int o = 0; o < 5; o++) {
            const float coverage = (float)oktas[o] / 8.0f;
            column_stats s;
            /* Columns that lean are taken at random places: one in eight is cloud, and as deep as it may be. */
            const column_case *of = &column_cases[k];
            const velum_slot_fields fields = {.base_m = of->base_m, .top_m = of->top_m, .kind = of->kind};
            const int columns = velum_lean_slope(of->slot, fields) > 0.0f ? 16000 : 4000;
            assert_true(columns_measure_anywhere(*state, of, coverage, columns, 48, &s));
            const bool good = fabs(s.coverage - (double)coverage) < 0.012 && fabs(s.water - 1.0) < 0.03 &&
                              fabs(s.base_error_m) < 10.0 && fabs(s.top_error_m) < 10.0;
            if (!good) {
                print_message("%s, %d oktas: coverage %.4f, water %.3f, base %+.1f m, top %+.1f m\n", of->name,
                              oktas[o], s.coverage, s.water, s.base_error_m, s.top_error_m);
            }
            assert_true(good);
        }
    }
}

/* Wind carries anvils over what was clear; of low storms as of usual and of high ones. */
static void storms_in_wind_hold_what_was_asked_for(void **state) {
    static const struct {
        float top_m, wind_m_s;
    } cases[] = {{11500.0f, 10.0f}, {11500.0f, 20.0f}, {15000.0f, 10.0f}, {6200.0f, 20.0f}, {15000.0f, 30.0f}};
    column_case storm = column_cases[3];
    assert_int_equal(storm.slot, VELUM_SLOT_STORM);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        storm.top_m = cases[k].top_m;
        storm.wind_m_s = cases[k].wind_m_s;
        for (int o = 0; o < 5; o++) {
            const float coverage = (float)oktas[o] / 8.0f;
            column_stats s;
            assert_true(columns_measure_anywhere(*state, &storm, coverage, 4000, 48, &s));
            const bool good = fabs(s.coverage - (double)coverage) < 0.02 && fabs(s.water - 1.0) < 0.05;
            if (!good) {
                print_message("up to %g m, %g m/s, %d oktas: coverage %.4f, water %.3f\n", (double)storm.top_m,
                              (double)storm.wind_m_s, oktas[o], s.coverage, s.water);
            }
            assert_true(good);
        }
    }
}

/* From the smallest heaps to towers. */
static void cumulus_of_any_depth_hold_what_was_asked_for(void **state) {
    static const float depths_m[] = {350.0f, 700.0f, 2800.0f, 4000.0f, 6500.0f, 10000.0f};
    column_case cumulus = column_cases[2];
    bool ok = true;
    assert_int_equal(cumulus.slot, VELUM_SLOT_CUMULUS);
    const float depth = cumulus.extinction_1_m * (cumulus.top_m - cumulus.base_m);
    for (size_t k = 0; k < sizeof depths_m / sizeof depths_m[0]; k++) {
        cumulus.top_m = cumulus.base_m + depths_m[k];
        cumulus.extinction_1_m = depth / depths_m[k];
        for (int o = 0; o < 5; o++) {
            const float coverage = (float)oktas[o] / 8.0f;
            column_stats s;
            assert_true(columns_measure_anywhere(*state, &cumulus, coverage, 12000, 48, &s));
            const bool good = fabs(s.coverage - (double)coverage) < 0.02 && fabs(s.water - 1.0) < 0.05;
            if (!good) {
                print_message("%g m deep, %d oktas: coverage %.4f, water %.3f\n", (double)depths_m[k], oktas[o],
                              s.coverage, s.water);
            }
            ok = ok && good;
        }
    }
    assert_true(ok);
}

/* Layers other than the usual ones: half and twice as thick, a fifth of and five times the water. */
static void other_layers_hold_what_was_asked_for(void **state) {
    static const float factors[4][2] = {{0.5f, 1.0f}, {2.0f, 1.0f}, {1.0f, 0.2f}, {1.0f, 5.0f}};
    for (int k = 0; k < COLUMN_CASES; k++) {
        for (int f = 0; f < 4; f++) {
            column_case of = column_cases[k];
            of.top_m = of.base_m + factors[f][0] * (of.top_m - of.base_m);
            of.extinction_1_m *= factors[f][1];
            column_stats s;
            assert_true(columns_measure_anywhere(*state, &of, 0.625f, 3000, 48, &s));
            const bool good = fabs(s.coverage - 0.625) < 0.02 && fabs(s.water - 1.0) < 0.05;
            if (!good) {
                print_message("%s, thickness x %g, water x %g: coverage %.4f, water %.3f\n", of.name,
                              (double)factors[f][0], (double)factors[f][1], s.coverage, s.water);
            }
            assert_true(good);
        }
    }
}

/* From the base to the top it is the mean, which is 1; its slope is what stands there. */
static void water_below_is_the_integral_of_water(void **state) {
    (void)state;
    const float step = 1.0f / 64.0f;
    for (float growth = 0.0f; growth <= 1.0f; growth += 0.25f) {
        velum_profile p = velum_profile_make(1.0f, 1.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, growth, 1.0f);
        assert_float_equal(velum_water_below(p, 0.0f), 0.0f, 0.0f);
        assert_float_equal(velum_water_below(p, 1.0f), 1.0f, 1e-6f);
        for (float z = step; z < 1.0f; z += step) {
            float slope = (velum_water_below(p, z + step) - velum_water_below(p, z - step)) / (2.0f * step);
            assert_float_equal(slope, velum_water(p, z), 1e-5f);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(water_below_is_the_integral_of_water),
        cmocka_unit_test(noise_as_a_whole_holds_what_was_asked_for),
        cmocka_unit_test(storms_in_wind_hold_what_was_asked_for),
        cmocka_unit_test(cumulus_of_any_depth_hold_what_was_asked_for),
        cmocka_unit_test(other_layers_hold_what_was_asked_for),
        cmocka_unit_test(squares_hold_what_was_asked_for),
    };
    return cmocka_run_group_tests_name("coverage", tests, find_noise, NULL);
}
