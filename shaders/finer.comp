#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* Where views move: lists a ray for each block, and three more for those around which the rays of the frame before have
 * found most that differs. How many may have them is bounded group by group: what a frame costs is too, and which blocks
 * they are does not go by the order in which they are listed. */
#include "due_list.glsl"
#include "near.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT_IN) uniform sampler2D march_light;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE_IN) uniform sampler2D march_distance;

shared float contrasts[VELUM_GROUP * VELUM_GROUP];

/* Cloud whose light is told from what shines through it. */
const float least_opacity = 0.05;

/* Of what is seen there. */
float contrast_around(ivec2 block) {
    ivec2 last = ivec2(view.march_size.xy) - 1;
    vec2 low = vec2(1.0e9);
    vec2 high = vec2(0.0);
    float bright = 1.0e-6;
    for (int k = 0; k < 9; ++k) {
        vec4 light = texelFetch(march_light, clamp(block + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last), 0);
        vec2 seen = vec2(dot(light.rgb, VELUM_LUMINANCE_OF), light.a);
        low = min(low, seen);
        high = max(high, seen);
        bright = max(bright, seen.x / max(1.0 - light.a, least_opacity));
    }
    return max((high.x - low.x) / bright, high.y - low.y);
}

void main() {
    ivec2 block = picture_block();
    uint lane = gl_LocalInvocationIndex;
    bool is_in = is_in_picture(block);
    float contrast = is_in ? contrast_around(block) : 0.0;
    /* Rays of blocks tell enough of near cloud, but for its edges. */
    float nearby = nearness(texelFetch(march_distance, block, 0).r, ray_of_pixel(ray_pixel(block)).direction);
    contrast *= 1.0 - nearby * sees_alike(contrast);
    contrasts[lane] = contrast;
    barrier();
    uint before_it = 0u;
    for (uint i = 0u; i < uint(VELUM_GROUP * VELUM_GROUP); ++i) {
        bool first = contrasts[i] > contrast || (contrasts[i] == contrast && i < lane);
        before_it += first ? 1u : 0u;
    }
    ivec2 here = clamp(ivec2(view.march_size.xy) - dealt_group() * VELUM_GROUP, ivec2(0), ivec2(VELUM_GROUP));
    uint most = uint(float(here.x * here.y) * view.before_jitter.z / 64.0 + 1.0e-3);
    bool finer = contrast > VELUM_FINER_CONTRAST && before_it < most;

    uint count = finer ? 4u : is_in ? 1u : 0u;
    uint room = due_room(count);
    uint number = finer ? atomicAdd(finer_count, 1u) : 0u;
    if (!is_in) {
        return;
    }
    uint index = ray_of(block);
    rays[index] = uvec2(view.march_size.w, finer ? number + 1u : 0u);
    for (uint which = 0u; which < count; ++which) {
        lit_list[room + which] = index * 4u + which;
    }
    if (finer) {
        lit_list[finer_first() + number] = index;
    }
}
