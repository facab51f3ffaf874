/* Clocks, moves and what history makes of them. */
#include "stability.h"

#include <math.h>

#define YEAR_S 31557600.0
#define LATE_S 1e9
#define FRAME_S (1.0 / 60.0)

static stage_camera over_field(void) {
    return trial_camera(50.0, 8.5, 300.0, 90.0, 20.0, 0.6);
}

/* Of one settled picture from another, `later_s` apart. */
static double change_after(trial *t, float wind_east_m_s, double time_s, double later_s) {
    trial_weather w = trial_air(TRIAL_CUMULUS("0.45"), 40.0);
    const stage_camera c = over_field();
    picture kept = {0};
    w.wind_east_m_s = wind_east_m_s;
    bool ok = trial_settle(t, &w, &c, time_s) && trial_keep(t, &kept) &&
              trial_draw(t, &c, time_s + later_s, VELUM_VIEW_CUT, TRIAL_SETTLE);
    double change = ok ? trial_difference(t, &kept) : NAN;
    picture_finish(&kept);
    return change;
}

static bool wind_late(trial *t) {
    double early = change_after(t, 10.0f, 0.0, FRAME_S);
    double year = change_after(t, 10.0f, YEAR_S, FRAME_S);
    double late = change_after(t, 10.0f, LATE_S, FRAME_S);
    t->value = trial_worse(year, late) - early;
    snprintf(t->text, sizeof t->text, "%.4g at 0, %.4g after a year, %.4g at 1e9 s", early, year, late);
    return true;
}

/* At these times no life of the noise gives way to the next. */
static bool calm_late(trial *t) {
    t->value = trial_worse(change_after(t, 0.0f, YEAR_S, FRAME_S), change_after(t, 0.0f, LATE_S, FRAME_S));
    double minute = change_after(t, 0.0f, LATE_S, 60.0);
    t->value = trial_worse(t->value, minute);
    return true;
}

/* In the middle of a fade: see core/drift.h. */
static bool calm_fade(trial *t) {
    const double fade_s = 6000.0 * floor(LATE_S / 6000.0);
    double early = change_after(t, 0.0f, 6000.0, FRAME_S);
    double late = change_after(t, 0.0f, fade_s, FRAME_S);
    t->value = late - early;
    snprintf(t->text, sizeof t->text, "%.3g at 6000 s, %.3g at 1e9 s; %.3g in a minute", early, late,
             change_after(t, 0.0f, fade_s, 60.0));
    return true;
}

static bool late_queries(trial *t) {
    static const double starts_s[] = {0.0, YEAR_S, LATE_S - 2e5};
    double mean[3] = {0}, worst, one;
    for (int i = 0; i < 9; i++) {
        double time_s = starts_s[i / 3] + 5e4 * (i % 3);
        trial_weather w = trial_no_air(TRIAL_CUMULUS("0.45"));
        const stage_camera c = over_field();
        w.wind_east_m_s = 10.0f;
        if (!trial_settle(t, &w, &c, time_s) || !trial_transmittance(t, &c, time_s, &worst, &one)) {
            return false;
        }
        mean[i / 3] += one / 3.0;
    }
    t->value = trial_worse(mean[1], mean[2]) - mean[0];
    snprintf(t->text, sizeof t->text, "%.3g at 0, %.3g after a year, %.3g at 1e9 s", mean[0], mean[1], mean[2]);
    return true;
}

/* What history does to a settled picture: `disturb` ends with one frame where `c` stands, at time 0. */
typedef struct disturbance {
    bool (*disturb)(trial *t, const stage_camera *c);
    float wind_east_m_s;
    bool is_cut; /* its last frame is to be as the first after a cut */
} disturbance;

static bool settled_after(trial *t, const disturbance *d) {
    trial_weather w = trial_air(TRIAL_CUMULUS("0.45"), 40.0);
    picture first = {0}, fresh = {0};
    const stage_camera c = trial_camera(50.0, 8.5, 300.0, 90.0, 15.0, 0.6);
    w.wind_east_m_s = d->wind_east_m_s;
    bool ok = trial_load(t, &w) && trial_open(t, TRIAL_WIDE, TRIAL_HIGH) && trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, 1) &&
              trial_keep(t, &first) && trial_draw(t, &c, 0.0, 0, TRIAL_SETTLE - 1) && trial_keep(t, &fresh) &&
              trial_open(t, TRIAL_WIDE, TRIAL_HIGH) && d->disturb(t, &c);
    double at_once = ok ? trial_difference(t, d->is_cut ? &first : &fresh) : NAN;
    /* With the disturbance's last, or from it on. */
    ok = ok && trial_draw(t, &c, 0.0, 0, d->is_cut ? TRIAL_SETTLE - 1 : TRIAL_SETTLE);
    double settled = ok ? trial_difference(t, &fresh) : NAN;
    t->value = d->is_cut ? trial_worse(settled, at_once) : settled;
    snprintf(t->text, sizeof t->text, "%.3g in the first frame%s", at_once,
             d->is_cut ? ", from the first after a cut" : ", from the settled picture");
    picture_finish(&first);
    picture_finish(&fresh);
    return ok;
}

static bool jump(trial *t, const stage_camera *c, uint32_t flags) {
    const stage_camera far = trial_camera(40.0, 20.0, 5000.0, 200.0, -20.0, 0.6);
    return trial_draw(t, &far, 0.0, VELUM_VIEW_CUT, TRIAL_SETTLE) && trial_draw(t, c, 0.0, flags, 1);
}

static bool disturb_teleport(trial *t, const stage_camera *c) {
    return jump(t, c, 0);
}

static bool disturb_cut(trial *t, const stage_camera *c) {
    return jump(t, c, VELUM_VIEW_CUT);
}

/* As many metres ahead as an aircraft might fly in a few seconds: not far enough to be seen as a jump. */
static bool disturb_hop(trial *t, const stage_camera *c) {
    stage_camera there = *c;
    for (int k = 0; k < 3; k++) {
        there.position_m[k] -= 800.0 * c->forward[k];
    }
    return trial_draw(t, &there, 0.0, VELUM_VIEW_CUT, TRIAL_SETTLE) && trial_draw(t, c, 0.0, 0, 1);
}

/* At 250 m/s, each pose shown for `repeats` frames. */
static bool fly_in(trial *t, const stage_camera *c, int repeats) {
    for (int i = 60; i >= 0; i--) {
        stage_camera moving = *c;
        for (int k = 0; k < 3; k++) {
            moving.position_m[k] -= 250.0 * FRAME_S * (i / repeats * repeats) * c->forward[k];
        }
        if (!trial_draw(t, &moving, 0.0, i == 60 ? VELUM_VIEW_CUT : 0, 1)) {
            return false;
        }
    }
    return true;
}

static bool disturb_halt(trial *t, const stage_camera *c) {
    return fly_in(t, c, 1);
}

/* To time 0, in frames of `step_s`. */
static bool run_clock(trial *t, const stage_camera *c, double step_s) {
    for (int i = 30; i >= 0; i--) {
        if (!trial_draw(t, c, -step_s * i, i == 30 ? VELUM_VIEW_CUT : 0, 1)) {
            return false;
        }
    }
    return true;
}

static bool disturb_clock(trial *t, const stage_camera *c) {
    return run_clock(t, c, -1.0 / 3.0);
}

/* Sizes of the sub-rectangle change every frame, up to the view's own. */
static bool disturb_size(trial *t, const stage_camera *c) {
    picture all = t->now;
    bool ok = true;
    for (uint32_t i = 0; i < 40 && ok; i++) {
        t->now.width = i == 39 ? TRIAL_WIDE : 1 + (i * 37) % TRIAL_WIDE;
        t->now.height = i == 39 ? TRIAL_HIGH : 1 + (i * 23) % TRIAL_HIGH;
        t->now.count = t->now.width * t->now.height;
        ok = trial_draw(t, c, 0.0, i == 0 ? VELUM_VIEW_CUT : 0, 1);
    }
    t->now = all;
    return ok;
}

static bool teleport(trial *t) {
    return settled_after(t, &(disturbance){disturb_teleport, 0.0f, true});
}

static bool hop(trial *t) {
    return settled_after(t, &(disturbance){disturb_hop, 0.0f, false});
}

static bool cut(trial *t) {
    return settled_after(t, &(disturbance){disturb_cut, 0.0f, true});
}

static bool halt(trial *t) {
    return settled_after(t, &(disturbance){disturb_halt, 0.0f, false});
}

static bool reversed_clock(trial *t) {
    return settled_after(t, &(disturbance){disturb_clock, 50.0f, false});
}

static bool resized(trial *t) {
    return settled_after(t, &(disturbance){disturb_size, 0.0f, true});
}

/* How much worse a picture in motion is than in another motion to the same place and time. */
static bool motions(trial *t, float wind_east_m_s, bool (*usual)(trial *t, const stage_camera *c),
                    bool (*odd)(trial *t, const stage_camera *c)) {
    trial_weather w = trial_air(TRIAL_CUMULUS("0.45"), 40.0);
    picture fresh = {0};
    const stage_camera c = trial_camera(50.0, 8.5, 300.0, 90.0, 15.0, 0.6);
    w.wind_east_m_s = wind_east_m_s;
    double errors[2] = {NAN, NAN};
    bool ok = trial_settle(t, &w, &c, 0.0) && trial_keep(t, &fresh);
    for (int i = 0; i < 2 && ok; i++) {
        ok = trial_open(t, TRIAL_WIDE, TRIAL_HIGH) && (i == 0 ? usual : odd)(t, &c);
        errors[i] = ok ? trial_difference(t, &fresh) : NAN;
    }
    t->value = errors[1] / errors[0];
    snprintf(t->text, sizeof t->text, "%.3g against %.3g", errors[1], errors[0]);
    picture_finish(&fresh);
    return ok;
}

static bool clock_onward(trial *t, const stage_camera *c) {
    return run_clock(t, c, FRAME_S);
}

static bool clock_back(trial *t, const stage_camera *c) {
    return run_clock(t, c, -FRAME_S);
}

static bool rewinding(trial *t) {
    return motions(t, 50.0f, clock_onward, clock_back);
}

static bool each_pose_four_times(trial *t, const stage_camera *c) {
    return fly_in(t, c, 4);
}

static bool slow_simulation(trial *t) {
    return motions(t, 0.0f, disturb_halt, each_pose_four_times);
}

#define SETTLED "difference from a fresh settled picture, after 48 frames"
#define SETTLED_AND_FIRST SETTLED ", and of the first frame from that of a cut"

const stability_case stability_times[] = {
    {"year_and_1e9s", "time in floats: the noise swims and jitters", "time and phase in double, modulo the period",
     "in wind, change of the settled picture in 1/60 s: late less early", 0.02, wind_late},
    {"calm_1e9s", "the same", "in calm air a field stands still for its life, 80 minutes",
     "in calm air, change of the settled picture in 1/60 s and in a minute, after a year and at 1e9 s", 0.0, calm_late},
    {"calm_fade_1e9s", "noise is reset at once, or for ever the same",
     "in calm air too a field gives way to the next, over 20 minutes, in place",
     "in calm air, change of the settled picture in 1/60 s in the middle of that: late less early", 0.02, calm_fade},
    {"queries_late", "picture and physics part", "one density for pictures and queries",
     "in wind, mean difference of transmittance from the line query: late less early", 0.02, late_queries},
    {"teleport", "ghosts of the old place", "an eye that no flight takes there begins anew", SETTLED_AND_FIRST, 0.02,
     teleport},
    {"teleport_800m", "ghosts of the old place", "history moves as far as it fits, and is forgotten at rest", SETTLED,
     0.02, hop},
    {"cut", "the first frames show the old place", "a cut begins anew", SETTLED_AND_FIRST, 0.02, cut},
    {"halt", "the smear stays", "a picture that comes to rest settles anew", SETTLED, 0.02, halt},
    {"slow_simulation", "a pose that is repeated is taken for a halt",
     "a rest is longer than the host has been seen to repeat", "error in flight, each pose shown four times, over once",
     1.5, slow_simulation},
    {"reversed_clock", "history from the future", "the same time gives the same picture", SETTLED, 0.02,
     reversed_clock},
    {"rewinding", "history is refused: every frame is a first one", "history fits whichever way time runs",
     "error while the clock runs back, over running onward", 1.2, rewinding},
    {"resized", "history of another size is read out of range", "history begins anew", SETTLED_AND_FIRST, 0.02,
     resized},
    {NULL, NULL, NULL, NULL, 0.0, NULL},
};
