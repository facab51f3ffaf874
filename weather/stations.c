#include "stations.h"

#include "error.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum { MAX_TABLE_BYTES = 64 * 1024 * 1024 };

static int by_name(const void *a, const void *b) {
    return strcmp(((const velum_weather_station *)a)->name, ((const velum_weather_station *)b)->name);
}

static int take(weather_stations *table, uint32_t *capacity, const char *name, double lat_deg, double lon_deg) {
    if (table->count == *capacity) {
        const uint32_t more = *capacity ? *capacity * 2 : 4096;
        velum_weather_station *stations = realloc(table->stations, more * sizeof(*stations));
        if (!stations) {
            return 0;
        }
        table->stations = stations;
        *capacity = more;
    }
    velum_weather_station *station = &table->stations[table->count++];
    memset(station, 0, sizeof(*station));
    memcpy(station->name, name, strlen(name));
    station->lat_deg = lat_deg;
    station->lon_deg = lon_deg;
    return 1;
}

static void take_name(char name[8], const char *line, size_t size) {
    memset(name, 0, 8);
    if (size < 3 || size > 9 || line[size - 1] != ']') {
        return;
    }
    for (size_t i = 0; i + 2 < size; ++i) {
        const char c = line[i + 1];
        name[i] = c >= 'a' && c <= 'z' ? (char)(c - 'a' + 'A') : c;
    }
}

/* "location = (latitude, longitude)" in radians. */
static int take_location(const char *line, size_t size, double *lat_deg, double *lon_deg) {
    char text[96];
    const char *key = "location";
    if (size <= strlen(key) || size >= sizeof(text) || memcmp(line, key, strlen(key)) != 0) {
        return 0;
    }
    memcpy(text, line, size);
    text[size] = '\0';
    const char *at = strchr(text, '(');
    if (!at) {
        return 0;
    }
    char *end;
    const double degrees = 180.0 / 3.14159265358979323846;
    *lat_deg = strtod(at + 1, &end) * degrees;
    if (end == at + 1 || *end != ',') {
        return 0;
    }
    at = end + 1;
    *lon_deg = strtod(at, &end) * degrees;
    return end != at && *end == ')' && fabs(*lat_deg) <= 90.0 && fabs(*lon_deg) <= 180.0;
}

velum_result weather_stations_parse(weather_stations *table, const char *name, const char *text, size_t size,
                                    velum_weather_error *error) {
    uint32_t capacity = 0;
    char station[8] = "";
    memset(table, 0, sizeof(*table));
    for (size_t at = 0; at < size;) {
        const char *line = text + at;
        const char *newline = memchr(line, '\n', size - at);
        size_t length = newline ? (size_t)(newline - line) : size - at;
        double lat_deg, lon_deg;
        at += length + 1;
        length -= length && line[length - 1] == '\r';
        if (length && line[0] == '[') {
            take_name(station, line, length);
        } else if (station[0] && take_location(line, length, &lat_deg, &lon_deg)) {
            if (!take(table, &capacity, station, lat_deg, lon_deg)) {
                weather_stations_finish(table);
                return weather_out_of_memory(error, name);
            }
            station[0] = '\0';
        }
    }
    if (!table->count) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, 0, 0,
                            "found no station, expected sections [name] with location = (latitude, longitude)");
    }
    qsort(table->stations, table->count, sizeof(*table->stations), by_name);
    return VELUM_OK;
}

velum_result weather_stations_read(weather_stations *table, const char *path, velum_weather_error *error) {
    velum_result result = VELUM_OK;
    char *text = NULL;
    size_t size = 0, capacity = 0;
    memset(table, 0, sizeof(*table));
    gzFile file = gzopen(path, "rb");
    if (!file) {
        return weather_fail(error, VELUM_ERROR_STATE, path, 0, 0, "the station table cannot be read");
    }
    for (;;) {
        if (size == capacity) {
            capacity = capacity ? capacity * 2 : 1024 * 1024;
            char *more = capacity <= MAX_TABLE_BYTES ? realloc(text, capacity) : NULL;
            if (!more) {
                result = weather_fail(error, VELUM_ERROR_OUT_OF_MEMORY, path, 0, 0,
                                      "the station table does not fit into memory (at most %d bytes)", MAX_TABLE_BYTES);
                goto done;
            }
            text = more;
        }
        const int got = gzread(file, text + size, (unsigned)(capacity - size));
        if (got < 0) {
            result = weather_fail(error, VELUM_ERROR_STATE, path, 0, 0, "the station table cannot be unpacked");
            goto done;
        }
        if (got == 0) {
            break;
        }
        size += (size_t)got;
    }
    result = weather_stations_parse(table, path, text, size, error);
done:
    gzclose(file);
    free(text);
    return result;
}

void weather_stations_finish(weather_stations *table) {
    if (table) {
        free(table->stations);
        memset(table, 0, sizeof(*table));
    }
}

const velum_weather_station *weather_stations_find(const weather_stations *table, const char *name) {
    velum_weather_station key = {0};
    const size_t size = strlen(name);
    if (!table->count || size >= sizeof(key.name)) {
        return NULL;
    }
    memcpy(key.name, name, size);
    return bsearch(&key, table->stations, table->count, sizeof(key), by_name);
}
