/* Between which heights there is anything of a slot, part by part of a tile (shared/tile_address.h). */
#ifndef VELUM_CORE_TILE_SPANS_H
#define VELUM_CORE_TILE_SPANS_H

#include "tile.h"

/* Of a slot's cloud; or with VELUM_SLOT_COUNT + slot, of its hem and of what falls from it. VELUM_SPAN_NONE where a
 * part, as far as filtering reaches, has no cloud of the slot. They hold between texels, and where the same place of
 * two tiles is mixed both hold together. */
void core_tile_spans(const core_tile *tile, uint32_t slot, uint32_t words[VELUM_SPAN_WORDS]);

/* The four texels that a place of a tile is filtered from; `edge` is how far it is from others, in texels. */
typedef struct core_tile_quad {
    uint32_t texel; /* the first of them, as rows run */
    float edge;
} core_tile_quad;
core_tile_quad core_tile_quad_at(float s, float t);

/* Between which heights there is anything of a slot within a quad: cloud, hem or what falls, alone or mixed with
 * another tile's. Nothing: low >= high. */
velum_span_m core_tile_quad_span(const core_tile *tile, uint32_t slot, core_tile_quad quad);

#endif
