#include "log.h"

#include <stdarg.h>
#include <stdio.h>

enum { MESSAGE_SIZE = 768 };

static void write_list(const log_sink *sink, int32_t severity, const char *object, const char *format, va_list list) {
    if (!sink || !sink->fn) {
        return;
    }
    char message[MESSAGE_SIZE];
    vsnprintf(message, sizeof message, format, list);
    sink->fn(sink->context, severity, object, message);
}

void log_write(const log_sink *sink, int32_t severity, const char *object, const char *format, ...) {
    va_list list;
    va_start(list, format);
    write_list(sink, severity, object, format, list);
    va_end(list);
}

static int32_t severity_of(velum_result result) {
    switch (result) {
    case VELUM_ERROR_ARGUMENT:
    case VELUM_ERROR_STRUCT_SIZE:
    case VELUM_ERROR_FLAGS:
    case VELUM_ERROR_STATE:
    case VELUM_ERROR_VERSION:
    case VELUM_ERROR_HANDLE: return VELUM_LOG_HOST_MISUSE;
    default: return result < 0 ? VELUM_LOG_ERROR : VELUM_LOG_WARNING;
    }
}

velum_result log_fail(const log_sink *sink, velum_result result, const char *object, const char *format, ...) {
    va_list list;
    va_start(list, format);
    write_list(sink, severity_of(result), object, format, list);
    va_end(list);
    return result;
}
