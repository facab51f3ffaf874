/* The two forms of METAR files, cut into records: the CSV cache of the aviation weather service, and plain lines. */
#ifndef VELUM_WEATHER_METAR_FILE_H
#define VELUM_WEATHER_METAR_FILE_H

#include <stddef.h>
#include <velum_weather/weather.h>

typedef struct metar_field {
    const char *text; /* not terminated; of a quoted field without the quotes, doubled quotes left as they are */
    size_t size;
    uint32_t line, column;
} metar_field;

typedef struct metar_record {
    uint32_t line;
    metar_field raw;
    metar_field lat, lon, elevation, time; /* text null: not in the file */
    char reason[96];                       /* not empty: the record cannot be used */
    uint32_t reason_column;                /* 0: the whole record */
} metar_record;

enum { METAR_COLUMN_RAW, METAR_COLUMN_LAT, METAR_COLUMN_LON, METAR_COLUMN_ELEVATION, METAR_COLUMN_TIME, METAR_COLUMNS };

typedef struct metar_file {
    const char *name, *text;
    size_t size, position;
    uint32_t line;
    int is_csv;
    int columns[METAR_COLUMNS]; /* -1: not there */
    int column_count;
    uint32_t expected, rows; /* "N results" of the preamble; 0: not said */
    uint32_t results_line;
} metar_file;

velum_result metar_file_open(metar_file *file, const char *name, const char *text, size_t size,
                             velum_weather_error *error);
velum_result metar_file_next(metar_file *file, metar_record *record, int *got, velum_weather_error *error);

#endif
