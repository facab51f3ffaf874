/* Errors, refusals and whole files: what every reader needs. */
#ifndef VELUM_WEATHER_ERROR_H
#define VELUM_WEATHER_ERROR_H

#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <velum_weather/weather.h>

enum { WEATHER_MAX_FILE_BYTES = 256 * 1024 * 1024, WEATHER_MAX_REFUSAL_TEXTS = 64 };

/* Fills *error (may be null) with "file:line:column: message" (file null, line 0, column 0: left out); returns result.
 */
__attribute__((format(printf, 6, 7))) velum_result weather_fail(velum_weather_error *error, velum_result result,
                                                                const char *file, uint32_t line, uint32_t column,
                                                                const char *format, ...);

/* The same for GRIB2: "file: message N: message" (message 0: left out). */
__attribute__((format(printf, 5, 6))) velum_result weather_fail_message(velum_weather_error *error, velum_result result,
                                                                        const char *file, uint32_t message,
                                                                        const char *format, ...);

velum_result weather_out_of_memory(velum_weather_error *error, const char *file);

/* Stores the text "file:line: ..." of a refused record in *report (may be null): at most 64 of each file, told apart by
 * what stands before the first colon. The counts are the caller's. */
__attribute__((format(printf, 2, 3))) void weather_refuse(velum_weather_report *report, const char *format, ...);

/* *bytes: malloc, the caller's to free, with a NUL after the last byte; null after an error. */
velum_result weather_read_file(const char *path, char **bytes, size_t *size, velum_weather_error *error);

#endif
