/* A flight from clear sky into a thunderstorm with a budget of time: how well it is kept, and whether quality pumps.
 * Once by the device's times, with their noise, and once by the work that is counted in each frame, without any. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "plugin/governor.h"
#include "plugin/preset_figures.h"
#include "scene.h"

/* A flight at 12 Hz: 20 m a frame. Work is counted at every sixth. */
enum { COUNTED_WIDTH = 192, COUNTED_HEIGHT = 108, COUNTED_FRAMES = 1200, BETWEEN = 6, MEDIUM = 1 };
enum { FRAMES = (COUNTED_FRAMES - 1) * BETWEEN, STORM_FRAMES = 24, RUNNING = 9 };
#define TOLERANCE 0.1
/* Turns of quality by less are not seen: 19 % of march time. */
#define SEEN_OCTAVES 0.25

typedef struct flight_frame {
    double ms;      /* or what is counted */
    double quality; /* log2 of rays a pixel and of steps a metre, or the governor's octaves */
    bool told;      /* its reasons say why the time cannot be met: too dear at the least, or cheaper at the best */
    bool waits;     /* under it, and they say that twice the rays would be too dear */
    bool begins;    /* nothing is governed yet, or there is no cloud */
} flight_frame;

static flight_frame frames[FRAMES];

static bool fly_to(scene *s, const velum_scenario *scenario, double time_s) {
    velum_scenario_camera pose;
    double unused_ms;
    velum_scenario_pose(scenario, time_s, &pose);
    velum_scenario_pose_ecef(&pose, s->position_ecef_m, s->right, s->up, s->forward);
    s->time_s = time_s;
    return scene_prepare(s, &unused_ms);
}

static double eye_ms(const scene_frame *f) {
    return f->march_ms + f->resolve_ms + f->shared_ms;
}

/* Median time of a preset at the end of the flight. */
static bool storm_ms(scene *s, const velum_scenario *scenario, int32_t quality, double *out) {
    static bench_series series;
    scene_eye eye;
    scene_frame frame;
    series = (bench_series){.count = 0};
    if (!fly_to(s, scenario, 0.8 * scenario->duration_s) ||
        !scene_eye_init(s, &eye, quality, 1, s->b->width, s->b->height)) {
        return false;
    }
    bool ok = scene_settle(s, &eye, 2);
    for (uint32_t i = 0; i < STORM_FRAMES && ok; i++) {
        ok = fly_to(s, scenario, 0.8 * scenario->duration_s + i) && scene_draw(s, &eye, &frame);
        bench_add(&series, eye_ms(&frame));
    }
    scene_eye_finish(&eye, s);
    *out = bench_median(&series);
    return ok;
}

static bool draw_frame(scene *s, scene_eye *eye, flight_frame *out) {
    scene_frame frame;
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = "";
    if (!scene_draw(s, eye, &frame) || s->b->host.engine->get_plan(eye->eye, &plan, &reasons) < 0) {
        return false;
    }
    out->ms = eye_ms(&frame);
    out->quality = -log2((double)plan.ray_rate) - log2((double)plan.step_m);
    out->told = (strstr(reasons, "even the least plan") && out->ms > (double)s->budget_ms) ||
                (strstr(reasons, "the best plan is cheaper") && out->ms < (double)s->budget_ms);
    out->waits = strstr(reasons, "twice the rays") && out->ms < (double)s->budget_ms;
    out->begins = strstr(reasons, "too few frames") || strstr(reasons, "no cloud");
    return true;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Median of the frames around one. */
static double running_ms(uint32_t at) {
    double sorted[RUNNING];
    uint32_t first = at < RUNNING / 2 ? 0 : at > FRAMES - 1 - RUNNING / 2 ? FRAMES - RUNNING : at - RUNNING / 2;
    for (uint32_t i = 0; i < RUNNING; i++) {
        sorted[i] = frames[first + i].ms;
    }
    qsort(sorted, RUNNING, sizeof sorted[0], compare);
    return sorted[RUNNING / 2];
}

static void report_flight(const bench *b, const char *name, double budget_ms) {
    static bench_series times, jitter;
    uint32_t governed = 0, told = 0, within = 0, over = 0, waits = 0, running = 0, turns = 0;
    int direction = 0;
    double extreme = frames[0].quality;
    times = jitter = (bench_series){.count = 0};
    for (uint32_t i = 0; i < FRAMES; i++) {
        const flight_frame *f = &frames[i];
        double up = f->quality - extreme;
        if (direction != 0 && up * direction > 0.0) {
            extreme = f->quality;
        } else if (fabs(up) > SEEN_OCTAVES) {
            turns += direction != 0;
            direction = up > 0.0 ? 1 : -1;
            extreme = f->quality;
        }
        if (f->begins) {
            continue;
        }
        governed++;
        told += f->told;
        within += fabs(f->ms / budget_ms - 1.0) <= TOLERANCE || f->told;
        running += fabs(running_ms(i) / budget_ms - 1.0) <= TOLERANCE || f->told;
        waits += f->waits && f->ms < (1.0 - TOLERANCE) * budget_ms;
        over += f->ms > (1.0 + TOLERANCE) * budget_ms && !f->told;
        bench_add(&times, f->ms);
        if (i > 0 && f->quality == frames[i - 1].quality && !frames[i - 1].begins) {
            bench_add(&jitter, fabs(f->ms / frames[i - 1].ms - 1.0));
        }
    }
    double count = governed > 0 ? governed : 1;
    bench_report_value(b, name, "budget", "ms or samples a pixel", budget_ms);
    bench_report_value(b, name, "frames_with_cloud", "1", governed);
    bench_report(b, name, "frame", "ms or samples a pixel", &times);
    bench_report_value(b, name, "within_10_percent", "1", within / count);
    bench_report_value(b, name, "within_10_percent_median_of_9", "1", running / count);
    bench_report_value(b, name, "of_these_told_why_not", "1", told / count);
    bench_report_value(b, name, "over_10_percent", "1", over / count);
    bench_report_value(b, name, "under_as_twice_the_rays_are_too_dear", "1", waits / count);
    bench_report_value(b, name, "turns_of_quality", "1", turns);
    bench_report(b, name, "frame_to_frame_same_plan", "1", &jitter);
}

static bool fly(bench *b, scene *s, const velum_scenario *scenario, const char *name, int32_t quality) {
    scene_eye eye;
    double budget_ms;
    s->budget_ms = 0.0f;
    if (!storm_ms(s, scenario, quality, &budget_ms)) {
        return false;
    }
    s->budget_ms = (float)budget_ms;
    bool ok = budget_ms > 0.0;
    if (!ok) {
        bench_skip(b, "the device has no timestamps");
        return true;
    }
    ok = fly_to(s, scenario, 0.0) && scene_eye_init(s, &eye, VELUM_QUALITY_MEDIUM, 1, b->width, b->height);
    if (!ok) {
        return false;
    }
    for (uint32_t i = 0; i < FRAMES && ok; i++) {
        ok = fly_to(s, scenario, scenario->duration_s * i / FRAMES) && draw_frame(s, &eye, &frames[i]);
    }
    scene_eye_finish(&eye, s);
    if (ok) {
        report_flight(b, name, budget_ms);
    }
    return ok;
}

/* Samples of a ray at medium, of each frame of the flight. */
static bool count_work(scene *s, const velum_scenario *scenario, double *samples) {
    scene_eye eye;
    s->budget_ms = 0.0f;
    if (!fly_to(s, scenario, 0.0) || !scene_eye_init(s, &eye, VELUM_QUALITY_MEDIUM, 1, COUNTED_WIDTH, COUNTED_HEIGHT)) {
        return false;
    }
    bool ok = true;
    for (uint32_t i = 0; i < COUNTED_FRAMES && ok; i++) {
        scene_frame frame;
        ok = fly_to(s, scenario, scenario->duration_s * i / COUNTED_FRAMES) && scene_draw(s, &eye, &frame);
        samples[i] = ok ? (frame.samples + frame.light_samples) / fmax(frame.rays, 1.0) : 0.0;
    }
    scene_eye_finish(&eye, s);
    return ok;
}

/* A device whose time is what is counted: a ray costs as much as so many samples (lavapipe: low and ultra in a storm
 * differ by 0.54 us a sample, and 17 us a ray are left). Resolve and shared passes take 15 % of the budget. */
#define RAY_SAMPLES 31.0
#define REST_SHARE 0.15

static double samples_over_medium(float preset) {
    uint32_t below = preset >= (float)(PRESETS - 2) ? PRESETS - 2 : (uint32_t)preset;
    double a = log((double)preset_figures_of[below].samples);
    double c = log((double)preset_figures_of[below + 1].samples);
    return exp(a + ((double)preset - below) * (c - a)) / (double)preset_figures_of[MEDIUM].samples;
}

static void fly_counted(const double *samples, double budget, uint32_t delay) {
    static governor_setting settings[FRAMES];
    const governor_setting best = {.ray_rate = 1, .preset = (float)(PRESETS - 1)};
    governor g;
    governor_init(&g, (float)budget, MEDIUM, best);
    for (uint32_t i = 0; i < FRAMES; i++) {
        flight_frame *f = &frames[i];
        double share = (double)(i % BETWEEN) / BETWEEN;
        double here = (1.0 - share) * samples[i / BETWEEN] + share * samples[i / BETWEEN + 1];
        if (i > delay) {
            const uint32_t done = i - delay - 1;
            const double rest = REST_SHARE * budget;
            const governor_frame learnt = {settings[done], (float)(frames[done].ms - rest), (float)rest};
            governor_learn(&g, &learnt);
        }
        settings[i] = governor_next(&g);
        f->ms = REST_SHARE * budget + (RAY_SAMPLES + here * samples_over_medium(settings[i].preset)) *
                                          (1.0 + 3.0 * settings[i].finer / 64.0) / (double)settings[i].ray_rate;
        f->quality = (double)governor_octaves(&g);
        f->waits = g.doing == GOVERNOR_WAITS && f->ms < budget;
        f->begins = g.doing == GOVERNOR_BEGINS;
        f->told = (g.doing == GOVERNOR_LEAST && f->ms > budget) || (g.doing == GOVERNOR_MOST && f->ms < budget);
    }
}

static bool fly_by_count(bench *b, scene *s, const velum_scenario *scenario) {
    static double samples[COUNTED_FRAMES];
    static bench_series storm;
    static const char *const names[] = {"counted work, 1 frame late", "counted work, 3 frames late"};
    if (!count_work(s, scenario, samples)) {
        return false;
    }
    storm = (bench_series){.count = 0};
    for (uint32_t i = COUNTED_FRAMES * 3 / 4; i < COUNTED_FRAMES; i++) {
        bench_add(&storm, samples[i]);
    }
    double budget = (RAY_SAMPLES + bench_median(&storm)) / 16.0 / (1.0 - REST_SHARE);
    for (uint32_t k = 0; k < 2; k++) {
        fly_counted(samples, budget, 1 + 2 * k);
        report_flight(b, names[k], budget);
    }
    return true;
}

static bool budget(bench *b) {
    scene s;
    velum_scenario *scenario = NULL;
    velum_weather_error error = {{0}, 0, 0, 0, {0}};
    velum_weather_report report = {0};
    const char *asked = b->scenario;
    b->scenario = asked ? asked : BENCH_FLIGHT;
    bool ok = false;
    if (velum_scenario_load(b->scenario, NULL, 0, &scenario, &report, &error) < 0) {
        fprintf(stderr, "velum-bench: %s\n", error.text);
    } else if (scene_init(&s, b)) {
        ok = fly_by_count(b, &s, scenario) && fly(b, &s, scenario, "device, medium's time", VELUM_QUALITY_MEDIUM);
        scene_finish(&s);
    }
    velum_scenario_destroy(scenario);
    b->scenario = asked;
    return ok;
}

const bench_case bench_budget_cases[] = {
    {"budget", "a flight from clear sky into a thunderstorm, medium, with the time that medium takes there", budget},
    {NULL, NULL, NULL},
};
