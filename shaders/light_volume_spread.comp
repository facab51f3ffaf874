#version 460
#extension GL_GOOGLE_include_directive : require
/* Each cell of a volume of light gathers what the others send: one order of scattering more. */
#include "air_light.glsl"
#include "light_volume.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

const int rays = 8;
const int steps = 64;
const float dark = 0.005; /* transmittance at which a ray ends */
const float golden_turn = 2.39996323; /* rad */

void main() {
    ivec3 cell;
    int index;
    if (!volume_cell_here(cell, index)) {
        return;
    }
    int count = volume_count();
    int newest = volume_newest() * count;
    float top = (volume.span.y - volume.span.x) / volume.north.w;
    vec3 above = ambient_over(volume.span.y, false);
    vec3 below = ambient_under(volume.span.x, false);
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
        vec3 rate = direction / vec3(volume.east.ww, volume.north.w);
        float step_m = 1.0 / max(max(abs(rate.x), abs(rate.y)), abs(rate.z));
        float from_east = volume_draw(chance);
        float from_north = volume_draw(chance);
        float from_low = volume_draw(chance);
        vec3 place = vec3(cell) + vec3(from_east, from_north, from_low);
        float dt = step_m * volume_draw(chance);
        float through = 1.0;
        vec3 ray_light = vec3(0.0);
        for (int k = 0; k < steps && through > dark; ++k) {
            vec3 middle = place + rate * (0.5 * dt);
            if (middle.z < 0.0 || middle.z >= top) {
                break;
            }
            int at = volume_index(ivec3(floor(middle)));
            vec4 there = volume_cells[newest + at];
            float step_t = exp(-there.w * dt);
            vec3 source = there.rgb + volume_cells[VELUM_LIGHT_VOLUME_SUN * count + at].rgb;
            ray_light += (through * (1.0 - step_t)) * source;
            through *= step_t;
            place += rate * dt;
            dt = step_m;
        }
        ray_light += through * (up > 0.0 ? above : below);
        light += ray_light / float(rays);
        flux -= direction * (dot(ray_light, VELUM_LUMINANCE_OF) / float(rays));
    }
    vec4 old = volume_cells[newest + index];
    vec3 old_flux = volume_cells[VELUM_LIGHT_VOLUME_FLUX * count + index].xyz;
    volume_cells[(1 - volume_newest()) * count + index] = vec4(max(mix(old.rgb, light, volume.span.z), 0.0), old.w);
    volume_cells[VELUM_LIGHT_VOLUME_FLUX * count + index] = vec4(mix(old_flux, flux, volume.span.z), 0.0);
}
