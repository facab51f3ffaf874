#version 460
#extension GL_GOOGLE_include_directive : require
/* A level of a cloud shadow map: transmittance of all cloud towards the sun, from where the texel's line along the sun
 * meets the ellipsoid. */
#include "weather.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_SHADOW_LEVEL, std140) uniform level_uniform {
    velum_shadow_level_block level;
};
layout(set = 1, binding = VELUM_BIND_SHADOW_OUT, r16f) uniform writeonly image2DArray shadow_out;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, int(level.window.x));
    int side = int(level.axis_v.w);
    if (texel.x >= side || texel.y >= int(level.window.x + level.window.y) || texel.y >= side) {
        return;
    }
    vec3 plane = level.origin.xyz +
                 (level.axis_u.xyz * (float(texel.x) + 0.5) + level.axis_v.xyz * (float(texel.y) + 0.5)) *
                     level.axis_u.w;
    vec3 to_sun = eye.sun.xyz;
    velum_span ground = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z, 0.0);
    bool grounded = ground.enter_m <= ground.leave_m;
    float depth = 0.0;
    int steps = int(level.window.z);
    /* Slot by slot, each through its own shell alone. */
    for (uint rest = eye.table.z; rest != 0u; rest &= rest - 1u) {
        int slot = findLSB(rest);
        vec4 bounds = eye.slots[slot].bounds;
        velum_span top = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                           bounds.y * VELUM_SCALE_Z + 1.0);
        velum_span base = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                            max(bounds.x - 1.0, -1000.0));
        float start = grounded ? ground.leave_m : top.enter_m;
        start = base.enter_m <= base.leave_m ? max(start, base.leave_m) : start;
        float end = top.enter_m <= top.leave_m ? top.leave_m : start;
        float dt = max(end - start, 0.0) / float(steps);
        bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
        for (int i = 0; i < steps; ++i) {
            vec3 r = plane + to_sun * (start + (float(i) + 0.5) * dt);
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            float h = place.height_m;
            float rise = abs(dot(normal, to_sun) * dt);
            tile_place tile = tile_find(normal, max(length(r), 1.0));
            bool here = (tile.mask & (1u << uint(slot))) != 0u;
            velum_slot_fields f = slot_fields(tile, slot, here);
            float z = (h - f.base_m) / max(f.top_m - f.base_m, 1.0);
            velum_profile profile = velum_profile_of(slot, f);
            float e = velum_excess(profile, f.coverage, column_rank(slot, f, r, normal, h));
            float body = velum_body(profile, e, clamp(z, 0.0, 1.0), h - f.base_m, lump_noise(slot, f, r), 0.5);
            bool within = here && f.coverage > 0.0 && z > 0.0 && z < 1.0 && e > 0.0;
            /* Sharp faces: the share of the step that lies within them. */
            float low = h - 0.5 * rise;
            float high = h + 0.5 * rise;
            float overlap = rise > 0.01 ? clamp((min(high, f.top_m) - max(low, f.base_m)) / rise, 0.0, 1.0)
                                        : (h >= f.base_m && h <= f.top_m ? 1.0 : 0.0);
            float slab = here && f.coverage >= 0.5 ? overlap : 0.0;
            depth += f.extinction_1_m * dt * (uniform_layer ? slab : (within ? body : 0.0));
        }
    }
    imageStore(shadow_out, ivec3(texel, int(level.origin.w)), vec4(exp(-depth)));
}
