/* Numbers, directions and rays of the reference's paths. */
#ifndef VELUM_REFERENCE_PATH_GLSL
#define VELUM_REFERENCE_PATH_GLSL

#include "shared/hash.h"

uint key;
uint drawn;
float draw() {
    return velum_hash_unit(velum_hash_2(key, drawn++));
}
#define VELUM_PHASE_DRAW() draw()

#include "reference_medium.glsl"

float mean(vec3 x) {
    return (x.r + x.g + x.b) * (1.0 / 3.0);
}
float greatest(vec3 x) {
    return max(abs(x.r), max(abs(x.g), abs(x.b)));
}

/* Unit vector turned from d by an angle of 1 - cos = turn, about by `round` 0..1. Frame: Duff et al. 2017. */
vec3 turned(vec3 d, float turn, float round) {
    float s = d.z >= 0.0 ? 1.0 : -1.0;
    float a = -1.0 / (s + d.z);
    float b = d.x * d.y * a;
    vec3 x = vec3(1.0 + s * d.x * d.x * a, s * b, -s * d.x);
    vec3 y = vec3(b, s + d.y * d.y * a, -d.y);
    float sine = sqrt(max(turn * (2.0 - turn), 0.0));
    float angle = 2.0 * PI * round;
    return normalize(d * (1.0 - turn) + (x * cos(angle) + y * sin(angle)) * sine);
}

/* 1 - cos between unit vectors, with all digits. */
float turn_between(vec3 a, vec3 b) {
    vec3 c = a - b;
    return min(0.5 * dot(c, c), 2.0);
}

/* Top of all that there is, m. */
float top_m() {
    return max(velum_slots != 0u ? eye.span.y : 0.0, velum_has_air ? VELUM_AIR_TOP_M : 0.0) + 5.0;
}

/* Where the pixel's ray ends: on the ground, or where nothing is any more. */
float view_length(vec3 r, vec3 d, out bool grounded) {
    float ground = ground_distance(r, d);
    grounded = ground >= 0.0;
    velum_span shell = velum_sphere_span(eye_geometry(), r.x, r.y, r.z, d.x, d.y, d.z, top_m() * VELUM_SCALE_Z);
    float leave = shell.enter_m > shell.leave_m ? 0.0 : max(shell.leave_m, 0.0);
    return grounded ? ground : leave;
}

/* Of other rays: those that rise end above everything by themselves. */
float ray_length(vec3 r, vec3 d, vec3 normal, bool from_ground, out bool grounded) {
    float ground = -1.0;
    for (int once = dot(normal, d) < 0.0 && !from_ground ? 0 : 1; once < 1; ++once) {
        ground = ground_distance(r, d);
    }
    grounded = ground >= 0.0;
    return grounded ? ground : 2.0e7;
}

bool is_bad(vec4 v) {
    return any(isnan(v)) || any(isinf(v));
}

#endif
