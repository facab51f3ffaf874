#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "weather/stations.h"

static const char table_text[] = "# comment\n[eddf]\ndescription = Frankfurt\nlocation = (0.8735373, 0.1500983)\n\n"
                                 "[aggg]\nlocation = None\n\n[zzzz]\nlocation = (2.0, 0.1)\n"
                                 "[toolongname]\nlocation = (0.1, 0.1)\n[aaaa]\r\nlocation = (-0.5, -1.5)\r\n";

static void names_give_positions_in_degrees(void **state) {
    (void)state;
    weather_stations table;
    velum_weather_error error;
    assert_int_equal(weather_stations_parse(&table, "t", table_text, strlen(table_text), &error), VELUM_OK);
    assert_int_equal(table.count, 2);
    const velum_weather_station *frankfurt = weather_stations_find(&table, "EDDF");
    assert_non_null(frankfurt);
    assert_true(fabs(frankfurt->lat_deg - 50.0500) < 1e-3);
    assert_true(fabs(frankfurt->lon_deg - 8.6000) < 1e-3);
    assert_non_null(weather_stations_find(&table, "AAAA"));
    assert_null(weather_stations_find(&table, "AGGG"));
    assert_null(weather_stations_find(&table, "ZZZZ"));
    assert_null(weather_stations_find(&table, "TOOLONGNAME"));
    weather_stations_finish(&table);
    weather_stations_finish(NULL);
}

static void any_cut_of_a_table_is_read_or_refused(void **state) {
    (void)state;
    for (size_t size = 0; size < strlen(table_text); ++size) {
        weather_stations table;
        velum_weather_error error = {0};
        const velum_result result = weather_stations_parse(&table, "t", table_text, size, &error);
        assert_true(result == VELUM_OK ? table.count > 0 : error.text[0] != '\0');
        weather_stations_finish(&table);
    }
}

static void a_missing_table_is_an_error(void **state) {
    (void)state;
    weather_stations table;
    velum_weather_error error;
    assert_int_equal(weather_stations_read(&table, "/nonexistent.gz", &error), VELUM_ERROR_STATE);
    assert_int_equal(table.count, 0);
}

static void the_system_table_knows_the_great_airports(void **state) {
    (void)state;
    weather_stations table;
    velum_weather_error error;
    if (access(WEATHER_STATION_TABLE, R_OK) != 0) {
        print_message("no %s: weather-util-data is not installed\n", WEATHER_STATION_TABLE);
        skip();
    }
    assert_int_equal(weather_stations_read(&table, WEATHER_STATION_TABLE, &error), VELUM_OK);
    assert_true(table.count > 5000);
    const velum_weather_station *kennedy = weather_stations_find(&table, "KJFK");
    assert_non_null(kennedy);
    assert_true(fabs(kennedy->lat_deg - 40.64) < 0.05 && fabs(kennedy->lon_deg + 73.76) < 0.05);
    const velum_weather_station *tokyo = weather_stations_find(&table, "RJTT");
    assert_non_null(tokyo);
    assert_true(fabs(tokyo->lat_deg - 35.55) < 0.05 && fabs(tokyo->lon_deg - 139.78) < 0.05);
    weather_stations_finish(&table);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(names_give_positions_in_degrees),
        cmocka_unit_test(any_cut_of_a_table_is_read_or_refused),
        cmocka_unit_test(a_missing_table_is_an_error),
        cmocka_unit_test(the_system_table_knows_the_great_airports),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
