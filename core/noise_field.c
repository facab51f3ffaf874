#include "noise_field.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "shared/hash.h"

#define MAX_TEXELS 32

void noise_field_clear(float *field, size_t count) {
    memset(field, 0, count * sizeof *field);
}

/* One point for each cell, relative to the cell's corner, in cells. */
static float *feature_points(uint32_t cells, uint32_t seed) {
    float *points = malloc((size_t)cells * cells * cells * 3 * sizeof *points);
    if (points) {
        float *point = points;
        for (uint32_t i = 0; i < cells * cells * cells; i++) {
            uint32_t hash = velum_hash_2(i, seed);
            for (int axis = 0; axis < 3; axis++) {
                *point++ = velum_hash_unit(hash);
                hash = velum_hash(hash);
            }
        }
    }
    return points;
}

static void worley_cell(float *field, uint32_t n, uint32_t cells, float weight, const float *lattice,
                        const uint32_t cell[3]) {
    const uint32_t texels = n / cells;
    const uint32_t mask = cells - 1;
    const float size = 1.0f / (float)texels;
    float points[27][3];
    for (uint32_t i = 0; i < 27; i++) {
        const uint32_t to[3] = {i % 3, i / 3 % 3, i / 9};
        const uint32_t x = (cell[0] + to[0] - 1) & mask;
        const uint32_t y = (cell[1] + to[1] - 1) & mask;
        const uint32_t z = (cell[2] + to[2] - 1) & mask;
        const float *point = lattice + (size_t)3 * ((z * cells + y) * cells + x);
        for (int axis = 0; axis < 3; axis++) {
            points[i][axis] = (float)(int32_t)to[axis] - 1.0f + point[axis];
        }
    }
    for (uint32_t k = 0; k < texels; k++) {
        float z = ((float)k + 0.5f) * size;
        for (uint32_t j = 0; j < texels; j++) {
            float y = ((float)j + 0.5f) * size;
            float nearest[MAX_TEXELS];
            for (uint32_t i = 0; i < texels; i++) {
                nearest[i] = 1.0f;
            }
            for (int p = 0; p < 27; p++) {
                float dy = points[p][1] - y;
                float dz = points[p][2] - z;
                float side = dy * dy + dz * dz;
                if (side >= 1.0f) {
                    continue;
                }
                float dx = 0.5f * size - points[p][0];
                for (uint32_t i = 0; i < texels; i++) {
                    float x = dx + (float)(int32_t)i * size;
                    float d2 = x * x + side;
                    nearest[i] = d2 < nearest[i] ? d2 : nearest[i];
                }
            }
            float *row = field + (((size_t)(cell[2] * texels + k) * n) + cell[1] * texels + j) * n + cell[0] * texels;
            for (uint32_t i = 0; i < texels; i++) {
                row[i] += weight * (1.0f - sqrtf(nearest[i]));
            }
        }
    }
}

bool noise_field_add_worley(float *field, uint32_t n, uint32_t cells, float weight, uint32_t seed) {
    float *lattice = feature_points(cells, seed);
    if (!lattice) {
        return false;
    }
    uint32_t cell[3];
    for (cell[2] = 0; cell[2] < cells; cell[2]++) {
        for (cell[1] = 0; cell[1] < cells; cell[1]++) {
            for (cell[0] = 0; cell[0] < cells; cell[0]++) {
                worley_cell(field, n, cells, weight, lattice, cell);
            }
        }
    }
    free(lattice);
    return true;
}

/* One of the 12 gradients towards the edges of a cube (Perlin 2002). */
static void gradient_of(const uint32_t node[3], uint32_t cells, uint32_t seed, float gradient[3]) {
    static const int8_t edges[12][3] = {{1, 1, 0},  {-1, 1, 0},  {1, -1, 0}, {-1, -1, 0}, {1, 0, 1},  {-1, 0, 1},
                                        {1, 0, -1}, {-1, 0, -1}, {0, 1, 1},  {0, -1, 1},  {0, 1, -1}, {0, -1, -1}};
    uint32_t hash = velum_hash_4(node[0] & (cells - 1), node[1] & (cells - 1), node[2] & (cells - 1), seed) % 12u;
    for (int axis = 0; axis < 3; axis++) {
        gradient[axis] = edges[hash][axis];
    }
}

static float fade(float t) {
    return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

static void perlin_cell(float *field, uint32_t n, uint32_t cells, float weight, uint32_t seed, const uint32_t cell[3]) {
    const uint32_t texels = n / cells;
    const float size = 1.0f / (float)texels;
    float gradient[2][2][2][3];
    float faded[MAX_TEXELS];
    for (uint32_t corner = 0; corner < 8; corner++) {
        const uint32_t node[3] = {cell[0] + (corner & 1), cell[1] + (corner >> 1 & 1), cell[2] + (corner >> 2)};
        gradient_of(node, cells, seed, gradient[corner >> 2][corner >> 1 & 1][corner & 1]);
    }
    for (uint32_t i = 0; i < texels; i++) {
        faded[i] = fade(((float)i + 0.5f) * size);
    }
    for (uint32_t k = 0; k < texels; k++) {
        float z = ((float)k + 0.5f) * size;
        for (uint32_t j = 0; j < texels; j++) {
            float y = ((float)j + 0.5f) * size;
            /* Along x each side's value is linear: constant and slope, blended over y and z beforehand. */
            float constant[2];
            float slope[2];
            for (int side = 0; side < 2; side++) {
                float c[2];
                float s[2];
                for (int up = 0; up < 2; up++) {
                    const float *g0 = gradient[up][0][side];
                    const float *g1 = gradient[up][1][side];
                    float c0 = g0[1] * y + g0[2] * (z - (float)up);
                    float c1 = g1[1] * (y - 1.0f) + g1[2] * (z - (float)up);
                    c[up] = c0 + (c1 - c0) * faded[j];
                    s[up] = g0[0] + (g1[0] - g0[0]) * faded[j];
                }
                constant[side] = c[0] + (c[1] - c[0]) * faded[k];
                slope[side] = s[0] + (s[1] - s[0]) * faded[k];
            }
            float *row = field + (((size_t)(cell[2] * texels + k) * n) + cell[1] * texels + j) * n + cell[0] * texels;
            for (uint32_t i = 0; i < texels; i++) {
                float x = ((float)(int32_t)i + 0.5f) * size;
                float left = constant[0] + slope[0] * x;
                float right = constant[1] + slope[1] * (x - 1.0f);
                row[i] += weight * (left + (right - left) * faded[i]);
            }
        }
    }
}

void noise_field_add_perlin(float *field, uint32_t n, uint32_t cells, float weight, uint32_t seed) {
    uint32_t cell[3];
    for (cell[2] = 0; cell[2] < cells; cell[2]++) {
        for (cell[1] = 0; cell[1] < cells; cell[1]++) {
            for (cell[0] = 0; cell[0] < cells; cell[0]++) {
                perlin_cell(field, n, cells, weight, seed, cell);
            }
        }
    }
}
