/* Segments of a ray through layers of cloud. */
#ifndef VELUM_RAY_SEGMENTS_GLSL
#define VELUM_RAY_SEGMENTS_GLSL

#include "segments.glsl"
#include "due.glsl"
#include "fringe.glsl"

/* Places of one ray's light, as they are found: see lit.glsl. */
struct ray_places {
    uint count;
    vec4 newest; /* not yet handed on */
    float pick;  /* 0..1 */
};

#ifdef VELUM_FRINGED
const uint segment_shells_most = 24u;
#else
const uint segment_shells_most = uint(VELUM_SLOT_COUNT);
#endif
/* Cloud is not dealt evenly: a segment may take so many times its share of a ray's steps. */
const float segment_steps = 2.0;
const uint segment_lanes = uint(VELUM_GROUP * VELUM_GROUP);
/* Of a ray, for each layer: long steps from the eye to where it enters and leaves its shell, twice. */
shared vec4 segment_shells[segment_shells_most * segment_lanes / 2u];
shared float segment_from_m[segment_lanes];
shared uint segment_opaque[segment_lanes]; /* the nearest through which nothing comes */
shared vec4 segment_found[segment_lanes];  /* transmittance; opacity; its distance times it; number of places */
shared vec4 segment_places[segment_lanes * uint(VELUM_LIT_PLACES)];

/* Long steps of march.comp from the eye to a distance, and the inverse. */
float steps_to(float distance_m) {
    float growth = max(view.march.y, 1.0e-4);
    float wide = distance_m * growth / view.march.x;
    return (wide < 1.0 ? wide : 1.0 + log(wide)) / growth;
}
float distance_of_steps(float steps) {
    float growth = max(view.march.y, 1.0e-4);
    float wide = steps * growth;
    return (wide < 1.0 ? wide : exp(wide - 1.0)) * view.march.x / growth;
}

/* What a ray meets of the shell of a layer, in steps. */
vec4 shell_steps(view_ray ray, vec2 bounds_m, float from_m, float to_m) {
    velum_span high = velum_sphere_span(eye_geometry(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                        ray.direction.y, ray.direction.z, bounds_m.y * VELUM_SCALE_Z + 1.0);
    velum_span low = velum_sphere_span(eye_geometry(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                       ray.direction.y, ray.direction.z, max(bounds_m.x - 1.0, -1000.0));
    if (high.enter_m > high.leave_m) {
        return vec4(0.0);
    }
    float enter = clamp(high.enter_m, from_m, to_m);
    float leave = clamp(high.leave_m, from_m, to_m);
    bool hollow = low.enter_m <= low.leave_m;
    float down = hollow ? clamp(low.enter_m, enter, leave) : leave;
    float up = hollow ? clamp(low.leave_m, down, leave) : leave;
    return vec4(steps_to(enter), steps_to(down), steps_to(up), steps_to(leave));
}

/* The segment, of the part of a ray that can meet cloud: each has as many long steps through layers. All of a group ask. */
vec2 segment_of(view_ray ray, float from_m, float to_m) {
    uint count = segment_count();
    uint here = segment_here();
    uint first = gl_LocalInvocationIndex / count * segment_shells_most;
    uint layers = FRINGED(eye.table.z | eye.table.w, eye.table.z);
    for (uint i = here; i < segment_shells_most; i += count) {
        if ((layers >> i & 1u) != 0u) {
            vec2 bounds_m = FRINGED(part_bounds(int(i)), eye.slots[i].bounds).xy;
            segment_shells[first + i] = shell_steps(ray, bounds_m, from_m, to_m);
        }
    }
    if (here == 0u) {
        segment_opaque[gl_LocalInvocationIndex] = count;
    }
    barrier();
    float low = steps_to(from_m);
    float high = steps_to(to_m);
    float total = 0.0;
    for (uint rest = layers; rest != 0u; rest &= rest - 1u) {
        vec4 shell = segment_shells[first + uint(findLSB(rest))];
        total += shell.y - shell.x + shell.w - shell.z;
    }
    float wanted = total * float(here) / float(count);
    for (int i = 0; i < 12; ++i) {
        float middle = 0.5 * (low + high);
        float before = 0.0;
        for (uint rest = layers; rest != 0u; rest &= rest - 1u) {
            vec4 shell = segment_shells[first + uint(findLSB(rest))];
            before += clamp(middle, shell.x, shell.y) - shell.x + clamp(middle, shell.z, shell.w) - shell.z;
        }
        low = before < wanted ? middle : low;
        high = before < wanted ? high : middle;
    }
    segment_from_m[gl_LocalInvocationIndex] = here == 0u ? from_m : clamp(distance_of_steps(high), from_m, to_m);
    barrier();
    return vec2(segment_from_m[gl_LocalInvocationIndex],
                here == count - 1u ? to_m : segment_from_m[gl_LocalInvocationIndex + 1u]);
}

/* Segments draw places each for itself, and all of a ray's together by its own number: none of these tells of another. */
float segment_pick(float offset) {
    return fract(23.0 * offset + 0.618 * float(segment_here()));
}

/* Of the ray's segments the nearest that has been found opaque: this one, if it is. */
bool segment_is_hidden(bool opaque) {
    uint first = gl_LocalInvocationIndex - segment_here();
    return atomicMin(segment_opaque[first], opaque ? segment_here() : segment_count()) < segment_here();
}

#endif
