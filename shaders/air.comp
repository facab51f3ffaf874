#version 460
#extension GL_GOOGLE_include_directive : require
/* Transmittance of clean air from a height, along a cosine, to space. Once. */
#include "air.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 0, binding = VELUM_BIND_AIR_OUT, rgba16f) uniform writeonly image2D air_out;

const int steps = 64;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (texel.x >= VELUM_AIR_W || texel.y >= VELUM_AIR_H) {
        return;
    }
    velum_air_ray ray =
        velum_air_ray_of(float(texel.x) / float(VELUM_AIR_W - 1), float(texel.y) / float(VELUM_AIR_H - 1));
    float r = VELUM_WGS84_A_M + ray.height_m;
    float top = VELUM_WGS84_A_M + VELUM_AIR_TOP_M;
    float d = -r * ray.mu + sqrt(max(r * r * (ray.mu * ray.mu - 1.0) + top * top, 0.0));
    vec3 depth = vec3(0.0);
    float before = 0.0;
    for (int i = 0; i < steps; ++i) {
        float x = float(i + 1) / float(steps);
        float t1 = d * x * x;
        float t = 0.5 * (before + t1);
        float over = (ray.height_m * (2.0 * VELUM_WGS84_A_M + ray.height_m) + t * (t + 2.0 * r * ray.mu));
        float height_m = over / (sqrt(VELUM_WGS84_A_M * VELUM_WGS84_A_M + over) + VELUM_WGS84_A_M);
        depth += air_extinction_1_m(max(height_m, 0.0)) * (t1 - before);
        before = t1;
    }
    imageStore(air_out, texel, vec4(exp(-depth), 1.0));
}
