/* How steep the shape noise is about every place, and how far away it is high. */
#ifndef VELUM_CORE_NOISE_SLOPE_H
#define VELUM_CORE_NOISE_SLOPE_H

#include <stdbool.h>

#include "noise.h"
#include "shared/reference.h"

/* Bytes of VELUM_SLOPE_BYTES, (z * cells + y) * cells + x, cells between the centres of texels: within
 * VELUM_SLOPE_RADIUS of any point of the cell, filtered ranks change by so many VELUM_SLOPE_UNIT a period at most.
 * False: out of memory. */
bool core_noise_slope(const core_noise *noise, uint8_t *out);

/* Bytes of VELUM_AWAY_BYTES, ((level * cells + z) * cells + y) * cells + x: from any point of the cell, filtered ranks
 * are below velum_away_rank(level) within so many VELUM_AWAY_UNIT cells. False: out of memory. */
bool core_noise_away(const core_noise *noise, uint8_t *out);

/* The greatest change of filtered detail noise over a period. */
float core_noise_detail_slope(const core_noise *noise);

#endif
