#include "result.h"

#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

velum_result core_fail(core_error *error, velum_result result, const char *format, ...) {
    if (error) {
        va_list arguments;
        va_start(arguments, format);
        error->result = result;
        vsnprintf(error->text, sizeof error->text, format, arguments);
        va_end(arguments);
    }
    return result;
}

bool core_copy_struct(void *out, size_t own, const void *in, size_t frozen) {
    uint32_t size;
    memcpy(&size, in, sizeof size);
    if (size < frozen) {
        return false;
    }
    memset(out, 0, own);
    memcpy(out, in, size < own ? size : own);
    return true;
}
