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

static const double pi = 3.14159265358979323846;

/* Down: what is diffuse, and what still comes straight from the sun. */
static double net_flux(float above, float below, float g, float mu_sun, float albedo) {
    const velum_diffuse d = velum_diffuse_in(above, below, g, mu_sun, albedo);
    return 4.0 * pi / 3.0 * (double)d.flux + (double)mu_sun * exp(-(double)above / (double)mu_sun);
}

static void diffuse_light_is_conserved(void **state) {
    (void)state;
    const float suns[] = {0.06f, 0.3f, 0.7f, 1.0f};
    const float depths[] = {0.01f, 0.3f, 2.0f, 30.0f};
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 4; k++) {
            const float mu = suns[i], all = depths[k];
            for (int a = 0; a <= 2; a++) {
                const float albedo = 0.5f * (float)a;
                const double net = net_flux(0.0f, all, 0.4f, mu, albedo);
                for (int n = 1; n <= 8; n++) {
                    const float above = all * (float)n / 8.0f;
                    assert_float_equal(net_flux(above, all - above, 0.4f, mu, albedo), net, 2e-6);
                }
                /* No more than the ground can take; Eddington: to first order. */
                assert_true(net >= -1e-6 && net <= (double)mu * (1.0 - (double)albedo) + 1e-3);
                /* None comes down from space. */
                const velum_diffuse top = velum_diffuse_in(0.0f, all, 0.4f, mu, albedo);
                assert_float_equal((double)top.mean + 2.0 / 3.0 * (double)top.flux, 0.0, 1e-6);
                /* The ground sends back its share of what comes down. */
                const velum_diffuse low = velum_diffuse_in(all, 0.0f, 0.4f, mu, albedo);
                const double down = pi * ((double)low.mean + 2.0 / 3.0 * (double)low.flux) +
                                    (double)mu * exp(-(double)all / (double)mu);
                const double up = pi * ((double)low.mean - 2.0 / 3.0 * (double)low.flux);
                assert_float_equal(up, (double)albedo * down, 2e-6);
            }
        }
    }
}

static void diffuse_light_has_its_limits(void **state) {
    (void)state;
    const velum_diffuse none = velum_diffuse_in(0.0f, 1e-6f, 0.4f, 0.6f, 0.0f);
    assert_float_equal((double)none.mean, 0.0, 1e-5);
    /* Half-space: all comes back. */
    assert_float_equal(net_flux(0.0f, 1e6f, 0.4f, 0.6f, 0.0f), 0.0, 1e-5);
    /* A white ground under nothing: mean of its own light and of none from above. */
    const velum_diffuse white = velum_diffuse_in(0.0f, 0.0f, 0.4f, 0.6f, 1.0f);
    assert_float_equal((double)white.mean, 0.5 * 0.6 / pi, 1e-6);
}

/* Light from the ground goes up and away; what does not, the ground gets back. */
static void light_from_below_has_its_limits(void **state) {
    (void)state;
    const velum_diffuse none = velum_diffuse_from_below(0.0f, 0.0f, 0.4f);
    assert_float_equal((double)none.mean, 0.5, 1e-6);
    for (int i = 0; i < 4; i++) {
        const float all = (float[]){0.01f, 0.3f, 2.0f, 30.0f}[i];
        const velum_diffuse top = velum_diffuse_from_below(0.0f, all, 0.4f);
        assert_float_equal((double)top.mean + 2.0 / 3.0 * (double)top.flux, 0.0, 1e-6);
        const velum_diffuse low = velum_diffuse_from_below(all, 0.0f, 0.4f);
        assert_float_equal((double)low.mean - 2.0 / 3.0 * (double)low.flux, 1.0, 1e-6);
        /* What the air sends back of an even luminance, and what goes through, are all of it. */
        const velum_diffuse even = velum_diffuse_from_below(all, 0.0f, 0.0f);
        const double back = (double)even.mean + 2.0 / 3.0 * (double)even.flux;
        assert_float_equal(back, (double)velum_sky_back(all), 1e-6);
        assert_float_equal(back - 4.0 / 3.0 * (double)even.flux, 1.0, 1e-6);
    }
}

/* Sun and sky together lose what goes back to space; the sky adds to the sun. */
static void the_sky_adds_to_the_sun(void **state) {
    (void)state;
    assert_float_equal((double)velum_sky_gain(0.0f, 2.0f), 1.0, 1e-6);
    assert_float_equal((double)velum_sky_back(0.0f), 0.0, 1e-9);
    for (int i = 1; i <= 20; i++) {
        const float depth = 0.02f * (float)i;
        for (int k = 1; k <= 10; k++) {
            const float mu = 0.1f * (float)k;
            const double gain = (double)velum_sky_gain(depth, 1.0f / mu);
            const double through = gain * exp(-(double)depth / (double)mu);
            assert_true(gain > 1.0 && through < 1.0);
            const double net = net_flux(depth, 0.0f, 0.0f, mu, 0.0f);
            assert_float_equal(through * (double)mu, net, 2e-6);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(slant_ways_are_chapmans), cmocka_unit_test(diffuse_light_is_conserved),
        cmocka_unit_test(diffuse_light_has_its_limits), cmocka_unit_test(light_from_below_has_its_limits),
        cmocka_unit_test(the_sky_adds_to_the_sun)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
