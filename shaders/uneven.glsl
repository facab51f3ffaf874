/* Layers at uneven heights: which a step can meet, and how far a ray is clear of the others. */
#ifndef VELUM_UNEVEN_GLSL
#define VELUM_UNEVEN_GLSL

#include "fringe.glsl"

/* Weather differs from place to place: parts of tiles tell where layers are. Else that would be asked for nothing. */
layout(constant_id = 10) const bool velum_uneven = true;

/* The word of a page's spans (shared/tile_address.h) for a place in it. */
uint part_word_of(tile_place place) {
    ivec2 part = part_at(place.uv);
    return uint(part.y * VELUM_PARTS + part.x);
}

/* Between the heights of layers that a step does not meet: highest below, lowest above. */
const vec2 no_gap_m = vec2(-1.0e9, 1.0e9);
vec2 gap_beside(vec2 gap_m, float low, float high, vec2 span_m) {
    return vec2(low >= span_m.y ? max(gap_m.x, span_m.y) : gap_m.x, high <= span_m.x ? min(gap_m.y, span_m.x) : gap_m.y);
}

/* How far a ray at height h that rises by `rise` a metre is in it (curvature makes every ray rise faster as it goes). */
float gap_way_m(vec2 gap_m, float h, float rise) {
    const float r = VELUM_WGS84_A_M;
    float up = r * (sqrt(rise * rise + 2.0 * (gap_m.y - h) / r) - rise);
    float inside = rise * rise - 2.0 * (h - gap_m.x) / r;
    float down = rise < 0.0 && inside > 0.0 ? r * (-rise - sqrt(inside)) : 1.0e9;
    return min(up, down);
}

#endif
