/* Set 1: what a view gives to its passes. */
#ifndef VELUM_VIEW_GLSL
#define VELUM_VIEW_GLSL

#include "shared/arguments.h"

layout(set = 1, binding = VELUM_BIND_VIEW, std140) uniform view_uniform {
    velum_view_block view;
};
layout(set = 1, binding = VELUM_BIND_DEPTH) uniform sampler2D depth_image;

/* Software devices give each thread one run of work groups: rows of groups are dealt like cards, so that sky and ground
 * fall to all alike. One deal is a bijection of 0..rows - 1; two of them spread four ways. */
uint deal(uint row, uint rows) {
    uint first = (rows + 1u) / 2u;
    return row < first ? 2u * row : 2u * (row - first) + 1u;
}
ivec2 dealt_group() {
    uint rows = gl_NumWorkGroups.y;
    return ivec2(gl_WorkGroupID.x, deal(deal(gl_WorkGroupID.y, rows), rows));
}

/* Pixels of a ray's block, and which of them has the ray in this frame. Where two lie side by side the rows take turns:
 * a checkerboard. */
ivec2 ray_block_size() {
    return ivec2(int(view.march_size.z), int(view.steps.w));
}
ivec2 ray_turn(int row) {
    return ivec2(view.turn.x ^ (uint(row) & view.turn.z), view.turn.y);
}

/* 0, but lavapipe does not know: it compiles a shader anew for each dispatch, where conditions depend on uniforms alone
 * and much would fall away with them. */
#ifndef VELUM_NOTHING
#define VELUM_NOTHING 0u
#endif

/* Frames in which calm tiles take one turn; 0: all blocks have their rays in every frame. */
uint calm_turns() {
    return view.turn.w + VELUM_NOTHING;
}

/* Of each block: frame of its newest ray; how far off the host's surface was there, as bits of a float, or, where blocks
 * may have more rays, how many such blocks come before it, and one (0: it has none more). Then of each tile of
 * VELUM_TILE_RAYS_W x VELUM_TILE_RAYS_H blocks: how restless it is; nothing. due.comp and finer.comp write the blocks',
 * due.comp lets the tiles' fade; later passes read the blocks' and add to the tiles'. */
layout(set = 1, binding = VELUM_BIND_RAYS, std430) buffer ray_buffer {
    uvec2 rays[];
};

uint ray_of(ivec2 block) {
    return uint(block.y) * view.march_size.x + uint(block.x);
}
uint block_count() {
    return view.march_size.x * view.march_size.y;
}
uint ray_tile_of(ivec2 block) {
    uint across = (view.march_size.x + uint(VELUM_TILE_RAYS_W) - 1u) / uint(VELUM_TILE_RAYS_W);
    uint tile = uint(block.y / VELUM_TILE_RAYS_H) * across + uint(block.x / VELUM_TILE_RAYS_W);
    return block_count() + tile;
}

/* Whether a block has its ray in this frame, once that is known (due.comp). */
bool block_has_ray(ivec2 block) {
    return calm_turns() == 0u || rays[ray_of(block)].x == view.march_size.w;
}

struct view_ray {
    vec3 origin; /* offset from the eye */
    vec3 direction;
    float stretch; /* length of forward + right x + up y: distance over depth */
};

bool view_flag(uint flag) {
    return ((view.frame.y + VELUM_NOTHING) & flag) != 0u;
}

/* Through a point of the picture, in pixels from its upper left corner. */
view_ray view_ray_at(vec2 pixel) {
    vec2 s = pixel / vec2(view.size.xy);
    float x = mix(view.right.w, view.up.w, s.x);
    float y = mix(view.offset.w, view.forward.w, s.y);
    view_ray ray;
    if (view_flag(VELUM_VIEW_BLOCK_ORTHOGRAPHIC)) {
        ray.origin = view.offset.xyz + view.right.xyz * x + view.up.xyz * y;
        ray.direction = view.forward.xyz;
        ray.stretch = 1.0;
    } else {
        vec3 d = view.forward.xyz + view.right.xyz * x + view.up.xyz * y;
        ray.origin = view.offset.xyz;
        ray.stretch = length(d);
        ray.direction = d / ray.stretch;
    }
    return ray;
}

/* Distances of one thing, as rays of one pixel find them. */
const float alike_ratio = 1.7;
bool alike(float a_m, float b_m) {
    return a_m < alike_ratio * b_m && b_m < alike_ratio * a_m;
}

/* The pixel of a block that has the ray in this frame. */
ivec2 ray_pixel(ivec2 block) {
    return min(block * ray_block_size() + ray_turn(block.y), ivec2(view.size.xy) - 1);
}

/* A finer block has a ray in each of its quarters, and each pixel of a quarter in its turn: of 4 x 4 all have had one
 * after four frames. Rays are told from the block's own, 0, by the bits of how their quarters lie to its. */
ivec2 quarter_size() {
    return max(ray_block_size() / 2, ivec2(1));
}
ivec2 finer_turn(int row, uint which) {
    return ray_turn(row) ^ ivec2(which & 1u, which >> 1u) * (ray_block_size() - 1);
}
/* Of the ray of a quarter (0, 0) to (1, 1). */
uint finer_which(ivec2 quarter) {
    ivec2 apart = quarter ^ (ray_turn(0) / quarter_size());
    return uint(apart.x + 2 * apart.y);
}
ivec2 finer_pixel(ivec2 block, uint which) {
    return min(block * ray_block_size() + finer_turn(block.y, which), ivec2(view.size.xy) - 1);
}
view_ray ray_of_pixel(ivec2 pixel) {
    return view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);
}

/* Four numbers, a quarter of all pixels each: blocks of 1, 16, 32 and 64 pixels differ from their neighbours, of others
 * three in four. Odd and even alternate as on a chessboard, but for one border in eight: two rounds of frames leave no
 * more between neighbours than that. */
uint dither(ivec2 pixel) {
    ivec2 mixed = pixel + (pixel >> 2) + (pixel >> 3);
    ivec2 pair = mixed >> 1;
    return uint((mixed.x + mixed.y) & 1) + 2u * uint((mixed.y + pair.x + pair.y) & 1);
}

/* Share of its length at which a step is sampled: another for each pixel and each round of frames, in quarters. After
 * four rounds all pixels, of whatever channel, have had the same. */
float step_offset(ivec2 pixel) {
    return fract(view.march.w + float(dither(pixel)) * 0.25);
}

/* The same for what is drawn from among a ray's samples: of the offset alone, so that they come round together; an odd
 * multiple takes dyadic fractions to all of them. */
float pick_offset(float offset) {
    return fract(3.0 * offset + 0.125);
}

/* Distance along the ray to what the host has drawn, or a negative number. */
float host_distance(ivec2 pixel, view_ray ray) {
    if (!view_flag(VELUM_VIEW_BLOCK_DEPTH)) {
        return -1.0;
    }
    float d = texelFetch(depth_image, pixel + ivec2(view.size.zw), 0).r;
    float near = view.depth.y;
    float far = view.depth.z;
    int convention = int(view.depth.x) + int(VELUM_NOTHING);
    float z;
    if (convention == 3) {
        return d > 0.0 && !isinf(d) ? d : -1.0;
    } else if (convention == 0) {
        if (d <= 0.0) {
            return -1.0;
        }
        z = near / d;
    } else if (convention == 1) {
        if (d <= 0.0) {
            return -1.0;
        }
        z = near * far / (d * (far - near) + near);
    } else {
        if (d >= 1.0) {
            return -1.0;
        }
        z = near * far / (far - d * (far - near));
    }
    return z * ray.stretch;
}

#endif
