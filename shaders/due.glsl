/* Rays of a frame. Where views stand, only some are due, and where they move, some blocks have more: listed, they fill
 * the lanes of the passes over them. */
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

ivec2 block_at(uint index) {
    return ivec2(index % view.march_size.x, index / view.march_size.x);
}
/* Of the list of rays in lit_list; of that of finer blocks, behind the places that there can be with them. */
uint due_first() {
    return block_count() * uint(VELUM_LIT_ROOM);
}
uint finer_first() {
    return due_first() - block_count() / 4u;
}

/* A block's ray, or a finer block's (see finer_pixel). */
struct due_ray {
    ivec2 block;
    uint which;
    uint place, places; /* its first in lit; how many it may have */
};

/* See VELUM_LIT_PLACES_LEAST. */
uint wanted_places() {
    return max(view.steps.y / 2u + 1u, uint(VELUM_LIT_PLACES_LEAST));
}

/* An invocation's ray, if there is one. */
bool due_ray_here(out due_ray ray) {
    bool finer = view_flag(VELUM_VIEW_BLOCK_FINER);
    ray.which = 0u;
    ray.places = min(wanted_places(), ray_places(finer));
    if (calm_turns() == 0u && !finer) {
        ray.block = picture_block();
        ray.place = own_head(ray_of(ray.block), finer);
        return is_in_picture(ray.block);
    }
    uint index = listed_index();
    bool is_due = index < due_count;
    uint listed = lit_list[due_first() + (is_due ? index : 0u)];
    ray.which = finer ? listed & 3u : 0u;
    listed = finer ? listed >> 2u : listed;
    ray.block = block_at(listed);
    ray.place = own_head(listed, finer);
    if (ray.which != 0u) {
        ray.place = finer_head(block_count(), rays[listed].y - 1u, ray.which) + 1u;
    }
    return is_due;
}

/* The ray of a place. */
ivec2 pixel_of_place(uint place) {
    if (!view_flag(VELUM_VIEW_BLOCK_FINER)) {
        return ray_pixel(block_at(place / uint(VELUM_LIT_PLACES)));
    }
    uint own = block_count() * uint(VELUM_FINER_PLACES);
    if (place < own) {
        return ray_pixel(block_at(place / uint(VELUM_FINER_PLACES)));
    }
    uint more = (place - own) / uint(VELUM_FINER_PLACES + 1);
    return finer_pixel(block_at(lit_list[finer_first() + more / 3u]), 1u + more % 3u);
}

#endif
