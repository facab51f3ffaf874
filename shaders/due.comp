#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* Where views stand: lists the rays that are due in a frame, and notes it of them; how restless tiles are fades. */
#include "due_list.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

/* Where the host has no surface. */
const float far_off_m = 1.0e9;

/* Calm tiles take turns, in another frame of each round, so that all their pixels do. `end_m`: the host's surface; where
 * that has come or gone a ray is due. */
bool takes_turn(ivec2 block, float end_m) {
    ivec2 side = ivec2(VELUM_TILE_RAYS_W, VELUM_TILE_RAYS_H);
    ivec2 here = min(ivec2(view.march_size.xy) - block / side * side, side);
    const float threshold = VELUM_RESTLESS * float(VELUM_RESTLESS_UNIT * VELUM_RESTLESS_FRAMES);
    bool restless = float(rays[ray_tile_of(block)].x) >= threshold * float(here.x * here.y);
    float before_m = uintBitsToFloat(rays[ray_of(block)].y);
    uint frame = view.march_size.w;
    uint turns = view.march_size.z * view.steps.w;
    uvec2 area = uvec2(block) / uvec2(8u, 4u);
    uint shift = turns > 1u ? frame / turns : 0u;
    return restless || !alike(end_m, before_m) || (frame + shift + area.x + 2u * area.y) % calm_turns() == 0u;
}

void main() {
    ivec2 block = picture_block();
    bool is_due = is_in_picture(block);
    if (is_due) {
        ivec2 pixel = ray_pixel(block);
        float end_m = host_distance(pixel, ray_of_pixel(pixel));
        end_m = end_m < 0.0 ? far_off_m : end_m;
        is_due = takes_turn(block, end_m);
        if (is_due) {
            rays[ray_of(block)] = uvec2(view.march_size.w, floatBitsToUint(end_m));
        }
    }
    /* All of a tile know how restless it has been. */
    memoryBarrierBuffer();
    barrier();
    if (is_due && block.x % VELUM_TILE_RAYS_W == 0 && block.y % VELUM_TILE_RAYS_H == 0) {
        uint tile = ray_tile_of(block);
        uint restless = min(rays[tile].x, VELUM_RESTLESS_MOST);
        rays[tile].x = restless - restless / VELUM_RESTLESS_FRAMES;
    }
    uint room = due_room(is_due ? 1u : 0u);
    if (is_due) {
        lit_list[room] = ray_of(block);
    }
}
