/* The light on the host's ground and the exposure. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "daylight.h"

#include <math.h>

static const float sun_lx[3] = {128000, 128000, 128000};
static const struct cloud_cover clear = {0, 0};

static double level_lx(double sine, const struct cloud_cover *cover) {
    struct daylight light;
    daylight_compute(sine, sun_lx, true, cover, &light);
    return (double)light.sun_lx[1] * fmax(sine, 0) + (double)light.sky_lx[1];
}

static void clear_noon_is_as_bright_as_measured(void **state) {
    (void)state;
    /* Clear skies: about 100 klx with the sun overhead, 50 to 60 klx at 30 degrees, 400 to 1000 lx at sunset. */
    assert_in_range((uintmax_t)level_lx(1, &clear), 100000, 130000);
    assert_in_range((uintmax_t)level_lx(0.5, &clear), 48000, 66000);
    assert_in_range((uintmax_t)level_lx(0, &clear), 400, 1000);
}

static void overcast_takes_light_away(void **state) {
    double before = level_lx(0.7, &clear);
    (void)state;
    for (double depth = 1; depth < 200; depth *= 2) {
        const struct cloud_cover cover = {1, depth};
        struct daylight light;
        daylight_compute(0.7, sun_lx, true, &cover, &light);
        assert_true((double)light.sky_lx[1] < before);
        before = (double)light.sky_lx[1];
    }
    assert_true(before < 0.15 * level_lx(0.7, &clear));
}

/* What broken cloud turns back comes down by its gaps, but for what goes back to space: its shadows are lighter than
 * the sky alone would have them, and on the mean the ground gets no more than under a clear sky. */
static void broken_cloud_lights_its_shadows(void **state) {
    (void)state;
    struct daylight light;
    daylight_compute(0.7, sun_lx, true, &clear, &light);
    const double sky_lx = (double)light.sky_lx[1];
    for (double share = 0.05; share < 1; share += 0.05) {
        for (double depth = 0.25; depth < 200; depth *= 2) {
            const struct cloud_cover cover = {share, share * depth};
            daylight_compute(0.7, sun_lx, true, &cover, &light);
            const double mean_lx = (1 - share) * (double)light.sun_lx[1] * 0.7 + (double)light.sky_lx[1];
            assert_true(mean_lx < level_lx(0.7, &clear));
            assert_true(share < 0.2 || share > 0.7 || depth < 16 || (double)light.sky_lx[1] > 1.2 * sky_lx);
        }
    }
}

static void no_air_means_no_sky(void **state) {
    struct daylight light;
    (void)state;
    daylight_compute(0.5, sun_lx, false, &clear, &light);
    assert_float_equal(light.sun_lx[0], 128000, 0);
    assert_float_equal(light.sky_lx[2], 0, 0);
}

static void exposure_is_finite_and_follows_the_sun(void **state) {
    const struct cloud_cover covers[] = {{0, 0}, {0.5, 5}, {0.9, 20}, {0.9, 44}, {1, 40}};
    (void)state;
    for (size_t i = 0; i < sizeof covers / sizeof covers[0]; i++) {
        double before = 0;
        for (double elevation = 90; elevation >= -90; elevation -= 1) {
            double exposure = daylight_exposure(sin(elevation * 3.14159265358979 / 180), sun_lx, true, &covers[i]);
            assert_true(isfinite(exposure) && exposure >= before);
            before = exposure;
        }
    }
    const float dark[3] = {0, 0, 0};
    assert_true(isfinite(daylight_exposure(0.5, dark, true, &clear)));
    const struct cloud_cover absurd = {7, NAN};
    assert_true(isfinite(daylight_exposure(0.5, sun_lx, true, &absurd)));
}

/* Level white ground under an overcast, or clear. */
static double white_of(double sine, const struct cloud_cover *cover) {
    struct daylight light;
    daylight_compute(sine, sun_lx, true, cover, &light);
    double lx = cover->coverage > 0 ? (double)light.sky_lx[1] : level_lx(sine, cover);
    return lx * daylight_exposure(sine, sun_lx, true, cover);
}

static void the_eye_opens_where_little_is_lit(void **state) {
    (void)state;
    const struct cloud_cover broken = {0.5, 10};
    assert_true(daylight_exposure(0.05, sun_lx, true, &broken) > 1.3 * daylight_exposure(0.05, sun_lx, true, &clear));
    assert_float_equal(daylight_exposure(0.6, sun_lx, true, &broken), daylight_exposure(0.6, sun_lx, true, &clear), 0);
}

static void what_is_darker_looks_darker(void **state) {
    (void)state;
    const struct cloud_cover covers[] = {{0, 0}, {1, 10}, {1, 40}, {1, 200}};
    const double sines[] = {0.05, 0.17, 0.6, 1};
    for (size_t i = 0; i < 4; i++) {
        for (size_t k = 1; k < 4; k++) {
            assert_true(white_of(sines[i], &covers[k]) < white_of(sines[i], &covers[k - 1]));
        }
        assert_true(white_of(sines[i], &covers[3]) < 0.8 * white_of(sines[i], &covers[0]));
    }
}

/* Of all layers the coverage is known, the optical depth of those over the eye. */
static void cloud_beneath_and_veils_change_nothing(void **state) {
    (void)state;
    const struct cloud_cover beneath = {1, 0}, veil = {1, 0.05};
    for (double sine = 0.02; sine < 1; sine += 0.02) {
        const double exposure = daylight_exposure(sine, sun_lx, true, &clear);
        assert_float_equal(daylight_exposure(sine, sun_lx, true, &beneath), exposure, 1e-9 * exposure);
        assert_float_equal(daylight_exposure(sine, sun_lx, true, &veil), exposure, 0.01 * exposure);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(clear_noon_is_as_bright_as_measured),
        cmocka_unit_test(overcast_takes_light_away),
        cmocka_unit_test(broken_cloud_lights_its_shadows),
        cmocka_unit_test(no_air_means_no_sky),
        cmocka_unit_test(exposure_is_finite_and_follows_the_sun),
        cmocka_unit_test(the_eye_opens_where_little_is_lit),
        cmocka_unit_test(what_is_darker_looks_darker),
        cmocka_unit_test(cloud_beneath_and_veils_change_nothing),
    };
    return cmocka_run_group_tests_name("daylight", tests, NULL, NULL);
}
