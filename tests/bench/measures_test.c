/* The measures against values worked out by hand. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "measures.h"

static void near(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) {
        print_error("found %.9g, expected %.9g\n", found, expected);
        fail();
    }
}

static void powers_are_found(void **state) {
    (void)state;
    const double sizes[4] = {1.0, 2.0, 4.0, 8.0};
    for (int k = 0; k < 3; k++) {
        double power = 0.5 + 0.5 * k, costs[4];
        for (int i = 0; i < 4; i++) {
            costs[i] = 3.0 * pow(sizes[i], power);
        }
        growth g = growth_of(sizes, costs, 4);
        near(g.exponent, power, 1e-12);
        near(g.sigma, 0.0, 1e-9);
        near(g.steepest, power, 1e-12);
    }
}

/* A constant part makes growth slower than linear; a last doubling that costs four times as much shows as steepest. */
static void other_laws(void **state) {
    (void)state;
    const double sizes[4] = {1.0, 2.0, 4.0, 8.0};
    const double affine[4] = {11.0, 12.0, 14.0, 18.0}, knee[4] = {1.0, 2.0, 4.0, 16.0};
    growth g = growth_of(sizes, affine, 4);
    assert_true(g.exponent > 0.1 && g.exponent < 0.4 && g.sigma > 0.0);
    near(g.steepest, log(18.0 / 14.0) / log(2.0), 1e-12);
    g = growth_of(sizes, knee, 4);
    near(g.steepest, 2.0, 1e-12);
    /* Slope of (0, 0), (1, 1), (2, 2), (3, 4) in steps of log 2: 6.5 / 5. */
    near(g.exponent, 1.3, 1e-12);
}

static void changes(void **state) {
    (void)state;
    const float a[6] = {0, 0, 0, 10, 10, 10}, b[6] = {6, 0, 0, 10, 4, 10}, c[6] = {0, 0, 0, 0, 0, 0},
                d[6] = {-4, 2, 0, 0, 7, 0};
    near(mean_change(a, b, 2), 2.0, 1e-12);
    near(mean_change(b, a, 2), 2.0, 1e-12);
    near(mean_excess(a, b, c, d, 2), 2.0 / 6.0, 1e-12);
    near(mean_excess(a, b, a, b, 2), 0.0, 0.0);
    near(share_beyond(a, b, c, d, 2, 1.5), 0.5, 0.0);
    near(share_beyond(a, b, c, d, 2, 2.5), 0.0, 0.0);
    near(share_beyond(a, b, c, c, 2, 2.5), 1.0, 0.0);
}

/* Black is 0, much light is white, grey stays grey and grows with light. */
static void tones(void **state) {
    (void)state;
    const float rgb[12] = {0, 0, 0, 100, 100, 100, 1e5f, 1e5f, 1e5f, 200, 200, 200};
    float out[12];
    tone_mapped(rgb, 4, 1e-3, out);
    near((double)out[0], 0.0, 0.5);
    near((double)out[3], (double)out[5], 1.0);
    assert_true(out[9] > out[3] + 5.0f && out[9] < out[6]);
    near((double)out[6], 255.0, 6.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(powers_are_found),
        cmocka_unit_test(other_laws),
        cmocka_unit_test(changes),
        cmocka_unit_test(tones),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
