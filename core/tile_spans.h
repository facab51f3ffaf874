/* Between which heights there is anything of a slot, part by part of a tile (shared/tile_address.h). */
#ifndef VELUM_CORE_TILE_SPANS_H
#define VELUM_CORE_TILE_SPANS_H

#include "tile.h"

/* Of a slot's cloud; or with VELUM_SLOT_COUNT + slot, of its hem and of what falls from it. VELUM_SPAN_NONE where a
 * part, as far as filtering reaches, has no cloud of the slot. They hold between texels, and where the same place of
 * two tiles is mixed both hold together. */
void core_tile_spans(const core_tile *tile, uint32_t slot, uint32_t words[VELUM_SPAN_WORDS]);

#endif
