#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <stdlib.h>
#include <string.h>

#include "weather/error.h"

static void texts_name_file_line_and_column(void **state) {
    (void)state;
    velum_weather_error error;
    assert_int_equal(weather_fail(&error, VELUM_ERROR_ARGUMENT, "a.json", 3, 7, "found %d", 5), VELUM_ERROR_ARGUMENT);
    assert_string_equal(error.text, "a.json:3:7: found 5");
    assert_string_equal(error.file, "a.json");
    assert_int_equal(error.line, 3);
    assert_int_equal(error.column, 7);
    weather_fail(&error, VELUM_ERROR_STATE, "a.json", 3, 0, "x");
    assert_string_equal(error.text, "a.json:3: x");
    weather_fail(&error, VELUM_ERROR_STATE, "a.json", 0, 0, "x");
    assert_string_equal(error.text, "a.json: x");
    weather_fail(&error, VELUM_ERROR_STATE, NULL, 0, 0, "x");
    assert_string_equal(error.text, "x");
    weather_fail_message(&error, VELUM_ERROR_STATE, "a.grib2", 12, "x");
    assert_string_equal(error.text, "a.grib2: message 12: x");
    assert_int_equal(error.message, 12);
    assert_int_equal(weather_fail(NULL, VELUM_ERROR_STATE, "a", 1, 1, "x"), VELUM_ERROR_STATE);
}

static void long_and_unprintable_texts_stay_whole(void **state) {
    (void)state;
    velum_weather_error error;
    char name[2000];
    memset(name, 'n', sizeof(name));
    name[sizeof(name) - 1] = '\0';
    weather_fail(&error, VELUM_ERROR_ARGUMENT, name, 1, 1, "%s\x1b[31m", name);
    assert_true(strlen(error.text) < sizeof(error.text));
    assert_true(strlen(error.file) < sizeof(error.file));
    weather_fail(&error, VELUM_ERROR_ARGUMENT, "f", 1, 1, "\x1b[31m\n");
    assert_string_equal(error.text, "f:1:1: ?[31m?");
}

static void refusals_keep_64_of_a_file_and_never_overflow(void **state) {
    (void)state;
    velum_weather_report *report = calloc(1, sizeof(*report));
    for (int file = 0; file < 10; ++file) {
        for (int i = 0; i < 100; ++i) {
            weather_refuse(report, "file%d.csv:%d: reason", file, i);
        }
    }
    assert_int_equal(report->refusal_count, 256);
    assert_string_equal(report->refusals[63].text, "file0.csv:63: reason");
    assert_string_equal(report->refusals[64].text, "file1.csv:0: reason");
    weather_refuse(NULL, "nothing");
    free(report);
}

static void files_that_cannot_be_read_are_named(void **state) {
    (void)state;
    velum_weather_error error;
    char *bytes;
    size_t size;
    assert_int_equal(weather_read_file("/nonexistent/x", &bytes, &size, &error), VELUM_ERROR_STATE);
    assert_null(bytes);
    assert_non_null(strstr(error.text, "/nonexistent/x: cannot be read: No such file"));
    assert_int_equal(weather_read_file("/tmp", &bytes, &size, &error), VELUM_ERROR_STATE);
    assert_non_null(strstr(error.text, "directory"));
    assert_int_equal(weather_read_file("/dev/zero", &bytes, &size, &error), VELUM_ERROR_STATE);
    assert_int_equal(weather_read_file(NULL, &bytes, &size, &error), VELUM_ERROR_ARGUMENT);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texts_name_file_line_and_column),
        cmocka_unit_test(long_and_unprintable_texts_stay_whole),
        cmocka_unit_test(refusals_keep_64_of_a_file_and_never_overflow),
        cmocka_unit_test(files_that_cannot_be_read_are_named),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
