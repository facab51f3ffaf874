/* The metric against values worked out by hand, and the front of best trades. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "metric.h"
#include "pareto.h"

static void near(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) {
        print_error("found %.9g, expected %.9g\n", found, expected);
        fail();
    }
}

static void equal_pictures(void **state) {
    (void)state;
    const float r[4] = {1.0f, 2.0f, 3.0f, 0.0f};
    metric m;
    assert_true(metric_compute(r, r, NULL, 4, &m));
    near(m.error, 0.0, 0.0);
    near(m.bias, 0.0, 0.0);
    near(m.p99, 0.0, 0.0);
    near(m.mean, 1.5, 1e-12);
    assert_int_equal(m.pixels, 4);
}

static void brighter_by_a_tenth(void **state) {
    (void)state;
    float r[100], p[100];
    for (int i = 0; i < 100; i++) {
        r[i] = 1.0f + (float)i;
        p[i] = 1.1f * r[i];
    }
    metric m;
    assert_true(metric_compute(p, r, NULL, 100, &m));
    near(m.error, 0.1, 1e-6);
    near(m.bias, 0.1, 1e-6);
    near(m.p99, 0.1, 1e-6);
}

/* Errors of +2 and -2 of 10 leave no bias; one pixel of 200 does not reach the 99th percentile, three do. */
static void signs_and_tails(void **state) {
    (void)state;
    float r[200], p[200];
    for (int i = 0; i < 200; i++) {
        r[i] = 10.0f;
        p[i] = i % 2 ? 12.0f : 8.0f;
    }
    metric m;
    assert_true(metric_compute(p, r, NULL, 200, &m));
    near(m.error, 0.2, 1e-6);
    near(m.bias, 0.0, 1e-9);
    p[0] = 30.0f;
    assert_true(metric_compute(p, r, NULL, 200, &m));
    near(m.p99, 0.2, 1e-6);
    near(m.error, sqrt((199 * 0.04 + 4.0) / 200.0), 1e-6);
    p[2] = p[4] = 30.0f;
    assert_true(metric_compute(p, r, NULL, 200, &m));
    near(m.p99, 2.0, 1e-6);
}

/* A black pixel of the reference counts as 1 % of the scene's mean. */
static void denominator_has_a_floor(void **state) {
    (void)state;
    const float r[2] = {2.0f, 0.0f};
    const float p[2] = {2.0f, 0.02f};
    metric m;
    assert_true(metric_compute(p, r, NULL, 2, &m));
    near(m.error, 2.0 / sqrt(2.0), 1e-6);
    near(m.bias, 0.01, 1e-6);
}

static void invalid_pixels_are_counted(void **state) {
    (void)state;
    const float r[5] = {1.0f, 1.0f, 1.0f, 1.0f, NAN};
    const float p[5] = {1.0f, NAN, INFINITY, -1.0f, 1.0f};
    metric m;
    assert_true(metric_compute(p, r, NULL, 5, &m));
    assert_int_equal(m.invalid, 4);
    assert_int_equal(m.pixels, 1);
    near(m.error, 0.0, 0.0);
    assert_false(metric_compute(p + 1, r + 1, NULL, 3, &m));
    const float black[2] = {0.0f, 0.0f};
    assert_true(metric_compute(black, black, NULL, 2, &m));
    near(m.error, 0.0, 0.0);
    assert_false(metric_compute(r, black, NULL, 2, &m));
}

/* A noisy reference of variance s^2 makes an error of s where there is none, and no more once corrected. */
static void noise_of_the_reference(void **state) {
    (void)state;
    enum { COUNT = 40000 };
    static float r[COUNT], p[COUNT], v[COUNT];
    uint64_t random = 1;
    for (int i = 0; i < COUNT; i++) {
        double sum = 0.0;
        for (int k = 0; k < 12; k++) {
            random = random * 6364136223846793005u + 1442695040888963407u;
            sum += (double)(random >> 11) * 0x1p-53;
        }
        p[i] = 10.0f;
        r[i] = 10.0f + (float)(0.5 * (sum - 6.0));
        v[i] = 0.25f;
    }
    metric m;
    assert_true(metric_compute(p, r, v, COUNT, &m));
    near(m.noise, 0.05, 0.002);
    near(m.error, 0.05, 0.002);
    assert_true(m.error_corrected < 0.012);
    for (int i = 0; i < COUNT; i++) {
        p[i] = 11.0f;
    }
    assert_true(metric_compute(p, r, v, COUNT, &m));
    near(m.error_corrected, 0.1, 0.01); /* 1 / r is noisy too: of second order */
}

static void blocks(void **state) {
    (void)state;
    const float p[6] = {1.0f, 3.0f, 10.0f, 5.0f, 7.0f, 20.0f};
    const float v[6] = {4.0f, 4.0f, 4.0f, 4.0f, 4.0f, 4.0f};
    float mean[2], variance[2];
    assert_int_equal(metric_blocks(p, v, 3, 2, 2, mean, variance), 2);
    near((double)mean[0], 4.0, 1e-6);
    near((double)mean[1], 15.0, 1e-6);
    near((double)variance[0], 1.0, 1e-6);
    near((double)variance[1], 2.0, 1e-6);
}

static void luminance_of_white(void **state) {
    (void)state;
    near(metric_luminance((const float[3]){1.0f, 1.0f, 1.0f}), 1.0, 1e-9);
}

static void front(void **state) {
    (void)state;
    pareto_point points[] = {{1.0, 9.0, false}, {2.0, 5.0, false}, {3.0, 6.0, false}, {4.0, 1.0, false},
                             {4.0, 2.0, false}, {2.0, 5.0, false}, {NAN, 0.0, false}, {9.0, 1.0, false}};
    const bool expected[] = {true, true, false, true, false, true, false, false};
    pareto_mark(points, 8);
    for (int i = 0; i < 8; i++) {
        assert_int_equal(points[i].on_front, expected[i]);
    }
    pareto_mark(points, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(equal_pictures),
        cmocka_unit_test(brighter_by_a_tenth),
        cmocka_unit_test(signs_and_tails),
        cmocka_unit_test(denominator_has_a_floor),
        cmocka_unit_test(invalid_pixels_are_counted),
        cmocka_unit_test(noise_of_the_reference),
        cmocka_unit_test(blocks),
        cmocka_unit_test(luminance_of_white),
        cmocka_unit_test(front),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
