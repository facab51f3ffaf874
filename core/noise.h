/* The two tiling noises of shared/density.h. Made from integer lattices when Velum is built (noise_make.h): the same on
 * every machine that rounds floats to nearest. */
#ifndef VELUM_CORE_NOISE_H
#define VELUM_CORE_NOISE_H

#include <stdint.h>

#define CORE_NOISE_SHAPE_SIDE 128
#define CORE_NOISE_DETAIL_SIDE 64
#define CORE_NOISE_SHAPE_BYTES (CORE_NOISE_SHAPE_SIDE * CORE_NOISE_SHAPE_SIDE * CORE_NOISE_SHAPE_SIDE)
#define CORE_NOISE_DETAIL_BYTES (CORE_NOISE_DETAIL_SIDE * CORE_NOISE_DETAIL_SIDE * CORE_NOISE_DETAIL_SIDE)

/* Texel (x, y, z) is at (z * side + y) * side + x, its centre at (x + 0.5) / side of the period.
 * shape: Perlin-Worley, equalised: its trilinearly filtered values are uniform over 0..1, everywhere in the period
 * alike. detail: Worley, four octaves, cell walls 0, hearts 1; mean 0.5, 0 and 1 at 2.5 standard deviations. */
typedef struct core_noise {
    uint8_t shape[CORE_NOISE_SHAPE_BYTES];
    uint8_t detail[CORE_NOISE_DETAIL_BYTES];
} core_noise;

/* Constant; shared by all. */
const core_noise *core_noise_built(void);

/* 0..1, period 1, filtered as Vulkan's linear filter with repeat does. */
float core_noise_shape(const core_noise *noise, float x, float y, float z);
float core_noise_detail(const core_noise *noise, float x, float y, float z);

#endif
