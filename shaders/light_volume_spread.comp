#version 460
#extension GL_GOOGLE_include_directive : require
/* Each cell of a volume of light gathers what the others send: one order of scattering more. */
#include "air_light.glsl"
#include "light_volume.glsl"
#include "shared/slab.h"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

const int rays = 8;
const int steps = 128;
const float dark = 0.005; /* transmittance at which a ray ends */
const float golden_turn = 2.39996323; /* rad */

/* Luminance of a half world on the mean over a part of the cosines from the vertical, where its mean is known and that of an
 * even one with its flux: as a power of the cosine, which the two tell. */
const int half_parts = rays / 2;
vec3 half_world_over(vec3 mean, vec3 even, float cosine) {
    vec3 ratio = clamp(even / max(mean, vec3(1.0e-9)), 0.2, 1.6);
    vec3 power = (2.0 * ratio - 2.0) / (2.0 - ratio);
    float part = min(floor(cosine * float(half_parts)), float(half_parts - 1));
    vec3 low = pow(vec3(part / float(half_parts)), power + 1.0);
    vec3 high = pow(vec3((part + 1.0) / float(half_parts)), power + 1.0);
    return mean * (high - low) * float(half_parts);
}

/* What the air at a height sends along a way, and takes of it, a metre. */
struct volume_air {
    vec3 light_1_m;
    float dims_1_m;
};
volume_air volume_air_along(vec3 direction, float height_m) {
    vec3 d = volume.east.xyz * direction.x + volume.north.xyz * direction.y + eye.up.xyz * direction.z;
    float haze = haze_extinction_1_m(height_m);
    float fog = fog_extinction_1_m(height_m);
    vec3 source = air_source(height_m, haze, fog, dot(eye.up.xyz, eye.sun.xyz), dot(d, eye.sun.xyz), direction.z, true);
    vec3 dims = air_extinction_1_m(height_m) + vec3(fog + haze - goes_on_1_m(height_m, haze));
    bool any = eye.ground.w != 0.0;
    return volume_air(any ? eye.sun_lx.rgb * source : vec3(0.0), any ? dot(dims, VELUM_LUMINANCE_OF) : 0.0);
}

void main() {
    ivec3 cell;
    int index;
    if (!volume_cell_here(cell, index)) {
        return;
    }
    int count = volume_count();
    int newest = volume_newest() * count;
    vec4 old = volume_cell(newest + index);
    vec3 old_flux = volume_cells[VELUM_LIGHT_VOLUME_FLUX * count + index].xyz;
    if (old.w <= 0.0) {
        return;
    }
    volume_box box = volume_box_at(index);
    float height_m = volume.span.x + (float(cell.z) + 0.5) * volume.north.w;
    vec3 above = ambient_over(volume.span.y, false);
    vec3 above_even = ambient_over(volume.span.y, true);
    vec3 below = ambient_under(volume.span.x, false);
    vec3 below_even = ambient_under(volume.span.x, true);
    volume_chance chance = volume_chance(uint(index), volume.grid.z * 4096u);
    float turn = 2.0 * PI * volume_draw(chance);
    float rise = volume_draw(chance);
    vec3 light = vec3(0.0);
    vec3 flux = vec3(0.0);
    for (int i = 0; i < rays; ++i) {
        float up = 1.0 - 2.0 * (float(i) + rise) / float(rays);
        float aside = sqrt(max(1.0 - up * up, 0.0));
        float angle = turn + float(i) * golden_turn;
        vec3 direction = vec3(aside * cos(angle), aside * sin(angle), up);
        vec3 cells_1_m = direction / vec3(volume.east.ww, volume.north.w);
        volume_air air = volume_air_along(direction, height_m);
        volume_walk walk = volume_walk_from(cell, volume_start(cell, box, chance), cells_1_m);
        float through = 1.0;
        vec3 ray_light = vec3(0.0);
        for (int k = 0; k < steps && through > dark && !volume_walk_ends(walk); ++k) {
            int at = volume_index(walk.cell);
            vec4 there = volume_cell(newest + at);
            float way_m = walk.to_m - walk.from_m;
            float cloud = volume_crossed(walk, at, there.w);
            float all = cloud + air.dims_1_m * way_m;
            vec3 source = cloud * (there.rgb + volume_cell(VELUM_LIGHT_VOLUME_SUN * count + at).rgb) + air.light_1_m * way_m;
            ray_light += through * velum_mean_transmittance(all) * source;
            through *= exp(-all);
            walk = volume_walk_on(walk);
        }
        vec3 beyond = up > 0.0 ? half_world_over(above, above_even, up) : half_world_over(below, below_even, -up);
        ray_light += through * beyond;
        light += ray_light / float(rays);
        flux -= direction * (dot(ray_light, VELUM_LUMINANCE_OF) / float(rays));
    }
    volume_cells[(1 - volume_newest()) * count + index] = vec4(max(mix(old.rgb, light, volume.span.z), 0.0), old.w);
    volume_cells[VELUM_LIGHT_VOLUME_FLUX * count + index].xyz = mix(old_flux, flux, volume.span.z);
}
