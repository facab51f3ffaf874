#include "budget.h"

#include "preset_figures.h"

#define BUDGET_LEAST_MS 0.001
#define BUDGET_MOST_MS 10000.0
#define BUDGET_LEAST_ERROR 0.001

enum { RAY_RATE = PATH_BLOCK * PATH_BLOCK, DENSEST_RAY_RATE = 1 };

static uint32_t preset_of(const eye *y) {
    return (uint32_t)(y->quality - VELUM_QUALITY_LOW);
}

bool budget_check(checker *check, const velum_eye_desc *d) {
    if ((d->budget_ms != 0.0f &&
         !check_range(check, "desc.budget_ms", (double)d->budget_ms, BUDGET_LEAST_MS, BUDGET_MOST_MS)) ||
        (d->budget_error != 0.0f &&
         !check_range(check, "desc.budget_error", (double)d->budget_error, BUDGET_LEAST_ERROR, 1.0))) {
        return false;
    }
    return d->quality != VELUM_QUALITY_REFERENCE || (d->budget_ms == 0.0f && d->budget_error == 0.0f) ||
           check_fail(check, VELUM_ERROR_ARGUMENT, "desc.%s: found %g, expected 0 with VELUM_QUALITY_REFERENCE",
                      d->budget_ms != 0.0f ? "budget_ms" : "budget_error",
                      (double)(d->budget_ms != 0.0f ? d->budget_ms : d->budget_error));
}

void budget_init(eye *y, const velum_eye_desc *d) {
    const engine *e = y->e;
    governor_setting most = {.ray_rate = DENSEST_RAY_RATE, .preset = (float)(PRESETS - 1)};
    y->budget_ms = d->budget_ms;
    y->budget_error = d->budget_error;
    if (d->budget_error > 0.0f) {
        uint32_t preset = preset_for_error(d->budget_error);
        y->quality = VELUM_QUALITY_LOW + (int32_t)preset;
        most = (governor_setting){.ray_rate = RAY_RATE, .preset = (float)preset};
    }
    if (d->budget_ms > 0.0f) {
        governor_init(&y->governor, d->budget_ms, preset_of(y), most);
        if (!e->g.has_timestamps) {
            log_write(&e->sink, VELUM_LOG_WARNING, "eye",
                      "budget_ms: the device has no timestamps: no time can be kept, quality %s stays",
                      plan_preset_name(y->quality));
        }
    }
}

governor_setting budget_next(const engine *e, eye *y) {
    if (y->budget_ms == 0.0f || !e->g.has_timestamps) {
        return (governor_setting){.ray_rate = RAY_RATE, .preset = (float)(y->quality - VELUM_QUALITY_LOW)};
    }
    if (y->reset) {
        governor_reset(&y->governor);
    }
    /* Without cloud no steps are made: there is nothing to learn, and nothing to spend time on. */
    y->is_governed = y->tiles.mask != 0;
    return y->is_governed ? governor_next(&y->governor) : governor_now(&y->governor);
}

static void error_reason(eye *y) {
    const preset_figures *has = &preset_figures_of[preset_of(y)];
    if (has->error <= y->budget_error) {
        plan_reason(y, "\nerror budget %g: %s has %g, the cheapest that meets it%s", (double)y->budget_error,
                    plan_preset_name(y->quality), (double)has->error, y->budget_ms > 0.0f ? "; not better" : "");
    } else {
        plan_reason(y, "\nerror budget %g: none meets it; %s has the least, %g", (double)y->budget_error,
                    plan_preset_name(y->quality), (double)has->error);
    }
}

static void time_reason(const engine *e, eye *y) {
    const governor *g = &y->governor;
    if (!e->g.has_timestamps) {
        plan_reason(y, "\ntime budget %g ms: not kept, the device has no timestamps", (double)y->budget_ms);
        return;
    }
    if (!y->is_governed) {
        plan_reason(y, "\ntime budget %g ms: no cloud to spend it on", (double)y->budget_ms);
        return;
    }
    static const char *const doing[] = {
        [GOVERNOR_BEGINS] = "too few frames have finished to tell",
        [GOVERNOR_KEEPS] = "kept",
        [GOVERNOR_FALLS] = "was over, quality falls",
        [GOVERNOR_RISES] = "under, quality rises slowly",
        [GOVERNOR_WAITS] = "under, but twice the rays would be too dear",
        [GOVERNOR_LEAST] = "even the least plan is too dear",
        [GOVERNOR_MOST] = "the best plan is cheaper",
    };
    plan_reason(y, "\ntime budget %g ms: %s", (double)y->budget_ms, doing[g->doing]);
    if (g->doing != GOVERNOR_BEGINS) {
        plan_reason(y, "; %.3g ms expected", (double)governor_expected_ms(g));
    }
    if (y->budget_error > 0.0f && g->doing != GOVERNOR_MOST && g->doing != GOVERNOR_BEGINS) {
        plan_reason(y, "; less than the error asks for");
    }
}

void budget_reasons(const engine *e, eye *y) {
    if (y->budget_error > 0.0f) {
        error_reason(y);
    }
    if (y->budget_ms > 0.0f) {
        time_reason(e, y);
    }
}

void budget_learn(engine *e, const frame_slot *slot) {
    for (eye *y = e->eyes; y; y = y->next) {
        const frame_record *of_eye = NULL;
        governor_frame frame = {0};
        bool is_known = y->budget_ms > 0.0f;
        for (uint32_t i = 0; i < slot->record_count && is_known; i++) {
            const frame_record *record = &slot->record[i];
            if (!record->v || record->v->eye != y) {
                continue;
            }
            const velum_view_stats *stats = &record->v->stats;
            is_known = record->is_governed && stats->march_ms > 0.0f && stats->resolve_ms > 0.0f;
            frame.other_ms += stats->resolve_ms;
            frame.march_ms += stats->march_ms;
            of_eye = record;
        }
        if (is_known && of_eye) {
            const velum_view_stats *stats = &of_eye->v->stats;
            frame.setting = of_eye->setting;
            frame.other_ms += stats->shared_ms / (float)slot->eye_count;
            governor_learn(&y->governor, &frame);
        }
    }
}
