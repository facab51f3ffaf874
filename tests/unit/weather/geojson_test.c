#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <velum_weather/weather.h>

#include <cmocka.h>

#include "near.h"

#define FEATURE(properties, geometry)                                                                                  \
    "{\"type\": \"Feature\", \"properties\": " properties ", \"geometry\": " geometry "}"
#define COLLECTION(features) "{\"type\": \"FeatureCollection\", \"features\": [\n" features "]}"
#define SQUARE "{\"type\": \"Polygon\", \"coordinates\": [[[8,50],[9,50],[9,51],[8,51],[8,50]]]}"
#define FOG "{\"visibility_m\": 800}"

typedef struct outcome {
    velum_weather_set *set;
    velum_weather_report report;
    velum_weather_error error;
    velum_state_desc desc;
    velum_result result;
} outcome;

static outcome *read_text(const char *text) {
    outcome *o = calloc(1, sizeof *o);
    assert_non_null(o);
    o->set = velum_weather_set_create();
    o->result = velum_weather_read_geojson_memory(o->set, "r.geojson", text, strlen(text), &o->report, &o->error);
    velum_weather_set_state(o->set, &o->desc);
    return o;
}

static void finish(outcome *o) {
    velum_weather_set_destroy(o->set);
    free(o);
}

static void a_region_is_read_whole(void **state) {
    (void)state;
    outcome *o = read_text(COLLECTION(FEATURE(
        "{\"name\": \"a front\", \"layers\": [{\"type\": \"Ns\", \"coverage\": 0.9, \"base_m\": 600, \"top_m\": 4000, "
        "\"wind_from_deg\": 270, \"wind_m_s\": 12, \"precipitation\": \"snow\", \"precipitation_mm_h\": 3}, "
        "{\"type\": \"Ci\", \"coverage\": 0.2, \"base_m\": 8000, \"top_m\": 9000}], "
        "\"visibility_m\": 4000, \"transition_m\": 20000, \"merge\": true, \"priority\": 3, \"wind_from_deg\": 180, "
        "\"wind_m_s\": 5, \"gust_m_s\": 9, \"temperature_c\": 0, \"dew_point_c\": -2, \"elevation_m\": 100, "
        "\"fog_top_m\": 250, \"thunderstorm\": true, \"precipitation_mm_h\": 2}",
        "{\"type\": \"Polygon\", \"coordinates\": [[[8,50,17],[9,50],[9,51.5],[8,51],[8,50]],"
        "[[8.2,50.2],[8.4,50.2],[8.4,50.4],[8.2,50.2]]]}")));
    assert_int_equal(o->result, VELUM_OK);
    assert_int_equal(o->report.regions_read, 1);
    assert_int_equal(o->report.regions_refused, 0);
    assert_int_equal(o->report.layers, 2);
    assert_int_equal(o->desc.cell_count, 1);
    const velum_cell *cell = o->desc.cells;
    assert_int_equal(cell->struct_size, sizeof *cell);
    assert_int_equal(cell->kind, VELUM_CELL_POLYGON);
    assert_int_equal(cell->flags, VELUM_CELL_MERGE_LAYERS | VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY |
                                      VELUM_CELL_HAS_WIND | VELUM_CELL_HAS_PRECIPITATION | VELUM_CELL_HAS_TEMPERATURE);
    assert_true(cell->id > 0);
    assert_int_equal(cell->priority, 3);
    assert_int_equal(cell->ring_count, 2);
    assert_int_equal(cell->ring_sizes[0], 4);
    assert_int_equal(cell->ring_sizes[1], 3);
    assert_int_equal(cell->point_count, 7);
    assert_near(cell->points[2].lat_deg, 51.5, 0);
    assert_near(cell->points[2].lon_deg, 9, 0);
    assert_near(cell->points[6].lat_deg, 50.4, 0);
    assert_near(cell->visibility_m, 4000, 0);
    assert_near(cell->transition_m, 20000, 0);
    assert_near(cell->wind_north_m_s, 5, 1e-5); /* from the south */
    assert_near(cell->wind_east_m_s, 0, 1e-5);
    assert_near(cell->gust_m_s, 9, 0);
    assert_near(cell->temperature_k, 273.15, 1e-4);
    assert_near(cell->dew_point_k, 271.15, 1e-4);
    assert_near(cell->elevation_m, 100, 0);
    assert_near(cell->fog_top_m, 250, 0);
    assert_int_equal(cell->thunderstorm, 1);
    assert_int_equal(cell->precipitation, VELUM_PRECIPITATION_RAIN);
    assert_near(cell->precipitation_mm_h, 2, 0);
    const velum_layer *ns = cell->layers, *ci = cell->layers + 1;
    assert_int_equal(ns->genus, VELUM_GENUS_NS);
    assert_int_equal(ns->water, VELUM_WATER_LIQUID);
    assert_near(ns->wind_east_m_s, 12, 1e-5); /* from the west */
    assert_near(ns->wind_north_m_s, 0, 1e-5);
    assert_int_equal(ns->precipitation, VELUM_PRECIPITATION_SNOW);
    assert_true(ns->water_g_m3 > 0 && ns->radius_um > 0); /* defaults of the genus */
    assert_int_equal(ci->water, VELUM_WATER_ICE);
    assert_int_equal(ci->precipitation, VELUM_PRECIPITATION_NONE);
    assert_true(ci->water_g_m3 < ns->water_g_m3 / 5);
    finish(o);
}

static void a_lone_feature_and_no_layers_are_enough(void **state) {
    (void)state;
    outcome *o = read_text(FEATURE("{\"layers\": []}", SQUARE));
    assert_int_equal(o->result, VELUM_OK);
    assert_int_equal(o->desc.cells[0].flags, VELUM_CELL_HAS_LAYERS); /* a clear sky */
    assert_int_equal(o->desc.cells[0].layer_count, 0);
    finish(o);
}

/* RFC 7946 section 3.1.9. */
static void a_region_over_the_antimeridian_is_taken_as_split(void **state) {
    (void)state;
    outcome *o = read_text(
        FEATURE(FOG, "{\"type\": \"MultiPolygon\", \"coordinates\": [[[[170,40],[180,40],[180,50],[170,50],[170,40]]],"
                     "[[[-180,40],[-170,40],[-170,50],[-180,50],[-180,40]]]]}"));
    assert_int_equal(o->result, VELUM_OK);
    assert_int_equal(o->report.regions_read, 1);
    assert_int_equal(o->desc.cells[0].ring_count, 2);
    assert_int_equal(o->desc.cells[0].point_count, 8);
    assert_near(o->desc.cells[0].points[1].lon_deg, 180, 0);
    assert_near(o->desc.cells[0].points[4].lon_deg, -180, 0);
    finish(o);
}

static void one_bad_feature_is_named_and_left_out(void **state) {
    (void)state;
    static const struct {
        const char *feature, *reason;
    } bad[] = {
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8,91],[9,50],[9,51],[8,91]]]}"),
         "geometry.coordinates[0][0][1]: found 91, expected a number from -90 to 90"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[181,1],[9,50],[9,51],[8,91]]]}"),
         "geometry.coordinates[0][0][0]: found 181, expected a number from -180 to 180"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8,50],[9,50],[9,51],[8,51]]]}"),
         "geometry.coordinates[0]: found an array of 4, expected a closed ring: its last position like its first"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8,50],[9,50],[8,50]]]}"),
         "geometry.coordinates[0]: found an array of 3, expected an array of at least 4"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8,50],[8,50],[8,50],[8,50]]]}"),
         "geometry.coordinates[0]: found an array of 4, expected a ring that encloses an area"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8,50],[9,51],[9,50],[8,51],[8,50]]]}"),
         "geometry.coordinates[0]: found an array of 5, expected a simple one: this ring crosses itself near 8.5, 50.5 "
         "(lon, lat)"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8,50],[9,51],[9,50],[8,53],[8,50]]]}"),
         "geometry.coordinates[0]: found an array of 5, expected a simple one: this ring crosses itself near 8.75, "
         "50.75 (lon, lat)"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": []}"),
         "geometry.coordinates: found an array of 0, expected an array of at least 1"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[8],[9,50],[9,51],[8,50]]]}"),
         "geometry.coordinates[0][0]: found an array of 1, expected an array of at least 2"},
        {FEATURE(FOG, "{\"type\": \"Polygon\", \"coordinates\": [[[178,1],[-178,1],[-178,2],[178,1]]]}"),
         "geometry.coordinates[0][1]: found an array of 2, expected an edge over at most 180 degrees of longitude: "},
        {FEATURE(FOG, "{\"type\": \"Point\", \"coordinates\": [8, 50]}"),
         "geometry.type: found \"Point\", expected Polygon or MultiPolygon"},
        {FEATURE(FOG, "null"), "geometry: found null, expected a Polygon or MultiPolygon"},
        {FEATURE(FOG, "{\"type\": \"Polygon\"}"), "geometry.coordinates: found nothing, expected an array"},
        {FEATURE("null", SQUARE), "properties: found null, expected an object"},
        {FEATURE("{\"name\": \"x\"}", SQUARE), "properties: found an object, expected one with \"layers\""},
        {FEATURE("{\"layer\": []}", SQUARE), "properties.layer: found an unknown field, expected layers"},
        {FEATURE("{\"visibility_m\": -5}", SQUARE),
         "properties.visibility_m: found -5, expected a number from 1 to 1000000"},
        {FEATURE("{\"layers\": [{\"type\": \"Sc\", \"coverage\": 7, \"base_m\": 0, \"top_m\": 9}]}", SQUARE),
         "properties.layers[0].coverage: found 7, expected a number from 0 to 1"},
        {"{\"type\": \"Fature\"}", "type: found \"Fature\", expected Feature"},
        {"7", "found 7, expected an object"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        char text[2048], expected[300];
        snprintf(text, sizeof text, COLLECTION(FEATURE(FOG, SQUARE) ",\n%s,\n" FEATURE("{\"layers\": []}", SQUARE)),
                 bad[i].feature);
        snprintf(expected, sizeof expected, "r.geojson:3: feature 2: %s", bad[i].reason);
        expected[199] = '\0';
        outcome *o = read_text(text);
        assert_int_equal(o->result, VELUM_OK);
        assert_int_equal(o->report.regions_read, 2);
        assert_int_equal(o->report.regions_refused, 1);
        assert_int_equal(o->report.refusal_count, 1);
        assert_int_equal(o->desc.cell_count, 2);
        assert_int_equal(o->desc.cells[1].flags, VELUM_CELL_HAS_LAYERS);
        if (strncmp(o->report.refusals[0].text, expected, strlen(expected)) != 0) {
            fail_msg("found \"%s\", expected \"%s\"", o->report.refusals[0].text, expected);
        }
        finish(o);
    }
}

static void a_file_of_no_use_is_refused_whole(void **state) {
    (void)state;
    static const struct {
        const char *text, *error;
    } bad[] = {
        {"{}", "r.geojson:1:1: type: found nothing, expected FeatureCollection or Feature"},
        {"[]", "r.geojson:1:1: found an array of 0, expected an object"},
        {"{\"type\":\n \"Polygon\"}", "r.geojson:2:2: type: found \"Polygon\", expected FeatureCollection or Feature"},
        {"{\"type\": \"FeatureCollection\"}", "r.geojson:1:1: features: found nothing, expected an array"},
        {"{\"type\": \"FeatureCollection\",\n\"features\": {}}",
         "r.geojson:2:13: features: found an object, expected an array"},
        {COLLECTION(""), "r.geojson:1:43: features: found an array of 0, expected at least one Feature"},
        {FEATURE(FOG, "null"), "r.geojson:1:70: geometry: found null, expected a Polygon or MultiPolygon"},
        {COLLECTION("1,\n2"), "r.geojson:2:1: found no usable feature among 2, expected at least one; the first: found "
                              "1, expected an object"},
        {"{\"type\": ", "r.geojson:1:10: "},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        outcome *o = read_text(bad[i].text);
        assert_int_equal(o->result, VELUM_ERROR_ARGUMENT);
        assert_int_equal(o->desc.cell_count, 0);
        if (strncmp(o->error.text, bad[i].error, strlen(bad[i].error)) != 0) {
            fail_msg("found \"%s\", expected \"%s\"", o->error.text, bad[i].error);
        }
        finish(o);
    }
}

static void an_error_leaves_the_set_as_it_was(void **state) {
    (void)state;
    outcome *o = read_text(FEATURE(FOG, SQUARE));
    const char *bad = COLLECTION("1, 2");
    assert_int_equal(velum_weather_read_geojson_memory(o->set, "b", bad, strlen(bad), NULL, NULL),
                     VELUM_ERROR_ARGUMENT);
    assert_int_equal(velum_weather_read_geojson_memory(NULL, "b", bad, strlen(bad), NULL, &o->error),
                     VELUM_ERROR_ARGUMENT);
    assert_int_equal(velum_weather_read_geojson(o->set, "/nonexistent/x.geojson", NULL, &o->error), VELUM_ERROR_STATE);
    assert_int_equal(velum_weather_read_geojson_memory(o->set, NULL, NULL, 0, NULL, NULL), VELUM_ERROR_ARGUMENT);
    velum_weather_set_state(o->set, &o->desc);
    assert_int_equal(o->desc.cell_count, 1);
    assert_int_equal(o->desc.cells[0].point_count, 4);
    finish(o);
}

static void thousands_of_bad_features_are_counted(void **state) {
    (void)state;
    enum { COUNT = 3000 };
    char *text = malloc(COUNT * 16 + 1024);
    assert_non_null(text);
    size_t used = (size_t)sprintf(text, "{\"type\": \"FeatureCollection\", \"features\": [");
    for (int i = 0; i < COUNT; i++) {
        used += (size_t)sprintf(text + used, "{\"a\": %d},\n", i);
    }
    sprintf(text + used, FEATURE(FOG, SQUARE) "]}");
    outcome *o = read_text(text);
    assert_int_equal(o->result, VELUM_OK);
    assert_int_equal(o->report.regions_read, 1);
    assert_int_equal(o->report.regions_refused, COUNT);
    assert_int_equal(o->report.refusal_count, 64);
    finish(o);
    free(text);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_region_is_read_whole),
        cmocka_unit_test(a_lone_feature_and_no_layers_are_enough),
        cmocka_unit_test(a_region_over_the_antimeridian_is_taken_as_split),
        cmocka_unit_test(one_bad_feature_is_named_and_left_out),
        cmocka_unit_test(a_file_of_no_use_is_refused_whole),
        cmocka_unit_test(an_error_leaves_the_set_as_it_was),
        cmocka_unit_test(thousands_of_bad_features_are_counted),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
