#include "oracle_cursor.h"

#include <math.h>
#include <string.h>

#include "geodesy.h"
#include "shared/tile_address.h"

/* Beyond this from where its phases were formed, noise is found from a new origin: floats stay within millimetres. */
#define NOISE_REACH_M 16000.0
#define NO_QUAD UINT32_MAX
/* So far, at most, is passed over borders of tiles by what those have: heights change by about a metre a metre. */
#define OVER_BORDERS_M 25.0
/* The least that a texel measures of its nominal size: at the middle of a face's side, 1 / sqrt 2. */
#define NARROWEST 0.7

void oracle_cursor_init(oracle_cursor *cursor, const core_oracle *oracle, double footprint_m) {
    memset(cursor, 0, sizeof *cursor);
    cursor->oracle = oracle;
    cursor->distance_m = fmin(fmax(footprint_m / CORE_ORACLE_PIXEL_RAD, 0.0), 1e9);
    cursor->level = velum_tile_level((float)cursor->distance_m, oracle->detail);
    cursor->key = VELUM_TILE_KEY_NONE;
    cursor->data_key = VELUM_TILE_KEY_NONE;
}

static void drop_tiles(oracle_cursor *cursor) {
    for (int s = 0; s < 2; s++) {
        core_tile_unref(cursor->tile[s]);
        cursor->tile[s] = NULL;
    }
}

void oracle_cursor_finish(oracle_cursor *cursor) {
    drop_tiles(cursor);
}

static bool blends(const core_oracle *oracle) {
    return oracle->state[0] != oracle->state[1];
}

static void take_tiles(oracle_cursor *cursor, uint32_t data_key) {
    const core_oracle *oracle = cursor->oracle;
    drop_tiles(cursor);
    cursor->data_key = data_key;
    cursor->quad = NO_QUAD;
    cursor->all = (velum_span_m){0};
    for (int s = 0; s < (blends(oracle) ? 2 : 1); s++) {
        if (!oracle->state[s]) {
            continue;
        }
        cursor->tile[s] = oracle->tile(oracle->tile_context, oracle->state[s], data_key);
        if (!cursor->tile[s]) {
            cursor->result = VELUM_ERROR_OUT_OF_MEMORY;
            return;
        }
        for (uint32_t slot = 0; cursor->tile[s]->mask >> slot; slot++) {
            if (cursor->tile[s]->mask & (1u << slot)) {
                core_span_widen(&cursor->all, core_tile_slot_span(&cursor->tile[s]->slot[slot]));
            }
        }
    }
}

/* The tile that holds the fields of both states, as core_tile_set_init chooses it. */
static uint32_t data_key_of(const core_oracle *oracle, uint32_t key) {
    uint32_t level = 0;
    for (int s = 0; s < (blends(oracle) ? 2 : 1); s++) {
        if (oracle->state[s]) {
            uint32_t own = core_tile_detail_level(oracle->state[s], key);
            level = own > level ? own : level;
        }
    }
    return core_tile_ancestor(key, level);
}

/* Height and normal by the scaled sphere (see core_height_scaled), as velum_place_at, in double. */
static void set_place(oracle_place *place, const double ecef_m[3]) {
    memcpy(place->ecef_m, ecef_m, sizeof place->ecef_m);
    place->height_m = core_height_scaled(ecef_m);
    double stretch = (CORE_WGS84_A_M + place->height_m) / (CORE_WGS84_A_M * (1.0 - CORE_WGS84_E2) + place->height_m);
    double z = ecef_m[2] * stretch;
    double norm = 1.0 / sqrt(fmax(ecef_m[0] * ecef_m[0] + ecef_m[1] * ecef_m[1] + z * z, 1.0));
    place->normal[0] = ecef_m[0] * norm;
    place->normal[1] = ecef_m[1] * norm;
    place->normal[2] = z * norm;
}

static bool has_fringe(const oracle_cursor *cursor, uint32_t slot) {
    return (cursor->tile[0] && cursor->tile[0]->slot[slot].fringe) ||
           (cursor->tile[1] && cursor->tile[1]->slot[slot].fringe);
}

/* Fields are mixed of the texels about a place: between those, what they span holds everything. What one of two states
 * alone has hangs from a base between both. */
static void take_spans(oracle_cursor *cursor, core_tile_quad quad) {
    cursor->quad = quad.texel;
    memset(cursor->span, 0, sizeof cursor->span);
    for (int s = 0; s < 2; s++) {
        for (uint32_t slot = 0; cursor->tile[s] && cursor->tile[s]->mask >> slot; slot++) {
            if (cursor->tile[s]->mask & (1u << slot)) {
                const velum_span_m span = core_tile_quad_span(cursor->tile[s], slot, quad);
                if (core_span_has_some(span)) {
                    core_span_widen(&cursor->span[slot], span);
                }
            }
        }
    }
    for (uint32_t slot = 0; blends(cursor->oracle) && slot < VELUM_SLOT_COUNT; slot++) {
        if (core_span_has_some(cursor->span[slot]) && has_fringe(cursor, slot)) {
            cursor->span[slot].low -= VELUM_SCUD_SHALLOW_M;
            cursor->span[slot].high += VELUM_FALL_JOIN_MOST_M;
        }
    }
}

static float edge_of(float x, float y) {
    const float over_x = velum_fract(x);
    const float over_y = velum_fract(y);
    return fminf(fminf(over_x, 1.0f - over_x), fminf(over_y, 1.0f - over_y));
}

oracle_place oracle_cursor_move(oracle_cursor *cursor, const double ecef_m[3]) {
    oracle_place place = {0};
    set_place(&place, ecef_m);
    velum_face_place face = velum_face_of((float)place.normal[0], (float)place.normal[1], (float)place.normal[2]);
    float x = velum_tile_coordinate(face.u, cursor->level);
    float y = velum_tile_coordinate(face.v, cursor->level);
    uint32_t key = velum_tile_key(cursor->level, (uint32_t)face.face, (uint32_t)x, (uint32_t)y);
    if (key != cursor->key && cursor->result == VELUM_OK) {
        uint32_t data_key = data_key_of(cursor->oracle, key);
        if (data_key != cursor->data_key) {
            take_tiles(cursor, data_key);
        }
        cursor->key = key;
    }
    if (cursor->result != VELUM_OK) {
        return place;
    }
    float scale = 1.0f / (float)(1u << (cursor->level - velum_tile_key_level(cursor->data_key)));
    place.s = velum_fract(x * scale);
    place.t = velum_fract(y * scale);
    const core_tile_quad quad = core_tile_quad_at(place.s, place.t);
    if (quad.texel != cursor->quad) {
        take_spans(cursor, quad);
    }
    cursor->same_m = NARROWEST * fmin((double)edge_of(x, y) * VELUM_TILE_TEXELS * core_tile_texel_m(cursor->level),
                                      (double)quad.edge * core_tile_texel_m(velum_tile_key_level(cursor->data_key)));

    double moved2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double moved = ecef_m[axis] - cursor->noise_origin_m[axis];
        moved2 += moved * moved;
    }
    if (!cursor->has_noise || moved2 > NOISE_REACH_M * NOISE_REACH_M) {
        memcpy(cursor->noise_origin_m, ecef_m, sizeof cursor->noise_origin_m);
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            cursor->noise[slot] = core_cloud_noise_at(cursor->oracle->noise, slot, ecef_m, &cursor->oracle->drift);
        }
        cursor->has_noise = true;
    }
    return place;
}

uint32_t oracle_cursor_mask(const oracle_cursor *cursor) {
    uint32_t mask = 0;
    for (int s = 0; s < 2 && cursor->result == VELUM_OK; s++) {
        mask |= cursor->tile[s] ? cursor->tile[s]->mask : 0u;
    }
    return mask;
}

velum_slot_fields oracle_cursor_fields(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot) {
    velum_slot_fields fields[2] = {{0}};
    for (int s = 0; s < 2; s++) {
        if (cursor->tile[s] && cursor->result == VELUM_OK) {
            fields[s] = core_tile_sample(cursor->tile[s], slot, place->s, place->t);
        }
    }
    return blends(cursor->oracle) ? velum_fields_mix(fields[0], fields[1], cursor->oracle->blend) : fields[0];
}

static velum_fringe fringe_at(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot) {
    velum_slot_fields fields[2] = {{0}};
    velum_fringe fringe[2] = {{0}};
    for (int s = 0; s < 2; s++) {
        if (cursor->tile[s]) {
            fields[s] = core_tile_sample(cursor->tile[s], slot, place->s, place->t);
            fringe[s] = core_tile_fringe(cursor->tile[s], slot, place->s, place->t);
        }
    }
    float share = blends(cursor->oracle) ? velum_fields_share(fields[0], fields[1], cursor->oracle->blend) : 0.0f;
    return velum_fringe_mix(fringe[0], fringe[1], share);
}

/* A place as the noise wants it. */
typedef struct noise_point {
    float point_m[3], normal[3];
    bool fine;
} noise_point;

static noise_point noise_point_of(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot) {
    const core_cloud_noise *noise = &cursor->noise[slot];
    noise_point p = {.fine =
                         velum_shows_fine((float)cursor->distance_m, noise->phases.fine[0][3], noise->fine_stretch)};
    for (int axis = 0; axis < 3; axis++) {
        p.point_m[axis] = (float)(place->ecef_m[axis] - cursor->noise_origin_m[axis]);
        p.normal[axis] = (float)place->normal[axis];
    }
    return p;
}

static bool is_within(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot) {
    return cursor->result == VELUM_OK && place->height_m >= (double)cursor->span[slot].low &&
           place->height_m <= (double)cursor->span[slot].high && core_span_has_some(cursor->span[slot]);
}

/* Below 0: within. */
static double away_m(velum_span_m span, const oracle_place *place) {
    return fmax((double)span.low - place->height_m, place->height_m - (double)span.high);
}

double oracle_cursor_clear_m(const oracle_cursor *cursor, const oracle_place *place) {
    double clear_m = cursor->same_m;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (core_span_has_some(cursor->span[slot])) {
            clear_m = fmin(clear_m, away_m(cursor->span[slot], place));
        }
    }
    const double all_m = core_span_has_some(cursor->all) ? away_m(cursor->all, place) : OVER_BORDERS_M;
    return fmax(clear_m, fmin(all_m, OVER_BORDERS_M));
}

oracle_extinction oracle_cursor_slot(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot) {
    oracle_extinction out = {0};
    if (!is_within(cursor, place, slot)) {
        return out;
    }
    const core_cloud_noise *noise = &cursor->noise[slot];
    const velum_slot_fields fields = oracle_cursor_fields(cursor, place, slot);
    const noise_point p = noise_point_of(cursor, place, slot);
    out.cloud_1_m = core_cloud_extinction(noise, &fields, p.point_m, p.normal, (float)place->height_m, p.fine);
    if (has_fringe(cursor, slot)) {
        const velum_fringe fringe = fringe_at(cursor, place, slot);
        out.fringe_1_m =
            core_cloud_fringe(noise, &fields, &fringe, p.point_m, p.normal, (float)place->height_m, p.fine);
    }
    return out;
}

float oracle_cursor_total(const oracle_cursor *cursor, const oracle_place *place) {
    float total = 0.0f;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        const oracle_extinction extinction = oracle_cursor_slot(cursor, place, slot);
        total += extinction.cloud_1_m + extinction.fringe_1_m;
    }
    return total;
}
