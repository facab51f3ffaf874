#include "noise_textures.h"

#include <stdlib.h>

bool noise_texture_create(compute_device *device, VkFormat format, uint32_t side, const uint8_t *values,
                          compute_texture *texture) {
    const size_t count = (size_t)side * side * side;
    if (format == VK_FORMAT_R8_UNORM) {
        return compute_texture_create(device, format, side, values, count, texture);
    }
    const size_t bytes = count * (format == VK_FORMAT_R16_UNORM ? sizeof(uint16_t) : sizeof(float));
    uint16_t *words = malloc(bytes);
    if (!words) {
        *texture = (compute_texture){0};
        return false;
    }
    if (format == VK_FORMAT_R16_UNORM) {
        for (size_t i = 0; i < count; i++) {
            words[i] = (uint16_t)(257u * values[i]);
        }
    } else {
        float *floats = (float *)(void *)words;
        for (size_t i = 0; i < count; i++) {
            floats[i] = (float)values[i] / 255.0f;
        }
    }
    bool made = compute_texture_create(device, format, side, words, bytes, texture);
    free(words);
    return made;
}
