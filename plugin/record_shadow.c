/* Cloud shadow maps: planes across the sun, snapped to texels that are fixed to the world until the sun has turned. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "blocks.h"

/* The origin moves along the sun in steps of this, so that a climbing centre leaves the map as it is. */
#define ALONG_STEP_M 1024.0
#define DISTANCE_STEP_M 50000.0
#define DISTANCE_MAX_M 400000.0
/* A centre may wander so far, in shares of a level's side, before the level follows. */
#define SNAP_SHARE 16u
/* While time goes on, in steps up to this, a level is renewed by turns, a band of rows in a frame: in so much time the
 * finest, and each other in 4 times as much, as the wind takes so much longer to cross its texels; within BANDS frames
 * or one more where time goes faster, or has come to rest. */
#define BAND_LAG_S 60.0
#define RENEWED_S 0.5
#define BANDS 16u
/* A sun or weather that changes faster than the clock renews it too: a turn to another sun once, a blend so often. */
#define BLEND_ROUNDS 8.0
/* The map's sun lags behind the frame's by up to so much (0.1 degrees: 24 s of the day; 9 m from 5 km of height), then
 * turns to it: what is drawn goes on. One that has turned further is another sun. */
#define SUN_LAG_RAD 0.00175
#define SUN_TURN_RAD 0.0087
/* Of a level: its band, and the two strips that come into sight as it follows. */
#define RECTANGLES 3u
/* Of a texel's line on a GPU (segments.glsl): on an H200 a band takes a third of the time with 4, a fifth with 16. Each
 * has a step in a layer at least, where a software device has 8 and more in all. */
#define SEGMENTS 16u
_Static_assert(VELUM_GROUP *VELUM_GROUP % SEGMENTS == 0 && (SEGMENTS & (SEGMENTS - 1)) == 0, "see segments.glsl");

uint32_t shadow_segments(const gpu *g) {
    return gpu_is_software(g) ? 1 : SEGMENTS;
}

static double chord(const double a[3], const double b[3]) {
    const double d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return sqrt(dot3(d, d));
}

static double level_extent_m(const shadow *s, uint32_t level) {
    return s->extent_m * (double)(1u << (2 * level));
}

static double snap(double x, double step) {
    return floor(x / step + 0.5) * step;
}

static double texel_m(const shadow *s, uint32_t level) {
    return level_extent_m(s, level) / s->texels;
}

/* Where, along an axis across the sun, the corner of a level came to lie if the map turned about a place when the sun
 * did. */
static double corner_as_turned(const struct shadow_key *before, const struct shadow_key *now, const double about[3],
                               uint32_t level, int axis) {
    double from[2][3], to[2][3];
    axes_across(before->sun, from[0], from[1]);
    axes_across(now->sun, to[0], to[1]);
    return before->corner[level][axis] + dot3(about, to[axis]) - dot3(about, from[axis]);
}

/* A map that turns keeps its texels where they are about its centre: `key` gets the phase of each level's grid. */
static void turn_grid(const shadow *s, const double centre[3], struct shadow_key *key) {
    for (uint32_t k = 0; k < s->levels; k++) {
        for (int i = 0; i < 2; i++) {
            key->phase[k][i] = fmod(corner_as_turned(&s->key, key, centre, k, i), texel_m(s, k));
        }
    }
}

/* Where the levels lie for the key's sun and grid, and what the host is told. */
static void place(const shadow *s, const double centre[3], struct shadow_key *key, velum_shadow_geometry *geometry) {
    double axes[3][3]; /* u, v, sun */
    axes_across(key->sun, axes[0], axes[1]);
    memcpy(axes[2], key->sun, sizeof axes[2]);
    double across_m = s->extent_m / s->texels * (double)(s->texels / SNAP_SHARE);
    double at[3];
    for (int i = 0; i < 3; i++) {
        at[i] = snap(dot3(centre, axes[i]), i == 2 ? ALONG_STEP_M : across_m);
    }
    *geometry = (velum_shadow_geometry){.struct_size = sizeof *geometry, .levels = s->levels, .texels = s->texels};
    for (int i = 0; i < 3; i++) {
        key->origin[i] = at[0] * axes[0][i] + at[1] * axes[1][i] + at[2] * axes[2][i];
        geometry->origin_ecef_m[i] = key->origin[i];
        geometry->block.axis_u[i] = (float)axes[0][i];
        geometry->block.axis_v[i] = (float)axes[1][i];
        geometry->block.sun[i] = (float)key->sun[i];
    }
    geometry->block.axis_u[3] = (float)s->levels;
    geometry->block.axis_v[3] = (float)s->texels;
    for (uint32_t k = 0; k < s->levels; k++) {
        double extent_m = level_extent_m(s, k);
        geometry->block.level[k][0] = (float)extent_m;
        for (int i = 0; i < 2; i++) {
            const double middle_m = dot3(centre, axes[i]) - key->phase[k][i];
            double corner_m = snap(middle_m - 0.5 * extent_m, extent_m / SNAP_SHARE) + key->phase[k][i];
            key->corner[k][i] = corner_m;
            geometry->block.level[k][1 + i] = (float)((at[i] - corner_m) / extent_m);
        }
    }
}

/* How far from the origin the lines of the widest level meet the cloud. */
static double reach_m(const shadow *s, const double origin[3], const double sun[3]) {
    double radius = sqrt(dot3(origin, origin));
    double sine = fmax(dot3(origin, sun) / radius, 0.05);
    double reach = 0.7072 * level_extent_m(s, s->levels - 1) / sine + 15000.0 / sine;
    return fmin(ceil(reach / DISTANCE_STEP_M) * DISTANCE_STEP_M, DISTANCE_MAX_M);
}

static bool write_set(engine *e, const shadow *s, VkDescriptorSet *out) {
    if (!frame_set(e, e->passes.set_shadow, out)) {
        return false;
    }
    const VkDescriptorBufferInfo block = {e->uniforms.buffer, 0, sizeof(velum_shadow_level_block)};
    const VkDescriptorImageInfo image = {VK_NULL_HANDLE, s->image.view, VK_IMAGE_LAYOUT_GENERAL};
    const VkWriteDescriptorSet writes[2] = {{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                             .dstSet = *out,
                                             .dstBinding = VELUM_BIND_SHADOW_LEVEL,
                                             .descriptorCount = 1,
                                             .descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC,
                                             .pBufferInfo = &block},
                                            {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                             .dstSet = *out,
                                             .dstBinding = VELUM_BIND_SHADOW_OUT,
                                             .descriptorCount = 1,
                                             .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                                             .pImageInfo = &image}};
    e->g.UpdateDescriptorSets(e->g.device, 2, writes, 0, NULL);
    return true;
}

typedef struct rectangle {
    uint32_t level, x, y, width, height; /* texels */
} rectangle;

static velum_shadow_level_block level_block(const shadow *s, const velum_shadow_geometry *geometry,
                                            const struct shadow_key *key, const rectangle *r) {
    velum_shadow_level_block b = {.window = {r->x, r->y, r->width, r->height}};
    double u[3], v[3];
    axes_across(key->sun, u, v);
    double from_u_m = key->corner[r->level][0] - dot3(key->origin, u);
    double from_v_m = key->corner[r->level][1] - dot3(key->origin, v);
    for (int i = 0; i < 3; i++) {
        b.axis_u[i] = geometry->block.axis_u[i];
        b.axis_v[i] = geometry->block.axis_v[i];
        b.origin[i] = (float)(from_u_m * u[i] + from_v_m * v[i]);
    }
    b.axis_u[3] = (float)texel_m(s, r->level);
    b.axis_v[3] = (float)s->texels;
    b.origin[3] = (float)r->level;
    return b;
}

static velum_result draw(shadow *s, VkCommandBuffer commands, const velum_shadow_geometry *geometry,
                         const struct shadow_key *key, const rectangle *rectangles, uint32_t count) {
    engine *e = s->e;
    gpu *g = &e->g;
    velum_eye_block block;
    VkDescriptorSet sets[2];
    uint32_t offsets[3];
    const velum_shadow_block none = {0};
    if (!blocks_fill_eye(e, &s->tiles, key->origin, NULL, &block)) {
        return log_fail(&e->sink, VELUM_ERROR_ARGUMENT, "shadow",
                        "record_shadow: frame.centre_ecef_m: no place on the earth");
    }
    for (int i = 0; i < 3; i++) {
        block.sun[i] = (float)key->sun[i];
    }
    const pass which = (pass)(PASS_SHADOW + (blocks_mix(e) ? PASS_MIXED : 0) + (block.table[3] ? PASS_FRINGED : 0) +
                              (s->tiles.uneven ? PASS_UNEVEN : 0));
    if (!pipelines_need(&e->passes, g, &which, 1) || !frame_engine_set(e, &e->glow, &sets[0]) ||
        !write_set(e, s, &sets[1])) {
        return gpu_result(g);
    }
    if (!frame_uniform(e, &block, sizeof block, &offsets[0]) || !frame_uniform(e, &none, sizeof none, &offsets[1])) {
        return VELUM_ERROR_OUT_OF_MEMORY;
    }
    uint32_t blocks[SHADOW_LEVELS_MAX * RECTANGLES];
    for (uint32_t i = 0; i < count; i++) {
        velum_shadow_level_block level = level_block(s, geometry, key, &rectangles[i]);
        if (!frame_uniform(e, &level, sizeof level, &blocks[i])) {
            return VELUM_ERROR_OUT_OF_MEMORY;
        }
    }
    gpu_image_make_general(g, commands, &s->image);
    uint32_t query = e->now->shadow_queries < sizeof e->now->shadow_query / sizeof e->now->shadow_query[0]
                         ? frame_queries(e, 2)
                         : FRAME_QUERIES;
    if (query < FRAME_QUERIES) {
        e->now->shadow_query[e->now->shadow_queries++] = query;
    }
    frame_timestamp(e, commands, query);
    /* Whoever sampled the map before, in whatever stage, has done so. */
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    const uint32_t segments = shadow_segments(g);
    for (uint32_t i = 0; i < count; i++) {
        offsets[2] = blocks[i];
        g->CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.layout_shadow, 0, 2, sets, 3,
                                 offsets);
        record_layers(e, commands, which, rectangles[i].width, rectangles[i].height, segments);
        s->texels_drawn += (uint64_t)rectangles[i].width * rectangles[i].height;
    }
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    frame_timestamp(e, commands, query < FRAME_QUERIES ? query + 1 : FRAME_QUERIES);
    return VELUM_OK;
}

/* A little, and forward; the weather is that of before, and the sun nearly. */
static bool follows(const struct shadow_key *before, const struct shadow_key *now) {
    double step_s = now->time_s - before->time_s;
    double axes[2][2][3];
    axes_across(before->sun, axes[0][0], axes[0][1]);
    axes_across(now->sun, axes[1][0], axes[1][1]);
    return chord(before->sun, now->sun) <= SUN_TURN_RAD && chord(axes[0][0], axes[1][0]) <= SUN_TURN_RAD &&
           memcmp(before->state, now->state, sizeof now->state) == 0 && step_s >= 0.0 && step_s <= BAND_LAG_S;
}

/* Rows that a level has drawn anew in this frame, of `share` that falls due of it. */
static uint32_t band_rows(shadow *s, uint32_t k, bool rests, double share) {
    shadow_level *level = &s->level[k];
    const uint32_t unit = s->texels < 128 ? 4 : VELUM_GROUP;
    const uint32_t most = (s->texels / BANDS + unit - 1) / unit * unit;
    level->due_rows = fmin(rests ? s->texels : level->due_rows + share * s->texels, level->stale_rows);
    uint32_t rows = (uint32_t)level->due_rows / unit * unit;
    rows = rows < most ? rows : most;
    rows = rows < s->texels - level->next_row ? rows : s->texels - level->next_row;
    level->due_rows -= rows;
    return rows;
}

/* What both maps have moves to its new place, through the spare image: a copy's ends must not overlap. */
static void move_level(shadow *s, VkCommandBuffer commands, uint32_t level, int32_t du, int32_t dv) {
    gpu *g = &s->e->g;
    VkImageCopy copy = {.srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, level, 1},
                        .srcOffset = {du > 0 ? du : 0, dv > 0 ? dv : 0, 0},
                        .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                        .extent = {s->texels - (uint32_t)abs(du), s->texels - (uint32_t)abs(dv), 1}};
    gpu_image_make_general(g, commands, &s->spare);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_TRANSFER_BIT,
                VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    g->CmdCopyImage(commands, s->image.image, VK_IMAGE_LAYOUT_GENERAL, s->spare.image, VK_IMAGE_LAYOUT_GENERAL, 1,
                    &copy);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    copy.srcSubresource.baseArrayLayer = 0;
    copy.srcOffset = (VkOffset3D){0, 0, 0};
    copy.dstSubresource.baseArrayLayer = level;
    copy.dstOffset = (VkOffset3D){du < 0 ? -du : 0, dv < 0 ? -dv : 0, 0};
    g->CmdCopyImage(commands, s->spare.image, VK_IMAGE_LAYOUT_GENERAL, s->image.image, VK_IMAGE_LAYOUT_GENERAL, 1,
                    &copy);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

/* What is to be drawn of a level that goes on from what it shows: a band of it, and what has come into sight. */
static uint32_t continue_level(shadow *s, VkCommandBuffer commands, const struct shadow_key *key,
                               const double centre[3], uint32_t level, uint32_t rows, rectangle *out) {
    double shift[2];
    for (int i = 0; i < 2; i++) {
        shift[i] = (key->corner[level][i] - corner_as_turned(&s->key, key, centre, level, i)) / texel_m(s, level);
    }
    const double u = shift[0], v = shift[1];
    if (fabs(u) >= s->texels || fabs(v) >= s->texels) {
        s->level[level] = (shadow_level){0};
        out[0] = (rectangle){level, 0, 0, s->texels, s->texels};
        return 1;
    }
    int32_t du = (int32_t)lround(u);
    int32_t dv = (int32_t)lround(v);
    if (dv != 0 && s->level[level].stale_rows > 0) {
        /* Those moved away from where the next bands will be. */
        s->level[level].stale_rows = s->texels;
    }
    uint32_t count = 0;
    if (rows > 0) {
        out[count++] = (rectangle){level, 0, s->level[level].next_row, s->texels, rows};
    }
    if (du != 0 || dv != 0) {
        move_level(s, commands, level, du, dv);
    }
    if (du != 0) {
        out[count++] = (rectangle){level, du > 0 ? s->texels - (uint32_t)du : 0, 0, (uint32_t)abs(du), s->texels};
    }
    if (dv != 0) {
        out[count++] = (rectangle){level, 0, dv > 0 ? s->texels - (uint32_t)dv : 0, s->texels, (uint32_t)abs(dv)};
    }
    return count;
}

velum_result record_shadow(shadow *s, VkCommandBuffer commands, const velum_shadow_frame *frame) {
    engine *e = s->e;
    checker check = {&e->sink, "shadow", "record_shadow", VELUM_OK};
    velum_shadow_frame f;
    if (e->state != ENGINE_SHARED || s->frame == e->frames) {
        check_fail(&check, VELUM_ERROR_STATE,
                   e->state != ENGINE_SHARED ? "record_shared comes first" : "called twice in a frame");
        return check.result;
    }
    if (!check_pointer(&check, "commands", commands) ||
        !check_in(&check, "frame", &f, sizeof f, frame, V1_SHADOW_FRAME) ||
        !check_flags(&check, "frame.flags", f.flags, 0) ||
        !check_position(&check, "frame.centre_ecef_m", f.centre_ecef_m)) {
        return check.result;
    }
    struct shadow_key key;
    velum_shadow_geometry geometry;
    memset(&key, 0, sizeof key);
    memcpy(key.sun, e->frame.sun_direction_ecef, sizeof key.sun);
    key.time_s = e->frame.time_s;
    key.blend = e->weather.blend;
    for (int i = 0; i < 2; i++) {
        key.state[i] = e->weather.state[i] ? core_state_id(e->weather.state[i]) : 0;
    }
    const bool goes_on = s->drawn && !s->incomplete && follows(&s->key, &key);
    if (goes_on && chord(key.sun, s->key.sun) <= SUN_LAG_RAD) {
        memcpy(key.sun, s->key.sun, sizeof key.sun);
        memcpy(key.phase, s->key.phase, sizeof key.phase);
    } else if (goes_on) {
        turn_grid(s, f.centre_ecef_m, &key);
    }
    place(s, f.centre_ecef_m, &key, &geometry);
    s->frame = e->frames;
    uint32_t stale_rows = 0;
    for (uint32_t k = 0; k < s->levels; k++) {
        stale_rows += s->level[k].stale_rows;
    }
    if (goes_on && stale_rows == 0 && memcmp(&key, &s->key, sizeof key) == 0) {
        return VELUM_UNCHANGED;
    }
    const double step_s = key.time_s - s->key.time_s;
    const double turned =
        chord(key.sun, s->key.sun) / SUN_TURN_RAD + BLEND_ROUNDS * fabs((double)key.blend - (double)s->key.blend);
    const bool changes = !goes_on || step_s != 0.0 || turned > 0.0;
    VkBufferCopy copy;
    uint32_t budget = e->owner ? UINT32_MAX : RENDER_TILES;
    tiles_context context = record_tiles_context(e, &budget, &copy, 1);
    velum_result standing = tiles_update(&s->tiles, &context, key.origin, reach_m(s, key.origin, key.sun));
    record_uploads(e, commands, &context);
    if (standing < 0) {
        return standing;
    }
    rectangle rectangles[SHADOW_LEVELS_MAX * RECTANGLES];
    uint32_t count = 0;
    for (uint32_t k = 0; k < s->levels; k++) {
        shadow_level *level = &s->level[k];
        if (!goes_on) {
            *level = (shadow_level){0};
            rectangles[count++] = (rectangle){k, 0, 0, s->texels, s->texels};
            continue;
        }
        level->stale_rows = changes ? s->texels : level->stale_rows;
        const double share = step_s / (RENEWED_S * (double)(1u << (2 * k))) + turned;
        const uint32_t rows = band_rows(s, k, step_s == 0.0, share);
        count += continue_level(s, commands, &key, f.centre_ecef_m, k, rows, &rectangles[count]);
        level->stale_rows -= level->stale_rows < rows ? level->stale_rows : rows;
        level->next_row = (level->next_row + rows) % s->texels;
    }
    velum_result result = draw(s, commands, &geometry, &key, rectangles, count);
    if (result < 0) {
        s->drawn = false;
        return result;
    }
    s->key = key;
    s->geometry = geometry;
    s->drawn = true;
    s->incomplete = standing == VELUM_INCOMPLETE;
    s->last_serial = e->newest_serial;
    e->newest_shadow = s;
    return standing;
}
