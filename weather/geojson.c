#include "geojson.h"

#include "error.h"
#include "json_layer.h"
#include "ring.h"
#include "set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_POINTS = 1 << 20 };

static int type_is(const json_document *document, const json_node *object, const char *type) {
    const json_node *node = json_member(document, object, "type");
    return node && json_is_string(node->value) && strcmp(json_string_value(node->value), type) == 0;
}

static velum_result refuse_type(const json_document *document, const json_node *object, const char *expected) {
    const json_node *node = json_member(document, object, "type");
    return node ? json_refuse(document, node, "%s", expected) : json_refuse_missing(document, object, "type", expected);
}

static velum_result read_position(const json_document *document, const json_node *node, velum_lat_lon *out) {
    TRY(json_expect_array(document, node, 2, UINT32_MAX));
    const json_node *lon = json_first(document, node);
    TRY(json_number(document, lon, -180, 180, &out->lon_deg));
    return json_number(document, json_next(document, lon), -90, 90, &out->lat_deg);
}

/* A linear ring (RFC 7946 section 3.1.6) without its closing position. `points`: room for node->count - 1. */
static velum_result read_ring(const json_document *document, const json_node *ring, velum_lat_lon *points) {
    const json_node *node = json_first(document, ring);
    double area = 0;
    velum_lat_lon first = {0}, before = {0}, here = {0};
    for (uint32_t i = 0; node; i++, node = json_next(document, node)) {
        TRY(read_position(document, node, &here));
        double step_deg = fabs(here.lon_deg - before.lon_deg);
        if (i == 0) {
            first = here;
        } else if (step_deg > 180 && step_deg < 360) {
            return json_refuse(document, node,
                               "an edge over at most 180 degrees of longitude: regions over the antimeridian are split "
                               "(RFC 7946 section 3.1.9)");
        }
        area += i ? (before.lon_deg - first.lon_deg) * (here.lat_deg - first.lat_deg) -
                        (here.lon_deg - first.lon_deg) * (before.lat_deg - first.lat_deg)
                  : 0;
        before = here;
        if (i + 1 < ring->count) {
            points[i] = here;
        }
    }
    if (here.lat_deg != first.lat_deg || here.lon_deg != first.lon_deg) {
        return json_refuse(document, ring, "a closed ring: its last position like its first");
    }
    velum_result result = weather_ring_check(points, ring->count - 1, &here);
    if (result == VELUM_ERROR_OUT_OF_MEMORY) {
        return weather_out_of_memory(document->error, document->name);
    }
    if (result < 0) {
        return json_refuse(document, ring, "a simple one: this ring crosses itself near %.6g, %.6g (lon, lat)",
                           here.lon_deg, here.lat_deg);
    }
    return fabs(area) > 0 ? VELUM_OK : json_refuse(document, ring, "a ring that encloses an area");
}

/* Rings of one polygon; counted only where cell->points is null. */
static velum_result read_polygon(const json_document *document, const json_node *polygon, velum_lat_lon *points,
                                 uint32_t *ring_sizes, velum_cell *cell) {
    TRY(json_expect_array(document, polygon, 1, UINT32_MAX));
    for (const json_node *ring = json_first(document, polygon); ring; ring = json_next(document, ring)) {
        TRY(json_expect_array(document, ring, 4, UINT32_MAX));
        if (points) {
            TRY(read_ring(document, ring, points + cell->point_count));
            ring_sizes[cell->ring_count] = ring->count - 1;
        }
        cell->ring_count++;
        cell->point_count += ring->count - 1;
    }
    return VELUM_OK;
}

static velum_result read_polygons(const json_document *document, const json_node *geometry, velum_lat_lon *points,
                                  uint32_t *ring_sizes, velum_cell *cell) {
    const json_node *coordinates = json_member(document, geometry, "coordinates");
    if (!coordinates) {
        return json_refuse_missing(document, geometry, "coordinates", "an array");
    }
    cell->ring_count = 0;
    cell->point_count = 0;
    if (type_is(document, geometry, "Polygon")) {
        return read_polygon(document, coordinates, points, ring_sizes, cell);
    }
    TRY(json_expect_array(document, coordinates, 1, UINT32_MAX));
    for (const json_node *polygon = json_first(document, coordinates); polygon;
         polygon = json_next(document, polygon)) {
        TRY(read_polygon(document, polygon, points, ring_sizes, cell));
    }
    return VELUM_OK;
}

static velum_result read_geometry(const json_document *document, const json_node *feature, velum_weather_set *set,
                                  velum_cell *cell) {
    const json_node *geometry = json_member(document, feature, "geometry");
    if (!geometry) {
        return json_refuse_missing(document, feature, "geometry", "a Polygon or MultiPolygon");
    }
    if (!json_is_object(geometry->value)) {
        return json_refuse(document, geometry, "a Polygon or MultiPolygon");
    }
    if (!type_is(document, geometry, "Polygon") && !type_is(document, geometry, "MultiPolygon")) {
        return refuse_type(document, geometry, "Polygon or MultiPolygon");
    }
    TRY(read_polygons(document, geometry, NULL, NULL, cell));
    if (cell->point_count > MAX_POINTS) {
        return json_refuse(document, json_member(document, geometry, "coordinates"), "at most %d positions",
                           MAX_POINTS);
    }
    velum_lat_lon *points = weather_set_alloc(set, cell->point_count, sizeof *points);
    uint32_t *ring_sizes = weather_set_alloc(set, cell->ring_count, sizeof *ring_sizes);
    if (!points || !ring_sizes) {
        return weather_out_of_memory(document->error, document->name);
    }
    TRY(read_polygons(document, geometry, points, ring_sizes, cell));
    cell->points = points;
    cell->ring_sizes = ring_sizes;
    return VELUM_OK;
}

static velum_result read_feature(const json_document *document, const json_node *feature, velum_weather_set *set,
                                 velum_cell *cell) {
    static const char *const keys[] = {JSON_WEATHER_KEYS, JSON_REGION_KEYS, NULL};
    TRY(json_expect_object(document, feature));
    if (!type_is(document, feature, "Feature")) {
        return refuse_type(document, feature, "Feature");
    }
    const json_node *properties = json_member(document, feature, "properties");
    if (!properties) {
        return json_refuse_missing(document, feature, "properties", "an object with \"layers\" or other weather");
    }
    TRY(json_expect_object(document, properties));
    TRY(json_expect_spelling(document, properties, keys));
    TRY(json_read_region(document, properties, set, cell));
    cell->kind = VELUM_CELL_POLYGON;
    return read_geometry(document, feature, set, cell);
}

/* Of "file:line:column: features[2].properties.x: found ...": "properties.x: found ...". */
static const char *reason_of(const json_document *document, const json_node *feature,
                             const velum_weather_error *error) {
    char prefix[512], path[64];
    const char *text = error->text;
    int length = snprintf(prefix, sizeof prefix, "%.400s%s%u:%u: ", document->name ? document->name : "",
                          document->name && *document->name ? ":" : "", error->line, error->column);
    text += length > 0 && (size_t)length < strlen(text) ? (size_t)length : 0;
    json_path(document, feature, path, sizeof path);
    size_t skip = strlen(path);
    if (skip && strncmp(text, path, skip) == 0) {
        text += skip;
        text += strspn(text, ".: ");
    }
    return text;
}

static void report_refusal(const json_document *document, const json_node *feature, uint32_t number,
                           const velum_weather_error *error, velum_weather_report *report) {
    const char *name = document->name ? document->name : "";
    size_t length = strlen(name);
    weather_refuse(report, "%s:%u: feature %u: %s", name + (length > 80 ? length - 80 : 0), error->line, number,
                   reason_of(document, feature, error));
}

velum_result geojson_read_document(velum_weather_set *set, json_document *document, velum_weather_report *report) {
    const json_node *root = json_document_root(document);
    const json_node *feature = root, *features = NULL;
    velum_weather_error *error = document->error;
    velum_weather_error first_refusal = {0};
    uint32_t read = 0, refused = 0, layers = 0;
    velum_result result = json_expect_object(document, root);
    if (result < 0) {
        return result;
    }
    if (type_is(document, root, "FeatureCollection")) {
        features = json_member(document, root, "features");
        result = features ? json_expect_array(document, features, 0, UINT32_MAX)
                          : json_refuse_missing(document, root, "features", "an array");
        feature = json_first(document, features);
    } else if (!type_is(document, root, "Feature")) {
        result = refuse_type(document, root, "FeatureCollection or Feature");
    }
    if (result < 0) {
        return result;
    }
    for (uint32_t number = 1; feature; number++) {
        velum_weather_error refusal = {0};
        weather_set_mark_point mark = weather_set_mark(set);
        velum_cell *cell = weather_set_add_cell(set);
        /* texts beyond those that a report holds are not worth the search for their lines */
        document->error = refused < WEATHER_MAX_REFUSAL_TEXTS ? &refusal : NULL;
        result = cell ? read_feature(document, feature, set, cell) : VELUM_ERROR_OUT_OF_MEMORY;
        document->error = error;
        if (result == VELUM_ERROR_OUT_OF_MEMORY) {
            return weather_out_of_memory(error, document->name);
        }
        if (result < 0) {
            weather_set_rollback(set, &mark);
            if (refused < WEATHER_MAX_REFUSAL_TEXTS) {
                report_refusal(document, feature, number, &refusal, report);
            }
            if (refused++ == 0) {
                first_refusal = refusal;
            }
        } else {
            read++;
            layers += cell->layer_count;
        }
        feature = features ? json_next(document, feature) : NULL;
    }
    if (report) {
        report->regions_read += read;
        report->regions_refused += refused;
        report->layers += layers;
    }
    if (read > 0) {
        return VELUM_OK;
    }
    if (refused == 0) {
        return json_refuse(document, features, "at least one Feature");
    }
    if (refused == 1 && error) {
        *error = first_refusal;
        return VELUM_ERROR_ARGUMENT;
    }
    const json_node *first = features ? json_first(document, features) : root;
    return weather_fail(error, VELUM_ERROR_ARGUMENT, document->name, first_refusal.line, first_refusal.column,
                        "found no usable feature among %u, expected at least one; the first: %s", refused,
                        reason_of(document, first, &first_refusal));
}

velum_result velum_weather_read_geojson_memory(velum_weather_set *set, const char *name, const char *text,
                                               uint64_t size, velum_weather_report *report,
                                               velum_weather_error *error) {
    if (!set || (!text && size)) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, 0, 0, "%s: found null, expected %s",
                            set ? "text" : "set", set ? "GeoJSON" : "a set");
    }
    json_document document = {0};
    velum_result result = json_document_init(&document, name, text ? text : "", size, error);
    if (result < 0) {
        return result;
    }
    weather_set_mark_point mark = weather_set_mark(set);
    result = geojson_read_document(set, &document, report);
    if (result < 0) {
        weather_set_rollback(set, &mark);
    }
    json_document_finish(&document);
    return result;
}

velum_result velum_weather_read_geojson(velum_weather_set *set, const char *path, velum_weather_report *report,
                                        velum_weather_error *error) {
    char *text = NULL;
    size_t size = 0;
    velum_result result = weather_read_file(path, &text, &size, error);
    if (result >= 0) {
        result = velum_weather_read_geojson_memory(set, path, text, size, report, error);
    }
    free(text);
    return result;
}
