#version 460
#extension GL_GOOGLE_include_directive : require
/* Each ray: the light of its places, behind the air before them. */
#include "air.glsl"
#include "lit.glsl"
#define VELUM_NOTHING (lit_layers - 1u)
#include "view.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT, rgba16f) uniform writeonly image2D light_out;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE, r32f) uniform writeonly image2D distance_out;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT_IN) uniform sampler2D march_light;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE_IN) uniform sampler2D march_distance;

void main() {
    ivec2 block = dealt_group() * VELUM_GROUP + ivec2(gl_LocalInvocationID.xy);
    if (block.x >= int(view.march_size.x) || block.y >= int(view.march_size.y) || !block_has_ray(block)) {
        return;
    }
    if (calm_turns() != 0u && block.x % VELUM_TILE_RAYS_W == 0 && block.y % VELUM_TILE_RAYS_H == 0) {
        uint tile = ray_tile_of(block);
        uint restless = min(rays[tile].x, VELUM_RESTLESS_MOST);
        rays[tile].x = restless - restless / VELUM_RESTLESS_FRAMES;
    }
    /* As march.comp leaves it: number of places, their share of the picture, -, transmittance. */
    vec4 found = texelFetch(march_light, block, 0);
    float distance_m = texelFetch(march_distance, block, 0).r;
    uint first = lit_first(block, view.march_size.x);
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < uint(found.x); ++i) {
        sum += lit[first + i];
    }
    bool any = found.y > 0.0;
    distance_m += any ? sum.a / found.y : 0.0;
    view_ray ray = ray_of_pixel(ray_pixel(block));
    vec3 light = air_before_cloud(ray.origin, ray.direction, sum.rgb, found.a, distance_m, any);
    imageStore(light_out, block, vec4(min(light / VELUM_LUMINANCE_UNIT, vec3(60000.0)), found.a));
    imageStore(distance_out, block, vec4(distance_m));
}
