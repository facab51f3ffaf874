#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

layout(set = 0, binding = 3) uniform sampler3D texture_0;

const uint STEPS = 64u;

/* Marches as the cloud march does: neighbouring invocations are neighbouring rays, x and y in eighths of a texel.
 * Word 0: step in 1/1000 of the period. */
void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i < invocations) {
        float step_length = float(input_words[0]) * 0.001;
        vec3 place = vec3(float(i & 255u), float(i >> 8u), 0.0) / 1024.0;
        vec3 direction = normalize(vec3(0.3 + 0.001 * float(i & 7u), 0.2, 1.0)) * step_length;
        float sum = 0.0;
        for (uint n = 0u; n < STEPS; ++n) {
            sum += textureLod(texture_0, place, 0.0).r;
            place += direction;
        }
        output_words[i] = floatBitsToUint(sum);
    }
}
