#include "grib_decode.h"

#include "error.h"

#include <eccodes.h>
#include <math.h>
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <zlib.h>

enum {
    PACKING_SIMPLE = 0,
    PACKING_COMPLEX = 2,
    PACKING_COMPLEX_SPATIAL = 3,
    PACKING_IEEE = 4,
    PACKING_JPEG2000 = 40,
    PACKING_PNG = 41,
    PACKING_CCSDS = 42,
    DATA_HEAD_BYTES = 5,
    BITMAP_HEAD_BYTES = 6,
};

static const double missing_value = 9.999e20;

typedef struct packing {
    uint32_t template_number;
    uint32_t count; /* packed values */
    double reference;
    int binary_scale, decimal_scale;
    uint32_t bits;
    int constant; /* all values are the reference */
} packing;

static velum_result fail(const grib_field *field, const char *name, velum_weather_error *error, const char *what) {
    return weather_fail_message(error, VELUM_ERROR_ARGUMENT, name, field->number, "%s", what);
}

static uint32_t read_bits(const unsigned char *bytes, uint64_t bit, uint32_t count) {
    uint64_t value = 0;
    for (uint32_t i = 0; i < count; ++i, ++bit) {
        value = value << 1 | (bytes[bit >> 3] >> (7 - (bit & 7)) & 1u);
    }
    return (uint32_t)value;
}

static uint64_t whole_bytes(uint64_t bits) {
    return (bits + 7) / 8;
}

/* Complex packing, templates 5.2 and 5.3: the groups must add up to the values and fit into the section. */
static velum_result check_groups(const grib_field *field, const char *name, packing *out, velum_weather_error *error) {
    const unsigned char *head = field->packing.bytes;
    const unsigned char *data = field->data.bytes + DATA_HEAD_BYTES;
    const uint64_t size = field->data.size - DATA_HEAD_BYTES;
    const int spatial = out->template_number == PACKING_COMPLEX_SPATIAL;
    if (field->packing.size < (spatial ? 49u : 47u)) {
        return fail(field, name, error, "packing section: too short for complex packing");
    }
    const uint32_t groups = grib_u32(head + 31);
    const uint32_t width_reference = head[35], width_bits = head[36];
    const uint64_t length_reference = grib_u32(head + 37);
    const uint32_t length_increment = head[41], last_length = grib_u32(head + 42), length_bits = head[46];
    uint64_t used = 0;
    if (groups == 0) {
        out->constant = 1;
        return VELUM_OK;
    }
    if (head[21] > 2) {
        return fail(field, name, error, "missing value management: expected 0, 1 or 2");
    }
    if (groups > out->count || width_bits > 8 || length_bits > 32) {
        return fail(field, name, error, "groups: more than there are values, or fields wider than they may be");
    }
    if (spatial) {
        const uint32_t order = head[47], octets = head[48];
        if (order < 1 || order > 2 || octets < 1 || octets > 4 || out->count <= order) {
            return fail(field, name, error, "spatial differencing: expected order 1 or 2 with 1 to 4 octets a value");
        }
        used = (uint64_t)(order + 1) * octets;
    }
    const uint64_t widths = used + whole_bytes((uint64_t)groups * out->bits);
    const uint64_t lengths = widths + whole_bytes((uint64_t)groups * width_bits);
    const uint64_t values = lengths + whole_bytes((uint64_t)groups * length_bits);
    if (values > size) {
        return fail(field, name, error, "data section: shorter than its groups' descriptions");
    }
    uint64_t count = 0, bits = 0;
    for (uint32_t i = 0; i < groups; ++i) {
        const uint32_t width = width_reference + read_bits(data + widths, (uint64_t)i * width_bits, width_bits);
        uint64_t length = length_reference + (uint64_t)length_increment *
                                                 read_bits(data + lengths, (uint64_t)i * length_bits, length_bits);
        length = i + 1 == groups ? last_length : length;
        count += length;
        bits += length * width;
        if (width > 31 || count > out->count) {
            return fail(field, name, error, "groups: wider than 31 bits, or longer than the field");
        }
    }
    if (count != out->count || whole_bytes(bits) > size - values) {
        return fail(field, name, error,
                    "groups: their values are not those of the field, or do not fit the data section");
    }
    return VELUM_OK;
}

/* All chunks up to IEND lie inside, with their checksums, and unpack to rows * row_bytes: ecCodes ends the process when
 * a read goes beyond, and libpng writes to stderr. */
static int png_is_whole(const unsigned char *data, size_t size, uint64_t expected) {
    unsigned char sink[4096];
    uint64_t unpacked = 0;
    int status = Z_OK, is_ended = 0;
    z_stream stream = {0};
    if (inflateInit(&stream) != Z_OK) {
        return 0;
    }
    for (size_t at = 8; !is_ended && size - at >= 12;) {
        const uint32_t length = grib_u32(data + at);
        const unsigned char *type = data + at + 4;
        if (length > size - at - 12 || crc32(crc32(0, NULL, 0), type, length + 4) != grib_u32(type + 4 + length)) {
            break;
        }
        is_ended = memcmp(type, "IEND", 4) == 0;
        if (memcmp(type, "IDAT", 4) == 0) {
            stream.next_in = (unsigned char *)(uintptr_t)(type + 4);
            stream.avail_in = length;
            while (status == Z_OK && stream.avail_in && unpacked <= expected) {
                stream.next_out = sink;
                stream.avail_out = sizeof(sink);
                status = inflate(&stream, Z_NO_FLUSH);
                unpacked += sizeof(sink) - stream.avail_out;
            }
        } else if (!is_ended && at > 8 && (type[0] & 0x20) == 0) {
            break; /* a palette or an unknown critical chunk */
        }
        at += 12 + (size_t)length;
    }
    while (status == Z_OK && is_ended && unpacked <= expected) {
        stream.next_out = sink;
        stream.avail_out = sizeof(sink);
        status = inflate(&stream, Z_NO_FLUSH);
        unpacked += sizeof(sink) - stream.avail_out;
    }
    inflateEnd(&stream);
    return is_ended && status == Z_STREAM_END && unpacked == expected;
}

/* The picture inside must have as many points as there are packed values, of the stated depth. */
static velum_result check_picture(const grib_field *field, const char *name, const packing *in,
                                  velum_weather_error *error) {
    const unsigned char *data = field->data.bytes + DATA_HEAD_BYTES;
    const size_t size = field->data.size - DATA_HEAD_BYTES;
    uint64_t points = 0;
    int fits = 0;
    if (in->template_number == PACKING_PNG) {
        static const unsigned char magic[16] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10, 0, 0, 0, 13, 'I', 'H', 'D', 'R'};
        if (size < 45 || memcmp(data, magic, sizeof(magic)) != 0) {
            return fail(field, name, error, "data section: expected a PNG picture");
        }
        const uint32_t depth = data[24], colour = data[25];
        const uint32_t channels = colour == 0 ? 1 : colour == 2 ? 3 : colour == 6 ? 4 : 0;
        const uint64_t columns = grib_u32(data + 16), rows = grib_u32(data + 20);
        points = columns * rows;
        if (points != in->count || !png_is_whole(data, size, rows * (1 + (columns * depth * channels + 7) / 8))) {
            return fail(field, name, error, "data section: the PNG picture is damaged or not of the field's size");
        }
        fits = data[28] == 0 &&
               (depth * channels == in->bits || (colour == 0 && depth >= in->bits && depth - in->bits < 8));
    } else {
        if (size < 47 || memcmp(data, "\xff\x4f\xff\x51", 4) != 0) {
            return fail(field, name, error, "data section: expected a JPEG 2000 code stream");
        }
        const uint32_t x0 = grib_u32(data + 16), y0 = grib_u32(data + 20);
        const uint32_t x1 = grib_u32(data + 8), y1 = grib_u32(data + 12);
        if (x1 > x0 && y1 > y0) {
            points = (uint64_t)(x1 - x0) * (y1 - y0);
        }
        /* One component, unsigned (ecCodes ends the process otherwise), without subsampling, tiles that are not many
         * more than needed. */
        fits = grib_u16(data + 40) == 1 && data[42] < 128 && data[43] == 1 && data[44] == 1 &&
               grib_u32(data + 24) > 0 && grib_u32(data + 28) > 0 &&
               (uint64_t)grib_u32(data + 24) * grib_u32(data + 28) >= points / 1024;
    }
    if (points != in->count || !fits) {
        return fail(field, name, error, "data section: the picture's size or depth is not that of the field");
    }
    return VELUM_OK;
}

static velum_result check_packing(const grib_field *field, const char *name, packing *out, velum_weather_error *error) {
    const unsigned char *bytes = field->packing.bytes;
    const uint64_t data_bits = (uint64_t)(field->data.size - DATA_HEAD_BYTES) * 8;
    memset(out, 0, sizeof(*out));
    out->count = grib_u32(bytes + 5);
    out->template_number = grib_u16(bytes + 9);
    if (out->template_number == PACKING_IEEE) {
        const uint32_t precision = field->packing.size >= 12 ? bytes[11] : 0;
        if (precision != 1 && precision != 2) {
            return fail(field, name, error, "IEEE packing: expected precision 1 or 2");
        }
        if (out->count > data_bits / (precision * 32)) {
            return fail(field, name, error, "data section: shorter than its values");
        }
        return VELUM_OK;
    }
    if (field->packing.size < 21) {
        return fail(field, name, error, "packing section: too short");
    }
    const uint32_t raw = grib_u32(bytes + 11);
    float reference;
    memcpy(&reference, &raw, sizeof(reference));
    out->reference = reference;
    out->binary_scale = grib_s16(bytes + 15);
    out->decimal_scale = grib_s16(bytes + 17);
    out->bits = bytes[19];
    if (!isfinite(reference) || abs(out->binary_scale) > 200 || abs(out->decimal_scale) > 60 || out->bits > 32) {
        return weather_fail_message(error, VELUM_ERROR_ARGUMENT, name, field->number,
                                    "packing: found reference %g, scales 2^%d and 10^-%d, %u bits, expected finite "
                                    "values, scales within 200 and 60, at most 32 bits",
                                    (double)reference, out->binary_scale, out->decimal_scale, out->bits);
    }
    switch (out->template_number) {
    case PACKING_SIMPLE:
        out->constant = out->bits == 0;
        if (out->bits && out->count > data_bits / out->bits) {
            return fail(field, name, error, "data section: shorter than its values");
        }
        return VELUM_OK;
    case PACKING_COMPLEX:
    case PACKING_COMPLEX_SPATIAL: return check_groups(field, name, out, error);
    case PACKING_JPEG2000:
    case PACKING_PNG:
        out->constant = out->bits == 0;
        return out->constant ? VELUM_OK : check_picture(field, name, out, error);
    case PACKING_CCSDS:
        out->constant = out->bits == 0;
        if (field->packing.size < 25 || (out->bits && (bytes[22] == 0 || grib_u16(bytes + 23) == 0))) {
            return fail(field, name, error, "CCSDS packing: block size or reference interval is 0");
        }
        return VELUM_OK;
    default:
        return weather_fail_message(error, VELUM_ERROR_UNSUPPORTED, name, field->number,
                                    "packing: found template 5.%u, expected 0, 2, 3, 4, 40, 41 or 42",
                                    out->template_number);
    }
}

/* The number of points with a value; bitmap is null without one. */
static velum_result check_bitmap(const grib_field *field, const char *name, uint32_t nodes, uint32_t *count,
                                 const unsigned char **bitmap, velum_weather_error *error) {
    const uint32_t indicator = field->bitmap.bytes[5];
    *bitmap = NULL;
    *count = nodes;
    if (indicator == 255) {
        return VELUM_OK;
    }
    if (indicator != 0) {
        return weather_fail_message(error, VELUM_ERROR_UNSUPPORTED, name, field->number,
                                    "bitmap: found indicator %u, expected 0, 254 or 255", indicator);
    }
    if (field->bitmap.size - BITMAP_HEAD_BYTES < whole_bytes(nodes)) {
        return fail(field, name, error, "bitmap section: shorter than the grid");
    }
    *bitmap = field->bitmap.bytes + BITMAP_HEAD_BYTES;
    *count = 0;
    for (uint32_t i = 0; i < nodes; ++i) {
        *count += (*bitmap)[i >> 3] >> (7 - (i & 7)) & 1u;
    }
    return VELUM_OK;
}

static void put_u32(unsigned char *bytes, uint32_t value) {
    for (int i = 0; i < 4; ++i) {
        bytes[i] = (unsigned char)(value >> (24 - 8 * i));
    }
}

/* A message of one row of `count` points without a bitmap, with the field's packing and data. */
static unsigned char *compose(const grib_field *field, uint32_t count, size_t *size) {
    static const unsigned char identification[21] = {0, 0, 0, 21, 1, 0, 0, 0, 0, 2, 0, 1, 7, 208, 1, 1, 0, 0, 0, 0, 0};
    static const unsigned char no_bitmap[6] = {0, 0, 0, 6, 6, 255};
    unsigned char indicator[16] = {'G', 'R', 'I', 'B', 0, 0, 0, 2};
    unsigned char grid[72] = {0, 0, 0, 72, 3};
    unsigned char product[34] = {0, 0, 0, 34, 4};
    *size = sizeof(indicator) + sizeof(identification) + sizeof(grid) + sizeof(product) + field->packing.size +
            sizeof(no_bitmap) + field->data.size + 4;
    if (*size > UINT32_MAX) {
        return NULL;
    }
    put_u32(indicator + 12, (uint32_t)*size);
    put_u32(grid + 6, count);
    grid[14] = 6;
    put_u32(grid + 30, count);
    put_u32(grid + 34, 1);
    put_u32(grid + 59, 1000000);
    grid[54] = 48;
    product[22] = 1;
    product[28] = 255;
    unsigned char *message = malloc(*size);
    if (!message) {
        return NULL;
    }
    const grib_span parts[8] = {{indicator, sizeof(indicator)},
                                {identification, sizeof(identification)},
                                {grid, sizeof(grid)},
                                {product, sizeof(product)},
                                field->packing,
                                {no_bitmap, sizeof(no_bitmap)},
                                field->data,
                                {(const unsigned char *)"7777", 4}};
    size_t used = 0;
    for (int i = 0; i < 8; ++i) {
        memcpy(message + used, parts[i].bytes, parts[i].size);
        used += parts[i].size;
    }
    return message;
}

/* ecCodes passes OpenJPEG's complaints to its one logger, by default stderr. There is no way to ask for the logger in
 * use, so a host with one of its own has to set it again after reading a file with JPEG 2000 fields. */
static pthread_mutex_t logger_lock = PTHREAD_MUTEX_INITIALIZER;

static void log_nothing(const codes_context *context, int level, const char *message) {
    (void)context;
    (void)level;
    (void)message;
}

static int decode_values(codes_handle *handle, int quietly, double *values, size_t *count) {
    if (!quietly) {
        return codes_get_double_array(handle, "values", values, count);
    }
    pthread_mutex_lock(&logger_lock);
    codes_context_set_logging_proc(codes_context_get_default(), log_nothing);
    const int status = codes_get_double_array(handle, "values", values, count);
    codes_context_set_logging_proc(codes_context_get_default(), NULL);
    pthread_mutex_unlock(&logger_lock);
    return status;
}

static velum_result unpack(const grib_field *field, const char *name, uint32_t count, double *values,
                           velum_weather_error *error) {
    velum_result result = VELUM_OK;
    codes_handle *handle = NULL;
    size_t size = 0;
    unsigned char *message = compose(field, count, &size);
    if (!message) {
        return weather_out_of_memory(error, name);
    }
    handle = codes_handle_new_from_message(NULL, message, size);
    if (!handle) {
        result = fail(field, name, error, "ecCodes cannot read this message");
        goto done;
    }
    size_t got = 0;
    int status = codes_set_double(handle, "missingValue", missing_value);
    status = status ? status : codes_get_size(handle, "values", &got);
    if (!status && got != count) {
        result = weather_fail_message(error, VELUM_ERROR_ARGUMENT, name, field->number, "found %zu values, expected %u",
                                      got, count);
        goto done;
    }
    const uint32_t template_number = grib_u16(field->packing.bytes + 9);
    const int quietly = template_number == PACKING_JPEG2000 || template_number == PACKING_CCSDS;
    status = status ? status : decode_values(handle, quietly, values, &got);
    if (status || got != count) {
        result = weather_fail_message(error, VELUM_ERROR_ARGUMENT, name, field->number,
                                      "ecCodes cannot decode the values: %s", codes_get_error_message(status));
    }
done:
    codes_handle_delete(handle);
    free(message);
    return result;
}

velum_result grib_field_decode(const grib_field *field, const char *name, const grib_grid *grid, float *values,
                               velum_weather_error *error) {
    const uint32_t nodes = grid->columns * grid->rows;
    uint32_t count = 0;
    const unsigned char *bitmap = NULL;
    packing pack;
    velum_result result = check_bitmap(field, name, nodes, &count, &bitmap, error);
    result = result ? result : check_packing(field, name, &pack, error);
    if (result) {
        return result;
    }
    if (pack.count != count) {
        return weather_fail_message(error, VELUM_ERROR_ARGUMENT, name, field->number,
                                    "packing: found %u values, expected %u (grid and bitmap)", pack.count, count);
    }
    double *packed = malloc((count ? count : 1) * sizeof(*packed));
    if (!packed) {
        return weather_out_of_memory(error, name);
    }
    if (count && pack.constant) {
        const double value = pack.reference * pow(10.0, -pack.decimal_scale);
        for (uint32_t i = 0; i < count; ++i) {
            packed[i] = value;
        }
    } else if (count) {
        result = unpack(field, name, count, packed, error);
    }
    uint32_t used = 0;
    for (uint32_t i = 0; i < nodes && !result; ++i) {
        const int present = !bitmap || (bitmap[i >> 3] >> (7 - (i & 7)) & 1u);
        const double value = present ? packed[used++] : missing_value;
        values[i] = value >= missing_value * 0.99 && value <= missing_value * 1.01 ? NAN : (float)value;
        /* A NaN of the file (IEEE packing) is not a missing value: it must be seen and refused. */
        if (present && !isfinite(value)) {
            values[i] = INFINITY;
        }
    }
    free(packed);
    return result;
}
