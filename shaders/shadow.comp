#version 460
#extension GL_GOOGLE_include_directive : require
/* A level of a cloud shadow map: transmittance of all cloud towards the sun, from where the texel's line along the sun
 * meets the ellipsoid. */
#include "segments.glsl"
#include "uneven.glsl"
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

/* A texel's line through the heights of a layer; of it, a lane's segment. */
struct sun_way {
    float position, end;
    float whole_m;
};

/* `ground`: where the line is within the ellipsoid. */
sun_way way_through(vec3 plane, vec3 to_sun, velum_span ground, vec2 heights_m) {
    velum_span top = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                       heights_m.y * VELUM_SCALE_Z + 1.0);
    velum_span base = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                        max(heights_m.x - 1.0, -1000.0));
    sun_way way;
    float first = ground.enter_m <= ground.leave_m ? ground.leave_m : top.enter_m;
    first = base.enter_m <= base.leave_m ? max(first, base.leave_m) : first;
    way.whole_m = top.enter_m <= top.leave_m ? max(top.leave_m - first, 0.0) : 0.0;
    float segment_m = way.whole_m / float(segment_count());
    way.position = first + segment_m * float(segment_here());
    way.end = way.position + segment_m;
    return way;
}

/* As many steps as the texel can show, and enough for the layer's depth. */
float step_through_m(float way_m) {
    return max(way_m / clamp(ceil(way_m / (1.5 * level.axis_u.w)), 24.0, most_steps), 1.0);
}

/* What a step is to do about the heights between which its part of a tile has a layer. */
struct sun_step {
    bool meets;
    float stride_m; /* to the next; 0: the same once more, as it fits the layer */
    float dt_m;     /* of the next */
};

/* `here` false: there is no such layer; `known_m`: how far along the line heights are told. */
sun_step step_at(bool here, vec2 heights_m, float known_m, sun_way way, float dt, float rise, float h) {
    float half_m = 0.5 * dt * abs(rise) + 0.125 * dt * dt / VELUM_WGS84_A_M;
    vec2 gap_m = here ? gap_beside(no_gap_m, h - half_m, h + half_m, heights_m) : no_gap_m;
    sun_step next;
    next.meets = here && gap_m == no_gap_m;
    next.dt_m = step_through_m(way.whole_m);
    next.stride_m = next.meets ? dt : max(dt, 0.5 * dt + min(gap_way_m(gap_m, h, rise) - 1.0, known_m));
    return next;
}

/* The same by fields, which are known between four texels: elsewhere the layer lies higher or lower. It is taken to do so
 * by a metre a metre; edges of storms and of rain are steeper, but end within a texel. */
sun_step step_by_fields(velum_slot_fields f, vec2 heights_m, float known_m, sun_way way, float dt, float rise, float h) {
    bool here = f.coverage > 0.0;
    float away_m = here ? max(heights_m.x - h, h - heights_m.y) : 1.0e9;
    float closes = abs(rise) + sqrt(max(1.0 - rise * rise, 0.0));
    float through_m = min((heights_m.y - heights_m.x) / max(abs(rise), 1.0e-3), way.whole_m);
    bool touches = away_m < 0.5 * dt * closes;
    sun_step next;
    next.dt_m = here ? step_through_m(through_m) : dt;
    bool again = touches && dt > 1.001 * next.dt_m;
    next.meets = touches && !again;
    next.stride_m = again ? 0.0 : touches ? dt : max(dt, 0.5 * dt + min(away_m / closes, known_m));
    return next;
}

#ifdef VELUM_FRINGED
/* Optical depth of hems and of what falls. */
float fringe_depth(vec3 plane, vec3 to_sun, velum_span ground) {
    float depth = 0.0;
    tile_place tile = tile_nowhere();
    for (uint rest = eye.table.w; rest != 0u; rest &= rest - 1u) {
        int part = findLSB(rest);
        int slot = part & (VELUM_SLOT_COUNT - 1);
        vec2 bounds_m = part_bounds(part).xy;
        sun_way way = way_through(plane, to_sun, ground, bounds_m);
        float long_dt = step_through_m(way.whole_m);
        while (way.position < way.end) {
            float dt = min(long_dt, way.end - way.position);
            vec3 r = plane + to_sun * (way.position + 0.5 * dt);
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            tile = tile_move(tile, normal, max(length(r), 1.0));
            bool here = (tile.parts & (1u << uint(part))) != 0u;
            sun_step next = sun_step(here, dt, long_dt);
            float h = place.height_m;
            float rise = dot(normal, to_sun);
            vec3 reach_m = tile_reach_m(tile, normal, to_sun);
            if (velum_uneven) {
                vec2 heights_m = here ? part_heights_m(tile, part, part_word_of(tile)) : bounds_m;
                next = step_at(here, heights_m, here ? reach_m.y : reach_m.x, way, dt, rise, h);
            }
            if (next.meets) {
                velum_slot_fields f = slot_fields(tile, slot, true);
                velum_fringe g = slot_fringe(tile, slot);
                vec2 span = part_span(part, f, g);
                if (velum_uneven) {
                    next = step_by_fields(f, span, reach_m.z, way, dt, rise, h);
                }
                if (next.meets && f.coverage > 0.0 && h > span.x && h < span.y) {
                    depth += dt * part_extinction(part, f, velum_profile_of(slot, f), g, r, normal, h, false);
                }
            }
            way.position += next.stride_m;
            long_dt = next.dt_m;
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
    float depth = 0.0;
    tile_place tile = tile_nowhere();
    /* Slot by slot, each through its own shell alone. */
    for (uint rest = eye.table.z; rest != 0u; rest &= rest - 1u) {
        int slot = findLSB(rest);
        vec2 bounds_m = eye.slots[slot].bounds.xy;
        sun_way way = way_through(plane, to_sun, ground, bounds_m);
        float long_dt = step_through_m(way.whole_m);
        bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
        while (way.position < way.end) {
            float dt = min(long_dt, way.end - way.position);
            vec3 r = plane + to_sun * (way.position + 0.5 * dt);
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            float h = place.height_m;
            float rise = dot(normal, to_sun);
            tile = tile_move(tile, normal, max(length(r), 1.0));
            bool here = (tile.mask & (1u << uint(slot))) != 0u;
            sun_step next = sun_step(here, dt, long_dt);
            vec3 reach_m = tile_reach_m(tile, normal, to_sun);
            if (velum_uneven) {
                vec2 heights_m = here ? slot_heights_m(tile, slot, part_word_of(tile)) : bounds_m;
                next = step_at(here, heights_m, here ? reach_m.y : reach_m.x, way, dt, rise, h);
            }
            velum_slot_fields f = slot_fields(tile, slot, next.meets);
            if (velum_uneven && next.meets) {
                next = step_by_fields(f, vec2(f.base_m, f.top_m), reach_m.z, way, dt, rise, h);
            }
            float z = (h - f.base_m) / max(f.top_m - f.base_m, 1.0);
            bool within = next.meets && f.coverage > 0.0 && z > 0.0 && z < 1.0 && !uniform_layer;
            if (within) {
                velum_profile profile = even_profile(slot);
                if (velum_uneven) {
                    profile = velum_profile_of(slot, f);
                }
                float e = velum_excess(profile, f.coverage, column_rank(slot, f, r, normal, h));
                vec2 ways_m = clear_ways_m(slot, f, profile, rise);
                float clear = -e * ways_m.x;
                if (e > 0.0) {
                    float lump = lump_noise(slot, f, r);
                    depth += f.extinction_1_m * dt * velum_body(profile, e, z, h - f.base_m, lump, 0.5);
                    clear = -velum_margin(profile, e, z, lump, 0.5) * ways_m.y;
                }
                float known = min(tile.side_m / float(VELUM_TILE_TEXELS), reach_m.x);
                next.stride_m = max(next.stride_m, 0.5 * dt + min(clear, known));
            }
            /* Sharp faces: the share of the step that lies within them. */
            if (uniform_layer && next.meets && f.coverage >= 0.5) {
                float half_m = 0.5 * dt;
                depth += f.extinction_1_m * velum_slab_within(h, rise, f.base_m, f.top_m, half_m, half_m).inside_m;
            }
            way.position += next.stride_m;
            long_dt = next.dt_m;
        }
    }
    return depth + FRINGED(fringe_depth(plane, to_sun, ground), 0.0);
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
