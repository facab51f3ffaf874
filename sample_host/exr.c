#include "exr.h"

#include "files.h"
#include "report.h"

#include <OpenEXR/openexr.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* The library's own handler prints; the result code says enough. */
static void ignore_message(exr_const_context_t context, exr_result_t code, const char *message) {
    (void)context, (void)code, (void)message;
}

static exr_result_t add_channels(exr_context_t context, int part, const struct exr_channel *channels, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        exr_result_t result =
            exr_add_channel(context, part, channels[i].name, EXR_PIXEL_FLOAT, EXR_PERCEPTUALLY_LINEAR, 1, 1);
        if (result != EXR_ERR_SUCCESS) {
            return result;
        }
    }
    return EXR_ERR_SUCCESS;
}

static exr_result_t write_lines(exr_context_t context, int part, uint32_t width, uint32_t height,
                                const struct exr_channel *channels, uint32_t count) {
    size_t line_floats = (size_t)width * count;
    float *line = malloc(line_floats * sizeof *line);
    exr_result_t result = line ? EXR_ERR_SUCCESS : EXR_ERR_OUT_OF_MEMORY;
    for (uint32_t y = 0; result == EXR_ERR_SUCCESS && y < height; y++) {
        for (uint32_t c = 0; c < count; c++) {
            const float *from = channels[c].data + (size_t)y * width * channels[c].stride;
            for (uint32_t x = 0; x < width; x++) {
                line[(size_t)c * width + x] = from[(size_t)x * channels[c].stride];
            }
        }
        result = exr_write_scanline_chunk(context, part, (int)y, line, line_floats * sizeof *line);
    }
    free(line);
    return result;
}

bool exr_write(const char *path, uint32_t width, uint32_t height, const struct exr_channel *channels,
               uint32_t channel_count) {
    char temporary[FILES_PATH_MAX];
    exr_context_t context = NULL;
    exr_context_initializer_t initializer = EXR_DEFAULT_CONTEXT_INITIALIZER;
    initializer.error_handler_fn = ignore_message;
    int part = 0;
    if (!files_temporary(path, temporary)) {
        return false;
    }
    exr_result_t result = exr_start_write(&context, temporary, EXR_WRITE_FILE_DIRECTLY, &initializer);
    if (result == EXR_ERR_SUCCESS) {
        result = exr_add_part(context, "velum", EXR_STORAGE_SCANLINE, &part);
    }
    if (result == EXR_ERR_SUCCESS) {
        result = exr_initialize_required_attr_simple(context, part, (int)width, (int)height, EXR_COMPRESSION_NONE);
    }
    if (result == EXR_ERR_SUCCESS) {
        result = add_channels(context, part, channels, channel_count);
    }
    if (result == EXR_ERR_SUCCESS) {
        result = exr_write_header(context);
    }
    if (result == EXR_ERR_SUCCESS) {
        result = write_lines(context, part, width, height, channels, channel_count);
    }
    if (context) {
        exr_result_t finished = exr_finish(&context);
        result = result == EXR_ERR_SUCCESS ? finished : result;
    }
    if (result != EXR_ERR_SUCCESS) {
        report_error("%s: cannot write: %s", path, exr_get_default_error_message(result));
        files_discard(temporary);
        return false;
    }
    return files_commit(temporary, path);
}
