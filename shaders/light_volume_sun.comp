#version 460
#extension GL_GOOGLE_include_directive : require
/* Of each cell of a volume of light, what comes to it of the sun. */
#include "air_light.glsl"
#include "light_volume.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

const int rays = 4;
const int steps = 4096;
const float dark = 20.0; /* optical depth at which a ray ends */

void main() {
    ivec3 cell;
    int index;
    if (!volume_cell_here(cell, index)) {
        return;
    }
    int count = volume_count();
    volume_box box = volume_box_at(index);
    bool cloud = volume_cell(VELUM_LIGHT_VOLUME_EVEN * count + index).w > 0.0;
    vec3 to_sun = volume_east_north_up(eye.sun.xyz) / vec3(volume.east.ww, volume.north.w);
    volume_chance chance = volume_chance(uint(index), 0u);
    float mean = 0.0;
    for (int i = 0; i < (cloud ? rays : 0); ++i) {
        volume_walk walk = volume_walk_from(cell, volume_start(cell, box, chance), to_sun);
        float depth = 0.0;
        for (int k = 0; k < steps && depth < dark && !volume_walk_ends(walk); ++k) {
            int at = volume_index(walk.cell);
            depth += volume_crossed(walk, at, volume_cell(VELUM_LIGHT_VOLUME_EVEN * count + at).w);
            walk = volume_walk_on(walk);
        }
        mean += exp(-depth) / float(rays);
    }
    float height_m = volume.span.x + (float(cell.z) + 0.5) * volume.north.w;
    vec3 sun = eye.sun_lx.rgb * sun_through_air(height_m, dot(eye.up.xyz, eye.sun.xyz));
    volume_cells[VELUM_LIGHT_VOLUME_SUN * count + index].xyz = sun * (mean * VELUM_INV_4PI);
}
