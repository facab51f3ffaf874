#include "noise_place.h"

#include <math.h>

#include "shared/density.h"
#include "shared/fibre.h"
#include "shared/hash.h"

static const double axes[3][3] = {{(double)VELUM_NOISE_AX, (double)VELUM_NOISE_AY, (double)VELUM_NOISE_AZ},
                                  {(double)VELUM_NOISE_BX, (double)VELUM_NOISE_BY, (double)VELUM_NOISE_BZ},
                                  {(double)VELUM_NOISE_CX, (double)VELUM_NOISE_CY, (double)VELUM_NOISE_CZ}};

static double along(const double axis[3], const double p[3]) {
    return axis[0] * p[0] + axis[1] * p[1] + axis[2] * p[2];
}

static float cyclic(double periods) {
    float rounded = (float)(periods - floor(periods));
    return rounded < 1.0f ? rounded : 0.0f;
}

/* As velum_north_m, from the equator. */
static double north_m(const double p[3]) {
    return (double)VELUM_WGS84_A_M * atan2(p[2], hypot(p[0], p[1]));
}

static void phase_of(uint32_t slot, uint32_t noise, double period_m, double stretch, const double p[3],
                     const float offset[3], float out[4]) {
    const double q[3] = {stretch * p[0], stretch * p[1], stretch * p[2] + (1.0 - stretch) * north_m(p)};
    for (uint32_t axis = 0; axis < 3; axis++) {
        double own = (double)velum_hash_unit(velum_hash_3(slot, noise, axis));
        out[axis] = cyclic(along(axes[axis], q) / period_m + own + (double)offset[axis]);
    }
    out[3] = (float)(1.0 / period_m);
}

void core_slot_phases_at(uint32_t slot, const double position_ecef_m[3], const core_drift *drift,
                         core_slot_phases *out) {
    const velum_slot_noise noise = velum_noise_of((int)slot);
    for (int life = 0; life < 2; life++) {
        const float *offset = drift->offset[life];
        phase_of(slot, 0, (double)noise.shape_period_m, (double)noise.stretch, position_ecef_m, offset,
                 out->shape[life]);
        phase_of(slot, 1, (double)noise.lump_period_m, 1.0, position_ecef_m, offset, out->lump[life]);
        phase_of(slot, 2, (double)noise.fine_period_m, (double)noise.fine_stretch, position_ecef_m, offset,
                 out->fine[life]);
    }
}
