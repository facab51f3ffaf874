#include "arguments.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "core/result.h"

bool check_fail(checker *check, velum_result result, const char *format, ...) {
    char text[512];
    va_list list;
    va_start(list, format);
    vsnprintf(text, sizeof text, format, list);
    va_end(list);
    check->result = result;
    log_fail(check->sink, result, check->object, "%s: %s", check->call, text);
    return false;
}

bool check_pointer(checker *check, const char *field, const void *pointer) {
    return pointer || check_fail(check, VELUM_ERROR_ARGUMENT, "%s: found null", field);
}

static uint32_t size_of(const void *in) {
    uint32_t size;
    memcpy(&size, in, sizeof size);
    return size;
}

bool check_in(checker *check, const char *field, void *out, size_t own, const void *in, size_t frozen) {
    if (!check_pointer(check, field, in)) {
        return false;
    }
    return core_copy_struct(out, own, in, frozen) ||
           check_fail(check, VELUM_ERROR_STRUCT_SIZE, "%s.struct_size: found %u, expected at least %zu", field,
                      size_of(in), frozen);
}

bool check_out(checker *check, const char *field, const void *out, size_t frozen) {
    if (!check_pointer(check, field, out)) {
        return false;
    }
    uint32_t size = size_of(out);
    return size >= frozen || check_fail(check, VELUM_ERROR_STRUCT_SIZE,
                                        "%s.struct_size: found %u, expected at least %zu", field, size, frozen);
}

bool check_array(checker *check, const char *field, const void *array, uint32_t count, uint32_t *stride,
                 size_t frozen) {
    if (count == 0) {
        return true;
    }
    if (!check_pointer(check, field, array)) {
        return false;
    }
    if (*stride == 0) {
        *stride = size_of(array);
    }
    return *stride >= frozen || check_fail(check, VELUM_ERROR_STRUCT_SIZE,
                                           "%s: stride: found %u, expected at least %zu", field, *stride, frozen);
}

bool check_flags(checker *check, const char *field, uint32_t flags, uint32_t known) {
    return (flags & ~known) == 0 ||
           check_fail(check, VELUM_ERROR_FLAGS, "%s: found unknown bits 0x%x", field, flags & ~known);
}

bool check_zero(checker *check, const char *field, uint64_t value) {
    return value == 0 || check_fail(check, VELUM_ERROR_FLAGS, "%s: found %llu, expected 0 (reserved)", field,
                                    (unsigned long long)value);
}

bool check_range(checker *check, const char *field, double value, double low, double high) {
    return (value >= low && value <= high) ||
           check_fail(check, VELUM_ERROR_ARGUMENT, "%s: found %g, expected %g..%g", field, value, low, high);
}

bool check_count(checker *check, const char *field, uint64_t value, uint64_t low, uint64_t high) {
    return (value >= low && value <= high) ||
           check_fail(check, VELUM_ERROR_ARGUMENT, "%s: found %llu, expected %llu..%llu", field,
                      (unsigned long long)value, (unsigned long long)low, (unsigned long long)high);
}

bool check_position(checker *check, const char *field, const double ecef_m[3]) {
    double radius_m = sqrt(ecef_m[0] * ecef_m[0] + ecef_m[1] * ecef_m[1] + ecef_m[2] * ecef_m[2]);
    return (radius_m >= 6.2e6 && radius_m <= 6.0e7) ||
           check_fail(check, VELUM_ERROR_ARGUMENT,
                      "%s: found (%g, %g, %g), %g m from the earth's centre, expected 6.2e6..6e7", field, ecef_m[0],
                      ecef_m[1], ecef_m[2], radius_m);
}

bool check_unit(checker *check, const char *field, const double v[3]) {
    double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return fabs(length - 1.0) <= 1e-3 ||
           check_fail(check, VELUM_ERROR_ARGUMENT, "%s: found (%g, %g, %g) of length %g, expected a unit vector", field,
                      v[0], v[1], v[2], length);
}

void write_struct(void *out, const void *own_struct, size_t own) {
    uint32_t size = size_of(out);
    size_t bytes = size < own ? size : own;
    memcpy((char *)out + sizeof size, (const char *)own_struct + sizeof size, bytes - sizeof size);
}
