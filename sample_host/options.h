/* The command line. */
#ifndef HOST_OPTIONS_H
#define HOST_OPTIONS_H

#include <stdbool.h>
#include <stdint.h>
#include <velum_weather/weather.h>

enum command { COMMAND_PLAY, COMMAND_PROBE, COMMAND_SHADOW, COMMAND_TILES, COMMAND_CHECK, COMMAND_HELP };

enum { OPTIONS_WEATHER_MAX = 64, OPTIONS_CHANNELS_MAX = 32 };
enum { DEVICE_AUTO = -1, DEVICE_CPU = -2 };

struct options {
    enum command command;
    const char *scenario;
    const char *weather[OPTIONS_WEATHER_MAX];
    uint32_t weather_count;
    const char *out;
    bool png, exr;
    uint32_t width, height; /* 0: the channels' own */
    char channels[OPTIONS_CHANNELS_MAX][32];
    uint32_t channel_count; /* 0: all */
    bool has_at, has_from, has_to;
    double at_s, from_s, to_s;
    double fps;      /* 0: not given */
    uint32_t settle; /* 0: not given */
    bool has_pose;
    velum_scenario_camera pose;
    int32_t quality;                /* VELUM_QUALITY_* */
    uint32_t spp;                   /* of the reference; 0: not given */
    double error;                   /* relative, at which the reference stops; 0: not given */
    double budget_ms, budget_error; /* of the eye; 0: not given */
    int32_t device;                 /* index, DEVICE_AUTO or DEVICE_CPU */
    bool window;
    bool validate;
    bool no_cache;
    const char *stats;
    const char *plugin;
};

/* Reports the first mistake. */
bool options_parse(int argc, char **argv, struct options *out);

void options_print_usage(void);

#endif
