/* JSON with places: jansson's values together with where each stands in the text, and readers of fields that refuse
 * what does not fit by file, line, column and field. */
#ifndef VELUM_WEATHER_JSON_H
#define VELUM_WEATHER_JSON_H

#include <jansson.h>
#include <stddef.h>
#include <velum_weather/weather.h>

/* Returns the result of a call that failed. */
#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        velum_result try_result = (call);                                                                              \
        if (try_result < 0) {                                                                                          \
            return try_result;                                                                                         \
        }                                                                                                              \
    } while (0)

/* A value in the text. Nodes stand in the order of the text: a container before what it holds. */
typedef struct json_node {
    json_t *value;   /* borrowed */
    const char *key; /* of a member; null in arrays and for the root */
    uint32_t key_at; /* byte offsets */
    uint32_t at;
    uint32_t parent; /* indices of nodes; the root is its own parent */
    uint32_t next;   /* sibling, 0: none */
    uint32_t first;  /* child, 0: none */
    uint32_t count;  /* of children */
} json_node;

typedef struct json_document {
    const char *name; /* of the file, for errors */
    const char *text;
    size_t size;
    velum_weather_error *error; /* of the call that reads; may be null */
    json_t *root;
    json_node *nodes;
    uint32_t count, capacity;
} json_document;

/* The text, name and error must outlive the document. Refuses duplicate keys, NaN and infinities (RFC 8259). */
velum_result json_document_init(json_document *document, const char *name, const char *text, size_t size,
                                velum_weather_error *error);
void json_document_finish(json_document *document);

const json_node *json_document_root(const json_document *document);
const json_node *json_first(const json_document *document, const json_node *node);
const json_node *json_next(const json_document *document, const json_node *node);
const json_node *json_member(const json_document *document, const json_node *object, const char *key);
void json_place(const json_document *document, const json_node *node, uint32_t *line, uint32_t *column);

/* "weather[0].sources[1].grib"; empty for the root. Cut where the buffer ends. */
void json_path(const json_document *document, const json_node *node, char *text, size_t size);

/* Fails with "file:line:column: field: found X, expected ..."; the field and X are the node's. */
__attribute__((format(printf, 3, 4))) velum_result json_refuse(const json_document *document, const json_node *node,
                                                               const char *expected, ...);
/* The same for a member that is not there: the place is the object's. */
velum_result json_refuse_missing(const json_document *document, const json_node *object, const char *key,
                                 const char *expected);

velum_result json_expect_object(const json_document *document, const json_node *node);
velum_result json_expect_array(const json_document *document, const json_node *node, uint32_t least, uint32_t most);

/* Refuses members whose key is not in `keys` (null-terminated). */
velum_result json_expect_keys(const json_document *document, const json_node *object, const char *const *keys);

/* Refuses only members whose key looks like a spelling mistake of one in `keys`: where foreign members are legal. */
velum_result json_expect_spelling(const json_document *document, const json_node *object, const char *const *keys);

velum_result json_number(const json_document *document, const json_node *node, double least, double most, double *out);
velum_result json_whole_number(const json_document *document, const json_node *node, int64_t least, int64_t most,
                               int64_t *out);

/* Readers of a member. An optional member that is not there leaves *out as it was. */
enum { JSON_OPTIONAL = 0, JSON_REQUIRED = 1 };
velum_result json_read_double(const json_document *document, const json_node *object, const char *key, int required,
                              double least, double most, double *out);
velum_result json_read_float(const json_document *document, const json_node *object, const char *key, int required,
                             double least, double most, float *out);
velum_result json_read_integer(const json_document *document, const json_node *object, const char *key, int required,
                               int64_t least, int64_t most, int64_t *out);
velum_result json_read_bool(const json_document *document, const json_node *object, const char *key, int required,
                            uint32_t *out);
velum_result json_read_string(const json_document *document, const json_node *object, const char *key, int required,
                              size_t least_bytes, size_t most_bytes, const char **out);
velum_result json_read_floats(const json_document *document, const json_node *object, const char *key, int required,
                              uint32_t count, double least, double most, float *out);

typedef struct json_word {
    const char *word;
    int32_t value;
} json_word;
velum_result json_read_word(const json_document *document, const json_node *object, const char *key, int required,
                            const json_word *words, uint32_t count, int32_t *out);

#endif
