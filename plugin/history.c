#include "history.h"

#include <math.h>
#include <string.h>

#include "blocks.h"

/* Samples that a pixel's history counts for at most while the picture moves. */
#define MOVING_SAMPLES 3.0f
/* The same while it rests: always, and in a frame that is made otherwise than the one before, so that no jump shows
 * and the new way takes over. */
#define RESTING_SAMPLES 1024.0f
#define OTHER_PLAN_SAMPLES 8.0f
/* Blocks of so many pixels have quarters. */
#define FINER_RATE_LEAST 4
/* Beyond these an eye has not flown but been put elsewhere; in orbit it makes 8 km/s. */
#define JUMP_S 5.0
#define JUMP_M 1000.0
#define JUMP_M_S 12000.0
/* Of the plan's rays in every pixel before a view stands; pixels a frame that cloud may drift there. */
#define STANDING_ROUNDS 3
#define STANDING_PIXELS 0.5
/* The longest such frame, and by how much the sun may turn in it, rad. */
#define STANDING_FRAME_S 0.1
#define STANDING_SUN 2e-5
/* Of the plan's rays in every pixel before little is left of what was seen before it stood; and at rest after it, while
 * what was seen then gives way: in so many they have stepped from all their places. */
#define STOOD_ROUNDS 6
#define YIELDING_ROUNDS 4
/* Pixels that cloud may drift there before history is moved after it. */
#define KEPT_PIXELS 0.5
/* Sine of the least elevation from which its drift is reckoned: that at which the round earth shows cloud 12 km over
 * the eye on the horizon. A flat one would let it stand still there. */
#define RISE_LEAST 0.06

/* Whether a state has taken the place of another that it was not derived from and that no timeline leads to it. */
static bool weather_jumped(const engine *e, const camera *before, const camera *now) {
    for (int i = 0; i < 2; i++) {
        bool known = false;
        for (int k = 0; k < 2; k++) {
            known = known || now->state[i] == before->state[k] ||
                    (e->weather.base[i] && e->weather.base[i] == before->state[k]);
        }
        /* A transition begins with its second state at next to nothing, and ends with its first at next to nothing. */
        float weight = i == 0 ? 1.0f - now->blend : now->blend;
        if (!known && weight > 0.1f) {
            return true;
        }
    }
    return false;
}

static bool eye_jumped(const camera *before, const camera *now) {
    const double away2 = apart2(now->position, before->position);
    double dt = fabs(now->time_s - before->time_s);
    double reach_m = JUMP_M + JUMP_M_S * dt;
    return !(dt <= JUMP_S && away2 <= reach_m * reach_m);
}

static bool starts_anew(const view *v, const camera *now) {
    const camera *before = &v->past.before;
    return !v->past.is_there || v->eye->reset || now->width != before->width || now->height != before->height ||
           now->flags != before->flags || eye_jumped(before, now) || weather_jumped(v->eye->e, before, now);
}

static bool same_pose(const camera *a, const camera *b) {
    return memcmp(a->position, b->position, sizeof a->position) == 0 &&
           memcmp(a->right, b->right, sizeof a->right) == 0 && memcmp(a->up, b->up, sizeof a->up) == 0 &&
           memcmp(a->forward, b->forward, sizeof a->forward) == 0 && memcmp(a->tan, b->tan, sizeof a->tan) == 0;
}

static bool stands_still(const camera *a, const camera *b) {
    return same_pose(a, b) && memcmp(a->sun, b->sun, sizeof a->sun) == 0 && a->time_s == b->time_s &&
           memcmp(a->state, b->state, sizeof a->state) == 0 && a->blend == b->blend;
}

/* How fast cloud drifts in a view at most: over a grid of its directions. */
static double drift_pixels_s(const eye *y, const camera *c) {
    enum { SIDE = 5 };
    const double pixels = fmax(c->width / (double)(c->tan[1] - c->tan[0]), c->height / (double)(c->tan[3] - c->tan[2]));
    double most = 0.0;
    for (int i = 0; i < SIDE * SIDE; i++) {
        const double share[2] = {(double)(i % SIDE) / (SIDE - 1), (double)(i / SIDE) / (SIDE - 1)};
        const double x = (double)c->tan[0] + share[0] * (double)(c->tan[1] - c->tan[0]);
        const double z = (double)c->tan[2] + share[1] * (double)(c->tan[3] - c->tan[2]);
        const double length2 = 1.0 + x * x + z * z;
        double rise = 0.0;
        for (int k = 0; k < 3; k++) {
            rise += (c->forward[k] + x * c->right[k] + z * c->up[k]) * (double)y->block.up[k] / sqrt(length2);
        }
        const double above = rise > -RISE_LEAST ? (double)y->wind.above_rad_s : 0.0;
        const double below = rise < RISE_LEAST ? (double)y->wind.below_rad_s : 0.0;
        most = fmax(most, fmax(above, below) * fmax(fabs(rise), RISE_LEAST) * length2);
    }
    return isinf(y->wind.above_rad_s) ? INFINITY : most * pixels;
}

/* Whether a view goes on as it was, but for cloud that drifts slowly over it: see velum_plan.standing_ray_rate. */
static bool stands(const view *v, const camera *now, double pixels_s) {
    const eye *y = v->eye;
    const camera *before = &v->past.before;
    const double dt = fabs(now->time_s - before->time_s);
    return same_pose(now, before) && memcmp(now->state, before->state, sizeof now->state) == 0 &&
           now->state[0] == now->state[1] && !y->incomplete && !now->is_aside && y->block.table[3] == 0 &&
           dt <= STANDING_FRAME_S && apart2(now->sun, before->sun) <= STANDING_SUN * STANDING_SUN &&
           pixels_s * dt < STANDING_PIXELS;
}

/* Whether rays and steps are the same. */
static bool same_picture(const velum_plan *a, const velum_plan *b) {
    return a->flags == b->flags && a->march_steps == b->march_steps && a->light_steps == b->light_steps &&
           a->ray_rate == b->ray_rate && a->octaves == b->octaves && a->step_m == b->step_m &&
           a->step_growth == b->step_growth && a->integrator == b->integrator && a->scattering == b->scattering &&
           a->sun_depth == b->sun_depth && a->long_step == b->long_step && a->thin_density == b->thin_density &&
           a->exit_transmittance == b->exit_transmittance && a->volume_cell_m == b->volume_cell_m;
}

/* Whether history need not be moved: cloud has drifted too little since it was for that to show. */
static bool lags(const view *v, const camera *now, const velum_plan *plan, double pixels_s) {
    const view_history *past = &v->past;
    return plan->ray_rate == past->plan.ray_rate && memcmp(now->jitter, past->before.jitter, sizeof now->jitter) == 0 &&
           pixels_s * fabs(now->time_s - past->time_s) < KEPT_PIXELS;
}

/* Begun ones count. */
static uint32_t rounds_of(uint32_t frames, uint32_t ray_rate) {
    return (frames + ray_rate - 1) / ray_rate;
}

/* What was seen before counts for one ray beside all that come after it. */
static float yielding_samples(uint32_t frames_left, uint32_t ray_rate) {
    return 1.0f + (float)(YIELDING_ROUNDS - rounds_of(frames_left, ray_rate));
}

/* As a view that stands, until the last round: by and by as one at rest. */
static float yielding_shown(uint32_t frames_left, uint32_t ray_rate) {
    return MOVING_SAMPLES + fmaxf(1.0f - (float)frames_left / (float)ray_rate, 0.0f);
}

static history_turn begin(const camera *now, const velum_plan *plan) {
    return (history_turn){
        .anew = true,
        .has_depth = now->has_depth || now->is_aside,
        .way = HISTORY_RESTS,
        .next = {.is_there = true, .before = *now, .plan = *plan, .time_s = now->time_s, .counter = 1, .rest = 1}};
}

history_turn history_take(const view *v, bool cut, const camera *now, const velum_plan *plan) {
    const view_history *past = &v->past;
    if (cut || starts_anew(v, now)) {
        return begin(now, plan);
    }
    history_turn t = {.next = *past, .has_depth = now->has_depth || past->before.has_depth || now->is_aside};
    view_history *next = &t.next;
    const bool is_still = stands_still(now, &past->before);
    const double drift = drift_pixels_s(v->eye, now);
    next->still = is_still ? past->still + 1 : 0;
    next->stood = stands(v, now, drift) ? past->stood + 1 : 0;
    next->has_moved = past->has_moved || !is_still;
    next->yields = is_still ? past->yields : 0;
    if (!is_still && past->still < REPEATS_MOST && past->still >= past->rest) {
        next->rest = past->still + 1;
    } else if (next->still >= REPEATS_MOST) {
        next->rest = 1;
    }
    const bool other_plan = !same_picture(&past->plan, plan);
    /* A progressive mean that moved pictures have gone into would keep them. */
    const bool settles = next->has_moved && next->still >= past->rest;
    if (settles || plan->ray_rate != past->plan.ray_rate) {
        next->yields = rounds_of(next->yields, past->plan.ray_rate) * plan->ray_rate;
        next->rounds += rounds_of(past->counter - past->begun, past->plan.ray_rate);
        next->begun = past->counter;
    }
    if (settles) {
        /* A view that stood has seen the same cloud from the same place: its rays go on where they were. */
        const bool has_stood = past->calm_turns != 0 && past->stood >= STOOD_ROUNDS * plan->ray_rate;
        next->yields = has_stood ? YIELDING_ROUNDS * plan->ray_rate : 0;
        next->rounds = has_stood ? next->rounds : 0;
        next->has_moved = false;
    }
    t.round = next->rounds + (past->counter - next->begun) / plan->ray_rate;
    const bool drifts = next->stood >= STANDING_ROUNDS * plan->ray_rate && !settles && next->still < next->rest &&
                        plan->standing_ray_rate > plan->ray_rate && !plan_is_study(plan);
    const bool is_kept = drifts && lags(v, now, plan, drift);
    const bool has_settled = is_still && !next->has_moved && past->counter - next->begun >= plan->ray_rate;
    /* Pixels may lose what they have where the host's things come and go; studies put no ray into its pixel. */
    const bool in_place =
        !t.has_depth && !plan_is_study(plan) && !other_plan && !plan->every_pixel && (is_kept || has_settled);
    t.way = in_place ? HISTORY_KEEPS : is_still || is_kept ? HISTORY_RESTS : HISTORY_MOVES;
    t.forgets = settles && next->yields == 0;
    t.samples = drifts || !is_still ? MOVING_SAMPLES
                : next->yields > 0  ? yielding_samples(next->yields, plan->ray_rate)
                : other_plan        ? OTHER_PLAN_SAMPLES
                                    : RESTING_SAMPLES;
    t.shown_samples = next->yields > 0 ? yielding_shown(next->yields, plan->ray_rate) : t.samples;
    next->yields -= next->yields > 0;
    t.calm_turns = drifts && !other_plan ? plan->standing_ray_rate / plan->ray_rate : 0;
    t.tiles_begin = t.calm_turns != 0 && t.calm_turns != past->calm_turns;
    /* The rays of the frame before tell which. */
    t.has_finer = t.way == HISTORY_MOVES && t.calm_turns == 0 && plan->finer_rays != 0 &&
                  plan->ray_rate >= FINER_RATE_LEAST && !plan_is_study(plan) && plan->ray_rate == past->plan.ray_rate;
    next->calm_turns = t.calm_turns;
    next->time_s = t.way == HISTORY_MOVES || settles ? now->time_s : past->time_s;
    next->before = *now;
    next->plan = *plan;
    next->counter = past->counter + 1;
    return t;
}
