/* Time and memory as views, layers and pixels grow. */
#include <math.h>
#include <string.h>

#include "scaling.h"
#include "scene.h"

enum { AXES = 3, ROUNDS_MOST = 2, FRAMES = 2, LAYERS = 6 };

#define PLAY_STEP_S (1.0 / 60.0)

static const char sky[] = BENCH_SCENES "/broken_sky.json";

static double work_ms(const scene *s, const scene_frame *f) {
    return s->b->device.is_processor ? f->cpu_ms : f->gpu_ms;
}

/* One frame to fill caches, then some that count. */
static bool add_frames(scene *s, scene_eye *eye, scaling_axis *axis, uint32_t point, bool weather_memory) {
    bool ok = true;
    for (uint32_t i = 0; i <= FRAMES && ok; i++) {
        scene_frame frame;
        s->time_s += PLAY_STEP_S;
        ok = scene_draw(s, eye, &frame);
        if (ok && i > 0) {
            bench_add(&axis->wall_ms[point], frame.wall_ms);
            bench_add(&axis->work_ms[point], work_ms(s, &frame));
            bench_add(&axis->samples[point], frame.samples + frame.light_samples);
            axis->bytes[point] = weather_memory ? frame.weather_bytes : frame.view_bytes;
        }
    }
    return ok;
}

static uint32_t rounds_of(const bench *b) {
    return b->rounds < ROUNDS_MOST ? b->rounds : ROUNDS_MOST;
}

/* Eyes of their own, each with as many views or pixels; in turn. */
static bool grow_eyes(scene *s, scaling_axis *axis, const uint32_t (*shapes)[3]) {
    scene_eye eyes[SCALING_SIZES];
    memset(eyes, 0, sizeof eyes);
    bool ok = true;
    for (uint32_t i = 0; i < axis->count && ok; i++) {
        ok = scene_eye_init(s, &eyes[i], VELUM_QUALITY_MEDIUM, shapes[i][0], shapes[i][1], shapes[i][2]) &&
             scene_settle(s, &eyes[i], 1);
    }
    for (uint32_t round = 0; round < rounds_of(s->b) && ok; round++) {
        for (uint32_t i = 0; i < axis->count && ok; i++) {
            ok = add_frames(s, &eyes[i], axis, i, false);
        }
    }
    for (uint32_t i = 0; i < axis->count; i++) {
        if (eyes[i].eye) {
            scene_eye_finish(&eyes[i], s);
        }
    }
    return ok;
}

/* A ring of projectors, level, so that all see as much sky. */
static bool grow_views(scene *s, scaling_axis *axis) {
    static const uint32_t shapes[][3] = {{1, 480, 270}, {2, 480, 270}, {4, 480, 270}, {8, 480, 270}};
    *axis = (scaling_axis){.name = "views", .fixed = "480 x 270 each, three layers", .memory = "views", .count = 4};
    for (uint32_t i = 0; i < axis->count; i++) {
        axis->sizes[i] = shapes[i][0];
    }
    const velum_scenario_camera level = {.lat_deg = 50.0, .lon_deg = 8.5, .height_m = 2.0, .heading_deg = 90.0};
    const scene before = *s;
    velum_scenario_pose_ecef(&level, s->position_ecef_m, s->right, s->up, s->forward);
    s->half_width_deg = 22.5;
    bool ok = grow_eyes(s, axis, shapes);
    memcpy(s->position_ecef_m, before.position_ecef_m, sizeof s->position_ecef_m);
    memcpy(s->right, before.right, sizeof s->right);
    memcpy(s->up, before.up, sizeof s->up);
    memcpy(s->forward, before.forward, sizeof s->forward);
    s->half_width_deg = before.half_width_deg;
    return ok;
}

static bool grow_pixels(scene *s, scaling_axis *axis) {
    static const uint32_t shapes[][3] = {{1, 424, 240}, {1, 640, 360}, {1, 960, 540}, {1, 1920, 1080}, {1, 3840, 2160}};
    *axis = (scaling_axis){.name = "megapixels", .fixed = "one view, three layers", .memory = "views", .count = 5};
    for (uint32_t i = 0; i < axis->count; i++) {
        axis->sizes[i] = 1e-6 * shapes[i][1] * shapes[i][2];
    }
    return grow_eyes(s, axis, shapes);
}

static velum_result commit_layers(const scene *s, uint32_t count) {
    static const struct {
        int32_t genus, water;
        float coverage, base_m, top_m, water_g_m3, radius_um;
    } rows[LAYERS] = {{VELUM_GENUS_CU, VELUM_WATER_LIQUID, 0.3f, 1000.0f, 1800.0f, 0.3f, 10.0f},
                      {VELUM_GENUS_AC, VELUM_WATER_LIQUID, 0.3f, 3600.0f, 4100.0f, 0.15f, 8.0f},
                      {VELUM_GENUS_CI, VELUM_WATER_ICE, 0.3f, 8500.0f, 9500.0f, 0.01f, 30.0f},
                      {VELUM_GENUS_SC, VELUM_WATER_LIQUID, 0.3f, 2200.0f, 2600.0f, 0.25f, 9.0f},
                      {VELUM_GENUS_CB, VELUM_WATER_LIQUID, 0.1f, 1200.0f, 9000.0f, 1.0f, 14.0f},
                      {VELUM_GENUS_SC, VELUM_WATER_LIQUID, 0.3f, 2900.0f, 3300.0f, 0.25f, 9.0f}};
    velum_layer layers[LAYERS];
    for (uint32_t i = 0; i < count; i++) {
        layers[i] = (velum_layer){.struct_size = sizeof layers[i],
                                  .genus = rows[i].genus,
                                  .water = rows[i].water,
                                  .coverage = rows[i].coverage,
                                  .base_m = rows[i].base_m,
                                  .top_m = rows[i].top_m,
                                  .water_g_m3 = rows[i].water_g_m3,
                                  .radius_um = rows[i].radius_um,
                                  .wind_east_m_s = 10.0f};
    }
    const velum_cell cell = {.struct_size = sizeof cell,
                             .flags = VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY,
                             .id = 1,
                             .kind = VELUM_CELL_GLOBAL,
                             .layers = layers,
                             .layer_count = count,
                             .visibility_m = 40000.0f};
    const velum_state_desc state = {.struct_size = sizeof state, .cells = &cell, .cell_count = 1};
    velum_timeline_key key = {.struct_size = sizeof key};
    velum_result result = s->b->host.world->commit(s->world, &state, &key.state);
    return result >= 0 ? s->b->host.world->set_timeline(s->world, &key, 1, 0) : result;
}

/* Kinds of cloud beside each other, no two of them of one slot. */
static bool grow_layers(scene *s, scaling_axis *axis) {
    *axis = (scaling_axis){.name = "layers", .fixed = "one view of 640 x 360", .memory = "weather", .count = LAYERS};
    scene_eye eye = {.count = 0};
    bool ok = scene_eye_init(s, &eye, VELUM_QUALITY_MEDIUM, 1, 640, 360);
    for (uint32_t round = 0; round < rounds_of(s->b) && ok; round++) {
        for (uint32_t i = 0; i < LAYERS && ok; i++) {
            axis->sizes[i] = i + 1;
            velum_result result = commit_layers(s, i + 1);
            ok = (result >= 0 || bench_fail(s->b, "commit", result)) && scene_settle(s, &eye, 1) &&
                 add_frames(s, &eye, axis, i, true);
        }
    }
    if (eye.eye) {
        scene_eye_finish(&eye, s);
    }
    return ok;
}

static void report_axis(const bench *b, scaling_axis *axis) {
    double work[SCALING_SIZES];
    char variant[32];
    for (uint32_t i = 0; i < axis->count; i++) {
        snprintf(variant, sizeof variant, "%.3g %s", axis->sizes[i], axis->name);
        bench_report(b, variant, "frame", "ms", &axis->wall_ms[i]);
        bench_report(b, variant, b->device.is_processor ? "cpu" : "gpu", "ms", &axis->work_ms[i]);
        bench_report(b, variant, "all_samples", "1", &axis->samples[i]);
        bench_report_value(b, variant, "memory", "bytes", axis->bytes[i]);
        work[i] = bench_median(&axis->work_ms[i]);
    }
    axis->time_growth = growth_of(axis->sizes, work, axis->count);
    axis->memory_growth = growth_of(axis->sizes, axis->bytes, axis->count);
    bench_judge_value(b, axis->name, "time_exponent", "1", axis->time_growth.exponent, BENCH_AT_MOST, SCALING_BOUND);
    bench_report_value(b, axis->name, "time_exponent_sigma", "1", axis->time_growth.sigma);
    bench_report_value(b, axis->name, "time_steepest", "1", axis->time_growth.steepest);
    bench_judge_value(b, axis->name, "memory_exponent", "1", axis->memory_growth.exponent, BENCH_AT_MOST,
                      SCALING_BOUND);
}

/* Too large for a stack. */
static scaling_axis axes[AXES];

static bool scaling(bench *b) {
    static bool (*const grow[AXES])(scene * s, scaling_axis * axis) = {grow_views, grow_pixels, grow_layers};
    const char *asked = b->scenario;
    scene s;
    b->scenario = asked ? asked : sky;
    bool ok = scene_init(&s, b);
    b->scenario = asked;
    if (!ok) {
        return false;
    }
    ok = scene_shadow(&s);
    for (uint32_t i = 0; i < AXES && ok; i++) {
        ok = grow[i](&s, &axes[i]);
        if (ok) {
            report_axis(b, &axes[i]);
        }
    }
    scene_finish(&s);
    return ok && (!b->out || scaling_page(b, axes, AXES, b->out));
}

const bench_case bench_scaling_cases[] = {
    {"scaling", "time and memory of 1 to 8 views, 0.1 to 8 megapixels, 1 to 6 layers; with --out a page and a chart",
     scaling},
    {NULL, NULL, NULL},
};
