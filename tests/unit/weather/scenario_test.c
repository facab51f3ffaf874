#include "scenario.h"

#include "scenario_weather.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <velum_weather/weather.h>

#include <cmocka.h>

#include "near.h"
#include "tests/files.h"

static velum_scenario *load(const char *text) {
    velum_scenario *scenario = NULL;
    velum_weather_error error = {0};
    if (velum_scenario_load_memory("s.json", "", text, strlen(text), &scenario, NULL, &error) != VELUM_OK) {
        fail_msg("%s", error.text);
    }
    return scenario;
}

static velum_state_desc state_of(const velum_scenario *scenario, uint32_t key) {
    velum_state_desc desc;
    velum_weather_set_state(scenario->keys[key].set, &desc);
    return desc;
}

/* A scenario with every part, without files. */
static void the_example_is_read_whole(void **state) {
    (void)state;
    velum_scenario *s =
        load("{ \"velum\": 1, \"title\": \"Example\", \"start\": \"2014-12-18T08:00:00Z\", \"duration_s\": 3600, "
             "\"seed\": 7,\n"
             "  \"sun\": {\"azimuth_deg\": 180, \"elevation_deg\": 30, \"illuminance_lx\": [128000, 127000, 126000]},\n"
             "  \"atmosphere\": \"none\",   \"ground\": {\"albedo\": [0.1, 0.2, 0.3]}, \"geoid_undulation_m\": 47.5,\n"
             "  \"weather\": [ {\"time_s\": 0, \"transition_s\": 600, \"sources\": [\n"
             "      {\"global\": {\"visibility_m\": 9999, \"layers\": [\n"
             "          {\"type\": \"Sc\", \"coverage\": 0.5, \"base_m\": 900, \"top_m\": 1500, \"water_g_m3\": 0.3,\n"
             "           \"radius_um\": 10, \"wind_from_deg\": 270, \"wind_m_s\": 12} ]}} ]},\n"
             "    {\"time_s\": 900, \"transition_s\": 300.5, \"sources\": []} ],\n"
             "  \"camera\": [ {\"time_s\": 0, \"lat_deg\": 50.03, \"lon_deg\": 8.55, \"height_m\": 300,\n"
             "                 \"heading_deg\": 90, \"pitch_deg\": -1, \"roll_deg\": 2} ],\n"
             "  \"channels\": [ {\"name\": \"left\", \"yaw_deg\": -40, \"pitch_deg\": 1, \"roll_deg\": 2,\n"
             "                   \"hfov_deg\": 40, \"size\": [640, 360]}, {\"name\": \"right\"} ] }\n");
    assert_string_equal(s->title, "Example");
    assert_near(s->start_unix_s, 1418889600, 0);
    assert_near(s->duration_s, 3600, 0);
    assert_int_equal(s->seed, 7);
    assert_int_equal(s->sun, VELUM_SCENARIO_SUN_FIXED);
    assert_near(s->sun_azimuth_deg, 180, 0);
    assert_near(s->sun_elevation_deg, 30, 0);
    assert_near(s->sun_illuminance_lx[2], 126000, 0);
    assert_int_equal(s->atmosphere_none, 1);
    assert_near(s->ground_albedo[1], 0.2, 1e-7);
    assert_near(s->geoid_undulation_m, 47.5, 0);
    assert_int_equal(s->key_count, 2);
    assert_near(s->keys[0].transition_s, 0, 0); /* nothing to blend from */
    assert_near(s->keys[1].time_s, 900, 0);
    assert_near(s->keys[1].transition_s, 300.5, 0);
    velum_state_desc first = state_of(s, 0), second = state_of(s, 1);
    assert_int_equal(second.cell_count, 0);
    assert_int_equal(first.cell_count, 1);
    const velum_cell *cell = first.cells;
    assert_int_equal(cell->kind, VELUM_CELL_GLOBAL);
    assert_int_equal(cell->flags, VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY);
    assert_near(cell->visibility_m, 9999, 0);
    const velum_layer *sc = cell->layers;
    assert_int_equal(sc->struct_size, sizeof *sc);
    assert_int_equal(sc->flags, 0);
    assert_int_equal(sc->genus, VELUM_GENUS_SC);
    assert_near(sc->coverage, 0.5, 0);
    assert_near(sc->base_m, 900, 0);
    assert_near(sc->top_m, 1500, 0);
    assert_near(sc->water_g_m3, 0.3, 1e-7);
    assert_near(sc->radius_um, 10, 0);
    assert_near(sc->wind_east_m_s, 12, 1e-5);
    assert_int_equal(s->camera_count, 1);
    assert_near(s->cameras[0].heading_deg, 90, 0);
    assert_near(s->cameras[0].roll_deg, 2, 0);
    assert_int_equal(s->channel_count, 2);
    assert_string_equal(s->channels[0].name, "left");
    assert_near(s->channels[0].hfov_deg, 40, 0);
    assert_int_equal(s->channels[0].width, 640);
    assert_int_equal(s->channels[0].height, 360);
    assert_int_equal(s->channels[1].width, 1280);
    velum_scenario_destroy(s);
}

static void defaults_are_those_of_format_md(void **state) {
    (void)state;
    velum_scenario *s = load("{\"velum\": 1, \"start\": \"2024-06-21T12:00Z\", "
                             "\"camera\": [{\"lat_deg\": 1, \"lon_deg\": 2, \"height_m\": 3}]}");
    assert_string_equal(s->title, "");
    assert_near(s->start_unix_s, 1718971200, 0);
    assert_near(s->duration_s, 0, 0);
    assert_int_equal(s->seed, 0);
    assert_int_equal(s->sun, VELUM_SCENARIO_SUN_COMPUTED);
    assert_near(s->sun_illuminance_lx[0], 128000, 0);
    assert_int_equal(s->atmosphere_none, 0);
    assert_near(s->ground_albedo[2], 0.1, 1e-7);
    assert_int_equal(s->key_count, 1);
    assert_int_equal(state_of(s, 0).cell_count, 0);
    assert_near(s->cameras[0].time_s, 0, 0);
    assert_int_equal(s->channel_count, 1);
    assert_string_equal(s->channels[0].name, "main");
    assert_near(s->channels[0].hfov_deg, 60, 0);
    velum_scenario_destroy(s);
}

static void measurement_layers_and_rectangles(void **state) {
    (void)state;
    velum_scenario *s = load(
        "{\"velum\": 1, \"sun\": {\"azimuth_deg\": 0, \"elevation_deg\": 90, \"illuminance_lx\": [1, 1, 1]},"
        "\"camera\": [{\"lat_deg\": 0, \"lon_deg\": 0, \"height_m\": 0}], \"weather\": [{\"time_s\": 0, \"sources\": ["
        "{\"global\": {\"layers\": [{\"type\": \"St\", \"structure\": \"uniform\", \"base_m\": 1000, \"top_m\": 2000,"
        "\"extinction_1_m\": 0.01, \"albedo\": 0.9, \"phase\": {\"hg\": 0.85}}]}},"
        "{\"region\": {\"lat_deg\": 10, \"lon_deg\": -20, \"half_east_m\": 3000, \"half_north_m\": 2000,"
        "\"corner_radius_m\": 500, \"rotation_deg\": 30, \"transition_m\": 700, \"merge\": true, \"priority\": -2,"
        "\"visibility_m\": 50}}]}]}");
    velum_state_desc desc = state_of(s, 0);
    assert_int_equal(desc.cell_count, 2);
    const velum_layer *slab = desc.cells[0].layers;
    assert_int_equal(slab->flags,
                     VELUM_LAYER_UNIFORM | VELUM_LAYER_EXTINCTION | VELUM_LAYER_PHASE_HG | VELUM_LAYER_ALBEDO);
    assert_near(slab->coverage, 1, 0);
    assert_near(slab->extinction_1_m, 0.01, 1e-9);
    assert_near(slab->albedo, 0.9, 1e-7);
    assert_near(slab->hg_asymmetry, 0.85, 1e-7);
    const velum_cell *rectangle = desc.cells + 1;
    assert_int_equal(rectangle->kind, VELUM_CELL_RECTANGLE);
    assert_int_equal(rectangle->flags, VELUM_CELL_HAS_VISIBILITY | VELUM_CELL_MERGE_LAYERS);
    assert_true(rectangle->id != desc.cells[0].id);
    assert_near(rectangle->lat_deg, 10, 0);
    assert_near(rectangle->lon_deg, -20, 0);
    assert_near(rectangle->half_east_m, 3000, 0);
    assert_near(rectangle->half_north_m, 2000, 0);
    assert_near(rectangle->corner_radius_m, 500, 0);
    assert_near(rectangle->rotation_deg, 30, 0);
    assert_near(rectangle->transition_m, 700, 0);
    assert_int_equal(rectangle->priority, -2);
    velum_scenario_destroy(s);
}

#define HEAD "{\"velum\": 1, \"start\": \"2024-06-21T12:00:00Z\",\n"
#define CAMERA "\"camera\": [{\"time_s\": 0, \"lat_deg\": 1, \"lon_deg\": 2, \"height_m\": 3}]"
#define TAIL ",\n" CAMERA "}"
#define KEYS(keys) HEAD "\"weather\": [" keys "]" TAIL
#define SOURCES(sources) KEYS("{\"time_s\": 0, \"sources\": [\n" sources "]}")
#define LAYER(fields) SOURCES("{\"global\": {\"layers\": [{\"type\": \"Sc\",\n" fields "}]}}")
#define REGION(fields) SOURCES("{\"region\": {\"lat_deg\": 0, \"half_east_m\": 9, \"half_north_m\": 5,\n" fields "}}")
#define STATION(fields) SOURCES("{\"metar\": \"m.txt\", \"stations\": [{\n" fields "}]}")

static void what_is_wrong_is_named_with_its_place(void **state) {
    (void)state;
    static const struct {
        const char *text, *error;
    } bad[] = {
        {"", "s.json:1:1: '[' or '{' expected near end of file, expected JSON"},
        {"[]", "s.json:1:1: found an array of 0, expected an object"},
        {"{}", "s.json:1:1: velum: found nothing, expected 1"},
        {"{\"velum\": 2}", "s.json:1:11: velum: found 2, expected 1"},
        {HEAD "\"velum\": 1}", "s.json:2:1: duplicate object key"},
        {HEAD "\"seed\": NaN" TAIL, "s.json:2:9: invalid token near 'NaN', expected JSON"},
        {HEAD "\"wether\": []" TAIL, "s.json:2:1: wether: found an unknown field, expected one of velum, title, "},
        {HEAD "\"title\": 5" TAIL, "s.json:2:10: title: found 5, expected a string of 0 to 127 bytes"},
        {HEAD "\"duration_s\": -1" TAIL, "s.json:2:15: duration_s: found -1, expected a number from 0 to 1e+09"},
        {HEAD "\"duration_s\": \"1\"" TAIL, "s.json:2:15: duration_s: found \"1\", expected a number from 0 to 1e+09"},
        {HEAD "\"seed\": 1.5" TAIL, "s.json:2:9: seed: found 1.5, expected an integer from 0 to 9223372036854775807"},
        {HEAD "\"atmosphere\": \"mars\"" TAIL, "s.json:2:15: atmosphere: found \"mars\", expected one of earth, none"},
        {HEAD "\"ground\": {\"albedo\": [0, 0, 2]}" TAIL,
         "s.json:2:29: ground.albedo[2]: found 2, expected a number from 0 to 1"},
        {HEAD "\"geoid_undulation_m\": 999" TAIL,
         "s.json:2:23: geoid_undulation_m: found 999, expected a number from -200 to 200"},
        {HEAD "\"sun\": {\"azimuth_deg\": 5}" TAIL,
         "s.json:2:8: sun.elevation_deg: found nothing, expected a number from -90 to 90"},
        {HEAD "\"sun\": {\"illuminance_lx\": 128000}" TAIL,
         "s.json:2:27: sun.illuminance_lx: found 128000, expected an array of 3"},
        {"{\"velum\": 1" TAIL, "s.json:1:1: start: found nothing, expected a time like "},
        {"{\"velum\": 1,\n\"start\": \"2024-13-01T00:00:00Z\"" TAIL,
         "s.json:2:10: start: found \"2024-13-01T00:00:00Z\", expected a time in UTC, 1900 to 2199, like "},
        /* camera */
        {HEAD "\"title\": \"x\"}", "s.json:1:1: camera: found nothing, expected an array of at least 1"},
        {HEAD "\"camera\": []}", "s.json:2:11: camera: found an array of 0, expected an array of 1 to 1000000"},
        {HEAD "\"camera\": [{\"lat_deg\": 91, \"lon_deg\": 2, \"height_m\": 3}]}",
         "s.json:2:24: camera[0].lat_deg: found 91, expected a number from -90 to 90"},
        {HEAD "\"camera\": [{\"lat_deg\": 1, \"lon_deg\": 2}]}",
         "s.json:2:12: camera[0].height_m: found nothing, expected a number from -10000 to 50000000"},
        {HEAD "\"camera\": [{\"lat_deg\": 1, \"lon_deg\": 2, \"height_m\": 6e7}]}",
         "s.json:2:53: camera[0].height_m: found 60000000, expected a number from -10000 to 50000000"},
        {HEAD "\"camera\": [{\"lat_deg\": 1, \"lon_deg\": 2, \"height_m\": 3},\n"
              "{\"time_s\": 0, \"lat_deg\": 1, \"lon_deg\": 2, \"height_m\": 3}]}",
         "s.json:3:12: camera[1].time_s: found 0, expected more than 0, the time of the keyframe before"},
        /* channels */
        {HEAD "\"channels\": []" TAIL, "s.json:2:13: channels: found an array of 0, expected an array of 1 to 64"},
        {HEAD "\"channels\": [{\"name\": \"../x\"}]" TAIL,
         "s.json:2:23: channels[0].name: found \"../x\", expected letters, digits, _ and -"},
        {HEAD "\"channels\": [{\"name\": \"a\"}, {\"name\": \"a\"}]" TAIL,
         "s.json:2:38: channels[1].name: found \"a\", expected a name that no other channel has"},
        {HEAD "\"channels\": [{\"name\": \"a\", \"hfov_deg\": 180}]" TAIL,
         "s.json:2:40: channels[0].hfov_deg: found 180, expected a number from 0.01 to 170"},
        {HEAD "\"channels\": [{\"name\": \"a\", \"size\": [640, 0]}]" TAIL,
         "s.json:2:42: channels[0].size[1]: found 0, expected an integer from 1 to 8192"},
        /* weather keys */
        {HEAD "\"weather\": {}" TAIL, "s.json:2:12: weather: found an object, expected an array of 0 to 4096"},
        {KEYS("5"), "s.json:2:13: weather[0]: found 5, expected an object"},
        {KEYS("{\"time_s\": 0}"), "s.json:2:13: weather[0].sources: found nothing, expected an array"},
        {KEYS("{\"time_s\": 5, \"sources\": []}, {\"time_s\": 5, \"sources\": []}"),
         "s.json:2:54: weather[1].time_s: found 5, expected more than 5, the time of the key before"},
        {KEYS("{\"time_s\": 5, \"sources\": []}, {\"time_s\": 9, \"transition_s\": 6, \"sources\": []}"),
         "s.json:2:73: weather[1].transition_s: found 6, expected at most 4, the time since the key before"},
        {SOURCES("{}"), "s.json:3:1: weather[0].sources[0]: found an object, expected an object with one of grib, "},
        {SOURCES("{\"grib\": \"\"}"),
         "s.json:3:10: weather[0].sources[0].grib: found \"\", expected a string of 1 to 4000 bytes"},
        {SOURCES("{\"grib\": \"a\", \"metar\": \"b\"}"),
         "s.json:3:15: weather[0].sources[0].metar: found an unknown field, expected one of grib"},
        {SOURCES("{\"geojson\": \"/nonexistent/x.geojson\"}"), "/nonexistent/x.geojson: cannot be read: "},
        {SOURCES("{\"global\": 5}"), "s.json:3:12: weather[0].sources[0].global: found 5, expected an object"},
        {SOURCES("{\"global\": {\"merge\": true}}"),
         "s.json:3:13: weather[0].sources[0].global.merge: found an unknown field, expected one of layers, "},
        {SOURCES("{\"global\": {\"visibility_m\": 0}}"),
         "s.json:3:29: weather[0].sources[0].global.visibility_m: found 0, expected a number from 1 to 1000000"},
        {SOURCES("{\"global\": {\"wind_m_s\": 5}}"), "s.json:3:12: weather[0].sources[0].global.wind_from_deg: found "
                                                     "nothing, expected a number from 0 to 360"},
        {SOURCES("{\"global\": {\"gust_m_s\": 5}}"),
         "s.json:3:25: weather[0].sources[0].global.gust_m_s: found 5, expected it only beside wind_m_s"},
        {SOURCES("{\"global\": {\"temperature_c\": 5, \"dew_point_c\": 6}}"),
         "s.json:3:48: weather[0].sources[0].global.dew_point_c: found 6, expected at most temperature_c, 5"},
        {SOURCES("{\"global\": {\"precipitation\": \"rain\"}}"),
         "s.json:3:12: weather[0].sources[0].global.precipitation_mm_h: found nothing, expected a number from 0 to "},
        /* layers */
        {SOURCES("{\"global\": {\"layers\": [{\"type\": \"Kumulus\"}]}}"),
         "s.json:3:33: weather[0].sources[0].global.layers[0].type: found \"Kumulus\", expected one of Ci, Cc, Cs, Ac, "
         "As, Ns, Sc, St, Cu, Cb"},
        {SOURCES("{\"global\": {\"layers\": [{}]}}"),
         "s.json:3:24: weather[0].sources[0].global.layers[0].type: found nothing, expected one of Ci, "},
        {LAYER("\"coverage\": 7, \"base_m\": 0, \"top_m\": 9"),
         "s.json:4:13: weather[0].sources[0].global.layers[0].coverage: found 7, expected a number from 0 to 1"},
        {LAYER("\"coverage\": 1, \"base_m\": 9, \"top_m\": 9"),
         "s.json:4:38: weather[0].sources[0].global.layers[0].top_m: found 9, expected a number above base_m, 9"},
        {LAYER("\"coverage\": 1, \"base_m\": 9, \"top_m\": 99999"),
         "s.json:4:38: weather[0].sources[0].global.layers[0].top_m: found 99999, expected a number from -500 to "
         "25000"},
        {LAYER("\"coverage\": 1, \"base\": 9"),
         "s.json:4:16: weather[0].sources[0].global.layers[0].base: found an unknown field, expected one of type, "},
        {LAYER("\"coverage\": 1, \"base_m\": 0, \"top_m\": 9, \"water_g_m3\": -1"),
         "s.json:4:55: weather[0].sources[0].global.layers[0].water_g_m3: found -1, expected a number from 0 to 20"},
        {LAYER("\"coverage\": 1, \"base_m\": 0, \"top_m\": 9, \"radius_um\": 1e400"),
         "s.json:4:54: real number overflow"},
        {LAYER("\"coverage\": 1, \"albedo\": 0.5"), "s.json:4:26: weather[0].sources[0].global.layers[0].albedo: found "
                                                    "0.5, expected it only where \"structure\" is "
                                                    "\"uniform\""},
        {LAYER("\"extinction_1_m\": 1, \"radius_um\": 5"),
         "s.json:4:19: weather[0].sources[0].global.layers[0].extinction_1_m: found 1, expected either extinction_1_m "
         "or "
         "water_g_m3 and radius_um, not both"},
        {LAYER("\"structure\": \"uniform\", \"coverage\": 0.5"),
         "s.json:4:37: weather[0].sources[0].global.layers[0].coverage: found 0.5, expected 1"},
        {LAYER("\"structure\": \"uniform\", \"phase\": {\"hg\": 1}"),
         "s.json:4:41: weather[0].sources[0].global.layers[0].phase.hg: found 1, expected a number from -0.999 to "
         "0.999"},
        {LAYER("\"coverage\": 1, \"base_m\": 0, \"top_m\": 9, \"precipitation\": \"none\", \"precipitation_mm_h\": 1"),
         "s.json:4:88: weather[0].sources[0].global.layers[0].precipitation_mm_h: found 1, expected 0 where "},
        /* regions and stations */
        {REGION("\"visibility_m\": 9"),
         "s.json:3:12: weather[0].sources[0].region.lon_deg: found nothing, expected a number from -180 to 180"},
        {REGION("\"lon_deg\": 0"), "s.json:3:12: weather[0].sources[0].region: found an object, expected one with "},
        {REGION("\"lon_deg\": 0, \"corner_radius_m\": 6"),
         "s.json:4:34: weather[0].sources[0].region.corner_radius_m: found 6, expected a number from 0 to 5"},
        {REGION("\"lon_deg\": 0, \"visibility_m\": 9, \"merge\": 1"),
         "s.json:4:43: weather[0].sources[0].region.merge: found 1, expected true or false"},
        {STATION("\"name\": \"eddf\""),
         "s.json:4:9: weather[0].sources[0].stations[0].name: found \"eddf\", expected capital letters and digits"},
        {STATION("\"name\": \"EDDF\", \"lat_deg\": -91"),
         "s.json:4:28: weather[0].sources[0].stations[0].lat_deg: found -91, expected a number from -90 to 90"},
        {SOURCES("{\"metar\": \"m.txt\", \"radius_m\": 5}"),
         "s.json:3:32: weather[0].sources[0].radius_m: found 5, expected a number from 1000 to 500000"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        velum_weather_error error = {0};
        velum_scenario *scenario = (velum_scenario *)&error;
        velum_result result =
            velum_scenario_load_memory("s.json", "", bad[i].text, strlen(bad[i].text), &scenario, NULL, &error);
        if (result >= 0 || strncmp(error.text, bad[i].error, strlen(bad[i].error)) != 0) {
            fail_msg("%s\nfound \"%s\", expected \"%s\"", bad[i].text, error.text, bad[i].error);
        }
        assert_null(scenario);
        velum_scenario_load_memory("s.json", "", bad[i].text, strlen(bad[i].text), &scenario, NULL, NULL);
        assert_null(scenario);
    }
}

static void times_are_utc(void **state) {
    (void)state;
    double t = 0;
    assert_true(scenario_parse_utc("1970-01-01T00:00:00Z", &t));
    assert_near(t, 0, 0);
    assert_true(scenario_parse_utc("2000-02-29T23:59:59.5Z", &t));
    assert_near(t, 951868799.5, 1e-6);
    assert_true(scenario_parse_utc("1900-03-01T00:00Z", &t));
    assert_near(t, -2203891200.0, 0);
    assert_true(scenario_parse_utc("2199-12-31T00:00:00Z", &t));
    assert_near(t, 7258032000.0, 0);
    static const char *const bad[] = {"",
                                      "2014-12-18",
                                      "2014-12-18T08:00:00",
                                      "2014-12-18T08:00:00+01:00",
                                      "2014-12-18 08:00:00Z",
                                      "2023-02-29T00:00:00Z",
                                      "1900-02-29T00:00:00Z",
                                      "2014-12-18T24:00:00Z",
                                      "2014-12-18T08:60:00Z",
                                      "2014-12-18T08:00:60Z",
                                      "2014-12-18T08:00:00.Z",
                                      "2014-12-18T08:00:00Zx",
                                      "1899-12-31T00:00:00Z",
                                      "2014-12-18T8:00:00Z",
                                      "-014-12-18T08:00:00Z"};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        if (scenario_parse_utc(bad[i], &t)) {
            fail_msg("taken for a time: \"%s\"", bad[i]);
        }
    }
}

static void kinds_of_further_sources_go_by_content(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int32_t kind;
    } cases[] = {{"GRIB....", SCENARIO_EXTRA_GRIB},
                 {"HTXX00 KWBC 181200\r\r\nGRIB", SCENARIO_EXTRA_GRIB},
                 {" \n{\"type\": 1}", SCENARIO_EXTRA_GEOJSON},
                 {"\xef\xbb\xbf{", SCENARIO_EXTRA_GEOJSON},
                 {"[1]", SCENARIO_EXTRA_GEOJSON},
                 {"EDDF 180820Z 24008KT", SCENARIO_EXTRA_METAR},
                 {"", SCENARIO_EXTRA_METAR}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        assert_int_equal(scenario_extra_kind(cases[i].text, strlen(cases[i].text)), cases[i].kind);
    }
}

static void write_file(const char *directory, const char *name, const char *text) {
    char path[512];
    snprintf(path, sizeof path, "%s/%s", directory, name);
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    assert_int_equal(fwrite(text, 1, strlen(text), file), strlen(text));
    assert_int_equal(fclose(file), 0);
}

/* Paths are relative to the scenario; further sources join every key, after its own, and are counted once. */
static void files_are_found_beside_the_scenario(void **state) {
    (void)state;
    char directory[] = "/tmp/velum-scenario-XXXXXX", path[512], extra_path[512];
    assert_non_null(mkdtemp(directory));
    const char *square =
        "{\"type\":\"Feature\",\"properties\":{\"visibility_m\":%d},\"geometry\":{\"type\":\"Polygon\","
        "\"coordinates\":[[[8,50],[9,50],[9,51],[8,50]]]}}";
    char region[512];
    snprintf(region, sizeof region, square, 111);
    write_file(directory, "own.geojson", region);
    snprintf(region, sizeof region, square, 222);
    write_file(directory, "extra.json", region);
    write_file(
        directory, "s.json",
        KEYS("{\"time_s\": 0, \"sources\": [{\"geojson\": \"own.geojson\"}]}, {\"time_s\": 9, \"sources\": []}"));
    write_file(directory, "broken.json", KEYS("{\"time_s\": 0, \"sources\": [{\"geojson\": \"s.json\"}]}"));

    snprintf(path, sizeof path, "%s/s.json", directory);
    snprintf(extra_path, sizeof extra_path, "%s/extra.json", directory);
    const char *extra[] = {extra_path};
    velum_weather_report report = {0};
    velum_weather_error error = {0};
    velum_scenario *s = NULL;
    if (velum_scenario_load(path, extra, 1, &s, &report, &error) != VELUM_OK) {
        fail_msg("%s", error.text);
    }
    assert_int_equal(s->key_count, 2);
    assert_int_equal(state_of(s, 0).cell_count, 2);
    assert_near(state_of(s, 0).cells[0].visibility_m, 111, 0);
    assert_near(state_of(s, 0).cells[1].visibility_m, 222, 0);
    assert_int_equal(state_of(s, 1).cell_count, 1);
    assert_near(state_of(s, 1).cells[0].visibility_m, 222, 0);
    assert_int_equal(report.regions_read, 2);
    velum_scenario_destroy(s);

    snprintf(path, sizeof path, "%s/broken.json", directory);
    assert_int_equal(velum_scenario_load(path, NULL, 0, &s, NULL, &error), VELUM_ERROR_ARGUMENT);
    assert_null(s);
    assert_non_null(strstr(error.text, "/s.json:1:1: type: found nothing, expected FeatureCollection or Feature"));
    snprintf(path, sizeof path, "%s/s.json", directory);
    extra[0] = "/nonexistent/extra";
    assert_int_equal(velum_scenario_load(path, extra, 1, &s, NULL, &error), VELUM_ERROR_STATE);
    assert_string_equal(error.file, "/nonexistent/extra");
    assert_int_equal(velum_scenario_load(directory, NULL, 0, &s, NULL, &error), VELUM_ERROR_STATE);
    assert_int_equal(velum_scenario_load(NULL, NULL, 0, &s, NULL, &error), VELUM_ERROR_ARGUMENT);
    assert_int_equal(velum_scenario_load(path, NULL, 1, &s, NULL, &error), VELUM_ERROR_ARGUMENT);
    assert_int_equal(velum_scenario_load(path, NULL, 0, NULL, NULL, NULL), VELUM_ERROR_ARGUMENT);
    velum_scenario_destroy(NULL);

    static const char *const names[] = {"own.geojson", "extra.json", "s.json", "broken.json"};
    for (int i = 0; i < 4; i++) {
        snprintf(path, sizeof path, "%s/%s", directory, names[i]);
        unlink(path);
    }
    rmdir(directory);
}

/* The scenarios that come with the sample host: all can be read, fit edge to edge and move. */
static void our_own_scenarios_are_good(void **state) {
    (void)state;
    static const char *const names[] = {"fair_weather", "front",       "thunderstorm", "overcast_low_visibility",
                                        "pole",         "antimeridian"};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char name[64], path[1024];
        velum_scenario *s = NULL;
        velum_weather_error error = {0};
        snprintf(name, sizeof name, "sample_host/scenarios/%s.json", names[i]);
        source_path(path, name);
        velum_weather_report *report = calloc(1, sizeof *report);
        assert_non_null(report);
        if (velum_scenario_load(path, NULL, 0, &s, report, &error) != VELUM_OK) {
            fail_msg("%s", error.text);
        }
        assert_int_equal(report->regions_refused, 0);
        assert_true(report->layers > 0);
        assert_int_equal(s->channel_count, 3);
        for (int c = 0; c < 3; c++) {
            assert_near(s->channels[c].yaw_deg, (c - 1) * s->channels[c].hfov_deg, 0);
            assert_int_equal(s->channels[c].width, 640);
            assert_int_equal(s->channels[c].height, 360);
        }
        assert_true(s->duration_s >= 60 && s->duration_s <= 600);
        double a[3], b[3], r[3], u[3], f[3], sun[3], metres = 0, elevation = 0, axes[3][3];
        for (double t = 0; t + 1 <= s->duration_s; t += 1) {
            velum_scenario_camera pose;
            velum_scenario_pose(s, t, &pose);
            velum_scenario_pose_ecef(&pose, a, r, u, f);
            velum_scenario_pose(s, t + 1, &pose);
            velum_scenario_pose_ecef(&pose, b, axes[0], axes[1], axes[2]);
            metres =
                sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
            if (metres < 60 || metres > 140 || f[0] * axes[2][0] + f[1] * axes[2][1] + f[2] * axes[2][2] < 0.9999) {
                fail_msg("%s: %g m from %g s to the next", names[i], metres, t);
            }
        }
        velum_scenario_sun(s, 0, sun);
        for (int k = 0; k < 3; k++) {
            elevation += sun[k] * a[k] / 6.36e6;
        }
        assert_true(elevation > 0.08); /* day */
        velum_scenario_destroy(s);
        free(report);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_example_is_read_whole),
        cmocka_unit_test(defaults_are_those_of_format_md),
        cmocka_unit_test(measurement_layers_and_rectangles),
        cmocka_unit_test(what_is_wrong_is_named_with_its_place),
        cmocka_unit_test(times_are_utc),
        cmocka_unit_test(kinds_of_further_sources_go_by_content),
        cmocka_unit_test(files_are_found_beside_the_scenario),
        cmocka_unit_test(our_own_scenarios_are_good),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
