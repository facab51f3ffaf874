/* One error of a call, and the copy rule for structs that cross the ABI. */
#ifndef VELUM_CORE_RESULT_H
#define VELUM_CORE_RESULT_H

#include <stdbool.h>
#include <stddef.h>
#include <velum/abi.h>

#ifdef __cplusplus
extern "C" {
#endif

/* `text` names object and field: "cell 12, layer 3, coverage: found 7, expected 0..1". */
typedef struct core_error {
    velum_result result;
    char text[512];
} core_error;

/* Fills `error` (may be null) and returns `result`. */
velum_result core_fail(core_error *error, velum_result result, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

/* Copies min(*(uint32_t *)in, own) bytes of `in` into `out`, the rest of which is zeroed. False if the size that `in`
 * states is below `frozen`. */
bool core_copy_struct(void *out, size_t own, const void *in, size_t frozen);

#ifdef __cplusplus
}
#endif
#endif
