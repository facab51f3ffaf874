/* A host as it was built on the frozen headers (v1/): it must go on working with every later plugin of ABI 1. Prints
 * what it did; 77: no Vulkan device (the parts before it passed). */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <velum/velum.h>
#include <velum/vulkan.h>

#include "keep_drivers.h"

#define EXPECT(condition)                                                                                              \
    do {                                                                                                               \
        if (!(condition)) {                                                                                            \
            fprintf(stderr, "%s:%d: %s does not hold; last log: %s\n", __FILE__, __LINE__, #condition, last_log);      \
            return 1;                                                                                                  \
        }                                                                                                              \
    } while (0)

static char last_log[512];

static void VELUM_CALL on_log(void *context, int32_t severity, const char *object, const char *message) {
    (void)context;
    snprintf(last_log, sizeof last_log, "%d %s: %s", severity, object, message);
}

enum { WIDTH = 48, HEIGHT = 32 };

static int render(const velum_engine_api *engines, const velum_standalone_api *standalone, velum_engine *engine) {
    velum_eye_desc eye_desc = {.struct_size = sizeof eye_desc, .quality = VELUM_QUALITY_LOW};
    velum_view_desc view_desc = {.struct_size = sizeof view_desc, .width = WIDTH, .height = HEIGHT, .name = "old"};
    velum_eye *eye = NULL;
    velum_view *view = NULL;
    EXPECT(engines->create_eye(engine, &eye_desc, &eye) == VELUM_OK && eye);
    EXPECT(engines->create_view(eye, &view_desc, &view) == VELUM_OK && view);

    /* On the equator at 0 E, looking up and north. */
    velum_frame_info frame = {
        .struct_size = sizeof frame, .sun_direction_ecef = {1.0, 0.0, 0.0}, .sun_illuminance_lx = {1e5f, 1e5f, 1e5f}};
    velum_eye_frame eye_frame = {
        .struct_size = sizeof eye_frame, .eye = eye, .position_ecef_m = {6378137.0 + 100.0, 0.0, 0.0}};
    velum_view_frame view_frame = {.struct_size = sizeof view_frame,
                                   .position_ecef_m = {6378137.0 + 100.0, 0.0, 0.0},
                                   .right_ecef = {0.0, 1.0, 0.0},
                                   .up_ecef = {0.6, 0.0, -0.8},
                                   .forward_ecef = {0.8, 0.0, 0.6},
                                   .tan_left = -0.5f,
                                   .tan_right = 0.5f,
                                   .tan_bottom = -0.333f,
                                   .tan_top = 0.333f,
                                   .luminance_scale = 1e-3f};
    static float luminance[WIDTH * HEIGHT * 3], transmittance[WIDTH * HEIGHT * 3], distance[WIDTH * HEIGHT];
    velum_pixels pixels = {.struct_size = sizeof pixels,
                           .view = view,
                           .frame = &view_frame,
                           .luminance_rgb = luminance,
                           .transmittance_rgb = transmittance,
                           .distance_m = distance,
                           .width = WIDTH,
                           .height = HEIGHT};
    for (int i = 0; i < 4; i++) {
        EXPECT(standalone->render(engine, &frame, &eye_frame, 1, 0, &pixels, 1, 0) >= 0);
    }
    double sum = 0.0, through = 0.0;
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++) {
        EXPECT(isfinite(luminance[i]) && luminance[i] >= 0.0f);
        EXPECT(transmittance[i] >= 0.0f && transmittance[i] <= 1.001f);
        sum += luminance[i];
        through += transmittance[i];
    }
    EXPECT(sum > 0.0);
    EXPECT(through < 0.9 * WIDTH * HEIGHT * 3); /* an overcast is in the way */
    velum_view_stats stats = {.struct_size = sizeof stats};
    EXPECT(engines->get_stats(view, &stats) >= 0);
    printf("mean luminance %g, transmittance %g, %llu rays\n", sum / (WIDTH * HEIGHT * 3),
           through / (WIDTH * HEIGHT * 3), (unsigned long long)stats.rays);
    EXPECT(engines->destroy_view(view) == VELUM_OK);
    EXPECT(engines->destroy_eye(eye) == VELUM_OK);
    return 0;
}

int main(int argc, char **argv) {
    void *library = argc > 1 ? dlopen(argv[1], RTLD_NOW | RTLD_LOCAL) : NULL;
    if (!library) {
        fprintf(stderr, "no plugin: %s\n", argc > 1 ? dlerror() : "usage: old_host PLUGIN");
        return 1;
    }
    union {
        void *symbol;
        velum_negotiate_fn function;
    } negotiate = {.symbol = dlsym(library, "velum_negotiate")};
    EXPECT(negotiate.symbol);
    velum_host_info host = {.struct_size = sizeof host, .abi_min = 1, .abi_max = 1, .name = "old", .log = on_log};
    velum_plugin_info info = {.struct_size = sizeof info};
    EXPECT(negotiate.function(&host, &info) == VELUM_OK && info.abi == 1);

    const velum_world_api *worlds = info.get_table(VELUM_WORLD_API_ID);
    const velum_engine_api *engines = info.get_table(VELUM_ENGINE_API_ID);
    const velum_vulkan_api *vulkan = info.get_table(VELUM_VULKAN_API_ID);
    const velum_standalone_api *standalone = info.get_table(VELUM_STANDALONE_API_ID);
    EXPECT(worlds && worlds->struct_size >= sizeof *worlds);
    EXPECT(engines && engines->struct_size >= sizeof *engines);
    EXPECT(vulkan && vulkan->struct_size >= sizeof *vulkan);
    EXPECT(standalone && standalone->struct_size >= sizeof *standalone);

    velum_world_desc desc = {.struct_size = sizeof desc, .seed = 3, .log = on_log};
    velum_world *world = NULL;
    EXPECT(worlds->create(&desc, &world) == VELUM_OK && world);
    velum_layer layer = {.struct_size = sizeof layer,
                         .flags = VELUM_LAYER_UNIFORM | VELUM_LAYER_EXTINCTION,
                         .genus = VELUM_GENUS_ST,
                         .coverage = 1.0f,
                         .base_m = 500.0f,
                         .top_m = 900.0f,
                         .extinction_1_m = 0.05f};
    velum_cell cell = {.struct_size = sizeof cell,
                       .flags = VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY,
                       .id = 7,
                       .kind = VELUM_CELL_GLOBAL,
                       .layers = &layer,
                       .layer_count = 1,
                       .visibility_m = 20000.0f};
    velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    uint64_t id = 0;
    EXPECT(worlds->commit(world, &state, &id) >= 0 && id > 0);
    velum_timeline_key key = {.struct_size = sizeof key, .state = id};
    EXPECT(worlds->set_timeline(world, &key, 1, 0) == VELUM_OK);

    velum_point_query query = {.struct_size = sizeof query, .position_ecef_m = {6378137.0 + 700.0, 0.0, 0.0}};
    velum_point_answer answer = {.struct_size = sizeof answer};
    EXPECT(worlds->query_point(world, &query, &answer) >= 0);
    EXPECT(fabs(answer.height_hae_m - 700.0) < 0.01);
    EXPECT(fabsf(answer.extinction_1_m - 0.05f) < 0.05f * 1e-3f);
    velum_line_query line = {
        .struct_size = sizeof line, .from_ecef_m = {6378137.0, 0.0, 0.0}, .to_ecef_m = {6378137.0 + 2000.0, 0.0, 0.0}};
    velum_line_answer along = {.struct_size = sizeof along};
    EXPECT(worlds->query_line(world, &line, &along) >= 0);
    EXPECT(fabs(along.optical_depth - 20.0) < 0.2);
    EXPECT(along.has_contact == 1 && fabs(along.first_contact_m - 500.0) <= 1.0);
    printf("optical depth %g, first contact at %g m\n", along.optical_depth, along.first_contact_m);
    velum_world_info world_info = {.struct_size = sizeof world_info};
    EXPECT(worlds->get_info(world, &world_info) == VELUM_OK && world_info.state_count == 1);
    velum_vulkan_requirements requirements = {.struct_size = sizeof requirements};
    EXPECT(vulkan->get_requirements(&requirements) == VELUM_OK && requirements.api_version >= VK_API_VERSION_1_0);

    velum_standalone_desc standalone_desc = {
        .struct_size = sizeof standalone_desc, .world = world, .log = on_log, .device = VELUM_DEVICE_AUTO};
    velum_engine *engine = NULL;
    velum_result made = standalone->create_engine(&standalone_desc, &engine);
    int failed = 0;
    if (made >= 0) {
        keep_drivers();
        failed = render(engines, standalone, engine);
        EXPECT(failed || engines->destroy(engine) == VELUM_OK);
    } else if (made == VELUM_ERROR_UNSUPPORTED || made == VELUM_ERROR_VULKAN) {
        printf("no Vulkan device: nothing rendered (%s)\n", last_log);
        failed = 77;
    } else {
        fprintf(stderr, "create_engine: %s: %s\n", velum_result_name(made), last_log);
        failed = 1;
    }
    if (failed == 0 || failed == 77) {
        EXPECT(worlds->destroy(world) == VELUM_OK);
    }
    dlclose(library);
    return failed;
}
