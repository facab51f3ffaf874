#version 460
#extension GL_GOOGLE_include_directive : require
#include "words.glsl"

/* Rays through a texture that the march uses, and nothing else: as many filtered samples as the device can give.
 * Neighbours in a group of 64 are neighbouring rays of 8 x 8, 4 x 2 in a row of invocations, as in march.comp. */
#ifdef PAGES
layout(set = 0, binding = 3) uniform sampler2DArray pages;
#else
layout(set = 0, binding = 3) uniform sampler3D volume;
#endif

/* Words of the input. */
const uint ACROSS = 0u; /* rays in a row, a multiple of 8 */
const uint ROUNDS = 1u; /* of 4 samples each */
const uint STEP = 2u;   /* along a ray, a float: of the period; of pages, of a page */
const uint ANGLE = 3u;  /* between rays, a float */

void main() {
    uint i = gl_GlobalInvocationID.x;
    uint lane = i & 7u;
    uint part = (i >> 3u) & 7u;
    uint group = i >> 6u;
    uint groups = input_words[ACROSS] / 8u;
    uvec2 at = uvec2(group % groups, group / groups) * 8u +
               uvec2((part & 1u) * 4u + (lane & 3u), (part >> 1u) * 2u + (lane >> 2u));
    at.y %= 96u; /* the same picture again and again */
    vec2 turn = (vec2(at) - 0.5 * float(input_words[ACROSS])) * uintBitsToFloat(input_words[ANGLE]);
    /* No axis of the texture lies along the rays. */
    vec3 direction = normalize(vec3(0.612, 0.436, 0.660) + turn.x * vec3(0.733, 0.0, -0.680) + vec3(0.0, turn.y, 0.0));
    vec3 stride = direction * uintBitsToFloat(input_words[STEP]);
    vec3 place = vec3(0.31, 0.72, 0.13);
    vec4 sum = vec4(0.0);
    uint rounds = input_words[ROUNDS];
    for (uint n = 0u; n < rounds; ++n) {
#ifdef PAGES
        /* Pages hold several kilometres: a ray stays in one for many steps. */
        vec3 page = vec3(fract(place.xy), float((n >> 3u) % 64u));
        sum += textureLod(pages, page, 0.0);
        sum += textureLod(pages, page + vec3(stride.xy, 0.0), 0.0);
        sum += textureLod(pages, page + vec3(2.0 * stride.xy, 0.0), 0.0);
        sum += textureLod(pages, page + vec3(3.0 * stride.xy, 0.0), 0.0);
#else
        sum.x += textureLod(volume, place, 0.0).r;
        sum.y += textureLod(volume, place + stride, 0.0).r;
        sum.z += textureLod(volume, place + 2.0 * stride, 0.0).r;
        sum.w += textureLod(volume, place + 3.0 * stride, 0.0).r;
#endif
        place += 4.0 * stride;
    }
    output_words[i] = floatBitsToUint(dot(sum, vec4(1.0)));
}
