#version 460
#extension GL_GOOGLE_include_directive : require
// The host's ground: the WGS84 ellipsoid, lit by the sun through the cloud shadow map and by the sky.
#include "host_arguments.h"

#define VELUM_SHADOW_SET 0
#define VELUM_SHADOW_BLOCK_BINDING HOST_BINDING_SHADOW_BLOCK
#define VELUM_SHADOW_MAP_BINDING HOST_BINDING_SHADOW_MAP
#include "velum/velum_shadow.glsl"

layout(local_size_x = HOST_GROUP_SIZE, local_size_y = HOST_GROUP_SIZE) in;
layout(set = 0, binding = HOST_BINDING_VIEW, std140) uniform View {
    HOST_VIEW_ARGUMENTS
} view;
layout(set = 0, binding = HOST_BINDING_COLOUR, rgba32f) uniform writeonly image2D colour_image;
layout(set = 0, binding = HOST_BINDING_DEPTH, r32f) uniform writeonly image2D depth_image;

layout(constant_id = 0) const bool colour_wanted = true; // not only depth

const float PI = 3.14159265;

// Jarzynski and Olano 2020, "Hash functions for GPU rendering": pcg3d.
uvec3 hash(ivec3 cell) {
    uvec3 v = uvec3(cell) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> 16u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    return v;
}

vec3 hash_unit(ivec3 cell) {
    return vec3(hash(cell) >> 8u) * (1.0 / 16777216.0);
}

// Where a point relative to the eye lies in the lattice of a pattern.
void lattice(vec3 position, float size_m, vec3 eye_cell, vec3 eye_part, out ivec3 cell, out vec3 part) {
    vec3 p = eye_part + position / size_m;
    vec3 whole = floor(p);
    cell = ivec3(eye_cell) + ivec3(whole);
    part = p - whole;
}

// Value noise, 0..1, mean 0.5.
float noise(ivec3 cell, vec3 part) {
    vec3 s = part * part * (3.0 - 2.0 * part);
    vec2 xy[2];
    float z[2];
    for (int k = 0; k < 2; k++) {
        for (int j = 0; j < 2; j++) {
            xy[j] = vec2(hash_unit(cell + ivec3(0, j, k)).x, hash_unit(cell + ivec3(1, j, k)).x);
        }
        z[k] = mix(mix(xy[0].x, xy[0].y, s.x), mix(xy[1].x, xy[1].y, s.x), s.y);
    }
    return mix(z[0], z[1], s.z);
}

// The nearest of the scattered points: its hash, and the way to it in cells. `edge`: how much further the second is.
vec3 nearest(ivec3 cell, vec3 part, out vec3 way, out float edge) {
    ivec3 low = ivec3(floor(part - 0.5));
    float first = 1e9, second = 1e9;
    vec3 found = vec3(0.5);
    way = vec3(0.0);
    for (int i = 0; i < 8; i++) {
        ivec3 step = low + ivec3(i & 1, (i >> 1) & 1, i >> 2);
        vec3 random = hash_unit(cell + step);
        vec3 delta = vec3(step) + 0.2 + 0.6 * random - part;
        float square = dot(delta, delta);
        if (square < first) {
            second = first;
            first = square;
            found = random.zxy;
            way = delta;
        } else {
            second = min(second, square);
        }
    }
    edge = sqrt(second) - sqrt(first);
    return found;
}

// How much of a pattern a pixel of that footprint still shows.
float shown(float footprint_m, float size_m) {
    return 1.0 - smoothstep(0.12 * size_m, 0.45 * size_m, footprint_m);
}

// Relative to the mean albedo; each pattern's own mean is 1, so that distance only takes detail away.
vec3 pattern(vec3 position, float footprint_m) {
    const vec3 crops[4] = vec3[4](vec3(1.20, 1.08, 1.04), vec3(0.90, 1.03, 0.92), vec3(0.82, 0.93, 0.90),
                                  vec3(1.08, 0.96, 1.14));
    ivec3 cell;
    vec3 part;
    vec3 tint = vec3(1.0);
    float region = shown(footprint_m, HOST_PATTERN_REGION_M);
    if (region <= 0.0) {
        return tint;
    }
    lattice(position, HOST_PATTERN_REGION_M, view.region_cell.xyz, view.region_part.xyz, cell, part);
    tint *= 1.0 + region * 0.4 * (noise(cell, part) - 0.5) * vec3(1.0, 0.7, 0.9);

    float wood = shown(footprint_m, HOST_PATTERN_WOOD_M);
    if (wood <= 0.0) {
        return tint;
    }
    float field = shown(footprint_m, HOST_PATTERN_FIELD_M);
    float edge = 1.0;
    vec3 random = vec3(0.5), way = vec3(0.0);
    for (int once = 0; once < (field > 0.0 ? 1 : 0); once++) {
        lattice(position, HOST_PATTERN_FIELD_M, view.field_cell.xyz, view.field_part.xyz, cell, part);
        random = nearest(cell, part, way, edge);
    }
    // Woods end where fields do.
    vec3 place = position + way * HOST_PATTERN_FIELD_M;
    lattice(place, HOST_PATTERN_WOOD_M, view.wood_cell.xyz, view.wood_part.xyz, cell, part);
    float trees = smoothstep(0.55, 0.63, noise(cell, part) + 0.12 * (random.z - 0.5));
    tint *= 1.0 + wood * (trees * vec3(-0.44, -0.34, -0.42) + vec3(0.15, 0.115, 0.143));
    if (field > 0.0) {
        vec3 crop = crops[int(random.x * 3.999)] * (0.9 + 0.2 * random.y);
        float width = max(footprint_m / HOST_PATTERN_FIELD_M, 0.012);
        float hedge = (1.0 - smoothstep(0.5 * width, 1.5 * width, edge)) * min(1.0, 0.02 / width);
        tint *= mix(vec3(1.0), crop * (1.0 - 0.35 * hedge), field * (1.0 - 0.9 * trees));
    }
    float tuft = shown(footprint_m, HOST_PATTERN_TUFT_M);
    for (int once = 0; once < (tuft > 0.0 ? 1 : 0); once++) {
        lattice(position, HOST_PATTERN_TUFT_M, view.tuft_cell.xyz, view.tuft_part.xyz, cell, part);
        tint *= 1.0 + tuft * (0.2 + 0.35 * trees) * (noise(cell, part) - 0.5);
    }
    return tint;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    vec2 size = vec2(view.field_cell.w, view.tuft_cell.w);
    if (pixel.x >= int(size.x) || pixel.y >= int(size.y)) {
        return;
    }
    vec2 at = (vec2(pixel) + 0.5) / size;
    float x = mix(view.right.w, view.up.w, at.x);
    float y = mix(view.gradient.w, view.forward.w, at.y);
    vec3 direction = normalize(view.forward.xyz + x * view.right.xyz + y * view.up.xyz);

    vec3 stretched = direction * vec3(1.0, 1.0, view.surface.x);
    float a = dot(direction, stretched) * view.surface.y;
    float b = dot(direction, view.gradient.xyz);
    float c = view.surface.z;
    float discriminant = b * b - a * c;
    float depth = 0.0;
    vec3 luminance = vec3(0.0);
    if (b < 0.0 && discriminant > 0.0) {
        depth = c / (sqrt(discriminant) - b);
    }
    imageStore(depth_image, pixel, vec4(depth));
    if (!colour_wanted) {
        return;
    }
    // A loop, because software devices leave a loop without active pixels but run through an if.
    for (int once = 0; once < (depth > 0.0 ? 1 : 0); once++) {
        vec3 position = depth * direction;
        vec3 normal = normalize(view.gradient.xyz + stretched * (depth * view.surface.y));
        float facing = max(-dot(direction, normal), 0.002);
        vec3 albedo = view.albedo.rgb;
        // Not of uniforms alone: for such a condition Mesa's software device makes the shader anew in every frame, and
        // keeps them all.
        float strength = depth > 0.0 ? view.albedo.w : 0.0;
        if (strength > 0.0) {
            albedo *= mix(vec3(1.0), pattern(position, depth * view.surface.w / facing), strength);
        }
        float sun_cosine = dot(normal, view.sun.xyz);
        vec3 light = view.sky_lx.rgb;
        if (sun_cosine > 0.0) {
            float shadow = velum_shadow(position + view.shadow_offset.xyz);
            light += view.sun_lx.rgb * (sun_cosine * shadow);
        }
        luminance = min(albedo, vec3(1.0)) * light / PI;
    }
    imageStore(colour_image, pixel, vec4(luminance, 1.0));
}
