/* From any field to ranks: uniform over 0..1 when filtered trilinearly, in every part of the period alike. */
#ifndef VELUM_CORE_NOISE_EQUALISE_H
#define VELUM_CORE_NOISE_EQUALISE_H

#include <stdbool.h>
#include <stdint.h>

/* `field`: n^3 values, n = 128, tiling; spent. False: out of memory. */
bool noise_equalise(float *field, uint32_t n, uint8_t *texels);

#endif
