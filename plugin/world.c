#include "world.h"

#include <sched.h>
#include <stdlib.h>
#include <string.h>

#include "arguments.h"
#include "handle.h"

velum_result world_create(const velum_world_desc *desc, velum_world **out) {
    log_sink sink = {0};
    checker check = {&sink, "world", "create", VELUM_OK};
    velum_world_desc d;
    if (!check_pointer(&check, "out", out) || !check_in(&check, "desc", &d, sizeof d, desc, V1_WORLD_DESC)) {
        return check.result;
    }
    sink = (log_sink){d.log, d.log_context};
    if (!check_flags(&check, "desc.flags", d.flags, 0)) {
        return check.result;
    }
    world *w = calloc(1, sizeof *w);
    if (!w || pthread_mutex_init(&w->mutex, NULL) != 0) {
        free(w);
        return log_fail(&sink, VELUM_ERROR_OUT_OF_MEMORY, "world", "create: no memory");
    }
    w->sink = sink;
    w->seed = d.seed;
    w->revision = 1;
    w->cache = core_tile_cache_create(0);
    w->handle = w->cache ? handle_create(HANDLE_WORLD, w, NULL, &sink) : NULL;
    if (!w->handle) {
        core_tile_cache_destroy(w->cache);
        pthread_mutex_destroy(&w->mutex);
        free(w);
        return log_fail(&sink, VELUM_ERROR_OUT_OF_MEMORY, "world", "create: no memory, or too many objects");
    }
    *out = w->handle;
    return VELUM_OK;
}

velum_result world_destroy(world *w) {
    if (atomic_load(&w->engines) != 0) {
        return log_fail(&w->sink, VELUM_ERROR_STATE, "world", "destroy: %u engines use it", atomic_load(&w->engines));
    }
    handle_destroy(w->handle);
    core_tile_cache_destroy(w->cache);
    core_timeline_finish(&w->timeline);
    for (uint32_t i = 0; i < w->state_count; i++) {
        core_state_unref(w->states[i].state);
    }
    free(w->states);
    pthread_mutex_destroy(&w->mutex);
    free(w);
    return VELUM_OK;
}

/* With the mutex held. */
static const world_state *find_entry(const world *w, uint64_t id) {
    for (uint32_t i = w->state_count; i-- > 0;) {
        if (w->states[i].id == id) {
            return &w->states[i];
        }
    }
    return NULL;
}

static core_state *find_state(const world *w, uint64_t id) {
    const world_state *entry = find_entry(w, id);
    return entry ? entry->state : NULL;
}

static bool reserve_state(world *w) {
    if (w->state_count < w->state_capacity) {
        return true;
    }
    uint32_t capacity = w->state_capacity ? 2 * w->state_capacity : 16;
    world_state *states = realloc(w->states, capacity * sizeof *states);
    if (states) {
        w->states = states;
        w->state_capacity = capacity;
    }
    return states != NULL;
}

velum_result world_commit(world *w, const velum_state_desc *desc, uint64_t *out_state) {
    checker check = {&w->sink, "world", "commit", VELUM_OK};
    velum_state_desc d;
    if (!check_pointer(&check, "out_state", out_state) ||
        !check_in(&check, "state", &d, sizeof d, desc, V1_STATE_DESC) ||
        !check_flags(&check, "state.flags", d.flags, 0)) {
        return check.result;
    }
    pthread_mutex_lock(&w->mutex);
    core_state *base = d.base_state ? core_state_ref(find_state(w, d.base_state)) : NULL;
    uint64_t id = w->newest_id + 1;
    bool room = reserve_state(w);
    pthread_mutex_unlock(&w->mutex);
    if (d.base_state && !base) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "state.base_state: found %llu, which is no live state",
                   (unsigned long long)d.base_state);
        return check.result;
    }
    core_error error = {0};
    core_state *state = NULL;
    velum_result result = room ? core_state_create(&d, base, id, &state, &error)
                               : core_fail(&error, VELUM_ERROR_OUT_OF_MEMORY, "no memory");
    core_state_unref(base);
    if (result < 0) {
        check_fail(&check, result, "%s", error.text);
        return result;
    }
    if (core_state_merged_layers(state) > 0) {
        log_write(&w->sink, VELUM_LOG_INFO, "world", "commit: %u layers share a slot with another of their cell",
                  core_state_merged_layers(state));
    }
    pthread_mutex_lock(&w->mutex);
    w->states[w->state_count++] = (world_state){id, d.base_state, state};
    w->newest_id = id;
    w->revision++;
    pthread_mutex_unlock(&w->mutex);
    *out_state = id;
    return result;
}

velum_result world_retire(world *w, uint64_t state) {
    velum_result result = VELUM_OK;
    core_state *retired = NULL;
    pthread_mutex_lock(&w->mutex);
    uint32_t i = 0;
    while (i < w->state_count && w->states[i].id != state) {
        i++;
    }
    if (i == w->state_count) {
        result = VELUM_ERROR_ARGUMENT;
    } else if (core_timeline_names(&w->timeline, state)) {
        result = VELUM_ERROR_STATE;
    } else {
        retired = w->states[i].state;
        memmove(&w->states[i], &w->states[i + 1], (w->state_count - i - 1) * sizeof *w->states);
        w->state_count--;
        w->revision++;
        core_tile_cache_forget(w->cache, state);
    }
    pthread_mutex_unlock(&w->mutex);
    core_state_unref(retired);
    if (result < 0) {
        log_fail(&w->sink, result, "world", "retire: state %llu %s", (unsigned long long)state,
                 result == VELUM_ERROR_STATE ? "is named by the timeline" : "is no live state");
    }
    return result;
}

velum_result world_set_timeline(world *w, const velum_timeline_key *keys, uint32_t count, uint32_t stride) {
    checker check = {&w->sink, "world", "set_timeline", VELUM_OK};
    if (!check_array(&check, "keys", keys, count, &stride, V1_TIMELINE_KEY)) {
        return check.result;
    }
    core_timeline timeline = {0};
    core_error error = {0};
    velum_result result = core_timeline_init(&timeline, keys, count, stride, &error);
    if (result < 0) {
        check_fail(&check, result, "%s", error.text);
        return result;
    }
    uint64_t unknown = 0;
    uint32_t unknown_key = 0;
    pthread_mutex_lock(&w->mutex);
    for (uint32_t i = 0; i < timeline.count && !unknown; i++) {
        if (!find_state(w, timeline.keys[i].state)) {
            unknown = timeline.keys[i].state ? timeline.keys[i].state : UINT64_MAX;
            unknown_key = i;
        }
    }
    core_timeline old = timeline;
    if (!unknown) {
        old = w->timeline;
        w->timeline = timeline;
        w->revision++;
    }
    pthread_mutex_unlock(&w->mutex);
    core_timeline_finish(&old);
    if (unknown) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "keys[%u].state: found %llu, which is no live state", unknown_key,
                   (unsigned long long)(unknown == UINT64_MAX ? 0 : unknown));
    }
    return check.result;
}

void world_weather_at(world *w, double time_s, world_weather *out) {
    *out = (world_weather){0};
    pthread_mutex_lock(&w->mutex);
    core_timeline_place place = core_timeline_at(&w->timeline, time_s);
    uint64_t ids[2] = {place.state_a, place.state_b};
    if (w->timeline.count == 0 && w->state_count > 0) {
        ids[0] = ids[1] = w->states[w->state_count - 1].id;
        place.blend = 0.0f;
    }
    if (place.blend <= 0.0f) {
        ids[1] = ids[0];
    } else if (place.blend >= 1.0f) {
        ids[0] = ids[1];
    }
    for (uint32_t s = 0; s < 2; s++) {
        const world_state *entry = find_entry(w, ids[s]);
        out->state[s] = entry ? core_state_ref(entry->state) : NULL;
        out->base[s] = entry ? entry->base : 0;
    }
    out->blend = out->state[0] != out->state[1] ? place.blend : 0.0f;
    out->revision = w->revision;
    pthread_mutex_unlock(&w->mutex);
}

void world_weather_finish(world_weather *weather) {
    core_state_unref(weather->state[0]);
    core_state_unref(weather->state[1]);
    *weather = (world_weather){0};
}

core_tile *world_tile(world *w, const core_state *state, uint32_t key, bool rasterise, bool *rasterised) {
    atomic_fetch_add(&w->waiting, 1);
    pthread_mutex_lock(&w->mutex);
    atomic_fetch_sub(&w->waiting, 1);
    core_tile *tile = core_tile_cache_find(w->cache, core_state_id(state), key);
    *rasterised = !tile && rasterise;
    if (*rasterised) {
        tile = core_tile_cache_get(w->cache, state, key);
    }
    pthread_mutex_unlock(&w->mutex);
    return tile;
}

bool world_is_prepared(world *w) {
    pthread_mutex_lock(&w->mutex);
    bool prepared = w->prepared;
    pthread_mutex_unlock(&w->mutex);
    return prepared;
}

velum_result world_get_info(world *w, velum_world_info *out) {
    checker check = {&w->sink, "world", "get_info", VELUM_OK};
    if (!check_out(&check, "out", out, V1_WORLD_INFO)) {
        return check.result;
    }
    velum_world_info info = {0};
    pthread_mutex_lock(&w->mutex);
    core_tile_cache_info cache = core_tile_cache_get_info(w->cache);
    info.state_count = w->state_count;
    info.revision = w->revision;
    info.tiles_rasterised = cache.rasterised;
    info.tiles_resident = cache.resident;
    info.bytes = cache.bytes;
    for (uint32_t i = 0; i < w->state_count; i++) {
        info.cells += core_state_cell_count(w->states[i].state);
        info.bytes += core_state_bytes(w->states[i].state);
    }
    pthread_mutex_unlock(&w->mutex);
    write_struct(out, &info, sizeof info);
    return VELUM_OK;
}

/* Work that prepare() may still do. */
typedef struct prepare_budget {
    uint32_t left;
    bool limited;
} prepare_budget;

/* Rasterises what is missing of one data key. Lets frames that wait go first. */
static bool prepare_tile(world *w, const core_state *state, uint32_t key, prepare_budget *budget, bool *complete) {
    while (atomic_load(&w->waiting) > 0) {
        sched_yield();
    }
    pthread_mutex_lock(&w->mutex);
    core_tile *tile = core_tile_cache_find(w->cache, core_state_id(state), key);
    bool ok = true;
    if (!tile) {
        if (budget->limited && budget->left == 0) {
            *complete = false;
        } else {
            tile = core_tile_cache_get(w->cache, state, key);
            ok = tile != NULL;
            budget->left--;
        }
    }
    pthread_mutex_unlock(&w->mutex);
    core_tile_unref(tile);
    return ok;
}

static velum_result prepare_eye(world *w, const velum_prepare_eye *eye, prepare_budget *budget) {
    world_weather weather;
    world_weather_at(w, eye->time_s, &weather);
    core_tile_eye place = {.detail = WORLD_TILE_DETAIL, .distance_m = eye->distance_m};
    memcpy(place.position_ecef_m, eye->position_ecef_m, sizeof place.position_ecef_m);
    const core_state *states[2] = {weather.state[0], weather.state[1]};
    uint32_t state_count = weather.state[0] == weather.state[1] ? 1 : 2;
    core_tile_set set = {0};
    core_error error = {0};
    bool complete = true;
    velum_result result = VELUM_OK;
    if (weather.state[0] || weather.state[1]) {
        result = core_tile_set_init(&set, &place, states, state_count, &error);
    }
    if (result < 0) {
        log_fail(&w->sink, result, "world", "prepare: %s", error.text);
        goto done;
    }
    for (uint32_t i = 0; i < set.data_count && complete; i++) {
        for (uint32_t s = 0; s < state_count && complete; s++) {
            if (states[s] && !prepare_tile(w, states[s], set.data_keys[i], budget, &complete)) {
                result = log_fail(&w->sink, VELUM_ERROR_OUT_OF_MEMORY, "world", "prepare: no memory for a tile");
                goto done;
            }
        }
    }
    result = complete ? VELUM_OK : VELUM_INCOMPLETE;
done:
    core_tile_set_finish(&set);
    world_weather_finish(&weather);
    return result;
}

velum_result world_prepare(world *w, const velum_prepare_info *info) {
    checker check = {&w->sink, "world", "prepare", VELUM_OK};
    velum_prepare_info in;
    if (!check_in(&check, "info", &in, sizeof in, info, V1_PREPARE_INFO) ||
        !check_flags(&check, "info.flags", in.flags, 0) || !check_zero(&check, "info.reserved", in.reserved) ||
        !check_array(&check, "info.eyes", in.eyes, in.eye_count, &in.eye_stride, V1_PREPARE_EYE)) {
        return check.result;
    }
    for (uint32_t pass = 0; pass < 2; pass++) {
        prepare_budget budget = {in.max_tiles, in.max_tiles > 0};
        velum_result result = VELUM_OK;
        for (uint32_t i = 0; i < in.eye_count; i++) {
            velum_prepare_eye eye;
            if (!check_in(&check, "eye", &eye, sizeof eye, (const char *)in.eyes + (size_t)i * in.eye_stride,
                          V1_PREPARE_EYE) ||
                !check_flags(&check, "eye.flags", eye.flags, 0) ||
                !check_position(&check, "eye.position_ecef_m", eye.position_ecef_m) ||
                !check_range(&check, "eye.time_s", eye.time_s, -1e15, 1e15) ||
                !check_range(&check, "eye.pixel_rad", eye.pixel_rad, 0.0, 1.0) ||
                !check_range(&check, "eye.distance_m", eye.distance_m, 0.0, 1e7)) {
                return check.result;
            }
            if (pass == 1) {
                velum_result one = prepare_eye(w, &eye, &budget);
                if (one < 0) {
                    return one;
                }
                result = one != VELUM_OK ? one : result;
            }
        }
        if (pass == 1) {
            pthread_mutex_lock(&w->mutex);
            w->prepared = true;
            pthread_mutex_unlock(&w->mutex);
            return result;
        }
    }
    return VELUM_OK;
}
