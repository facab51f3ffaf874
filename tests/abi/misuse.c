#include "misuse.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static void complain(misuse *m, const char *field, const char *what, velum_result result) {
    m->wrong++;
    fprintf(stderr, "%s: %s: %s: %s; log: %s\n", m->call_name, field ? field : "-", what, velum_result_name(result),
            m->host->log.message);
}

void misuse_expect(misuse *m, velum_result expected, const char *field) {
    uint8_t before[256] = {0}, after[256] = {0};
    if (m->snapshot) {
        m->snapshot(m->context, before);
    }
    test_log_clear(&m->host->log);
    velum_result result = m->call(m->context);
    m->tried++;
    if (result != expected) {
        char text[64];
        snprintf(text, sizeof text, "expected %s, got", velum_result_name(expected));
        complain(m, field, text, result);
    } else if (field && m->host->log.failures == 0) {
        complain(m, field, "nothing was logged before", result);
    } else if (field && !strstr(m->host->log.message, field)) {
        complain(m, field, "the log does not name it", result);
    }
    if (m->snapshot) {
        m->snapshot(m->context, after);
        if (memcmp(before, after, sizeof before) != 0) {
            complain(m, field, "the state has changed", result);
        }
    }
}

void misuse_expect_ok(misuse *m, const char *what) {
    test_log_clear(&m->host->log);
    velum_result result = m->call(m->context);
    m->tried++;
    if (result < 0) {
        complain(m, what, "expected success, got", result);
    }
}

static size_t poke(void *at, field_type type, double value) {
    switch (type) {
    case FIELD_F32: {
        float v = (float)value;
        memcpy(at, &v, sizeof v);
        return sizeof v;
    }
    case FIELD_F64: memcpy(at, &value, sizeof value); return sizeof value;
    case FIELD_I32: {
        int32_t v = (int32_t)value;
        memcpy(at, &v, sizeof v);
        return sizeof v;
    }
    case FIELD_U32: {
        uint32_t v = (uint32_t)value;
        memcpy(at, &v, sizeof v);
        return sizeof v;
    }
    default: {
        uint64_t v = (uint64_t)value;
        memcpy(at, &v, sizeof v);
        return sizeof v;
    }
    }
}

/* The nearest value of the type beyond a bound. */
static double beyond(field_type type, double bound, double sign) {
    if (type == FIELD_F32) {
        float b = (float)bound;
        float next = nextafterf(b, (float)sign * FLT_MAX);
        return (double)next == bound ? (double)nextafterf(next, (float)sign * FLT_MAX) : (double)next;
    }
    return type == FIELD_F64 ? nextafter(bound, sign * DBL_MAX) : bound + sign;
}

static bool fits(field_type type, double value) {
    switch (type) {
    case FIELD_I32: return value >= -2147483648.0 && value <= 2147483647.0;
    case FIELD_U32: return value >= 0.0 && value <= 4294967295.0;
    case FIELD_U64: return value >= 0.0 && value <= 9007199254740992.0;
    default: return true;
    }
}

void misuse_rules(misuse *m, void *object, const field_rule *rules, size_t count, bool accept_bounds) {
    for (size_t i = 0; i < count; i++) {
        const field_rule *rule = &rules[i];
        char *at = (char *)object + rule->offset;
        uint8_t kept[8];
        memcpy(kept, at, rule->type == FIELD_F64 || rule->type == FIELD_U64 ? 8 : 4);
        velum_result expected = rule->expected != VELUM_OK ? rule->expected : VELUM_ERROR_ARGUMENT;
        double bad[5];
        size_t bad_count = 0;
        size_t size = 4;
        if (rule->type == FIELD_F32 || rule->type == FIELD_F64) {
            bad[bad_count++] = (double)NAN;
            bad[bad_count++] = (double)INFINITY;
            bad[bad_count++] = -(double)INFINITY;
        }
        if (isfinite(rule->low) && fits(rule->type, rule->low - 1.0)) {
            bad[bad_count++] = beyond(rule->type, rule->low, -1.0);
        }
        if (isfinite(rule->high) && fits(rule->type, rule->high + 1.0)) {
            bad[bad_count++] = beyond(rule->type, rule->high, 1.0);
        }
        for (size_t b = 0; b < bad_count; b++) {
            size = poke(at, rule->type, bad[b]);
            uint32_t wrong = m->wrong;
            misuse_expect(m, expected, rule->name);
            if (m->wrong != wrong) {
                fprintf(stderr, "    with %s = %.9g\n", rule->name, bad[b]);
            }
        }
        if (accept_bounds && isfinite(rule->low)) {
            size = poke(at, rule->type, rule->low);
            misuse_expect_ok(m, rule->name);
        }
        if (accept_bounds && isfinite(rule->high)) {
            size = poke(at, rule->type, rule->high);
            misuse_expect_ok(m, rule->name);
        }
        memcpy(at, kept, size);
    }
}

void misuse_struct(misuse *m, void *object, uint32_t size, bool has_flags, uint32_t known_flags) {
    uint32_t kept;
    memcpy(&kept, object, sizeof kept);
    const uint32_t sizes[] = {0, 1, 4, 7, size / 2, size - 8, size - 1};
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        memcpy(object, &sizes[i], sizeof sizes[i]);
        uint32_t wrong = m->wrong;
        misuse_expect(m, VELUM_ERROR_STRUCT_SIZE, m->silent_size ? NULL : "");
        if (m->wrong != wrong) {
            fprintf(stderr, "    with struct_size = %u\n", sizes[i]);
        }
    }
    memcpy(object, &kept, sizeof kept);
    if (!has_flags) {
        return;
    }
    char *flags = (char *)object + 4;
    memcpy(&kept, flags, sizeof kept);
    for (uint32_t bit = 0; bit < 32; bit++) {
        if (known_flags >> bit & 1u) {
            continue;
        }
        uint32_t value = kept | 1u << bit;
        memcpy(flags, &value, sizeof value);
        misuse_expect(m, VELUM_ERROR_FLAGS, "flags");
    }
    memcpy(flags, &kept, sizeof kept);
}
