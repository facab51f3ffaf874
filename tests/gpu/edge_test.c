/* The edge of a region is rendered where GeographicLib puts it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/geodesy.h"
#include "fixture.h"

enum { WIDTH = 256, HEIGHT = 4, SETTLE = 16 };
static const double half_m = 100000.0;
static const double wide_m = 512.0; /* pixels of 2 m */
static const double bound_m = 10.0;

/* A rectangle that is a sharp slab; of corner radius half_m it is a disc. */
static void commit_region(fixture *f, double lat_deg, double lon_deg, double corner_m, double rotation_deg) {
    const velum_layer slab = fixture_slab(4.0f);
    const velum_cell cell = {.struct_size = sizeof cell,
                             .flags = VELUM_CELL_HAS_LAYERS,
                             .id = 1,
                             .kind = VELUM_CELL_RECTANGLE,
                             .lat_deg = lat_deg,
                             .lon_deg = lon_deg,
                             .half_east_m = half_m,
                             .half_north_m = half_m,
                             .corner_radius_m = corner_m,
                             .rotation_deg = rotation_deg,
                             .layers = &slab,
                             .layer_count = 1};
    const velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    uint64_t id = 0;
    assert_int_equal(f->world_api->commit(f->world, &state, &id), VELUM_OK);
}

/* Straight down on the point at that azimuth and distance from the centre, the outward geodesic to the right: metres
 * from the point to where the slab ends, positive outward. */
static double edge_offset(fixture *f, velum_view *view, double lat_deg, double lon_deg, double azimuth_deg,
                          double distance_m) {
    double lat, lon, back_deg, length_m;
    assert_true(core_geodesic_direct(lat_deg, lon_deg, azimuth_deg, distance_m, &lat, &lon));
    assert_true(core_geodesic_inverse(lat, lon, lat_deg, lon_deg, &length_m, &back_deg));
    assert_float_equal(length_m, distance_m, 1e-3);
    const double out = (back_deg + 180.0) * CORE_DEG;
    double east[3], north[3], up[3], outward[3], down[3];
    fixture_axes(lat, lon, east, north, up);
    for (int i = 0; i < 3; i++) {
        outward[i] = sin(out) * east[i] + cos(out) * north[i];
        down[i] = -up[i];
    }
    velum_eye_frame eye = {.struct_size = sizeof eye, .flags = VELUM_EYE_RESET, .eye = f->eye};
    fixture_position(lat, lon, 3000.0, eye.position_ecef_m);
    velum_view_frame camera = fixture_camera(eye.position_ecef_m, down, outward, 1.0f, 1.0f);
    camera.flags = VELUM_VIEW_ORTHOGRAPHIC;
    camera.tan_right = (float)(0.5 * wide_m);
    camera.tan_left = -camera.tan_right;
    camera.tan_top = (float)(0.5 * wide_m * HEIGHT / WIDTH);
    camera.tan_bottom = -camera.tan_top;
    const velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_NONE);
    static float rgb[WIDTH * HEIGHT * 3];
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &camera,
                                 .transmittance_rgb = rgb,
                                 .width = WIDTH,
                                 .height = HEIGHT};
    for (int i = 0; i < SETTLE; i++) {
        assert_int_equal(f->standalone_api->render(f->engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        eye.flags = 0;
    }
    /* Cloud at the left, clear at the right, one step between: its place is the share of cloud. */
    const float *row = rgb + 3 * WIDTH * (HEIGHT / 2);
    assert_float_equal(row[0], exp(-4.0), 0.01 * exp(-4.0) + 0.002);
    assert_float_equal(row[3 * (WIDTH - 1)], 1.0, 1e-6);
    int steps = 0;
    double at = NAN;
    for (int x = 1; x < WIDTH; x++) {
        bool cloud = row[3 * x - 3] < 0.5f;
        if (cloud != (row[3 * x] < 0.5f)) {
            steps++;
            at = ((double)x / WIDTH - 0.5) * wide_m;
        }
    }
    assert_int_equal(steps, 1);
    return at;
}

static void expect_edges(double lat_deg, double lon_deg, bool disc, double rotation_deg) {
    static const double azimuths_deg[] = {0.0, 20.0, 70.0, 90.0, 155.0, 180.0, 230.0, 270.0, 300.0};
    fixture f;
    fixture_borrow(&f);
    velum_view *view = fixture_view(&f, f.eye, WIDTH, HEIGHT);
    commit_region(&f, lat_deg, lon_deg, disc ? half_m : 0.0, rotation_deg);
    double worst_m = 0.0;
    for (size_t i = 0; i < sizeof azimuths_deg / sizeof azimuths_deg[0]; i++) {
        /* In the rectangle's own axes: where the geodesic from the centre meets its side. */
        double own = (azimuths_deg[i] - rotation_deg) * CORE_DEG;
        double distance_m = disc ? half_m : half_m / fmax(fabs(sin(own)), fabs(cos(own)));
        double offset_m = edge_offset(&f, view, lat_deg, lon_deg, azimuths_deg[i], distance_m);
        if (!(fabs(offset_m) <= bound_m)) {
            print_message("edge of %g, %g at azimuth %g: %.1f m off\n", lat_deg, lon_deg, azimuths_deg[i], offset_m);
        }
        assert_true(fabs(offset_m) <= bound_m);
        worst_m = fmax(worst_m, fabs(offset_m));
        /* The measure itself: from elsewhere on the geodesic the edge stands elsewhere in the picture. */
        offset_m = edge_offset(&f, view, lat_deg, lon_deg, azimuths_deg[i], distance_m - 140.0);
        assert_float_equal(offset_m, 140.0, bound_m);
    }
    print_message("%g, %g: worst edge %.1f m off\n", lat_deg, lon_deg, worst_m);
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_give_back(&f);
}

static void of_a_disc(void **state) {
    (void)state;
    expect_edges(50.0, 8.5, true, 0.0);
}

static void of_a_square(void **state) {
    (void)state;
    expect_edges(50.0, 8.5, false, 0.0);
}

static void of_a_turned_square(void **state) {
    (void)state;
    expect_edges(-33.9, 151.2, false, 30.0);
}

static void over_the_antimeridian(void **state) {
    (void)state;
    expect_edges(-17.0, 179.9, false, 0.0);
    expect_edges(52.0, -179.7, true, 0.0);
}

static void far_north(void **state) {
    (void)state;
    expect_edges(80.0, 100.0, false, 0.0);
    expect_edges(80.0, 100.0, true, 0.0);
}

/* The disc holds the pole. */
static void round_a_pole(void **state) {
    (void)state;
    expect_edges(89.5, 20.0, true, 0.0);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(of_a_disc),          cmocka_unit_test(of_a_square),
                                       cmocka_unit_test(of_a_turned_square), cmocka_unit_test(over_the_antimeridian),
                                       cmocka_unit_test(far_north),          cmocka_unit_test(round_a_pole)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
