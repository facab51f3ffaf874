/* Air by closed forms, against quadrature in double precision. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>

#include "shared/air.h"

/* exp(-h / scale) along a straight ray over the sphere, over the same straight up. */
static double slant_by_quadrature(double scale_m, double height_m, double mu) {
    enum { STEPS = 200000 };
    const double r = (double)VELUM_WGS84_A_M + height_m;
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double u = (i + 0.5) / STEPS;
        const double t = scale_m * 1000.0 * u * u; /* finer near by */
        const double rise = t * (2.0 * r * mu + t) / (r + sqrt(r * r + t * (2.0 * r * mu + t)));
        sum += exp(-rise / scale_m) * 2.0 * u / STEPS * 1000.0;
    }
    return sum;
}

static void slant_ways_are_chapmans(void **state) {
    (void)state;
    const double scales_m[] = {1200.0, 1500.0, 8000.0};
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k <= 20; k++) {
            const double mu = k / 20.0 * (k / 20.0);
            const double expected = slant_by_quadrature(scales_m[i], 500.0, mu);
            assert_float_equal((double)velum_slant((float)scales_m[i], 500.0f, (float)mu), expected, 0.01 * expected);
        }
        assert_float_equal((double)velum_slant((float)scales_m[i], 500.0f, 1.0f), 1.0, 0.01);
        assert_true(velum_slant((float)scales_m[i], 500.0f, -0.1f) == velum_slant((float)scales_m[i], 500.0f, 0.0f));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(slant_ways_are_chapmans)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
