#version 460
#extension GL_GOOGLE_include_directive : require
/* The march as it is, but for its counters: each has the number of one kind of fetch added to it. What a ray itself asks
 * for counts, not what idle lanes beside it do. */
uint fetched_shape = 0u;
uint fetched_detail = 0u;
uint fetched_other = 0u; /* tiles and tables: four channels */

vec4 counted_lod(sampler2D from, vec2 at, float lod) {
    ++fetched_other;
    return textureLod(from, at, lod);
}
vec4 counted_lod(sampler2DArray from, vec3 at, float lod) {
    ++fetched_other;
    return textureLod(from, at, lod);
}
/* The volumes are told apart by their sizes. */
vec4 counted_lod(sampler3D from, vec3 at, float lod) {
    ivec3 side = textureSize(from, 0);
    bool is_shape = side == ivec3(128);
    bool is_detail = side == ivec3(64);
    fetched_shape += is_shape ? 1u : 0u;
    fetched_detail += is_detail ? 1u : 0u;
    fetched_other += is_shape || is_detail ? 0u : 1u;
    return textureLod(from, at, lod);
}

#define textureLod counted_lod
#define main march_main
#include "march_body.glsl"
#undef main

void main() {
    march_main();
    uint shape = subgroupAdd(fetched_shape);
    uint detail = subgroupAdd(fetched_detail);
    uint other = subgroupAdd(fetched_other);
    if (subgroupElect()) {
        atomicAdd(counters[0], shape);
        atomicAdd(counters[1], detail);
        atomicAdd(counters[2], other);
    }
}
