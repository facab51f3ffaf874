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

/* Normal deviates: sums of twelve (variance 1). */
static double normal(uint64_t *random) {
    double sum = -6.0;
    for (int k = 0; k < 12; k++) {
        *random = *random * 6364136223846793005u + 1442695040888963407u;
        sum += (double)(*random >> 11) * 0x1p-53;
    }
    return sum;
}

/* A reference that is s too bright in half of its pixels and s too dark in the others, and says so, beside a picture
 * that is right, or wrong by a known share: every figure has a closed form. */
static void noise_is_subtracted_exactly(void **state) {
    (void)state;
    const double s = 0.5, truth = 10.0;
    const double high = truth + s, low = truth - s;
    float r[200], p[200], v[200];
    for (int off = 0; off < 2; off++) {
        const double own = off ? 11.0 : truth;
        for (int i = 0; i < 200; i++) {
            p[i] = (float)own;
            r[i] = (float)(i % 2 ? high : low);
            v[i] = (float)(s * s);
        }
        metric m;
        assert_true(metric_compute(p, r, v, 200, &m));
        double raw = 0.5 * (pow((own - high) / high, 2.0) + pow((own - low) / low, 2.0));
        double noise = 0.5 * s * s * (1.0 / (high * high) + 1.0 / (low * low));
        near(m.error_raw, sqrt(raw), 1e-9);
        near(m.noise, sqrt(noise), 1e-9);
        near(m.error, sqrt(fmax(raw - noise, 0.0)), 1e-8);
        near(m.error, off ? 0.1 : 0.0, 0.006); /* of second order: 1 / r is noisy too */
        near(m.bias, own / truth - 1.0, 1e-9);
        near(m.bias_sigma, s / sqrt(200.0) / truth, 1e-9);
        double h = s * s / high / high, l = s * s / low / low;
        double square = 0.5 * (4.0 * fmax(pow((own - high) / high, 2.0) - h, 0.0) * h + 2.0 * h * h +
                               4.0 * fmax(pow((own - low) / low, 2.0) - l, 0.0) * l + 2.0 * l * l);
        near(m.error_sigma, sqrt(m.error * m.error + sqrt(square / 200.0)) - m.error, 1e-9);
    }
}

/* Many references of one truth: the error scatters about the true one as error_sigma says, and does not grow with
 * their noise. */
static void noisy_references_agree(void **state) {
    (void)state;
    enum { PIXELS = 1000, DRAWS = 200 };
    static float r[PIXELS], p[PIXELS], v[PIXELS];
    uint64_t random = 1;
    for (int level = 1; level <= 3; level++) {
        double relative = 0.03 * level;
        double sum = 0.0, squares = 0.0, told = 0.0, raw = 0.0;
        for (int draw = 0; draw < DRAWS; draw++) {
            for (int i = 0; i < PIXELS; i++) {
                double truth = 1.0 + i % 7;
                double s = relative * truth;
                p[i] = (float)(truth * (i % 3 ? 1.05 : 0.9)); /* square: (2 * 0.05^2 + 0.1^2) / 3 */
                r[i] = (float)(truth + s * normal(&random));
                v[i] = (float)(s * s);
            }
            metric m;
            assert_true(metric_compute(p, r, v, PIXELS, &m));
            sum += m.error / DRAWS;
            squares += m.error * m.error / DRAWS;
            told += m.error_sigma / DRAWS;
            raw += m.error_raw / DRAWS;
        }
        const double expected = sqrt((2.0 * 0.0025 + 0.01) / 3.0);
        double scatter = sqrt(fmax(squares - sum * sum, 0.0));
        near(sum, expected, 0.01 * expected + 1.5 * relative * relative);
        near(told, scatter, 0.2 * scatter);
        assert_true(raw > sqrt(expected * expected + 0.9 * relative * relative));
    }
}

/* A picture of half the light, on its left side only, of a noisy reference. */
static void differences_without_noise(void **state) {
    (void)state;
    enum { SIDE = 60 };
    static float r[SIDE * SIDE], p[SIDE * SIDE], v[SIDE * SIDE], e[SIDE * SIDE], with[SIDE * SIDE];
    uint64_t random = 3;
    for (int i = 0; i < SIDE * SIDE; i++) {
        bool left = i % SIDE < SIDE / 2;
        p[i] = left ? 2.0f : 4.0f;
        r[i] = 4.0f + (float)normal(&random); /* 25 % */
        v[i] = 1.0f;
    }
    metric_difference(p, r, v, SIDE, SIDE, e);
    metric_difference(p, r, NULL, SIDE, SIDE, with);
    double left = 0.0, right = 0.0, right_with = 0.0;
    int count = 0;
    for (int y = 1; y + 1 < SIDE; y++) {
        for (int x = 1; x < SIDE / 2 - 1; x++, count++) {
            left += (double)e[y * SIDE + x];
            right += pow((double)e[y * SIDE + x + SIDE / 2], 2.0);
            right_with += pow((double)with[y * SIDE + x + SIDE / 2], 2.0);
        }
    }
    near(left / count, -0.5, 0.02);
    /* Of a normal deviate x of variance 1, max(x^2 - 1, 0) has the mean 2 phi(1) = 0.48. */
    near(right / right_with, 0.48, 0.06);
    near(sqrt(right_with / count), 0.25 / 3.0, 0.01);
    const float black[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    const float broken[4] = {NAN, 0.0f, 0.0f, 1.0f};
    metric_difference(broken, black, black, 2, 2, e);
    assert_true(isnan(e[0]));
    assert_true(e[1] >= 0.0f && e[3] >= 0.0f);
}

static void noise_alone(void **state) {
    (void)state;
    float r[16 * 8], v[16 * 8];
    double noise, noise_8;
    for (int i = 0; i < 16 * 8; i++) {
        r[i] = i % 16 < 8 ? 1.0f : 3.0f;
        v[i] = 0.01f;
    }
    assert_true(metric_noise(r, v, 16, 8, &noise, &noise_8));
    near(noise, 0.1 * sqrt(0.5 * (1.0 + 1.0 / 9.0)), 1e-6);
    near(noise_8, noise / 8.0, 1e-6);
    metric m;
    assert_true(metric_compute(r, r, v, 16 * 8, &m));
    near(m.noise, noise, 1e-9);
    for (int i = 0; i < 16 * 8; i++) {
        r[i] = 0.0f;
    }
    assert_false(metric_noise(r, v, 16, 8, &noise, &noise_8));
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
        cmocka_unit_test(noise_is_subtracted_exactly),
        cmocka_unit_test(noisy_references_agree),
        cmocka_unit_test(differences_without_noise),
        cmocka_unit_test(noise_alone),
        cmocka_unit_test(blocks),
        cmocka_unit_test(luminance_of_white),
        cmocka_unit_test(front),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
