#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_planet.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_planet(i * CASE_PLANET_IN, i * CASE_PLANET_OUT);
    }
}
