/* Ground begins at the horizon, however the eye turns and wherever it is: nothing of it above, nothing but it below. */
#include <math.h>
#include <string.h>

#include "core/geodesy.h"
#include "fixture.h"

enum { W = 64, H = 52, PIXELS = W * H }; /* not whole work groups */

/* Sine of how far inside the cone of rays that meet the ellipsoid a ray lies: of WGS84, scaled to a sphere. */
static double inside(const double position[3], const double ray[3]) {
    const double scale[3] = {1.0, 1.0, CORE_WGS84_A_M / CORE_WGS84_B_M};
    double position2 = 0.0, ray2 = 0.0, along = 0.0;
    for (int i = 0; i < 3; i++) {
        position2 += pow(position[i] * scale[i], 2.0);
        ray2 += pow(ray[i] * scale[i], 2.0);
        along -= position[i] * scale[i] * ray[i] * scale[i];
    }
    return along / sqrt(position2 * ray2) - sqrt(1.0 - CORE_WGS84_A_M * CORE_WGS84_A_M / position2);
}

typedef struct seen {
    uint32_t ground, sky;
} seen;

static void look(fixture *f, velum_view *view, double lat_deg, double height_m, double pitch_deg, double roll_deg,
                 seen *all) {
    static float through[PIXELS * 3];
    double east[3], north[3], up[3], forward[3], right[3];
    fixture_axes(lat_deg, 8.5, east, north, up);
    const double pitch = pitch_deg * CORE_DEG, roll = roll_deg * CORE_DEG;
    for (int i = 0; i < 3; i++) {
        forward[i] = cos(pitch) * north[i] + sin(pitch) * up[i];
        right[i] = cos(roll) * east[i] - sin(roll) * (cos(pitch) * up[i] - sin(pitch) * north[i]);
    }
    velum_eye_frame eye = {.struct_size = sizeof eye, .flags = VELUM_EYE_RESET, .eye = f->eye};
    fixture_position(lat_deg, 8.5, height_m, eye.position_ecef_m);
    velum_view_frame camera = fixture_camera(eye.position_ecef_m, forward, right, 0.8f, 0.65f);
    camera.flags |= VELUM_VIEW_GROUND;
    const velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_NONE);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &camera,
                                 .transmittance_rgb = through,
                                 .width = W,
                                 .height = H};
    assert_int_equal(f->standalone_api->render(f->engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
    for (int p = 0; p < PIXELS; p++) {
        const double x = 0.8 * (2.0 * (p % W + 0.5) / W - 1.0);
        const double y = 0.65 * (1.0 - 2.0 * (p / W + 0.5) / H);
        double ray[3];
        for (int i = 0; i < 3; i++) {
            ray[i] = camera.forward_ecef[i] + x * camera.right_ecef[i] + y * camera.up_ecef[i];
        }
        const double in = inside(eye.position_ecef_m, ray);
        if (fabs(in) > 2e-4) {
            assert_true(through[3 * p] == (in > 0.0 ? 0.0f : 1.0f));
            all->ground += in > 0.0 ? 1 : 0;
            all->sky += in > 0.0 ? 0 : 1;
        }
    }
}

static void ground_begins_at_the_horizon(void **state) {
    (void)state;
    static const double heights_m[] = {2.0, 300.0, 11000.0, 400000.0, 36000000.0};
    static const double pitches_deg[] = {0.0, 12.0, -8.0, -33.0, 60.0, -90.0};
    static const double rolls_deg[] = {0.0, 20.0, 90.0, 180.0};
    fixture f;
    fixture_init(&f, false);
    velum_view *view = fixture_view(&f, f.eye, W, H);
    seen all = {0, 0};
    for (size_t h = 0; h < sizeof heights_m / sizeof *heights_m; h++) {
        for (size_t p = 0; p < sizeof pitches_deg / sizeof *pitches_deg; p++) {
            for (size_t r = 0; r < sizeof rolls_deg / sizeof *rolls_deg; r++) {
                const double lat_deg = h % 2 ? 50.0 : r % 2 ? 0.0 : 90.0;
                look(&f, view, lat_deg, heights_m[h], pitches_deg[p], rolls_deg[r], &all);
            }
        }
    }
    print_message("%u pixels of ground, %u of sky\n", all.ground, all.sky);
    assert_true(all.ground > 20 * PIXELS && all.sky > 20 * PIXELS);
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_finish(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(ground_begins_at_the_horizon)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
