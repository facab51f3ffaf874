#version 460
#extension GL_GOOGLE_include_directive : require
/* Of each cell of a volume of light, how dense its cloud is for light that is on its way to all sides. */
#include "air_light.glsl"
#include "weather.glsl"
#include "cloud_light.glsl"
#include "light_volume.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

/* Samples of a cell, at different heights. */
const int samples = 6;
const float near_m = 0.0; /* all detail */

void main() {
    ivec3 cell;
    int index;
    if (!volume_cell_here(cell, index)) {
        return;
    }
    volume_chance chance = volume_chance(uint(index), 0u);
    float sum_1_m = 0.0;
    for (int i = 0; i < samples; ++i) {
        float east = volume_draw(chance);
        float north = volume_draw(chance);
        float up = (float(i) + volume_draw(chance)) / float(samples);
        cloud_hit hit;
        hit.r = volume_point(vec3(cell) + vec3(east, north, up));
        velum_place here = place_of(hit.r);
        hit.normal = vec3(here.nx, here.ny, here.nz);
        hit.at_h_m = here.height_m;
        hit.rise = 0.0;
        hit.before_m = 0.5 * volume.north.w;
        hit.after_m = 0.5 * volume.north.w;
        hit.tile = tile_find(hit.normal, length(hit.r));
        for (uint rest = hit.tile.mask & volume.grid.w; rest != 0u; rest &= rest - 1u) {
            hit.slot = findLSB(rest);
            hit.part = hit.slot;
            cloud_fields(hit, true);
            hit.profile = velum_profile_of(hit.slot, hit.fields);
            cloud_look(hit, true, near_m, false);
            sum_1_m += hit.extinction_1_m;
        }
    }
    vec4 first = vec4(0.0, 0.0, 0.0, (1.0 - study_g_water) * sum_1_m / float(samples));
    volume_cells[VELUM_LIGHT_VOLUME_EVEN * volume_count() + index] = first;
    volume_cells[VELUM_LIGHT_VOLUME_ODD * volume_count() + index] = first;
    volume_cells[VELUM_LIGHT_VOLUME_FLUX * volume_count() + index] = vec4(0.0);
}
