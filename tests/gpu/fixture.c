#include "fixture.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "asked_device.h"
#include "core/geodesy.h"

void fixture_log(void *context, int32_t severity, const char *object, const char *message) {
    fixture *f = context;
    if (strcmp(object, "validation") == 0) {
        f->validation++;
        print_message("%s: %s\n", object, message);
    } else if (severity >= VELUM_LOG_ERROR) {
        f->errors++;
        snprintf(f->newest, sizeof f->newest, "%s: %s", object, message);
    }
}

void fixture_tables(fixture *f) {
    *f = (fixture){0};
    const velum_host_info host = {.struct_size = sizeof host, .abi_min = 1, .abi_max = 1};
    velum_plugin_info info = {.struct_size = sizeof info};
    assert_int_equal(velum_negotiate(&host, &info), VELUM_OK);
    f->world_api = info.get_table(VELUM_WORLD_API_ID);
    f->engine_api = info.get_table(VELUM_ENGINE_API_ID);
    f->standalone_api = info.get_table(VELUM_STANDALONE_API_ID);
    assert_non_null(f->world_api);
    assert_non_null(f->engine_api);
    assert_non_null(f->standalone_api);
}

int32_t fixture_device(void) {
    int32_t index;
    if (!asked_device(&index)) {
        fail_msg("VELUM_TEST_DEVICE: expected the index of a device");
    }
    return index < 0 ? VELUM_DEVICE_CPU : index;
}

velum_engine *fixture_engine(fixture *f, bool validate) {
    velum_engine *engine = NULL;
    const velum_standalone_desc desc = {.struct_size = sizeof desc,
                                        .flags = validate ? VELUM_STANDALONE_VALIDATE : 0,
                                        .world = f->world,
                                        .log = fixture_log,
                                        .log_context = f,
                                        .device = fixture_device()};
    velum_result result = f->standalone_api->create_engine(&desc, &engine);
    if (result == VELUM_ERROR_UNSUPPORTED && desc.device == VELUM_DEVICE_CPU) {
        f->world_api->destroy(f->world);
        print_message("skipped: no Vulkan device: %s\n", f->newest);
        skip();
    }
    assert_int_equal(result, VELUM_OK);
    return engine;
}

void fixture_init(fixture *f, bool validate) {
    fixture_tables(f);
    const velum_world_desc world = {.struct_size = sizeof world, .seed = 7, .log = fixture_log, .log_context = f};
    assert_int_equal(f->world_api->create(&world, &f->world), VELUM_OK);
    f->engine = fixture_engine(f, validate);
    const velum_eye_desc eye = {.struct_size = sizeof eye};
    assert_int_equal(f->engine_api->create_eye(f->engine, &eye, &f->eye), VELUM_OK);
}

void fixture_finish(fixture *f) {
    assert_int_equal(f->engine_api->destroy_eye(f->eye), VELUM_OK);
    assert_int_equal(f->engine_api->destroy(f->engine), VELUM_OK);
    assert_int_equal(f->world_api->destroy(f->world), VELUM_OK);
    assert_int_equal(f->validation, 0);
}

static fixture shared;

void fixture_borrow(fixture *f) {
    if (!shared.engine) {
        fixture_init(&shared, false);
        assert_int_equal(shared.engine_api->destroy_eye(shared.eye), VELUM_OK);
    }
    *f = shared;
    assert_int_equal(f->world_api->set_timeline(f->world, NULL, 0, 0), VELUM_OK);
    const velum_eye_desc eye = {.struct_size = sizeof eye};
    assert_int_equal(f->engine_api->create_eye(f->engine, &eye, &f->eye), VELUM_OK);
}

void fixture_give_back(fixture *f) {
    assert_int_equal(f->engine_api->destroy_eye(f->eye), VELUM_OK);
    assert_true(fixture_is_bare(f->engine));
    assert_int_equal(shared.validation, 0);
    shared.state = f->state;
}

int fixture_shared_finish(void **state) {
    (void)state;
    if (shared.engine) {
        assert_int_equal(shared.engine_api->destroy(shared.engine), VELUM_OK);
        assert_int_equal(shared.world_api->destroy(shared.world), VELUM_OK);
        shared = (fixture){0};
    }
    return 0;
}

velum_cell fixture_cell(const velum_layer *layers, uint32_t count) {
    return (velum_cell){.struct_size = sizeof(velum_cell),
                        .flags = VELUM_CELL_HAS_LAYERS,
                        .id = 1,
                        .kind = VELUM_CELL_GLOBAL,
                        .layers = layers,
                        .layer_count = count};
}

void fixture_commit(fixture *f, const velum_layer *layers, uint32_t count) {
    const velum_cell cell = fixture_cell(layers, count);
    fixture_commit_cell(f, &cell);
}

void fixture_commit_cell(fixture *f, const velum_cell *cell) {
    const velum_state_desc state = {.struct_size = sizeof state, .cells = cell, .cell_count = 1};
    uint64_t before = f->state;
    assert_int_equal(f->world_api->commit(f->world, &state, &f->state), VELUM_OK);
    if (before) {
        f->world_api->retire(f->world, before);
    }
}

velum_layer fixture_slab(float tau) {
    return (velum_layer){.struct_size = sizeof(velum_layer),
                         .flags = VELUM_LAYER_UNIFORM | VELUM_LAYER_EXTINCTION,
                         .genus = VELUM_GENUS_ST,
                         .coverage = 1.0f,
                         .base_m = 1000.0f,
                         .top_m = 2000.0f,
                         .extinction_1_m = tau / 1000.0f};
}

velum_layer fixture_cumulus(void) {
    return (velum_layer){.struct_size = sizeof(velum_layer),
                         .genus = VELUM_GENUS_CU,
                         .coverage = 0.4f,
                         .base_m = 1000.0f,
                         .top_m = 2200.0f,
                         .water_g_m3 = 0.4f,
                         .radius_um = 10.0f,
                         .wind_east_m_s = 12.0f};
}

velum_layer fixture_layer(int32_t genus, float coverage, float base_m, float top_m) {
    velum_layer layer = fixture_cumulus();
    layer.genus = genus;
    layer.coverage = coverage;
    layer.base_m = base_m;
    layer.top_m = top_m;
    return layer;
}

void fixture_position(double lat_deg, double lon_deg, double height_m, double ecef_m[3]) {
    const core_geodetic place = {lat_deg, lon_deg, height_m};
    assert_true(core_ecef_from_geodetic(&place, ecef_m));
}

void fixture_axes(double lat_deg, double lon_deg, double east[3], double north[3], double up[3]) {
    core_normal(lat_deg, lon_deg, up);
    core_east_north(up, east, north);
}

velum_frame_info fixture_frame(const double sun[3], double time_s, int32_t atmosphere) {
    velum_frame_info frame = {.struct_size = sizeof frame,
                              .time_s = time_s,
                              .sun_illuminance_lx = {1.0f, 1.0f, 1.0f},
                              .atmosphere = atmosphere};
    if (atmosphere == VELUM_ATMOSPHERE_EARTH) {
        for (int i = 0; i < 3; i++) {
            frame.sun_illuminance_lx[i] = 128000.0f;
            frame.ground_albedo[i] = 0.1f;
        }
    }
    memcpy(frame.sun_direction_ecef, sun, sizeof frame.sun_direction_ecef);
    return frame;
}

velum_view_frame fixture_camera(const double position[3], const double forward[3], const double right[3], float tan_x,
                                float tan_y) {
    velum_view_frame camera = {
        .struct_size = sizeof camera, .tan_left = -tan_x, .tan_right = tan_x, .tan_bottom = -tan_y, .tan_top = tan_y};
    memcpy(camera.position_ecef_m, position, sizeof camera.position_ecef_m);
    memcpy(camera.forward_ecef, forward, sizeof camera.forward_ecef);
    memcpy(camera.right_ecef, right, sizeof camera.right_ecef);
    camera.up_ecef[0] = right[1] * forward[2] - right[2] * forward[1];
    camera.up_ecef[1] = right[2] * forward[0] - right[0] * forward[2];
    camera.up_ecef[2] = right[0] * forward[1] - right[1] * forward[0];
    return camera;
}

velum_view *fixture_view(fixture *f, velum_eye *eye, uint32_t width, uint32_t height) {
    velum_view *view = NULL;
    const velum_view_desc desc = {.struct_size = sizeof desc, .width = width, .height = height, .name = "test"};
    assert_int_equal(f->engine_api->create_view(eye, &desc, &view), VELUM_OK);
    return view;
}
