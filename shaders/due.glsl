/* Rays of a frame. Where views stand, only some are due: listed, they fill the lanes of the passes over them. */
#ifndef VELUM_DUE_GLSL
#define VELUM_DUE_GLSL

#include "lit.glsl"
#define VELUM_NOTHING (lit_layers - 1u)
#include "view.glsl"

/* An invocation's block, where all of the picture's have one; past its edges there is none. Eight neighbours in a row of
 * invocations stand 4 x 2 in the picture: they go the same way more often. */
ivec2 picture_block() {
    uint lane = gl_LocalInvocationIndex & 7u;
    uint row = gl_LocalInvocationIndex >> 3u;
    return dealt_group() * VELUM_GROUP + ivec2((row & 1u) * 4u + (lane & 3u), (row >> 1u) * 2u + (lane >> 2u));
}
bool is_in_picture(ivec2 block) {
    return block.x < int(view.march_size.x) && block.y < int(view.march_size.y);
}

/* Of the list of rays in lit_list. */
uint due_first() {
    return view.march_size.x * view.march_size.y * uint(VELUM_LIT_PLACES);
}

/* The block whose ray is an invocation's, if there is one. */
bool due_block(out ivec2 block) {
    if (calm_turns() == 0u) {
        block = picture_block();
        return is_in_picture(block);
    }
    uint index = listed_index();
    bool is_due = index < due_count;
    uint ray = lit_list[due_first() + (is_due ? index : 0u)];
    block = ivec2(ray % view.march_size.x, ray / view.march_size.x);
    return is_due;
}

#endif
