#include "tile_cache.h"

#include <stdlib.h>

#define BUCKETS 4096u

typedef struct entry {
    core_tile *tile;
    struct entry *next; /* in its bucket */
    struct entry *newer, *older;
} entry;

struct core_tile_cache {
    entry *bucket[BUCKETS];
    entry *newest, *oldest;
    uint64_t byte_limit;
    core_tile_cache_info info;
};

static uint32_t bucket_of(uint64_t state, uint32_t key) {
    uint64_t h = (state * 0x9e3779b97f4a7c15u) ^ key;
    h *= 0xbf58476d1ce4e5b9u;
    return (uint32_t)(h >> 40) & (BUCKETS - 1u);
}

core_tile_cache *core_tile_cache_create(uint64_t byte_limit) {
    core_tile_cache *cache = calloc(1, sizeof *cache);
    if (cache) {
        cache->byte_limit = byte_limit ? byte_limit : CORE_TILE_CACHE_BYTES;
    }
    return cache;
}

static void unlink_age(core_tile_cache *cache, entry *e) {
    *(e->newer ? &e->newer->older : &cache->newest) = e->older;
    *(e->older ? &e->older->newer : &cache->oldest) = e->newer;
    e->newer = e->older = NULL;
}

static void link_newest(core_tile_cache *cache, entry *e) {
    e->older = cache->newest;
    e->newer = NULL;
    *(cache->newest ? &cache->newest->newer : &cache->oldest) = e;
    cache->newest = e;
}

static void drop(core_tile_cache *cache, entry *e) {
    entry **at = &cache->bucket[bucket_of(e->tile->state, e->tile->key)];
    while (*at != e) {
        at = &(*at)->next;
    }
    *at = e->next;
    unlink_age(cache, e);
    cache->info.bytes -= e->tile->bytes;
    cache->info.resident--;
    core_tile_unref(e->tile);
    free(e);
}

void core_tile_cache_destroy(core_tile_cache *cache) {
    if (cache) {
        while (cache->newest) {
            drop(cache, cache->newest);
        }
        free(cache);
    }
}

core_tile *core_tile_cache_find(core_tile_cache *cache, uint64_t state, uint32_t key) {
    for (entry *e = cache->bucket[bucket_of(state, key)]; e; e = e->next) {
        if (e->tile->state == state && e->tile->key == key) {
            unlink_age(cache, e);
            link_newest(cache, e);
            return core_tile_ref(e->tile);
        }
    }
    return NULL;
}

core_tile *core_tile_cache_get(core_tile_cache *cache, const core_state *state, uint32_t key) {
    core_tile *tile = core_tile_cache_find(cache, core_state_id(state), key);
    if (tile) {
        return tile;
    }
    tile = core_tile_create(state, key);
    entry *e = calloc(1, sizeof *e);
    if (!tile || !e) {
        core_tile_unref(tile);
        free(e);
        return NULL;
    }
    e->tile = tile;
    entry **bucket = &cache->bucket[bucket_of(tile->state, key)];
    e->next = *bucket;
    *bucket = e;
    link_newest(cache, e);
    cache->info.rasterised++;
    cache->info.resident++;
    cache->info.bytes += tile->bytes;
    while (cache->info.bytes > cache->byte_limit && cache->oldest != e) {
        drop(cache, cache->oldest);
    }
    return core_tile_ref(tile);
}

void core_tile_cache_forget(core_tile_cache *cache, uint64_t state) {
    entry *e = cache->newest;
    while (e) {
        entry *older = e->older;
        if (e->tile->state == state) {
            drop(cache, e);
        }
        e = older;
    }
}

core_tile_cache_info core_tile_cache_get_info(const core_tile_cache *cache) {
    return cache->info;
}
