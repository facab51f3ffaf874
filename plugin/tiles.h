/* What an eye (or a shadow map) needs of the weather: its tiles, their pages, its page table. */
#ifndef PLUGIN_TILES_H
#define PLUGIN_TILES_H

#include "core/tile_set.h"
#include "pages.h"
#include "world.h"

/* Pages of a tile: of each slot's cloud, then of each one's fringe. */
enum { TILE_PAGES = 2 * VELUM_SLOT_COUNT };

enum { TABLE_CHUNK_BYTES = 64 * VELUM_TABLE_WORDS * 4, TABLE_CHUNKS = 1024 };

/* The buffer of all page tables, in chunks of 64 entries. */
typedef struct table_space {
    gpu_buffer buffer;
    uint8_t taken[TABLE_CHUNKS];
} table_space;

bool table_space_init(table_space *space, gpu *g);
void table_space_finish(table_space *space, gpu *g);

typedef struct tiles {
    bool has_set;
    core_tile_set set;
    core_tile_eye wanted;
    uint64_t states[2];
    uint32_t *resolved; /* per data key: the key that stands for it */
    uint32_t *page;     /* per data key, state, slot; fringes after the slots */
    uint64_t *contents;
    velum_result standing; /* VELUM_OK, VELUM_INCOMPLETE or VELUM_DEGRADED */
    uint32_t *words;       /* the table as the device has it */
    size_t words_bytes;
    uint32_t entries;
    uint64_t built; /* tables so far */
    uint32_t first_chunk, chunk_count;
    uint32_t mask;                                           /* slots with cloud */
    uint32_t closing;                                        /* of them: uniform, or all but overcast somewhere */
    uint32_t fringes;                                        /* VELUM_PART_* + slot */
    float base_m[VELUM_SLOT_COUNT], top_m[VELUM_SLOT_COUNT]; /* HAE */
    bool uneven; /* what there is, how high it lies, or what makes its profile is not much the same in all tiles */
    core_look look[2][VELUM_SLOT_COUNT]; /* else that, of each state */
    velum_span_m hem_m[VELUM_SLOT_COUNT], fall_m[VELUM_SLOT_COUNT];
    float most_scud_1_m[VELUM_SLOT_COUNT], most_band_1_m[VELUM_SLOT_COUNT], most_fall_1_m[VELUM_SLOT_COUNT];
} tiles;

/* Where updates find what they need. */
typedef struct tiles_context {
    world *w;
    const world_weather *weather;
    pages *p;
    stage *s;
    table_space *space;
    const log_sink *sink;
    uint32_t *budget;     /* tiles that may still be rasterised in this frame */
    VkBufferCopy *copies; /* of tables, appended */
    uint32_t copy_count, copy_capacity;
} tiles_context;

/* Brings pages and table up to date for a place. VELUM_INCOMPLETE: some tile is not there, an ancestor stands in.
 * VELUM_DEGRADED: there is no room for all. */
velum_result tiles_update(tiles *t, tiles_context *context, const double position_ecef_m[3], double distance_m);
void tiles_finish(tiles *t, table_space *space);

#endif
