#include "noise_make.h"

#include <math.h>
#include <stdlib.h>

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

bool core_noise_make(core_noise *out) {
    float *field = malloc(CORE_NOISE_SHAPE_BYTES * sizeof *field);
    float *scratch = malloc(CORE_NOISE_SHAPE_BYTES * sizeof *scratch);
    bool made = field && scratch && make_shape(field, scratch) &&
                noise_equalise(field, CORE_NOISE_SHAPE_SIDE, out->shape) && make_detail(out->detail, scratch);
    free(field);
    free(scratch);
    return made;
}
