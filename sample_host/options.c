#include "options.h"

#include "report.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <velum/engine.h>

enum { PLAY = 1 << COMMAND_PLAY, PROBE = 1 << COMMAND_PROBE, SHADOW = 1 << COMMAND_SHADOW };
enum { TILES = 1 << COMMAND_TILES, CHECK = 1 << COMMAND_CHECK, ALL = PLAY | PROBE | SHADOW | TILES | CHECK };

typedef bool parse_value(struct options *options, const char *name, const char *value);

void options_print_usage(void) {
    fputs(
        "velum-host play SCENARIO [--weather FILE]... [--out DIR] [--format png,exr] [--size WxH]\n"
        "    [--channels a,b,c] [--at T | --from T --to T --fps F] [--settle N]\n"
        "    [--pose lat,lon,height,heading,pitch,roll] [--quality low|medium|high|ultra|reference] [--spp N]\n"
        "    [--error E] [--budget-ms X] [--budget-error X] [--device auto|cpu|INDEX] [--window] [--stats FILE]\n"
        "    [--plugin PATH] [--validate] [--no-cache]\n"
        "velum-host probe  SCENARIO --at T [--pose ...]     one JSON object: what the weather is there\n"
        "velum-host shadow SCENARIO --at T --out FILE.exr   a cloud shadow map; its geometry as JSON on stdout\n"
        "velum-host tiles  SCENARIO --at T --out DIR        the weather around the eye as pictures, with their "
        "extents\n"
        "velum-host check  SCENARIO [--weather FILE]...     reads everything, renders nothing\n"
        "\n"
        "Times are seconds of the scenario, heights metres above the ellipsoid, angles degrees.\n"
        "play opens a window for each channel; with --out, or where there is no display, it writes\n"
        "DIR/CHANNEL_NNNNNN.png|exr (DIR is 'out' if not given): without --at or --from the whole scenario at one "
        "frame a\n"
        "second of its time; --at T that one time, settled over 32 frames unless --settle says otherwise. With "
        "--settle N\n"
        "every picture starts anew and is the last of N frames. --to before --from plays backward.\n"
        "EXR channels: R G B the light that cloud and air add (cd/m2), TR TG TB what they let through, A the mean of "
        "that\n"
        "weighted by luminance, Z the mean distance of cloud (m; 0: none); of the reference also V, the variance of "
        "the mean\n"
        "luminance. PNG: the composed, tone-mapped picture.\n"
        "The reference stops at --spp N paths a pixel or at a mean relative standard error of --error E, whichever is "
        "first;\n"
        "without either at 64 paths.\n"
        "--budget-ms X: rays and steps so that all channels together take X ms of the device a frame, beginning with "
        "those\n"
        "of --quality. --budget-error X: the cheapest quality whose measured relative error is X or less. Both: the "
        "time\n"
        "holds, and no better quality than the error asks for. --stats tells each frame's plan and its reasons.\n"
        "Keys in a window: space pauses, arrows seek, r reverses, q and Escape close.\n",
        stdout);
}

static bool parse_number(const char *text, double low, double high, double *out) {
    char *end = NULL;
    errno = 0;
    double value = strtod(text, &end);
    if (end == text || *end != '\0' || errno == ERANGE || !isfinite(value) || value < low || value > high) {
        return false;
    }
    *out = value;
    return true;
}

static bool parse_count(const char *text, uint32_t low, uint32_t high, uint32_t *out) {
    double value = 0;
    if (strspn(text, "0123456789") != strlen(text) || !parse_number(text, low, high, &value)) {
        return false;
    }
    *out = (uint32_t)value;
    return true;
}

static bool expected(const char *name, const char *value, const char *what) {
    report_error("%s: found '%s', expected %s", name, value, what);
    return false;
}

static bool parse_time(const char *name, const char *value, bool *has, double *out) {
    if (!parse_number(value, 0, 1e9, out)) {
        return expected(name, value, "seconds of the scenario, 0 or more");
    }
    *has = true;
    return true;
}

static bool set_weather(struct options *options, const char *name, const char *value) {
    if (options->weather_count == OPTIONS_WEATHER_MAX) {
        report_error("%s: at most %d files", name, OPTIONS_WEATHER_MAX);
        return false;
    }
    options->weather[options->weather_count++] = value;
    return true;
}

static bool set_out(struct options *options, const char *name, const char *value) {
    if (*value == '\0') {
        return expected(name, value, "a path");
    }
    options->out = value;
    return true;
}

static bool set_format(struct options *options, const char *name, const char *value) {
    options->png = options->exr = false;
    for (const char *at = value;;) {
        size_t length = strcspn(at, ",");
        if (length == 3 && strncmp(at, "png", 3) == 0) {
            options->png = true;
        } else if (length == 3 && strncmp(at, "exr", 3) == 0) {
            options->exr = true;
        } else {
            return expected(name, value, "png, exr or both with a comma between");
        }
        if (at[length] == '\0') {
            return true;
        }
        at += length + 1;
    }
}

static bool set_size(struct options *options, const char *name, const char *value) {
    char width[16];
    size_t length = strcspn(value, "x");
    if (value[length] != 'x' || length == 0 || length >= sizeof width) {
        return expected(name, value, "WIDTHxHEIGHT");
    }
    memcpy(width, value, length);
    width[length] = '\0';
    if (!parse_count(width, 1, 8192, &options->width) || !parse_count(value + length + 1, 1, 8192, &options->height)) {
        return expected(name, value, "WIDTHxHEIGHT, each 1 to 8192");
    }
    return true;
}

static bool set_channels(struct options *options, const char *name, const char *value) {
    options->channel_count = 0;
    for (const char *at = value;;) {
        size_t length = strcspn(at, ",");
        if (length == 0 || length >= sizeof options->channels[0] || options->channel_count == OPTIONS_CHANNELS_MAX) {
            return expected(name, value, "names of channels with commas between");
        }
        char *channel = options->channels[options->channel_count];
        memcpy(channel, at, length);
        channel[length] = '\0';
        for (uint32_t i = 0; i < options->channel_count; i++) {
            if (strcmp(options->channels[i], channel) == 0) {
                return expected(name, value, "each channel once");
            }
        }
        options->channel_count++;
        if (at[length] == '\0') {
            return true;
        }
        at += length + 1;
    }
}

static bool set_at(struct options *options, const char *name, const char *value) {
    return parse_time(name, value, &options->has_at, &options->at_s);
}

static bool set_from(struct options *options, const char *name, const char *value) {
    return parse_time(name, value, &options->has_from, &options->from_s);
}

static bool set_to(struct options *options, const char *name, const char *value) {
    return parse_time(name, value, &options->has_to, &options->to_s);
}

static bool set_fps(struct options *options, const char *name, const char *value) {
    return parse_number(value, 1e-6, 1000, &options->fps) ||
           expected(name, value, "frames a second of the scenario's time, above 0, at most 1000");
}

static bool set_settle(struct options *options, const char *name, const char *value) {
    return parse_count(value, 1, 1000000, &options->settle) || expected(name, value, "a number of frames, 1 or more");
}

static bool set_pose(struct options *options, const char *name, const char *value) {
    static const struct {
        const char *text;
        double low, high;
    } fields[6] = {{"latitude", -90, 90},  {"longitude", -360, 360}, {"height", -1e4, 5e7},
                   {"heading", -720, 720}, {"pitch", -90, 90},       {"roll", -360, 360}};
    double values[6];
    const char *at = value;
    for (int i = 0; i < 6; i++) {
        char number[64];
        size_t length = strcspn(at, ",");
        bool last = i == 5;
        if (length >= sizeof number || (at[length] == '\0') != last) {
            return expected(name, value, "lat,lon,height,heading,pitch,roll");
        }
        memcpy(number, at, length);
        number[length] = '\0';
        if (!parse_number(number, fields[i].low, fields[i].high, &values[i])) {
            report_error("%s: %s: found '%s', expected %g to %g", name, fields[i].text, number, fields[i].low,
                         fields[i].high);
            return false;
        }
        at += length + (last ? 0 : 1);
    }
    options->pose = (velum_scenario_camera){.lat_deg = values[0],
                                            .lon_deg = values[1],
                                            .height_m = values[2],
                                            .heading_deg = values[3],
                                            .pitch_deg = values[4],
                                            .roll_deg = values[5]};
    options->has_pose = true;
    return true;
}

static bool set_quality(struct options *options, const char *name, const char *value) {
    static const char *const names[] = {"low", "medium", "high", "ultra", "reference"};
    for (int32_t i = 0; i < 5; i++) {
        if (strcmp(value, names[i]) == 0) {
            options->quality = VELUM_QUALITY_LOW + i;
            return true;
        }
    }
    return expected(name, value, "low, medium, high, ultra or reference");
}

static bool set_spp(struct options *options, const char *name, const char *value) {
    return parse_count(value, 1, 1000000, &options->spp) || expected(name, value, "samples a pixel, 1 or more");
}

static bool set_error(struct options *options, const char *name, const char *value) {
    return parse_number(value, 1e-6, 1, &options->error) ||
           expected(name, value, "a relative standard error, above 0, at most 1");
}

static bool set_budget_ms(struct options *options, const char *name, const char *value) {
    return parse_number(value, 1e-3, 1e4, &options->budget_ms) ||
           expected(name, value, "milliseconds of the device a frame, 0.001 to 10000");
}

static bool set_budget_error(struct options *options, const char *name, const char *value) {
    return parse_number(value, 1e-3, 1, &options->budget_error) ||
           expected(name, value, "a relative error, 0.001 to 1");
}

static bool set_device(struct options *options, const char *name, const char *value) {
    uint32_t index = 0;
    if (strcmp(value, "auto") == 0) {
        options->device = DEVICE_AUTO;
    } else if (strcmp(value, "cpu") == 0) {
        options->device = DEVICE_CPU;
    } else if (parse_count(value, 0, 255, &index)) {
        options->device = (int32_t)index;
    } else {
        return expected(name, value, "auto, cpu or the index of a device");
    }
    return true;
}

static bool set_window(struct options *options, const char *name, const char *value) {
    (void)name, (void)value;
    options->window = true;
    return true;
}

static bool set_validate(struct options *options, const char *name, const char *value) {
    (void)name, (void)value;
    options->validate = true;
    return true;
}

static bool set_no_cache(struct options *options, const char *name, const char *value) {
    (void)name, (void)value;
    options->no_cache = true;
    return true;
}

static bool set_stats(struct options *options, const char *name, const char *value) {
    (void)name;
    options->stats = value;
    return true;
}

static bool set_plugin(struct options *options, const char *name, const char *value) {
    (void)name;
    options->plugin = value;
    return true;
}

static const struct {
    const char *name;
    int commands;
    bool has_value;
    parse_value *parse;
} table[] = {
    {"--weather", ALL, true, set_weather},
    {"--out", PLAY | SHADOW | TILES, true, set_out},
    {"--format", PLAY, true, set_format},
    {"--size", PLAY, true, set_size},
    {"--channels", PLAY, true, set_channels},
    {"--at", PLAY | PROBE | SHADOW | TILES, true, set_at},
    {"--from", PLAY, true, set_from},
    {"--to", PLAY, true, set_to},
    {"--fps", PLAY, true, set_fps},
    {"--settle", PLAY, true, set_settle},
    {"--pose", PLAY | PROBE | SHADOW | TILES, true, set_pose},
    {"--quality", PLAY, true, set_quality},
    {"--spp", PLAY, true, set_spp},
    {"--error", PLAY, true, set_error},
    {"--budget-ms", PLAY, true, set_budget_ms},
    {"--budget-error", PLAY, true, set_budget_error},
    {"--device", PLAY | SHADOW, true, set_device},
    {"--window", PLAY, false, set_window},
    {"--stats", PLAY, true, set_stats},
    {"--plugin", PLAY | PROBE | SHADOW | TILES, true, set_plugin},
    {"--validate", PLAY | SHADOW, false, set_validate},
    {"--no-cache", PLAY | SHADOW, false, set_no_cache},
};

static const char *const command_names[] = {"play", "probe", "shadow", "tiles", "check"};

static bool parse_option(struct options *options, char **argv, int argc, int *index) {
    const char *argument = argv[*index];
    size_t length = strcspn(argument, "=");
    for (size_t i = 0; i < sizeof table / sizeof table[0]; i++) {
        if (strlen(table[i].name) != length || strncmp(argument, table[i].name, length) != 0) {
            continue;
        }
        if (!(table[i].commands & (1 << options->command))) {
            report_error("%s: not an option of '%s'", table[i].name, command_names[options->command]);
            return false;
        }
        const char *value = NULL;
        if (argument[length] == '=') {
            value = argument + length + 1;
        } else if (table[i].has_value && *index + 1 < argc) {
            value = argv[++*index];
        }
        if (table[i].has_value != (value != NULL)) {
            report_error("%s: %s", table[i].name, table[i].has_value ? "a value is missing" : "takes no value");
            return false;
        }
        return table[i].parse(options, table[i].name, value);
    }
    report_error("%s: unknown option; 'velum-host --help' lists them", argument);
    return false;
}

static bool check_together(const struct options *options) {
    const char *command = command_names[options->command];
    const char *error = NULL;
    if (!options->scenario) {
        report_error("%s: a scenario file is missing", command);
        return false;
    }
    if (options->has_at && (options->has_from || options->has_to || options->fps > 0)) {
        error = "--at does not go with --from, --to or --fps";
    } else if (options->spp > 0 && options->quality != VELUM_QUALITY_REFERENCE) {
        error = "--spp needs --quality reference";
    } else if (options->error > 0 && options->quality != VELUM_QUALITY_REFERENCE) {
        error = "--error needs --quality reference";
    } else if (options->budget_ms > 0 && options->quality == VELUM_QUALITY_REFERENCE) {
        error = "--budget-ms does not go with --quality reference";
    } else if (options->budget_error > 0 && options->quality == VELUM_QUALITY_REFERENCE) {
        error = "--budget-error does not go with --quality reference; --error stops it";
    } else if (options->window && (options->out || options->exr)) {
        error = "--window does not go with --out or --format exr";
    } else if (options->window && (options->has_at || options->settle > 0)) {
        error = "--window does not go with --at or --settle; --from starts there";
    } else if (options->command != COMMAND_PLAY && options->command != COMMAND_CHECK && !options->has_at) {
        error = "--at is missing";
    } else if ((options->command == COMMAND_SHADOW || options->command == COMMAND_TILES) && !options->out) {
        error = "--out is missing";
    }
    if (error) {
        report_error("%s: %s", command, error);
    }
    return !error;
}

bool options_parse(int argc, char **argv, struct options *out) {
    struct options options = {.png = true, .quality = VELUM_QUALITY_DEFAULT, .device = DEVICE_AUTO};
    for (int i = 1; i < argc; i++) {
        if (strcmp(argv[i], "--help") == 0 || strcmp(argv[i], "-h") == 0) {
            options.command = COMMAND_HELP;
            *out = options;
            return true;
        }
    }
    if (argc < 2) {
        report_error("a command is missing: play, probe, shadow, tiles or check; 'velum-host --help' explains them");
        return false;
    }
    size_t command = 0;
    while (command < 5 && strcmp(argv[1], command_names[command]) != 0) {
        command++;
    }
    if (command == 5) {
        report_error("%s: unknown command; there are play, probe, shadow, tiles and check", argv[1]);
        return false;
    }
    options.command = (enum command)command;
    for (int i = 2; i < argc; i++) {
        if (strncmp(argv[i], "--", 2) == 0) {
            if (!parse_option(&options, argv, argc, &i)) {
                return false;
            }
        } else if (options.scenario) {
            report_error("%s: a second scenario; there is '%s' already", argv[i], options.scenario);
            return false;
        } else {
            options.scenario = argv[i];
        }
    }
    if (!check_together(&options)) {
        return false;
    }
    *out = options;
    return true;
}
