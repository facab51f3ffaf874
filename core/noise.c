#include "noise.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "noise_equalise.h"
#include "noise_field.h"

#define SHAPE_CELLS 8
#define DETAIL_CELLS 4

static bool make_shape(float *field, float *scratch) {
    /* Perlin and inverted Worley over each other: remap(perlin, 0, 1, worley, 1) (Schneider 2015; Haggstrom 2018). */
    const uint32_t n = CORE_NOISE_SHAPE_SIDE;
    const size_t count = CORE_NOISE_SHAPE_BYTES;
    noise_field_clear(field, count);
    if (!noise_field_add_worley(field, n, SHAPE_CELLS, 0.62f, 1u) ||
        !noise_field_add_worley(field, n, 2 * SHAPE_CELLS, 0.26f, 2u) ||
        !noise_field_add_worley(field, n, 4 * SHAPE_CELLS, 0.12f, 3u)) {
        return false;
    }
    noise_field_clear(scratch, count);
    noise_field_add_perlin(scratch, n, SHAPE_CELLS, 0.55f, 4u);
    noise_field_add_perlin(scratch, n, 2 * SHAPE_CELLS, 0.30f, 5u);
    noise_field_add_perlin(scratch, n, 4 * SHAPE_CELLS, 0.15f, 6u);
    for (size_t i = 0; i < count; i++) {
        float perlin = 0.5f + 0.5f * scratch[i];
        field[i] = field[i] + perlin * (1.0f - field[i]);
    }
    return true;
}

static bool make_detail(uint8_t *texels, float *field) {
    const uint32_t n = CORE_NOISE_DETAIL_SIDE;
    const size_t count = CORE_NOISE_DETAIL_BYTES;
    noise_field_clear(field, count);
    if (!noise_field_add_worley(field, n, DETAIL_CELLS, 0.625f, 11u) ||
        !noise_field_add_worley(field, n, 2 * DETAIL_CELLS, 0.25f, 12u) ||
        !noise_field_add_worley(field, n, 4 * DETAIL_CELLS, 0.125f, 13u) ||
        !noise_field_add_worley(field, n, 8 * DETAIL_CELLS, 0.05f, 14u)) {
        return false;
    }
    double sum = 0.0;
    double squares = 0.0;
    for (size_t i = 0; i < count; i++) {
        sum += field[i];
        squares += (double)field[i] * field[i];
    }
    double mean = sum / (double)count;
    double deviation = sqrt(squares / (double)count - mean * mean);
    for (size_t i = 0; i < count; i++) {
        double value = 0.5 + (field[i] - mean) / (5.0 * deviation);
        texels[i] = (uint8_t)lround(255.0 * fmin(fmax(value, 0.0), 1.0));
    }
    return true;
}

core_noise *core_noise_create(void) {
    core_noise *noise = malloc(sizeof *noise);
    float *field = malloc(CORE_NOISE_SHAPE_BYTES * sizeof *field);
    float *scratch = malloc(CORE_NOISE_SHAPE_BYTES * sizeof *scratch);
    if (!noise || !field || !scratch) {
        goto error;
    }
    if (!make_shape(field, scratch) || !noise_equalise(field, CORE_NOISE_SHAPE_SIDE, noise->shape) ||
        !make_detail(noise->detail, scratch)) {
        goto error;
    }
    free(field);
    free(scratch);
    return noise;
error:
    free(noise);
    free(field);
    free(scratch);
    return NULL;
}

void core_noise_destroy(core_noise *noise) {
    free(noise);
}

static float filtered(const uint8_t *texels, uint32_t side, float x, float y, float z) {
    const float at[3] = {x, y, z};
    uint32_t low[3];
    uint32_t high[3];
    float part[3];
    for (int axis = 0; axis < 3; axis++) {
        float turn = isfinite(at[axis]) ? at[axis] - floorf(at[axis]) : 0.0f;
        float texel = turn * (float)side - 0.5f;
        float whole = floorf(texel);
        part[axis] = texel - whole;
        low[axis] = (uint32_t)((int32_t)whole + (int32_t)side) & (side - 1);
        high[axis] = (low[axis] + 1) & (side - 1);
    }
    const uint8_t *row00 = texels + ((size_t)low[2] * side + low[1]) * side;
    const uint8_t *row01 = texels + ((size_t)low[2] * side + high[1]) * side;
    const uint8_t *row10 = texels + ((size_t)high[2] * side + low[1]) * side;
    const uint8_t *row11 = texels + ((size_t)high[2] * side + high[1]) * side;
    float v00 = (float)row00[low[0]] + (float)(row00[high[0]] - row00[low[0]]) * part[0];
    float v01 = (float)row01[low[0]] + (float)(row01[high[0]] - row01[low[0]]) * part[0];
    float v10 = (float)row10[low[0]] + (float)(row10[high[0]] - row10[low[0]]) * part[0];
    float v11 = (float)row11[low[0]] + (float)(row11[high[0]] - row11[low[0]]) * part[0];
    float v0 = v00 + (v01 - v00) * part[1];
    float v1 = v10 + (v11 - v10) * part[1];
    return (v0 + (v1 - v0) * part[2]) * (1.0f / 255.0f);
}

float core_noise_shape(const core_noise *noise, float x, float y, float z) {
    return filtered(noise->shape, CORE_NOISE_SHAPE_SIDE, x, y, z);
}

float core_noise_detail(const core_noise *noise, float x, float y, float z) {
    return filtered(noise->detail, CORE_NOISE_DETAIL_SIDE, x, y, z);
}
