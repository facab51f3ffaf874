/* PNG, 8 bits a channel. */
#ifndef HOST_PNG_H
#define HOST_PNG_H

#include <stdbool.h>
#include <stdint.h>

/* channels: 1 (grey) or 3 (sRGB), packed rows, top first. The file appears whole or not at all. Failures are reported.
 */
bool png_write(const char *path, uint32_t width, uint32_t height, uint32_t channels, const uint8_t *pixels);

#endif
