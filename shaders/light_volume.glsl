/* Light that cloud around the eye scatters more than once, in cells. Between cells it is scattered alike to all sides, by an
 * extinction that counts what goes on forward as not scattered (similarity: van de Hulst 1980, section 14.1); the sun's
 * beam that has not been so scattered is kept apart. Sideways the grid repeats itself. */
#ifndef VELUM_LIGHT_VOLUME_GLSL
#define VELUM_LIGHT_VOLUME_GLSL

#include "engine.glsl"
#include "shared/hash.h"
#include "shared/light_volume.h"
#include "shared/phase.h"

layout(set = 1, binding = VELUM_BIND_LIGHT_VOLUME, std430) buffer light_volume_buffer {
    velum_light_volume_block volume;
    vec4 volume_cells[];
};

int volume_count() {
    return int(volume.grid.x * volume.grid.x * volume.grid.y);
}
/* Which of the two that are written in turn is the newest before this pass. */
int volume_newest() {
    return int(volume.grid.z & 1u);
}

/* Of cells beside the grid: as if it went on from its other side. */
int volume_index(ivec3 cell) {
    ivec2 within = cell.xy & (int(volume.grid.x) - 1);
    int row = clamp(cell.z, 0, int(volume.grid.y) - 1);
    return (row * int(volume.grid.x) + within.y) * int(volume.grid.x) + within.x;
}

vec3 volume_east_north_up(vec3 v) {
    return vec3(dot(v, volume.east.xyz), dot(v, volume.north.xyz), dot(v, eye.up.xyz));
}

/* Of a place in cells, from the grid's corner. */
vec3 volume_place(vec3 r, float height_m) {
    vec2 aside = volume_east_north_up(r).xy / volume.east.w + 0.5 * float(volume.grid.x);
    return vec3(aside, (height_m - volume.span.x) / volume.north.w);
}
/* From the eye. */
vec3 volume_point(vec3 place) {
    vec2 aside_m = (place.xy - 0.5 * float(volume.grid.x)) * volume.east.w;
    float falls_m = dot(aside_m, aside_m) / (2.0 * VELUM_WGS84_A_M);
    float up_m = volume.span.x + place.z * volume.north.w - eye.up.w - falls_m;
    return volume.east.xyz * aside_m.x + volume.north.xyz * aside_m.y + eye.up.xyz * up_m;
}

/* The cell that an invocation is for; false: none. */
bool volume_cell_here(out ivec3 cell, out int index) {
    int side = int(volume.grid.x);
    ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    cell = ivec3(at.x, at.y % side, at.y / side);
    index = volume_index(cell);
    return at.x < side && at.y < side * int(volume.grid.y);
}

/* Numbers by chance for a cell, the same at every run. */
struct volume_chance {
    uint cell, next;
};
float volume_draw(inout volume_chance chance) {
    return velum_hash_unit(velum_hash_2(chance.cell, chance.next++));
}

#endif
