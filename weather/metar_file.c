#include "metar_file.h"

#include "error.h"

#include <stdio.h>
#include <string.h>

enum { MAX_PREAMBLE_LINES = 20, MAX_COLUMNS = 256 };

static const char *const column_names[METAR_COLUMNS] = {[METAR_COLUMN_RAW] = "raw_text",
                                                        [METAR_COLUMN_LAT] = "latitude",
                                                        [METAR_COLUMN_LON] = "longitude",
                                                        [METAR_COLUMN_ELEVATION] = "elevation_m",
                                                        [METAR_COLUMN_TIME] = "observation_time"};

static size_t line_size(const metar_file *file, size_t position, size_t *next) {
    const char *newline = memchr(file->text + position, '\n', file->size - position);
    size_t size = newline ? (size_t)(newline - file->text) - position : file->size - position;
    *next = position + size + (newline != NULL);
    if (size && file->text[position + size - 1] == '\r') {
        --size;
    }
    return size;
}

static int field_is(const metar_field *field, const char *name) {
    return field->size == strlen(name) && memcmp(field->text, name, field->size) == 0;
}

static int is_control(char byte) {
    const unsigned char c = (unsigned char)byte;
    return (c < 0x20 && c != '\t' && c != '\r' && c != '\n') || c == 0x7f;
}

/* One field of a CSV row (RFC 4180); *end is 1 after the row's last. */
static velum_result take_field(metar_file *file, size_t row_start, metar_field *field, int *end,
                               velum_weather_error *error) {
    const char *text = file->text;
    size_t at = file->position;
    field->line = file->line;
    field->column = (uint32_t)(at - row_start) + 1;
    if (at < file->size && text[at] == '"') {
        field->text = text + ++at;
        while (at < file->size && (text[at] != '"' || (at + 1 < file->size && text[at + 1] == '"'))) {
            file->line += text[at] == '\n';
            at += text[at] == '"' ? 2 : 1;
        }
        if (at >= file->size) {
            return weather_fail(error, VELUM_ERROR_ARGUMENT, file->name, field->line, field->column,
                                "quoted field: found the end of the file, expected a closing quote");
        }
        field->size = (size_t)(text + at - field->text);
        ++at;
        while (at < file->size && is_control(text[at])) {
            ++at; /* check_record names it */
        }
    } else {
        field->text = text + at;
        while (at < file->size && text[at] != ',' && text[at] != '\n' && text[at] != '\r') {
            ++at;
        }
        field->size = (size_t)(text + at - field->text);
    }
    if (at < file->size && text[at] == '\r') {
        ++at;
    }
    *end = at >= file->size || text[at] == '\n';
    if (!*end && text[at] != ',') {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, file->name, file->line, (uint32_t)(at - row_start) + 1,
                            "found '%c' after a field, expected a comma or the end of the line", text[at]);
    }
    if (at < file->size) {
        file->line += text[at] == '\n';
        ++at;
    }
    file->position = at;
    return VELUM_OK;
}

static velum_result take_header(metar_file *file, velum_weather_error *error) {
    const size_t start = file->position;
    const uint32_t line = file->line;
    int end = 0;
    for (int i = 0; i < METAR_COLUMNS; ++i) {
        file->columns[i] = -1;
    }
    while (!end) {
        metar_field field;
        const velum_result result = take_field(file, start, &field, &end, error);
        if (result) {
            return result;
        }
        for (int i = 0; i < METAR_COLUMNS; ++i) {
            if (file->columns[i] < 0 && field_is(&field, column_names[i])) {
                file->columns[i] = file->column_count;
            }
        }
        if (++file->column_count > MAX_COLUMNS) {
            return weather_fail(error, VELUM_ERROR_ARGUMENT, file->name, line, field.column,
                                "header: found more than %d columns", MAX_COLUMNS);
        }
    }
    if (file->columns[METAR_COLUMN_RAW] < 0) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, file->name, line, 1, "header: expected a column raw_text");
    }
    if ((file->columns[METAR_COLUMN_LAT] < 0) != (file->columns[METAR_COLUMN_LON] < 0)) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, file->name, line, 1,
                            "header: expected latitude and longitude together");
    }
    return VELUM_OK;
}

static int has_word(const char *line, size_t size, const char *word) {
    return memmem(line, size, word, strlen(word)) != NULL;
}

static size_t find_control(const metar_file *file, size_t from, size_t to) {
    while (from < to && !is_control(file->text[from])) {
        ++from;
    }
    return from;
}

static velum_result fail_control(const metar_file *file, size_t at, velum_weather_error *error) {
    uint32_t line = 1;
    size_t start = 0;
    for (size_t i = 0; i < at; ++i) {
        if (file->text[i] == '\n') {
            ++line;
            start = i + 1;
        }
    }
    return weather_fail(error, VELUM_ERROR_UNSUPPORTED, file->name, line, (uint32_t)(at - start) + 1,
                        "found byte 0x%02x, expected text", (unsigned char)file->text[at]);
}

/* A stray control character costs its record; in more than a tenth of the lines (and more than one) they say that this
 * is no METAR file. */
static velum_result check_text(const metar_file *file, velum_weather_error *error) {
    size_t lines = 0, bad_lines = 0, first = file->size;
    for (size_t position = 0, next = 0; position < file->size; position = next, ++lines) {
        const size_t end = position + line_size(file, position, &next);
        const size_t control = find_control(file, position, end);
        bad_lines += control < end;
        first = control < end && first == file->size ? control : first;
    }
    return bad_lines > 1 && bad_lines * 10 > lines ? fail_control(file, first, error) : VELUM_OK;
}

static void check_record(const metar_file *file, size_t start, size_t end, metar_record *record) {
    const size_t control = find_control(file, start, end);
    if (control < end) {
        record->reason_column = (uint32_t)(control - start) + 1;
        snprintf(record->reason, sizeof(record->reason), "column %u: found byte 0x%02x, expected text",
                 record->reason_column, (unsigned char)file->text[control]);
    }
}

velum_result metar_file_open(metar_file *file, const char *name, const char *text, size_t size,
                             velum_weather_error *error) {
    memset(file, 0, sizeof(*file));
    file->name = name;
    file->text = text;
    file->size = size;
    file->line = 1;
    const velum_result result = check_text(file, error);
    if (result) {
        return result;
    }
    size_t position = 0, next = 0;
    int is_cache = 0;
    for (uint32_t i = 1; i <= MAX_PREAMBLE_LINES && position < size; ++i, position = next) {
        const char *line = text + position;
        const size_t length = line_size(file, position, &next);
        unsigned results = 0;
        if (has_word(line, length, "raw_text") && has_word(line, length, ",")) {
            file->is_csv = 1;
            file->position = position;
            file->line = i;
            const velum_result header = take_header(file, error);
            const size_t control = find_control(file, 0, file->position);
            return header || control == file->position ? header : fail_control(file, control, error);
        }
        is_cache = is_cache || (length == 19 && memcmp(line, "data source=metars", 18) == 0) ||
                   (length == 18 && memcmp(line, "data source=metars", 18) == 0);
        char head[32] = "";
        memcpy(head, line, length < sizeof(head) - 1 ? length : sizeof(head) - 1);
        int used = 0;
        if (sscanf(head, "%9u results%n", &results, &used) == 1 && used > 0 && (size_t)used == length) {
            file->expected = results;
            file->results_line = i;
        }
    }
    if (is_cache) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, file->results_line ? file->results_line : 1, 1,
                            "found the preamble of a METAR cache, expected a header with raw_text after it");
    }
    file->expected = 0;
    return VELUM_OK;
}

static velum_result next_row(metar_file *file, metar_record *record, int *got, velum_weather_error *error) {
    size_t next = 0;
    while (file->position < file->size && line_size(file, file->position, &next) == 0) {
        file->position = next;
        ++file->line;
    }
    if (file->position >= file->size) {
        if (file->rows < file->expected) {
            return weather_fail(error, VELUM_ERROR_ARGUMENT, file->name, file->line, 1,
                                "truncated: found %u reports, expected %u (line %u)", file->rows, file->expected,
                                file->results_line);
        }
        return VELUM_OK;
    }
    metar_field *const wanted[METAR_COLUMNS] = {[METAR_COLUMN_RAW] = &record->raw,
                                                [METAR_COLUMN_LAT] = &record->lat,
                                                [METAR_COLUMN_LON] = &record->lon,
                                                [METAR_COLUMN_ELEVATION] = &record->elevation,
                                                [METAR_COLUMN_TIME] = &record->time};
    const size_t start = file->position;
    record->line = file->line;
    int end = 0, count = 0;
    for (; !end; ++count) {
        metar_field field;
        const velum_result result = take_field(file, start, &field, &end, error);
        if (result) {
            return result;
        }
        for (int i = 0; i < METAR_COLUMNS; ++i) {
            if (file->columns[i] == count) {
                *wanted[i] = field;
            }
        }
    }
    if (count != file->column_count) {
        snprintf(record->reason, sizeof(record->reason), "found %d columns, expected %d", count, file->column_count);
    }
    check_record(file, start, file->position, record);
    ++file->rows;
    *got = 1;
    return VELUM_OK;
}

/* "2014/12/18 07:56", as the single-station files of tgftp carry it. */
static int is_date_line(const char *line, size_t size) {
    static const char form[] = "dddd/dd/dd dd:dd";
    if (size != sizeof(form) - 1) {
        return 0;
    }
    for (size_t i = 0; i < size; ++i) {
        const int is_digit = line[i] >= '0' && line[i] <= '9';
        if (form[i] == 'd' ? !is_digit : line[i] != form[i]) {
            return 0;
        }
    }
    return 1;
}

static velum_result next_line(metar_file *file, metar_record *record, int *got) {
    while (file->position < file->size && !*got) {
        size_t next = 0;
        const char *line = file->text + file->position;
        size_t size = line_size(file, file->position, &next), indent = 0;
        while (size && (line[size - 1] == ' ' || line[size - 1] == '\t')) {
            --size;
        }
        while (indent < size && (line[indent] == ' ' || line[indent] == '\t')) {
            ++indent;
        }
        if (indent < size && line[indent] != '#' && !is_date_line(line, size)) {
            record->line = file->line;
            record->raw = (metar_field){line + indent, size - indent, file->line, (uint32_t)indent + 1};
            check_record(file, file->position, next, record);
            ++file->rows;
            *got = 1;
        }
        file->position = next;
        ++file->line;
    }
    return VELUM_OK;
}

velum_result metar_file_next(metar_file *file, metar_record *record, int *got, velum_weather_error *error) {
    memset(record, 0, sizeof(*record));
    *got = 0;
    return file->is_csv ? next_row(file, record, got, error) : next_line(file, record, got);
}
