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

/* tile_move where weather is even: the tiles under a tile of data are all as that is. */
tile_place tile_move_even(tile_place last, vec3 normal, float distance_m) {
    velum_face_place face = velum_face_of(normal.x, normal.y, normal.z);
    uint level = velum_tile_level(distance_m, eye.weather.x);
    uint data_level = min(level, uint(VELUM_TILE_DATA_LEVEL_MIN));
    vec2 at = vec2(velum_tile_coordinate(face.u, data_level), velum_tile_coordinate(face.v, data_level));
    uint key = velum_tile_key(data_level, uint(face.face), uint(at.x), uint(at.y));
    tile_place place = last;
    if (key != last.key) {
        uint own_key = velum_tile_key(level, uint(face.face), uint(velum_tile_coordinate(face.u, level)),
                                      uint(velum_tile_coordinate(face.v, level)));
        place = tile_look_up(face, int(level), own_key);
        place.key = key;
        place.scale *= float(1u << (level - data_level));
        place.face = face.face;
    }
    place.uv = uv_in_page(at * place.scale);
    return place;
}

#endif
