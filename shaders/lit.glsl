/* Places of rays that get light: what the march leaves to light.comp, and that to gather.comp. Rays differ in where they
 * meet cloud and how often; listed, the places are lit side by side, however their rays went. The rays that are due
 * are listed beside them (due.glsl). */
#ifndef VELUM_LIT_GLSL
#define VELUM_LIT_GLSL

#include "shared/arguments.h"
#include "shared/lit.h"

/* Of a ray, VELUM_LIT_PLACES, or VELUM_FINER_PLACES where blocks may have more rays. As the march leaves it: pack_place.
 * As light.comp leaves it, four halves: luminance / VELUM_LUMINANCE_UNIT times the place's share; how far beyond, m, times
 * that share, its light comes from. In motion near.comp leaves the ray itself there: see own_head. */
layout(set = 1, binding = VELUM_BIND_LIT, std430) buffer lit_buffer {
    uint lit_columns, lit_rows, lit_layers; /* of the dispatch */
    uint lit_count;                         /* of the list */
    uint due_columns, due_rows, due_layers, due_count; /* see due.glsl */
    uint finer_count, finer_unused_1, finer_unused_2, finer_unused_3; /* blocks: see finer.comp */
    uvec2 lit[];
};
layout(set = 1, binding = VELUM_BIND_LIT_LIST, std430) buffer lit_list_buffer {
    uint lit_list[];
};

const float most_half = 60000.0; /* to spare what a device may round up */

/* Distance m and length m of the step (of a uniform layer, and of what falls: of all steps that are lit as one), share of
 * the picture, slot (or VELUM_PART_*; below 32). The least bits of the distance, 2e-6 of it, are the part's; the others are
 * halves. */
const uint part_bits = 31u;
const float length_unit_m = 16.0;
uvec2 pack_place(vec4 place) {
    uint distance_bits = (floatBitsToUint(place.x) & ~part_bits) | uint(place.w);
    return uvec2(distance_bits, packHalf2x16(vec2(min(place.y / length_unit_m, most_half), place.z)));
}
vec4 unpack_place(uvec2 place) {
    vec2 halves = unpackHalf2x16(place.y);
    return vec4(uintBitsToFloat(place.x & ~part_bits), length_unit_m * halves.x, halves.y, float(place.x & part_bits));
}

uvec2 pack_halves(vec4 x) {
    return uvec2(packHalf2x16(x.xy), packHalf2x16(x.zw));
}
vec4 unpack_halves(uvec2 x) {
    return vec4(unpackHalf2x16(x.x), unpackHalf2x16(x.y));
}

/* How far a ray has met cloud (0: it has not), and where it ends (near.glsl), m: one word, for pixels read many. From a
 * hand's breadth, for which halves have all their digits, to farther than any horizon. */
const float way_unit_m = 1024.0, way_least_m = 0.125;
uint pack_ways(float distance_m, float end_m) {
    float met_m = distance_m > 0.0 ? max(distance_m, way_least_m) : 0.0;
    return packHalf2x16(min(vec2(met_m, end_m) / way_unit_m, vec2(most_half)));
}

/* An invocation's place in a list, in a dispatch over that; rows of such a dispatch. */
uint listed_index() {
    uint group = gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
    return group * uint(VELUM_GROUP * VELUM_GROUP) + gl_LocalInvocationIndex;
}
uint listed_rows(uint count) {
    const uint in_row = uint(VELUM_GROUP * VELUM_GROUP * VELUM_LIT_COLUMNS);
    return (count + in_row - 1u) / in_row;
}

/* Head of a ray more of a finer block, the `which`th of three (1..3): as the march leaves it distance m, transmittance,
 * share of the picture and number of its places, in the order of pack_place; as gather.comp leaves it light and
 * transmittance, then pack_ways. Its places follow. `finer`: the block's number among its like. `rays`: one for each
 * block. */
uint finer_head(uint rays, uint finer, uint which) {
    return rays * uint(VELUM_FINER_PLACES) + (finer * 3u + which - 1u) * uint(VELUM_FINER_PLACES + 1);
}

/* How many a ray has room for. */
uint ray_places(bool finer) {
    return finer ? uint(VELUM_FINER_PLACES) : uint(VELUM_LIT_PLACES);
}

/* Of a block's own ray, its first place: near.comp leaves the same there, once its places have been gathered, and in the
 * third, where history lags, how much more of light and transmittance it has found than that holds. */
uint own_head(uint ray, bool finer) {
    return ray * ray_places(finer);
}

#endif
