// Velum: how much sunlight the clouds let through to a point. For the host's own shaders.
//
// Before the include define where the host binds things:
//     #define VELUM_SHADOW_SET 0            descriptor set
//     #define VELUM_SHADOW_BLOCK_BINDING 1  uniform buffer: velum_shadow_geometry.block
//     #define VELUM_SHADOW_MAP_BINDING 2    combined image sampler: velum_vulkan_shadow.view, .sampler, layout GENERAL
// Positions are metres, ECEF axes, relative to velum_shadow_geometry.origin_ecef_m: subtract it in double.
#ifndef VELUM_SHADOW_GLSL
#define VELUM_SHADOW_GLSL

layout(set = VELUM_SHADOW_SET, binding = VELUM_SHADOW_BLOCK_BINDING, std140) uniform VelumShadowBlock {
    vec4 axis_u;   // w: number of levels
    vec4 axis_v;   // w: texels a side
    vec4 sun;      // towards the sun
    vec4 level[4]; // extent_m, offset_u, offset_v
} velum_shadow_block;

layout(set = VELUM_SHADOW_SET, binding = VELUM_SHADOW_MAP_BINDING) uniform sampler2DArray velum_shadow_map;

// Transmittance towards the sun, 0..1, of all cloud over the point. Outside the coarsest level: 1. Levels are blended
// over the outer tenth, so that no border shows.
float velum_shadow(vec3 position_rel_origin) {
    vec2 across = vec2(dot(position_rel_origin, velum_shadow_block.axis_u.xyz),
                       dot(position_rel_origin, velum_shadow_block.axis_v.xyz));
    int levels = int(velum_shadow_block.axis_u.w);
    float half_texel = 0.5 / velum_shadow_block.axis_v.w;
    float transmittance = 0.0;
    float left = 1.0;
    for (int k = 0; k < levels && left > 0.0; k++) {
        vec2 uv = across / velum_shadow_block.level[k].x + velum_shadow_block.level[k].yz;
        vec2 inside = min(uv, 1.0 - uv) - half_texel;
        float weight = left * clamp(min(inside.x, inside.y) * 10.0, 0.0, 1.0);
        if (weight > 0.0) {
            transmittance += weight * textureLod(velum_shadow_map, vec3(uv, float(k)), 0.0).r;
            left -= weight;
        }
    }
    return transmittance + left;
}

#endif
