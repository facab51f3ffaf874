#version 460
#extension GL_GOOGLE_include_directive : require
/* Where views move: rays of blocks as resolve.comp takes them. Those to cloud so near that it has no detail between them
 * are taken together with those beside them, for they differ by where they step, and such cloud passes before its pixels
 * have had rays from all places. A finer block's other rays stay as they are: near cloud has none. And where each
 * ends, and how far history lags behind it. */
#include "due.glsl"
#include "moved.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT_IN) uniform sampler2D march_light;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE_IN) uniform sampler2D march_distance;

/* Distances of one surface of the host's, so many rays apart. */
const float one_ratio = 1.3;
/* Four rays side by side step from all places: 1, 2, 2, 2, 1 of 8 in a row, and so of rows. */
const int reach = 2;
const float whole = 64.0;
float share_of(ivec2 beside) {
    return (abs(beside.x) < reach ? 2.0 : 1.0) * (abs(beside.y) < reach ? 2.0 : 1.0) / whole;
}

/* What a ray sees more than history holds there; nothing where that holds another thing, or nothing. */
vec4 lag_of(view_ray ray, vec4 light, float distance_m, float end_m) {
    float there_m = has_depth ? min(met_m(distance_m), end_m) : met_m(distance_m);
    bool one;
    history_place place = history_of(ray, there_m, there_m, one);
    light_beside beside;
    vec4 lag = light - history_light(place.pixel, vec2(view.size.xy), beside);
    bool ends_alike = !place.ended.x || (place.ended.y && end_m < nothing_m());
    bool tells = place.known && place.samples >= has_ray && ends_alike && alike(place.held_m, there_m);
    return tells ? sees_alike(abs(lag.a)) * clamp(lag, -most_half, most_half) : vec4(0.0);
}

void main() {
    ivec2 block = picture_block();
    if (!is_in_picture(block)) {
        return;
    }
    ivec2 last = ivec2(view.march_size.xy) - 1;
    vec4 own = texelFetch(march_light, block, 0);
    float own_m = texelFetch(march_distance, block, 0).r;
    view_ray ray = ray_of_pixel(ray_pixel(block));
    float own_near = nearness(own_m, ray.direction);
    float end_m = has_depth ? end_of(host_distance(ray_pixel(block), ray)) : 0.0;
    /* What goes from ray to ray is the same both ways, but at the picture's border: light stays what it is on the mean. */
    vec4 light = own;
    float product = (1.0 - own.a) * own_m;
    float own_product = product;
    for (int k = 0; k < 25; ++k) {
        ivec2 beside = ivec2(k % 5, k / 5) - reach;
        ivec2 there = clamp(block + beside, ivec2(0), last);
        vec4 other = texelFetch(march_light, there, 0);
        float other_m = texelFetch(march_distance, there, 0).r;
        float near = max(own_near, nearness(other_m, ray.direction));
        float share = share_of(beside) * near * sees_alike(abs(other.a - own.a));
        if (has_depth) {
            float there_m = end_of(host_distance(ray_pixel(there), ray));
            bool one = end_m < one_ratio * there_m && there_m < one_ratio * end_m;
            bool fit = one || (hides(own, own_m, there_m) && hides(other, other_m, end_m));
            share = fit ? share : 0.0;
        }
        light += share * (other - own);
        product += share * ((1.0 - other.a) * other_m - own_product);
    }
    uint head = own_head(ray_of(block), view_flag(VELUM_VIEW_BLOCK_FINER));
    lit[head] = pack_halves(light);
    lit[head + 1u].x = pack_ways(light.a < 1.0 ? product / (1.0 - light.a) : 0.0, end_m);
    if (history_lags()) {
        lit[head + 2u] = pack_halves(lag_of(ray, own, own_m, end_m));
    }
}
