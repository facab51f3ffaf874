/* Velum cloud shadow maps in a host's shaders: position -> transmittance of all cloud between the ground below it and
 * the sun.
 *
 * Before including, define VELUM_SHADOW_SET, VELUM_SHADOW_BLOCK_BINDING (uniform buffer: velum_shadow_geometry.block,
 * 160 bytes) and VELUM_SHADOW_MAP_BINDING (combined image sampler: view and sampler of velum_vulkan_shadow, layout
 * GENERAL). Positions are relative to velum_shadow_geometry.origin_ecef_m, ECEF axes, metres: subtract the origin in
 * double (for an eye: once, on the CPU).
 *
 * The map holds, for each line along the sun, what comes through from where the line meets the ellipsoid to space. It is
 * right for the ground and for what stands on it below the cloud; in or above cloud it is too dark.
 *
 * The finest level that holds the position answers, fading to the next one over the outer tenth of its side; outside of
 * all levels there is no shadow: 1. */
#ifndef VELUM_SHADOW_GLSL
#define VELUM_SHADOW_GLSL

layout(set = VELUM_SHADOW_SET, binding = VELUM_SHADOW_BLOCK_BINDING, std140) uniform velum_shadow_uniform {
    vec4 axis_u;   /* w: number of levels; 0: no map */
    vec4 axis_v;   /* w: texels a side */
    vec4 sun;
    vec4 level[4]; /* extent m, offset u, offset v */
}
velum_shadow_data;
layout(set = VELUM_SHADOW_SET, binding = VELUM_SHADOW_MAP_BINDING) uniform sampler2DArray velum_shadow_map;

float velum_shadow(vec3 position) {
    vec2 place = vec2(dot(position, velum_shadow_data.axis_u.xyz), dot(position, velum_shadow_data.axis_v.xyz));
    int levels = int(velum_shadow_data.axis_u.w);
    float half_texel = 0.5 / max(velum_shadow_data.axis_v.w, 1.0);
    float result = 0.0;
    float left = 1.0; /* weight that no level has taken yet */
    for (int k = 0; k < levels && left > 0.0; ++k) {
        vec4 level = velum_shadow_data.level[k];
        vec2 uv = place / level.x + level.yz;
        vec2 inside = 0.5 - abs(uv - 0.5);
        float border = min(inside.x, inside.y);
        if (border > half_texel) {
            float weight = left * clamp((border - half_texel) / 0.1, 0.0, 1.0);
            result += weight * textureLod(velum_shadow_map, vec3(uv, float(k)), 0.0).r;
            left -= weight;
        }
    }
    return result + left;
}

#endif
