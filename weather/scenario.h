/* Scenario files, version 1. */
#ifndef VELUM_WEATHER_SCENARIO_H
#define VELUM_WEATHER_SCENARIO_H

/* "2014-12-18T08:00:00Z", seconds with a fraction or left out; years 1900..2199. 0: not such a time. */
int scenario_parse_utc(const char *text, double *unix_s);

#endif
