#include "methods.h"

#include <stddef.h>
#include <string.h>

/* Each pixel its own ray in every frame, and steps enough: the error is that of what the row changes. */
static void alone(velum_plan *plan) {
    plan->ray_rate = 1;
    plan->standing_ray_rate = 0;
    plan->march_steps = 4096;
}

static void set_step(velum_plan *plan, double value) {
    alone(plan);
    plan->step_m = (float)value;
}

static void set_step_no_growth(velum_plan *plan, double value) {
    alone(plan);
    plan->step_m = (float)value;
    plan->step_growth = 0.0f;
}

static void set_growth(velum_plan *plan, double value) {
    alone(plan);
    plan->step_growth = (float)value;
}

static void set_march_steps(velum_plan *plan, double value) {
    alone(plan);
    plan->march_steps = (uint32_t)value;
}

static void set_light_steps(velum_plan *plan, double value) {
    alone(plan);
    plan->light_steps = (uint32_t)value;
}

static void set_ray_rate(velum_plan *plan, double value) {
    plan->ray_rate = (uint32_t)value;
    plan->standing_ray_rate = 0;
}

/* Of steps in cloud, metres; those that look for it are as long. Every sample finds its own light, so that the error
 * falls with the steps. */
static void set_integrator(velum_plan *plan, uint32_t integrator, double step_m) {
    alone(plan);
    plan->flags = VELUM_PLAN_LIGHT_ALL;
    plan->integrator = integrator;
    plan->long_step = 1.0f;
    plan->step_m = (float)(step_m / 0.18);
    plan->step_growth = (float)(step_m * 5e-4);
}

static void set_energy(velum_plan *plan, double value) {
    set_integrator(plan, VELUM_INTEGRATOR_ENERGY, value);
}

static void set_before(velum_plan *plan, double value) {
    set_integrator(plan, VELUM_INTEGRATOR_BEFORE, value);
}

static void set_after(velum_plan *plan, double value) {
    set_integrator(plan, VELUM_INTEGRATOR_AFTER, value);
}

static void set_trapezoid(velum_plan *plan, double value) {
    set_integrator(plan, VELUM_INTEGRATOR_TRAPEZOID, value);
}

/* 0: all steps alike, and nothing is passed at once. */
static void set_empty(velum_plan *plan, double value) {
    alone(plan);
    plan->flags = value < 1.0 ? VELUM_PLAN_STEP_THROUGH : 0;
    plan->long_step = value < 1.0 ? 1.0f : (float)value;
}

static void set_empty_through(velum_plan *plan, double value) {
    set_empty(plan, value);
    plan->flags |= VELUM_PLAN_STEP_THROUGH;
}

static void set_empty_base(velum_plan *plan, double value) {
    set_empty(plan, value);
    plan->flags |= VELUM_PLAN_BASE_SEARCH;
}

static void set_exit(velum_plan *plan, double value) {
    alone(plan);
    plan->exit_transmittance = (float)value;
}

static void set_thin(velum_plan *plan, double value) {
    alone(plan);
    plan->thin_density = (float)value;
}

static void set_sun_coarse(velum_plan *plan, double value) {
    set_light_steps(plan, value);
    plan->sun_depth = VELUM_SUN_DEPTH_COARSE;
}

static void set_sun_fine(velum_plan *plan, double value) {
    set_light_steps(plan, value);
    plan->sun_depth = VELUM_SUN_DEPTH_FINE;
}

static void set_sun_all(velum_plan *plan, double value) {
    set_light_steps(plan, value);
    plan->flags = VELUM_PLAN_LIGHT_ALL;
}

static void set_sun_limit(velum_plan *plan, double value) {
    set_sun_fine(plan, value);
    plan->flags = VELUM_PLAN_LIGHT_ALL;
}

static void set_sun_map(velum_plan *plan, double value) {
    (void)value;
    alone(plan);
    plan->sun_depth = VELUM_SUN_DEPTH_MAP;
}

static void set_octaves(velum_plan *plan, double value) {
    alone(plan);
    plan->scattering = VELUM_SCATTERING_OCTAVES;
    plan->octaves = (uint32_t)value;
}

static void set_volume(velum_plan *plan, double value) {
    alone(plan);
    plan->scattering = VELUM_SCATTERING_VOLUME;
    plan->volume_cell_m = (float)value;
}

static void set_closure(velum_plan *plan, double value) {
    (void)value;
    alone(plan);
}

/* P. Ford 2024, section 5.4: rungs, each on top of those before. Frames are the row's. */
static void set_ladder(velum_plan *plan, double value) {
    int rung = (int)value;
    alone(plan);
    plan->flags = rung < 4 ? VELUM_PLAN_STEP_THROUGH : 0;
    plan->long_step = rung < 4 ? 1.0f : 0.0f;
    plan->step_growth = rung < 4 ? 0.0f : plan->step_growth;
    plan->step_m = (float)((rung < 3 ? 9.0 : 100.0) / 0.18);
    plan->exit_transmittance = rung < 1 ? 1e-6f : 0.075f;
    plan->thin_density = rung < 2 ? 0.0f : 0.01f;
    plan->ray_rate = rung < 5 ? 1 : rung < 6 ? 4 : 16;
    plan->standing_ray_rate = 0;
}

/* Their number, and they. */
#define VALUES(...)                                                                                                    \
    sizeof((double[]){__VA_ARGS__}) / sizeof(double), {                                                                \
        __VA_ARGS__                                                                                                    \
    }

/* Hillaire 2016: 21 samples of the energy-conserving for 512 of others. */
#define STEPS_M VALUES(320, 160, 80, 40, 20, 10, 5, 2.5)

const method_row method_rows[] = {
    {"steps", "step length, growing", "m", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_step,
     VALUES(1000, 700, 400, 250, 160, 110, 60, 35, 20)},
    {"steps", "step length, constant", "m", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_step_no_growth,
     VALUES(1000, 700, 400, 250, 160, 110, 60)},
    {"growth", "growth of steps", "of distance", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_growth,
     VALUES(0.2, 0.1, 0.0667, 0.05, 0.04, 0.025, 0.012, 0.006, 0.0)},
    {"march_steps", "steps a ray", "at most", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_march_steps,
     VALUES(16, 32, 64, 128, 256, 512, 1024)},
    {"sun", "samples towards the sun", "samples", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_light_steps,
     VALUES(1, 2, 3, 4, 5, 6, 8, 12, 16, 32)},
    {"sun", "without lumps", "samples", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_sun_coarse, VALUES(1, 2, 4, 8, 16)},
    {"sun", "all detail", "samples", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_sun_fine, VALUES(1, 2, 4, 8, 16)},
    {"sun", "light at every sample", "samples", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_sun_all,
     VALUES(1, 2, 4, 8, 16)},
    {"sun", "shadow map instead", "", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_sun_map, VALUES(0)},
    {"rays", "still", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_STILL, set_ray_rate, VALUES(16, 4, 2, 1)},
    {"rays", "250 m/s", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_FORWARD, set_ray_rate, VALUES(16, 4, 2, 1)},
    {"rays", "60 deg/s of roll", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_ROLL, set_ray_rate,
     VALUES(16, 4, 2, 1)},
    {"rays", "wind of 50 m/s", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_WIND, set_ray_rate, VALUES(16, 4, 2, 1)},
    /* One octave is single scattering. */
    {"orders", "octaves", "octaves", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_octaves, VALUES(1, 2, 4, 8)},
    {"orders", "volume of light, once made", "m a cell", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_volume,
     VALUES(400, 200, 100)},
    {"orders", "Velum", "", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_closure, VALUES(0)},
    {"integrators", "energy-conserving", "m in cloud", VELUM_QUALITY_HIGH, 4, MOTION_STILL, set_energy, STEPS_M},
    {"integrators", "before-step", "m in cloud", VELUM_QUALITY_HIGH, 4, MOTION_STILL, set_before, STEPS_M},
    {"integrators", "after-step", "m in cloud", VELUM_QUALITY_HIGH, 4, MOTION_STILL, set_after, STEPS_M},
    {"integrators", "trapezoid", "m in cloud", VELUM_QUALITY_HIGH, 4, MOTION_STILL, set_trapezoid, STEPS_M},
    {"empty", "long steps in empty air", "times those in cloud", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_empty,
     VALUES(0, 1, 2, 2.5, 3.3333, 5, 8, 10, 16, 32)},
    {"empty", "long steps, none passed at once", "times those in cloud", VELUM_QUALITY_HIGH, 8, MOTION_STILL,
     set_empty_through, VALUES(2, 5, 10, 32)},
    {"empty", "long steps over the base shape", "times those in cloud", VELUM_QUALITY_HIGH, 8, MOTION_STILL,
     set_empty_base, VALUES(2, 5, 10, 32)},
    {"exit", "early exit", "transmittance", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_exit,
     VALUES(1e-6, 0.0015, 0.005, 0.02, 0.075, 0.15, 0.3, 0.5)},
    {"thin", "thin samples skipped", "of mean density", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_thin,
     VALUES(0, 0.001, 0.01, 0.03, 0.1, 0.3, 1)},
    {"ladder", "Ford's ladder", "rung", VELUM_QUALITY_HIGH, 1, MOTION_STILL, set_ladder, VALUES(0, 1, 2)},
    {"ladder", "Ford's ladder", "rung", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_ladder, VALUES(3, 4, 5, 6)},
    {NULL, NULL, NULL, 0, 0, MOTION_STILL, NULL, 0, {0}},
};

/* As fine as it goes, over more frames. */
static const method_row limits[] = {
    {"steps", "limit", "m", VELUM_QUALITY_HIGH, 24, MOTION_STILL, set_step_no_growth, VALUES(20)},
    {"growth", "limit", "of distance", VELUM_QUALITY_HIGH, 24, MOTION_STILL, set_growth, VALUES(0)},
    {"sun", "limit", "samples", VELUM_QUALITY_HIGH, 24, MOTION_STILL, set_sun_limit, VALUES(32)},
    {"integrators", "limit", "m in cloud", VELUM_QUALITY_HIGH, 24, MOTION_STILL, set_energy, VALUES(2.5)},
    {"empty", "limit", "times those in cloud", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_empty, VALUES(0)},
    {"exit", "limit", "transmittance", VELUM_QUALITY_HIGH, 24, MOTION_STILL, set_exit, VALUES(1e-6)},
    {"thin", "limit", "of mean density", VELUM_QUALITY_HIGH, 24, MOTION_STILL, set_thin, VALUES(0)},
};

const method_row *method_limit(const char *group) {
    for (size_t i = 0; i < sizeof limits / sizeof limits[0]; i++) {
        if (strcmp(limits[i].group, group) == 0) {
            return &limits[i];
        }
    }
    return NULL;
}

int method_matches(const method_row *row, const char *text) {
    return !text || strcmp(text, "all") == 0 || strcmp(row->group, text) == 0 || strcmp(row->name, text) == 0;
}
