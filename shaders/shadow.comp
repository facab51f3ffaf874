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
    /* From the plane down to the ground (or the nearest approach), then up through the layers. */
    velum_span ground = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z, 0.0);
    velum_span top = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                       eye.span.y * VELUM_SCALE_Z + 1.0);
    float depth = 0.0;
    if (top.enter_m < top.leave_m && eye.table.z != 0u) {
        float from = ground.enter_m <= ground.leave_m ? ground.leave_m : top.enter_m;
        velum_span base = velum_sphere_span(eye_geometry(), plane.x, plane.y, plane.z, to_sun.x, to_sun.y, to_sun.z,
                                            max(eye.span.x - 1.0, 0.0));
        float start = ground.enter_m <= ground.leave_m && base.leave_m > from ? base.leave_m : from;
        float end = top.leave_m;
        int steps = int(level.window.z);
        float offset = 0.5;
        float dt = (end - start) / float(steps);
        for (int i = 0; i < steps && depth < 12.0; ++i) {
            vec3 r = plane + to_sun * (start + (float(i) + offset) * dt);
            velum_place place = place_of(r);
            vec3 normal = vec3(place.nx, place.ny, place.nz);
            float h = place.height_m;
            float rise = dot(normal, to_sun) * dt;
            tile_place tile = tile_find(normal, max(length(r), 1.0));
            for (int slot = 0; slot < VELUM_SLOT_COUNT; ++slot) {
                if ((tile.mask & (1u << uint(slot))) == 0u) {
                    continue;
                }
                vec4 bounds = eye.slots[slot].bounds;
                if (h + abs(rise) < bounds.x || h - abs(rise) > bounds.y) {
                    continue;
                }
                velum_slot_fields f = slot_fields(tile, slot, true);
                if (f.coverage <= 0.0) {
                    continue;
                }
                if (slot >= VELUM_SLOT_UNIFORM) {
                    float low = h - 0.5 * abs(rise);
                    float high = h + 0.5 * abs(rise);
                    float overlap = high - low > 0.01
                                        ? clamp((min(high, f.top_m) - max(low, f.base_m)) / (high - low), 0.0, 1.0)
                                        : (h >= f.base_m && h <= f.top_m ? 1.0 : 0.0);
                    depth += f.coverage >= 0.5 ? f.extinction_1_m * overlap * dt : 0.0;
                    continue;
                }
                float z = (h - f.base_m) / max(f.top_m - f.base_m, 1.0);
                if (z <= 0.0 || z >= 1.0) {
                    continue;
                }
                velum_profile profile = velum_profile_of(slot, f);
                float e = velum_excess(profile, f.coverage, column_rank(slot, f, r, normal, h));
                if (e > 0.0) {
                    depth += f.extinction_1_m * velum_body(profile, e, z, h - f.base_m, lump_noise(slot, f, r), 0.5) * dt;
                }
            }
        }
    }
    imageStore(shadow_out, ivec3(texel, int(level.origin.w)), vec4(exp(-depth)));
}
