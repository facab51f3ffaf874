#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <velum_weather/weather.h>

#include "tests/files.h"
#include "weather/stations.h"

static const char header[] = "raw_text,station_id,observation_time,latitude,longitude,elevation_m\n";
static const velum_weather_station two_stations[] = {
    {.name = "EDDF", .lat_deg = 50.05, .lon_deg = 8.6, .elevation_m = 100},
    {.name = "KAIA", .lat_deg = 42.05, .lon_deg = -102.8, .elevation_m = 1196}};
static const velum_weather_station_options two = {.stations = two_stations, .station_count = 2};

typedef struct fixture {
    velum_weather_set *set;
    velum_weather_report report;
    velum_weather_error error;
    velum_state_desc state;
    velum_result result;
} fixture;

static fixture *read_text(const char *text, const velum_weather_station_options *options) {
    fixture *f = calloc(1, sizeof(*f));
    const size_t size = strlen(text);
    char *copy = malloc(size ? size : 1); /* without a NUL: reads beyond are seen */
    memcpy(copy, text, size);
    f->set = velum_weather_set_create();
    f->result = velum_weather_read_metar_memory(f->set, "m", copy, size, options, &f->report, &f->error);
    velum_weather_set_state(f->set, &f->state);
    free(copy);
    if (f->result) {
        assert_int_equal(f->state.cell_count, 0);
        assert_int_equal(f->report.stations_read + f->report.stations_refused + f->report.refusal_count, 0);
        assert_true(f->error.text[0]);
    }
    return f;
}

static void finish(fixture *f) {
    velum_weather_set_destroy(f->set);
    free(f);
}

static fixture *good(const char *text) {
    fixture *f = read_text(text, &two);
    if (f->result) {
        print_error("%s\n", f->error.text);
    }
    assert_int_equal(f->result, VELUM_OK);
    return f;
}

static void refused_whole(const char *text, const char *expected) {
    fixture *f = read_text(text, &two);
    if (!strstr(f->error.text, expected)) {
        print_error("found '%s', expected '%s'\n", f->error.text, expected);
    }
    assert_true(f->result < 0);
    assert_non_null(strstr(f->error.text, expected));
    finish(f);
}

static void near_to(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) {
        print_error("found %g, expected %g\n", found, expected);
    }
    assert_true(fabs(found - expected) <= tolerance);
}

static void bases_are_above_the_station(void **state) {
    (void)state;
    fixture *f = good("METAR EDDF 180750Z 19010KT 4800 -DZ BKN003 OVC004 08/08 Q1013 BECMG 6000=\n");
    assert_int_equal(f->state.cell_count, 1);
    const velum_cell *cell = &f->state.cells[0];
    assert_int_equal(cell->kind, VELUM_CELL_STATION);
    near_to(cell->radius_m, 60000, 0);
    near_to(cell->lat_deg, 50.05, 0);
    near_to((double)cell->visibility_m, 4800, 0);
    /* From 190 degrees: towards north and a little east. */
    near_to((double)cell->wind_north_m_s, 5.14444 * cos(10 * M_PI / 180), 1e-3);
    near_to((double)cell->wind_east_m_s, 5.14444 * sin(10 * M_PI / 180), 1e-3);
    near_to((double)cell->temperature_k, 281.15, 1e-3);
    assert_int_equal(cell->precipitation, VELUM_PRECIPITATION_DRIZZLE);
    assert_int_equal(cell->layer_count, 2);
    near_to((double)cell->layers[0].base_m, 100 + 300 * 0.3048, 0.1);
    near_to((double)cell->layers[1].base_m, 100 + 400 * 0.3048, 0.1);
    assert_int_equal(cell->layers[0].genus, VELUM_GENUS_ST);
    assert_true(cell->layers[0].precipitation_mm_h + cell->layers[1].precipitation_mm_h > 0.0f);
    assert_true(cell->flags & VELUM_CELL_HAS_LAYERS && cell->flags & VELUM_CELL_HAS_WIND &&
                cell->flags & VELUM_CELL_HAS_VISIBILITY && cell->flags & VELUM_CELL_HAS_TEMPERATURE &&
                cell->flags & VELUM_CELL_HAS_PRECIPITATION);
    finish(f);
}

/* Sky groups are cumulative from below; at random overlap the layers up to each cover what its group says. */
static void coverage_sums_from_below(void **state) {
    (void)state;
    static const double sums[] = {1.5 / 8, 3.5 / 8, 6.0 / 8, 1.0};
    fixture *f = good("EDDF 180750Z FEW010 SCT030 BKN060 OVC200 15/05");
    const velum_cell *cell = &f->state.cells[0];
    assert_int_equal(cell->layer_count, 4);
    double clear = 1.0;
    for (int i = 0; i < 4; ++i) {
        clear *= 1.0 - (double)cell->layers[i].coverage;
        near_to(1.0 - clear, sums[i], 1e-5);
    }
    assert_int_equal(cell->layers[2].genus, VELUM_GENUS_SC);
    assert_int_equal(cell->layers[3].genus, VELUM_GENUS_CS);
    assert_int_equal(cell->layers[3].water, VELUM_WATER_ICE);
    finish(f);
    f = good("EDDF 180750Z SCT010 SCT030 10/05");
    assert_int_equal(f->state.cells[0].layer_count, 2);
    assert_true(f->state.cells[0].layers[1].coverage > 0.0f && f->state.cells[0].layers[1].coverage < 0.1f);
    finish(f);
    f = good("EDDF 180750Z OVC010 OVC030 10/05");
    assert_int_equal(f->state.cells[0].layer_count, 1);
    finish(f);
    f = good("EDDF 180750Z BKN010 FEW018CB 29/25");
    assert_int_equal(f->state.cells[0].layers[1].genus, VELUM_GENUS_CB);
    near_to((double)f->state.cells[0].layers[1].coverage, 1.5 / 8, 1e-6);
    assert_true(f->state.cells[0].layers[1].top_m > 8000.0f);
    finish(f);
}

static void clear_obscured_and_unknown_skies_differ(void **state) {
    (void)state;
    fixture *f = good("EDDF 180750Z CAVOK 15/05");
    assert_true(f->state.cells[0].flags & VELUM_CELL_HAS_LAYERS);
    assert_int_equal(f->state.cells[0].layer_count, 0);
    finish(f);
    f = good("EDDF 180750Z 9999 ////// 15/05");
    assert_false(f->state.cells[0].flags & VELUM_CELL_HAS_LAYERS);
    finish(f);
    f = good("EDDF 180750Z 9999 BKN/// 15/05");
    assert_false(f->state.cells[0].flags & VELUM_CELL_HAS_LAYERS);
    finish(f);
    f = good("KAIA 180753Z AUTO 24007KT 1/4SM FZFG VV002 M07/M08");
    assert_false(f->state.cells[0].flags & VELUM_CELL_HAS_LAYERS);
    near_to((double)f->state.cells[0].visibility_m, 402.336, 0.01);
    near_to((double)f->state.cells[0].fog_top_m, 1196 + 1.5 * 60.96, 0.1);
    finish(f);
    f = good("KAIA 180753Z 3/4SM SN VV007 M02/M03");
    assert_int_equal(f->state.cells[0].layer_count, 1);
    assert_int_equal(f->state.cells[0].layers[0].genus, VELUM_GENUS_NS);
    assert_int_equal(f->state.cells[0].layers[0].precipitation, VELUM_PRECIPITATION_SNOW);
    finish(f);
}

static void genera_follow_the_rules(void **state) {
    (void)state;
    static const struct {
        const char *text;
        int32_t genus;
    } cases[] = {
        {"FEW040 25/15", VELUM_GENUS_CU},      {"SCT040 15/14", VELUM_GENUS_SC},   {"BKN030 10/05", VELUM_GENUS_SC},
        {"OVC005 10/10", VELUM_GENUS_ST},      {"BKN090 10/05", VELUM_GENUS_AC},   {"OVC090 10/05", VELUM_GENUS_AS},
        {"SCT250 10/05", VELUM_GENUS_CI},      {"OVC250 10/05", VELUM_GENUS_CS},   {"RA OVC020 10/09", VELUM_GENUS_NS},
        {"TSRA BKN030 25/20", VELUM_GENUS_CB}, {"SCT030TCU 25/18", VELUM_GENUS_CU}};
    for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); ++i) {
        char text[100];
        snprintf(text, sizeof(text), "EDDF 180750Z %s", cases[i].text);
        fixture *f = good(text);
        if (f->state.cells[0].layers[0].genus != cases[i].genus) {
            print_error("%s: found genus %d, expected %d\n", text, f->state.cells[0].layers[0].genus, cases[i].genus);
        }
        assert_int_equal(f->state.cells[0].layers[0].genus, cases[i].genus);
        finish(f);
    }
}

static void the_newest_report_of_a_station_holds(void **state) {
    (void)state;
    fixture *f = good("EDDF 180720Z 9999 10/05\nEDDF 180750Z 0300 FG 08/08\nEDDF 180650Z 5000 10/05\n");
    assert_int_equal(f->report.stations_read, 1);
    assert_int_equal(f->report.stations_refused, 2);
    near_to((double)f->state.cells[0].visibility_m, 300, 0);
    assert_string_equal(f->report.refusals[0].text, "m:1: EDDF: older than the report of line 2");
    finish(f);
    f = good("EDDF 180750Z 9999 10/05\nEDDF 180750Z 0300 FG 08/08\n");
    near_to((double)f->state.cells[0].visibility_m, 300, 0);
    assert_string_equal(f->report.refusals[0].text, "m:1: EDDF: same time as the report of line 2");
    finish(f);
    /* Days go round with the month: the 1st comes after the 31st. */
    f = good("EDDF 010020Z 0300 FG\nEDDF 312350Z 9999\n");
    near_to((double)f->state.cells[0].visibility_m, 300, 0);
    finish(f);
}

static void bad_reports_are_counted_and_named(void **state) {
    (void)state;
    char text[1000];
    snprintf(text, sizeof(text), "%s%s%s%s%s%s%s", header,
             "EDDF 180750Z CAVOK,EDDF,2014-12-18T07:50:00Z,50.05,8.6,113.0\n",
             "EDDM 180750Z CAVOK,EDDM,2014-12-18T07:50:00Z,91,8.6,113.0\n",
             "EDDH 180750Z CAVOK,EDDH,2014-12-18T07:50:00Z,50,nan,113.0\n",
             "EDDK 180750Z CAVOK,EDDK,2014-12-18T07:50:00Z,50,8,1e9\n", "EDDL 180750Z 99910KT,EDDL,,50,8,10\n",
             "\"EDDN 180750Z, \"\"CAVOK\"\" 9999\",EDDN\n");
    fixture *f = good(text);
    assert_int_equal(f->report.stations_read, 1);
    assert_int_equal(f->report.stations_refused, 5);
    assert_string_equal(f->report.refusals[0].text, "m:3: EDDM: latitude: found 91, expected -90 to 90");
    assert_non_null(strstr(f->report.refusals[1].text, "m:4: EDDH: longitude: found nan"));
    assert_non_null(strstr(f->report.refusals[2].text, "m:5: EDDK: elevation: found 1e9"));
    assert_non_null(strstr(f->report.refusals[3].text, "m:6: EDDL: wind direction: found 99910KT"));
    assert_non_null(strstr(f->report.refusals[4].text, "m:7: EDDN: found 2 columns, expected 6"));
    near_to((double)f->state.cells[0].elevation_m, 113, 0);
    finish(f);
}

static void a_stray_control_character_costs_one_report(void **state) {
    (void)state;
    fixture *f = good("raw_text,latitude,longitude\nEDDF 180750Z CAVOK,50,8\nEDDM 180750Z \x12 CAVOK,48,11\n"
                      "\"EDDH 180750Z CAVOK\",53,10\n");
    assert_int_equal(f->report.stations_read, 2);
    assert_int_equal(f->report.stations_refused, 1);
    assert_string_equal(f->report.refusals[0].text, "m:3: EDDM: column 14: found byte 0x12, expected text");
    finish(f);
    f = good("raw_text,latitude,longitude\n\"EDDF 180750Z CAVOK\"\x12,50,8\nEDDM 180750Z CAVOK,48,11\n");
    assert_int_equal(f->report.stations_read, 1);
    assert_string_equal(f->report.refusals[0].text, "m:2: EDDF: column 21: found byte 0x12, expected text");
    finish(f);
    f = good("EDDF 180720Z 9999 10/05\nEDDF 180750Z 0300\x7f FG 08/08\n");
    assert_true(f->state.cells[0].visibility_m > 9000);
    assert_string_equal(f->report.refusals[0].text, "m:2: EDDF: column 18: found byte 0x7f, expected text");
    finish(f);
}

static void wrong_structures_are_refused_whole(void **state) {
    (void)state;
    refused_whole("", "m:1:1: no METAR report");
    refused_whole("# nothing\n\n", "no METAR report");
    refused_whole("{\"type\": \"FeatureCollection\"}\n", "m:1:1: no usable METAR report");
    refused_whole("EDDF 180750Z 9999\x01\n",
                  "m:1:18: no usable METAR report; EDDF: column 18: found byte 0x01, expected text");
    refused_whole("EDDF 180750Z 9999\nEDDF 180750Z\x01 9999\nEDDF 180750Z 9999\x02\n", "m:2:13: found byte 0x01");
    refused_whole("raw_text,latitude,longitude,a\x12\nEDDF 180750Z CAVOK,50,8,\n", "m:1:30: found byte 0x12");
    refused_whole("No errors\ndata source=metars\n0 results\n", "m:3:1: found the preamble");
    refused_whole("raw_text,latitude\nEDDF 180750Z CAVOK,50\n", "latitude and longitude together");
    refused_whole("raw,raw_text_x,station\nEDDF 180750Z CAVOK,1,2\n", "expected a column raw_text");
    refused_whole("No errors\n3 results\nraw_text,latitude,longitude\nEDDF 180750Z CAVOK,50,8\n",
                  "truncated: found 1 reports, expected 3 (line 2)");
    refused_whole("raw_text,latitude,longitude\n\"EDDF 180750Z CAVOK,50,8\n", "m:2:1: quoted field");
    refused_whole("raw_text,latitude,longitude\n\"EDDF 180750Z CAVOK\"x,50,8\n", "m:2:21: found 'x'");
    refused_whole("raw_text,latitude,longitude\nEDDF 180750Z CAVOK,95,8\n",
                  "m:2:20: no usable METAR report; EDDF: latitude");
    refused_whole("XXXX 180750Z CAVOK\n", "no position");
}

static void positions_come_from_file_then_scenario_then_table(void **state) {
    (void)state;
    char path[] = "/tmp/velum-stations-XXXXXX";
    const int file = mkstemp(path);
    const char table[] = "[rjtt]\nlocation = (0.62, 2.44)\n[eddf]\nlocation = (0.1, 0.1)\n";
    assert_true(write(file, table, sizeof(table) - 1) > 0);
    close(file);
    velum_weather_station_options options = two;
    options.table_path = path;
    options.radius_m = 30000.0f;
    fixture *f = read_text(
        "raw_text,latitude,longitude\nKAIA 180750Z CAVOK,1,2\nEDDF 180750Z CAVOK,,\nRJTT 180750Z CAVOK,,\n", &options);
    assert_int_equal(f->result, VELUM_OK);
    assert_int_equal(f->report.stations_read, 3);
    near_to(f->state.cells[0].lat_deg, 1, 0);
    near_to(f->state.cells[1].lat_deg, 50.05, 0);
    near_to(f->state.cells[2].lat_deg, 0.62 * 180 / M_PI, 1e-9);
    near_to(f->state.cells[0].radius_m, 30000, 0);
    finish(f);
    unlink(path);
    f = read_text("RJTT 180750Z CAVOK\n", &options);
    assert_int_equal(f->result, VELUM_ERROR_STATE);
    assert_non_null(strstr(f->error.text, path));
    finish(f);
    options.radius_m = 10.0f;
    f = read_text("RJTT 180750Z CAVOK\n", &options);
    assert_int_equal(f->result, VELUM_ERROR_ARGUMENT);
    finish(f);
    options.radius_m = NAN;
    f = read_text("RJTT 180750Z CAVOK\n", &options);
    assert_int_equal(f->result, VELUM_ERROR_ARGUMENT);
    finish(f);
}

static void check_cells(const velum_state_desc *state) {
    for (uint32_t i = 0; i < state->cell_count; ++i) {
        const velum_cell *cell = &state->cells[i];
        assert_true(fabs(cell->lat_deg) <= 90.0 && cell->lon_deg >= -180.0 && cell->lon_deg <= 360.0);
        assert_true(isfinite(cell->wind_east_m_s) && isfinite(cell->wind_north_m_s));
        assert_true(!(cell->flags & VELUM_CELL_HAS_VISIBILITY) || cell->visibility_m >= 1.0f);
        assert_true(cell->layer_count <= 9);
        for (uint32_t j = 0; j < cell->layer_count; ++j) {
            const velum_layer *layer = &cell->layers[j];
            assert_true(layer->coverage > 0.0f && layer->coverage <= 1.0f);
            assert_true(layer->base_m >= cell->elevation_m && layer->top_m <= 25000.0f);
            assert_true(layer->top_m - layer->base_m >= 99.0f);
            assert_true(layer->water_g_m3 > 0.0f && layer->radius_um > 0.5f);
            assert_true(layer->precipitation_mm_h >= 0.0f && layer->precipitation_mm_h <= 500.0f);
        }
    }
}

static void cuts_and_flips_never_break_the_reader(void **state) {
    (void)state;
    char full[1024];
    size_t size;
    char *text = read_all(source_path(full, "tests/data/fuzz/metar/cache.csv"), &size);
    assert_non_null(text);
    uint32_t whole = 0, seed = 7;
    for (int turn = 0; turn < 1500; ++turn) {
        const size_t cut = turn < 800 ? (size_t)turn * size / 800 : size;
        char *copy = malloc(cut ? cut : 1);
        memcpy(copy, text, cut);
        for (int flip = 0; turn >= 800 && flip < 4; ++flip) {
            seed = seed * 1664525u + 1013904223u;
            copy[seed % cut] = (char)(seed >> 24);
        }
        velum_weather_set *set = velum_weather_set_create();
        velum_weather_error error = {0};
        velum_state_desc desc;
        const velum_result result = velum_weather_read_metar_memory(set, "m", copy, cut, &two, NULL, &error);
        velum_weather_set_state(set, &desc);
        assert_true((result != VELUM_OK) == (error.text[0] != '\0'));
        assert_true(result == VELUM_OK || desc.cell_count == 0);
        check_cells(&desc);
        whole += turn < 800 && result == VELUM_OK;
        velum_weather_set_destroy(set);
        free(copy);
    }
    /* Cut within its last row, a cache still has as many rows as it says. */
    assert_true(whole < 20);
    free(text);
}

static const velum_cell *cell_at(const velum_state_desc *state, double lat_deg, double lon_deg) {
    for (uint32_t i = 0; i < state->cell_count; ++i) {
        if (state->cells[i].lat_deg == lat_deg && state->cells[i].lon_deg == lon_deg) {
            return &state->cells[i];
        }
    }
    fail();
    return NULL;
}

static void the_real_cache(void **state) {
    (void)state;
    char path[1024];
    if (!shared_path(path, "data/metars-20141218.csv")) {
        print_message("%s is not there (set VELUM_SHARED)\n", path);
        skip();
    }
    fixture *f = calloc(1, sizeof(*f));
    f->set = velum_weather_set_create();
    assert_int_equal(velum_weather_read_metar(f->set, path, NULL, &f->report, &f->error), VELUM_OK);
    velum_weather_set_state(f->set, &f->state);
    assert_int_equal(f->report.stations_read + f->report.stations_refused, 4538);
    assert_true(f->report.stations_read > 4470);
    assert_true(f->report.refusal_count > 30 && f->report.refusal_count <= 64);
    assert_int_equal(f->report.stations_read, f->state.cell_count);
    check_cells(&f->state);
    /* KADW 180758Z 27005KT 10SM BKN048 02/M06 */
    const velum_cell *andrews = cell_at(&f->state, 38.82, -76.87);
    near_to((double)andrews->layers[0].base_m, 86 + 4800 * 0.3048, 0.1);
    near_to((double)andrews->layers[0].coverage, 0.75, 1e-6);
    near_to((double)andrews->wind_east_m_s, 5 * 0.514444, 1e-3);
    near_to((double)andrews->temperature_k, 275.15, 1e-3);
    /* EHAM 180755Z 24015KT 9999 FEW005 BKN006 BKN012 11/10 Q1007 TEMPO 3000 -DZ */
    const velum_cell *schiphol = cell_at(&f->state, 52.32, 4.78);
    assert_int_equal(schiphol->layer_count, 3);
    assert_int_equal(schiphol->precipitation, VELUM_PRECIPITATION_NONE);
    near_to((double)schiphol->layers[2].base_m, 9 + 1200 * 0.3048, 0.1);
    /* "VRMM 180700Z 04014KT 9999 SCT017 FEW018CB BKN120 29/25 Q1011 CB NE,S,WSW NOSIG" (quoted) */
    const velum_cell *male = cell_at(&f->state, 4.2, 73.52);
    assert_int_equal(male->layer_count, 3);
    assert_int_equal(male->layers[1].genus, VELUM_GENUS_CB);
    /* KAIA 180753Z AUTO 24007KT 1/4SM FZFG VV002 M07/M08 */
    near_to((double)cell_at(&f->state, 42.05, -102.8)->visibility_m, 402.3, 0.1);
    finish(f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(bases_are_above_the_station),
        cmocka_unit_test(coverage_sums_from_below),
        cmocka_unit_test(clear_obscured_and_unknown_skies_differ),
        cmocka_unit_test(genera_follow_the_rules),
        cmocka_unit_test(the_newest_report_of_a_station_holds),
        cmocka_unit_test(bad_reports_are_counted_and_named),
        cmocka_unit_test(a_stray_control_character_costs_one_report),
        cmocka_unit_test(wrong_structures_are_refused_whole),
        cmocka_unit_test(positions_come_from_file_then_scenario_then_table),
        cmocka_unit_test(cuts_and_flips_never_break_the_reader),
        cmocka_unit_test(the_real_cache),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
