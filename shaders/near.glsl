/* What a ray tells of what is seen beside it: past surfaces of the host's, and of near cloud. */
#ifndef VELUM_NEAR_GLSL
#define VELUM_NEAR_GLSL

#include "view.glsl"
#include "shared/lit.h"

/* Whether calm tiles take turns: see calm_turns. Pipelines that resolve pixels in motion know it. */
layout(constant_id = 13) const uint turns_taken = VELUM_TURNS_ASKED;
bool takes_turns() {
    return turns_taken == VELUM_TURNS_ASKED ? calm_turns() != 0u : turns_taken == VELUM_TURNS_SOME;
}

/* Where a ray met no cloud, history is moved as if it had been so far away, or as far as rays go. */
const float nothing_least_m = 60000.0;
float nothing_m() {
    return max(nothing_least_m, view.march.z);
}

/* For history, where a ray met cloud; 0: it met none. */
float met_m(float distance_m) {
    return distance_m > 0.0 ? distance_m : nothing_m();
}

/* Where a ray ends whose host's surface is so far away; below 0: there is none. */
float end_of(float hit_m) {
    return hit_m >= 0.0 ? min(hit_m, nothing_m()) : nothing_m();
}

/* Cloud that lets no more through hides what the host has drawn behind it: its rays and history are as good for pixels
 * beside them, whatever that is. */
const float shut = 0.01;
/* Cloud so far away, what the host has drawn. */
bool hides(vec4 light, float distance_m, float end_m) {
    return light.a < shut && alike_ratio * distance_m < end_m;
}

/* Width of what can be seen in near cloud, m; how many rays lie within it where they begin to tell all of it, and where
 * they do. */
const float near_detail_m = 8.0, near_from = 1.5, near_to = 3.0;
/* Pixels that the eye's way moves it in a frame where history begins to say less than they, and where it does. */
const float near_moves_from = 0.5, near_moves_to = 2.0;
/* How far cloud so far away in a direction is better told by blocks' rays beside one than by what pixels have had, 0..1.
 * 0 m: there is none. The eye's way counts alone: the wind's is short beside it. */
float nearness(float distance_m, vec3 direction) {
    float pixel_m = distance_m * (view.up.w - view.right.w) / float(view.size.x);
    float ray_m = distance_m * (view.up.w - view.right.w) / float(view.march_size.x);
    vec3 way = view.offset.xyz - view.before_offset.xyz;
    float moved_m = length(way - dot(way, direction) * direction);
    bool none = distance_m <= 0.0 || view_flag(VELUM_VIEW_BLOCK_ORTHOGRAPHIC) || takes_turns();
    float near = smoothstep(near_from, near_to, near_detail_m / max(ray_m, 1.0e-6)) *
                 smoothstep(near_moves_from, near_moves_to, moved_m / max(pixel_m, 1.0e-6));
    return none ? 0.0 : near;
}

/* Of rays whose transmittances differ by so much, 0..1: how far they see one thing. Between others there is an edge, which
 * stays sharp. */
float sees_alike(float apart) {
    return 1.0 - smoothstep(0.1, 0.4, apart);
}

#endif
