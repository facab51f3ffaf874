#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_phase.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_phase(i * CASE_PHASE_IN, i * CASE_PHASE_OUT);
    }
}
