/* The noise volumes as textures of a format. */
#ifndef VELUM_TESTS_NOISE_TEXTURES_H
#define VELUM_TESTS_NOISE_TEXTURES_H

#include "compute.h"

/* R8_UNORM, R16_UNORM or R32_SFLOAT; of n^3 values of 8 bits. Wider formats hold the same values. */
bool noise_texture_create(compute_device *device, VkFormat format, uint32_t side, const uint8_t *values,
                          compute_texture *texture);

#endif
