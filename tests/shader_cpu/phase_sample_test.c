/* Directions drawn from phase functions: their share below any angle is that of the function itself. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

enum { NODES = 181 };
static float table_cos[NODES], table_value[NODES], table_share[NODES];
static float velum_phase_table_cos(int i) {
    return table_cos[i];
}
static float velum_phase_table_value(int i) {
    return table_value[i];
}
static float velum_phase_table_share(int i) {
    return table_share[i];
}
#define VELUM_PHASE_TABLE
static uint64_t drawn;
/* SplitMix64 (Steele et al. 2014). */
static float drawn_unit(void) {
    uint64_t z = drawn += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (float)((z ^ z >> 31) >> 40) * 0x1p-24f;
}
#define VELUM_PHASE_DRAW() drawn_unit()
#include "shared/phase_sample.h"

/* Share of light that turns by 1 - cos >= turn, by quadrature in the angle. */
static double share_beyond(velum_phase_lobes p, double turn) {
    const int steps = 20000;
    double from = acos(fmax(1.0 - turn, -1.0));
    double sum = 0.0;
    for (int i = 0; i < steps; i++) {
        double angle = from + (3.14159265358979 - from) * (i + 0.5) / steps;
        double half = sin(0.5 * angle);
        sum += (double)velum_phase_lobes_turn(p, (float)(2.0 * half * half)) * sin(angle);
    }
    return sum * (3.14159265358979 - from) / steps * 2.0 * 3.14159265358979;
}

/* As many draws should end beyond an angle as the function sends there: 5 standard deviations of the count. */
static void lobes_are_drawn_as_they_are(void **state) {
    (void)state;
    const velum_phase_lobes cases[] = {velum_phase_lobes_cloud(false),
                                       velum_phase_lobes_cloud(true),
                                       velum_phase_lobes_make(0.85f, 0.0f, 0.0f, 0.0f),
                                       velum_phase_lobes_make(0.0f, 0.0f, 0.0f, 0.0f),
                                       velum_phase_lobes_make(-0.4f, 0.0f, 0.0f, 0.0f),
                                       velum_phase_lobes_make(0.0f, 0.0f, 1.0f, 1.0f),
                                       velum_phase_lobes_droplet(velum_phase_droplet_of(10.0f)),
                                       velum_phase_lobes_droplet(velum_phase_droplet_of(40.0f))};
    enum { DRAWS = 200000, ANGLES = 24 };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        double beyond[ANGLES];
        int count[ANGLES] = {0};
        float turns[ANGLES];
        for (int i = 0; i < ANGLES; i++) {
            /* From half a degree to 180, evenly in the logarithm. */
            double half = 0.5 * 3.14159265358979 / 180.0 * 0.5 * pow(360.0, (double)i / ANGLES);
            turns[i] = (float)(2.0 * sin(half) * sin(half));
            beyond[i] = share_beyond(cases[k], (double)turns[i]);
        }
        for (int n = 0; n < DRAWS; n++) {
            float turn = velum_phase_lobes_draw(cases[k]);
            assert_true(turn >= 0.0f && turn <= 2.0f);
            for (int i = 0; i < ANGLES; i++) {
                count[i] += turn >= turns[i];
            }
        }
        for (int i = 0; i < ANGLES; i++) {
            double sigma = sqrt(DRAWS * fmax(beyond[i] * (1.0 - beyond[i]), 1.0 / DRAWS));
            assert_float_equal(count[i], DRAWS * beyond[i], 5.0 * sigma);
        }
        assert_float_equal(share_beyond(cases[k], 0.0), 1.0, 2e-3);
        for (int i = 0; i <= 20; i++) {
            float c = 1.0f - (float)i * 0.1f;
            assert_float_equal((double)velum_phase_lobes_at(cases[k], c),
                               (double)velum_phase_lobes_turn(cases[k], 1.0f - c),
                               1e-3 * (double)velum_phase_lobes_at(cases[k], c) + 1e-9);
        }
    }
}

static void the_cloud_function_is_that_of_the_presets(void **state) {
    (void)state;
    for (int ice = 0; ice < 2; ice++) {
        for (int i = 0; i <= 100; i++) {
            float c = -1.0f + 0.02f * (float)i;
            float value = velum_phase_cloud(c, ice);
            assert_float_equal((double)velum_phase_lobes_at(velum_phase_lobes_cloud(ice), c), (double)value,
                               1e-6 * (double)value);
        }
    }
}

static void tables_are_drawn_as_they_are(void **state) {
    (void)state;
    for (int i = 0; i < NODES; i++) {
        table_cos[i] = (float)-cos(3.14159265358979 * i / (NODES - 1));
        table_value[i] = velum_phase_lobes_at(velum_phase_lobes_make(0.7f, -0.3f, 0.0f, 0.3f), table_cos[i]);
        table_share[i] = i == 0 ? 0.0f
                                : table_share[i - 1] + velum_phase_table_area(table_cos[i - 1], table_value[i - 1],
                                                                              table_cos[i], table_value[i]);
    }
    const float whole = table_share[NODES - 1];
    for (int i = 0; i < NODES; i++) {
        table_value[i] /= whole;
        table_share[i] /= whole;
    }
    /* Trapezoids between what is drawn, against the shares that were asked for. */
    float before = -1.0f;
    for (int i = 1; i <= 100; i++) {
        float u = (float)i / 100.0f;
        float c = 1.0f - velum_phase_table_sample(NODES, u);
        double sum = 0.0;
        const int steps = 2000;
        for (int k = 0; k < steps; k++) {
            sum += (double)velum_phase_table_at(NODES, before + (c - before) * ((float)k + 0.5f) / steps);
        }
        assert_float_equal(sum * (double)(c - before) / steps * 2.0 * 3.14159265358979, 0.01, 3e-4);
        before = c;
    }
    assert_float_equal((double)before, 1.0, 1e-5);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(lobes_are_drawn_as_they_are),
                                       cmocka_unit_test(the_cloud_function_is_that_of_the_presets),
                                       cmocka_unit_test(tables_are_drawn_as_they_are)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
