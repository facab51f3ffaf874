#include "grib_message.h"

#include "error.h"

#include <math.h>
#include <string.h>

enum { INDICATOR_BYTES = 16, END_BYTES = 4, SECTION_HEAD_BYTES = 5, MAX_HEADING_BYTES = 128 };

uint32_t grib_u16(const unsigned char *bytes) {
    return (uint32_t)bytes[0] << 8 | bytes[1];
}

uint32_t grib_u32(const unsigned char *bytes) {
    return grib_u16(bytes) << 16 | grib_u16(bytes + 2);
}

int32_t grib_s16(const unsigned char *bytes) {
    const int32_t magnitude = (int32_t)(grib_u16(bytes) & 0x7fffu);
    return bytes[0] & 0x80 ? -magnitude : magnitude;
}

int32_t grib_s32(const unsigned char *bytes) {
    const int32_t magnitude = (int32_t)(grib_u32(bytes) & 0x7fffffffu);
    return bytes[0] & 0x80 ? -magnitude : magnitude;
}

static uint64_t u64(const unsigned char *bytes) {
    return (uint64_t)grib_u32(bytes) << 32 | grib_u32(bytes + 4);
}

void grib_reader_init(grib_reader *reader, const char *name, const void *bytes, size_t size) {
    memset(reader, 0, sizeof(*reader));
    reader->name = name;
    reader->bytes = bytes;
    reader->size = size;
    /* A telecommunication heading may stand before the first message. */
    for (size_t i = 0; i + 4 <= size && i < MAX_HEADING_BYTES; ++i) {
        if (memcmp(reader->bytes + i, "GRIB", 4) == 0) {
            reader->position = i;
            break;
        }
    }
}

static velum_result begin_message(grib_reader *reader, velum_weather_error *error) {
    const unsigned char *bytes = reader->bytes + reader->position;
    const size_t left = reader->size - reader->position;
    const uint32_t number = reader->number + 1;
    char found[5] = "";
    memcpy(found, bytes, left < 4 ? left : 4);
    for (int i = 0; i < 4; ++i) {
        found[i] = found[i] >= 0x20 && found[i] < 0x7f ? found[i] : (found[i] ? '?' : '\0');
    }
    if (left < 4 || memcmp(bytes, "GRIB", 4) != 0) {
        return weather_fail_message(error, number == 1 ? VELUM_ERROR_UNSUPPORTED : VELUM_ERROR_ARGUMENT, reader->name,
                                    number, "at byte %zu: found \"%s\", expected \"GRIB\"", reader->position, found);
    }
    if (left < INDICATOR_BYTES) {
        return weather_fail_message(error, VELUM_ERROR_ARGUMENT, reader->name, number,
                                    "truncated: found %zu bytes, expected at least %d", left, INDICATOR_BYTES);
    }
    if (bytes[7] != 2) {
        return weather_fail_message(error, VELUM_ERROR_UNSUPPORTED, reader->name, number,
                                    "found GRIB edition %d, expected 2", bytes[7]);
    }
    const uint64_t length = u64(bytes + 8);
    if (length > left) {
        return weather_fail_message(error, VELUM_ERROR_ARGUMENT, reader->name, number,
                                    "truncated: found %zu bytes, expected %llu", left, (unsigned long long)length);
    }
    if (length < INDICATOR_BYTES + END_BYTES) {
        return weather_fail_message(error, VELUM_ERROR_ARGUMENT, reader->name, number,
                                    "total length: found %llu, expected at least %d", (unsigned long long)length,
                                    INDICATOR_BYTES + END_BYTES);
    }
    if (memcmp(bytes + length - END_BYTES, "7777", END_BYTES) != 0) {
        return weather_fail_message(error, VELUM_ERROR_ARGUMENT, reader->name, number,
                                    "end section: expected \"7777\" at byte %llu",
                                    (unsigned long long)(reader->position + length - END_BYTES));
    }
    reader->discipline = bytes[6];
    reader->message_end = reader->position + (size_t)length - END_BYTES;
    reader->position += INDICATOR_BYTES;
    reader->centre = 0;
    reader->grid = (grib_span){0};
    reader->bitmap = (grib_span){0};
    reader->has_product = 0;
    return VELUM_OK;
}

static double scaled(const unsigned char *bytes) {
    if (bytes[0] == 0xff || grib_u32(bytes + 1) == 0xffffffffu) {
        return 0.0;
    }
    const int factor = bytes[0] & 0x80 ? -(bytes[0] & 0x7f) : bytes[0];
    return (double)grib_s32(bytes + 1) * pow(10.0, -factor);
}

/* Product definition templates that share the layout up to octet 34: at a point in time or over a period, of one
 * forecast or of an ensemble. */
static void read_product(grib_reader *reader, grib_span section) {
    grib_field *field = &reader->next;
    memset(field, 0, sizeof(*field));
    field->discipline = reader->discipline;
    field->centre = reader->centre;
    field->category = 255;
    field->surface = GRIB_SURFACE_NONE;
    const uint32_t product = grib_u16(section.bytes + 7);
    const int instant = product == 0 || product == 1 || product == 2;
    const int period = product == 8 || product == 11 || product == 12;
    if ((instant || period) && section.size >= 34) {
        field->category = section.bytes[9];
        field->parameter = section.bytes[10];
        field->instant = instant;
        field->surface = section.bytes[22];
        field->surface_value = scaled(section.bytes + 23);
    }
    reader->has_product = 1;
}

static velum_result fail_section(const grib_reader *reader, velum_weather_error *error, int section, const char *what) {
    return weather_fail_message(error, VELUM_ERROR_ARGUMENT, reader->name, reader->number + 1,
                                "section %d at byte %zu: %s", section, reader->position, what);
}

/* Takes one section; *done is 1 when it completed a field. */
static velum_result take_section(grib_reader *reader, int *done, velum_weather_error *error) {
    static const size_t least_bytes[8] = {0, 21, 5, 14, 9, 11, 6, 5};
    const size_t left = reader->message_end - reader->position;
    if (left < SECTION_HEAD_BYTES) {
        return fail_section(reader, error, 0, "found the end of the message, expected a section");
    }
    const unsigned char *bytes = reader->bytes + reader->position;
    const grib_span section = {bytes, grib_u32(bytes)};
    const int number = bytes[4];
    if (number < 1 || number > 7) {
        return fail_section(reader, error, number, "unknown section, expected 1 to 7");
    }
    if (section.size > left) {
        return fail_section(reader, error, number, "longer than its message");
    }
    if (section.size < least_bytes[number]) {
        return fail_section(reader, error, number, "too short");
    }
    switch (number) {
    case 1: reader->centre = grib_u16(bytes + 5); break;
    case 3: reader->grid = section; break;
    case 4: read_product(reader, section); break;
    case 5: reader->next.packing = section; break;
    case 6:
        if (bytes[5] != 254) {
            reader->bitmap = section;
        } else if (!reader->bitmap.size) {
            return fail_section(reader, error, 6, "an earlier bitmap is asked for, but there is none");
        }
        break;
    case 7:
        if (!reader->has_product || !reader->grid.size || !reader->next.packing.size || !reader->bitmap.size) {
            return fail_section(reader, error, 7, "data before grid, product, packing and bitmap sections");
        }
        reader->next.data = section;
        reader->next.grid = reader->grid;
        reader->next.bitmap = reader->bitmap;
        reader->has_product = 0;
        *done = 1;
        break;
    default: break;
    }
    reader->position += section.size;
    return VELUM_OK;
}

velum_result grib_reader_next(grib_reader *reader, grib_field *field, int *got, velum_weather_error *error) {
    velum_result result = VELUM_OK;
    *got = 0;
    if (!reader->message_end) {
        while (reader->number && reader->position < reader->size && reader->bytes[reader->position] == 0) {
            ++reader->position;
        }
        if (reader->position == reader->size && reader->number) {
            return VELUM_OK;
        }
        result = begin_message(reader, error);
    }
    int done = 0;
    while (!result && !done) {
        result = take_section(reader, &done, error);
    }
    if (result) {
        return result;
    }
    reader->next.number = ++reader->number;
    *field = reader->next;
    *got = 1;
    if (reader->position == reader->message_end) {
        reader->position += END_BYTES;
        reader->message_end = 0;
    }
    return VELUM_OK;
}

static velum_result fail_grid(const grib_field *field, const char *name, velum_weather_error *error,
                              velum_result result, const char *what, double found, const char *expected) {
    return weather_fail_message(error, result, name, field->number, "grid: %s: found %g, expected %s", what, found,
                                expected);
}

velum_result grib_field_grid(const grib_field *field, const char *name, grib_grid *grid, velum_weather_error *error) {
    const unsigned char *bytes = field->grid.bytes;
    const velum_result unsupported = VELUM_ERROR_UNSUPPORTED;
    const velum_result wrong = VELUM_ERROR_ARGUMENT;
    const uint32_t definition = grib_u16(bytes + 12);
    if (bytes[5] != 0 || definition != 0) {
        return fail_grid(field, name, error, unsupported, "definition template", definition,
                         "0 (regular latitude-longitude)");
    }
    if (field->grid.size < 72) {
        return fail_grid(field, name, error, wrong, "section length", (double)field->grid.size, "at least 72");
    }
    if (bytes[10] != 0) {
        return fail_grid(field, name, error, unsupported, "list of points a row", bytes[10], "none (0)");
    }
    const uint32_t columns = grib_u32(bytes + 30);
    const uint32_t rows = grib_u32(bytes + 34);
    if (columns < 2 || rows < 2 || columns > GRIB_MAX_NODES || rows > GRIB_MAX_NODES / columns) {
        return weather_fail_message(
            error, wrong, name, field->number,
            "grid: found %u columns and %u rows, expected at least 2 of each and at most %d nodes", columns, rows,
            GRIB_MAX_NODES);
    }
    if (grib_u32(bytes + 6) != columns * rows) {
        return fail_grid(field, name, error, wrong, "number of points", grib_u32(bytes + 6), "columns x rows");
    }
    const uint32_t basic_angle = grib_u32(bytes + 38);
    const uint32_t subdivisions = grib_u32(bytes + 42);
    const int in_microdegrees = basic_angle == 0 || basic_angle == 0xffffffffu;
    if (!in_microdegrees && (subdivisions == 0 || subdivisions == 0xffffffffu)) {
        return fail_grid(field, name, error, wrong, "subdivisions of the basic angle", subdivisions, "1 or more");
    }
    const double unit = in_microdegrees ? 1e-6 : (double)basic_angle / subdivisions;
    const double lat_first = grib_s32(bytes + 46) * unit;
    const double lon_first = grib_s32(bytes + 50) * unit;
    const double lat_last = grib_s32(bytes + 55) * unit;
    const double lon_last = grib_s32(bytes + 59) * unit;
    if (bytes[71] != 0 && bytes[71] != 0x40) {
        return fail_grid(field, name, error, unsupported, "scanning mode", bytes[71],
                         "0 or 64 (rows from west to east)");
    }
    if (fabs(lat_first) > 90.0 || fabs(lat_last) > 90.0) {
        return fail_grid(field, name, error, wrong, "latitude", fabs(lat_first) > 90.0 ? lat_first : lat_last,
                         "-90 to 90");
    }
    if (lon_first < -180.0 || lon_first > 360.0 || lon_last < -180.0 || lon_last > 360.0) {
        return fail_grid(field, name, error, wrong, "longitude",
                         lon_first < -180.0 || lon_first > 360.0 ? lon_first : lon_last, "-180 to 360");
    }
    if (bytes[71] == 0 ? lat_last >= lat_first : lat_last <= lat_first) {
        return fail_grid(field, name, error, wrong, "last latitude", lat_last, "one in the scanning direction");
    }
    double span = lon_last - lon_first;
    span = span <= 0.0 ? span + 360.0 : span;
    double lon_step = span / (columns - 1);
    if (span <= 0.0 || span + lon_step > 360.0 + 0.01 * lon_step) {
        return fail_grid(field, name, error, wrong, "extent in longitude", span, "at most once round the globe");
    }
    if (fabs(span + lon_step - 360.0) <= 0.01 * lon_step) {
        lon_step = 360.0 / columns;
    }
    *grid = (grib_grid){.columns = columns,
                        .rows = rows,
                        .lat_first_deg = lat_first,
                        .lon_first_deg = lon_first,
                        .lat_step_deg = (lat_last - lat_first) / (rows - 1),
                        .lon_step_deg = lon_step};
    return VELUM_OK;
}
