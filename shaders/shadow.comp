#version 460
#extension GL_GOOGLE_include_directive : require
/* A level of a cloud shadow map: transmittance of all cloud towards the sun, from where the texel's line along the sun
 * meets the ellipsoid. */
#include "fringe.glsl"
#include "segments.glsl"
#include "shared/slab.h"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_SHADOW_LEVEL, std140) uniform level_uniform {
    velum_shadow_level_block level;
};
layout(set = 1, binding = VELUM_BIND_SHADOW_OUT, r16f) uniform writeonly image2DArray shadow_out;

/* Of a line through the shell of a layer. */
const float most_steps = 32.0;

/* Of the segments of a texel's line. */
shared float depths[VELUM_GROUP * VELUM_GROUP];

#ifdef VELUM_FRINGED
/* Optical depth of hems and of what falls, from so far on along the sun's line. */
float fringe_depth(vec3 plane, vec3 to_sun, float from_m) {
    float depth = 0.0;
    tile_place tile = tile_nowhere();
    for (uint rest = eye.table.w; rest != 0u; rest &= rest - 1u) {
        int part = findLSB(rest);
        int slot = part & (VELUM_SLOT_COUNT - 1);
        vec4 bounds = part_bounds(part);
        velum_span high = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                            bounds.y * VELUM_SCALE_Z + 1.0);
        velum_span low = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                           max(bounds.x - 1.0, -1000.0));
        float position = max(from_m, high.enter_m);
        position = low.enter_m <= low.leave_m && bounds.x > 0.0 ? max(position, low.leave_m) : position;
        float way = high.enter_m <= high.leave_m ? max(high.leave_m - position, 0.0) : 0.0;
        float count = way > 0.0 ? clamp(ceil(way / (1.5 * level.axis_u.w)), 8.0, most_steps) : 0.0;
        float dt = way / max(count, 1.0);
        for (float i = 0.5 + float(segment_here()); i < count; i += float(segment_count())) {
            vec3 r = plane + to_sun * (position + dt * i);
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            tile = tile_move(tile, normal, max(length(r), 1.0));
            if ((tile.parts & (1u << uint(part))) != 0u) {
                velum_slot_fields f = slot_fields(tile, slot, true);
                velum_fringe g = slot_fringe(tile, slot);
                vec2 span = part_span(part, f, g);
                float h = place.height_m;
                if (f.coverage > 0.0 && h > span.x && h < span.y) {
                    depth += dt * part_extinction(part, f, velum_profile_of(slot, f), g, r, normal, h, false);
                }
            }
        }
    }
    return depth;
}
#endif

/* Optical depth of a texel's line towards the sun; of its segment of each layer. */
float line_depth(ivec2 texel) {
    vec3 plane = level.origin.xyz +
                 (level.axis_u.xyz * (float(texel.x) + 0.5) + level.axis_v.xyz * (float(texel.y) + 0.5)) *
                     level.axis_u.w;
    vec3 to_sun = eye.sun.xyz;
    velum_span ground = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z, 0.0);
    bool grounded = ground.enter_m <= ground.leave_m;
    float depth = 0.0;
    tile_place tile = tile_nowhere();
    /* Slot by slot, each through its own shell alone. */
    for (uint rest = eye.table.z; rest != 0u; rest &= rest - 1u) {
        int slot = findLSB(rest);
        vec4 bounds = eye.slots[slot].bounds;
        velum_span top = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                           bounds.y * VELUM_SCALE_Z + 1.0);
        velum_span base = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                            max(bounds.x - 1.0, -1000.0));
        float position = grounded ? ground.leave_m : top.enter_m;
        position = base.enter_m <= base.leave_m ? max(position, base.leave_m) : position;
        float end = top.enter_m <= top.leave_m ? top.leave_m : position;
        float way = max(end - position, 0.0);
        float segment_m = way / float(segment_count());
        position += segment_m * float(segment_here());
        end = position + segment_m;
        /* As many steps as the texel can show, and no more. */
        float long_dt = max(way / clamp(ceil(way / (1.5 * level.axis_u.w)), 8.0, most_steps), 1.0);
        bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
        while (position < end) {
            float dt = min(long_dt, end - position);
            float at = position + 0.5 * dt;
            vec3 r = plane + to_sun * at;
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            float h = place.height_m;
            float rise = dot(normal, to_sun);
            tile = tile_move(tile, normal, max(length(r), 1.0));
            bool here = (tile.mask & (1u << uint(slot))) != 0u;
            velum_slot_fields f = slot_fields(tile, slot, here);
            float z = (h - f.base_m) / max(f.top_m - f.base_m, 1.0);
            bool within = here && f.coverage > 0.0 && z > 0.0 && z < 1.0 && !uniform_layer;
            float stride = dt;
            if (within) {
                velum_profile profile = velum_profile_of(slot, f);
                float e = velum_excess(profile, f.coverage, column_rank(slot, f, r, normal, h));
                vec2 ways_m = clear_ways_m(slot, f, profile, rise);
                float clear = -e * ways_m.x;
                if (e > 0.0) {
                    float lump = lump_noise(slot, f, r);
                    depth += f.extinction_1_m * dt * velum_body(profile, e, z, h - f.base_m, lump, 0.5);
                    clear = -velum_margin(profile, e, z, lump, 0.5) * ways_m.y;
                }
                float known = min(tile.side_m / float(VELUM_TILE_TEXELS), tile_reach_m(tile, normal, to_sun).x);
                stride = max(dt, 0.5 * dt + min(clear, known));
            }
            /* Sharp faces: the share of the step that lies within them. */
            if (uniform_layer && here && f.coverage >= 0.5) {
                float half_m = 0.5 * dt;
                depth += f.extinction_1_m * velum_slab_within(h, rise, f.base_m, f.top_m, half_m, half_m).inside_m;
            }
            position += stride;
        }
    }
    return depth + FRINGED(fringe_depth(plane, to_sun, grounded ? ground.leave_m : -1.0e9), 0.0);
}

void main() {
    uvec2 lane = uvec2(segment_lane() % uint(VELUM_GROUP), segment_lane() / uint(VELUM_GROUP));
    uvec2 at = gl_WorkGroupID.xy * uint(VELUM_GROUP) + lane;
    ivec2 texel = ivec2(at + level.window.xy);
    bool is_texel = all(lessThan(at, level.window.zw)) && all(lessThan(texel, ivec2(int(level.axis_v.w))));
    float depth = is_texel ? line_depth(texel) : 0.0;
    if (velum_segmented) {
        depths[gl_LocalInvocationIndex] = depth;
        barrier();
        is_texel = is_texel && segment_here() == 0u;
        for (uint i = 1u; i < segment_count(); ++i) {
            depth += is_texel ? depths[gl_LocalInvocationIndex + i] : 0.0;
        }
    }
    if (is_texel) {
        imageStore(shadow_out, ivec3(texel, int(level.origin.w)), vec4(exp(-depth)));
    }
}
