#version 460
#extension GL_GOOGLE_include_directive : require
/* The slice's paths into the means of their pixels, in order; then every pixel as it stands to the host's images. */
#include "engine.glsl"
#include "shared/reference.h"
layout(set = 1, binding = VELUM_BIND_REFERENCE_ERROR, std430) readonly buffer slice_buffer {
    uint slice[VELUM_SLICE_WORDS];
};
#define VELUM_NOTHING slice[VELUM_SLICE_NOTHING]
#include "view.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_REFERENCE_PATHS, std430) readonly buffer paths_buffer {
    velum_reference_path paths[];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_PIXELS, std430) buffer pixels_buffer {
    velum_reference_pixel pixels[];
};
#ifdef VELUM_LAYERED
#define OUT_IMAGE image2DArray
#define OUT_PIXEL(p) ivec3(p, int(view.frame.z))
#else
#define OUT_IMAGE image2D
#define OUT_PIXEL(p) (p)
#endif
layout(set = 1, binding = VELUM_BIND_OUT_LUMINANCE) uniform writeonly OUT_IMAGE luminance_out;
layout(set = 1, binding = VELUM_BIND_OUT_TRANSMITTANCE) uniform writeonly OUT_IMAGE transmittance_out;
layout(set = 1, binding = VELUM_BIND_OUT_DISTANCE) uniform writeonly OUT_IMAGE distance_out;
layout(set = 1, binding = VELUM_BIND_REFERENCE_OUT_VARIANCE) uniform writeonly OUT_IMAGE variance_out;

void main() {
    ivec2 pixel = dealt_group() * VELUM_GROUP + ivec2(gl_LocalInvocationID.xy);
    if (pixel.x >= int(view.size.x) || pixel.y >= int(view.size.y)) {
        return;
    }
    uint number = uint(pixel.y) * view.size.x + uint(pixel.x);
    velum_reference_pixel sum = pixels[number];
    if (view_flag(VELUM_VIEW_BLOCK_CUT)) {
        sum.light = sum.through = sum.distance = vec4(0.0);
    }
    uint turn = velum_reference_turn_of(uint(pixel.x), uint(pixel.y), view.steps.y, view.size.x);
    uint all = view.march_size.y * view.march_size.z;
    bool complete = slice[VELUM_SLICE_DONE] == all && slice[VELUM_SLICE_TAKEN] != all;
    bool own = complete && turn >= view.march_size.x && turn < view.march_size.x + view.march_size.y;
    uint first = (turn - view.march_size.x) * view.march_size.z;
    uint count = own ? view.march_size.z : 0u;
    for (uint i = 0u; i < count; ++i) {
        velum_reference_path path = paths[first + i];
        float n = sum.light.w + 1.0;
        vec3 off = path.light.rgb - sum.light.rgb;
        vec3 light = sum.light.rgb + off / n;
        sum.through.w += dot(off, VELUM_LUMINANCE_OF) * dot(path.light.rgb - light, VELUM_LUMINANCE_OF);
        sum.light = vec4(light, n);
        sum.through.rgb += (path.through.rgb - sum.through.rgb) / n;
        sum.distance.x += (path.light.w - sum.distance.x) / n;
        sum.distance.y += (path.through.w - sum.distance.y) / n;
    }
    pixels[number] = sum;

    view_ray ray = view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);
    bool solid = host_distance(pixel, ray) >= 0.0 || ground_distance(ray.origin, ray.direction) >= 0.0;
    vec3 light = max(sum.light.rgb, vec3(0.0));
    /* Before its first path a pixel lets everything through. */
    vec3 transmittance = sum.light.w > 0.0 ? clamp(sum.through.rgb, 0.0, 1.0) : vec3(1.0);
    if (!solid && view_flag(VELUM_VIEW_BLOCK_SUN_DISC)) {
        /* As resolve.comp. */
        float radius = max(eye.sun_lx.w, 1e-4);
        float angle = length(ray.direction - eye.sun.xyz);
        float edge = clamp((radius - angle) / (0.02 * radius) + 0.5, 0.0, 1.0);
        light += transmittance * edge * eye.sun_lx.rgb / (PI * radius * radius);
    }
    light *= view.scale.x;
    float n = sum.light.w;
    float variance = n > 1.0 ? max(sum.through.w, 0.0) / (n * (n - 1.0)) : 0.0;
    float mean = dot(transmittance, VELUM_LUMINANCE_OF);
    float distance_m = sum.distance.y > 1e-4 ? max(sum.distance.x / sum.distance.y, 0.0) : 0.0;
    ivec2 out_pixel = pixel + ivec2(view.size.zw);
    imageStore(luminance_out, OUT_PIXEL(out_pixel), vec4(min(light, vec3(view.depth.w)), mean));
    imageStore(transmittance_out, OUT_PIXEL(out_pixel), vec4(transmittance, mean));
    imageStore(distance_out, OUT_PIXEL(out_pixel), vec4(distance_m));
    imageStore(variance_out, OUT_PIXEL(out_pixel), vec4(min(variance, 3e38)));
}
