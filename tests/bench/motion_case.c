/* One ray for 16 pixels and history, against a ray for every pixel, in motion. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "playback.h"

#define DEG (3.14159265358979323846 / 180.0)
#define FRAME_S (1.0 / 60.0)
#define TIME_BOUND (1.0 / 12.0)
#define ERROR_BOUND 0.03
/* Relative difference that is drawn in full colour. */
#define SHOWN_DIFFERENCE 0.3

/* Frames before a compared one in which every pixel has its ray: its history counts for three samples at most. */
enum { COMPARED_MOST = 8, EVERY_PIXEL_FRAMES = 8, TRUTH_FRAMES = 16, PATH_STEPS = 4000 };
#define PATH_STEP_M 5.0
#define FLIGHT_M_S 250.0

typedef struct motion motion;
struct motion {
    const char *name;
    const char *scene; /* of tests/accuracy/scenes */
    float wind_east_m_s;
    void (*move)(const motion *m, const stage_camera *c, double t_s, stage_camera *out);
    bool (*find_start)(playback *p, motion *m, const stage_camera *c); /* null: where the camera stands */
    bool is_cut;                                                       /* each compared frame is judged by itself */
    bool has_peak;                                                     /* the host draws one and gives its depth */
    uint32_t compared[COMPARED_MOST]; /* frames since the cut that begins, the cut's own being 1; ends with 0 */
    double start_m;                   /* along the flight, at frame 0 */
};

static void stand(const motion *m, const stage_camera *c, double t_s, stage_camera *out) {
    (void)m, (void)t_s;
    *out = *c;
}

/* From 30 degrees at one side through level flight, on and on. */
static void bank(const motion *m, const stage_camera *c, double t_s, stage_camera *out) {
    (void)m;
    double angle = (60.0 * t_s - 30.0) * DEG;
    *out = *c;
    for (int i = 0; i < 3; i++) {
        out->right[i] = cos(angle) * c->right[i] - sin(angle) * c->up[i];
        out->up[i] = cos(angle) * c->up[i] + sin(angle) * c->right[i];
    }
}

static void fly(const motion *m, const stage_camera *c, double t_s, stage_camera *out) {
    *out = *c;
    for (int i = 0; i < 3; i++) {
        out->position_m[i] += (m->start_m + FLIGHT_M_S * t_s) * c->forward[i];
    }
}

/* A peak beside the way: a cone of so much width to its height. Over the right, up and forward of the camera at the
 * start, m. */
#define PEAK_SLOPE 0.45
static const double peak_m[3] = {200.0, 150.0, 900.0};

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Way to the peak along a ray, from a place, in those axes; 0: it is missed. */
static double peak_along_m(const double from_m[3], const double ray[3]) {
    const double k2 = PEAK_SLOPE * PEAK_SLOPE;
    double q[3];
    for (int i = 0; i < 3; i++) {
        q[i] = from_m[i] - peak_m[i];
    }
    const double a = ray[0] * ray[0] + ray[2] * ray[2] - k2 * ray[1] * ray[1];
    const double b = q[0] * ray[0] + q[2] * ray[2] - k2 * q[1] * ray[1];
    const double d = b * b - a * (q[0] * q[0] + q[2] * q[2] - k2 * q[1] * q[1]);
    double nearest = 0.0;
    for (int side = -1; side <= 1 && d > 0.0; side += 2) {
        const double t = (-b + side * sqrt(d)) / a;
        if (t > 0.0 && q[1] + t * ray[1] < 0.0 && (nearest == 0.0 || t < nearest)) {
            nearest = t;
        }
    }
    return nearest;
}

/* What the host would give of the peak, as seen by `now`. */
static void draw_peak(const stage_camera *start, const stage_camera *now, uint32_t width, uint32_t height, float *out) {
    double moved[3];
    for (int i = 0; i < 3; i++) {
        moved[i] = now->position_m[i] - start->position_m[i];
    }
    const double from_m[3] = {dot(moved, start->right), dot(moved, start->up), dot(moved, start->forward)};
    for (uint32_t i = 0; i < width * height; i++) {
        const double x = now->tan_x * (2.0 * (i % width + 0.5) / width - 1.0);
        const double y = now->tan_y * (1.0 - 2.0 * (i / width + 0.5) / height);
        double world[3];
        for (int axis = 0; axis < 3; axis++) {
            world[axis] = now->forward[axis] + x * now->right[axis] + y * now->up[axis];
        }
        const double length = sqrt(dot(world, world));
        const double ray[3] = {dot(world, start->right) / length, dot(world, start->up) / length,
                               dot(world, start->forward) / length};
        out[i] = (float)peak_along_m(from_m, ray);
    }
}

static bool extinction_at(playback *p, const stage_camera *c, double along_m, double *out_1_m) {
    velum_point_query query = {.struct_size = sizeof query};
    velum_point_answer answer = {.struct_size = sizeof answer};
    for (int i = 0; i < 3; i++) {
        query.position_ecef_m[i] = c->position_m[i] + along_m * c->forward[i];
    }
    velum_result result = p->s.host.world->query_point(p->s.world, &query, &answer);
    if (result < 0) {
        stage_fail(&p->s, "query", result);
    }
    *out_1_m = (double)answer.extinction_1_m;
    return result >= 0;
}

/* Where clear air of 200 m at least ends in cloud of as much, or the other way round. The compared frames lie about it:
 * `before` frames are flown until then. */
static bool find_face(playback *p, motion *m, const stage_camera *c, bool into, uint32_t before) {
    const uint32_t wanted = (uint32_t)(200.0 / PATH_STEP_M);
    uint32_t run = 0, earlier = 0;
    bool inside = false;
    for (uint32_t i = 0; i < PATH_STEPS; i++) {
        double extinction_1_m;
        if (!extinction_at(p, c, PATH_STEP_M * i, &extinction_1_m)) {
            return false;
        }
        bool cloud = extinction_1_m > 1e-3;
        if (cloud != inside) {
            earlier = run;
            run = 0;
            inside = cloud;
        }
        run++;
        if (inside == into && run == wanted && earlier >= wanted) {
            double face_m = PATH_STEP_M * (i + 1 - wanted);
            double back_m = FLIGHT_M_S * FRAME_S * before;
            if (face_m > back_m) {
                m->start_m = face_m - back_m;
                return true;
            }
        }
    }
    fprintf(stderr, "velum-bench: %s: no such cloud within %g km\n", m->name, 1e-3 * PATH_STEP_M * PATH_STEPS);
    return false;
}

/* Frames until the face: those compared lie 13 m before it, and 8 and 42 m behind. */
enum { FACE_FRAME = 35 };
static bool find_way_in(playback *p, motion *m, const stage_camera *c) {
    return find_face(p, m, c, true, FACE_FRAME);
}
static bool find_way_out(playback *p, motion *m, const stage_camera *c) {
    return find_face(p, m, c, false, FACE_FRAME);
}

static const motion motions[] = {
    {.name = "standing",
     .scene = "broken_below",
     .wind_east_m_s = 12.0f,
     .move = stand,
     .compared = {40, 52, 240, 360}},
    {.name = "banking", .scene = "broken_below", .wind_east_m_s = 12.0f, .move = bank, .compared = {30, 45}},
    {.name = "flying", .scene = "broken_between", .move = fly, .compared = {30, 60}},
    {.name = "into_cloud", .scene = "broken_between", .move = fly, .find_start = find_way_in, .compared = {33, 38, 46}},
    {.name = "out_of_cloud",
     .scene = "broken_between",
     .move = fly,
     .find_start = find_way_out,
     .compared = {33, 38, 46}},
    {.name = "past_a_peak", .scene = "broken_between", .move = fly, .has_peak = true, .compared = {30, 60}},
    {.name = "cut",
     .scene = "broken_below",
     .wind_east_m_s = 12.0f,
     .move = stand,
     .is_cut = true,
     .compared = {1, 2, 4, 8, 16}},
};

/* What a motion gave. */
typedef struct outcome {
    bench_series preset_ms, every_pixel_ms, time_ratio;
    bench_series error, beyond, error_8, bias, p99, every_pixel_error, truth_noise;
    double worst;
} outcome;

static bool error_of_blocks(const picture *a, const picture *b, double *out) {
    const uint32_t side = 8, blocks = ((a->width + side - 1) / side) * ((a->height + side - 1) / side);
    float *means = calloc(2u * blocks, sizeof *means);
    metric m = {0};
    bool ok = means != NULL;
    if (ok) {
        metric_blocks(a->luminance, NULL, a->width, a->height, side, means, NULL);
        metric_blocks(b->luminance, NULL, b->width, b->height, side, means + blocks, NULL);
        ok = metric_compute(means, means + blocks, NULL, blocks, &m);
    }
    free(means);
    *out = m.error_raw;
    return ok;
}

/* Every pixel its ray; 1/16; settled; their difference. */
static bool save(const playback *p, const char *name) {
    const picture *truth = &p->truth.now;
    const uint32_t gap = 4;
    sheet s;
    char path[1024];
    if (!sheet_init(&s, 2 * truth->width + gap, 2 * truth->height + gap)) {
        return false;
    }
    double exposure = picture_exposure(truth);
    sheet_put_picture(&s, 0, 0, &p->preset.now, exposure);
    sheet_put_picture(&s, truth->width + gap, 0, truth, exposure);
    sheet_put_picture(&s, 0, truth->height + gap, &p->every_pixel.now, exposure);
    snprintf(path, sizeof path, "%s/motion_%s.png", p->b->out, name);
    bool ok =
        sheet_put_difference(&s, truth->width + gap, truth->height + gap, &p->preset.now, truth, SHOWN_DIFFERENCE) &&
        sheet_write(&s, path);
    sheet_finish(&s);
    return ok;
}

/* What history and few rays add to the error that the motion makes with every ray. */
static double beyond(const metric *preset, const metric *every) {
    return sqrt(fmax(preset->error_raw * preset->error_raw - every->error_raw * every->error_raw, 0.0));
}

static bool compare(playback *p, const motion *m, const stage_camera *c, uint32_t frame, double time_s, outcome *o) {
    const picture *preset = &p->preset.now, *every = &p->every_pixel.now, *truth = &p->truth.now;
    metric of_preset, of_every;
    double error_8;
    if (!playback_draw_truth(p, c, time_s, TRUTH_FRAMES) ||
        !metric_compute(preset->luminance, truth->luminance, NULL, preset->count, &of_preset) ||
        !metric_compute(every->luminance, truth->luminance, NULL, every->count, &of_every) ||
        !error_of_blocks(preset, truth, &error_8)) {
        fprintf(stderr, "velum-bench: %s: nothing to compare\n", m->name);
        return false;
    }
    bench_add(&o->error, of_preset.error_raw);
    bench_add(&o->beyond, beyond(&of_preset, &of_every));
    bench_add(&o->error_8, error_8);
    bench_add(&o->bias, of_preset.bias);
    bench_add(&o->p99, of_preset.p99);
    bench_add(&o->every_pixel_error, of_every.error_raw);
    bench_add(&o->truth_noise, p->truth_noise);
    if (m->is_cut) {
        char variant[64];
        snprintf(variant, sizeof variant, "%s, %u frames", m->name, frame);
        bench_judge_value(p->b, variant, "added_error", "1", of_preset.error_raw, BENCH_AT_MOST, ERROR_BOUND);
        bench_report_value(p->b, variant, "every_pixel_error", "1", of_every.error_raw);
    }
    bool worst = of_preset.error_raw > o->worst;
    o->worst = worst ? of_preset.error_raw : o->worst;
    return !worst || !p->b->out || save(p, m->name);
}

/* Whether every pixel has its ray in a frame, and how many frames it has had. */
static bool needs_every_pixel(const motion *m, uint32_t frame, bool *out_begins) {
    for (const uint32_t *at = m->compared; *at; at++) {
        if (frame <= *at && frame + EVERY_PIXEL_FRAMES > *at) {
            bool joined = at > m->compared && at[-1] + EVERY_PIXEL_FRAMES >= *at;
            *out_begins = frame == 1 || (!joined && frame + EVERY_PIXEL_FRAMES == *at + 1);
            return true;
        }
    }
    return false;
}

static bool play(playback *p, const motion *m, const stage_camera *c, float *depth, outcome *o) {
    const uint32_t *at = m->compared;
    p->preset.v.depth = p->every_pixel.v.depth = p->truth.v.depth = depth;
    for (uint32_t frame = 1; *at; frame++) {
        const double t_s = FRAME_S * (frame - 1);
        stage_camera now;
        bool begins = false;
        m->move(m, c, t_s, &now);
        if (depth) {
            draw_peak(c, &now, p->b->width, p->b->height, depth);
        }
        if ((frame % 8 == 0 && !stage_prepare(&p->s, &now, p->b->width, t_s)) ||
            !playback_draw(p, &p->preset, &now, t_s, frame == 1 ? VELUM_VIEW_CUT : 0)) {
            return false;
        }
        if (needs_every_pixel(m, frame, &begins)) {
            if (!playback_draw(p, &p->every_pixel, &now, t_s, begins ? VELUM_VIEW_CUT : 0)) {
                return false;
            }
            bench_add(&o->preset_ms, p->preset.cost.view_ms);
            bench_add(&o->every_pixel_ms, p->every_pixel.cost.view_ms);
            bench_add(&o->time_ratio, p->preset.cost.view_ms / p->every_pixel.cost.view_ms);
        }
        if (frame == *at) {
            if (!compare(p, m, &now, frame, t_s, o)) {
                return false;
            }
            at++;
        }
    }
    return true;
}

static void report(const bench *b, const motion *m, const outcome *o) {
    bench_report(b, m->name, "view", "ms", &o->preset_ms);
    bench_report(b, m->name, "view_every_pixel", "ms", &o->every_pixel_ms);
    bench_judge(b, m->name, "time_ratio", "1", &o->time_ratio, BENCH_AT_MOST, TIME_BOUND);
    if (!m->is_cut) {
        bench_judge(b, m->name, "added_error", "1", &o->error, BENCH_AT_MOST, ERROR_BOUND);
        bench_report(b, m->name, "every_pixel_error", "1", &o->every_pixel_error);
    }
    bench_report(b, m->name, "beyond_every_pixel", "1", &o->beyond);
    bench_report(b, m->name, "added_error_8x8", "1", &o->error_8);
    bench_report(b, m->name, "bias", "1", &o->bias);
    bench_report(b, m->name, "p99", "1", &o->p99);
    bench_report(b, m->name, "truth_left_unsure", "1", &o->truth_noise);
}

/* The motion that the case is named after. */
static bool motion_case(bench *b) {
    static outcome o;
    motion m = {.name = NULL};
    for (size_t i = 0; i < sizeof motions / sizeof motions[0]; i++) {
        if (strcmp(b->case_name + strlen("motion_"), motions[i].name) == 0) {
            m = motions[i];
        }
    }
    playback p = {.b = b};
    stage_camera c;
    memset(&o, 0, sizeof o);
    float *depth = m.has_peak ? calloc((size_t)b->width * b->height, sizeof *depth) : NULL;
    bool ok = m.name && (depth || !m.has_peak) && playback_init(&p, b) &&
              playback_load(&p, ACCURACY_SCENES, m.scene, m.wind_east_m_s, &c) &&
              (!m.find_start || m.find_start(&p, &m, &c)) && play(&p, &m, &c, depth, &o);
    if (ok) {
        report(b, &m, &o);
    }
    playback_finish(&p);
    free(depth);
    return ok;
}

const bench_case bench_motion_cases[] = {
    {"motion_standing", "1 ray for 16 pixels against every pixel, standing, wind on", motion_case},
    {"motion_banking", "the same, banking at 60 degrees a second", motion_case},
    {"motion_flying", "the same, level flight at 250 m/s between broken cumulus", motion_case},
    {"motion_into_cloud", "the same, flying into a cloud", motion_case},
    {"motion_out_of_cloud", "the same, flying out of a cloud", motion_case},
    {"motion_past_a_peak", "the same as motion_flying, past a peak whose depth the host gives", motion_case},
    {"motion_cut", "the same, 1, 2, 4, 8 and 16 frames after a cut", motion_case},
    {NULL, NULL, NULL},
};
