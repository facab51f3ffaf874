#version 460
#extension GL_GOOGLE_include_directive : require
/* Of each cell of a volume of light, what comes to it of the sun. */
#include "air_light.glsl"
#include "light_volume.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;

const int rays = 4;
const int steps = 256;
/* As far as a low sun's way through cloud is followed. */
const float low_sun_m = 2.0e5;
/* Of a cell, where so many steps then come out of the cloud. */
const float step_share = 0.5;

void main() {
    ivec3 cell;
    int index;
    if (!volume_cell_here(cell, index)) {
        return;
    }
    vec3 to_sun = volume_east_north_up(eye.sun.xyz) / vec3(volume.east.ww, volume.north.w);
    float step_m = step_share / max(max(abs(to_sun.x), abs(to_sun.y)), abs(to_sun.z));
    float above = (volume.span.y - volume.span.x) / volume.north.w;
    float rows = to_sun.z > 0.0 ? above - float(cell.z) : float(cell.z) + 1.0;
    step_m = max(step_m, min(rows / max(abs(to_sun.z), 1.0e-9), low_sun_m) / float(steps));
    volume_chance chance = volume_chance(uint(index), 0u);
    float mean = 0.0;
    for (int i = 0; i < rays; ++i) {
        float east = volume_draw(chance);
        float north = volume_draw(chance);
        float up = (float(i) + volume_draw(chance)) / float(rays);
        vec3 place = vec3(cell) + vec3(east, north, up) + to_sun * (step_m * 0.5);
        float depth = 0.0;
        for (int k = 0; k < steps && place.z >= 0.0 && place.z < above; ++k) {
            depth += volume_cells[VELUM_LIGHT_VOLUME_EVEN * volume_count() + volume_index(ivec3(floor(place)))].w * step_m;
            place += to_sun * step_m;
        }
        mean += exp(-depth) / float(rays);
    }
    float height_m = volume.span.x + (float(cell.z) + 0.5) * volume.north.w;
    vec3 sun = eye.sun_lx.rgb * sun_through_air(height_m, dot(eye.up.xyz, eye.sun.xyz));
    volume_cells[VELUM_LIGHT_VOLUME_SUN * volume_count() + index] = vec4(sun * (mean * VELUM_INV_4PI), 0.0);
}
