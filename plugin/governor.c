#include "governor.h"

#include <math.h>

#include "preset_figures.h"

enum {
    DENSITY_MOST = 6,    /* one ray a pixel */
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
/* March time goes with this power of the samples: a ray has costs of its own. On a software device 0.65 was measured in
 * a thunderstorm; where samples are all, 1. */
#define SAMPLES_POWER 0.8f
/* Share of a new frame in the means of a track. */
#define SMOOTH 0.07f
/* Octaves from the median of three. */
#define OUTLIER 0.5f
#define LEAST_MS 1e-4f

/* March time over that of preset low at the same rays. */
static float octaves_of(uint32_t preset) {
    return SAMPLES_POWER * log2f(preset_figures_of[preset].samples / preset_figures_of[0].samples);
}

static float octaves_at(float preset) {
    uint32_t below = (uint32_t)fminf(preset, (float)(PRESETS - 2));
    float first = octaves_of(below);
    return first + (preset - (float)below) * (octaves_of(below + 1) - first);
}

static float preset_at(float octaves) {
    uint32_t below = 0;
    while (below < PRESETS - 2 && octaves_of(below + 1) < octaves) {
        below++;
    }
    float first = octaves_of(below);
    float share = (octaves - first) / (octaves_of(below + 1) - first);
    return fminf(fmaxf((float)below + share, 0.0f), (float)(PRESETS - 1));
}

static uint32_t density_of(uint32_t ray_rate) {
    uint32_t density = DENSITY_MOST;
    for (; ray_rate > 1; ray_rate >>= 1) {
        density--;
    }
    return density;
}

static float octaves_of_setting(governor_setting setting) {
    return (float)density_of(setting.ray_rate) + octaves_at(setting.preset);
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

void governor_init(governor *g, float budget_ms, uint32_t first_preset, governor_setting most) {
    *g = (governor){.budget_ms = budget_ms,
                    .first = (float)DENSITY_PRESETS + octaves_of(first_preset),
                    .most = octaves_of_setting(most),
                    .densest = density_of(most.ray_rate),
                    .density = DENSITY_PRESETS,
                    .hold_next = HOLD_FIRST};
    g->first = fminf(g->first, g->most);
    g->octaves = g->first;
}

void governor_reset(governor *g) {
    if (g->octaves > g->first) {
        g->octaves = g->first;
        g->density = DENSITY_PRESETS;
    }
    g->cost = g->rest = (governor_track){0};
    g->rises = false;
    g->hold = 0;
    g->hold_next = HOLD_FIRST;
    g->epoch++;
}

void governor_learn(governor *g, const governor_frame *frame) {
    if (frame->setting.epoch != g->epoch) {
        return;
    }
    track(&g->cost, frame->march_ms * exp2f(-octaves_of_setting(frame->setting)));
    track(&g->rest, frame->other_ms);
}

float governor_expected_ms(const governor *g) {
    return is_known(g) ? exp2f(g->rest.value) + exp2f(g->cost.value + g->octaves) : 0.0f;
}

/* Octaves at which the frame takes so long; may be below 0. */
static float octaves_for(const governor *g, float ms) {
    return log2f(fmaxf(ms - exp2f(g->rest.value), LEAST_MS)) - g->cost.value;
}

/* Whether twice the rays may be tried: surely where even at the same steps they fit, otherwise unless it has just
 * failed. */
static bool may_be_denser(const governor *g) {
    float march_ms = exp2f(g->cost.value + g->octaves);
    return g->density < g->densest && (g->hold == 0 || governor_expected_ms(g) + march_ms <= AIM_FALL * g->budget_ms);
}

/* Rays and steps overlap: a number of rays is kept as long as steps can make up for what is wanted. */
static void share_out(governor *g) {
    while (g->octaves < (float)g->density && g->density > 0) {
        g->density--;
        if (g->since_denser < g->hold_next) {
            g->hold = g->hold_next;
            g->hold_next = g->hold_next < HOLD_MOST / 2 ? 2 * g->hold_next : HOLD_MOST;
        }
        g->since_denser = HOLD_MOST;
    }
    const float widest = octaves_of(PRESETS - 1);
    if (g->octaves > (float)g->density + widest && may_be_denser(g)) {
        g->density++;
        g->since_denser = 0;
    }
    if (g->octaves > (float)g->density + widest) {
        g->octaves = (float)g->density + widest;
        g->doing = g->density < g->densest ? GOVERNOR_WAITS : g->doing;
    }
}

governor_setting governor_next(governor *g) {
    float expected_ms = governor_expected_ms(g);
    g->hold -= g->hold > 0 ? 1 : 0;
    if (g->since_denser < HOLD_MOST && ++g->since_denser > g->hold_next) {
        g->hold_next = HOLD_FIRST;
    }
    g->doing = is_known(g) ? GOVERNOR_KEEPS : GOVERNOR_BEGINS;
    if (is_known(g) && expected_ms > OVER * g->budget_ms) {
        g->doing = GOVERNOR_FALLS;
        g->rises = false;
        g->octaves = fminf(g->octaves, octaves_for(g, AIM_FALL * g->budget_ms));
    } else if (is_known(g) && (expected_ms < UNDER * g->budget_ms || g->rises)) {
        float wanted = octaves_for(g, AIM_RISE * g->budget_ms);
        g->rises = wanted > g->octaves + RISE;
        g->doing = GOVERNOR_RISES;
        g->octaves = fmaxf(g->octaves, fminf(wanted, g->octaves + RISE));
    }
    if (g->octaves <= 0.0f) {
        g->octaves = 0.0f;
        g->doing = g->doing == GOVERNOR_FALLS ? GOVERNOR_LEAST : g->doing;
    } else if (g->octaves >= g->most) {
        g->octaves = g->most;
        g->doing = g->doing == GOVERNOR_RISES ? GOVERNOR_MOST : g->doing;
    }
    share_out(g);
    return governor_now(g);
}

governor_setting governor_now(const governor *g) {
    return (governor_setting){.ray_rate = 1u << (DENSITY_MOST - g->density),
                              .preset = preset_at(g->octaves - (float)g->density),
                              .epoch = g->epoch};
}
