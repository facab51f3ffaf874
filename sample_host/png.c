#include "png.h"

#include "files.h"
#include "report.h"

#include <errno.h>
#include <spng.h>
#include <stdio.h>
#include <string.h>

static int encode(spng_ctx *context, FILE *file, uint32_t width, uint32_t height, uint32_t channels,
                  const uint8_t *pixels) {
    struct spng_ihdr header = {.width = width,
                               .height = height,
                               .bit_depth = 8,
                               .color_type = channels == 1 ? SPNG_COLOR_TYPE_GRAYSCALE : SPNG_COLOR_TYPE_TRUECOLOR};
    int result = spng_set_png_file(context, file);
    if (!result) {
        result = spng_set_option(context, SPNG_IMG_COMPRESSION_LEVEL, 4);
    }
    if (!result) {
        result = spng_set_ihdr(context, &header);
    }
    if (!result && channels == 3) {
        result = spng_set_srgb(context, 0);
    }
    if (!result) {
        result =
            spng_encode_image(context, pixels, (size_t)width * height * channels, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE);
    }
    return result;
}

bool png_write(const char *path, uint32_t width, uint32_t height, uint32_t channels, const uint8_t *pixels) {
    char temporary[FILES_PATH_MAX];
    if (!files_temporary(path, temporary)) {
        return false;
    }
    FILE *file = fopen(temporary, "wb");
    if (!file) {
        report_error("%s: cannot write: %s", path, strerror(errno));
        return false;
    }
    spng_ctx *context = spng_ctx_new(SPNG_CTX_ENCODER);
    int result = context ? encode(context, file, width, height, channels, pixels) : SPNG_EMEM;
    spng_ctx_free(context);
    bool closed = fclose(file) == 0;
    if (result || !closed) {
        report_error("%s: cannot write: %s", path, result ? spng_strerror(result) : strerror(errno));
        files_discard(temporary);
        return false;
    }
    return files_commit(temporary, path);
}
