#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_hash.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_hash(i * CASE_HASH_IN, i * CASE_HASH_OUT);
    }
}
