/* Tiling fields of Perlin and Worley noise over a cube of n^3 texels, n a power of two, cells dividing n. */
#ifndef VELUM_CORE_NOISE_FIELD_H
#define VELUM_CORE_NOISE_FIELD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

void noise_field_clear(float *field, size_t count);
/* Adds weight times 1 - distance to the nearest of one point for each cell, in cells, at most 1 (Worley 1996). At most
 * 64 cells a side, at most 32 texels a cell. False: out of memory. */
bool noise_field_add_worley(float *field, uint32_t n, uint32_t cells, float weight, uint32_t seed);
/* Adds weight times gradient noise, about -1..1 (Perlin 2002). */
void noise_field_add_perlin(float *field, uint32_t n, uint32_t cells, float weight, uint32_t seed);

#endif
