/* What a view keeps of each pixel from frame to frame. */
#ifndef VELUM_HISTORY_GLSL
#define VELUM_HISTORY_GLSL

#include "view.glsl"

layout(set = 1, binding = VELUM_BIND_HISTORY_IN) uniform sampler2D history_in;
layout(set = 1, binding = VELUM_BIND_HISTORY_DATA_IN) uniform sampler2D history_data_in;
layout(set = 1, binding = VELUM_BIND_HISTORY_OUT, rgba16f) uniform writeonly image2D history_out;
layout(set = 1, binding = VELUM_BIND_HISTORY_DATA_OUT, rg16f) uniform writeonly image2D history_data_out;

const float distance_unit_m = 100.0;
/* So that samples of what has none can be negative. */
const float least_samples = 1e-3;

/* A pixel's rays step from so many places: until they have, a view that stands shows its pixels with those beside them. */
const float places_of_steps = 4.0;

struct cloud_pixel {
    vec4 light; /* luminance / VELUM_LUMINANCE_UNIT, transmittance */
    float distance_m; /* 0: none */
    float samples;
    vec4 change; /* of the light, by this frame's ray; great where history was not known; 0: no ray */
};

float distance_in(float product, float opacity) {
    return opacity > 0.0 ? product / opacity : 0.0;
}

/* History where it stands. A filter's weights have 8 bits: it would bleed into its neighbours frame by frame. */
cloud_pixel standing_at(ivec2 pixel, out bool ended) {
    vec2 data = texelFetch(history_data_in, pixel, 0).rg;
    cloud_pixel old;
    old.light = texelFetch(history_in, pixel, 0);
    old.distance_m = distance_in(data.x, 1.0 - old.light.a) * distance_unit_m;
    old.samples = abs(data.y);
    old.change = vec4(0.0);
    ended = data.y < 0.0;
    return old;
}

/* What has had rays from all places keeps that, however little it counts for. */
float stepped(cloud_pixel old, float samples) {
    return max(samples, min(old.samples, places_of_steps));
}

/* With a ray of its own more, which gets at least such a share. */
cloud_pixel with_ray(cloud_pixel old, float count, cloud_pixel fresh, float least) {
    float n = count < 1.0 ? 1.0 : count + 1.0;
    float share = max(1.0 / n, least);
    float opacity = old.distance_m > 0.0 ? (1.0 - old.light.a) * (1.0 - share) : 0.0;
    float added = (1.0 - fresh.light.a) * share;
    cloud_pixel result;
    result.light = mix(old.light, fresh.light, share);
    result.distance_m = distance_in(opacity * old.distance_m + added * fresh.distance_m, opacity + added);
    result.samples = min(n, 1024.0);
    result.change = fresh.light - old.light;
    return result;
}

/* x >= 0 in 16 bits: of the two numbers about it the greater where the lower bits of `chances` carry. What 16 bits hold
 * stays as it is. */
const uint half_below = 0x1fffu;
vec4 as_half(vec4 x, uvec4 chances) {
    const float least = 6.103515625e-5, unit = 5.9604644775390625e-8; /* normal; denormal */
    chances &= half_below;
    vec4 normal = uintBitsToFloat((floatBitsToUint(x) + chances) & ~half_below);
    vec4 small = floor(x / unit + vec4(chances) / float(half_below + 1u)) * unit;
    return min(mix(normal, small, lessThan(x, vec4(least))), vec4(65504.0));
}

/* `chance`: of pixel and frame. In motion the nearer of two numbers more often: cut off, as some devices do, each frame
 * that hands light on would take 0.05 % of it. At rest the nearer. `ended`: by the host's depth. */
void history_store(ivec2 pixel, cloud_pixel cloud, bool ended, bool moves, uint chance) {
    uvec4 chances = moves ? uvec4(chance, chance >> 6u, chance >> 12u, chance >> 18u) : uvec4(half_below / 2u);
    vec4 held = as_half(cloud.light, chances);
    /* Distance is got back by opacity as it is held. */
    vec4 product = as_half(vec4((1.0 - held.a) * cloud.distance_m / distance_unit_m), chances);
    float samples = ended ? -max(cloud.samples, least_samples) : cloud.samples;
    imageStore(history_out, pixel, held);
    imageStore(history_data_out, pixel, vec4(product.x, samples, 0.0, 0.0));
}

/* Where calm tiles take turns: a ray has changed its pixel so much, of what is seen there (`light`, cd/m2) or of what
 * shines through: its tile is the more restless. */
void history_unrest(ivec2 block, vec4 change, vec3 light) {
    if (change != vec4(0.0)) {
        float part = dot(abs(change.rgb), VELUM_LUMINANCE_OF) / max(dot(light, VELUM_LUMINANCE_OF), 1e-6);
        part = min(max(part, abs(change.a)), 1.0);
        atomicAdd(rays[ray_tile_of(block)].x, uint(part * float(VELUM_RESTLESS_UNIT)));
    }
}

#endif
