/* What holds for a slot anywhere in a tile: bounds for tracking (shared/reference.h). */
#ifndef VELUM_CORE_TILE_BOUNDS_H
#define VELUM_CORE_TILE_BOUNDS_H

#include "shared/reference.h"
#include "tile.h"

/* Zeroed without cloud of the slot. */
void core_tile_bounds(const core_tile *tile, uint32_t slot, velum_page_bounds *out);

/* Of its fringe alone. */
void core_tile_fringe_bounds(const core_tile *tile, uint32_t slot, velum_page_bounds *out);

#endif
