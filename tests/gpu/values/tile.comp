#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "case_tile.h"

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        case_tile(i * CASE_TILE_IN, i * CASE_TILE_OUT);
    }
}
