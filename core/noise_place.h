/* Where a place on the planet lies in the noises of a slot: what the GPU gets of the eye, and the queries of a point.
 */
#ifndef VELUM_CORE_NOISE_PLACE_H
#define VELUM_CORE_NOISE_PLACE_H

#include <stdint.h>

#include "drift.h"

/* For each drift phase: coordinates of the position, in periods modulo 1, and 1 / period, 1/m. */
typedef struct core_slot_phases {
    float shape[2][4];
    float lump[2][4];
    float fine[2][4];
} core_slot_phases;

/* Rotation of the position over the period, plus offsets of slot, noise, seed and drift cycle, formed in double. The
 * position must be finite. */
void core_slot_phases_at(uint32_t slot, const double position_ecef_m[3], const core_drift *drift,
                         core_slot_phases *out);

#endif
