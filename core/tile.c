#include "tile.h"

#include "geodesy.h"
#include "state_private.h"

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

typedef struct texel {
    uint16_t value[8]; /* A, B */
} texel;

enum { TEXEL_COVERAGE, TEXEL_BASE, TEXEL_TOP, TEXEL_EXTINCTION, TEXEL_WIND, TEXEL_KIND = 7 };

static texel make_texel(const float *field, const double normal[3], float undulation_m) {
    float scale = 1.0f / field[CORE_FIELD_COVERAGE];
    const float *wind = &field[CORE_FIELD_WIND_X];
    float up = wind[0] * (float)normal[0] + wind[1] * (float)normal[1] + wind[2] * (float)normal[2];
    float log2_extinction = field[CORE_FIELD_LOG_EXTINCTION] * scale * 1.4426950408889634f;
    texel out;
    out.value[TEXEL_COVERAGE] = unorm(fminf(field[CORE_FIELD_COVERAGE], 1.0f));
    out.value[TEXEL_BASE] = unorm(velum_texel_from_height(field[CORE_FIELD_BASE] * scale + undulation_m));
    out.value[TEXEL_TOP] = unorm(velum_texel_from_height(field[CORE_FIELD_TOP] * scale + undulation_m));
    out.value[TEXEL_EXTINCTION] = unorm(velum_clamp(
        (log2_extinction - VELUM_TEXEL_LOG2_EXTINCTION_MIN) / VELUM_TEXEL_LOG2_EXTINCTION_RANGE, 0.0f, 1.0f));
    for (uint32_t axis = 0; axis < 3; axis++) {
        out.value[TEXEL_WIND + axis] = unorm(velum_texel_from_wind((wind[axis] - up * (float)normal[axis]) * scale));
    }
    out.value[TEXEL_KIND] = unorm(velum_clamp(field[CORE_FIELD_KIND] * scale, 0.0f, 1.0f));
    return out;
}

typedef struct raster {
    uint32_t mask;
    uint8_t covered[VELUM_SLOT_COUNT][WIDE_COUNT];
    texel texels[VELUM_SLOT_COUNT][WIDE_COUNT];
} raster;

static void rasterise(const core_state *state, uint32_t key, raster *out) {
    uint32_t level = velum_tile_key_level(key);
    uint32_t face = velum_tile_key_face(key);
    double texel_m = core_tile_texel_m(level);
    double scale = 1.0 / ((double)VELUM_TILE_TEXELS * (double)(1u << level));
    double a[WIDE];
    double b[WIDE];
    for (int i = 0; i < WIDE; i++) {
        /* Whole numbers of half texels over a power of two: the same for every tile that has the place. */
        double u = (double)(2 * (int)(velum_tile_key_x(key) * VELUM_TILE_TEXELS) + 2 * (i - 1) - 1) * scale - 1.0;
        double v = (double)(2 * (int)(velum_tile_key_y(key) * VELUM_TILE_TEXELS) + 2 * (i - 1) - 1) * scale - 1.0;
        a[i] = tan(u * (CORE_PI / 4.0));
        b[i] = tan(v * (CORE_PI / 4.0));
    }
    out->mask = 0;
    memset(out->covered, 0, sizeof out->covered);
    for (uint32_t at = 0; at < WIDE_COUNT; at++) {
        core_blend blend;
        double normal[3];
        uint32_t i = at % WIDE;
        uint32_t j = at / WIDE;
        normal_of_tangents(face, a[i], b[j], normal);
        core_blend_at(state, normal, texel_m, false, &blend);
        for (uint32_t slot = 0; blend.mask >> slot; slot++) {
            if (blend.mask & (1u << slot) && blend.slot[slot][CORE_FIELD_COVERAGE] > 1e-12f) {
                texel made = make_texel(blend.slot[slot], normal, state->undulation_m);
                out->covered[slot][at] = 1;
                out->texels[slot][at] = made;
                if (made.value[TEXEL_COVERAGE] > 0 && i > 0 && i < WIDE - 1 && j > 0 && j < WIDE - 1) {
                    out->mask |= 1u << slot;
                }
            }
        }
    }
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
        uint32_t sum[8] = {0};
        uint32_t count = 0;
        for (int dj = -1; dj <= 1; dj++) {
            for (int di = -1; di <= 1; di++) {
                int i = at % WIDE + di;
                int j = at / WIDE + dj;
                if (i < 0 || i >= WIDE || j < 0 || j >= WIDE || covered[j * WIDE + i] != 1) {
                    continue;
                }
                for (uint32_t f = 1; f < 8; f++) {
                    sum[f] += texels[j * WIDE + i].value[f];
                }
                count++;
            }
        }
        if (count > 0) {
            texels[at].value[TEXEL_COVERAGE] = 0;
            for (uint32_t f = 1; f < 8; f++) {
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

static void store(core_tile_slot *slot, const texel *texels, uint16_t *a, uint16_t *b) {
    uint32_t coverage = 0;
    uint32_t base = 65535;
    uint32_t top = 0;
    uint32_t extinction = 0;
    for (uint32_t j = 0; j < SIDE; j++) {
        for (uint32_t i = 0; i < SIDE; i++) {
            const texel *from = &texels[(j + 1) * WIDE + i + 1];
            memcpy(a + (j * SIDE + i) * 4, &from->value[0], 4 * sizeof *a);
            memcpy(b + (j * SIDE + i) * 4, &from->value[4], 4 * sizeof *b);
            if (from->value[TEXEL_COVERAGE] > 0) {
                coverage = coverage > from->value[TEXEL_COVERAGE] ? coverage : from->value[TEXEL_COVERAGE];
                base = base < from->value[TEXEL_BASE] ? base : from->value[TEXEL_BASE];
                top = top > from->value[TEXEL_TOP] ? top : from->value[TEXEL_TOP];
                extinction = extinction > from->value[TEXEL_EXTINCTION] ? extinction : from->value[TEXEL_EXTINCTION];
            }
        }
    }
    slot->a = a;
    slot->b = b;
    slot->max_coverage = (float)coverage / 65535.0f;
    slot->min_base_m = velum_texel_height_m((float)base / 65535.0f);
    slot->max_top_m = velum_texel_height_m((float)top / 65535.0f);
    slot->max_extinction_1_m = velum_texel_extinction_1_m((float)extinction / 65535.0f);
}

core_tile *core_tile_create(const core_state *state, uint32_t key) {
    raster *made = malloc(sizeof *made);
    tile_block *block = NULL;
    uint32_t count = 0;
    if (!made) {
        return NULL;
    }
    rasterise(state, key, made);
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        count += made->mask >> slot & 1u;
    }
    size_t bytes = sizeof *block + (size_t)count * 2 * CORE_TILE_PAGE_BYTES;
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
                fill(made->covered[slot], made->texels[slot]);
                store(&block->tile.slot[slot], made->texels[slot], page, page + CORE_TILE_PAGE_VALUES);
                page += 2 * CORE_TILE_PAGE_VALUES;
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

velum_slot_fields core_tile_sample(const core_tile *tile, uint32_t slot, float s, float t) {
    const core_tile_slot *from = &tile->slot[slot];
    velum_slot_fields fields = {0};
    if (!from->a) {
        return fields;
    }
    float x = velum_clamp(s, 0.0f, 1.0f) * VELUM_TILE_TEXELS + 0.5f;
    float y = velum_clamp(t, 0.0f, 1.0f) * VELUM_TILE_TEXELS + 0.5f;
    uint32_t i = (uint32_t)fminf(x, SIDE - 2);
    uint32_t j = (uint32_t)fminf(y, SIDE - 2);
    float tx = x - (float)i;
    float ty = y - (float)j;
    float value[8];
    for (uint32_t f = 0; f < 8; f++) {
        const uint16_t *page = (f < 4 ? from->a : from->b) + f % 4;
        float v00 = page[(j * SIDE + i) * 4];
        float v10 = page[(j * SIDE + i + 1) * 4];
        float v01 = page[((j + 1) * SIDE + i) * 4];
        float v11 = page[((j + 1) * SIDE + i + 1) * 4];
        value[f] = velum_mix(velum_mix(v00, v10, tx), velum_mix(v01, v11, tx), ty) * (1.0f / 65535.0f);
    }
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
