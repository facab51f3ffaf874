/* Frames: channels, sizes, presets, memory, moving air. */
#include <string.h>

#include "scene.h"

enum { VARIANTS = 6, STANDING_FRAMES = 110 };

typedef struct variant {
    const char *name;
    int32_t quality;
    uint32_t views, width, height;
    double bound_ms;        /* of a frame; 0: none */
    bool moves;             /* has the rays of an eye that moves */
    double device_bound_ms; /* of the device's own time in a frame; 0: none */
    float depth_m;          /* see scene.depth_m */
} variant;

/* Series of each variant. Too large for a stack: one set, in the one thread that there is. */
typedef struct figures {
    bench_series wall, cpu, record, gpu, shared, shadow, march, resolve, view[SCENE_VIEWS], rays, samples, light,
        weather, memory;
} figures;

static void add(figures *f, const scene_frame *frame, uint32_t views) {
    bench_add(&f->wall, frame->wall_ms);
    bench_add(&f->cpu, frame->cpu_ms);
    bench_add(&f->record, frame->record_ms);
    bench_add(&f->gpu, frame->gpu_ms);
    bench_add(&f->shared, frame->shared_ms);
    bench_add(&f->shadow, frame->shadow_ms);
    bench_add(&f->march, frame->march_ms);
    bench_add(&f->resolve, frame->resolve_ms);
    for (uint32_t i = 0; i < views; i++) {
        bench_add(&f->view[i], frame->view_ms[i]);
    }
    bench_add(&f->rays, frame->rays);
    bench_add(&f->samples, frame->samples);
    bench_add(&f->light, frame->light_samples);
    bench_add(&f->weather, frame->weather_bytes);
    bench_add(&f->memory, frame->view_bytes);
}

static void report(const bench *b, const variant *v, const figures *f) {
    static const char *const view_names[SCENE_VIEWS] = {"gpu_view_1", "gpu_view_2", "gpu_view_3", "gpu_view_4",
                                                        "gpu_view_5", "gpu_view_6", "gpu_view_7", "gpu_view_8"};
    if (v->bound_ms > 0.0) {
        bench_judge(b, v->name, "frame", "ms", &f->wall, BENCH_AT_MOST, v->bound_ms);
    } else {
        bench_report(b, v->name, "frame", "ms", &f->wall);
    }
    bench_report(b, v->name, "cpu", "ms", &f->cpu);
    bench_report(b, v->name, "record", "ms", &f->record);
    if (v->device_bound_ms > 0.0) {
        bench_judge(b, v->name, "gpu", "ms", &f->gpu, BENCH_AT_MOST, v->device_bound_ms);
    } else {
        bench_report(b, v->name, "gpu", "ms", &f->gpu);
    }
    bench_report(b, v->name, "gpu_shared", "ms", &f->shared);
    bench_report(b, v->name, "gpu_shadow", "ms", &f->shadow);
    bench_report(b, v->name, "gpu_march", "ms", &f->march);
    bench_report(b, v->name, "gpu_resolve", "ms", &f->resolve);
    for (uint32_t i = 0; i < v->views; i++) {
        bench_report(b, v->name, view_names[i], "ms", &f->view[i]);
    }
    bench_report(b, v->name, "rays", "1", &f->rays);
    bench_report(b, v->name, "samples", "1", &f->samples);
    bench_report(b, v->name, "light_samples", "1", &f->light);
    bench_report(b, v->name, "weather_memory", "bytes", &f->weather);
    bench_report(b, v->name, "view_memory", "bytes", &f->memory);
}

/* Time goes on until views that stand have the rays of such: three rounds, then tiles grow calm. */
static bool stand(scene *s, scene_eye *eye, double step_s) {
    scene_frame frame;
    for (uint32_t i = 0; i < STANDING_FRAMES; i++) {
        s->time_s += step_s;
        if (!scene_draw(s, eye, &frame)) {
            return false;
        }
    }
    return true;
}

static bool impose_motion(const scene *s, const scene_eye *eye) {
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    bool ok = s->b->host.engine->get_plan(eye->eye, &plan, &reasons) >= 0;
    plan.standing_ray_rate = 0;
    return ok && s->b->host.engine->set_plan(eye->eye, &plan) >= 0;
}

/* Variants in turn, each settled before. Time stands; or goes on by step_s a frame, with a shadow map to be renewed,
 * and a variant has all its rounds in a row. */
static bool run_variants(bench *b, const variant *variants, uint32_t count, double step_s, figures *f) {
    scene s;
    scene_eye eyes[VARIANTS];
    memset(eyes, 0, sizeof eyes);
    memset(f, 0, count * sizeof *f);
    if (!scene_init(&s, b)) {
        return false;
    }
    bool ok = step_s == 0.0 || scene_shadow(&s);
    for (uint32_t v = 0; v < count && ok; v++) {
        s.depth_m = variants[v].depth_m;
        ok = scene_eye_init(&s, &eyes[v], variants[v].quality, variants[v].views, variants[v].width,
                            variants[v].height) &&
             scene_settle(&s, &eyes[v], 17) && (!variants[v].moves || impose_motion(&s, &eyes[v]));
    }
    const uint32_t rounds = step_s == 0.0 ? b->rounds : 1;
    const uint32_t frames = b->rounds * b->frames / rounds;
    for (uint32_t round = 0; round < rounds && ok; round++) {
        for (uint32_t v = 0; v < count && ok; v++) {
            ok = step_s == 0.0 || stand(&s, &eyes[v], step_s);
            for (uint32_t i = 0; i < frames + 1 && ok; i++) {
                scene_frame frame;
                s.time_s += step_s;
                ok = scene_draw(&s, &eyes[v], &frame);
                if (i > 0 && ok) { /* the first after another variant pays for its caches */
                    add(&f[v], &frame, variants[v].views);
                }
            }
        }
    }
    for (uint32_t v = 0; v < count && ok; v++) {
        report(b, &variants[v], &f[v]);
    }
    for (uint32_t v = 0; v < count; v++) {
        if (eyes[v].eye) {
            scene_eye_finish(&eyes[v], &s);
        }
    }
    scene_finish(&s);
    return ok;
}

static figures series[VARIANTS];

#define PLAY_STEP_S (1.0 / 60.0)

static bool run_channels(bench *b, double step_s) {
    static const variant variants[] = {{"1 channel", VELUM_QUALITY_MEDIUM, 1, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"2 channels", VELUM_QUALITY_MEDIUM, 2, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"3 channels", VELUM_QUALITY_MEDIUM, 3, 640, 360, 0.0, false, 0.0, 0.0f}};
    if (!run_variants(b, variants, 3, step_s, series)) {
        return false;
    }
    /* What a channel adds to a frame, and its share of the first one's. */
    for (int cpu = 0; cpu < 2; cpu++) {
        double one = bench_median(cpu ? &series[0].cpu : &series[0].wall);
        double two = bench_median(cpu ? &series[1].cpu : &series[1].wall) - one;
        double three = bench_median(cpu ? &series[2].cpu : &series[2].wall) - one - two;
        bench_report_value(b, "first channel", cpu ? "cpu_cost" : "cost", "ms", one);
        bench_report_value(b, "second channel", cpu ? "cpu_cost" : "cost", "ms", two);
        bench_report_value(b, "third channel", cpu ? "cpu_cost" : "cost", "ms", three);
        if (one > 0.0) {
            bench_report_value(b, "second channel", cpu ? "cpu_share_of_first" : "share_of_first", "1", two / one);
            bench_report_value(b, "third channel", cpu ? "cpu_share_of_first" : "share_of_first", "1", three / one);
        }
    }
    return true;
}

static bool channels(bench *b) {
    return run_channels(b, 0.0);
}

static bool channels_playing(bench *b) {
    return run_channels(b, PLAY_STEP_S);
}

static bool resolutions(bench *b) {
    static const variant variants[] = {{"640x360", VELUM_QUALITY_MEDIUM, 1, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"960x540", VELUM_QUALITY_MEDIUM, 1, 960, 540, 0.0, false, 0.0, 0.0f},
                                       {"1920x1080", VELUM_QUALITY_MEDIUM, 1, 1920, 1080, 0.0, false, 0.0, 0.0f}};
    return run_variants(b, variants, 3, PLAY_STEP_S, series);
}

static bool views(bench *b) {
    static const variant variants[] = {{"1 view", VELUM_QUALITY_MEDIUM, 1, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"2 views", VELUM_QUALITY_MEDIUM, 2, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"3 views", VELUM_QUALITY_MEDIUM, 3, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"4 views", VELUM_QUALITY_MEDIUM, 4, 640, 360, 0.0, false, 0.0, 0.0f}};
    return run_variants(b, variants, 4, PLAY_STEP_S, series);
}

static bool presets(bench *b) {
    static const variant variants[] = {{"low", VELUM_QUALITY_LOW, 1, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"medium", VELUM_QUALITY_MEDIUM, 1, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"high", VELUM_QUALITY_HIGH, 1, 640, 360, 0.0, false, 0.0, 0.0f},
                                       {"ultra", VELUM_QUALITY_ULTRA, 1, 640, 360, 0.0, false, 0.0, 0.0f}};
    return run_variants(b, variants, 4, PLAY_STEP_S, series);
}

static bool under_broken_sky(bench *b, const variant *variants, uint32_t count) {
    const char *asked = b->scenario;
    b->scenario = asked ? asked : BENCH_SCENES "/broken_sky.json";
    bool ok = run_variants(b, variants, count, PLAY_STEP_S, series);
    b->scenario = asked;
    return ok;
}

static bool broken_sky(bench *b) {
    static const variant variants[] = {
        {"960x540", VELUM_QUALITY_MEDIUM, 1, 960, 540, 70.0, false, 0.0, 0.0f},
        {"1920x1080", VELUM_QUALITY_MEDIUM, 1, 1920, 1080, 180.0, false, 0.0, 0.0f},
        {"960x540, rays as in motion", VELUM_QUALITY_MEDIUM, 1, 960, 540, 0.0, true, 0.0, 0.0f},
        {"1920x1080, the same", VELUM_QUALITY_MEDIUM, 1, 1920, 1080, 0.0, true, 0.0, 0.0f},
        /* Behind all that is in sight. */
        {"960x540, the host gives depth", VELUM_QUALITY_MEDIUM, 1, 960, 540, 0.0, false, 0.0, 200000.0f},
        {"960x540, the same, rays as in motion", VELUM_QUALITY_MEDIUM, 1, 960, 540, 0.0, true, 0.0, 200000.0f}};
    return under_broken_sky(b, variants, 6);
}

static bool broken_sky_gpu(bench *b) {
    static const variant variants[] = {
        {"medium", VELUM_QUALITY_MEDIUM, 1, 1920, 1080, 0.0, false, 0.20, 0.0f},
        {"high", VELUM_QUALITY_HIGH, 1, 1920, 1080, 0.0, false, 0.50, 0.0f},
        {"medium, rays as in motion", VELUM_QUALITY_MEDIUM, 1, 1920, 1080, 0.0, true, 0.20, 0.0f},
        {"high, the same", VELUM_QUALITY_HIGH, 1, 1920, 1080, 0.0, true, 0.50, 0.0f}};
    if (b->device.is_processor) {
        bench_skip(b, "needs a GPU: its bounds are of such");
        return true;
    }
    return under_broken_sky(b, variants, 4);
}

/* Ten minutes of wind: tiles change when the weather does. */
static bool wind(bench *b) {
    scene s;
    scene_eye eye = {.count = 0};
    if (!scene_init(&s, b)) {
        return false;
    }
    velum_world_info before = {.struct_size = sizeof before};
    velum_world_info after = before;
    bool ok = scene_eye_init(&s, &eye, VELUM_QUALITY_LOW, 1, 160, 90) && scene_settle(&s, &eye, 1);
    b->host.world->get_info(s.world, &before);
    for (int i = 0; i < 60 && ok; i++) {
        scene_frame frame;
        double unused_ms;
        s.time_s += 10.0;
        ok = scene_prepare(&s, &unused_ms) && scene_draw(&s, &eye, &frame);
    }
    b->host.world->get_info(s.world, &after);
    if (ok) {
        bench_report_value(b, "600 s of wind", "tiles_before", "1", (double)before.tiles_rasterised);
        bench_report_value(b, "600 s of wind", "tiles_rebuilt", "1",
                           (double)(after.tiles_rasterised - before.tiles_rasterised));
    }
    if (eye.eye) {
        scene_eye_finish(&eye, &s);
    }
    scene_finish(&s);
    return ok;
}

static bool memory(bench *b) {
    scene s;
    scene_eye eye = {.count = 0};
    if (!scene_init(&s, b)) {
        return false;
    }
    scene_frame frame = {0};
    bool ok = scene_eye_init(&s, &eye, VELUM_QUALITY_MEDIUM, 3, 640, 360) && scene_settle(&s, &eye, 2) &&
              scene_draw(&s, &eye, &frame);
    velum_world_info info = {.struct_size = sizeof info};
    b->host.world->get_info(s.world, &info);
    if (ok) {
        bench_report_value(b, "3 channels", "weather_memory", "bytes", frame.weather_bytes);
        bench_report_value(b, "3 channels", "view_memory", "bytes", frame.view_bytes);
        bench_report_value(b, "3 channels", "world_host_memory", "bytes", (double)info.bytes);
        bench_report_value(b, "3 channels", "tiles_resident", "1", (double)info.tiles_resident);
    }
    if (eye.eye) {
        scene_eye_finish(&eye, &s);
    }
    eye = (scene_eye){.count = 0};
    ok = ok && scene_eye_init(&s, &eye, VELUM_QUALITY_MEDIUM, 1, 1920, 1080) && scene_settle(&s, &eye, 2) &&
         scene_draw(&s, &eye, &frame);
    if (ok) {
        bench_report_value(b, "1920x1080", "view_memory", "bytes", frame.view_bytes);
    }
    if (eye.eye) {
        scene_eye_finish(&eye, &s);
    }
    scene_finish(&s);
    return ok;
}

/* A cut: the first frames of a view, until it has settled. */
static bool first_frames(bench *b) {
    scene s;
    double start_ms = bench_now_ms();
    if (!scene_init(&s, b)) {
        return false;
    }
    bench_report_value(b, "start", "create_engine", "ms", bench_now_ms() - start_ms);
    scene_eye eye = {.count = 0};
    bool ok = scene_eye_init(&s, &eye, VELUM_QUALITY_MEDIUM, 1, 640, 360);
    static const char *const names[] = {"frame 1", "frame 2", "frame 3", "frame 4"};
    for (uint32_t i = 0; i < 4 && ok; i++) {
        scene_frame frame;
        ok = scene_draw(&s, &eye, &frame);
        if (ok) {
            bench_report_value(b, names[i], "frame", "ms", frame.wall_ms);
        }
    }
    if (eye.eye) {
        scene_eye_finish(&eye, &s);
    }
    scene_finish(&s);
    return ok;
}

const bench_case bench_frame_cases[] = {
    {"channels", "1, 2 and 3 channels of 640x360, settled, medium; the cost of each", channels},
    {"channels_playing", "the same while time goes on: 1/60 s a frame, a shadow map renewed", channels_playing},
    {"resolutions", "640x360, 960x540, 1920x1080, one view, settled, medium", resolutions},
    {"views", "1 to 4 views of 640x360, settled, medium", views},
    {"presets", "low, medium, high, ultra; one view of 640x360, settled", presets},
    {"broken_sky", "standing under three broken layers (Cu, Ac, Ci), wind on, sky and shadow map included, medium",
     broken_sky},
    {"broken_sky_gpu", "the same at 1920x1080, medium and high, for a GPU of the H200 class", broken_sky_gpu},
    {"first_frames", "making an engine, and the first frames of a view without prepare()", first_frames},
    {"wind", "tiles rebuilt while only the wind blows", wind},
    {"memory", "device memory of the weather with three channels, and of views", memory},
    {NULL, NULL, NULL},
};
