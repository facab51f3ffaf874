/* Makes the noises, when Velum is built (noise_source.c). */
#ifndef VELUM_CORE_NOISE_MAKE_H
#define VELUM_CORE_NOISE_MAKE_H

#include <stdbool.h>

#include "noise.h"

/* False: no memory. */
bool core_noise_make(core_noise *out);

#endif
