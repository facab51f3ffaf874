/* Where an object's messages go. */
#ifndef PLUGIN_LOG_H
#define PLUGIN_LOG_H

#include <velum/abi.h>

typedef struct log_sink {
    velum_log_fn fn; /* may be null */
    void *context;
} log_sink;

void log_write(const log_sink *sink, int32_t severity, const char *object, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

/* Logs under the severity that goes with `result` and returns it. */
velum_result log_fail(const log_sink *sink, velum_result result, const char *object, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

#endif
