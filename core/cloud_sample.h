/* The density function over the CPU's noise: the same steps as shaders/weather.glsl takes over the GPU's. */
#ifndef VELUM_CORE_CLOUD_SAMPLE_H
#define VELUM_CORE_CLOUD_SAMPLE_H

#include <stdbool.h>

#include "drift.h"
#include "noise.h"
#include "noise_place.h"
#include "shared/fringe.h"
#include "shared/sample.h"

/* One slot's noise around an origin: points are offsets from it, m, ECEF. */
typedef struct core_cloud_noise {
    const core_noise *noise;
    core_slot_phases phases;
    float tau_s[2];
    float weight_1; /* of drift phase 1 */
    bool drifting;  /* both phases have weight */
    float stretch, fine_stretch;
    float origin_m[3]; /* ECEF */
    int slot;
} core_cloud_noise;

core_cloud_noise core_cloud_noise_at(const core_noise *noise, uint32_t slot, const double origin_ecef_m[3],
                                     const core_drift *drift);

/* -1..1, and 0..1. */
float core_cloud_lump(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3]);
float core_cloud_fine(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3]);

/* Rank of the column over a point, 0..1. */
float core_cloud_rank(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3],
                      const float normal[3], float height_m);
/* Extinction at a point of a column of that rank, 1/m, by the fields' velum_profile_of; not of uniform layers. `fine`:
 * with fine detail. */
float core_cloud_extinction_of(const core_cloud_noise *cloud, const velum_slot_fields *fields,
                               const velum_profile *profile, float rank, const float point_m[3], float height_m,
                               bool fine);
/* Extinction at a point, 1/m. */
float core_cloud_extinction(const core_cloud_noise *cloud, const velum_slot_fields *fields, const float point_m[3],
                            const float normal[3], float height_m, bool fine);
/* The same of what lies beyond the cloud. */
float core_cloud_fringe(const core_cloud_noise *cloud, const velum_slot_fields *fields, const velum_fringe *fringe,
                        const float point_m[3], const float normal[3], float height_m, bool fine);

#endif
