/* Positions of stations by name: the table of Debian's weather-util-data (an INI file, gzip or plain). */
#ifndef VELUM_WEATHER_STATIONS_H
#define VELUM_WEATHER_STATIONS_H

#include <stddef.h>
#include <velum_weather/weather.h>

#define WEATHER_STATION_TABLE "/usr/share/weather-util/stations.gz"

typedef struct weather_stations {
    velum_weather_station *stations; /* sorted by name; elevations are 0: the table has none */
    uint32_t count;
} weather_stations;

/* Entries without a position, or with one out of range, are left out. */
velum_result weather_stations_read(weather_stations *table, const char *path, velum_weather_error *error);
velum_result weather_stations_parse(weather_stations *table, const char *name, const char *text, size_t size,
                                    velum_weather_error *error);
void weather_stations_finish(weather_stations *table);
/* Null: not in the table. */
const velum_weather_station *weather_stations_find(const weather_stations *table, const char *name);

#endif
