#include "noise_slope.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = CORE_NOISE_SHAPE_SIDE, MASK = SIDE - 1, VOLUME = SIDE * SIDE * SIDE };

/* Of a volume of side^3 that repeats. */
static int texel(const uint8_t *texels, uint32_t side, uint32_t x, uint32_t y, uint32_t z) {
    const uint32_t mask = side - 1;
    return texels[((z & mask) * side + (y & mask)) * side + (x & mask)];
}

/* Each component of the gradient of a trilinear cell is bilinear: its length, in steps over a texel, is greatest at a
 * corner. */
static float cell_slope(const uint8_t *texels, uint32_t side, uint32_t x, uint32_t y, uint32_t z) {
    int most = 0;
    for (uint32_t k = 0; k < 8; k++) {
        const uint32_t i = x + (k & 1);
        const uint32_t j = y + (k >> 1 & 1);
        const uint32_t l = z + (k >> 2);
        int a = texel(texels, side, x + 1, j, l) - texel(texels, side, x, j, l);
        int b = texel(texels, side, i, y + 1, l) - texel(texels, side, i, y, l);
        int c = texel(texels, side, i, j, z + 1) - texel(texels, side, i, j, z);
        int square = a * a + b * b + c * c;
        most = square > most ? square : most;
    }
    return sqrtf((float)most);
}

static void widen(const uint8_t *in, uint8_t *out, uint32_t stride) {
    for (uint32_t i = 0; i < VOLUME; i++) {
        const uint32_t along = i / stride & MASK;
        const uint32_t base = i - along * stride;
        uint8_t most = 0;
        for (uint32_t step = 0; step <= 2 * VELUM_SLOPE_CELLS; step++) {
            uint8_t one = in[base + ((along + step + SIDE - VELUM_SLOPE_CELLS) & MASK) * stride];
            most = one > most ? one : most;
        }
        out[i] = most;
    }
}

bool core_noise_slope(const core_noise *noise, uint8_t *out) {
    uint8_t *own = malloc(VOLUME);
    if (!own) {
        return false;
    }
    for (uint32_t i = 0; i < VOLUME; i++) {
        float slope = cell_slope(noise->shape, SIDE, i & MASK, i / SIDE & MASK, i / SIDE / SIDE);
        slope = ceilf(slope * ((float)SIDE / 255.0f / VELUM_SLOPE_UNIT));
        out[i] = slope < 255.0f ? (uint8_t)slope : 255;
    }
    widen(out, own, 1);
    widen(own, out, SIDE);
    widen(out, own, SIDE * SIDE);
    memcpy(out, own, VOLUME);
    free(own);
    return true;
}

enum { AWAY = VELUM_AWAY_SIDE, AWAY_MASK = AWAY - 1, AWAY_VOLUME = AWAY * AWAY * AWAY, FAR = 255 * 255 };

/* The greatest corner of the cells in and about each coarser one: distances count from a cell's nearest side. */
static void fill_highest(const core_noise *noise, uint8_t *out) {
    const uint32_t texels = SIDE / AWAY;
    for (uint32_t i = 0; i < AWAY_VOLUME; i++) {
        const uint32_t from[3] = {(i & AWAY_MASK) * texels + SIDE - texels,
                                  (i / AWAY & AWAY_MASK) * texels + SIDE - texels,
                                  i / AWAY / AWAY * texels + SIDE - texels};
        int most = 0;
        for (uint32_t z = 0; z <= 3 * texels; z++) {
            for (uint32_t y = 0; y <= 3 * texels; y++) {
                for (uint32_t x = 0; x <= 3 * texels; x++) {
                    int own = texel(noise->shape, SIDE, from[0] + x, from[1] + y, from[2] + z);
                    most = own > most ? own : most;
                }
            }
        }
        out[i] = (uint8_t)most;
    }
}

/* Squares of distances along one axis more (Saito & Toriwaki 1994). */
static void sweep(const uint16_t *in, uint16_t *out, uint32_t stride) {
    for (uint32_t i = 0; i < AWAY_VOLUME; i++) {
        const uint32_t along = i / stride & AWAY_MASK;
        const uint32_t base = i - along * stride;
        uint32_t best = in[i];
        for (uint32_t off = 1; off <= AWAY / 2 && off * off < best; off++) {
            uint32_t up = in[base + ((along + off) & AWAY_MASK) * stride] + off * off;
            uint32_t down = in[base + ((along - off) & AWAY_MASK) * stride] + off * off;
            best = up < best ? up : best;
            best = down < best ? down : best;
        }
        out[i] = (uint16_t)best;
    }
}

bool core_noise_away(const core_noise *noise, uint8_t *out) {
    uint8_t *high = malloc(AWAY_VOLUME);
    uint16_t *a = malloc(2 * sizeof *a * AWAY_VOLUME);
    if (!high || !a) {
        free(high);
        free(a);
        return false;
    }
    uint16_t *b = a + AWAY_VOLUME;
    fill_highest(noise, high);
    for (uint32_t level = 0; level < VELUM_AWAY_LEVELS; level++) {
        const float rank = velum_away_rank((int)level) - VELUM_SLOPE_SLACK;
        for (uint32_t i = 0; i < AWAY_VOLUME; i++) {
            a[i] = (float)high[i] >= rank * 255.0f ? 0 : FAR - 3 * AWAY * AWAY;
        }
        sweep(a, b, 1);
        sweep(b, a, AWAY);
        sweep(a, b, AWAY * AWAY);
        for (uint32_t i = 0; i < AWAY_VOLUME; i++) {
            float cells = sqrtf((float)b[i]) * (0.9999f / VELUM_AWAY_UNIT);
            out[(size_t)level * AWAY_VOLUME + i] = cells < 255.0f ? (uint8_t)cells : 255;
        }
    }
    free(high);
    free(a);
    return true;
}

float core_noise_detail_slope(const core_noise *noise) {
    enum { DETAIL = CORE_NOISE_DETAIL_SIDE };
    float most = 0.0f;
    for (uint32_t i = 0; i < CORE_NOISE_DETAIL_BYTES; i++) {
        most = fmaxf(most, cell_slope(noise->detail, DETAIL, i % DETAIL, i / DETAIL % DETAIL, i / DETAIL / DETAIL));
    }
    return most * ((float)DETAIL / 255.0f);
}
