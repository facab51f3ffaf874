#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_air.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_air(i * CASE_AIR_IN, i * CASE_AIR_OUT);
    }
}
