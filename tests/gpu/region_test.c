/* A small region of cloud is seen from afar, whole, as the CPU's query says that it is. */
#include <math.h>

#include "core/oracle.h"
#include "fixture.h"

enum { WIDTH = 32, HEIGHT = 8, SETTLE = 32 };

static velum_layer cumulus(void) {
    velum_layer layer = fixture_cumulus();
    layer.coverage = 0.9f;
    layer.base_m = 1200.0f;
    layer.top_m = 2600.0f;
    return layer;
}

static velum_layer storm(void) {
    velum_layer layer = fixture_cumulus();
    layer.genus = VELUM_GENUS_CB;
    layer.coverage = 1.0f;
    layer.base_m = 1100.0f;
    layer.top_m = 11000.0f;
    return layer;
}

static void commit_region(fixture *f, const velum_layer *layer, double half_m, double transition_m) {
    const velum_cell cell = {.struct_size = sizeof cell,
                             .flags = VELUM_CELL_HAS_LAYERS,
                             .id = 1,
                             .kind = VELUM_CELL_RECTANGLE,
                             .lat_deg = 50.0,
                             .lon_deg = 8.0,
                             .half_east_m = half_m,
                             .half_north_m = half_m,
                             .transition_m = transition_m,
                             .layers = layer,
                             .layer_count = 1};
    const velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    uint64_t id = 0;
    assert_int_equal(f->world_api->commit(f->world, &state, &id), VELUM_OK);
}

/* So many frames without air; what comes through in the last. */
static void draw(fixture *f, velum_view *view, const velum_view_frame *camera, const double up[3], velum_eye_frame *eye,
                 int frames, float rgb[WIDTH * HEIGHT * 3]) {
    const velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_NONE);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = view,
                                 .frame = camera,
                                 .transmittance_rgb = rgb,
                                 .width = WIDTH,
                                 .height = HEIGHT};
    for (int i = 0; i < frames; i++) {
        assert_int_equal(f->standalone_api->render(f->engine, &frame, eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        eye->flags = 0;
    }
}

/* Rays that run out of steps lose what is behind: what stands here takes no more than these. */
static void draw_with_few_steps(fixture *f, velum_view *view, const velum_view_frame *camera, const double up[3],
                                velum_eye_frame *eye, int frames, float rgb[WIDTH * HEIGHT * 3]) {
    velum_plan plan = {.struct_size = sizeof plan};
    draw(f, view, camera, up, eye, 1, rgb);
    assert_int_equal(f->engine_api->get_plan(eye->eye, &plan, NULL), VELUM_OK);
    plan.march_steps = 224;
    assert_int_equal(f->engine_api->set_plan(eye->eye, &plan), VELUM_OK);
    eye->flags = VELUM_EYE_RESET;
    draw(f, view, camera, up, eye, frames, rgb);
    assert_int_equal(f->engine_api->set_plan(eye->eye, NULL), VELUM_OK);
}

/* Northward on the region from so far south of it, that high: share of the pixels in which picture and query agree on
 * opaque or clear; *cloud: share that the query calls opaque. */
static double agreement(fixture *f, velum_view *view, double half_m, double distance_m, double height_m,
                        double *cloud) {
    double east[3], north[3], up[3];
    double lat_deg = 50.0 - distance_m / 111229.0;
    fixture_axes(lat_deg, 8.0, east, north, up);
    velum_eye_frame eye = {.struct_size = sizeof eye, .flags = VELUM_EYE_RESET, .eye = f->eye};
    fixture_position(lat_deg, 8.0, height_m, eye.position_ecef_m);
    const float tan_x = (float)(1.1 * half_m / distance_m);
    const velum_view_frame camera = fixture_camera(eye.position_ecef_m, north, east, tan_x, tan_x * HEIGHT / WIDTH);
    static float rgb[WIDTH * HEIGHT * 3];
    draw_with_few_steps(f, view, &camera, up, &eye, SETTLE, rgb);
    int sure = 0;
    int alike = 0;
    int opaque = 0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double x = (double)tan_x * (2.0 * (i % WIDTH + 0.5) / WIDTH - 1.0);
        double y = (double)tan_x * HEIGHT / WIDTH * (1.0 - 2.0 * (i / WIDTH + 0.5) / HEIGHT);
        /* The march too goes by distance, however wide the pixels are. */
        velum_line_query line = {.struct_size = sizeof line, .footprint_m = CORE_ORACLE_PIXEL_RAD * distance_m};
        velum_line_answer answer = {.struct_size = sizeof answer};
        for (int k = 0; k < 3; k++) {
            line.from_ecef_m[k] = eye.position_ecef_m[k];
            line.to_ecef_m[k] =
                eye.position_ecef_m[k] + (distance_m + 2.0 * half_m) * (north[k] + x * east[k] + y * up[k]);
        }
        assert_int_equal(f->world_api->query_line(f->world, &line, &answer), VELUM_OK);
        if (answer.optical_depth > 5.0 || answer.optical_depth == 0.0) {
            sure++;
            alike += (answer.optical_depth > 5.0) == (rgb[3 * i] < 0.5f);
            opaque += answer.optical_depth > 5.0;
        }
    }
    *cloud = (double)opaque / (WIDTH * HEIGHT);
    return sure > 0 ? (double)alike / sure : 0.0;
}

static void seen_from_afar(void **state) {
    (void)state;
    static const double halves_m[] = {450.0, 2000.0, 2000.0, 8000.0};
    static const double transitions_m[] = {350.0, 0.0, 2000.0, 4000.0};
    static const double distances_m[] = {3000.0, 12000.0, 28500.0, 45000.0, 90000.0};
    fixture f;
    fixture_borrow(&f);
    velum_view *view = fixture_view(&f, f.eye, WIDTH, HEIGHT);
    const velum_layer heap = cumulus();
    for (int r = 0; r < 4; r++) {
        commit_region(&f, &heap, halves_m[r], transitions_m[r]);
        for (int d = 0; d < 5; d++) {
            if (distances_m[d] < 3.0 * halves_m[r] || halves_m[r] / distances_m[d] < 0.03) {
                continue; /* within it, or of few rays */
            }
            double cloud = 0.0;
            double alike = agreement(&f, view, halves_m[r], distances_m[d], 1900.0, &cloud);
            print_message("region of %g m and %g m of transition from %g m: %.1f %% opaque, %.1f %% alike\n",
                          2.0 * halves_m[r], transitions_m[r], distances_m[d], 100.0 * cloud, 100.0 * alike);
            assert_true(cloud > 0.2);
            assert_true(alike > 0.95);
        }
    }
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_give_back(&f);
}

/* A storm's towers sink from its middle to its edge as fast as walls: rays over the low ones meet the high ones behind.
 */
static void storms_have_all_of_their_tops(void **state) {
    (void)state;
    static const double distances_m[] = {30000.0, 45000.0};
    static const double heights_m[] = {5000.0, 7000.0, 9000.0};
    const double half_m = 1500.0;
    const double transition_m = 4000.0;
    const velum_layer towers = storm();
    fixture f;
    fixture_borrow(&f);
    velum_view *view = fixture_view(&f, f.eye, WIDTH, HEIGHT);
    commit_region(&f, &towers, half_m, transition_m);
    for (int i = 0; i < 6; i++) {
        double cloud = 0.0;
        double alike = agreement(&f, view, 0.4 * transition_m, distances_m[i / 3], heights_m[i % 3], &cloud);
        print_message("storm from %g m, %g m high: %.1f %% opaque, %.1f %% alike\n", distances_m[i / 3],
                      heights_m[i % 3], 100.0 * cloud, 100.0 * alike);
        assert_true(cloud > 0.1);
        assert_true(alike > 0.95);
    }
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    fixture_give_back(&f);
}

/* A low sheet that covers all is seen to the end of every ray at the cheapest preset, whatever other layers a forecast
 * has: these have hardly any cloud here, and somewhere reach from the ground to over the eye. */
static void sheets_hold_under_many_layers(void **state) {
    (void)state;
    static const int32_t genera[] = {VELUM_GENUS_ST, VELUM_GENUS_SC, VELUM_GENUS_CU, VELUM_GENUS_CB, VELUM_GENUS_AC};
    enum { LAYERS = sizeof genera / sizeof genera[0] };
    velum_layer here[LAYERS], there[LAYERS];
    for (int i = 0; i < LAYERS; i++) {
        here[i] = there[i] = fixture_cumulus();
        here[i].genus = there[i].genus = genera[i];
        here[i].coverage = i == 0 ? 1.0f : 0.04f;
        here[i].base_m = i == 0 ? 200.0f : 2600.0f + 100.0f * (float)i;
        here[i].top_m = here[i].base_m + 130.0f;
        there[i].base_m = 60.0f;
        there[i].top_m = 3300.0f;
    }
    velum_cell cells[2] = {fixture_cell(here, LAYERS), fixture_cell(there, LAYERS)};
    cells[1].id = 2;
    cells[1].kind = VELUM_CELL_RECTANGLE;
    cells[1].lat_deg = 49.6;
    cells[1].lon_deg = 8.0;
    cells[1].half_east_m = cells[1].half_north_m = 4000.0;
    cells[1].transition_m = 8000.0;
    fixture f;
    fixture_borrow(&f);
    const velum_state_desc weather = {.struct_size = sizeof weather, .cells = cells, .cell_count = 2};
    uint64_t id = 0;
    assert_int_equal(f.world_api->commit(f.world, &weather, &id), VELUM_OK);
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = VELUM_QUALITY_LOW};
    velum_eye_frame eye = {.struct_size = sizeof eye, .flags = VELUM_EYE_RESET};
    assert_int_equal(f.engine_api->create_eye(f.engine, &desc, &eye.eye), VELUM_OK);
    velum_view *view = fixture_view(&f, eye.eye, WIDTH, HEIGHT);
    double east[3], north[3], up[3], ahead[3];
    fixture_axes(50.0, 8.0, east, north, up);
    fixture_position(50.0, 8.0, 1200.0, eye.position_ecef_m);
    for (int k = 0; k < 3; k++) {
        ahead[k] = cos(0.08) * north[k] - sin(0.08) * up[k];
    }
    const velum_view_frame camera = fixture_camera(eye.position_ecef_m, ahead, east, 0.2f, 0.05f);
    static float rgb[WIDTH * HEIGHT * 3];
    draw_with_few_steps(&f, view, &camera, up, &eye, 2 * SETTLE, rgb);
    double through = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        through += (double)rgb[3 * i] / (WIDTH * HEIGHT);
    }
    print_message("a closed sheet under many layers lets %.4f through at preset low\n", through);
    assert_true(through < 0.02);
    assert_int_equal(f.engine_api->destroy_view(view), VELUM_OK);
    assert_int_equal(f.engine_api->destroy_eye(eye.eye), VELUM_OK);
    fixture_give_back(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(seen_from_afar),
                                       cmocka_unit_test(sheets_hold_under_many_layers),
                                       cmocka_unit_test(storms_have_all_of_their_tops)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
