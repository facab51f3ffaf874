/* Radiative transfer in plane-parallel layers: what shared/scattering.h describes. */
#ifndef VELUM_CORE_SCATTERING_TABLE_H
#define VELUM_CORE_SCATTERING_TABLE_H

#include <stdbool.h>

#include "shared/scattering.h"

enum { CORE_SCATTERING_TEXELS = VELUM_SCATTERING_SLICES * VELUM_SCATTERING_DEPTHS * VELUM_SCATTERING_DEPTHS };

/* Texels of x, then y, then z. False: no memory. albedo: of single scattering, 0..1; 0 gives darkness. Takes 0.05 s. */
bool core_scattering_table(velum_phase_lobes phase, float albedo, float out[CORE_SCATTERING_TEXELS][4]);

#endif
