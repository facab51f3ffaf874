/* Small helpers over jansson. */
#ifndef HOST_JSON_H
#define HOST_JSON_H

#include <jansson.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

/* JSON has no NaN or infinity: null stands for them. */
static inline json_t *json_number(double value) {
    return isfinite(value) ? json_real(value) : json_null();
}

static inline json_t *json_floats(const float *values, unsigned count) {
    json_t *array = json_array();
    for (unsigned i = 0; i < count; i++) {
        json_array_append_new(array, json_number((double)values[i]));
    }
    return array;
}

static inline json_t *json_doubles(const double *values, unsigned count) {
    json_t *array = json_array();
    for (unsigned i = 0; i < count; i++) {
        json_array_append_new(array, json_number(values[i]));
    }
    return array;
}

/* One object and a newline; takes over `object`. False: could not be written. */
static inline bool json_print(json_t *object, FILE *file, size_t flags) {
    bool done = object && json_dumpf(object, file, flags | JSON_REAL_PRECISION(9)) == 0 && fputc('\n', file) != EOF &&
                fflush(file) == 0;
    json_decref(object);
    return done;
}

#endif
