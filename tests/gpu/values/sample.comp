#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_sample.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_sample(i * CASE_SAMPLE_IN, i * CASE_SAMPLE_OUT);
    }
}
