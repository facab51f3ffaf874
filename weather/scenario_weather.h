/* The weather keys of a scenario and their sources. */
#ifndef VELUM_WEATHER_SCENARIO_WEATHER_H
#define VELUM_WEATHER_SCENARIO_WEATHER_H

#include "json.h"

/* A further source (--weather), read once for all keys. */
typedef struct scenario_extra {
    const char *path;
    char *bytes;
    size_t size;
    int32_t kind; /* SCENARIO_EXTRA_* */
} scenario_extra;
enum { SCENARIO_EXTRA_GRIB = 1, SCENARIO_EXTRA_GEOJSON, SCENARIO_EXTRA_METAR };

/* By content: GRIB magic, JSON, else METAR. */
int32_t scenario_extra_kind(const char *bytes, size_t size);

/* Fills scenario->keys; what was made before an error belongs to the scenario. */
velum_result scenario_read_weather(const json_document *document, const char *directory, const scenario_extra *extras,
                                   uint32_t extra_count, velum_scenario *scenario, velum_weather_report *report);

#endif
