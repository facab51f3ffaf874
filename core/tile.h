/* Tiles of smooth fields: what the GPU's pages hold (shared/slots.h, shared/tile_address.h).
 *
 * Texel i of a side, 0..33, has its centre at (i - 0.5) / 32 of the tile's side: texels 0 and 33 are the apron, half a
 * texel outside. Over a face's edge the face's own coordinates go on, so an apron texel is evaluated at its own normal
 * and every field is a function of normal and level alone. Rows run along v: texel (i, j) is at j * 34 + i. */
#ifndef VELUM_CORE_TILE_H
#define VELUM_CORE_TILE_H

#include <math.h>

#include "column.h"
#include "shared/fringe.h"
#include "shared/slots.h"
#include "shared/tile_address.h"

#define CORE_TILE_PAGE_VALUES (VELUM_TILE_SIDE * VELUM_TILE_SIDE * 4)
#define CORE_TILE_PAGE_BYTES (CORE_TILE_PAGE_VALUES * 2)

/* What makes a profile (density.h): 1, m, 1/m, 1, m/s. */
enum {
    CORE_LOOK_COVERAGE,
    CORE_LOOK_THICKNESS,
    CORE_LOOK_EXTINCTION,
    CORE_LOOK_KIND,
    CORE_LOOK_WIND,
    CORE_LOOK_VALUES
};
typedef struct core_look {
    float value[CORE_LOOK_VALUES];
} core_look;
/* Least and greatest of each. */
typedef struct core_look_range {
    core_look least, most;
} core_look_range;

typedef struct core_tile_slot {
    const uint16_t *a;           /* coverage, base, top, extinction; null: no cloud of this slot in the tile */
    const uint16_t *b;           /* wind x, y, z, kind */
    const uint16_t *fringe;      /* as shared/fringe.h has it; null: none */
    float min_base_m, max_top_m; /* HAE, over texels with coverage, apron included */
    core_look_range looks;       /* of all texels: filters take what stands where there is no cloud, too */
    velum_span_m hem_m, fall_m;  /* heights of what is there of either, HAE; low >= high: nothing */
    float max_scud_1_m, max_band_1_m, max_fall_1_m;
} core_tile_slot;

typedef struct core_tile {
    uint32_t key;
    uint32_t mask; /* slots with pages */
    uint64_t state;
    uint64_t bytes;
    core_tile_slot slot[VELUM_SLOT_COUNT];
} core_tile;

/* What a stored value is, 0..1. */
static inline float core_texel_unit(uint16_t stored) {
    return (float)stored * (1.0f / 65535.0f);
}

/* Makes the range hold the other. */
static inline void core_look_widen(core_look_range *range, const core_look_range *by) {
    for (int i = 0; i < CORE_LOOK_VALUES; i++) {
        range->least.value[i] = fminf(range->least.value[i], by->least.value[i]);
        range->most.value[i] = fmaxf(range->most.value[i], by->most.value[i]);
    }
}

static inline bool core_span_has_some(velum_span_m span) {
    return span.low < span.high;
}

/* Makes the span hold the other; of itself it may hold nothing (low >= high). */
static inline void core_span_widen(velum_span_m *span, velum_span_m by) {
    const bool first = !core_span_has_some(*span);
    span->low = first || by.low < span->low ? by.low : span->low;
    span->high = first || by.high > span->high ? by.high : span->high;
}

/* Heights of all that the slot has. */
static inline velum_span_m core_tile_slot_span(const core_tile_slot *slot) {
    velum_span_m span = {slot->min_base_m, slot->max_top_m};
    if (core_span_has_some(slot->hem_m)) {
        core_span_widen(&span, slot->hem_m);
    }
    if (core_span_has_some(slot->fall_m)) {
        core_span_widen(&span, slot->fall_m);
    }
    return span;
}

/* Heights between which a fringe of these fields can be, whatever they are mixed with: where each holds its part. */
typedef struct core_fringe_reach {
    velum_span_m scud_m, band_m, fall_m;
} core_fringe_reach;
core_fringe_reach core_fringe_reach_of(float base_m, float top_m, velum_fringe g);

/* Null: out of memory. One reference. */
core_tile *core_tile_create(const core_state *state, uint32_t key);
core_tile *core_tile_ref(core_tile *tile);
void core_tile_unref(core_tile *tile); /* null is legal */

/* One slot at (s, t), 0..1 over the tile, bilinear over the stored values as a sampler does it. Zeroed without pages.
 */
velum_slot_fields core_tile_sample(const core_tile *tile, uint32_t slot, float s, float t);
/* The same of what the slot has beyond its cloud. */
velum_fringe core_tile_fringe(const core_tile *tile, uint32_t slot, float s, float t);

/* The deepest level whose texels this key's place needs, at most the key's own: below it the weather is smooth. */
uint32_t core_tile_detail_level(const core_state *state, uint32_t key);
/* The key's ancestor of that level (or the key itself). */
uint32_t core_tile_ancestor(uint32_t key, uint32_t level);

/* Nominal size of a texel. */
double core_tile_texel_m(uint32_t level);
/* Inverse of velum_face_of, in double; u and v may lie beyond -1..1. */
void core_face_normal(uint32_t face, double u, double v, double normal[3]);
/* The normal at (s, t) of the tile, 0..1 over its side. */
void core_tile_normal(uint32_t key, double s, double t, double normal[3]);

#endif
