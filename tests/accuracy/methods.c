#include "methods.h"

#include <stddef.h>
#include <string.h>

/* Each pixel its own ray in every frame, and steps enough: the error is that of what the row changes. */
static void alone(velum_plan *plan) {
    plan->ray_rate = 1;
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
}

static void set_octaves(velum_plan *plan, double value) {
    alone(plan);
    plan->octaves = (uint32_t)value;
}

/* Their number, and they. */
#define VALUES(...)                                                                                                    \
    sizeof((double[]){__VA_ARGS__}) / sizeof(double), {                                                                \
        __VA_ARGS__                                                                                                    \
    }

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
    {"rays", "still", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_STILL, set_ray_rate, VALUES(16, 4, 1)},
    {"rays", "250 m/s", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_FORWARD, set_ray_rate, VALUES(16, 4, 1)},
    {"rays", "60 deg/s of roll", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_ROLL, set_ray_rate, VALUES(16, 4, 1)},
    {"rays", "wind of 50 m/s", "pixels a ray", VELUM_QUALITY_HIGH, 48, MOTION_WIND, set_ray_rate, VALUES(16, 4, 1)},
    {"orders", "octaves", "octaves", VELUM_QUALITY_HIGH, 8, MOTION_STILL, set_octaves, VALUES(1, 2, 4, 8)},
    {NULL, NULL, NULL, 0, 0, MOTION_STILL, NULL, 0, {0}},
};

int method_matches(const method_row *row, const char *text) {
    return !text || strcmp(text, "all") == 0 || strcmp(row->group, text) == 0 || strcmp(row->name, text) == 0;
}
