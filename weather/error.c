#include "error.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static void append(char *text, size_t size, size_t *used, const char *format, ...)
    __attribute__((format(printf, 4, 5)));

static void append_v(char *text, size_t size, size_t *used, const char *format, va_list arguments) {
    if (*used + 1 >= size) {
        return;
    }
    const int written = vsnprintf(text + *used, size - *used, format, arguments);
    if (written > 0) {
        const size_t room = size - *used - 1;
        *used += (size_t)written < room ? (size_t)written : room;
    }
}

static void append(char *text, size_t size, size_t *used, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    append_v(text, size, used, format, arguments);
    va_end(arguments);
}

static void begin(velum_weather_error *error, const char *file, uint32_t line, uint32_t column, uint32_t message) {
    memset(error, 0, sizeof(*error));
    snprintf(error->file, sizeof(error->file), "%s", file ? file : "");
    error->line = line;
    error->column = column;
    error->message = message;
}

/* Content of files ends up in texts: a terminal must not obey it. */
static void make_printable(char *text) {
    for (char *c = text; *c; ++c) {
        const unsigned char byte = (unsigned char)*c;
        if (byte < 0x20 || byte == 0x7f) {
            *c = '?';
        }
    }
}

velum_result weather_fail(velum_weather_error *error, velum_result result, const char *file, uint32_t line,
                          uint32_t column, const char *format, ...) {
    if (!error) {
        return result;
    }
    begin(error, file, line, column, 0);
    size_t used = 0;
    if (file && *file) {
        append(error->text, sizeof(error->text), &used, "%.400s:", file);
    }
    if (line) {
        append(error->text, sizeof(error->text), &used, "%u:", line);
    }
    if (line && column) {
        append(error->text, sizeof(error->text), &used, "%u:", column);
    }
    if (used) {
        append(error->text, sizeof(error->text), &used, " ");
    }
    va_list arguments;
    va_start(arguments, format);
    append_v(error->text, sizeof(error->text), &used, format, arguments);
    va_end(arguments);
    make_printable(error->text);
    return result;
}

velum_result weather_fail_message(velum_weather_error *error, velum_result result, const char *file, uint32_t message,
                                  const char *format, ...) {
    if (!error) {
        return result;
    }
    begin(error, file, 0, 0, message);
    size_t used = 0;
    if (file && *file) {
        append(error->text, sizeof(error->text), &used, "%.400s: ", file);
    }
    if (message) {
        append(error->text, sizeof(error->text), &used, "message %u: ", message);
    }
    va_list arguments;
    va_start(arguments, format);
    append_v(error->text, sizeof(error->text), &used, format, arguments);
    va_end(arguments);
    make_printable(error->text);
    return result;
}

velum_result weather_out_of_memory(velum_weather_error *error, const char *file) {
    return weather_fail(error, VELUM_ERROR_OUT_OF_MEMORY, file, 0, 0, "out of memory");
}

void weather_refuse(velum_weather_report *report, const char *format, ...) {
    if (!report) {
        return;
    }
    const uint32_t capacity = (uint32_t)(sizeof(report->refusals) / sizeof(report->refusals[0]));
    if (report->refusal_count >= capacity) {
        return;
    }
    char text[sizeof(report->refusals[0].text)];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof(text), format, arguments);
    va_end(arguments);
    make_printable(text);
    const size_t prefix = strcspn(text, ":") + 1;
    uint32_t same = 0;
    for (uint32_t i = 0; i < report->refusal_count; ++i) {
        same += strncmp(report->refusals[i].text, text, prefix) == 0;
    }
    if (same < WEATHER_MAX_REFUSAL_TEXTS) {
        memcpy(report->refusals[report->refusal_count++].text, text, sizeof(text));
    }
}

velum_result weather_read_file(const char *path, char **bytes, size_t *size, velum_weather_error *error) {
    velum_result result = VELUM_OK;
    char *buffer = NULL;
    *bytes = NULL;
    *size = 0;
    if (!path) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, NULL, 0, 0, "path: found null, expected the path of a file");
    }
    /* O_NONBLOCK: a pipe without a writer must not hold us; the check below refuses it. */
    const int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    struct stat status;
    if (file < 0 || fstat(file, &status) != 0) {
        result = weather_fail(error, VELUM_ERROR_STATE, path, 0, 0, "cannot be read: %s", strerror(errno));
        goto done;
    }
    if (!S_ISREG(status.st_mode)) {
        result = weather_fail(error, VELUM_ERROR_STATE, path, 0, 0, "cannot be read: found %s, expected a file",
                              S_ISDIR(status.st_mode) ? "a directory" : "a device or pipe");
        goto done;
    }
    if (status.st_size > WEATHER_MAX_FILE_BYTES) {
        result =
            weather_fail(error, VELUM_ERROR_STATE, path, 0, 0, "cannot be read: found %lld bytes, expected at most %d",
                         (long long)status.st_size, WEATHER_MAX_FILE_BYTES);
        goto done;
    }
    const size_t capacity = (size_t)status.st_size;
    buffer = malloc(capacity + 1);
    if (!buffer) {
        result = weather_out_of_memory(error, path);
        goto done;
    }
    size_t used = 0;
    while (used < capacity) {
        const ssize_t got = read(file, buffer + used, capacity - used);
        if (got < 0 && errno == EINTR) {
            continue;
        }
        if (got < 0) {
            result = weather_fail(error, VELUM_ERROR_STATE, path, 0, 0, "cannot be read: %s", strerror(errno));
            goto done;
        }
        if (got == 0) {
            break;
        }
        used += (size_t)got;
    }
    buffer[used] = '\0';
    *bytes = buffer;
    *size = used;
    buffer = NULL;
done:
    free(buffer);
    if (file >= 0) {
        close(file);
    }
    return result;
}
