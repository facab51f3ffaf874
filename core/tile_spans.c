#include "tile_spans.h"

#include <math.h>

/* Of stored heights: what filters round. */
#define SPARE_M 1.0f

static uint32_t word_of(velum_span_m span) {
    if (!core_span_has_some(span)) {
        return VELUM_SPAN_NONE;
    }
    const float low = floorf(velum_texel_from_height(span.low - SPARE_M) * 65535.0f);
    const float high = ceilf(velum_texel_from_height(span.high + SPARE_M) * 65535.0f);
    return (uint32_t)low | (uint32_t)high << 16;
}

/* Fields are mixed before spans are made of them: these hold of any mixture. */
static void widen(const core_tile_slot *from, size_t texel, bool fringe, velum_span_m spans[2]) {
    const uint16_t *a = from->a + texel * 4;
    const float base_m = velum_texel_height_m(core_texel_unit(a[1]));
    const float top_m = velum_texel_height_m(core_texel_unit(a[2]));
    if (!fringe) {
        core_span_widen(&spans[0], (velum_span_m){base_m, fmaxf(top_m, base_m + SPARE_M)});
        return;
    }
    const uint16_t *v = from->fringe + texel * 4;
    const core_fringe_reach reach =
        core_fringe_reach_of(base_m, top_m,
                             velum_fringe_of_texel(core_texel_unit(v[0]), core_texel_unit(v[1]), core_texel_unit(v[2]),
                                                   core_texel_unit(v[3])));
    core_span_widen(&spans[0], reach.scud_m);
    core_span_widen(&spans[0], reach.band_m);
    core_span_widen(&spans[1], reach.fall_m);
}

void core_tile_spans(const core_tile *tile, uint32_t slot, uint32_t words[VELUM_SPAN_WORDS]) {
    const bool fringe = slot >= VELUM_SLOT_COUNT;
    const core_tile_slot *from = &tile->slot[slot % VELUM_SLOT_COUNT];
    const uint32_t step = VELUM_TILE_TEXELS / VELUM_PARTS;
    const uint32_t reach = step + 2;
    for (uint32_t part = 0; part < VELUM_PARTS * VELUM_PARTS; part++) {
        velum_span_m spans[2] = {0};
        bool some[3] = {false}; /* cloud, hem, fall */
        for (uint32_t i = 0; i < reach * reach; i++) {
            const size_t texel = (size_t)(part / VELUM_PARTS * step + i / reach) * VELUM_TILE_SIDE +
                                 part % VELUM_PARTS * step + i % reach;
            const uint16_t *v = fringe ? from->fringe + texel * 4 : NULL;
            some[0] = some[0] || from->a[texel * 4] > 0;
            some[1] = some[1] || (v && (v[0] > 0 || v[1] > 0));
            some[2] = some[2] || (v && v[2] > 0);
            widen(from, texel, fringe, spans);
        }
        const bool first = some[0] && (!fringe || some[1]);
        words[part] = first ? word_of(spans[0]) : VELUM_SPAN_NONE;
        words[VELUM_PARTS * VELUM_PARTS + part] = some[0] && some[2] ? word_of(spans[1]) : VELUM_SPAN_NONE;
    }
}

core_tile_quad core_tile_quad_at(float s, float t) {
    const float x = velum_clamp(s, 0.0f, 1.0f) * VELUM_TILE_TEXELS + 0.5f;
    const float y = velum_clamp(t, 0.0f, 1.0f) * VELUM_TILE_TEXELS + 0.5f;
    const uint32_t i = (uint32_t)fminf(x, VELUM_TILE_SIDE - 2);
    const uint32_t j = (uint32_t)fminf(y, VELUM_TILE_SIDE - 2);
    const float over_x = x - (float)i;
    const float over_y = y - (float)j;
    return (core_tile_quad){j * VELUM_TILE_SIDE + i, fminf(fminf(over_x, 1.0f - over_x), fminf(over_y, 1.0f - over_y))};
}

velum_span_m core_tile_quad_span(const core_tile *tile, uint32_t slot, core_tile_quad quad) {
    const core_tile_slot *from = &tile->slot[slot];
    const size_t corner[4] = {quad.texel, quad.texel + 1, quad.texel + VELUM_TILE_SIDE,
                              quad.texel + VELUM_TILE_SIDE + 1};
    velum_span_m spans[4] = {0}; /* cloud, nothing, hem, fall */
    bool some = false;
    for (uint32_t k = 0; k < 4; k++) {
        some = some || from->a[corner[k] * 4] > 0;
        widen(from, corner[k], false, &spans[0]);
        if (from->fringe) {
            widen(from, corner[k], true, &spans[2]);
        }
    }
    velum_span_m whole = {0};
    for (uint32_t k = 0; some && k < 4; k++) {
        if (core_span_has_some(spans[k])) {
            core_span_widen(&whole, (velum_span_m){spans[k].low - SPARE_M, spans[k].high + SPARE_M});
        }
    }
    return whole;
}
