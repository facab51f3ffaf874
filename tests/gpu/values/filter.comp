#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

layout(set = 0, binding = 3) uniform sampler3D texture_0;
layout(set = 0, binding = 4) uniform sampler3D texture_1;

/* Places x, y, z in; what the two textures' filters give out. */
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        vec3 place = uintBitsToFloat(uvec3(input_words[3u * i], input_words[3u * i + 1u], input_words[3u * i + 2u]));
        output_words[2u * i] = floatBitsToUint(textureLod(texture_0, place, 0.0).r);
        output_words[2u * i + 1u] = floatBitsToUint(textureLod(texture_1, place, 0.0).r);
    }
}
