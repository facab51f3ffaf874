/* Checks of what hosts hand in. Each failure is logged, with object, call and field, before it is returned. */
#ifndef PLUGIN_ARGUMENTS_H
#define PLUGIN_ARGUMENTS_H

#include <stdbool.h>
#include <stddef.h>

#include "log.h"

/* Sizes of the structs as ABI 1 was frozen: the least that is accepted. Never change a number. */
enum {
    V1_HOST_INFO = 40,
    V1_PLUGIN_INFO = 48,
    V1_WORLD_DESC = 32,
    V1_POINT_QUERY = 48,
    V1_POINT_ANSWER = 88,
    V1_LINE_QUERY = 80,
    V1_LINE_ANSWER = 32,
    V1_PREPARE_EYE = 56,
    V1_PREPARE_INFO = 32,
    V1_WORLD_INFO = 40,
    V1_STATE_DESC = 56,
    V1_TIMELINE_KEY = 32,
    V1_EYE_DESC = 24,
    V1_VIEW_DESC = 24,
    V1_SHADOW_DESC = 24,
    V1_FRAME_INFO = 88,
    V1_EYE_FRAME = 40,
    V1_VIEW_FRAME = 168,
    V1_SHADOW_FRAME = 32,
    V1_SHADOW_GEOMETRY = 152,
    V1_VIEW_STATS = 88,
    V1_PLAN = 72,
    V1_VULKAN_REQUIREMENTS = 64,
    V1_VULKAN_LEND = 112,
    V1_VULKAN_IMAGES = 72,
    V1_VULKAN_SHADOW = 40,
    V1_STANDALONE_DESC = 40,
    V1_PIXELS = 72
};

/* One call on one object; `result` is what the first failed check found. */
typedef struct checker {
    const log_sink *sink;
    const char *object;
    const char *call;
    velum_result result;
} checker;

/* Each returns false, having set result and logged, if the value is refused. */
bool check_fail(checker *check, velum_result result, const char *format, ...) __attribute__((format(printf, 3, 4)));
bool check_pointer(checker *check, const char *field, const void *pointer);
/* Copies a struct that the host filled; `out` is zeroed beyond what the host knows. */
bool check_in(checker *check, const char *field, void *out, size_t own, const void *in, size_t frozen);
/* Whether a struct that we shall fill is large enough. */
bool check_out(checker *check, const char *field, const void *out, size_t frozen);
bool check_array(checker *check, const char *field, const void *array, uint32_t count, uint32_t *stride, size_t frozen);
bool check_flags(checker *check, const char *field, uint32_t flags, uint32_t known);
bool check_zero(checker *check, const char *field, uint64_t value);
bool check_range(checker *check, const char *field, double value, double low, double high);
bool check_count(checker *check, const char *field, uint64_t value, uint64_t low, uint64_t high);
/* A place in ECEF: finite, between 6,200 and 60,000 km from the centre of the earth. */
bool check_position(checker *check, const char *field, const double ecef_m[3]);
/* Unit within 1e-3. */
bool check_unit(checker *check, const char *field, const double v[3]);

/* Writes min(the host's size, own) bytes of `own_struct` to `out`, whose struct_size stays. */
void write_struct(void *out, const void *own_struct, size_t own);

#endif
