/* Set 0: what the engine and the eye give to every pass. */
#ifndef VELUM_ENGINE_GLSL
#define VELUM_ENGINE_GLSL

#include "shared/air.h"
#include "shared/arguments.h"
#include "shared/planet.h"
#include "shared/tile_address.h"

layout(set = 0, binding = VELUM_BIND_EYE, std140) uniform eye_uniform {
    velum_eye_block eye;
};
layout(set = 0, binding = VELUM_BIND_TABLE, std430) readonly buffer table_buffer {
    uint table[];
};
layout(set = 0, binding = VELUM_BIND_SPANS, std430) readonly buffer span_buffer {
    uint spans[];
};
layout(set = 0, binding = VELUM_BIND_TILES_A) uniform sampler2DArray tiles_a;
layout(set = 0, binding = VELUM_BIND_TILES_B) uniform sampler2DArray tiles_b;
layout(set = 0, binding = VELUM_BIND_SHAPE) uniform sampler3D shape_noise;
layout(set = 0, binding = VELUM_BIND_DETAIL) uniform sampler3D detail_noise;
layout(set = 0, binding = VELUM_BIND_AIR) uniform sampler2D air_table;
layout(set = 0, binding = VELUM_BIND_SKY) uniform sampler2D sky_table;
layout(set = 0, binding = VELUM_BIND_GLOW) uniform sampler2D glow_table;

const float PI = 3.14159265358979;

velum_eye_geometry eye_geometry() {
    return velum_eye_geometry(eye.scaled.x, eye.scaled.y, eye.scaled.z, eye.scaled.w, eye.position.w, eye.position.x,
                              eye.position.y, eye.position.z);
}

velum_place place_of(vec3 r) {
    return velum_place_at(eye_geometry(), r.x, r.y, r.z);
}

/* The ground is the ellipsoid. Where the sea lies lower, so does an eye on it: then it is just under the eye. */
float ground_height_m() {
    return min(eye.up.w * 1.01 - 2.0, 0.0);
}

/* Distance along a ray from offset o to the ground, or a negative number. */
float ground_distance(vec3 o, vec3 d) {
    velum_span span = velum_sphere_span(eye_geometry(), o.x, o.y, o.z, d.x, d.y, d.z, ground_height_m());
    if (span.enter_m > span.leave_m || span.leave_m < 0.0) {
        return -1.0;
    }
    return span.enter_m > 0.0 ? span.enter_m : 0.0;
}

#endif
