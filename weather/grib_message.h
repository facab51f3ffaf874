/* The section structure of GRIB edition 2 (WMO Manual on Codes, FM 92): a file's messages cut into fields and checked,
 * before anything is handed to a decoder. */
#ifndef VELUM_WEATHER_GRIB_MESSAGE_H
#define VELUM_WEATHER_GRIB_MESSAGE_H

#include <stddef.h>
#include <stdint.h>
#include <velum_weather/weather.h>

/* A fuzzer would spend its time on large empty grids. */
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
enum { GRIB_MAX_NODES = 1 << 14 };
#else
enum { GRIB_MAX_NODES = 1 << 21 };
#endif
enum { GRIB_SURFACE_NONE = 255 };

typedef struct grib_span {
    const unsigned char *bytes;
    size_t size;
} grib_span;

typedef struct grib_field {
    uint32_t number; /* in the file, from 1; fields of one message count singly, as grib_ls does */
    uint32_t discipline;
    uint32_t centre;
    uint32_t category; /* 255: a product definition that is not looked at */
    uint32_t parameter;
    int instant;      /* 0: mean, sum or extreme over a period */
    uint32_t surface; /* type of the first fixed surface (code table 4.5) */
    double surface_value;
    grib_span grid;    /* section 3 */
    grib_span packing; /* section 5 */
    grib_span bitmap;  /* section 6, 254 resolved */
    grib_span data;    /* section 7 */
} grib_field;

/* A regular latitude-longitude grid, rows from the first latitude on. */
typedef struct grib_grid {
    uint32_t columns, rows;
    double lat_first_deg, lon_first_deg, lat_step_deg, lon_step_deg;
} grib_grid;

typedef struct grib_reader {
    const char *name;
    const unsigned char *bytes;
    size_t size;
    size_t position;    /* of the next section or message */
    size_t message_end; /* 0: between messages */
    uint32_t number;
    uint32_t discipline, centre;
    grib_span grid, bitmap;
    int has_product;
    grib_field next;
} grib_reader;

void grib_reader_init(grib_reader *reader, const char *name, const void *bytes, size_t size);
/* *got is 0 at the end of the file. */
velum_result grib_reader_next(grib_reader *reader, grib_field *field, int *got, velum_weather_error *error);

/* Checks section 3 and reads it. */
velum_result grib_field_grid(const grib_field *field, const char *name, grib_grid *grid, velum_weather_error *error);

uint32_t grib_u16(const unsigned char *bytes);
uint32_t grib_u32(const unsigned char *bytes);
int32_t grib_s16(const unsigned char *bytes); /* sign and magnitude */
int32_t grib_s32(const unsigned char *bytes);

#endif
