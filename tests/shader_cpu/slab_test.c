/* Light and length of steps through uniform layers, against quadrature and geometry in double precision. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "shared/slab.h"

static void thin_steps_keep_their_digits(void **state) {
    (void)state;
    for (double depth = 1e-12; depth < 100.0; depth *= 1.07) {
        double found = (double)velum_opacity((float)depth, expf(-(float)depth));
        assert_true(fabs(found / -expm1(-depth) - 1.0) < 1e-5);
        double mean = (double)velum_mean_transmittance((float)depth);
        assert_true(fabs(mean * depth / -expm1(-depth) - 1.0) < 1e-5);
    }
}

typedef struct means {
    double direct, place;
} means;

/* Of what the step takes, in equal parts: t is the depth at which a share u has been taken. */
static means quadrature(double depth, double near_depth, double far_depth) {
    enum { PARTS = 20000 };
    means sum = {0};
    for (int i = 0; i < PARTS; i++) {
        double u = (i + 0.5) / PARTS;
        double t = -log1p(u * expm1(-depth));
        double d = near_depth + (far_depth - near_depth) * t / depth;
        sum.direct += exp(-d) / PARTS;
        sum.place += t / depth / PARTS;
    }
    return sum;
}

static void steps_are_what_quadrature_says(void **state) {
    (void)state;
    static const double depths[] = {1e-6, 1e-3, 0.02, 0.3, 1.0, 4.0, 20.0, 300.0};
    /* Depth towards the sun against depth of the step: rays up and down, sun high and low. */
    static const double slopes[] = {0.05, 0.7, 1.0, 1.3, 5.0};
    uint32_t compared = 0;
    for (int i = 0; i < 8; i++) {
        for (int k = 0; k < 5; k++) {
            for (int turn = 0; turn < 2; turn++) {
                for (double rest = 0.0; rest < 3.0; rest += 1.1) {
                    double across = rest + slopes[k] * depths[i];
                    double near_depth = turn ? across : rest, far_depth = turn ? rest : across;
                    means expected = quadrature(depths[i], near_depth, far_depth);
                    velum_slab_light found = velum_slab_light_of((float)depths[i], (float)near_depth, (float)far_depth);
                    assert_true(fabs((double)found.direct - expected.direct) < 2e-3 * expected.direct + 1e-6);
                    assert_true(fabs((double)found.place - expected.place) < 1e-3);
                    compared++;
                }
            }
        }
    }
    assert_int_equal(compared, 8 * 5 * 2 * 3);
}

static void shares_are_taken_so_far_on(void **state) {
    (void)state;
    for (double depth = 1e-6; depth < 60.0; depth *= 1.7) {
        for (int i = 0; i <= 10; i++) {
            double t = (double)velum_slab_share((float)depth, (float)i / 10.0f);
            assert_true(t >= 0.0 && t <= 1.0);
            assert_float_equal(expm1(-depth * t) / expm1(-depth), i / 10.0, 3e-3);
        }
    }
}

static void extremes_are_numbers(void **state) {
    (void)state;
    static const float depths[] = {0.0f, 1e-30f, 1e-8f, 1.0f, 90.0f, 1e5f, 1e9f};
    for (int i = 0; i < 7; i++) {
        for (int k = 0; k < 7; k++) {
            for (int n = 0; n < 7; n++) {
                velum_slab_light l = velum_slab_light_of(depths[i], depths[k], depths[n]);
                assert_true(l.direct >= 0.0f && l.direct <= 1.0f);
                assert_true(l.place >= 0.0f && l.place <= 1.0f);
            }
        }
    }
}

/* Height at t of a ray from height h that rises by `rise`: exact on a sphere. */
static double height_at(double h, double rise, double t) {
    const double r = 6378137.0 + h;
    double square = t * (2.0 * r * rise + t);
    return h + square / (r + sqrt(r * r + square));
}

static void lengths_are_those_of_the_bent_ray(void **state) {
    (void)state;
    static const double rises[] = {-1.0, -0.7, -0.02, -0.001, 0.0, 0.001, 0.02, 0.7, 1.0};
    static const double heights[] = {0.0, 999.0, 1000.0, 1000.5, 1001.0, 1500.0, 2500.0};
    static const double steps[] = {1.0, 100.0, 2000.0, 20000.0};
    static const double tops[] = {1001.0, 2000.0};
    enum { PARTS = 20000 };
    uint32_t crossed = 0;
    for (int i = 0; i < 9 * 7 * 4 * 2; i++) {
        double rise = rises[i % 9], h = heights[i / 9 % 7], step = steps[i / 63 % 4], top = tops[i / 252];
        uint32_t in = 0;
        for (int k = 0; k < PARTS; k++) {
            double at = height_at(h, rise, step * ((k + 0.5) / PARTS - 0.3));
            in += at > 1000.0 && at < top ? 1 : 0;
        }
        double expected = step * in / PARTS;
        velum_slab_span s =
            velum_slab_within((float)h, (float)rise, 1000.0f, (float)top, (float)(0.3 * step), (float)(0.7 * step));
        assert_true(s.from_m <= s.to_m && (double)s.from_m >= -0.3001 * step && (double)s.to_m <= 0.7001 * step);
        assert_true(fabs((double)s.inside_m - expected) < 3e-4 * step + 0.02 * expected);
        crossed += expected > 0.0 ? 1 : 0;
    }
    assert_true(crossed > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(thin_steps_keep_their_digits), cmocka_unit_test(steps_are_what_quadrature_says),
        cmocka_unit_test(shares_are_taken_so_far_on), cmocka_unit_test(extremes_are_numbers),
        cmocka_unit_test(lengths_are_those_of_the_bent_ray)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
