/* What pictures may not depend on: other views, other engines, the past, the seams of the globe. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fixture.h"

enum { WIDTH = 64, HEIGHT = 48, VIEWS = 3, FRAMES = 5, PIXELS = WIDTH * HEIGHT };

typedef struct picture {
    float light[PIXELS * 3], transmittance[PIXELS * 3], distance[PIXELS];
} picture;

/* Three channels side by side over fair-weather cloud, a moving eye, some frames; of the views in `mask`. */
static void play(fixture *f, velum_engine *engine, uint32_t mask, picture *out) {
    velum_eye *eye = NULL;
    velum_view *views[VIEWS] = {0};
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = VELUM_QUALITY_LOW};
    assert_int_equal(f->engine_api->create_eye(engine, &desc, &eye), VELUM_OK);
    for (uint32_t i = 0; i < VIEWS; i++) {
        if (mask & (1u << i)) {
            views[i] = fixture_view(f, eye, WIDTH, HEIGHT);
        }
    }
    double east[3], north[3], up[3];
    fixture_axes(50.0, 8.5, east, north, up);
    double sun[3];
    for (int i = 0; i < 3; i++) {
        sun[i] = 0.6 * up[i] + 0.8 * east[i];
    }
    for (uint32_t k = 0; k < FRAMES; k++) {
        velum_frame_info frame = fixture_frame(sun, 100.0 + 0.5 * k, VELUM_ATMOSPHERE_EARTH);
        velum_eye_frame at = {.struct_size = sizeof at, .eye = eye};
        fixture_position(50.0 + 0.0001 * k, 8.5, 300.0, at.position_ecef_m);
        velum_view_frame cameras[VIEWS];
        velum_pixels pixels[VIEWS];
        uint32_t count = 0;
        for (uint32_t i = 0; i < VIEWS; i++) {
            if (!(mask & (1u << i))) {
                continue;
            }
            double yaw = 0.7 * ((double)i - 1.0);
            double forward[3], right[3];
            for (int a = 0; a < 3; a++) {
                forward[a] = 0.98 * (cos(yaw) * north[a] + sin(yaw) * east[a]) + sqrt(1.0 - 0.98 * 0.98) * up[a];
                right[a] = cos(yaw) * east[a] - sin(yaw) * north[a];
            }
            cameras[count] = fixture_camera(at.position_ecef_m, forward, right, 0.36f, 0.27f);
            cameras[count].flags = VELUM_VIEW_GROUND | VELUM_VIEW_SUN_DISC;
            pixels[count] = (velum_pixels){.struct_size = sizeof pixels[count],
                                           .view = views[i],
                                           .frame = &cameras[count],
                                           .luminance_rgb = out[i].light,
                                           .transmittance_rgb = out[i].transmittance,
                                           .distance_m = out[i].distance,
                                           .width = WIDTH,
                                           .height = HEIGHT};
            count++;
        }
        assert_int_equal(f->standalone_api->render(engine, &frame, &at, 1, 0, pixels, count, 0), VELUM_OK);
    }
    for (uint32_t i = 0; i < VIEWS; i++) {
        assert_int_equal(f->engine_api->destroy_view(views[i]), VELUM_OK);
    }
    assert_int_equal(f->engine_api->destroy_eye(eye), VELUM_OK);
}

static void expect_cloud(const picture *p) {
    uint32_t covered = 0;
    for (int i = 0; i < PIXELS; i++) {
        for (int c = 0; c < 3; c++) {
            assert_true(isfinite(p->light[3 * i + c]) && p->light[3 * i + c] >= 0.0f);
        }
        covered += p->distance[i] > 0.0f;
    }
    assert_in_range(covered, PIXELS / 20, PIXELS);
}

static void together_as_alone(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, false);
    velum_layer cumulus = fixture_cumulus();
    fixture_commit(&f, &cumulus, 1);
    picture *together = calloc(VIEWS, sizeof *together);
    picture *alone = calloc(VIEWS, sizeof *alone);
    assert_true(together && alone);
    play(&f, f.engine, 7, together);
    for (uint32_t i = 0; i < VIEWS; i++) {
        velum_engine *engine = fixture_engine(&f, false);
        play(&f, engine, 1u << i, alone);
        assert_int_equal(f.engine_api->destroy(engine), VELUM_OK);
        expect_cloud(&together[i]);
    }
    assert_memory_equal(together, alone, VIEWS * sizeof *together);
    free(together);
    free(alone);
    fixture_finish(&f);
}

static void the_same_twice_in_two_worlds(void **state) {
    (void)state;
    fixture a, b;
    fixture_init(&a, false);
    fixture_init(&b, false);
    velum_layer layers[2] = {fixture_cumulus(), fixture_cumulus()};
    layers[1].genus = VELUM_GENUS_CI;
    layers[1].base_m = 8000.0f;
    layers[1].top_m = 9000.0f;
    layers[1].water = VELUM_WATER_ICE;
    layers[1].water_g_m3 = 0.02f;
    layers[1].radius_um = 40.0f;
    fixture_commit(&a, layers, 2);
    fixture_commit(&b, layers, 2);
    picture *one = calloc(VIEWS, sizeof *one);
    picture *two = calloc(VIEWS, sizeof *two);
    assert_true(one && two);
    play(&a, a.engine, 2, one);
    play(&b, b.engine, 2, two);
    expect_cloud(&one[1]);
    assert_memory_equal(one, two, VIEWS * sizeof *one);
    /* Again on the same engine: what it remembers may not be seen. */
    play(&a, a.engine, 2, two);
    assert_memory_equal(one, two, VIEWS * sizeof *one);
    free(one);
    free(two);
    fixture_finish(&b);
    fixture_finish(&a);
}

static void one_picture(fixture *f, const double position[3], const double forward[3], const double right[3],
                        const double sun[3], float tan_half, uint32_t settle, picture *out) {
    velum_view *view = fixture_view(f, f->eye, WIDTH, HEIGHT);
    velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_NONE);
    velum_eye_frame eye = {.struct_size = sizeof eye, .flags = VELUM_EYE_RESET, .eye = f->eye};
    memcpy(eye.position_ecef_m, position, sizeof eye.position_ecef_m);
    velum_view_frame camera = fixture_camera(position, forward, right, tan_half, tan_half * HEIGHT / WIDTH);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = &camera,
                                 .luminance_rgb = out->light,
                                 .transmittance_rgb = out->transmittance,
                                 .distance_m = out->distance,
                                 .width = WIDTH,
                                 .height = HEIGHT};
    for (uint32_t i = 0; i < settle; i++) {
        assert_int_equal(f->standalone_api->render(f->engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        eye.flags = 0;
    }
    assert_int_equal(f->engine_api->destroy_view(view), VELUM_OK);
}

/* Straight down over a place where coordinates meet. */
static void look_down(fixture *f, double lat_deg, double lon_deg, double height_m, float tan_half, uint32_t settle,
                      picture *out) {
    double east[3], north[3], up[3], position[3], down[3];
    fixture_axes(lat_deg, lon_deg, east, north, up);
    fixture_position(lat_deg, lon_deg, height_m, position);
    for (int i = 0; i < 3; i++) {
        down[i] = -up[i];
    }
    one_picture(f, position, down, east, up, tan_half, settle, out);
}

static const double places[][2] = {{90.0, 0.0},    {-90.0, 0.0}, {0.0, 180.0},
                                   {60.0, -180.0}, {0.0, 45.0},  {35.264, 45.0}};
enum { PLACES = 6 };

static void no_seam_in_a_uniform_slab(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer slab = fixture_slab(1.0f);
    fixture_commit(&f, &slab, 1);
    picture *p = calloc(1, sizeof *p);
    assert_non_null(p);
    for (int place = 0; place < PLACES; place++) {
        look_down(&f, places[place][0], places[place][1], 12000.0, 0.5f, 16, p);
        for (int i = 0; i < PIXELS; i++) {
            double x = ((i % WIDTH) + 0.5) / WIDTH * 1.0 - 0.5;
            double y = ((i / WIDTH) + 0.5) / HEIGHT * 0.75 - 0.375;
            double expected = exp(-sqrt(1.0 + x * x + y * y));
            assert_float_equal(p->transmittance[3 * i], expected, 0.01 * expected + 0.002);
        }
    }
    free(p);
    fixture_give_back(&f);
}

/* Over noise a line would show as two neighbouring columns or rows that differ more than all others do. */
static void no_line_in_cloud(void **state) {
    (void)state;
    fixture f;
    fixture_borrow(&f);
    velum_layer cumulus = fixture_cumulus();
    fixture_commit(&f, &cumulus, 1);
    picture *p = calloc(1, sizeof *p);
    assert_non_null(p);
    for (int place = 0; place < PLACES; place++) {
        look_down(&f, places[place][0], places[place][1], 12000.0, 0.9f, 16, p);
        double across[2] = {0.0, 0.0};
        double at_seam[2] = {0.0, 0.0};
        for (int y = 0; y + 1 < HEIGHT; y++) {
            for (int x = 0; x + 1 < WIDTH; x++) {
                int i = y * WIDTH + x;
                double dx = fabs((double)p->transmittance[3 * i] - (double)p->transmittance[3 * (i + 1)]);
                double dy = fabs((double)p->transmittance[3 * i] - (double)p->transmittance[3 * (i + WIDTH)]);
                across[0] += dx / (WIDTH - 1);
                across[1] += dy / (HEIGHT - 1);
                at_seam[0] += x == WIDTH / 2 - 1 ? dx : 0.0;
                at_seam[1] += y == HEIGHT / 2 - 1 ? dy : 0.0;
            }
        }
        expect_cloud(p);
        assert_true(across[0] > 0.1 && across[1] > 0.1);
        assert_true(at_seam[0] < 2.5 * across[0]);
        assert_true(at_seam[1] < 2.5 * across[1]);
    }
    free(p);
    fixture_give_back(&f);
}

static void wind_builds_no_tiles(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, false);
    velum_layer cumulus = fixture_cumulus();
    fixture_commit(&f, &cumulus, 1);
    picture *before = calloc(2, sizeof *before);
    assert_non_null(before);
    double east[3], north[3], up[3];
    fixture_axes(50.0, 8.5, east, north, up);
    velum_view *view = fixture_view(&f, f.eye, WIDTH, HEIGHT);
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = f.eye};
    fixture_position(50.0, 8.5, 300.0, eye.position_ecef_m);
    velum_view_frame camera = fixture_camera(eye.position_ecef_m, up, east, 0.5f, 0.4f);
    uint64_t uploaded = 0;
    velum_world_info info = {.struct_size = sizeof info};
    uint64_t rasterised = 0;
    for (int i = 0; i < 8; i++) {
        velum_frame_info frame = fixture_frame(up, 4.0 * i, VELUM_ATMOSPHERE_NONE);
        const velum_pixels pixels = {.struct_size = sizeof pixels,
                                     .view = view,
                                     .frame = &camera,
                                     .transmittance_rgb = before[i > 0].transmittance,
                                     .width = WIDTH,
                                     .height = HEIGHT};
        assert_int_equal(f.standalone_api->render(f.engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        assert_int_equal(f.world_api->get_info(f.world, &info), VELUM_OK);
        if (i == 0) {
            uploaded = fixture_pages_uploaded(f.engine);
            rasterised = info.tiles_rasterised;
            assert_true(uploaded > 0 && rasterised > 0);
        }
    }
    assert_int_equal(fixture_pages_uploaded(f.engine), uploaded);
    assert_int_equal(info.tiles_rasterised, rasterised);
    assert_memory_not_equal(before[0].transmittance, before[1].transmittance, sizeof before[0].transmittance);
    free(before);
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_finish(&f);
}

/* Over a front with an edge: wherever the eye goes, all tiles are there, and what was sent stays. */
static void flight_stays_whole(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, false);
    velum_layer cumulus = fixture_cumulus();
    const velum_cell cell = {.struct_size = sizeof cell,
                             .flags = VELUM_CELL_HAS_LAYERS,
                             .id = 5,
                             .kind = VELUM_CELL_RECTANGLE,
                             .lat_deg = 50.0,
                             .lon_deg = 8.5,
                             .half_east_m = 60000.0,
                             .half_north_m = 30000.0,
                             .transition_m = 1000.0,
                             .layers = &cumulus,
                             .layer_count = 1};
    const velum_state_desc desc = {.struct_size = sizeof desc, .cells = &cell, .cell_count = 1};
    uint64_t id = 0;
    assert_int_equal(f.world_api->commit(f.world, &desc, &id), VELUM_OK);
    picture *p = calloc(1, sizeof *p);
    assert_non_null(p);
    uint64_t uploads[2] = {0, 0};
    velum_view_stats stats = {.struct_size = sizeof stats};
    velum_view *view = fixture_view(&f, f.eye, WIDTH, HEIGHT);
    double east[3], north[3], up[3];
    fixture_axes(50.0, 8.5, east, north, up);
    for (int i = 0; i < 30; i++) {
        velum_frame_info frame = fixture_frame(up, 1.0 * i, VELUM_ATMOSPHERE_NONE);
        velum_eye_frame eye = {.struct_size = sizeof eye, .eye = f.eye};
        fixture_position(50.0, 8.5 + 0.004 * i, 300.0, eye.position_ecef_m);
        velum_view_frame camera = fixture_camera(eye.position_ecef_m, north, east, 0.5f, 0.4f);
        const velum_pixels pixels = {.struct_size = sizeof pixels,
                                     .view = view,
                                     .frame = &camera,
                                     .transmittance_rgb = p->transmittance,
                                     .distance_m = p->distance,
                                     .width = WIDTH,
                                     .height = HEIGHT};
        assert_int_equal(f.standalone_api->render(f.engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        assert_int_equal(f.engine_api->get_stats(view, &stats), VELUM_OK);
        assert_int_equal(stats.incomplete, 0);
        uploads[i > 0] = fixture_pages_uploaded(f.engine);
    }
    /* 8.6 km of flight send a part of what the place took. */
    assert_true(uploads[0] > 20);
    assert_true(uploads[1] - uploads[0] < uploads[0]);
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    free(p);
    fixture_finish(&f);
}

/* A commit that leaves a place as it was sends nothing there. */
static void equal_states_share_pages(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, false);
    velum_layer cumulus = fixture_cumulus();
    picture *p = calloc(1, sizeof *p);
    assert_non_null(p);
    fixture_commit(&f, &cumulus, 1);
    look_down(&f, 45.0, 7.0, 8000.0, 0.5f, 1, p);
    uint64_t uploaded = fixture_pages_uploaded(f.engine);
    assert_true(uploaded > 0);
    fixture_commit(&f, &cumulus, 1);
    look_down(&f, 45.0, 7.0, 8000.0, 0.5f, 1, p);
    assert_int_equal(fixture_pages_uploaded(f.engine), uploaded);
    free(p);
    fixture_finish(&f);
}

static void memory_is_within_bounds(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, false);
    velum_view *handle = fixture_view(&f, f.eye, 1920, 1080);
    assert_in_range(fixture_weather_bytes(f.engine), 1 << 20, 64000000);
    assert_in_range(fixture_view_bytes(handle), 1 << 20, 64000000);
    assert_int_equal(f.engine_api->destroy_view(handle), VELUM_OK);
    fixture_finish(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(memory_is_within_bounds),
                                       cmocka_unit_test(together_as_alone),
                                       cmocka_unit_test(the_same_twice_in_two_worlds),
                                       cmocka_unit_test(no_seam_in_a_uniform_slab),
                                       cmocka_unit_test(no_line_in_cloud),
                                       cmocka_unit_test(wind_builds_no_tiles),
                                       cmocka_unit_test(equal_states_share_pages),
                                       cmocka_unit_test(flight_stays_whole)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
