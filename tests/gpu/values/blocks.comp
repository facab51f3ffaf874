#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

#include "block_members.h"
#include "shared/arguments.h"

layout(set = 0, binding = 2, std140) uniform block_uniform {
#ifdef BLOCK_EYE
    velum_eye_block block;
#elif defined BLOCK_VIEW
    velum_view_block block;
#else
    velum_shadow_level_block block;
#endif
};

uint at = 0u;

void copy(uvec4 words) {
    for (uint i = 0u; i < 4u; ++i) {
        output_words[at++] = words[i];
    }
}

#define COPY_F(name) copy(floatBitsToUint(block.name));
#define COPY_U(name) copy(block.name);
#define COPY_SLOT_F(name) copy(floatBitsToUint(block.slots[slot].name));

void main() {
    if (gl_GlobalInvocationID.x == 0u) {
#ifdef BLOCK_EYE
        MEMBERS_EYE(COPY_F, COPY_U)
        for (int level = 0; level < VELUM_SHADE_LEVELS; ++level) {
            copy(floatBitsToUint(block.shades[level]));
        }
        for (int slot = 0; slot < VELUM_SLOT_COUNT; ++slot) {
            MEMBERS_SLOT(COPY_SLOT_F)
        }
        for (int part = 0; part < VELUM_FRINGE_PARTS; ++part) {
            copy(floatBitsToUint(block.fringes[part]));
        }
#elif defined BLOCK_VIEW
        MEMBERS_VIEW(COPY_F, COPY_U)
        for (int level = 0; level < VELUM_SHADE_LEVELS; ++level) {
            copy(floatBitsToUint(block.drifts[level]));
        }
#else
        MEMBERS_SHADOW_LEVEL(COPY_F, COPY_U)
#endif
    }
}
