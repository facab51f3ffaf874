/* How a frame of an eye is made: version 1. Steps and rates come from the preset, layers and distance from the tiles.
 */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "budget.h"

typedef struct preset {
    const char *name;
    uint32_t march_steps, light_steps, octaves;
    float step_m, step_growth;
    uint32_t standing_ray_rate; /* as its error allows; 0: none */
} preset;

/* Of steps as many as lengths and growth take to any horizon, and some for clouds before it. */
static const preset presets[] = {[VELUM_QUALITY_LOW] = {"low", 448, 6, 2, 110.0f, 0.014f, 256},
                                 [VELUM_QUALITY_MEDIUM] = {"medium", 640, 8, 3, 70.0f, 0.010f, 128},
                                 [VELUM_QUALITY_HIGH] = {"high", 1000, 14, 4, 45.0f, 0.006f, 64},
                                 [VELUM_QUALITY_ULTRA] = {"ultra", 1600, 16, 6, 35.0f, 0.0035f, 0},
                                 /* Its octaves are the greatest order of scattering; 0: all. */
                                 [VELUM_QUALITY_REFERENCE] = {"reference", 1, 1, 0, 1.0f, 0.0f, 0}};

const char *plan_preset_name(int32_t quality) {
    return presets[quality].name;
}

/* Lengths and counts between two presets; 0: low, 3: ultra. */
static preset preset_between(float place) {
    uint32_t below = (uint32_t)fminf(place, 2.0f);
    float share = place - (float)below;
    const preset *a = &presets[VELUM_QUALITY_LOW + (int)below];
    const preset *b = a + 1;
    preset p = share < 1.0f ? *a : *b;
    if (share > 0.0f && share < 1.0f) {
        p.march_steps =
            (uint32_t)lroundf((float)a->march_steps + share * ((float)b->march_steps - (float)a->march_steps));
        p.light_steps =
            (uint32_t)lroundf((float)a->light_steps + share * ((float)b->light_steps - (float)a->light_steps));
        p.step_m = a->step_m * powf(b->step_m / a->step_m, share);
        p.step_growth = a->step_growth * powf(b->step_growth / a->step_growth, share);
    }
    return p;
}

void plan_reason(eye *y, const char *format, ...) {
    size_t used = strlen(y->reasons);
    va_list list;
    va_start(list, format);
    vsnprintf(y->reasons + used, sizeof y->reasons - used, format, list);
    va_end(list);
}

void plan_make(const engine *e, eye *y) {
    static const char *const slots[VELUM_SLOT_COUNT] = {"low",    "low 2", "cumulus", "storm",
                                                        "middle", "high",  "uniform", "uniform 2"};
    y->reasons[0] = '\0';
    y->is_governed = false;
    if (y->is_imposed) {
        y->plan = y->imposed;
        y->plan.active_layers &= y->tiles.mask;
        plan_reason(y, "the host imposes this plan");
        return;
    }
    const governor_setting setting = budget_next(e, y);
    const preset p = y->quality == VELUM_QUALITY_REFERENCE ? presets[y->quality] : preset_between(setting.preset);
    bool blends = e->weather.state[0] != e->weather.state[1];
    float distance_m = y->tiles.has_set && y->tiles.mask ? (float)y->tiles.set.distance_m : 1000.0f;
    y->plan = (velum_plan){.struct_size = sizeof y->plan,
                           .active_layers = y->tiles.mask,
                           .march_steps = p.march_steps,
                           .light_steps = p.light_steps,
                           .ray_rate = setting.ray_rate,
                           .octaves = p.octaves,
                           .blending = blends,
                           .step_m = p.step_m,
                           .step_growth = p.step_growth,
                           .distance_m = distance_m,
                           /* What it saves would be spent by a budget, and be missing as soon as the eye moves. */
                           .standing_ray_rate = y->is_governed ? 0 : p.standing_ray_rate,
                           .finer_rays = y->is_governed ? setting.finer != 0 : y->quality != VELUM_QUALITY_REFERENCE,
                           .finer_blocks = y->is_governed ? setting.finer : 0,
                           .every_pixel = y->is_governed};
    plan_reason(y, "quality %s%s: %u steps, of %g m and more after the first, %u towards the sun, 1 ray for %u pixels",
                p.name, setting.preset > floorf(setting.preset) ? " and better" : "", p.march_steps, (double)p.step_m,
                p.light_steps, setting.ray_rate);
    if (y->plan.standing_ray_rate != 0) {
        plan_reason(y, ", for %u where views stand and rays find nothing new", y->plan.standing_ray_rate);
    }
    if (y->plan.finer_rays != 0) {
        plan_reason(y, ", four times as many where views move and neighbouring rays differ");
        if (y->plan.finer_blocks != 0) {
            plan_reason(y, ", in %u of 64 blocks", y->plan.finer_blocks);
        }
    }
    budget_reasons(e, y);
    if (y->tiles.mask == 0) {
        plan_reason(y, "\nno cloud within sight: no steps");
        y->plan.march_steps = 1;
    }
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (y->tiles.mask & (1u << slot)) {
            plan_reason(y, "\nlayers '%s' between %.0f and %.0f m HAE", slots[slot], (double)y->tiles.base_m[slot],
                        (double)y->tiles.top_m[slot]);
        }
    }
    if (y->tiles.mask) {
        plan_reason(y, "\nrays end at %.0f m: horizon of the highest cloud", (double)distance_m);
    }
    if (blends) {
        plan_reason(y, "\ntwo weather states, %.3f of the second", (double)e->weather.blend);
    }
    if (y->degraded) {
        plan_reason(y, "\nfar tiles are coarser: the pages do not suffice");
    }
    if (y->incomplete) {
        plan_reason(y, "\ntiles are missing: coarser ones stand in");
    }
}

bool plan_is_study(const velum_plan *p) {
    return p->flags != 0 || p->integrator != 0 || p->scattering != 0 || p->sun_depth != 0 || p->long_step != 0.0f ||
           p->thin_density != 0.0f || p->exit_transmittance != 0.0f || p->volume_cell_m != 0.0f;
}

static bool check_study(checker *check, const eye *y, const velum_plan *p) {
    const uint32_t flags = VELUM_PLAN_STEP_THROUGH | VELUM_PLAN_BASE_SEARCH | VELUM_PLAN_LIGHT_ALL;
    if (!check_flags(check, "plan.flags", p->flags, flags) ||
        !check_count(check, "plan.integrator", p->integrator, 0, VELUM_INTEGRATOR_TRAPEZOID) ||
        !check_count(check, "plan.scattering", p->scattering, 0, VELUM_SCATTERING_VOLUME) ||
        !check_count(check, "plan.sun_depth", p->sun_depth, 0, VELUM_SUN_DEPTH_MAP) ||
        (p->long_step != 0.0f && !check_range(check, "plan.long_step", (double)p->long_step, 1.0, 64.0)) ||
        !check_range(check, "plan.thin_density", (double)p->thin_density, 0.0, 1.0) ||
        (p->exit_transmittance != 0.0f &&
         !check_range(check, "plan.exit_transmittance", (double)p->exit_transmittance, (double)1e-6f, (double)0.9f)) ||
        (p->volume_cell_m != 0.0f &&
         !check_range(check, "plan.volume_cell_m", (double)p->volume_cell_m, 50.0, 2000.0))) {
        return false;
    }
    if (y->has_study || !plan_is_study(p)) {
        return true;
    }
    const char *field = p->flags                       ? "flags"
                        : p->integrator                ? "integrator"
                        : p->scattering                ? "scattering"
                        : p->sun_depth                 ? "sun_depth"
                        : p->long_step > 0.0f          ? "long_step"
                        : p->thin_density > 0.0f       ? "thin_density"
                        : p->exit_transmittance > 0.0f ? "exit_transmittance"
                                                       : "volume_cell_m";
    return check_fail(check, VELUM_ERROR_STATE, "plan.%s: expected 0: the eye was made without VELUM_EYE_STUDY", field);
}

static bool is_ray_rate(uint32_t rate, uint32_t most) {
    return rate != 0 && rate <= most && (rate & (rate - 1)) == 0;
}

velum_result plan_impose(eye *y, const velum_plan *plan) {
    engine *e = y->e;
    checker check = {&e->sink, "eye", "set_plan", VELUM_OK};
    velum_plan p;
    if (e->state != ENGINE_IDLE || e->inside) {
        check_fail(&check, VELUM_ERROR_STATE, "not legal inside a frame");
        return check.result;
    }
    if (!plan) {
        y->is_imposed = false;
        return VELUM_OK;
    }
    if (!check_in(&check, "plan", &p, sizeof p, plan, V1_PLAN) ||
        !check_flags(&check, "plan.active_layers", p.active_layers, (1u << VELUM_SLOT_COUNT) - 1u) ||
        !check_count(&check, "plan.march_steps", p.march_steps, 1, 4096) ||
        !check_count(&check, "plan.light_steps", p.light_steps, 1, 64) ||
        !check_count(&check, "plan.octaves", p.octaves, y->quality == VELUM_QUALITY_REFERENCE ? 0 : 1,
                     y->quality == VELUM_QUALITY_REFERENCE ? 1000000 : 8) ||
        !check_count(&check, "plan.blending", p.blending, 0, 1) ||
        !check_range(&check, "plan.step_m", (double)p.step_m, 1.0, 10000.0) ||
        !check_range(&check, "plan.step_growth", (double)p.step_growth, 0.0, 0.5) ||
        !check_range(&check, "plan.distance_m", (double)p.distance_m, 1.0, 1e7)) {
        return check.result;
    }
    if (!is_ray_rate(p.ray_rate, RAY_RATE_MOST)) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "plan.ray_rate: found %u, expected 1, 2, 4, 8, 16, 32 or 64",
                   p.ray_rate);
        return check.result;
    }
    if (p.standing_ray_rate != 0 && !is_ray_rate(p.standing_ray_rate, STANDING_RAY_RATE_MOST)) {
        check_fail(&check, VELUM_ERROR_ARGUMENT,
                   "plan.standing_ray_rate: found %u, expected 0 or a power of two up to 256", p.standing_ray_rate);
        return check.result;
    }
    if (!check_count(&check, "plan.finer_rays", p.finer_rays, 0, 1) ||
        !check_count(&check, "plan.finer_blocks", p.finer_blocks, 0, GOVERNOR_FINER_MOST) ||
        !check_count(&check, "plan.every_pixel", p.every_pixel, 0, 1) || !check_study(&check, y, &p)) {
        return check.result;
    }
    p.struct_size = sizeof p;
    y->imposed = p;
    y->is_imposed = true;
    return VELUM_OK;
}
