#include "noise.h"

#include <math.h>
#include <stddef.h>

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
