#include "noise_equalise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define SIDE 128
#define COUNT ((size_t)SIDE * SIDE * SIDE)
#define RANKS 16384 /* of the first, coarse ranking */
#define BLOCKS 16   /* a side; local distributions are known for each block of 8^3 texels */
#define BLOCK_TEXELS (SIDE / BLOCKS)
#define BLOCK_COUNT (BLOCKS * BLOCKS * BLOCKS)
#define BINS 24    /* of a local distribution */
#define LEAST 2.0f /* texels of a bin */
#define PLANE_RANKS 256
#define CURVE 1024

/* ---------------------------------------------------------------- ranks over the whole period */

static void rank_texels(float *field) {
    float low = field[0];
    float high = field[0];
    for (size_t i = 0; i < COUNT; i++) {
        low = field[i] < low ? field[i] : low;
        high = field[i] > high ? field[i] : high;
    }
    static const float last = RANKS - 1;
    float scale = last / fmaxf(high - low, 1e-20f);
    uint32_t counts[RANKS] = {0};
    float rank[RANKS + 1];
    for (size_t i = 0; i < COUNT; i++) {
        counts[(uint32_t)((field[i] - low) * scale)]++;
    }
    uint32_t sum = 0;
    for (uint32_t i = 0; i < RANKS; i++) {
        rank[i] = (float)sum / (float)COUNT;
        sum += counts[i];
    }
    rank[RANKS] = 1.0f;
    for (size_t i = 0; i < COUNT; i++) {
        float at = (field[i] - low) * scale;
        uint32_t bin = (uint32_t)at;
        field[i] = rank[bin] + (rank[bin + 1] - rank[bin]) * (at - (float)bin);
    }
}

/* ---------------------------------------------------------------- ranks among neighbours */

/* A low pass: waves of a third of the period and longer go, whatever the threshold; shorter than a sixth stay. */
static void blur_axis(const float *from, float *to, size_t stride) {
    static const float kernel[9] = {0.59125f, 0.29040f,  -0.06844f, -0.04605f, 0.02750f,
                                    0.00841f, -0.00656f, -0.00276f, 0.00187f};
    for (size_t i = 0; i < BLOCK_COUNT; i++) {
        size_t at = i / stride % BLOCKS;
        size_t line = i - at * stride;
        float sum = from[i] * kernel[0];
        for (size_t k = 1; k < 9; k++) {
            sum += kernel[k] *
                   (from[line + (at + k) % BLOCKS * stride] + from[line + (at + BLOCKS - k) % BLOCKS * stride]);
        }
        to[i] = sum;
    }
}

/* shares[bin * BLOCK_COUNT + block]: of texels around the block whose rank lies below bin / BINS. */
static void local_shares(const float *field, float *shares, float *scratch) {
    const size_t step = BLOCK_COUNT;
    memset(shares, 0, (BINS + 1) * step * sizeof *shares);
    for (size_t z = 0; z < SIDE; z++) {
        for (size_t y = 0; y < SIDE; y++) {
            const float *row = field + (z * SIDE + y) * SIDE;
            float *block = shares + (z / BLOCK_TEXELS * BLOCKS + y / BLOCK_TEXELS) * BLOCKS;
            for (size_t x = 0; x < SIDE; x++) {
                size_t bin = (size_t)(row[x] * BINS);
                block[((bin < BINS ? bin : BINS - 1) + 1) * step + x / BLOCK_TEXELS] += 1.0f;
            }
        }
    }
    for (size_t bin = 1; bin <= BINS; bin++) {
        float *own = shares + bin * step;
        blur_axis(own, scratch, 1);
        blur_axis(scratch, own, BLOCKS);
        blur_axis(own, scratch, (size_t)BLOCKS * BLOCKS);
        for (size_t i = 0; i < step; i++) {
            /* The low pass overshoots: no part of the curve may fall. */
            own[i] = shares[(bin - 1) * step + i] + fmaxf(scratch[i], LEAST);
        }
    }
    for (size_t bin = 1; bin <= BINS; bin++) {
        for (size_t i = 0; i < step; i++) {
            shares[bin * step + i] /= shares[BINS * step + i];
        }
    }
}

/* The texels between eight blocks' centres. */
static void rank_between(float *field, const float *shares, const size_t block[3]) {
    float corner[8][BINS + 1];
    for (size_t c = 0; c < 8; c++) {
        size_t x = (block[0] + (c & 1)) % BLOCKS;
        size_t y = (block[1] + (c >> 1 & 1)) % BLOCKS;
        size_t z = (block[2] + (c >> 2)) % BLOCKS;
        for (size_t bin = 0; bin <= BINS; bin++) {
            corner[c][bin] = shares[bin * BLOCK_COUNT + (z * BLOCKS + y) * BLOCKS + x];
        }
    }
    for (size_t k = 0; k < BLOCK_TEXELS; k++) {
        float tz = ((float)k + 0.5f) / BLOCK_TEXELS;
        size_t z = (block[2] * BLOCK_TEXELS + BLOCK_TEXELS / 2 + k) % SIDE;
        for (size_t j = 0; j < BLOCK_TEXELS; j++) {
            float ty = ((float)j + 0.5f) / BLOCK_TEXELS;
            size_t y = (block[1] * BLOCK_TEXELS + BLOCK_TEXELS / 2 + j) % SIDE;
            float side[2][BINS + 1];
            for (size_t s = 0; s < 2; s++) {
                for (size_t bin = 0; bin <= BINS; bin++) {
                    float a = corner[s][bin] + (corner[s + 2][bin] - corner[s][bin]) * ty;
                    float b = corner[s + 4][bin] + (corner[s + 6][bin] - corner[s + 4][bin]) * ty;
                    side[s][bin] = a + (b - a) * tz;
                }
            }
            float *row = field + (z * SIDE + y) * SIDE;
            for (size_t i = 0; i < BLOCK_TEXELS; i++) {
                float tx = ((float)i + 0.5f) / BLOCK_TEXELS;
                size_t x = (block[0] * BLOCK_TEXELS + BLOCK_TEXELS / 2 + i) % SIDE;
                float at = row[x] * BINS;
                size_t bin = (size_t)at < BINS ? (size_t)at : BINS - 1;
                float part = at - (float)bin;
                float a = side[0][bin] + (side[0][bin + 1] - side[0][bin]) * part;
                float b = side[1][bin] + (side[1][bin + 1] - side[1][bin]) * part;
                row[x] = a + (b - a) * tx;
            }
        }
    }
}

static void rank_locally(float *field, float *shares, float *scratch) {
    local_shares(field, shares, scratch);
    size_t block[3];
    for (block[2] = 0; block[2] < BLOCKS; block[2]++) {
        for (block[1] = 0; block[1] < BLOCKS; block[1]++) {
            for (block[0] = 0; block[0] < BLOCKS; block[0]++) {
                rank_between(field, shares, block);
            }
        }
    }
}

/* ---------------------------------------------------------------- ranks in planes */

/* A ground that lies along the texture's planes sees little but one of them for tens of kilometres. */
static void rank_planes(float *field, size_t stride) {
    static const float last = PLANE_RANKS - 1e-3f;
    const size_t inner = stride == 1 ? SIDE : 1;
    const size_t outer = stride == (size_t)SIDE * SIDE ? SIDE : (size_t)SIDE * SIDE;
    for (size_t plane = 0; plane < SIDE; plane++) {
        uint32_t counts[PLANE_RANKS] = {0};
        float rank[PLANE_RANKS + 1];
        float *own = field + plane * stride;
        for (size_t j = 0; j < SIDE; j++) {
            for (size_t i = 0; i < SIDE; i++) {
                counts[(uint32_t)(own[j * outer + i * inner] * last)]++;
            }
        }
        uint32_t sum = 0;
        for (uint32_t i = 0; i <= PLANE_RANKS; i++) {
            rank[i] = (float)sum / (float)(SIDE * SIDE);
            sum += i < PLANE_RANKS ? counts[i] : 0;
        }
        for (size_t j = 0; j < SIDE; j++) {
            for (size_t i = 0; i < SIDE; i++) {
                float *value = own + j * outer + i * inner;
                float at = *value * last;
                uint32_t bin = (uint32_t)at;
                *value = rank[bin] + (rank[bin + 1] - rank[bin]) * (at - (float)bin);
            }
        }
    }
}

/* ---------------------------------------------------------------- what the filter does */

static float curve_at(const float *curve, float value) {
    float at = fminf(fmaxf(value, 0.0f), 1.0f) * CURVE;
    uint32_t i = at < CURVE ? (uint32_t)at : CURVE - 1;
    return curve[i] + (curve[i + 1] - curve[i]) * (at - (float)i);
}

static float filtered(const float *field, const float *curve, const float at[3]) {
    size_t low[3];
    size_t high[3];
    float part[3];
    for (int axis = 0; axis < 3; axis++) {
        float texel = at[axis] * SIDE;
        low[axis] = (size_t)texel & (SIDE - 1);
        high[axis] = (low[axis] + 1) & (SIDE - 1);
        part[axis] = texel - floorf(texel);
    }
    float sum = 0.0f;
    for (int c = 0; c < 8; c++) {
        size_t x = c & 1 ? high[0] : low[0];
        size_t y = c & 2 ? high[1] : low[1];
        size_t z = c & 4 ? high[2] : low[2];
        float weight = (c & 1 ? part[0] : 1.0f - part[0]) * (c & 2 ? part[1] : 1.0f - part[1]) *
                       (c & 4 ? part[2] : 1.0f - part[2]);
        sum += weight * curve_at(curve, field[(z * SIDE + y) * SIDE + x]);
    }
    return sum;
}

/* Bends `curve` until values of the filtered field are uniform: its own distribution, applied again and again. */
static void correct_curve(const float *field, float *curve, uint32_t samples) {
    uint32_t counts[CURVE] = {0};
    float share[CURVE + 1];
    /* The R3 sequence (Roberts 2018): evenly spread over the cube. */
    double at[3] = {0.5, 0.5, 0.5};
    for (uint32_t i = 0; i < samples; i++) {
        const float place[3] = {(float)at[0], (float)at[1], (float)at[2]};
        float value = filtered(field, curve, place);
        uint32_t bin = (uint32_t)(value * CURVE);
        counts[bin < CURVE ? bin : CURVE - 1]++;
        at[0] += 0.8191725133961645;
        at[1] += 0.6710436067037893;
        at[2] += 0.5497004779019703;
        for (int axis = 0; axis < 3; axis++) {
            at[axis] -= floor(at[axis]);
        }
    }
    uint32_t sum = 0;
    for (uint32_t i = 0; i <= CURVE; i++) {
        share[i] = (float)sum / (float)samples;
        sum += i < CURVE ? counts[i] : 0;
    }
    for (uint32_t i = 0; i <= CURVE; i++) {
        curve[i] = curve_at(share, curve[i]);
    }
}

bool noise_equalise(float *field, uint32_t n, uint8_t *texels) {
    float *shares = malloc((BINS + 2) * BLOCK_COUNT * sizeof *shares);
    if (!shares || n != SIDE) {
        free(shares);
        return false;
    }
    rank_texels(field);
    for (int pass = 0; pass < 2; pass++) {
        rank_locally(field, shares, shares + (BINS + 1) * BLOCK_COUNT);
    }
    rank_planes(field, 1);
    rank_planes(field, SIDE);
    rank_planes(field, (size_t)SIDE * SIDE);
    float curve[CURVE + 1];
    for (uint32_t i = 0; i <= CURVE; i++) {
        curve[i] = (float)i / CURVE;
    }
    for (uint32_t pass = 0; pass < 4; pass++) {
        correct_curve(field, curve, 1u << (14 + pass));
    }
    for (size_t i = 0; i < COUNT; i++) {
        texels[i] = (uint8_t)(curve_at(curve, field[i]) * 255.0f + 0.5f);
    }
    free(shares);
    return true;
}
