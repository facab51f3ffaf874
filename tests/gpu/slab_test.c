/* The transmittance of a uniform slab, in a view and in the shadow map: Beer and Lambert. */
#include <math.h>
#include <stdlib.h>

#include "fixture.h"

static const float taus[] = {0.5f, 1.0f, 2.0f, 4.0f, 8.0f};
static const double mus[] = {1.0, 0.8, 0.6, 0.4, 0.2};
enum { TAUS = 5, MUS = 5, SIDE = 16, SETTLE = 17 };

static void expect_transmittance(double found, double tau, double mu, const char *where) {
    double expected = exp(-tau / mu);
    double bound = 0.01 * expected + 0.002;
    if (!(fabs(found - expected) <= bound)) {
        print_message("%s: tau %g, mu %g: found %.5f, expected %.5f within %.5f\n", where, tau, mu, found, expected,
                      bound);
    }
    assert_true(fabs(found - expected) <= bound);
}

static void mix_axes(const double up[3], const double side[3], double mu, double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = mu * up[i] + sqrt(1.0 - mu * mu) * side[i];
    }
}

static void transmits_in_views(void **state) {
    (void)state;
    static float rgb[SIDE * SIDE * 3];
    fixture f;
    fixture_borrow(&f);
    velum_view *view = fixture_view(&f, f.eye, SIDE, SIDE);
    double east[3], north[3], up[3];
    double below[3];
    fixture_axes(50.0, 8.5, east, north, up);
    fixture_position(50.0, 8.5, 999.0, below);
    double sun[3];
    mix_axes(up, east, 0.6, sun);
    for (int t = 0; t < TAUS; t++) {
        velum_layer slab = fixture_slab(taus[t]);
        fixture_commit(&f, &slab, 1);
        for (int m = 0; m < MUS; m++) {
            double forward[3];
            mix_axes(up, east, mus[m], forward);
            velum_view_frame camera = fixture_camera(below, forward, north, 0.001f, 0.001f);
            velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_NONE);
            velum_eye_frame eye = {.struct_size = sizeof eye, .flags = VELUM_EYE_RESET, .eye = f.eye};
            for (int i = 0; i < 3; i++) {
                eye.position_ecef_m[i] = below[i];
            }
            const velum_pixels pixels = {.struct_size = sizeof pixels,
                                         .view = view,
                                         .frame = &camera,
                                         .transmittance_rgb = rgb,
                                         .width = SIDE,
                                         .height = SIDE};
            for (int i = 0; i < SETTLE; i++) {
                assert_int_equal(f.standalone_api->render(f.engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
                eye.flags = 0;
            }
            for (int i = 0; i < SIDE * SIDE; i++) {
                expect_transmittance((double)rgb[3 * i + i % 3], (double)taus[t], mus[m], "view");
            }
        }
    }
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_give_back(&f);
}

static void transmits_in_shadow_maps(void **state) {
    (void)state;
    enum { TEXELS = 64, LEVELS = 2 };
    static float map[LEVELS * TEXELS * TEXELS];
    fixture f;
    fixture_borrow(&f);
    velum_shadow *shadow = NULL;
    const velum_shadow_desc desc = {
        .struct_size = sizeof desc, .levels = LEVELS, .texels = TEXELS, .extent_m = 1000.0f};
    assert_int_equal(f.engine_api->create_shadow(f.engine, &desc, &shadow), VELUM_OK);
    double east[3], north[3], up[3];
    velum_shadow_frame where = {.struct_size = sizeof where};
    fixture_axes(-33.0, 151.0, east, north, up);
    fixture_position(-33.0, 151.0, 0.0, where.centre_ecef_m);
    for (int t = 0; t < TAUS; t++) {
        velum_layer slab = fixture_slab(taus[t]);
        fixture_commit(&f, &slab, 1);
        for (int m = 0; m < MUS; m++) {
            double sun[3];
            mix_axes(up, north, mus[m], sun);
            velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_NONE);
            assert_int_equal(
                f.standalone_api->render_shadow(f.engine, &frame, shadow, &where, map, sizeof map / sizeof map[0]),
                VELUM_OK);
            for (int k = 0; k < LEVELS; k++) {
                const float *level = map + k * TEXELS * TEXELS;
                expect_transmittance((double)level[(TEXELS / 2) * TEXELS + TEXELS / 2], (double)taus[t], mus[m],
                                     "shadow map");
            }
        }
    }
    assert_int_equal(f.engine_api->destroy_shadow(shadow), VELUM_OK);
    fixture_give_back(&f);
}

static void slab_without_weather_is_clear(void **state) {
    (void)state;
    static float rgb[SIDE * SIDE * 3], light[SIDE * SIDE * 3];
    fixture f;
    fixture_init(&f, false);
    velum_view *view = fixture_view(&f, f.eye, SIDE, SIDE);
    double east[3], north[3], up[3];
    fixture_axes(10.0, -60.0, east, north, up);
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = f.eye};
    fixture_position(10.0, -60.0, 100.0, eye.position_ecef_m);
    velum_view_frame camera = fixture_camera(eye.position_ecef_m, up, north, 0.1f, 0.1f);
    velum_frame_info frame = fixture_frame(east, 0.0, VELUM_ATMOSPHERE_NONE);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &camera,
                                 .luminance_rgb = light,
                                 .transmittance_rgb = rgb,
                                 .width = SIDE,
                                 .height = SIDE};
    assert_int_equal(f.standalone_api->render(f.engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
    for (int i = 0; i < SIDE * SIDE * 3; i++) {
        assert_true(rgb[i] == 1.0f);
        assert_true(light[i] == 0.0f);
    }
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_finish(&f);
}

/* What the host has drawn ends the rays, in each convention of depth. */
static void depth_ends_the_rays(void **state) {
    (void)state;
    enum { PIXELS = SIDE * SIDE };
    static float rgb[PIXELS * 3], depth[PIXELS];
    const float near_m = 0.5f;
    const float far_m = 50000.0f;
    fixture f;
    fixture_borrow(&f);
    velum_layer slab = fixture_slab(2.0f);
    fixture_commit(&f, &slab, 1);
    velum_view *view = fixture_view(&f, f.eye, SIDE, SIDE);
    double east[3], north[3], up[3];
    fixture_axes(20.0, 100.0, east, north, up);
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = f.eye};
    fixture_position(20.0, 100.0, 500.0, eye.position_ecef_m);
    velum_view_frame camera = fixture_camera(eye.position_ecef_m, up, north, 0.01f, 0.01f);
    camera.depth_near_m = near_m;
    camera.depth_far_m = far_m;
    velum_frame_info frame = fixture_frame(east, 0.0, VELUM_ATMOSPHERE_NONE);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &camera,
                                 .transmittance_rgb = rgb,
                                 .depth = depth,
                                 .width = SIDE,
                                 .height = SIDE};
    /* Nothing, a wall below the slab, one in its middle. */
    static const float walls_m[] = {0.0f, 400.0f, 1000.0f};
    static const double depths[] = {2.0, 0.0, 1.0};
    for (int wall = 0; wall < 3; wall++) {
        for (int convention = VELUM_DEPTH_REVERSED_INFINITE; convention <= VELUM_DEPTH_DISTANCE; convention++) {
            float z = walls_m[wall];
            float d = z;
            if (convention == VELUM_DEPTH_REVERSED_INFINITE) {
                d = z > 0.0f ? near_m / z : 0.0f;
            } else if (convention == VELUM_DEPTH_REVERSED) {
                d = z > 0.0f ? near_m * (far_m - z) / (z * (far_m - near_m)) : 0.0f;
            } else if (convention == VELUM_DEPTH_FORWARD) {
                d = z > 0.0f ? far_m * (z - near_m) / (z * (far_m - near_m)) : 1.0f;
            }
            for (int i = 0; i < PIXELS; i++) {
                depth[i] = d;
            }
            camera.depth_convention = convention;
            eye.flags = VELUM_EYE_RESET;
            assert_int_equal(f.standalone_api->render(f.engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
            /* Forward depth has few digits so far away. */
            double slack = convention == VELUM_DEPTH_FORWARD ? 0.01 : 0.0;
            assert_float_equal(rgb[0], exp(-depths[wall]), 0.01 * exp(-depths[wall]) + 0.002 + slack);
        }
    }
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_give_back(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(slab_without_weather_is_clear),
                                       cmocka_unit_test(transmits_in_views), cmocka_unit_test(transmits_in_shadow_maps),
                                       cmocka_unit_test(depth_ends_the_rays)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
