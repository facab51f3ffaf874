#include "scene.h"

#include <math.h>
#include <string.h>

#include "commit.h"

#define DEG (3.14159265358979323846 / 180.0)

static velum_layer cloud(int32_t genus, float coverage, float base_m, float top_m, float water_g_m3, float radius_um) {
    return (velum_layer){.struct_size = sizeof(velum_layer),
                         .genus = genus,
                         .water = genus == VELUM_GENUS_CI ? VELUM_WATER_ICE : VELUM_WATER_LIQUID,
                         .coverage = coverage,
                         .base_m = base_m,
                         .top_m = top_m,
                         .water_g_m3 = water_g_m3,
                         .radius_um = radius_um,
                         .wind_east_m_s = 12.0f,
                         .wind_north_m_s = 3.0f};
}

static velum_result commit_built_in(scene *s) {
    velum_layer layers[2] = {cloud(VELUM_GENUS_CU, 0.45f, 1000.0f, 2200.0f, 0.3f, 10.0f),
                             cloud(VELUM_GENUS_CI, 0.5f, 8500.0f, 9500.0f, 0.01f, 30.0f)};
    velum_cell cell = {.struct_size = sizeof cell,
                       .flags = VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY,
                       .id = 1,
                       .kind = VELUM_CELL_GLOBAL,
                       .layers = layers,
                       .layer_count = 2,
                       .visibility_m = 40000.0f};
    velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    uint64_t id = 0;
    return s->b->host.world->commit(s->world, &state, &id);
}

static bool play_scenario(scene *s) {
    velum_scenario *scenario = NULL;
    velum_weather_error error = {{0}, 0, 0, 0, {0}};
    velum_weather_report report = {0};
    if (velum_scenario_load(s->b->scenario, NULL, 0, &scenario, &report, &error) < 0) {
        fprintf(stderr, "velum-bench: %s\n", error.text);
        return false;
    }
    velum_result result = commit_scenario(s->b->host.world, s->world, scenario, 0.0f);
    velum_scenario_camera pose;
    velum_scenario_pose(scenario, 0.0, &pose);
    velum_scenario_pose_ecef(&pose, s->position_ecef_m, s->right, s->up, s->forward);
    velum_scenario_sun(scenario, 0.0, s->sun);
    memcpy(s->ground_albedo, scenario->ground_albedo, sizeof s->ground_albedo);
    if (scenario->channel_count > 0) {
        s->half_width_deg = 0.5 * scenario->channels[0].hfov_deg;
    }
    velum_scenario_destroy(scenario);
    return result >= 0 || bench_fail(s->b, "commit", result);
}

void scene_place(scene *s, double lat_deg, double lon_deg, double height_m) {
    velum_scenario_camera pose = {
        .lat_deg = lat_deg, .lon_deg = lon_deg, .height_m = height_m, .heading_deg = 90.0, .pitch_deg = 4.0};
    double east[3], north[3];
    velum_scenario_pose_ecef(&pose, s->position_ecef_m, s->right, s->up, s->forward);
    pose.pitch_deg = 35.0; /* the sun's height */
    pose.heading_deg = 160.0;
    double unused[3];
    velum_scenario_pose_ecef(&pose, unused, east, north, s->sun);
    for (int i = 0; i < 3; i++) {
        s->ground_albedo[i] = 0.1f;
    }
}

static bool create_world(scene *s, bench *b) {
    *s = (scene){.b = b, .half_width_deg = 20.0};
    s->world = test_host_create_world(&b->host, 7);
    scene_place(s, 50.03, 8.55, 300.0);
    return s->world || bench_fail(b, "create world", VELUM_ERROR_OUT_OF_MEMORY);
}

bool scene_engine(scene *s) {
    velum_vulkan_lend lend = vulkan_device_lend(&s->b->device, &s->b->host, s->world);
    velum_result result = s->b->host.vulkan->create_engine(&lend, &s->engine);
    return result >= 0 || bench_fail(s->b, "create engine", result);
}

bool scene_shadow(scene *s) {
    const velum_shadow_desc desc = {.struct_size = sizeof desc};
    velum_result result = s->b->host.engine->create_shadow(s->engine, &desc, &s->shadow);
    return result >= 0 || bench_fail(s->b, "create shadow", result);
}

bool scene_init(scene *s, bench *b) {
    if (!create_world(s, b)) {
        return false;
    }
    velum_result result = VELUM_OK;
    if (!b->scenario) {
        result = commit_built_in(s);
    } else if (!play_scenario(s)) {
        goto error;
    }
    if (result < 0) {
        bench_fail(b, "commit", result);
        goto error;
    }
    if (!scene_engine(s)) {
        goto error;
    }
    return true;
error:
    scene_finish(s);
    return false;
}

bool scene_world(scene *s, bench *b, velum_weather_report *report) {
    if (!create_world(s, b)) {
        return false;
    }
    char grib[1024], metar[1024];
    snprintf(grib, sizeof grib, "%s/data/gfs.t12z.pgrbf120.2p5deg.grib2", b->shared);
    snprintf(metar, sizeof metar, "%s/data/metars-20141218.csv", b->shared);
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_error error = {{0}, 0, 0, 0, {0}};
    velum_result result = VELUM_ERROR_OUT_OF_MEMORY;
    bool ok = false;
    if (!set || (result = velum_weather_read_grib(set, grib, report, &error)) < 0 ||
        (result = velum_weather_read_metar(set, metar, NULL, report, &error)) < 0) {
        fprintf(stderr, "velum-bench: %s\n", error.text);
        goto done;
    }
    velum_state_desc state = {.struct_size = sizeof state};
    velum_weather_set_state(set, &state);
    uint64_t id = 0;
    result = b->host.world->commit(s->world, &state, &id);
    ok = result >= 0 || bench_fail(b, "commit", result);
done:
    velum_weather_set_destroy(set);
    if (!ok) {
        scene_finish(s);
    }
    return ok;
}

void scene_finish(scene *s) {
    if (s->shadow) {
        s->b->host.engine->destroy_shadow(s->shadow);
    }
    if (s->engine) {
        s->b->host.engine->complete(s->engine, s->serial);
        velum_result result = s->b->host.engine->destroy(s->engine);
        if (result < 0) {
            bench_fail(s->b, "destroy engine", result);
        }
    }
    s->b->host.world->destroy(s->world);
    *s = (scene){.b = s->b};
}

bool scene_eye_init(scene *s, scene_eye *eye, int32_t quality, uint32_t views, uint32_t width, uint32_t height) {
    const velum_engine_api *api = s->b->host.engine;
    *eye = (scene_eye){.count = views, .width = width, .height = height};
    velum_eye_desc eye_desc = {.struct_size = sizeof eye_desc, .quality = quality, .budget_ms = s->budget_ms};
    velum_result result = api->create_eye(s->engine, &eye_desc, &eye->eye);
    for (uint32_t i = 0; i < views && result >= 0; i++) {
        velum_view_desc desc = {.struct_size = sizeof desc, .width = width, .height = height};
        result = api->create_view(eye->eye, &desc, &eye->views[i]);
        eye->yaw_deg[i] = s->half_width_deg * (2.0 * (double)i - (double)(views - 1));
        if (result >= 0 && !vulkan_device_images(&s->b->device, width, height, &eye->images[i])) {
            result = VELUM_ERROR_OUT_OF_MEMORY;
        }
        if (result >= 0 && s->depth_m > 0.0f && !vulkan_device_depth(&s->b->device, s->depth_m, &eye->images[i])) {
            result = VELUM_ERROR_OUT_OF_MEMORY;
        }
    }
    if (result < 0) {
        bench_fail(s->b, "create eye and views", result);
        scene_eye_finish(eye, s);
    }
    return result >= 0;
}

void scene_eye_finish(scene_eye *eye, scene *s) {
    s->b->host.engine->complete(s->engine, s->serial);
    for (uint32_t i = 0; i < eye->count; i++) {
        s->b->host.engine->destroy_view(eye->views[i]);
    }
    s->b->host.engine->destroy_eye(eye->eye);
    *eye = (scene_eye){.count = 0};
}

static velum_view_frame view_frame(const scene *s, const scene_eye *eye, uint32_t index) {
    const double c = cos(eye->yaw_deg[index] * DEG);
    const double sine = sin(eye->yaw_deg[index] * DEG);
    const double tan_x = tan(s->half_width_deg * DEG);
    velum_view_frame frame = {.struct_size = sizeof frame,
                              .flags = VELUM_VIEW_GROUND | VELUM_VIEW_SUN_DISC,
                              .tan_left = (float)-tan_x,
                              .tan_right = (float)tan_x,
                              .tan_bottom = (float)(-tan_x * eye->height / eye->width),
                              .tan_top = (float)(tan_x * eye->height / eye->width),
                              .depth_convention = VELUM_DEPTH_DISTANCE,
                              .luminance_scale = 1e-3f};
    memcpy(frame.position_ecef_m, s->position_ecef_m, sizeof frame.position_ecef_m);
    memcpy(frame.up_ecef, s->up, sizeof frame.up_ecef);
    for (int i = 0; i < 3; i++) {
        frame.right_ecef[i] = c * s->right[i] - sine * s->forward[i];
        frame.forward_ecef[i] = c * s->forward[i] + sine * s->right[i];
    }
    return frame;
}

static void read_stats(scene *s, const scene_eye *eye, scene_frame *out) {
    for (uint32_t i = 0; i < eye->count; i++) {
        velum_view_stats stats = {.struct_size = sizeof stats};
        if (s->b->host.engine->get_stats(eye->views[i], &stats) != VELUM_OK) {
            continue;
        }
        out->view_ms[i] = (double)stats.march_ms + (double)stats.resolve_ms;
        out->march_ms += (double)stats.march_ms;
        out->resolve_ms += (double)stats.resolve_ms;
        out->shared_ms = (double)stats.shared_ms;
        out->shadow_ms = (double)stats.shadow_ms;
        out->gpu_ms += out->view_ms[i];
        out->rays += (double)stats.rays;
        out->samples += (double)stats.samples;
        out->light_samples += (double)stats.light_samples;
        out->weather_bytes = (double)stats.weather_bytes;
        out->view_bytes += (double)stats.view_bytes;
        out->incomplete = out->incomplete || stats.incomplete;
    }
    out->gpu_ms += out->shared_ms + out->shadow_ms;
}

bool scene_draw(scene *s, scene_eye *eye, scene_frame *out) {
    const test_host *host = &s->b->host;
    *out = (scene_frame){0};
    velum_frame_info frame = {.struct_size = sizeof frame,
                              .submit_serial = s->serial + 1,
                              .completed_serial = s->serial,
                              .time_s = s->time_s,
                              .sun_illuminance_lx = {128000.0f, 128000.0f, 128000.0f}};
    memcpy(frame.sun_direction_ecef, s->sun, sizeof frame.sun_direction_ecef);
    memcpy(frame.ground_albedo, s->ground_albedo, sizeof frame.ground_albedo);
    velum_eye_frame eye_frame = {.struct_size = sizeof eye_frame, .eye = eye->eye};
    memcpy(eye_frame.position_ecef_m, s->position_ecef_m, sizeof eye_frame.position_ecef_m);
    double start_cpu_ms = bench_cpu_ms();
    double start_ms = bench_now_ms();
    VkCommandBuffer commands = vulkan_device_begin(&s->b->device, 0);
    velum_result result = host->engine->begin_frame(s->engine, &frame);
    if (result < 0) {
        return bench_fail(s->b, "begin_frame", result);
    }
    s->serial++;
    result = host->vulkan->record_shared(s->engine, commands, &eye_frame, 1, 0);
    out->incomplete = result == VELUM_INCOMPLETE;
    if (s->shadow && result >= 0) {
        velum_shadow_frame shadow = {.struct_size = sizeof shadow};
        memcpy(shadow.centre_ecef_m, s->position_ecef_m, sizeof shadow.centre_ecef_m);
        result = host->vulkan->record_shadow(s->shadow, commands, &shadow);
    }
    for (uint32_t i = 0; i < eye->count && result >= 0; i++) {
        velum_view_frame view = view_frame(s, eye, i);
        result = host->vulkan->record_view(eye->views[i], commands, &view, &eye->images[i]);
        out->incomplete = out->incomplete || result == VELUM_INCOMPLETE;
    }
    velum_result ended = host->engine->end_frame(s->engine);
    out->record_ms = bench_now_ms() - start_ms;
    bool submitted = vulkan_device_submit(&s->b->device, 0) && vulkan_device_wait(&s->b->device, 0);
    out->wall_ms = bench_now_ms() - start_ms;
    out->cpu_ms = bench_cpu_ms() - start_cpu_ms;
    if (result < 0 || ended < 0 || !submitted) {
        return bench_fail(s->b, "record", result < 0 ? result : ended < 0 ? ended : VELUM_ERROR_VULKAN);
    }
    result = host->engine->complete(s->engine, s->serial);
    if (result < 0) {
        return bench_fail(s->b, "complete", result);
    }
    read_stats(s, eye, out);
    return true;
}

bool scene_prepare(scene *s, double *out_ms) {
    velum_prepare_eye eye = {
        .struct_size = sizeof eye, .time_s = s->time_s, .pixel_rad = 2.0 * tan(s->half_width_deg * DEG) / 640.0};
    memcpy(eye.position_ecef_m, s->position_ecef_m, sizeof eye.position_ecef_m);
    velum_prepare_info info = {.struct_size = sizeof info, .eyes = &eye, .eye_count = 1};
    double start_ms = bench_now_ms();
    velum_result result = s->b->host.world->prepare(s->world, &info);
    *out_ms = bench_now_ms() - start_ms;
    return result >= 0 || bench_fail(s->b, "prepare", result);
}

bool scene_settle(scene *s, scene_eye *eye, uint32_t count) {
    double unused_ms;
    if (!scene_prepare(s, &unused_ms)) {
        return false;
    }
    scene_frame frame = {.incomplete = true};
    for (uint32_t i = 0; i < 64 && frame.incomplete; i++) {
        if (!scene_draw(s, eye, &frame)) {
            return false;
        }
    }
    if (frame.incomplete) {
        fprintf(stderr, "velum-bench: %s: tiles are missing after 64 frames\n", s->b->case_name);
    }
    for (uint32_t i = 0; i < count; i++) {
        if (!scene_draw(s, eye, &frame)) {
            return false;
        }
    }
    return true;
}
