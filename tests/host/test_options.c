/* Command lines that are right. Those that are wrong: command_line.sh. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "options.h"
#include "play.h"

#include <string.h>
#include <velum/engine.h>

static bool parse(const char *line, struct options *options) {
    static char words[512];
    char *argv[40] = {"velum-host"};
    int argc = 1;
    assert_true(strlen(line) < sizeof words);
    strcpy(words, line);
    for (char *word = strtok(words, " "); word; word = strtok(NULL, " ")) {
        argv[argc++] = word;
    }
    return options_parse(argc, argv, options);
}

static void everything_is_understood(void **state) {
    struct options o;
    (void)state;
    assert_true(parse("play s.json --weather a.grib2 --weather=b.csv --out d --format png,exr --size 320x200 "
                      "--channels left,right --from 10 --to 20 --fps 2.5 --settle 7 --pose 50.5,-8,300,90,-5,2 "
                      "--quality reference --spp 16 --device 2 --stats s.jsonl --plugin p.so --validate",
                      &o));
    assert_int_equal(o.command, COMMAND_PLAY);
    assert_string_equal(o.scenario, "s.json");
    assert_int_equal(o.weather_count, 2);
    assert_string_equal(o.weather[1], "b.csv");
    assert_true(o.png && o.exr && o.validate && o.has_from && o.has_to && !o.has_at && o.has_pose);
    assert_int_equal(o.width, 320);
    assert_int_equal(o.height, 200);
    assert_int_equal(o.channel_count, 2);
    assert_string_equal(o.channels[1], "right");
    assert_int_equal(o.settle, 7);
    assert_int_equal(o.quality, VELUM_QUALITY_REFERENCE);
    assert_int_equal(o.spp, 16);
    assert_int_equal(o.device, 2);
    assert_true(o.pose.lat_deg == 50.5 && o.pose.lon_deg == -8 && o.pose.pitch_deg == -5 && o.pose.roll_deg == 2);
}

static void defaults(void **state) {
    struct options o;
    (void)state;
    assert_true(parse("play s.json", &o));
    assert_true(o.png && !o.exr && !o.window && !o.validate && !o.out);
    assert_int_equal(o.device, DEVICE_AUTO);
    assert_int_equal(o.quality, VELUM_QUALITY_DEFAULT);
    assert_true(parse("play s.json --format exr --device cpu", &o));
    assert_true(!o.png && o.exr);
    assert_int_equal(o.device, DEVICE_CPU);
    assert_true(o.budget_ms == 0 && o.budget_error == 0);
    assert_true(parse("play s.json --budget-ms 2.5 --budget-error=0.15 --quality high", &o));
    assert_true(o.budget_ms == 2.5 && o.budget_error == 0.15);
    assert_int_equal(o.quality, VELUM_QUALITY_HIGH);
}

static void times_of_pictures(void **state) {
    struct options o;
    struct play_times times;
    (void)state;
    assert_true(parse("play s.json --out d", &o));
    assert_true(play_times(&o, 60, &times));
    assert_true(times.count == 61 && times.from_s == 0 && times.step_s == 1);
    assert_true(parse("play s.json --out d --at 12.5", &o));
    assert_true(play_times(&o, 60, &times));
    assert_true(times.count == 1 && times.from_s == 12.5);
    assert_true(parse("play s.json --out d --from 0 --to 0.3 --fps 10", &o));
    assert_true(play_times(&o, 60, &times));
    assert_true(times.count == 4 && times.step_s == 0.1);
    assert_true(parse("play s.json --out d --from 20 --to 10", &o));
    assert_true(play_times(&o, 60, &times));
    assert_true(times.count == 11 && times.from_s == 20 && times.step_s == -1);
    assert_true(parse("play s.json --out d --from 0 --to 1e9 --fps 1000", &o));
    assert_false(play_times(&o, 60, &times));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(everything_is_understood),
        cmocka_unit_test(defaults),
        cmocka_unit_test(times_of_pictures),
    };
    return cmocka_run_group_tests_name("options", tests, NULL, NULL);
}
