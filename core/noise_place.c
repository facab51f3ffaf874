#include "noise_place.h"

#include <math.h>

#include "shared/density.h"
#include "shared/hash.h"

static void phase_of(uint32_t slot, uint32_t noise, double period_m, double stretch, const double p[3],
                     const float offset[3], float out[4]) {
    static const double fibre[3] = {(double)VELUM_FIBRE_X, (double)VELUM_FIBRE_Y, (double)VELUM_FIBRE_Z};
    const double along = (1.0 - stretch) * (fibre[0] * p[0] + fibre[1] * p[1] + fibre[2] * p[2]);
    double q[3];
    for (int axis = 0; axis < 3; axis++) {
        q[axis] = stretch * p[axis] + along * fibre[axis];
    }
    const double turned[3] = {
        (double)VELUM_NOISE_AX * q[0] + (double)VELUM_NOISE_AY * q[1] + (double)VELUM_NOISE_AZ * q[2],
        (double)VELUM_NOISE_BX * q[0] + (double)VELUM_NOISE_BY * q[1] + (double)VELUM_NOISE_BZ * q[2],
        (double)VELUM_NOISE_CX * q[0] + (double)VELUM_NOISE_CY * q[1] + (double)VELUM_NOISE_CZ * q[2],
    };
    for (uint32_t axis = 0; axis < 3; axis++) {
        double own = (double)velum_hash_unit(velum_hash_3(slot, noise, axis));
        double phase = turned[axis] / period_m + own + (double)offset[axis];
        float rounded = (float)(phase - floor(phase));
        out[axis] = rounded < 1.0f ? rounded : 0.0f;
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
