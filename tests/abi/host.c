#include "host.h"

#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "keep_drivers.h"

void VELUM_CALL test_log_write(void *context, int32_t severity, const char *object, const char *message) {
    test_log *log = context;
    log->count++;
    if (severity >= VELUM_LOG_ERROR) {
        log->failures++;
        log->severity = severity;
        snprintf(log->object, sizeof log->object, "%s", object ? object : "");
        snprintf(log->message, sizeof log->message, "%s", message ? message : "");
    }
}

void test_log_clear(test_log *log) {
    *log = (test_log){0};
}

bool test_host_open(test_host *host) {
    *host = (test_host){.info = {.struct_size = sizeof host->info}};
    const char *path = getenv("VELUM_PLUGIN");
    host->library = path ? dlopen(path, RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!host->library) {
        const char *error = path ? dlerror() : "VELUM_PLUGIN is not set";
        fprintf(stderr, "no plugin: %s\n", error ? error : path);
        return false;
    }
    union {
        void *symbol;
        velum_negotiate_fn function;
    } negotiate = {.symbol = dlsym(host->library, "velum_negotiate")};
    host->negotiate = negotiate.function;
    velum_host_info info = {.struct_size = sizeof info,
                            .abi_min = VELUM_ABI_MAJOR,
                            .abi_max = VELUM_ABI_MAJOR,
                            .name = "tests",
                            .log = test_log_write,
                            .log_context = &host->log};
    if (!negotiate.symbol || host->negotiate(&info, &host->info) != VELUM_OK) {
        fprintf(stderr, "%s: does not negotiate: %s\n", path, host->log.message);
        test_host_close(host);
        return false;
    }
    host->world = host->info.get_table(VELUM_WORLD_API_ID);
    host->engine = host->info.get_table(VELUM_ENGINE_API_ID);
    host->vulkan = host->info.get_table(VELUM_VULKAN_API_ID);
    host->standalone = host->info.get_table(VELUM_STANDALONE_API_ID);
    if (!host->world || !host->engine || !host->vulkan || !host->standalone) {
        fprintf(stderr, "%s: lacks a table\n", path);
        test_host_close(host);
        return false;
    }
    return true;
}

void test_host_close(test_host *host) {
    if (host->library) {
        dlclose(host->library);
        host->library = NULL;
    }
}

velum_world *test_host_create_world(test_host *host, uint64_t seed) {
    velum_world_desc desc = {
        .struct_size = sizeof desc, .seed = seed, .log = test_log_write, .log_context = &host->log};
    velum_world *world = NULL;
    return host->world->create(&desc, &world) == VELUM_OK ? world : NULL;
}

uint64_t test_host_commit_overcast(test_host *host, velum_world *world, float coverage) {
    velum_layer layer = {.struct_size = sizeof layer,
                         .genus = VELUM_GENUS_SC,
                         .coverage = coverage,
                         .base_m = 900.0f,
                         .top_m = 1500.0f,
                         .water_g_m3 = 0.3f,
                         .radius_um = 10.0f};
    velum_cell cell = {.struct_size = sizeof cell,
                       .flags = VELUM_CELL_HAS_LAYERS,
                       .id = 1,
                       .kind = VELUM_CELL_GLOBAL,
                       .layers = &layer,
                       .layer_count = 1};
    velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    uint64_t id = 0;
    return host->world->commit(world, &state, &id) >= 0 ? id : 0;
}

velum_engine *test_host_create_engine(test_host *host, velum_world *world) {
    velum_standalone_desc desc = {.struct_size = sizeof desc,
                                  .world = world,
                                  .log = test_log_write,
                                  .log_context = &host->log,
                                  .device = VELUM_DEVICE_AUTO};
    velum_engine *engine = NULL;
    velum_result result = host->standalone->create_engine(&desc, &engine);
    keep_drivers();
    return result >= 0 ? engine : NULL;
}

#define DEG (3.14159265358979323846 / 180.0)

void test_ecef(double lat_deg, double lon_deg, double height_m, double out[3]) {
    const double a_m = 6378137.0;
    const double e2 = 6.69437999014131699613723e-3;
    double s = sin(lat_deg * DEG);
    double c = cos(lat_deg * DEG);
    double n_m = a_m / sqrt(1.0 - e2 * s * s);
    out[0] = (n_m + height_m) * c * cos(lon_deg * DEG);
    out[1] = (n_m + height_m) * c * sin(lon_deg * DEG);
    out[2] = (n_m * (1.0 - e2) + height_m) * s;
}

velum_frame_info test_frame_info(void) {
    velum_frame_info frame = {.struct_size = sizeof frame,
                              .sun_illuminance_lx = {128000.0f, 128000.0f, 128000.0f},
                              .ground_albedo = {0.1f, 0.1f, 0.1f},
                              .atmosphere = VELUM_ATMOSPHERE_EARTH};
    double zenith[3], high[3];
    test_ecef(50.0, 8.5, 0.0, zenith);
    test_ecef(50.0, 8.5, 1000.0, high);
    for (int i = 0; i < 3; i++) {
        frame.sun_direction_ecef[i] = (high[i] - zenith[i]) / 1000.0;
    }
    return frame;
}

velum_view_frame test_view_frame(void) {
    const double lat = 50.0 * DEG, lon = 8.5 * DEG, pitch = 8.0 * DEG;
    const double east[3] = {-sin(lon), cos(lon), 0.0};
    const double north[3] = {-sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat)};
    const double up[3] = {cos(lat) * cos(lon), cos(lat) * sin(lon), sin(lat)};
    velum_view_frame frame = {.struct_size = sizeof frame,
                              .flags = VELUM_VIEW_GROUND,
                              .tan_left = -0.36f,
                              .tan_right = 0.36f,
                              .tan_bottom = -0.2025f,
                              .tan_top = 0.2025f,
                              .luminance_scale = 1e-3f};
    test_ecef(50.0, 8.5, 300.0, frame.position_ecef_m);
    for (int i = 0; i < 3; i++) {
        frame.right_ecef[i] = -north[i];
        frame.up_ecef[i] = cos(pitch) * up[i] - sin(pitch) * east[i];
        frame.forward_ecef[i] = cos(pitch) * east[i] + sin(pitch) * up[i];
    }
    return frame;
}
