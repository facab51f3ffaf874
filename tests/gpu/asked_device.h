/* The device that tests are to run on: environment VELUM_TEST_DEVICE. */
#ifndef GPU_ASKED_DEVICE_H
#define GPU_ASKED_DEVICE_H

#include <stdbool.h>
#include <stdint.h>
#include <stdlib.h>

/* Its index; -1: none is asked for. False: it is no index. */
static inline bool asked_device(int32_t *out_index) {
    const char *wanted = getenv("VELUM_TEST_DEVICE");
    char *end = NULL;
    const long index = wanted ? strtol(wanted, &end, 10) : -1;
    *out_index = (int32_t)index;
    return !wanted || (end != wanted && !*end && index >= 0 && index < INT32_MAX);
}

#endif
