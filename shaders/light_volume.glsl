/* Light that cloud around the eye scatters more than once, in cells. Between cells it is scattered alike to all sides, by an
 * extinction that counts what goes on forward as not scattered (similarity: van de Hulst 1980, section 14.1); the sun's
 * beam that has not been so scattered is kept apart. Of a cell the cloud fills a box, evenly: spread over all of it, cloud
 * would let through what it throws back. Sideways the grid repeats itself. */
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
/* The same to read, which is quicker. Of what a running pass writes nothing is used. */
layout(set = 1, binding = VELUM_BIND_LIGHT_VOLUME_TEXELS) uniform samplerBuffer volume_texels;
vec4 volume_cell(int at) {
    return texelFetch(volume_texels, VELUM_LIGHT_VOLUME_HEAD + at);
}

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

/* Where a cell's cloud is, in shares of its sides. */
struct volume_box {
    vec3 low, high;
};
const float box_marks = 63.0; /* three counts of them are a whole number that a float holds */
float volume_pack(vec3 shares) {
    uvec3 marks = uvec3(round(shares * box_marks));
    return float(marks.x | marks.y << 6 | marks.z << 12);
}
vec3 volume_unpack(float packed_shares) {
    return vec3(uvec3(packed_shares) >> uvec3(0u, 6u, 12u) & 63u) / box_marks;
}
volume_box volume_box_at(int at) {
    return volume_box(volume_unpack(volume_cell(VELUM_LIGHT_VOLUME_SUN * volume_count() + at).w),
                      volume_unpack(volume_cell(VELUM_LIGHT_VOLUME_FLUX * volume_count() + at).w));
}
vec3 volume_start(ivec3 cell, volume_box box, inout volume_chance chance) {
    float east = volume_draw(chance);
    float north = volume_draw(chance);
    float up = volume_draw(chance);
    return vec3(cell) + mix(box.low, box.high, vec3(east, north, up));
}

/* A ray's way, cell by cell. */
struct volume_walk {
    vec3 place, cells_1_m, leaves_m; /* where it started; cells a metre; where it leaves the column, line and row */
    ivec3 cell;
    float from_m, to_m; /* in this cell */
};
volume_walk volume_walk_from(ivec3 cell, vec3 place, vec3 cells_1_m) {
    volume_walk walk;
    walk.place = place;
    walk.cells_1_m = mix(cells_1_m, vec3(1.0e-9), lessThan(abs(cells_1_m), vec3(1.0e-9)));
    walk.cell = cell;
    walk.leaves_m = (vec3(cell) + step(0.0, walk.cells_1_m) - place) / walk.cells_1_m;
    walk.from_m = 0.0;
    walk.to_m = min(min(walk.leaves_m.x, walk.leaves_m.y), walk.leaves_m.z);
    return walk;
}
bool volume_walk_ends(volume_walk walk) {
    return walk.cell.z < 0 || walk.cell.z >= int(volume.grid.y);
}
volume_walk volume_walk_on(volume_walk walk) {
    bvec3 leaves = lessThanEqual(walk.leaves_m, vec3(walk.to_m));
    leaves.yz = bvec2(leaves.y && !leaves.x, leaves.z && !leaves.x && !leaves.y);
    walk.cell += ivec3(leaves) * ivec3(sign(walk.cells_1_m));
    walk.leaves_m += vec3(leaves) / abs(walk.cells_1_m);
    walk.from_m = walk.to_m;
    walk.to_m = min(min(walk.leaves_m.x, walk.leaves_m.y), walk.leaves_m.z);
    return walk;
}
/* Of the cell's cloud what the ray crosses, as optical depth of the transport. */
float volume_crossed(volume_walk walk, int at, float transport_1_m) {
    volume_box box = volume_box_at(at);
    vec3 sides = box.high - box.low;
    vec3 low_m = (vec3(walk.cell) + box.low - walk.place) / walk.cells_1_m;
    vec3 high_m = (vec3(walk.cell) + box.high - walk.place) / walk.cells_1_m;
    vec3 near_m = min(low_m, high_m);
    vec3 far_m = max(low_m, high_m);
    float from_m = max(max(max(near_m.x, near_m.y), near_m.z), walk.from_m);
    float to_m = min(min(min(far_m.x, far_m.y), far_m.z), walk.to_m);
    return transport_1_m * max(to_m - from_m, 0.0) / (sides.x * sides.y * sides.z);
}

#endif
