/* What layout.py finds in a set of headers. */
#ifndef TESTS_ABI_LAYOUT_H
#define TESTS_ABI_LAYOUT_H

#include <stdint.h>

typedef struct layout_struct {
    const char *name;
    uint64_t size;
} layout_struct;

typedef struct layout_field {
    const char *owner, *name;
    const char *declaration;
    uint64_t offset, size;
} layout_field;

typedef struct layout_constant {
    const char *name;
    int64_t value;
} layout_constant;

/* Of the frozen headers, and of today's. */
extern const layout_struct v1_structs[], now_structs[];
extern const layout_field v1_fields[], now_fields[];
extern const layout_constant v1_constants[], now_constants[];
extern const uint32_t v1_struct_count, now_struct_count;
extern const uint32_t v1_field_count, now_field_count;
extern const uint32_t v1_constant_count, now_constant_count;

#endif
