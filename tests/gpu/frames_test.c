/* Frames on a lent device: order, serials, lifetimes, and what the validation layers say. */
#include <pthread.h>
#include <stdlib.h>
#include <string.h>

#include "lent.h"

enum { WIDTH = 48, HEIGHT = 40 };

typedef struct host {
    uint32_t turns;
    fixture f;
    const velum_vulkan_api *api;
    lent *l;
    velum_engine *engine;
    velum_eye *eye;
    velum_view *views[2];
    velum_shadow *shadow;
    velum_frame_info frame;
    velum_eye_frame at;
    velum_view_frame camera;
    velum_shadow_frame centre;
} host;

static bool has_validation(void) {
    static int known = -1; /* an engine takes a second or two */
    if (known >= 0) {
        return known;
    }
    fixture f;
    fixture_tables(&f);
    const velum_world_desc world = {.struct_size = sizeof world};
    velum_engine *engine = NULL;
    assert_int_equal(f.world_api->create(&world, &f.world), VELUM_OK);
    const velum_standalone_desc desc = {
        .struct_size = sizeof desc, .flags = VELUM_STANDALONE_VALIDATE, .world = f.world, .device = fixture_device()};
    velum_result result = f.standalone_api->create_engine(&desc, &engine);
    f.engine_api->destroy(engine);
    f.world_api->destroy(f.world);
    known = result == VELUM_OK;
    return known;
}

static void host_init_turns(host *h, uint32_t turns) {
    *h = (host){.turns = turns};
    bool validate = has_validation();
    if (!validate) {
        print_message("without validation layers: VK_LAYER_KHRONOS_validation is not installed, or no device\n");
    }
    fixture_init(&h->f, validate);
    velum_layer cumulus = fixture_cumulus();
    fixture_commit(&h->f, &cumulus, 1);
    const velum_host_info info = {.struct_size = sizeof info, .abi_min = 1, .abi_max = 1};
    velum_plugin_info plugin = {.struct_size = sizeof plugin};
    assert_int_equal(velum_negotiate(&info, &plugin), VELUM_OK);
    h->api = plugin.get_table(VELUM_VULKAN_API_ID);
    assert_non_null(h->api);
    h->l = lent_create(&h->f, turns, WIDTH, HEIGHT);
    velum_vulkan_lend lend = lent_desc(h->l);
    assert_int_equal(h->api->create_engine(&lend, &h->engine), VELUM_OK);
    const velum_eye_desc eye = {.struct_size = sizeof eye, .quality = VELUM_QUALITY_LOW};
    assert_int_equal(h->f.engine_api->create_eye(h->engine, &eye, &h->eye), VELUM_OK);
    h->views[0] = fixture_view(&h->f, h->eye, WIDTH, HEIGHT);
    h->views[1] = fixture_view(&h->f, h->eye, WIDTH, HEIGHT);
    const velum_shadow_desc shadow = {.struct_size = sizeof shadow, .levels = 2, .texels = 64};
    assert_int_equal(h->f.engine_api->create_shadow(h->engine, &shadow, &h->shadow), VELUM_OK);
    double east[3], north[3], up[3];
    fixture_axes(47.0, 11.0, east, north, up);
    h->at = (velum_eye_frame){.struct_size = sizeof h->at, .eye = h->eye};
    fixture_position(47.0, 11.0, 600.0, h->at.position_ecef_m);
    h->camera = fixture_camera(h->at.position_ecef_m, north, east, 0.5f, 0.4f);
    h->frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_EARTH);
    h->centre = (velum_shadow_frame){.struct_size = sizeof h->centre};
    memcpy(h->centre.centre_ecef_m, h->at.position_ecef_m, sizeof h->centre.centre_ecef_m);
}

static void host_init(host *h) {
    host_init_turns(h, 2);
}

static void host_finish(host *h) {
    lent_wait(h->l);
    assert_int_equal(h->f.engine_api->complete(h->engine, h->frame.submit_serial), VELUM_OK);
    assert_int_equal(h->f.engine_api->destroy_shadow(h->shadow), VELUM_OK);
    assert_int_equal(h->f.engine_api->destroy_view(h->views[1]), VELUM_OK);
    assert_int_equal(h->f.engine_api->destroy_view(h->views[0]), VELUM_OK);
    assert_int_equal(h->f.engine_api->destroy_eye(h->eye), VELUM_OK);
    assert_int_equal(h->f.engine_api->destroy(h->engine), VELUM_OK);
    lent_destroy(h->l);
    fixture_finish(&h->f);
}

static velum_result begin(host *h) {
    h->frame.submit_serial++;
    h->frame.completed_serial = h->frame.submit_serial > h->turns ? h->frame.submit_serial - h->turns : 0;
    return h->f.engine_api->begin_frame(h->engine, &h->frame);
}

/* A whole frame; the result of record_shared. */
static velum_result whole_frame(host *h) {
    uint32_t turn = (uint32_t)(h->frame.submit_serial % h->turns);
    VkCommandBuffer commands = lent_begin(h->l, turn);
    assert_int_equal(begin(h), VELUM_OK);
    velum_result shared = h->api->record_shared(h->engine, commands, &h->at, 1, sizeof h->at);
    assert_true(shared >= 0);
    lent_barrier(h->l, commands);
    velum_result shadow = h->api->record_shadow(h->shadow, commands, &h->centre);
    assert_true(shadow >= 0);
    for (uint32_t i = 0; i < 2; i++) {
        velum_vulkan_images images = lent_images(h->l, commands, i);
        h->camera.array_layer = i;
        assert_true(h->api->record_view(h->views[i], commands, &h->camera, &images) >= 0);
    }
    assert_int_equal(h->f.engine_api->end_frame(h->engine), VELUM_OK);
    lent_submit(h->l, turn);
    return shared;
}

/* Each frame's share of the stage is smaller than what the first one sends. */
static void four_frames_in_flight_run(void **state) {
    (void)state;
    host h;
    host_init_turns(&h, 4);
    for (int i = 0; i < 6; i++) {
        whole_frame(&h);
    }
    assert_int_equal(h.f.errors, 0);
    host_finish(&h);
}

static void runs_in_silence(void **state) {
    (void)state;
    host h;
    host_init(&h);
    velum_view_stats stats = {.struct_size = sizeof stats};
    assert_int_equal(h.f.engine_api->get_stats(h.views[0], &stats), VELUM_UNCHANGED);
    velum_result shared = VELUM_INCOMPLETE;
    h.camera.flags |= VELUM_VIEW_GROUND;
    for (int i = 0; i < 24; i++) {
        h.frame.time_s = 1.0 * i;
        shared = whole_frame(&h);
    }
    assert_int_equal(shared, VELUM_OK);
    assert_int_equal(h.f.errors, 0);
    assert_int_equal(h.f.engine_api->get_stats(h.views[0], &stats), VELUM_OK);
    assert_true(stats.frame >= 20 && stats.frame < 24);
    /* And as many more as a moving sky may have. */
    assert_in_range(stats.rays, (WIDTH / 4) * (HEIGHT / 4), (WIDTH / 4) * (HEIGHT / 4) * 5 / 3);
    assert_true(stats.samples > 0);
    assert_int_equal(stats.incomplete, 0);
    assert_true(stats.weather_bytes > 0 && stats.view_bytes > 0);
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    assert_int_equal(h.f.engine_api->get_plan(h.eye, &plan, &reasons), VELUM_OK);
    assert_non_null(strstr(reasons, "quality low"));
    assert_int_equal(plan.active_layers, 4);
    /* Standing: tiles grow calm, history is kept, and moved now and then; at rest it is kept too. */
    const double stood_s = h.frame.time_s;
    for (int i = 0; i < 130; i++) {
        h.frame.time_s = stood_s + (i < 110 ? i : 110) / 60.0;
        whole_frame(&h);
        if (i == 110) {
            assert_int_equal(h.f.engine_api->get_stats(h.views[0], &stats), VELUM_OK);
            assert_true(stats.rays < (WIDTH / 4) * (HEIGHT / 4));
        }
    }
    /* Other rates of rays, imposed. */
    static const uint32_t rates[] = {4, 1, 64, 8, 32, 16};
    for (int i = 0; i < 6; i++) {
        plan.ray_rate = rates[i];
        assert_int_equal(h.f.engine_api->set_plan(h.eye, &plan), VELUM_OK);
        for (int k = 0; k < 3; k++) {
            whole_frame(&h);
        }
    }
    host_finish(&h);
}

static void refuses_the_wrong_order(void **state) {
    (void)state;
    host h;
    host_init(&h);
    const velum_engine_api *api = h.f.engine_api;
    VkCommandBuffer commands = lent_begin(h.l, 0);
    velum_vulkan_images images = lent_images(h.l, commands, 0);
    assert_int_equal(api->end_frame(h.engine), VELUM_ERROR_STATE);
    assert_int_equal(h.api->record_shared(h.engine, commands, &h.at, 1, 0), VELUM_ERROR_STATE);
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &images), VELUM_ERROR_STATE);
    assert_int_equal(h.api->record_shadow(h.shadow, commands, &h.centre), VELUM_ERROR_STATE);
    velum_shadow_geometry geometry = {.struct_size = sizeof geometry};
    assert_int_equal(api->get_shadow_geometry(h.shadow, &geometry), VELUM_ERROR_STATE);
    assert_int_equal(begin(&h), VELUM_OK);
    assert_int_equal(api->begin_frame(h.engine, &h.frame), VELUM_ERROR_STATE);
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &images), VELUM_ERROR_STATE);
    velum_eye_frame twice[2] = {h.at, h.at};
    assert_int_equal(h.api->record_shared(h.engine, commands, twice, 2, 0), VELUM_ERROR_ARGUMENT);
    h.at.flags = 8;
    assert_int_equal(h.api->record_shared(h.engine, commands, &h.at, 1, 0), VELUM_ERROR_FLAGS);
    h.at.flags = 0;
    assert_true(h.api->record_shared(h.engine, commands, &h.at, 1, 0) >= 0);
    assert_int_equal(h.api->record_shared(h.engine, commands, &h.at, 1, 0), VELUM_ERROR_STATE);
    assert_true(h.api->record_view(h.views[0], commands, &h.camera, &images) >= 0);
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &images), VELUM_ERROR_STATE);
    assert_int_equal(api->destroy_view(h.views[1]), VELUM_ERROR_STATE);
    assert_int_equal(api->destroy(h.engine), VELUM_ERROR_STATE);
    assert_int_equal(api->complete(h.engine, 1), VELUM_ERROR_STATE);
    assert_int_equal(api->end_frame(h.engine), VELUM_OK);
    lent_submit(h.l, 0);
    assert_int_equal(h.f.errors, 14);
    host_finish(&h);
}

static void refuses_bad_serials(void **state) {
    (void)state;
    host h;
    host_init(&h);
    const velum_engine_api *api = h.f.engine_api;
    velum_frame_info f = h.frame;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_ERROR_ARGUMENT); /* serial 0 */
    f.submit_serial = f.completed_serial = 5;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_ERROR_ARGUMENT);
    f.completed_serial = 4;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_OK);
    assert_int_equal(api->end_frame(h.engine), VELUM_OK);
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_ERROR_ARGUMENT); /* the same again */
    f.submit_serial = 6;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_OK);
    assert_int_equal(api->end_frame(h.engine), VELUM_OK);
    f.submit_serial = 7;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_ERROR_STATE); /* a third in flight */
    f.completed_serial = 3;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_ERROR_ARGUMENT); /* completion goes back */
    f.completed_serial = 5;
    assert_int_equal(api->begin_frame(h.engine, &f), VELUM_OK);
    assert_int_equal(api->end_frame(h.engine), VELUM_OK);
    h.frame.submit_serial = 7;
    host_finish(&h);
}

static void objects_outlive_their_handles(void **state) {
    (void)state;
    host h;
    host_init(&h);
    const velum_engine_api *api = h.f.engine_api;
    whole_frame(&h);
    whole_frame(&h);
    /* Both frames are in flight. */
    assert_int_equal(api->destroy(h.engine), VELUM_ERROR_STATE);
    assert_int_equal(h.f.world_api->destroy(h.f.world), VELUM_ERROR_STATE);
    assert_int_equal(api->destroy_eye(h.eye), VELUM_ERROR_STATE); /* has views */
    assert_int_equal(api->destroy_view(h.views[0]), VELUM_OK);
    uint32_t errors = h.f.errors;
    assert_int_equal(api->destroy_view(h.views[0]), VELUM_ERROR_HANDLE);
    assert_int_equal(h.f.errors, errors + 1);
    assert_int_equal(api->destroy_shadow(h.shadow), VELUM_OK);
    assert_int_equal(api->destroy_shadow(h.shadow), VELUM_ERROR_HANDLE);
    h.views[0] = fixture_view(&h.f, h.eye, WIDTH, HEIGHT);
    const velum_shadow_desc shadow = {.struct_size = sizeof shadow, .levels = 1, .texels = 64};
    assert_int_equal(api->create_shadow(h.engine, &shadow, &h.shadow), VELUM_OK);
    int foreign = 0;
    assert_int_equal(api->destroy_view((velum_view *)(void *)&foreign), VELUM_ERROR_HANDLE);
    assert_int_equal(api->destroy_eye((velum_eye *)(void *)h.views[0]), VELUM_ERROR_HANDLE);
    assert_int_equal(api->destroy_view(NULL), VELUM_OK);
    assert_int_equal(api->get_volume(h.views[0], NULL), VELUM_ERROR_UNSUPPORTED);
    whole_frame(&h);
    /* An engine that is destroyed with frames in flight stays. */
    assert_int_equal(api->destroy(h.engine), VELUM_ERROR_STATE);
    host_finish(&h);
    assert_int_equal(api->destroy(h.engine), VELUM_ERROR_HANDLE);
}

static void refuses_bad_cameras(void **state) {
    (void)state;
    host h;
    host_init(&h);
    VkCommandBuffer commands = lent_begin(h.l, 0);
    velum_vulkan_images images = lent_images(h.l, commands, 0);
    assert_int_equal(begin(&h), VELUM_OK);
    assert_true(h.api->record_shared(h.engine, commands, &h.at, 1, 0) >= 0);
    velum_view_frame c = h.camera;
    c.struct_size = 100;
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_STRUCT_SIZE);
    c = h.camera;
    c.flags = 0x100;
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_FLAGS);
    c = h.camera;
    c.tan_left = 0.0f / (c.tan_left - c.tan_left + 0.0f);
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    c = h.camera;
    c.tan_left = c.tan_right;
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    c = h.camera;
    memcpy(c.up_ecef, c.right_ecef, sizeof c.up_ecef);
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    c = h.camera;
    for (int i = 0; i < 3; i++) {
        c.right_ecef[i] = -c.right_ecef[i];
    }
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    c = h.camera;
    c.position_ecef_m[0] += 20000.0;
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    c = h.camera;
    c.x = 1;
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    c = h.camera;
    c.array_layer = 2;
    assert_int_equal(h.api->record_view(h.views[0], commands, &c, &images), VELUM_ERROR_ARGUMENT);
    velum_vulkan_images bad = images;
    bad.format = VK_FORMAT_R8G8B8A8_UNORM;
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &bad), VELUM_ERROR_ARGUMENT);
    bad = images;
    bad.luminance = VK_NULL_HANDLE;
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &bad), VELUM_ERROR_ARGUMENT);
    assert_int_equal(h.f.errors, 11);
    /* After all that, the good one. */
    assert_true(h.api->record_view(h.views[0], commands, &h.camera, &images) >= 0);
    assert_int_equal(h.f.engine_api->end_frame(h.engine), VELUM_OK);
    lent_submit(h.l, 0);
    host_finish(&h);
}

/* A host that prepares: frames rasterise nothing, say what is missing, and are whole once it is there. */
static void prepare_makes_frames_whole(void **state) {
    (void)state;
    host h;
    host_init(&h);
    velum_prepare_eye eye = {.struct_size = sizeof eye};
    memcpy(eye.position_ecef_m, h.at.position_ecef_m, sizeof eye.position_ecef_m);
    velum_prepare_info info = {.struct_size = sizeof info, .eyes = &eye, .eye_count = 1, .max_tiles = 1};
    velum_world_info before = {.struct_size = sizeof before};
    velum_world_info after = {.struct_size = sizeof after};
    assert_int_equal(h.f.world_api->prepare(h.f.world, &info), VELUM_INCOMPLETE);
    assert_int_equal(h.f.world_api->get_info(h.f.world, &before), VELUM_OK);
    assert_int_equal(before.tiles_rasterised, 1);
    VkCommandBuffer commands = lent_begin(h.l, 0);
    assert_int_equal(begin(&h), VELUM_OK);
    assert_int_equal(h.api->record_shared(h.engine, commands, &h.at, 1, 0), VELUM_INCOMPLETE);
    velum_vulkan_images images = lent_images(h.l, commands, 0);
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &images), VELUM_INCOMPLETE);
    assert_int_equal(h.f.engine_api->end_frame(h.engine), VELUM_OK);
    lent_submit(h.l, 0);
    lent_wait(h.l);
    assert_int_equal(h.f.world_api->get_info(h.f.world, &after), VELUM_OK);
    assert_int_equal(after.tiles_rasterised, 1);
    info.max_tiles = 0;
    assert_int_equal(h.f.world_api->prepare(h.f.world, &info), VELUM_OK);
    assert_int_equal(h.f.world_api->get_info(h.f.world, &before), VELUM_OK);
    assert_true(before.tiles_rasterised > 1);
    commands = lent_begin(h.l, 0);
    assert_int_equal(begin(&h), VELUM_OK);
    assert_int_equal(h.api->record_shared(h.engine, commands, &h.at, 1, 0), VELUM_OK);
    assert_int_equal(h.api->record_view(h.views[0], commands, &h.camera, &images), VELUM_OK);
    assert_int_equal(h.f.engine_api->end_frame(h.engine), VELUM_OK);
    lent_submit(h.l, 0);
    assert_int_equal(h.f.world_api->get_info(h.f.world, &after), VELUM_OK);
    assert_int_equal(after.tiles_rasterised, before.tiles_rasterised);
    host_finish(&h);
}

/* [weather] calls of another thread; what fails there is counted, as cmocka asserts in the main thread alone. */
static void *change_the_weather(void *context) {
    host *h = context;
    const velum_world_api *api = h->f.world_api;
    uint64_t before = 0;
    size_t failures = 0;
    for (int i = 0; i < 40; i++) {
        velum_layer layer = fixture_cumulus();
        layer.coverage = 0.2f + 0.015f * (float)i;
        const velum_cell cell = {.struct_size = sizeof cell,
                                 .flags = VELUM_CELL_HAS_LAYERS,
                                 .id = 2,
                                 .kind = VELUM_CELL_RECTANGLE,
                                 .lat_deg = 47.0,
                                 .lon_deg = 11.0 + 0.01 * i,
                                 .half_east_m = 20000.0,
                                 .half_north_m = 10000.0,
                                 .transition_m = 5000.0,
                                 .layers = &layer,
                                 .layer_count = 1};
        const velum_state_desc desc = {
            .struct_size = sizeof desc, .base_state = before, .cells = &cell, .cell_count = 1};
        velum_prepare_eye eye = {.struct_size = sizeof eye, .time_s = i};
        memcpy(eye.position_ecef_m, h->at.position_ecef_m, sizeof eye.position_ecef_m);
        const velum_prepare_info info = {.struct_size = sizeof info, .eyes = &eye, .eye_count = 1, .max_tiles = 40};
        uint64_t id = 0;
        failures += api->commit(h->f.world, &desc, &id) != VELUM_OK;
        failures += api->prepare(h->f.world, &info) < 0;
        failures += before && api->retire(h->f.world, before) != VELUM_OK;
        before = id;
    }
    return (void *)failures;
}

static void weather_changes_beside_frames(void **state) {
    (void)state;
    host h;
    host_init(&h);
    pthread_t thread;
    assert_int_equal(pthread_create(&thread, NULL, change_the_weather, &h), 0);
    for (int i = 0; i < 30; i++) {
        h.frame.time_s = 0.1 * i;
        whole_frame(&h);
    }
    void *failures = NULL;
    assert_int_equal(pthread_join(thread, &failures), 0);
    assert_null(failures);
    whole_frame(&h);
    host_finish(&h);
}

static void pipeline_cache_comes_back(void **state) {
    (void)state;
    host h;
    host_init(&h);
    uint64_t size = 0;
    assert_int_equal(h.api->get_pipeline_cache(h.engine, NULL, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(h.api->get_pipeline_cache(h.engine, NULL, &size), VELUM_OK);
    assert_true(size > 32);
    char *blob = malloc(size);
    assert_non_null(blob);
    uint64_t small = 8;
    assert_int_equal(h.api->get_pipeline_cache(h.engine, blob, &small), VELUM_ERROR_ARGUMENT);
    assert_int_equal(h.api->get_pipeline_cache(h.engine, blob, &size), VELUM_OK);
    velum_vulkan_lend lend = lent_desc(h.l);
    lend.pipeline_cache = blob;
    /* Whole, cut, damaged: an engine each time. */
    for (int i = 0; i < 3; i++) {
        lend.pipeline_cache_size = i == 1 ? size - 1 : size;
        blob[size / 2] ^= i == 2 ? 1 : 0;
        velum_engine *engine = NULL;
        assert_int_equal(h.api->create_engine(&lend, &engine), VELUM_OK);
        assert_int_equal(h.f.engine_api->destroy(engine), VELUM_OK);
    }
    free(blob);
    host_finish(&h);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(runs_in_silence),
                                       cmocka_unit_test(four_frames_in_flight_run),
                                       cmocka_unit_test(refuses_the_wrong_order),
                                       cmocka_unit_test(refuses_bad_serials),
                                       cmocka_unit_test(objects_outlive_their_handles),
                                       cmocka_unit_test(refuses_bad_cameras),
                                       cmocka_unit_test(prepare_makes_frames_whole),
                                       cmocka_unit_test(weather_changes_beside_frames),
                                       cmocka_unit_test(pipeline_cache_comes_back)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
