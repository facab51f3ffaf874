#include "governor.h"

#include <math.h>

#include "preset_figures.h"

enum {
    DENSITY_MOST = 6,    /* one ray a pixel */
    DENSITY_FINER = 4,   /* the most at which blocks are large enough for four rays */
    DENSITY_PRESETS = 2, /* one ray for 16, as presets have */
    KNOWN = 3,           /* frames that a track needs */
    SETTLED = 32,        /* of which it is a mean at first */
    HOLD_FIRST = 30,
    HOLD_MOST = 3600
};

/* Of the budget. Between the first and the last nothing is done; what is done aims between the others. */
#define UNDER 0.92f
#define AIM_FALL 0.98f
#define AIM_RISE 0.98f
#define OVER 1.05f
/* Octaves a frame. */
#define RISE 0.04f
/* March time goes with a power of the samples: a ray has costs of its own. Where samples are all, 1; a software device
 * had 0.65 in a thunderstorm. */
#define POWER_FIRST 0.8f
#define POWER_LEAST 0.3f
#define POWER_MOST 1.2f
/* Beyond these by so much it was the scene that changed. */
#define POWER_SLACK 0.5f
/* Octaves of samples from frame to frame that tell of it, and share of what they tell in what is believed. */
#define TELLING_STEPS 0.4f
#define TELLING_SHARE 0.3f
/* Octaves of steps that are given up before the last finer block is: to have any at all has a cost of its own, which a
 * device tells when it has them. */
#define FINER_KEPT 0.6f
/* Of the way back to the first guess in a frame that waits with all steps: nothing tells of the power then, and one
 * that was learnt too low, from a scene that changed, would have it wait for ever. */
#define FORGET 0.02f
/* Share of a new frame in the means of a track. */
#define SMOOTH 0.06f
/* Octaves from the median of three. */
#define OUTLIER 0.5f
#define LEAST_MS 1e-4f

static float steps_of(uint32_t preset) {
    return log2f(preset_figures_of[preset].samples / preset_figures_of[0].samples);
}

static const uint32_t finest = PRESETS - 1;

static float steps_at(float preset) {
    uint32_t below = (uint32_t)fminf(preset, (float)(PRESETS - 2));
    float first = steps_of(below);
    return first + (preset - (float)below) * (steps_of(below + 1) - first);
}

static float preset_at(float steps) {
    uint32_t below = 0;
    while (below < PRESETS - 2 && steps_of(below + 1) < steps) {
        below++;
    }
    float first = steps_of(below);
    float share = (steps - first) / (steps_of(below + 1) - first);
    return fminf(fmaxf((float)below + share, 0.0f), (float)finest);
}

static uint32_t density_of(uint32_t ray_rate) {
    uint32_t density = DENSITY_MOST;
    for (; ray_rate > 1; ray_rate >>= 1) {
        density--;
    }
    return density;
}

/* Rays more, where all blocks that may have them do. */
static float octaves_of_finer(uint32_t finer) {
    return log2f(1.0f + 3.0f * (float)finer / 64.0f);
}

static uint32_t finer_at(float octaves) {
    const float finer = (exp2f(octaves) - 1.0f) * (64.0f / 3.0f) + 0.5f;
    return (uint32_t)fminf(fmaxf(finer, 0.0f), (float)GOVERNOR_FINER_MOST);
}

/* Where there may be no more rays, there are no finer blocks either. */
static uint32_t finer_most(const governor *g) {
    return g->density <= DENSITY_FINER && g->density < density_of(g->most.ray_rate) ? GOVERNOR_FINER_MOST : 0;
}

static float octaves_of(const governor *g, governor_setting setting) {
    return (float)density_of(setting.ray_rate) + g->power * steps_at(setting.preset) + octaves_of_finer(setting.finer);
}

float governor_octaves(const governor *g) {
    return (float)g->density + g->power * g->steps + octaves_of_finer(g->finer);
}

static float median(float a, float b, float c) {
    return fmaxf(fminf(a, b), fminf(fmaxf(a, b), c));
}

/* Lone outliers are passed over. Then exponential smoothing that is quicker the more errors are of one sign (Trigg and
 * Leach 1967), by the square of their tracking signal: slow in noise, at once after a step. */
static void track(governor_track *t, float ms) {
    float now = log2f(fmaxf(ms, LEAST_MS));
    t->newest[t->next] = now;
    t->next = (t->next + 1) % 3;
    t->known += t->known < SETTLED ? 1 : 0;
    float middle = median(t->newest[0], t->newest[1], t->newest[2]);
    if (t->known <= KNOWN) {
        t->value = middle;
        return;
    }
    float off = (fabsf(now - middle) < OUTLIER ? now : middle) - t->value;
    t->error += SMOOTH * (off - t->error);
    t->spread += SMOOTH * (fabsf(off) - t->spread);
    float signal = t->error / fmaxf(t->spread, 1e-6f);
    t->value += fmaxf(signal * signal, 1.0f / (float)(t->known - KNOWN + 1)) * off;
}

static bool is_known(const governor *g) {
    return g->cost.known >= KNOWN && g->rest.known >= KNOWN;
}

static void begin(governor *g) {
    const governor_setting first = {.ray_rate = 1u << (DENSITY_MOST - DENSITY_PRESETS),
                                    .preset = (float)g->first_preset};
    const bool above = octaves_of(g, first) > octaves_of(g, g->most);
    g->density = density_of(above ? g->most.ray_rate : first.ray_rate);
    g->steps = steps_at(above ? g->most.preset : first.preset);
    g->finer = 0;
}

void governor_init(governor *g, float budget_ms, uint32_t first_preset, governor_setting most) {
    *g = (governor){.budget_ms = budget_ms,
                    .first_preset = first_preset,
                    .most = most,
                    .power = POWER_FIRST,
                    .hold_next = HOLD_FIRST};
    begin(g);
}

void governor_reset(governor *g) {
    const governor before = *g;
    begin(g);
    if (governor_octaves(&before) < governor_octaves(g)) {
        g->density = before.density;
        g->steps = before.steps;
        g->finer = before.finer;
    }
    g->cost = g->rest = (governor_track){0};
    g->newest = (governor_frame){0};
    g->rises = false;
    g->hold = 0;
    g->hold_next = HOLD_FIRST;
    g->epoch++;
}

/* What is known of the cost stays true at the steps that it was learnt at. */
static void believe_power(governor *g, float power, float steps) {
    float shift = (g->power - power) * steps;
    g->power = power;
    g->cost.value += shift;
    for (int i = 0; i < 3; i++) {
        g->cost.newest[i] += shift;
    }
}

/* From two frames in a row with quite different steps. */
static void learn_power(governor *g, const governor_frame *frame) {
    const governor_frame *last = &g->newest;
    if (last->setting.ray_rate == 0) {
        return;
    }
    float steps = steps_at(frame->setting.preset) - steps_at(last->setting.preset);
    if (fabsf(steps) < TELLING_STEPS || frame->march_ms <= 0.0f || last->march_ms <= 0.0f) {
        return;
    }
    float density = (float)density_of(frame->setting.ray_rate) - (float)density_of(last->setting.ray_rate) +
                    octaves_of_finer(frame->setting.finer) - octaves_of_finer(last->setting.finer);
    float told = (log2f(frame->march_ms / last->march_ms) - density) / steps;
    if (told < POWER_LEAST - POWER_SLACK || told > POWER_MOST + POWER_SLACK) {
        return;
    }
    const float held = fminf(fmaxf(told, POWER_LEAST), POWER_MOST);
    believe_power(g, g->power + TELLING_SHARE * (held - g->power), steps_at(last->setting.preset));
}

void governor_learn(governor *g, const governor_frame *frame) {
    if (frame->setting.epoch != g->epoch) {
        return;
    }
    learn_power(g, frame);
    g->newest = *frame;
    track(&g->cost, frame->march_ms * exp2f(-octaves_of(g, frame->setting)));
    track(&g->rest, frame->other_ms);
}

float governor_expected_ms(const governor *g) {
    return is_known(g) ? exp2f(g->rest.value) + exp2f(g->cost.value + governor_octaves(g)) : 0.0f;
}

/* Octaves at which the frame takes so long; may be below 0. */
static float octaves_for(const governor *g, float ms) {
    return log2f(fmaxf(ms - exp2f(g->rest.value), LEAST_MS)) - g->cost.value;
}

/* Whether twice the rays may be tried: surely where even at the same steps they fit; otherwise where they should at
 * the least steps, unless that has just failed. */
static bool may_be_denser(const governor *g) {
    float room = octaves_for(g, AIM_RISE * g->budget_ms);
    return g->density < density_of(g->most.ray_rate) &&
           (room >= governor_octaves(g) + 1.0f || (g->hold == 0 && room >= (float)(g->density + 1)));
}

/* Rays and steps for so many octaves. A number of rays is kept as long as steps, and then finer blocks, can make up for
 * what is wanted. */
static void share_out(governor *g, float octaves) {
    while (octaves < (float)g->density && g->density > 0) {
        g->density--;
        if (g->since_denser < g->hold_next) {
            g->hold = g->hold_next;
            g->hold_next = g->hold_next < HOLD_MOST / 2 ? 2 * g->hold_next : HOLD_MOST;
        }
        g->since_denser = HOLD_MOST;
    }
    const float widest = g->power * steps_of(finest) + octaves_of_finer(finer_most(g));
    if (octaves > (float)g->density + widest) {
        if (may_be_denser(g)) {
            g->density++;
            g->since_denser = 0;
        } else if (g->density < density_of(g->most.ray_rate)) {
            g->doing = GOVERNOR_WAITS;
            believe_power(g, g->power + FORGET * fmaxf(POWER_FIRST - g->power, 0.0f), g->steps);
        }
    }
    const float steps = g->power * steps_of(finest);
    const float left = octaves - (float)g->density;
    const uint32_t finer = finer_at(left - steps);
    const uint32_t least = g->finer > 0 && left > steps - FINER_KEPT ? 1 : 0;
    const uint32_t most = finer_most(g);
    g->finer = finer > least ? finer : least;
    g->finer = g->finer < most ? g->finer : most;
    g->steps = fminf(fmaxf((left - octaves_of_finer(g->finer)) / g->power, 0.0f), steps_of(finest));
}

/* Octaves of the next frame. */
static float octaves_next(governor *g) {
    float octaves = governor_octaves(g);
    float expected_ms = governor_expected_ms(g);
    if (expected_ms > OVER * g->budget_ms) {
        g->doing = GOVERNOR_FALLS;
        g->rises = false;
        return fminf(octaves, octaves_for(g, AIM_FALL * g->budget_ms));
    }
    if (expected_ms < UNDER * g->budget_ms || g->rises) {
        float wanted = octaves_for(g, AIM_RISE * g->budget_ms);
        g->rises = wanted > octaves + RISE;
        g->doing = GOVERNOR_RISES;
        return fmaxf(octaves, fminf(wanted, octaves + RISE));
    }
    return octaves;
}

governor_setting governor_next(governor *g) {
    g->hold -= g->hold > 0 ? 1 : 0;
    if (g->since_denser < HOLD_MOST && ++g->since_denser > g->hold_next) {
        g->hold_next = HOLD_FIRST;
    }
    g->doing = GOVERNOR_BEGINS;
    if (is_known(g)) {
        g->doing = GOVERNOR_KEEPS;
        float octaves = octaves_next(g);
        float most = octaves_of(g, g->most);
        if (octaves <= 0.0f) {
            octaves = 0.0f;
            g->doing = g->doing == GOVERNOR_FALLS ? GOVERNOR_LEAST : g->doing;
        } else if (octaves >= most) {
            octaves = most;
            /* Fewer rays with finer blocks may come to as much. */
            g->density = density_of(g->most.ray_rate);
            g->doing = g->doing == GOVERNOR_RISES ? GOVERNOR_MOST : g->doing;
        }
        share_out(g, octaves);
    }
    return governor_now(g);
}

governor_setting governor_now(const governor *g) {
    return (governor_setting){.ray_rate = 1u << (DENSITY_MOST - g->density),
                              .preset = preset_at(g->steps),
                              .finer = g->finer,
                              .epoch = g->epoch};
}
