#include "scenario_weather.h"

#include "error.h"
#include "json_layer.h"
#include "set.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_KEYS = 4096, MAX_SOURCES = 4096 };
static const double MOST_TIME_S = 1e9;

typedef struct source_reader {
    const json_document *document;
    const char *directory;
    velum_weather_set *set;
    velum_weather_report *report;
} source_reader;

int32_t scenario_extra_kind(const char *bytes, size_t size) {
    size_t at = size >= 3 && memcmp(bytes, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
    /* a bulletin heading may stand before the first message */
    if (memmem(bytes, size < 128 ? size : 128, "GRIB", 4)) {
        return SCENARIO_EXTRA_GRIB;
    }
    while (at < size && (bytes[at] == ' ' || bytes[at] == '\t' || bytes[at] == '\r' || bytes[at] == '\n')) {
        at++;
    }
    return at < size && (bytes[at] == '{' || bytes[at] == '[') ? SCENARIO_EXTRA_GEOJSON : SCENARIO_EXTRA_METAR;
}

/* *path: malloc, the caller's. */
static velum_result read_path(const source_reader *reader, const json_node *source, const char *key, int required,
                              char **path) {
    const char *name = NULL;
    *path = NULL;
    TRY(json_read_string(reader->document, source, key, required, 1, 4000, &name));
    if (!name) {
        return VELUM_OK;
    }
    const char *directory = name[0] == '/' ? "" : reader->directory;
    size_t size = strlen(directory) + strlen(name) + 2;
    *path = malloc(size);
    if (!*path) {
        return weather_out_of_memory(reader->document->error, reader->document->name);
    }
    snprintf(*path, size, "%s%s%s", directory, *directory && directory[strlen(directory) - 1] != '/' ? "/" : "", name);
    return VELUM_OK;
}

typedef velum_result read_file(velum_weather_set *set, const char *path, velum_weather_report *report,
                               velum_weather_error *error);

/* A source that is a path and nothing else. */
static velum_result read_plain(const source_reader *reader, const json_node *source, const char *key, read_file *read) {
    const char *const keys[] = {key, NULL};
    char *path = NULL;
    TRY(json_expect_keys(reader->document, source, keys));
    TRY(read_path(reader, source, key, JSON_REQUIRED, &path));
    velum_result result = read(reader->set, path, reader->report, reader->document->error);
    free(path);
    return result;
}

static velum_result read_station(const json_document *document, const json_node *node, velum_weather_station *out) {
    static const char *const keys[] = {"name", "lat_deg", "lon_deg", "elevation_m", NULL};
    const char *name = "";
    TRY(json_expect_keys(document, node, keys));
    TRY(json_read_string(document, node, "name", JSON_REQUIRED, 3, sizeof out->name - 1, &name));
    if (strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789") != strlen(name)) {
        return json_refuse(document, json_member(document, node, "name"), "capital letters and digits");
    }
    snprintf(out->name, sizeof out->name, "%s", name);
    TRY(json_read_double(document, node, "lat_deg", JSON_REQUIRED, -90, 90, &out->lat_deg));
    TRY(json_read_double(document, node, "lon_deg", JSON_REQUIRED, -180, 180, &out->lon_deg));
    return json_read_float(document, node, "elevation_m", JSON_REQUIRED, -500, 9000, &out->elevation_m);
}

static velum_result read_metar(const source_reader *reader, const json_node *source) {
    static const char *const keys[] = {"metar", "stations", "station_table", "radius_m", NULL};
    const json_document *document = reader->document;
    velum_weather_station_options options = {0};
    velum_weather_station *stations = NULL;
    char *path = NULL, *table_path = NULL;
    velum_result result = json_expect_keys(document, source, keys);
    if (result < 0) {
        goto error;
    }
    const json_node *list = json_member(document, source, "stations");
    if (list) {
        result = json_expect_array(document, list, 0, 1000000);
        if (result < 0) {
            goto error;
        }
        stations = calloc(list->count + 1u, sizeof *stations);
        if (!stations) {
            result = weather_out_of_memory(document->error, document->name);
            goto error;
        }
        for (const json_node *node = json_first(document, list); node; node = json_next(document, node)) {
            result = read_station(document, node, &stations[options.station_count++]);
            if (result < 0) {
                goto error;
            }
        }
    }
    options.stations = stations;
    result = json_read_float(document, source, "radius_m", JSON_OPTIONAL, 1000, 500000, &options.radius_m);
    if (result < 0) {
        goto error;
    }
    result = read_path(reader, source, "station_table", JSON_OPTIONAL, &table_path);
    if (result < 0) {
        goto error;
    }
    options.table_path = table_path;
    result = read_path(reader, source, "metar", JSON_REQUIRED, &path);
    if (result < 0) {
        goto error;
    }
    result = velum_weather_read_metar(reader->set, path, &options, reader->report, document->error);
error:
    free(path);
    free(table_path);
    free(stations);
    return result;
}

static velum_result read_global(const source_reader *reader, const json_node *source) {
    static const char *const outer[] = {"global", NULL};
    static const char *const keys[] = {JSON_WEATHER_KEYS, NULL};
    const json_document *document = reader->document;
    TRY(json_expect_keys(document, source, outer));
    const json_node *object = json_member(document, source, "global");
    TRY(json_expect_keys(document, object, keys));
    velum_cell *cell = weather_set_add_cell(reader->set);
    if (!cell) {
        return weather_out_of_memory(document->error, document->name);
    }
    cell->kind = VELUM_CELL_GLOBAL;
    velum_result result = json_read_weather(document, object, reader->set, cell);
    if (result < 0) {
        return result == VELUM_ERROR_OUT_OF_MEMORY ? weather_out_of_memory(document->error, document->name) : result;
    }
    if (reader->report) {
        reader->report->layers += cell->layer_count;
    }
    return VELUM_OK;
}

static velum_result read_rectangle(const json_document *document, const json_node *object, velum_weather_set *set,
                                   velum_cell *cell) {
    static const char *const keys[] = {JSON_WEATHER_KEYS, JSON_REGION_KEYS,  "lat_deg",      "lon_deg", "half_east_m",
                                       "half_north_m",    "corner_radius_m", "rotation_deg", NULL};
    TRY(json_expect_keys(document, object, keys));
    cell->kind = VELUM_CELL_RECTANGLE;
    TRY(json_read_double(document, object, "lat_deg", JSON_REQUIRED, -90, 90, &cell->lat_deg));
    TRY(json_read_double(document, object, "lon_deg", JSON_REQUIRED, -180, 180, &cell->lon_deg));
    TRY(json_read_double(document, object, "half_east_m", JSON_REQUIRED, 1, 5e6, &cell->half_east_m));
    TRY(json_read_double(document, object, "half_north_m", JSON_REQUIRED, 1, 5e6, &cell->half_north_m));
    double least_m = cell->half_east_m < cell->half_north_m ? cell->half_east_m : cell->half_north_m;
    TRY(json_read_double(document, object, "corner_radius_m", JSON_OPTIONAL, 0, least_m, &cell->corner_radius_m));
    TRY(json_read_double(document, object, "rotation_deg", JSON_OPTIONAL, -360, 360, &cell->rotation_deg));
    return json_read_region(document, object, set, cell);
}

static velum_result read_region(const source_reader *reader, const json_node *source) {
    static const char *const outer[] = {"region", NULL};
    const json_document *document = reader->document;
    TRY(json_expect_keys(document, source, outer));
    velum_cell *cell = weather_set_add_cell(reader->set);
    velum_result result = VELUM_ERROR_OUT_OF_MEMORY;
    if (cell) {
        result = read_rectangle(document, json_member(document, source, "region"), reader->set, cell);
    }
    if (result == VELUM_ERROR_OUT_OF_MEMORY) {
        return weather_out_of_memory(document->error, document->name);
    }
    if (result >= 0 && reader->report) {
        reader->report->regions_read++;
        reader->report->layers += cell->layer_count;
    }
    return result;
}

static velum_result read_source(const source_reader *reader, const json_node *source) {
    const json_document *document = reader->document;
    TRY(json_expect_object(document, source));
    if (json_member(document, source, "grib")) {
        return read_plain(reader, source, "grib", velum_weather_read_grib);
    }
    if (json_member(document, source, "metar")) {
        return read_metar(reader, source);
    }
    if (json_member(document, source, "geojson")) {
        return read_plain(reader, source, "geojson", velum_weather_read_geojson);
    }
    if (json_member(document, source, "global")) {
        return read_global(reader, source);
    }
    if (json_member(document, source, "region")) {
        return read_region(reader, source);
    }
    return json_refuse(document, source, "an object with one of grib, metar, geojson, global, region");
}

static velum_result read_extra(const source_reader *reader, const scenario_extra *extra) {
    velum_weather_error *error = reader->document->error;
    switch (extra->kind) {
    case SCENARIO_EXTRA_GRIB:
        return velum_weather_read_grib_memory(reader->set, extra->path, extra->bytes, extra->size, reader->report,
                                              error);
    case SCENARIO_EXTRA_GEOJSON:
        return velum_weather_read_geojson_memory(reader->set, extra->path, extra->bytes, extra->size, reader->report,
                                                 error);
    default:
        return velum_weather_read_metar_memory(reader->set, extra->path, extra->bytes, extra->size, NULL,
                                               reader->report, error);
    }
}

/* Sources in turn, then the extras. */
static velum_result read_sources(const source_reader *reader, const json_node *sources, const scenario_extra *extras,
                                 uint32_t extra_count, int is_first) {
    const json_document *document = reader->document;
    for (const json_node *source = json_first(document, sources); source; source = json_next(document, source)) {
        TRY(read_source(reader, source));
    }
    source_reader further = *reader;
    further.report = is_first ? reader->report : NULL; /* the same for every key: counted once */
    for (uint32_t i = 0; i < extra_count; i++) {
        TRY(read_extra(&further, &extras[i]));
    }
    return VELUM_OK;
}

static velum_result read_key(const json_document *document, const json_node *node, const velum_scenario_key *before,
                             velum_scenario_key *key) {
    static const char *const keys[] = {"time_s", "transition_s", "sources", NULL};
    TRY(json_expect_keys(document, node, keys));
    TRY(json_read_double(document, node, "time_s", JSON_REQUIRED, -MOST_TIME_S, MOST_TIME_S, &key->time_s));
    TRY(json_read_double(document, node, "transition_s", JSON_OPTIONAL, 0, MOST_TIME_S, &key->transition_s));
    if (!before) {
        key->transition_s = 0; /* there is nothing to blend from */
        return VELUM_OK;
    }
    if (!(key->time_s > before->time_s)) {
        return json_refuse(document, json_member(document, node, "time_s"),
                           "more than %.9g, the time of the key before", before->time_s);
    }
    if (key->transition_s > key->time_s - before->time_s) {
        return json_refuse(document, json_member(document, node, "transition_s"),
                           "at most %.9g, the time since the key before", key->time_s - before->time_s);
    }
    return VELUM_OK;
}

velum_result scenario_read_weather(const json_document *document, const char *directory, const scenario_extra *extras,
                                   uint32_t extra_count, velum_scenario *scenario, velum_weather_report *report) {
    const json_node *array = json_member(document, json_document_root(document), "weather");
    const json_node *node = json_first(document, array);
    source_reader reader = {.document = document, .directory = directory, .report = report};
    if (array) {
        TRY(json_expect_array(document, array, 0, MAX_KEYS));
    }
    uint32_t count = array && array->count ? array->count : 1; /* without a key: a clear sky, for the extras */
    scenario->keys = calloc(count, sizeof *scenario->keys);
    if (!scenario->keys) {
        return weather_out_of_memory(document->error, document->name);
    }
    for (uint32_t i = 0; i < count; i++, node = json_next(document, node)) {
        velum_scenario_key *key = &scenario->keys[i];
        key->set = velum_weather_set_create();
        scenario->key_count = i + 1;
        if (!key->set) {
            return weather_out_of_memory(document->error, document->name);
        }
        const json_node *sources = NULL;
        if (node) {
            TRY(read_key(document, node, i ? key - 1 : NULL, key));
            sources = json_member(document, node, "sources");
            if (!sources) {
                return json_refuse_missing(document, node, "sources", "an array");
            }
            TRY(json_expect_array(document, sources, 0, MAX_SOURCES));
        }
        reader.set = key->set;
        TRY(read_sources(&reader, sources, extras, extra_count, i == 0));
    }
    return VELUM_OK;
}
