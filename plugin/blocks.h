/* From the host's doubles and the world's states to the blocks that shaders read. */
#ifndef PLUGIN_BLOCKS_H
#define PLUGIN_BLOCKS_H

#include <math.h>

#include "engine.h"

/* An eye's block at a place; `plan` may be null: all layers. False: the place is not usable. */
bool blocks_fill_eye(const engine *e, const tiles *t, const double position_ecef_m[3], const velum_plan *plan,
                     velum_eye_block *out);

/* Phase function (asymmetry given in any case) and albedo of a UNIFORM slot. */
core_uniform_phase blocks_uniform_phase(const engine *e, uint32_t slot);

/* Whether two weather states, or two lives of the noise, are mixed in this frame. */
bool blocks_mix(const engine *e);

/* By the clouds over the place, weighted by their coverage. */
void blocks_wind(const engine *e, const tiles *t, const double position_ecef_m[3], cloud_wind *out);

/* A shadow map's block with positions relative to another origin. */
void blocks_shift_shadow(const velum_shadow_geometry *geometry, const double origin_ecef_m[3], velum_shadow_block *out);

static inline double dot3(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void cross3(const double a[3], const double b[3], double out[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

/* Unit vectors across a direction and each other; of the vertical east and north, but not within 26 degrees of a pole.
 */
static inline void axes_across(const double direction[3], double u[3], double v[3]) {
    const double pole[3] = {0.0, 0.0, 1.0};
    const double meridian[3] = {1.0, 0.0, 0.0};
    cross3(fabs(direction[2]) < 0.9 ? pole : meridian, direction, u);
    double length = sqrt(dot3(u, u));
    for (int i = 0; i < 3; i++) {
        u[i] /= length;
    }
    cross3(direction, u, v);
}

/* Square of how far. */
static inline double apart2(const double a[3], const double b[3]) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum;
}

#endif
