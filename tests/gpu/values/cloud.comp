#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

layout(set = 0, binding = 3) uniform sampler3D texture_0;
layout(set = 0, binding = 4) uniform sampler3D texture_1;

float velum_shape_at(float x, float y, float z) {
    return textureLod(texture_0, vec3(x, y, z), 0.0).r;
}
float velum_detail_at(float x, float y, float z) {
    return textureLod(texture_1, vec3(x, y, z), 0.0).r;
}

#include "case_cloud.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_cloud(i * CASE_CLOUD_IN, i * CASE_CLOUD_OUT);
    }
}
