/* How fine the weather is at a place. Private to tiles and tile sets. */
#ifndef VELUM_CORE_TILE_DETAIL_H
#define VELUM_CORE_TILE_DETAIL_H

#include "state_private.h"
#include "tile.h"

/* The part of the planet that a key stands for, as a circle. */
typedef struct core_tile_cap {
    uint32_t level;
    double normal[3];
    double corner[4][3];
    double radius_m;
} core_tile_cap;
core_tile_cap core_tile_cap_of(uint32_t key);

/* False: the cell cannot change the detail of the cap, nor of anything inside it. */
bool core_cell_matters(const core_cell *cell, const core_tile_cap *cap);

/* False: it has no layers over the cap. */
bool core_cell_touches(const core_cell *cell, const core_tile_cap *cap);

/* The level whose texels are at most so large. */
uint32_t core_level_of_texel(double texel_m);
/* What the fading wind of global cells asks for at a pole. */
#define CORE_POLE_FADE_TEXEL_M (CORE_POLE_FADE_DEG * 111195.0 / 8.0)

/* core_tile_detail_level with the stations and regions to look at given by number: all that matter, or more. */
uint32_t core_detail_level(const core_state *state, const uint32_t *cells, uint32_t count, const core_tile_cap *cap);

#endif
