#include "tile.h"

#include "geodesy.h"
#include "state_private.h"
#include "tile_detail.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

#define SIDE VELUM_TILE_SIDE
/* One more ring than is stored, so that what fills empty texels of the apron does not depend on the tile. */
#define WIDE (SIDE + 2)
#define WIDE_COUNT (WIDE * WIDE)

typedef struct tile_block {
    core_tile tile;
    atomic_uint references;
    uint16_t pages[];
} tile_block;

double core_tile_texel_m(uint32_t level) {
    return (double)VELUM_TILE_FACE_M / VELUM_TILE_TEXELS / (double)(1u << level);
}

/* Of tangents a and b along the face's axes. */
static void normal_of_tangents(uint32_t face, double a, double b, double normal[3]) {
    double n[3];
    switch (face) {
    case 0: memcpy(n, (double[3]){1.0, a, b}, sizeof n); break;
    case 1: memcpy(n, (double[3]){-1.0, -a, b}, sizeof n); break;
    case 2: memcpy(n, (double[3]){-a, 1.0, b}, sizeof n); break;
    case 3: memcpy(n, (double[3]){a, -1.0, b}, sizeof n); break;
    case 4: memcpy(n, (double[3]){-b, a, 1.0}, sizeof n); break;
    default: memcpy(n, (double[3]){b, a, -1.0}, sizeof n); break;
    }
    double scale = 1.0 / sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int i = 0; i < 3; i++) {
        normal[i] = n[i] * scale;
    }
}

void core_face_normal(uint32_t face, double u, double v, double normal[3]) {
    normal_of_tangents(face, tan(u * (CORE_PI / 4.0)), tan(v * (CORE_PI / 4.0)), normal);
}

void core_tile_normal(uint32_t key, double s, double t, double normal[3]) {
    double scale = 2.0 / (double)(1u << velum_tile_key_level(key));
    core_face_normal(velum_tile_key_face(key), (velum_tile_key_x(key) + s) * scale - 1.0,
                     (velum_tile_key_y(key) + t) * scale - 1.0, normal);
}

uint32_t core_tile_ancestor(uint32_t key, uint32_t level) {
    uint32_t own = velum_tile_key_level(key);
    if (level >= own) {
        return key;
    }
    return velum_tile_key(level, velum_tile_key_face(key), velum_tile_key_x(key) >> (own - level),
                          velum_tile_key_y(key) >> (own - level));
}

/* ---------------------------------------------------------------- rasterising */

static uint16_t unorm(float x) {
    return (uint16_t)(x * 65535.0f + 0.5f);
}

enum { TEXEL_COVERAGE, TEXEL_BASE, TEXEL_TOP, TEXEL_EXTINCTION, TEXEL_WIND, TEXEL_KIND = 7 };
enum { TEXEL_SCUD = 8, TEXEL_TRANSITION, TEXEL_FALL, TEXEL_FALL_KIND, TEXEL_VALUES };

typedef struct texel {
    uint16_t value[TEXEL_VALUES]; /* A, B, fringe */
} texel;

static texel make_texel(uint32_t slot, const float *field, const double normal[3], float undulation_m) {
    float scale = 1.0f / field[CORE_FIELD_COVERAGE];
    const float *wind = &field[CORE_FIELD_WIND_X];
    float up = wind[0] * (float)normal[0] + wind[1] * (float)normal[1] + wind[2] * (float)normal[2];
    float log2_extinction = core_blend_log_extinction(slot, field) * scale * 1.4426950408889634f;
    texel out;
    out.value[TEXEL_COVERAGE] = unorm(velum_clamp(core_blend_coverage(slot, field), 0.0f, 1.0f));
    out.value[TEXEL_BASE] = unorm(velum_texel_from_height(field[CORE_FIELD_BASE] * scale + undulation_m));
    out.value[TEXEL_TOP] = unorm(velum_texel_from_height(core_blend_top(slot, field) * scale + undulation_m));
    out.value[TEXEL_EXTINCTION] = unorm(velum_clamp(
        (log2_extinction - VELUM_TEXEL_LOG2_EXTINCTION_MIN) / VELUM_TEXEL_LOG2_EXTINCTION_RANGE, 0.0f, 1.0f));
    for (uint32_t axis = 0; axis < 3; axis++) {
        out.value[TEXEL_WIND + axis] = unorm(velum_texel_from_wind((wind[axis] - up * (float)normal[axis]) * scale));
    }
    out.value[TEXEL_KIND] = unorm(velum_clamp(core_blend_kind(slot, field) * scale, 0.0f, 1.0f));
    float fall = field[CORE_FIELD_FALL];
    out.value[TEXEL_SCUD] = unorm(velum_clamp(core_blend_scud(slot, field) * scale, 0.0f, 1.0f));
    out.value[TEXEL_TRANSITION] =
        unorm(velum_clamp(field[CORE_FIELD_TRANSITION] * scale / VELUM_TEXEL_TRANSITION_RANGE_M, 0.0f, 1.0f));
    out.value[TEXEL_FALL] =
        unorm(velum_clamp(core_blend_fall(slot, field) * scale / VELUM_TEXEL_FALL_RANGE, 0.0f, 1.0f));
    out.value[TEXEL_FALL_KIND] = fall > 0.0f ? unorm(velum_clamp(field[CORE_FIELD_FALL_KIND] / fall, 0.0f, 1.0f)) : 0;
    return out;
}

/* Below a state's base level all but its regions is smooth: it is evaluated on that level's texels and interpolated.
 * The lattice belongs to state, face and level alone, so neighbours agree. */
#define LATTICE_SIDE (WIDE / 2 + 2)

typedef struct raster {
    uint32_t mask;
    uint32_t region_count;
    uint32_t *regions; /* that can reach the tile */
    bool has_polygon;  /* among them: only polygons ask for latitude and longitude */
    uint8_t covered[VELUM_SLOT_COUNT][WIDE_COUNT];
    texel texels[VELUM_SLOT_COUNT][WIDE_COUNT];
    core_blend lattice[LATTICE_SIDE * LATTICE_SIDE];
} raster;

/* Tangent of texel centre n, which may lie outside the face. Whole numbers over a power of two: the same for every tile
 * that has the place. */
static double texel_tangent(int32_t n, uint32_t level) {
    double u = (double)(2 * n + 1) / ((double)VELUM_TILE_TEXELS * (double)(1u << level)) - 1.0;
    return tan(u * (CORE_PI / 4.0));
}

/* Texel centre m of a level in the lattice of a coarser one: whole part and rest. */
static int32_t lattice_place(int32_t m, uint32_t steps, float *rest) {
    int32_t halves = (2 * m + 1) - (int32_t)(1u << steps);
    int32_t spacing = (int32_t)(2u << steps);
    int32_t whole = halves >= 0 ? halves / spacing : -((spacing - 1 - halves) / spacing);
    *rest = (float)(halves - whole * spacing) / (float)spacing;
    return whole;
}

static void mix_blends(const core_blend *const from[4], float tx, float ty, core_blend *out) {
    const float weight[4] = {(1.0f - tx) * (1.0f - ty), tx * (1.0f - ty), (1.0f - tx) * ty, tx * ty};
    out->mask = from[0]->mask | from[1]->mask | from[2]->mask | from[3]->mask;
    for (uint32_t slot = 0; out->mask >> slot; slot++) {
        if (!(out->mask & (1u << slot))) {
            continue;
        }
        memset(out->slot[slot], 0, sizeof out->slot[slot]);
        for (uint32_t k = 0; k < 4; k++) {
            if (from[k]->mask & (1u << slot)) {
                for (uint32_t f = 0; f < CORE_FIELD_COUNT; f++) {
                    out->slot[slot][f] += from[k]->slot[slot][f] * weight[k];
                }
            }
        }
    }
}

static bool find_regions(const core_state *state, const core_tile_cap *cap, raster *out) {
    uint32_t room = state->cell_count - state->first_region;
    out->region_count = 0;
    out->has_polygon = false;
    out->regions = malloc((room + 1u) * sizeof *out->regions);
    if (!out->regions) {
        return false;
    }
    for (uint32_t c = state->first_region; c < state->cell_count; c++) {
        if (core_cell_touches(state->cells[c], cap)) {
            out->regions[out->region_count++] = c;
            out->has_polygon |= state->cells[c]->polygon != NULL;
        }
    }
    return true;
}

static void take_texel(raster *out, uint32_t at, const core_blend *blend, const double normal[3], float undulation_m) {
    uint32_t i = at % WIDE;
    uint32_t j = at / WIDE;
    for (uint32_t slot = 0; blend->mask >> slot; slot++) {
        if (blend->mask & (1u << slot) && blend->slot[slot][CORE_FIELD_COVERAGE] > 1e-12f) {
            texel made = make_texel(slot, blend->slot[slot], normal, undulation_m);
            out->covered[slot][at] = 1;
            out->texels[slot][at] = made;
            if (made.value[TEXEL_COVERAGE] > 0 && i > 0 && i < WIDE - 1 && j > 0 && j < WIDE - 1) {
                out->mask |= 1u << slot;
            }
        }
    }
}

/* The base over the tile: steps levels coarser, `width` lattice points a row from (x, y). */
typedef struct lattice {
    uint32_t steps;
    int32_t x, y, width, height;
} lattice;

static lattice make_lattice(const core_state *state, uint32_t face, uint32_t level, int32_t first_x, int32_t first_y,
                            raster *out) {
    lattice made = {.steps = level > state->base_level ? level - state->base_level : 0};
    float rest;
    if (made.steps == 0) {
        return made;
    }
    made.x = lattice_place(first_x, made.steps, &rest);
    made.y = lattice_place(first_y, made.steps, &rest);
    made.width = lattice_place(first_x + WIDE - 1, made.steps, &rest) - made.x + 2;
    made.height = lattice_place(first_y + WIDE - 1, made.steps, &rest) - made.y + 2;
    for (int32_t at = 0; at < made.width * made.height; at++) {
        double normal[3];
        normal_of_tangents(face, texel_tangent(made.x + at % made.width, state->base_level),
                           texel_tangent(made.y + at / made.width, state->base_level), normal);
        core_blend_base_at(state, normal, core_normal_lat_deg(normal), core_normal_lon_deg(normal),
                           core_tile_texel_m(state->base_level), false, &out->lattice[at]);
    }
    return made;
}

static bool rasterise(const core_state *state, uint32_t key, raster *out) {
    uint32_t level = velum_tile_key_level(key);
    uint32_t face = velum_tile_key_face(key);
    int32_t first_x = (int32_t)(velum_tile_key_x(key) * VELUM_TILE_TEXELS) - 2;
    int32_t first_y = (int32_t)(velum_tile_key_y(key) * VELUM_TILE_TEXELS) - 2;
    double texel_m = core_tile_texel_m(level);
    double a[WIDE];
    double b[WIDE];
    core_tile_cap cap = core_tile_cap_of(key);
    cap.radius_m += 3.0 * texel_m;
    if (!find_regions(state, &cap, out)) {
        return false;
    }
    for (int32_t i = 0; i < WIDE; i++) {
        a[i] = texel_tangent(first_x + i, level);
        b[i] = texel_tangent(first_y + i, level);
    }
    lattice base = make_lattice(state, face, level, first_x, first_y, out);
    out->mask = 0;
    memset(out->covered, 0, sizeof out->covered);
    for (int32_t at = 0; at < WIDE_COUNT; at++) {
        core_blend blend;
        double normal[3];
        double lat_deg = 0.0;
        double lon_deg = 0.0;
        normal_of_tangents(face, a[at % WIDE], b[at / WIDE], normal);
        if (base.steps == 0 || out->has_polygon) {
            lat_deg = core_normal_lat_deg(normal);
            lon_deg = core_normal_lon_deg(normal);
        }
        if (base.steps == 0) {
            core_blend_base_at(state, normal, lat_deg, lon_deg, texel_m, false, &blend);
        } else {
            float tx;
            float ty;
            int32_t x = lattice_place(first_x + at % WIDE, base.steps, &tx) - base.x;
            int32_t y = lattice_place(first_y + at / WIDE, base.steps, &ty) - base.y;
            const core_blend *from = &out->lattice[y * base.width + x];
            mix_blends((const core_blend *[4]){from, from + 1, from + base.width, from + base.width + 1}, tx, ty,
                       &blend);
        }
        for (uint32_t r = 0; r < out->region_count; r++) {
            core_blend_region(state->cells[out->regions[r]], normal, lat_deg, lon_deg, texel_m, false, &blend);
        }
        take_texel(out, (uint32_t)at, &blend, normal, state->undulation_m);
    }
    free(out->regions);
    return true;
}

/* Texels without cloud take the other fields from their covered neighbours, so that interpolation towards them changes
 * coverage alone; farther ones from the nearest. */
static void fill(uint8_t *covered, texel *texels) {
    uint16_t queue[WIDE_COUNT];
    uint32_t head = 0;
    uint32_t tail = 0;
    for (int at = 0; at < WIDE_COUNT; at++) {
        if (covered[at]) {
            continue;
        }
        uint32_t sum[TEXEL_VALUES] = {0};
        uint32_t count = 0;
        for (int dj = -1; dj <= 1; dj++) {
            for (int di = -1; di <= 1; di++) {
                int i = at % WIDE + di;
                int j = at / WIDE + dj;
                if (i < 0 || i >= WIDE || j < 0 || j >= WIDE || covered[j * WIDE + i] != 1) {
                    continue;
                }
                for (uint32_t f = 1; f < TEXEL_VALUES; f++) {
                    sum[f] += texels[j * WIDE + i].value[f];
                }
                count++;
            }
        }
        if (count > 0) {
            texels[at].value[TEXEL_COVERAGE] = 0;
            for (uint32_t f = 1; f < TEXEL_VALUES; f++) {
                texels[at].value[f] = (uint16_t)((sum[f] + count / 2) / count);
            }
            covered[at] = 2;
            queue[tail++] = (uint16_t)at;
        }
    }
    while (head < tail) {
        int at = queue[head++];
        static const int step_i[4] = {-1, 1, 0, 0};
        static const int step_j[4] = {0, 0, -1, 1};
        for (uint32_t k = 0; k < 4; k++) {
            int i = at % WIDE + step_i[k];
            int j = at / WIDE + step_j[k];
            int to = j * WIDE + i;
            if (i >= 0 && i < WIDE && j >= 0 && j < WIDE && !covered[to]) {
                texels[to] = texels[at];
                covered[to] = 3;
                queue[tail++] = (uint16_t)to;
            }
        }
    }
}

static core_look look_of(const texel *from) {
    float wind2 = 0.0f;
    for (uint32_t axis = 0; axis < 3; axis++) {
        const float wind_m_s = velum_texel_wind_m_s(core_texel_unit(from->value[TEXEL_WIND + axis]));
        wind2 += wind_m_s * wind_m_s;
    }
    const float top_m = velum_texel_height_m(core_texel_unit(from->value[TEXEL_TOP]));
    return (core_look){
        {[CORE_LOOK_COVERAGE] = core_texel_unit(from->value[TEXEL_COVERAGE]),
         [CORE_LOOK_THICKNESS] = top_m - velum_texel_height_m(core_texel_unit(from->value[TEXEL_BASE])),
         [CORE_LOOK_EXTINCTION] = velum_texel_extinction_1_m(core_texel_unit(from->value[TEXEL_EXTINCTION])),
         [CORE_LOOK_KIND] = core_texel_unit(from->value[TEXEL_KIND]),
         [CORE_LOOK_WIND] = sqrtf(wind2)}};
}

static void store(core_tile_slot *slot, const texel *texels, uint16_t *a, uint16_t *b) {
    uint32_t base = 65535;
    uint32_t top = 0;
    slot->looks.least = slot->looks.most = look_of(&texels[WIDE + 1]);
    for (uint32_t j = 0; j < SIDE; j++) {
        for (uint32_t i = 0; i < SIDE; i++) {
            const texel *from = &texels[(j + 1) * WIDE + i + 1];
            memcpy(a + (j * SIDE + i) * 4, &from->value[0], 4 * sizeof *a);
            memcpy(b + (j * SIDE + i) * 4, &from->value[4], 4 * sizeof *b);
            if (from->value[TEXEL_COVERAGE] > 0) {
                base = base < from->value[TEXEL_BASE] ? base : from->value[TEXEL_BASE];
                top = top > from->value[TEXEL_TOP] ? top : from->value[TEXEL_TOP];
            }
            const core_look look = look_of(from);
            core_look_widen(&slot->looks, &(core_look_range){look, look});
        }
    }
    slot->a = a;
    slot->b = b;
    slot->min_base_m = velum_texel_height_m((float)base / 65535.0f);
    slot->max_top_m = velum_texel_height_m((float)top / 65535.0f);
}

static bool has_fringe(const texel *texels) {
    for (uint32_t at = 0; at < WIDE_COUNT; at++) {
        if (texels[at].value[TEXEL_SCUD] > 0 || texels[at].value[TEXEL_TRANSITION] > 0 ||
            texels[at].value[TEXEL_FALL] > 0) {
            return true;
        }
    }
    return false;
}

/* What rounding and filtering may add. */
#define FRINGE_SPARE_M 1.0f

static velum_span_m with_spare(velum_span_m span) {
    return (velum_span_m){span.low - FRINGE_SPARE_M, span.high + FRINGE_SPARE_M};
}

core_fringe_reach core_fringe_reach_of(float base_m, float top_m, velum_fringe g) {
    return (core_fringe_reach){
        .scud_m = {base_m - VELUM_SCUD_SHALLOW_M - VELUM_SCUD_DEEP_M * g.scud, base_m + VELUM_SCUD_OVER_M},
        .band_m = {base_m - g.transition_m, top_m + g.transition_m},
        .fall_m = {fmaxf(base_m - VELUM_FALL_REACH_M * g.fall, VELUM_FALL_FLOOR_M), base_m + VELUM_FALL_JOIN_MOST_M}};
}

/* Bounds hold between texels too: they are of fields that are mixed, not of what is made of each. */
static void store_fringe(core_tile_slot *slot, const texel *texels, uint16_t *fringe) {
    velum_span_m scud_m = {0};
    velum_span_m band_m = {0};
    velum_span_m fall_m = {0};
    float scud = 0.0f;
    float transition_m = 0.0f;
    float fall = 0.0f;
    float kind = 0.0f;
    for (uint32_t j = 0; j < SIDE; j++) {
        for (uint32_t i = 0; i < SIDE; i++) {
            const texel *from = &texels[(j + 1) * WIDE + i + 1];
            const uint16_t *v = &from->value[TEXEL_SCUD];
            memcpy(fringe + (j * SIDE + i) * 4, v, 4 * sizeof *fringe);
            velum_fringe g = velum_fringe_of_texel((float)v[0] / 65535.0f, (float)v[1] / 65535.0f,
                                                   (float)v[2] / 65535.0f, (float)v[3] / 65535.0f);
            const float base_m = velum_texel_height_m((float)from->value[TEXEL_BASE] / 65535.0f);
            const float top_m = velum_texel_height_m((float)from->value[TEXEL_TOP] / 65535.0f);
            const core_fringe_reach reach = core_fringe_reach_of(base_m, top_m, g);
            core_span_widen(&scud_m, reach.scud_m);
            core_span_widen(&band_m, reach.band_m);
            core_span_widen(&fall_m, reach.fall_m);
            scud = fmaxf(scud, g.scud);
            transition_m = fmaxf(transition_m, g.transition_m);
            fall = fmaxf(fall, g.fall);
            kind = fmaxf(kind, g.fall_kind);
        }
    }
    if (scud > 0.0f) {
        slot->hem_m = with_spare(scud_m);
        slot->max_scud_1_m =
            fminf(VELUM_SCUD_SHARE * slot->looks.most.value[CORE_LOOK_EXTINCTION], VELUM_SCUD_MOST_1_M);
    }
    if (transition_m > 0.0f) {
        core_span_widen(&slot->hem_m, with_spare(band_m));
        slot->max_band_1_m = VELUM_BAND_SHARE * slot->looks.most.value[CORE_LOOK_EXTINCTION];
    }
    if (fall > 0.0f) {
        slot->fall_m = with_spare(fall_m);
        slot->max_fall_1_m = velum_fall_most_1_m((velum_fringe){.fall = fall, .fall_kind = kind});
    }
    slot->fringe = fringe;
}

core_tile *core_tile_create(const core_state *state, uint32_t key) {
    raster *made = malloc(sizeof *made);
    tile_block *block = NULL;
    uint32_t count = 0;
    uint32_t fringes = 0; /* slots that have them */
    if (!made) {
        return NULL;
    }
    if (!rasterise(state, key, made)) {
        free(made);
        return NULL;
    }
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (made->mask & (1u << slot)) {
            fill(made->covered[slot], made->texels[slot]);
            bool fringed = has_fringe(made->texels[slot]);
            fringes |= (uint32_t)fringed << slot;
            count += fringed ? 3 : 2;
        }
    }
    size_t bytes = sizeof *block + (size_t)count * CORE_TILE_PAGE_BYTES;
    block = calloc(1, bytes);
    if (block) {
        uint16_t *page = block->pages;
        atomic_init(&block->references, 1);
        block->tile.key = key;
        block->tile.mask = made->mask;
        block->tile.state = state->id;
        block->tile.bytes = bytes;
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            if (made->mask & (1u << slot)) {
                store(&block->tile.slot[slot], made->texels[slot], page, page + CORE_TILE_PAGE_VALUES);
                page += 2 * CORE_TILE_PAGE_VALUES;
                if (fringes & (1u << slot)) {
                    store_fringe(&block->tile.slot[slot], made->texels[slot], page);
                    page += CORE_TILE_PAGE_VALUES;
                }
            }
        }
    }
    free(made);
    return block ? &block->tile : NULL;
}

core_tile *core_tile_ref(core_tile *tile) {
    if (tile) {
        atomic_fetch_add_explicit(&((tile_block *)tile)->references, 1, memory_order_relaxed);
    }
    return tile;
}

void core_tile_unref(core_tile *tile) {
    if (tile && atomic_fetch_sub_explicit(&((tile_block *)tile)->references, 1, memory_order_acq_rel) == 1) {
        free(tile);
    }
}

/* ---------------------------------------------------------------- reading */

/* Four channels at (s, t). */
static void sample_page(const uint16_t *texels, float s, float t, float value[4]) {
    float x = velum_clamp(s, 0.0f, 1.0f) * VELUM_TILE_TEXELS + 0.5f;
    float y = velum_clamp(t, 0.0f, 1.0f) * VELUM_TILE_TEXELS + 0.5f;
    uint32_t i = (uint32_t)fminf(x, SIDE - 2);
    uint32_t j = (uint32_t)fminf(y, SIDE - 2);
    float tx = x - (float)i;
    float ty = y - (float)j;
    for (uint32_t f = 0; f < 4; f++) {
        const uint16_t *page = texels + f;
        float v00 = page[(j * SIDE + i) * 4];
        float v10 = page[(j * SIDE + i + 1) * 4];
        float v01 = page[((j + 1) * SIDE + i) * 4];
        float v11 = page[((j + 1) * SIDE + i + 1) * 4];
        value[f] = velum_mix(velum_mix(v00, v10, tx), velum_mix(v01, v11, tx), ty) * (1.0f / 65535.0f);
    }
}

velum_fringe core_tile_fringe(const core_tile *tile, uint32_t slot, float s, float t) {
    float value[4] = {0};
    if (tile->slot[slot].fringe) {
        sample_page(tile->slot[slot].fringe, s, t, value);
    }
    return velum_fringe_of_texel(value[0], value[1], value[2], value[3]);
}

velum_slot_fields core_tile_sample(const core_tile *tile, uint32_t slot, float s, float t) {
    const core_tile_slot *from = &tile->slot[slot];
    velum_slot_fields fields = {0};
    if (!from->a) {
        return fields;
    }
    float value[8];
    sample_page(from->a, s, t, value);
    sample_page(from->b, s, t, value + 4);
    fields.coverage = value[TEXEL_COVERAGE];
    fields.base_m = velum_texel_height_m(value[TEXEL_BASE]);
    fields.top_m = velum_texel_height_m(value[TEXEL_TOP]);
    fields.extinction_1_m = velum_texel_extinction_1_m(value[TEXEL_EXTINCTION]);
    fields.wind_x_m_s = velum_texel_wind_m_s(value[TEXEL_WIND]);
    fields.wind_y_m_s = velum_texel_wind_m_s(value[TEXEL_WIND + 1]);
    fields.wind_z_m_s = velum_texel_wind_m_s(value[TEXEL_WIND + 2]);
    fields.kind = value[TEXEL_KIND];
    return fields;
}
