#include "metar_cell.h"
#include "metar_file.h"

#include "error.h"
#include "set.h"
#include "stations.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_REPORTS = 1000000, MINUTES_IN_CYCLE = 31 * 1440 };

typedef struct candidate {
    metar_report report;
    uint32_t line;
    int has_date;
    int64_t minute; /* of an era, with a date; else of the month */
    int has_place;
    double lat_deg, lon_deg;
    float elevation_m;
    uint32_t newer_line; /* 0: this is the station's newest */
    int is_same_time;    /* as that of newer_line */
} candidate;

typedef struct metar_reader {
    const char *name;
    const velum_weather_station_options *options;
    velum_weather_report *report;
    weather_stations table;
    int table_tried;
    candidate *candidates;
    uint32_t count, capacity;
    uint32_t refused;
    uint32_t first_line, first_column;
    char first_reason[160];
} metar_reader;

static void refuse(metar_reader *reader, uint32_t line, uint32_t column, const char *station, const char *reason) {
    ++reader->refused;
    if (!reader->first_line) {
        reader->first_line = line;
        reader->first_column = column;
        snprintf(reader->first_reason, sizeof(reader->first_reason), "%s: %s", *station ? station : "report", reason);
    }
    weather_refuse(reader->report, "%.100s:%u: %s: %s", reader->name, line, *station ? station : "report", reason);
}

/* 1: a number; 0: empty; -1: something else. */
static int take_number(const metar_field *field, double *value) {
    char text[40];
    char *end = NULL;
    if (!field->text || !field->size) {
        return 0;
    }
    if (field->size >= sizeof(text)) {
        return -1;
    }
    memcpy(text, field->text, field->size);
    text[field->size] = '\0';
    *value = strtod(text, &end);
    return end != text && *end == '\0' && strspn(text, "+-.0123456789eE") == field->size && isfinite(*value) ? 1 : -1;
}

static int64_t days_from_civil(int64_t year, int month, int day) {
    /* Proleptic Gregorian calendar (Hinnant 2013, "chrono-compatible low-level date algorithms"). */
    year -= month <= 2;
    const int64_t era = (year >= 0 ? year : year - 399) / 400;
    const int64_t of_era = year - era * 400;
    const int64_t of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

static int take_time(const metar_field *field, int64_t *minute) {
    char text[40];
    int year, month, day, hour, minutes;
    if (!field->text || field->size < 16 || field->size >= sizeof(text)) {
        return 0;
    }
    memcpy(text, field->text, field->size);
    text[field->size] = '\0';
    if (sscanf(text, "%4d-%2d-%2dT%2d:%2d", &year, &month, &day, &hour, &minutes) != 5 || month < 1 || month > 12 ||
        day < 1 || day > 31 || hour < 0 || hour > 23 || minutes < 0 || minutes > 59) {
        return 0;
    }
    *minute = days_from_civil(year, month, day) * 1440 + hour * 60 + minutes;
    return 1;
}

static int take_columns(candidate *to, const metar_record *record, char reason[96], uint32_t *column) {
    double lat = 0.0, lon = 0.0, elevation = 0.0;
    const int has_lat = take_number(&record->lat, &lat), has_lon = take_number(&record->lon, &lon);
    const int has_elevation = take_number(&record->elevation, &elevation);
    *column = record->lat.column;
    if (has_lat < 0 || fabs(lat) > 90.0) {
        snprintf(reason, 96, "latitude: found %.*s, expected -90 to 90",
                 (int)(record->lat.size < 20 ? record->lat.size : 20), record->lat.text);
        return 0;
    }
    *column = record->lon.column;
    if (has_lon < 0 || lon < -180.0 || lon > 360.0) {
        snprintf(reason, 96, "longitude: found %.*s, expected -180 to 360",
                 (int)(record->lon.size < 20 ? record->lon.size : 20), record->lon.text);
        return 0;
    }
    *column = record->elevation.column;
    if (has_elevation < 0 || elevation < -500.0 || elevation > 9000.0) {
        snprintf(reason, 96, "elevation: found %.*s, expected -500 to 9000 m",
                 (int)(record->elevation.size < 20 ? record->elevation.size : 20), record->elevation.text);
        return 0;
    }
    to->has_place = has_lat && has_lon;
    to->lat_deg = lat;
    to->lon_deg = lon;
    to->elevation_m = (float)elevation;
    return 1;
}

static int has_name(const velum_weather_station *station, const char *name) {
    return strncmp(station->name, name, sizeof(station->name)) == 0;
}

static velum_result find_place(metar_reader *reader, candidate *to, velum_weather_error *error) {
    const velum_weather_station_options *options = reader->options;
    for (uint32_t i = 0; options && options->stations && i < options->station_count; ++i) {
        const velum_weather_station *station = &options->stations[i];
        if (has_name(station, to->report.station)) {
            to->has_place = 1;
            to->lat_deg = station->lat_deg;
            to->lon_deg = station->lon_deg;
            to->elevation_m = station->elevation_m;
            return VELUM_OK;
        }
    }
    if (!reader->table_tried) {
        const char *path = options ? options->table_path : NULL;
        reader->table_tried = 1;
        const velum_result result =
            weather_stations_read(&reader->table, path ? path : WEATHER_STATION_TABLE, path ? error : NULL);
        /* The system's table may be absent; one that was asked for may not. */
        if (result && (path || result == VELUM_ERROR_OUT_OF_MEMORY)) {
            return path ? result : weather_out_of_memory(error, reader->name);
        }
    }
    const velum_weather_station *station = weather_stations_find(&reader->table, to->report.station);
    if (station) {
        to->has_place = 1;
        to->lat_deg = station->lat_deg;
        to->lon_deg = station->lon_deg;
    }
    return VELUM_OK;
}

static velum_result take_record(metar_reader *reader, const metar_record *record, velum_weather_error *error) {
    if (reader->count == MAX_REPORTS) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, reader->name, record->line, 1, "found more than %d reports",
                            MAX_REPORTS);
    }
    if (reader->count == reader->capacity) {
        const uint32_t capacity = reader->capacity ? reader->capacity * 2 : 1024;
        candidate *more = realloc(reader->candidates, capacity * sizeof(*more));
        if (!more) {
            return weather_out_of_memory(error, reader->name);
        }
        reader->candidates = more;
        reader->capacity = capacity;
    }
    candidate *to = &reader->candidates[reader->count];
    char reason[96];
    size_t offset = 0;
    uint32_t column = record->raw.column;
    memset(to, 0, sizeof(*to));
    to->line = record->line;
    const int is_decoded = metar_decode(record->raw.text ? record->raw.text : "",
                                        record->raw.text ? record->raw.size : 0, &to->report, reason, &offset);
    if (record->reason[0]) {
        refuse(reader, record->line, record->reason_column ? record->reason_column : 1, to->report.station,
               record->reason);
        return VELUM_OK;
    }
    if (!is_decoded) {
        refuse(reader, record->line, column + (uint32_t)offset, to->report.station, reason);
        return VELUM_OK;
    }
    if (!take_columns(to, record, reason, &column)) {
        refuse(reader, record->line, column, to->report.station, reason);
        return VELUM_OK;
    }
    to->has_date = take_time(&record->time, &to->minute);
    if (!to->has_date) {
        to->minute = to->report.minute_of_month;
    }
    if (!to->has_place) {
        const velum_result result = find_place(reader, to, error);
        if (result) {
            return result;
        }
    }
    if (!to->has_place) {
        refuse(reader, record->line, record->raw.column, to->report.station,
               "no position in the file, the scenario or the station table");
        return VELUM_OK;
    }
    ++reader->count;
    return VELUM_OK;
}

/* Above 0: a is the newer. Without dates, days of the month go round. */
static int64_t newer(const candidate *a, const candidate *b) {
    if (a->has_date && b->has_date) {
        return a->minute - b->minute;
    }
    const int64_t a_minute = a->report.minute_of_month, b_minute = b->report.minute_of_month;
    const int64_t apart = ((a_minute - b_minute) % MINUTES_IN_CYCLE + MINUTES_IN_CYCLE) % MINUTES_IN_CYCLE;
    return apart > MINUTES_IN_CYCLE / 2 ? apart - MINUTES_IN_CYCLE : apart;
}

static int by_station(const void *a, const void *b) {
    const candidate *const *first = a, *const *second = b;
    const int order = memcmp((*first)->report.station, (*second)->report.station, sizeof((*first)->report.station));
    return order ? order : ((*first)->line > (*second)->line) - ((*first)->line < (*second)->line);
}

/* Marks all but the newest report of each station; of the same time, the later line holds. */
static velum_result keep_newest(metar_reader *reader, velum_weather_error *error) {
    if (!reader->count) {
        return VELUM_OK;
    }
    candidate **order = malloc(reader->count * sizeof(*order));
    if (!order) {
        return weather_out_of_memory(error, reader->name);
    }
    for (uint32_t i = 0; i < reader->count; ++i) {
        order[i] = &reader->candidates[i];
    }
    qsort(order, reader->count, sizeof(*order), by_station);
    candidate *best = order[0];
    for (uint32_t i = 1; i < reader->count; ++i) {
        candidate *one = order[i];
        if (memcmp(one->report.station, best->report.station, sizeof(best->report.station)) != 0) {
            best = one;
            continue;
        }
        const int64_t later = newer(one, best);
        if (later >= 0) {
            best->newer_line = one->line;
            best->is_same_time = later == 0;
            best = one;
        } else {
            one->newer_line = best->line;
        }
    }
    free(order);
    return VELUM_OK;
}

static velum_result make_cells(metar_reader *reader, velum_weather_set *set, uint32_t *stations, uint32_t *layer_count,
                               velum_weather_error *error) {
    const float radius_m = reader->options ? reader->options->radius_m : 0.0f;
    for (uint32_t i = 0; i < reader->count; ++i) {
        const candidate *from = &reader->candidates[i];
        if (from->newer_line) {
            char reason[96];
            snprintf(reason, sizeof(reason), "%s the report of line %u",
                     from->is_same_time ? "same time as" : "older than", from->newer_line);
            refuse(reader, from->line, 1, from->report.station, reason);
            continue;
        }
        velum_layer layers[METAR_MAX_CLOUDS + 1];
        velum_cell *cell = weather_set_add_cell(set);
        if (!cell) {
            return weather_out_of_memory(error, reader->name);
        }
        cell->kind = VELUM_CELL_STATION;
        cell->lat_deg = from->lat_deg;
        cell->lon_deg = from->lon_deg;
        cell->elevation_m = from->elevation_m;
        cell->radius_m = radius_m > 0.0f ? (double)radius_m : 60000.0;
        metar_fill_cell(&from->report, cell);
        const uint32_t count =
            cell->flags & VELUM_CELL_HAS_LAYERS ? metar_layers(&from->report, from->elevation_m, layers) : 0;
        velum_layer *own = weather_set_layers(set, cell, count);
        if (count && !own) {
            return weather_out_of_memory(error, reader->name);
        }
        if (count) {
            memcpy(own, layers, count * sizeof(*own));
        }
        *layer_count += count;
        ++*stations;
    }
    return VELUM_OK;
}

static velum_result check_options(const velum_weather_station_options *options, velum_weather_error *error) {
    if (!options) {
        return VELUM_OK;
    }
    if (options->radius_m != 0.0f && !(options->radius_m >= 1000.0f && options->radius_m <= 500000.0f)) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, NULL, 0, 0,
                            "station radius: found %g m, expected 1000 to 500000", (double)options->radius_m);
    }
    for (uint32_t i = 0; options->stations && i < options->station_count; ++i) {
        const velum_weather_station *station = &options->stations[i];
        if (!(fabs(station->lat_deg) <= 90.0) || !(station->lon_deg >= -180.0 && station->lon_deg <= 360.0) ||
            !(station->elevation_m >= -500.0f && station->elevation_m <= 9000.0f)) {
            return weather_fail(error, VELUM_ERROR_ARGUMENT, NULL, 0, 0,
                                "station %.8s: found latitude %g, longitude %g, elevation %g m, expected -90 to 90, "
                                "-180 to 360, -500 to 9000",
                                station->name, station->lat_deg, station->lon_deg, (double)station->elevation_m);
        }
    }
    return VELUM_OK;
}

static velum_result read_records(metar_reader *reader, const char *text, size_t size, velum_weather_error *error) {
    metar_file file;
    velum_result result = metar_file_open(&file, reader->name, text, size, error);
    int got = 1;
    while (!result && got) {
        metar_record record;
        result = metar_file_next(&file, &record, &got, error);
        if (!result && got) {
            result = take_record(reader, &record, error);
        }
    }
    if (!result && !reader->count) {
        result = reader->first_line
                     ? weather_fail(error, VELUM_ERROR_ARGUMENT, reader->name, reader->first_line, reader->first_column,
                                    "no usable METAR report; %s", reader->first_reason)
                     : weather_fail(error, VELUM_ERROR_ARGUMENT, reader->name, file.line, 1,
                                    "no METAR report: found the end of the file");
    }
    return result;
}

velum_result velum_weather_read_metar_memory(velum_weather_set *set, const char *name, const char *text, uint64_t size,
                                             const velum_weather_station_options *options, velum_weather_report *report,
                                             velum_weather_error *error) {
    if (!set || (!text && size) || size > WEATHER_MAX_FILE_BYTES) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, 0, 0,
                            "found a null set, null text or more than %d bytes", WEATHER_MAX_FILE_BYTES);
    }
    velum_result result = check_options(options, error);
    if (result) {
        return result;
    }
    /* An error leaves the report as it was, too. */
    velum_weather_report *draft = report ? malloc(sizeof(*draft)) : NULL;
    if (report && !draft) {
        return weather_out_of_memory(error, name);
    }
    if (draft) {
        *draft = *report;
    }
    metar_reader reader = {.name = name ? name : "METAR", .options = options, .report = draft};
    const weather_set_mark_point mark = weather_set_mark(set);
    uint32_t stations = 0, layers = 0;
    result = read_records(&reader, text ? text : "", (size_t)size, error);
    result = result ? result : keep_newest(&reader, error);
    result = result ? result : make_cells(&reader, set, &stations, &layers, error);
    if (result) {
        weather_set_rollback(set, &mark);
    } else if (report) {
        draft->stations_read += stations;
        draft->stations_refused += reader.refused;
        draft->layers += layers;
        *report = *draft;
    }
    weather_stations_finish(&reader.table);
    free(reader.candidates);
    free(draft);
    return result;
}

velum_result velum_weather_read_metar(velum_weather_set *set, const char *path,
                                      const velum_weather_station_options *options, velum_weather_report *report,
                                      velum_weather_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    velum_result result = weather_read_file(path, &bytes, &size, error);
    if (!result) {
        result = velum_weather_read_metar_memory(set, path, bytes, size, options, report, error);
    }
    free(bytes);
    return result;
}
