/* The world: states, timeline, the cache of rasterised tiles. [weather] calls may run beside [render] calls of the
 * engines that show it: everything that both touch is under one mutex, held for one tile at a time. */
#ifndef PLUGIN_WORLD_H
#define PLUGIN_WORLD_H

#include <pthread.h>
#include <stdatomic.h>
#include <velum/world.h>

#include "core/tile_cache.h"
#include "core/tile_set.h"
#include "core/timeline.h"
#include "log.h"

typedef struct world_state {
    uint64_t id;
    uint64_t base; /* that it was derived from; 0: none */
    core_state *state;
} world_state;

typedef struct world {
    log_sink sink;
    velum_world *handle;
    uint64_t seed;
    atomic_uint engines;   /* that show it */
    atomic_uint waiting;   /* render calls that want the mutex */
    pthread_mutex_t mutex; /* of all below */
    world_state *states;   /* ascending ids */
    uint32_t state_count, state_capacity;
    uint64_t newest_id; /* ever given out */
    uint64_t revision;
    core_timeline timeline;
    core_tile_cache *cache;
    bool prepared; /* the host calls prepare(): frames leave the work to it */
} world;

/* What holds at a time. */
typedef struct world_weather {
    core_state *state[2]; /* with references; null: no weather. The same where nothing blends */
    uint64_t base[2];     /* ids of what they were derived from; 0: none */
    float blend;          /* share of state[1] */
    uint64_t revision;
} world_weather;

void world_weather_at(world *w, double time_s, world_weather *out);
void world_weather_finish(world_weather *weather);

/* For [render]: the tile with a reference, or null where it is not rasterised and `rasterise` is false. */
core_tile *world_tile(world *w, const core_state *state, uint32_t key, bool rasterise, bool *rasterised);
bool world_is_prepared(world *w);

/* Detail of tiles, as in velum_tile_level, of all eyes. */
#define WORLD_TILE_DETAIL 1.0f

velum_result world_create(const velum_world_desc *desc, velum_world **out);
velum_result world_destroy(world *w);
velum_result world_commit(world *w, const velum_state_desc *desc, uint64_t *out_state);
velum_result world_retire(world *w, uint64_t state);
velum_result world_set_timeline(world *w, const velum_timeline_key *keys, uint32_t count, uint32_t stride);
velum_result world_prepare(world *w, const velum_prepare_info *info);
velum_result world_query_point(world *w, const velum_point_query *query, velum_point_answer *out);
velum_result world_query_line(world *w, const velum_line_query *query, velum_line_answer *out);
velum_result world_get_info(world *w, velum_world_info *out);

#endif
