#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_density.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_density(i * CASE_DENSITY_IN, i * CASE_DENSITY_OUT);
    }
}
