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
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        /* The lobes apart: what is drawn at u leaves the share u behind. */
        for (int lobe = 0; lobe < 2; lobe++) {
            velum_phase_lobes p = cases[k];
            if (lobe == 1 && p.weight_second == 0.0f) {
                continue;
            }
            p.weight_second = lobe == 1 ? 1.0f : 0.0f;
            for (int i = 0; i < 40; i++) {
                float u = ((float)i + 0.5f) / 40.0f;
                float turn = velum_phase_lobes_sample(p, 0.5f, u);
                assert_true(turn >= 0.0f && turn <= 2.0f);
                assert_float_equal(share_beyond(p, (double)turn), (double)u, 2e-3);
            }
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
