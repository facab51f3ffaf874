/* States over time. */
#ifndef VELUM_CORE_TIMELINE_H
#define VELUM_CORE_TIMELINE_H

#include <velum/weather.h>

#include "result.h"

#define CORE_TIMELINE_MAX_KEYS 65536u

typedef struct core_timeline {
    uint32_t count;
    velum_timeline_key *keys;
} core_timeline;

/* Two states and the share of the second: 0 all A, 1 all B. Outside transitions A = B and blend 0. */
typedef struct core_timeline_place {
    uint64_t state_a, state_b; /* 0: no timeline */
    float blend;
} core_timeline_place;

/* Copies and checks; that the states exist is the caller's to check. count 0 makes an empty one. `timeline` is zeroed
 * or finished before; unchanged after an error. */
velum_result core_timeline_init(core_timeline *timeline, const velum_timeline_key *keys, uint32_t count,
                                uint32_t stride, core_error *error);
void core_timeline_finish(core_timeline *timeline);

/* A pure function of the time: smoothstep over each transition. A time that is not finite counts as 0. */
core_timeline_place core_timeline_at(const core_timeline *timeline, double time_s);
bool core_timeline_names(const core_timeline *timeline, uint64_t state);

#endif
