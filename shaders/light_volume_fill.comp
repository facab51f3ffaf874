#version 460
#extension GL_GOOGLE_include_directive : require
/* Of each cell of a volume of light, how dense its cloud is for light that is on its way to all sides, and where. */
#include "weather.glsl"
#include "cloud_hit.glsl"
#include "light_volume.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

const ivec3 samples = ivec3(4, 4, 3); /* of a cell, each for a part of it */
const float near_m = 0.0;             /* all detail */

void main() {
    ivec3 cell;
    int index;
    if (!volume_cell_here(cell, index)) {
        return;
    }
    volume_chance chance = volume_chance(uint(index), 0u);
    int count = samples.x * samples.y * samples.z;
    float sum_1_m = 0.0;
    vec3 sum_at = vec3(0.0);
    vec3 sum_at_2 = vec3(0.0);
    for (int i = 0; i < count; ++i) {
        ivec3 part = ivec3(i % samples.x, i / samples.x % samples.y, i / (samples.x * samples.y));
        vec3 at = volume_start(part, volume_box(vec3(0.0), vec3(1.0)), chance) / vec3(samples);
        vec3 middle = (vec3(part) + 0.5) / vec3(samples);
        cloud_hit hit;
        hit.r = volume_point(vec3(cell) + at);
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
            sum_at += hit.extinction_1_m * middle;
            sum_at_2 += hit.extinction_1_m * middle * middle;
        }
    }
    /* The box that has the same mean place and spread, where each part is filled evenly. */
    const vec3 part_spread_2 = 1.0 / (12.0 * vec3(samples * samples));
    float whole_1_m = max(sum_1_m, 1.0e-12);
    vec3 middle = sum_at / whole_1_m;
    vec3 spread = sqrt(3.0 * (max(sum_at_2 / whole_1_m - middle * middle, vec3(0.0)) + part_spread_2));
    vec3 low = clamp(middle - spread, 0.0, 1.0);
    vec3 high = clamp(middle + spread, 0.0, 1.0);
    vec4 first = vec4(0.0, 0.0, 0.0, (1.0 - study_g_water) * sum_1_m / float(count));
    volume_cells[VELUM_LIGHT_VOLUME_EVEN * volume_count() + index] = first;
    volume_cells[VELUM_LIGHT_VOLUME_ODD * volume_count() + index] = first;
    volume_cells[VELUM_LIGHT_VOLUME_SUN * volume_count() + index] = vec4(0.0, 0.0, 0.0, volume_pack(low));
    volume_cells[VELUM_LIGHT_VOLUME_FLUX * volume_count() + index] = vec4(0.0, 0.0, 0.0, volume_pack(high));
}
