#include "json.h"

#include "error.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

/* ------------------------------------------------------------------ places */

static void place_of(const char *text, size_t size, size_t at, uint32_t *line, uint32_t *column) {
    uint32_t l = 1, c = 1;
    const char *start = text;
    const char *end = text + (at < size ? at : size);
    const char *feed;
    while (start < end && (feed = memchr(start, '\n', (size_t)(end - start)))) {
        l++;
        start = feed + 1;
    }
    for (; start < end; start++) {
        c += ((unsigned char)*start & 0xc0u) != 0x80u; /* characters of UTF-8, not bytes */
    }
    *line = l;
    *column = c;
}

static size_t skip_space(const json_document *document, size_t at) {
    while (at < document->size && strchr(" \t\r\n", document->text[at]) && document->text[at]) {
        at++;
    }
    return at;
}

static size_t skip_string(const json_document *document, size_t at) {
    at++;
    while (at < document->size && document->text[at] != '"') {
        at += document->text[at] == '\\' ? 2 : 1;
    }
    return at + 1;
}

static size_t skip_scalar(const json_document *document, size_t at) {
    if (at < document->size && document->text[at] == '"') {
        return skip_string(document, at);
    }
    while (at < document->size && !strchr(" \t\r\n,:]}", document->text[at])) {
        at++;
    }
    return at;
}

static uint32_t add_node(json_document *document, json_t *value, const char *key, size_t key_at, size_t at,
                         uint32_t parent) {
    if (document->count == document->capacity) {
        uint32_t capacity = document->capacity ? document->capacity * 2 : 256;
        json_node *nodes = capacity > document->capacity ? realloc(document->nodes, capacity * sizeof *nodes) : NULL;
        if (!nodes) {
            return UINT32_MAX;
        }
        document->nodes = nodes;
        document->capacity = capacity;
    }
    document->nodes[document->count] =
        (json_node){.value = value, .key = key, .key_at = (uint32_t)key_at, .at = (uint32_t)at, .parent = parent};
    return document->count++;
}

static velum_result lost(const json_document *document, size_t at) {
    uint32_t line = 0, column = 0;
    place_of(document->text, document->size, at, &line, &column);
    return weather_fail(document->error, VELUM_ERROR_ARGUMENT, document->name, line, column,
                        "found text that does not match its parsed values, expected JSON");
}

/* Walks the text, which jansson has found to be JSON, in step with jansson's values: objects keep the order of their
 * members. Its depth is jansson's own limit (2048). *at: where the value starts, then where it ends. */
static velum_result place_value(json_document *document, json_t *value, const char *key, size_t key_at, uint32_t parent,
                                size_t *at, uint32_t *out) {
    *at = skip_space(document, *at);
    uint32_t self = add_node(document, value, key, key_at, *at, parent);
    if (self == UINT32_MAX) {
        return weather_out_of_memory(document->error, document->name);
    }
    *out = self;
    int is_object = json_is_object(value);
    if (!is_object && !json_is_array(value)) {
        *at = skip_scalar(document, *at);
        return VELUM_OK;
    }
    if (*at >= document->size || document->text[*at] != (is_object ? '{' : '[')) {
        return lost(document, *at);
    }
    uint32_t before = 0;
    void *member = is_object ? json_object_iter(value) : NULL;
    size_t count = is_object ? json_object_size(value) : json_array_size(value);
    for (size_t i = 0; i < count; i++) {
        size_t child_key_at = 0;
        const char *child_key = NULL;
        json_t *child = is_object ? json_object_iter_value(member) : json_array_get(value, i);
        *at = skip_space(document, *at + 1);
        if (is_object) {
            child_key = json_object_iter_key(member);
            member = json_object_iter_next(value, member);
            child_key_at = *at;
            size_t end = skip_string(document, *at);
            size_t length = end - *at - 2;
            if (end > document->size ||
                (!memchr(document->text + *at, '\\', end - *at) &&
                 (strlen(child_key) != length || memcmp(document->text + *at + 1, child_key, length) != 0))) {
                return lost(document, *at);
            }
            *at = skip_space(document, end) + 1;
        }
        uint32_t index = 0;
        velum_result result = place_value(document, child, child_key, child_key_at, self, at, &index);
        if (result < 0) {
            return result;
        }
        *at = skip_space(document, *at);
        if (before) {
            document->nodes[before].next = index;
        } else {
            document->nodes[self].first = index;
        }
        before = index;
        document->nodes[self].count++;
    }
    if (count == 0) {
        *at = skip_space(document, *at + 1);
    }
    if (*at >= document->size || document->text[*at] != (is_object ? '}' : ']')) {
        return lost(document, *at);
    }
    *at += 1;
    return VELUM_OK;
}

/* jansson says where the refused token ends; its text says what the token was, if it is short. */
static velum_result refuse_syntax(const json_document *document, const json_error_t *error) {
    size_t at = error->position > 0 ? (size_t)error->position : 0;
    const char *near = strstr(error->text, " near '");
    if (near) {
        near += strlen(" near '");
        const char *end = strrchr(near, '\'');
        size_t length = end ? (size_t)(end - near) : 0;
        if (length > 0 && length <= at && memcmp(document->text + at - length, near, length) == 0) {
            at -= length;
        }
    }
    uint32_t line = 0, column = 0;
    place_of(document->text, document->size, at, &line, &column);
    return weather_fail(document->error, VELUM_ERROR_ARGUMENT, document->name, line, column, "%s, expected JSON",
                        error->text);
}

velum_result json_document_init(json_document *document, const char *name, const char *text, size_t size,
                                velum_weather_error *error) {
    *document = (json_document){.name = name, .text = text, .size = size, .error = error};
    if (size > WEATHER_MAX_FILE_BYTES) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, 0, 0, "found %zu bytes, expected at most %d", size,
                            WEATHER_MAX_FILE_BYTES);
    }
    if (size >= 3 &&
        memcmp(text, "\xef\xbb\xbf", 3) == 0) { /* byte order mark: may be ignored (RFC 8259 section 8.1) */
        document->text += 3;
        document->size -= 3;
    }
    json_error_t syntax = {0};
    velum_result result = VELUM_OK;
    document->root = json_loadb(document->text, document->size, JSON_REJECT_DUPLICATES, &syntax);
    if (!document->root) {
        result = json_error_code(&syntax) == json_error_out_of_memory ? weather_out_of_memory(error, name)
                                                                      : refuse_syntax(document, &syntax);
        goto error;
    }
    size_t at = 0;
    uint32_t root = 0;
    result = place_value(document, document->root, NULL, 0, 0, &at, &root);
    if (result < 0) {
        goto error;
    }
    return VELUM_OK;
error:
    json_document_finish(document);
    return result;
}

void json_document_finish(json_document *document) {
    if (document) {
        json_decref(document->root);
        free(document->nodes);
        *document = (json_document){0};
    }
}

/* ------------------------------------------------------------------ walking */

const json_node *json_document_root(const json_document *document) {
    return document->nodes;
}

const json_node *json_first(const json_document *document, const json_node *node) {
    return node && node->first ? document->nodes + node->first : NULL;
}

const json_node *json_next(const json_document *document, const json_node *node) {
    return node && node->next ? document->nodes + node->next : NULL;
}

const json_node *json_member(const json_document *document, const json_node *object, const char *key) {
    if (!object || !json_is_object(object->value)) {
        return NULL;
    }
    const json_node *node = json_first(document, object);
    while (node && strcmp(node->key, key) != 0) {
        node = json_next(document, node);
    }
    return node;
}

void json_place(const json_document *document, const json_node *node, uint32_t *line, uint32_t *column) {
    place_of(document->text, document->size, node->at, line, column);
}

static size_t append(char *text, size_t size, size_t used, const char *part) {
    int n = used < size ? snprintf(text + used, size - used, "%s", part) : 0;
    used += n > 0 ? (size_t)n : 0;
    return used < size ? used : size;
}

void json_path(const json_document *document, const json_node *node, char *text, size_t size) {
    const json_node *chain[24];
    size_t depth = 0, used = 0;
    if (size == 0) {
        return;
    }
    text[0] = '\0';
    for (; node != document->nodes; node = document->nodes + node->parent) {
        if (depth == sizeof chain / sizeof chain[0]) { /* keep the inner end */
            memmove(chain, chain + 1, sizeof chain - sizeof chain[0]);
            depth--;
        }
        chain[depth++] = node;
    }
    while (depth > 0) {
        const json_node *part = chain[--depth];
        if (part->key) {
            used = append(text, size, used, used ? "." : "");
            used = append(text, size, used, part->key);
        } else {
            char index[24];
            uint32_t i = 0;
            for (const json_node *n = json_first(document, document->nodes + part->parent); n != part;
                 n = json_next(document, n)) {
                i++;
            }
            snprintf(index, sizeof index, "[%u]", i);
            used = append(text, size, used, index);
        }
    }
}

/* ------------------------------------------------------------------ refusals */

static void describe(const json_node *node, char *text, size_t size) {
    switch (json_typeof(node->value)) {
    case JSON_OBJECT: snprintf(text, size, "an object"); return;
    case JSON_ARRAY: snprintf(text, size, "an array of %u", node->count); return;
    case JSON_STRING: {
        const char *string = json_string_value(node->value);
        int cut = 40;
        int is_long = strlen(string) > 40;
        while (is_long && cut > 0 && ((unsigned char)string[cut] & 0xc0u) == 0x80u) {
            cut--;
        }
        snprintf(text, size, "\"%.*s%s\"", cut, string, is_long ? "..." : "");
        for (char *c = text; *c; c++) {
            *c = (unsigned char)*c < 0x20 || *c == 0x7f ? '?' : *c;
        }
        return;
    }
    case JSON_INTEGER: snprintf(text, size, "%" JSON_INTEGER_FORMAT, json_integer_value(node->value)); return;
    case JSON_REAL: snprintf(text, size, "%.9g", json_real_value(node->value)); return;
    case JSON_TRUE: snprintf(text, size, "true"); return;
    case JSON_FALSE: snprintf(text, size, "false"); return;
    case JSON_NULL: snprintf(text, size, "null"); return;
    }
}

static velum_result refuse(const json_document *document, const json_node *node, size_t at, const char *field,
                           const char *found, const char *expected) {
    char path[160];
    uint32_t line = 0, column = 0;
    if (!document->error) {
        return VELUM_ERROR_ARGUMENT;
    }
    json_path(document, node, path, sizeof path);
    size_t used = strlen(path);
    if (field) {
        used = append(path, sizeof path, used, used ? "." : "");
        append(path, sizeof path, used, field);
    }
    place_of(document->text, document->size, at, &line, &column);
    return weather_fail(document->error, VELUM_ERROR_ARGUMENT, document->name, line, column,
                        "%s%sfound %s, expected %s", path, path[0] ? ": " : "", found, expected);
}

velum_result json_refuse(const json_document *document, const json_node *node, const char *expected, ...) {
    char found[96], wanted[320];
    va_list arguments;
    va_start(arguments, expected);
    vsnprintf(wanted, sizeof wanted, expected, arguments);
    va_end(arguments);
    describe(node, found, sizeof found);
    return refuse(document, node, node->at, NULL, found, wanted);
}

velum_result json_refuse_missing(const json_document *document, const json_node *object, const char *key,
                                 const char *expected) {
    return refuse(document, object, object->at, key, "nothing", expected);
}

velum_result json_expect_object(const json_document *document, const json_node *node) {
    return json_is_object(node->value) ? VELUM_OK : json_refuse(document, node, "an object");
}

velum_result json_expect_array(const json_document *document, const json_node *node, uint32_t least, uint32_t most) {
    if (json_is_array(node->value) && node->count >= least && node->count <= most) {
        return VELUM_OK;
    }
    if (least == most) {
        return json_refuse(document, node, "an array of %u", least);
    }
    if (most == UINT32_MAX) {
        return least ? json_refuse(document, node, "an array of at least %u", least)
                     : json_refuse(document, node, "an array");
    }
    return json_refuse(document, node, "an array of %u to %u", least, most);
}

velum_result json_expect_keys(const json_document *document, const json_node *object, const char *const *keys) {
    velum_result result = json_expect_object(document, object);
    if (result < 0) {
        return result;
    }
    for (const json_node *node = json_first(document, object); node; node = json_next(document, node)) {
        uint32_t i = 0;
        while (keys[i] && strcmp(keys[i], node->key) != 0) {
            i++;
        }
        if (!keys[i]) {
            char expected[320];
            size_t used = append(expected, sizeof expected, 0, "one of");
            for (i = 0; keys[i]; i++) {
                used = append(expected, sizeof expected, used, i ? ", " : " ");
                used = append(expected, sizeof expected, used, keys[i]);
            }
            return refuse(document, node, node->key_at, NULL, "an unknown field", expected);
        }
    }
    return VELUM_OK;
}

/* Levenshtein's distance (1966), letters of either case alike; 99 for words that are too long to matter. */
static uint32_t edit_distance(const char *a, const char *b) {
    uint32_t row[33];
    size_t na = strlen(a), nb = strlen(b);
    if (na > 32 || nb > 32) {
        return 99;
    }
    for (size_t j = 0; j <= nb; j++) {
        row[j] = (uint32_t)j;
    }
    for (size_t i = 1; i <= na; i++) {
        uint32_t diagonal = row[0];
        row[0] = (uint32_t)i;
        for (size_t j = 1; j <= nb; j++) {
            uint32_t cost = diagonal + (strncasecmp(a + i - 1, b + j - 1, 1) != 0);
            diagonal = row[j];
            cost = row[j] + 1 < cost ? row[j] + 1 : cost;
            row[j] = row[j - 1] + 1 < cost ? row[j - 1] + 1 : cost;
        }
    }
    return row[nb];
}

velum_result json_expect_spelling(const json_document *document, const json_node *object, const char *const *keys) {
    for (const json_node *node = json_first(document, object); node; node = json_next(document, node)) {
        const char *nearest = NULL;
        for (uint32_t i = 0; keys[i]; i++) {
            if (strcmp(keys[i], node->key) == 0) {
                nearest = NULL;
                break;
            }
            if (edit_distance(keys[i], node->key) <= (strlen(keys[i]) < 6 ? 1 : 2)) {
                nearest = keys[i];
            }
        }
        if (nearest) {
            return refuse(document, node, node->key_at, NULL, "an unknown field", nearest);
        }
    }
    return VELUM_OK;
}

/* ------------------------------------------------------------------ members */

enum { RANGE_SIZE = 80 };

static void describe_numbers(double least, double most, char text[RANGE_SIZE]) {
    if (least < most) {
        snprintf(text, RANGE_SIZE, "a number from %.9g to %.9g", least, most);
    } else {
        snprintf(text, RANGE_SIZE, "%.9g", least);
    }
}

static void describe_integers(int64_t least, int64_t most, char text[RANGE_SIZE]) {
    if (least < most) {
        snprintf(text, RANGE_SIZE, "an integer from %lld to %lld", (long long)least, (long long)most);
    } else {
        snprintf(text, RANGE_SIZE, "%lld", (long long)least);
    }
}

velum_result json_number(const json_document *document, const json_node *node, double least, double most, double *out) {
    double value = json_number_value(node->value);
    if (!json_is_number(node->value) || !(value >= least && value <= most)) {
        char expected[RANGE_SIZE];
        describe_numbers(least, most, expected);
        return json_refuse(document, node, "%s", expected);
    }
    *out = value;
    return VELUM_OK;
}

velum_result json_whole_number(const json_document *document, const json_node *node, int64_t least, int64_t most,
                               int64_t *out) {
    json_int_t value = json_integer_value(node->value);
    if (!json_is_integer(node->value) || value < least || value > most) {
        char expected[RANGE_SIZE];
        describe_integers(least, most, expected);
        return json_refuse(document, node, "%s", expected);
    }
    *out = value;
    return VELUM_OK;
}

velum_result json_read_double(const json_document *document, const json_node *object, const char *key, int required,
                              double least, double most, double *out) {
    const json_node *node = json_member(document, object, key);
    if (!node) {
        char expected[RANGE_SIZE];
        describe_numbers(least, most, expected);
        return required ? json_refuse_missing(document, object, key, expected) : VELUM_OK;
    }
    return json_number(document, node, least, most, out);
}

velum_result json_read_float(const json_document *document, const json_node *object, const char *key, int required,
                             double least, double most, float *out) {
    double value = *out;
    velum_result result = json_read_double(document, object, key, required, least, most, &value);
    *out = result < 0 ? *out : (float)value;
    return result;
}

velum_result json_read_integer(const json_document *document, const json_node *object, const char *key, int required,
                               int64_t least, int64_t most, int64_t *out) {
    const json_node *node = json_member(document, object, key);
    if (!node) {
        char expected[RANGE_SIZE];
        describe_integers(least, most, expected);
        return required ? json_refuse_missing(document, object, key, expected) : VELUM_OK;
    }
    return json_whole_number(document, node, least, most, out);
}

velum_result json_read_bool(const json_document *document, const json_node *object, const char *key, int required,
                            uint32_t *out) {
    const json_node *node = json_member(document, object, key);
    if (!node) {
        return required ? json_refuse_missing(document, object, key, "true or false") : VELUM_OK;
    }
    if (!json_is_boolean(node->value)) {
        return json_refuse(document, node, "true or false");
    }
    *out = json_is_true(node->value);
    return VELUM_OK;
}

velum_result json_read_string(const json_document *document, const json_node *object, const char *key, int required,
                              size_t least_bytes, size_t most_bytes, const char **out) {
    const json_node *node = json_member(document, object, key);
    if (!node) {
        return required ? json_refuse_missing(document, object, key, "a string") : VELUM_OK;
    }
    if (!json_is_string(node->value) || json_string_length(node->value) < least_bytes ||
        json_string_length(node->value) > most_bytes) {
        return json_refuse(document, node, "a string of %zu to %zu bytes", least_bytes, most_bytes);
    }
    *out = json_string_value(node->value);
    return VELUM_OK;
}

velum_result json_read_floats(const json_document *document, const json_node *object, const char *key, int required,
                              uint32_t count, double least, double most, float *out) {
    const json_node *node = json_member(document, object, key);
    if (!node) {
        return required ? json_refuse_missing(document, object, key, "an array of numbers") : VELUM_OK;
    }
    velum_result result = json_expect_array(document, node, count, count);
    const json_node *element = json_first(document, node);
    for (uint32_t i = 0; result >= 0 && i < count; i++, element = json_next(document, element)) {
        double value = 0;
        result = json_number(document, element, least, most, &value);
        out[i] = result < 0 ? out[i] : (float)value;
    }
    return result;
}

velum_result json_read_word(const json_document *document, const json_node *object, const char *key, int required,
                            const json_word *words, uint32_t count, int32_t *out) {
    const json_node *node = json_member(document, object, key);
    char expected[160];
    size_t used = append(expected, sizeof expected, 0, count > 1 ? "one of" : "");
    for (uint32_t i = 0; i < count; i++) {
        used = append(expected, sizeof expected, used, i ? ", " : count > 1 ? " " : "");
        used = append(expected, sizeof expected, used, words[i].word);
    }
    if (!node) {
        return required ? json_refuse_missing(document, object, key, expected) : VELUM_OK;
    }
    for (uint32_t i = 0; json_is_string(node->value) && i < count; i++) {
        if (strcmp(json_string_value(node->value), words[i].word) == 0) {
            *out = words[i].value;
            return VELUM_OK;
        }
    }
    return json_refuse(document, node, "%s", expected);
}
