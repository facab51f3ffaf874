/* Tables of what may be wrong with a struct, and the one loop that tries it all. */
#ifndef TESTS_ABI_MISUSE_H
#define TESTS_ABI_MISUSE_H

#include <stddef.h>

#include "host.h"

typedef enum field_type { FIELD_F32, FIELD_F64, FIELD_I32, FIELD_U32, FIELD_U64 } field_type;

/* One field: low..high is legal, all beyond is not. An infinite bound: that side has no bound but finiteness. For
 * integers a bound beyond the type is none. */
typedef struct field_rule {
    const char *name; /* that the log must hold */
    size_t offset;
    field_type type;
    double low, high;
    velum_result expected; /* VELUM_OK: VELUM_ERROR_ARGUMENT */
} field_rule;

#define RULE(owner, field, type, low, high)                                                                            \
    { #field, offsetof(owner, field), type, low, high, VELUM_OK }
/* Logged under another name. */
#define RULE_AS(owner, field, name, type, low, high)                                                                   \
    { name, offsetof(owner, field), type, low, high, VELUM_OK }
#define RULE_RESERVED(owner, field, type)                                                                              \
    { #field, offsetof(owner, field), type, 0, 0, VELUM_ERROR_FLAGS }

typedef velum_result (*misuse_call)(void *context);

/* What a call under test works on. `snapshot` (may be null) writes what must not change to 256 zeroed bytes. */
typedef struct misuse {
    test_host *host;
    const char *call_name;
    misuse_call call;
    void *context;
    void (*snapshot)(void *context, void *out256);
    bool silent_size; /* where the log is in the struct whose size is too small */
    uint32_t tried, wrong;
} misuse;

/* The call as it is now must give `expected`, log a failure that holds `field` (null: must log nothing; "": any text),
 * and change nothing. */
void misuse_expect(misuse *m, velum_result expected, const char *field);
/* The call as it is now must succeed. */
void misuse_expect_ok(misuse *m, const char *what);

/* Every rule: NaN, infinities, just below low and just above high; with `accept_bounds` finite bounds must be legal. */
void misuse_rules(misuse *m, void *object, const field_rule *rules, size_t count, bool accept_bounds);

/* struct_size 0, 1 and all below `size`; unknown flag bits beside `known_flags` (at offset 4, if has_flags). */
void misuse_struct(misuse *m, void *object, uint32_t size, bool has_flags, uint32_t known_flags);

#endif
