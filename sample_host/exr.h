/* OpenEXR: 32-bit float, uncompressed scanlines. */
#ifndef HOST_EXR_H
#define HOST_EXR_H

#include <stdbool.h>
#include <stdint.h>

enum { EXR_CHANNELS_MAX = 16 };

/* One channel: element (x, y) is data[(y * width + x) * stride]. */
struct exr_channel {
    const char *name;
    const float *data;
    uint32_t stride;
};

/* Channels in the order of their names' bytes. The file appears whole or not at all. Failures are reported. */
bool exr_write(const char *path, uint32_t width, uint32_t height, const struct exr_channel *channels,
               uint32_t channel_count);

#endif
