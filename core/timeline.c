#include "timeline.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TIMELINE_KEY_V1_SIZE 32u

velum_result core_timeline_init(core_timeline *timeline, const velum_timeline_key *keys, uint32_t count,
                                uint32_t stride, core_error *error) {
    core_timeline made = {0};
    if (count == 0) {
        *timeline = made;
        return VELUM_OK;
    }
    if (!keys) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "timeline: keys: found null, expected %u keys", count);
    }
    if (count > CORE_TIMELINE_MAX_KEYS) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "timeline: count: found %u, expected at most %u", count,
                         CORE_TIMELINE_MAX_KEYS);
    }
    if (stride == 0) {
        stride = keys->struct_size;
    }
    if (stride < TIMELINE_KEY_V1_SIZE) {
        return core_fail(error, VELUM_ERROR_STRUCT_SIZE, "timeline: stride: found %u, expected at least %u", stride,
                         TIMELINE_KEY_V1_SIZE);
    }
    made.keys = calloc(count, sizeof *made.keys);
    if (!made.keys) {
        return core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "timeline: %u keys: out of memory", count);
    }
    made.count = count;
    velum_result result = VELUM_ERROR_ARGUMENT;
    for (uint32_t i = 0; i < count; i++) {
        velum_timeline_key *key = &made.keys[i];
        const char *from = (const char *)keys + (size_t)i * stride;
        if (!core_copy_struct(key, sizeof *key, from, TIMELINE_KEY_V1_SIZE)) {
            result = core_fail(error, VELUM_ERROR_STRUCT_SIZE, "timeline: key %u, struct_size: below %u", i,
                               TIMELINE_KEY_V1_SIZE);
            goto error;
        }
        if (key->reserved != 0) {
            result = core_fail(error, VELUM_ERROR_FLAGS, "timeline: key %u, reserved: found %u, expected 0", i,
                               key->reserved);
            goto error;
        }
        if (!isfinite(key->time_s) || (i > 0 && !(key->time_s > made.keys[i - 1].time_s))) {
            core_fail(error, result, "timeline: key %u, time_s: found %g, expected a finite time after the key before",
                      i, key->time_s);
            goto error;
        }
        if (!isfinite(key->transition_s) || key->transition_s < 0.0 ||
            (i > 0 && key->transition_s > key->time_s - made.keys[i - 1].time_s)) {
            core_fail(error, result,
                      "timeline: key %u, transition_s: found %g, expected 0 to the distance to the key before", i,
                      key->transition_s);
            goto error;
        }
        if (key->state == 0) {
            core_fail(error, result, "timeline: key %u, state: found 0, expected the id of a state", i);
            goto error;
        }
    }
    *timeline = made;
    return VELUM_OK;
error:
    core_timeline_finish(&made);
    return result;
}

void core_timeline_finish(core_timeline *timeline) {
    if (timeline) {
        free(timeline->keys);
        *timeline = (core_timeline){0};
    }
}

core_timeline_place core_timeline_at(const core_timeline *timeline, double time_s) {
    core_timeline_place place = {0};
    if (timeline->count == 0) {
        return place;
    }
    if (!isfinite(time_s)) {
        time_s = 0.0;
    }
    /* The first key after time_s, by bisection. */
    uint32_t low = 0;
    uint32_t high = timeline->count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (timeline->keys[middle].time_s <= time_s) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    place.state_a = place.state_b = timeline->keys[low > 0 ? low - 1 : 0].state;
    if (low > 0 && low < timeline->count) {
        const velum_timeline_key *next = &timeline->keys[low];
        double begin_s = next->time_s - next->transition_s;
        if (time_s > begin_s && next->state != place.state_a) {
            double t = fmin((time_s - begin_s) / next->transition_s, 1.0);
            place.state_b = next->state;
            place.blend = (float)(t * t * (3.0 - 2.0 * t));
        }
    }
    return place;
}

bool core_timeline_names(const core_timeline *timeline, uint64_t state) {
    for (uint32_t i = 0; i < timeline->count; i++) {
        if (timeline->keys[i].state == state) {
            return true;
        }
    }
    return false;
}
