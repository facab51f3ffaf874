/* What clouds leave of the light of sun and sky over a place. */
#ifndef PLUGIN_SHADES_H
#define PLUGIN_SHADES_H

#include "core/column.h"
#include "shared/shade.h"

/* Adds to velum_eye_block.shades what one column of weather makes of it, in a blend of them. albedo: of the ground. */
void shades_add(const core_column *column, float mu_sun, float albedo, float weight,
                float shades[VELUM_SHADE_LEVELS][4]);

#endif
