/* The tiles of a world that were rasterised, least recently used out. Calls must not overlap. */
#ifndef VELUM_CORE_TILE_CACHE_H
#define VELUM_CORE_TILE_CACHE_H

#include "tile.h"

#define CORE_TILE_CACHE_BYTES (256ull << 20)

typedef struct core_tile_cache core_tile_cache;

/* byte_limit 0: CORE_TILE_CACHE_BYTES. Null: out of memory. */
core_tile_cache *core_tile_cache_create(uint64_t byte_limit);
void core_tile_cache_destroy(core_tile_cache *cache); /* null is legal; tiles that others hold live on */

/* The tile of (state, key) with a reference for the caller, or null if it was not rasterised yet. */
core_tile *core_tile_cache_find(core_tile_cache *cache, uint64_t state, uint32_t key);
/* The same, rasterised now if need be. Null: out of memory. */
core_tile *core_tile_cache_get(core_tile_cache *cache, const core_state *state, uint32_t key);
/* Drops all tiles of a state. */
void core_tile_cache_forget(core_tile_cache *cache, uint64_t state);

typedef struct core_tile_cache_info {
    uint64_t rasterised; /* since creation */
    uint64_t bytes;
    uint32_t resident;
} core_tile_cache_info;
core_tile_cache_info core_tile_cache_get_info(const core_tile_cache *cache);

#endif
