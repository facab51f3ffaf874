/* Which tiles an eye can ask for, and the page table that finds them. */
#ifndef VELUM_CORE_TILE_SET_H
#define VELUM_CORE_TILE_SET_H

#include "tile.h"

#define CORE_TILE_SET_MAX_KEYS 65536u

typedef struct core_tile_eye {
    double position_ecef_m[3];
    float detail;      /* as given to velum_tile_level, 1/16..8 */
    double distance_m; /* how far clouds are wanted; 0: to the horizon of the highest cloud */
} core_tile_eye;

/* keys[i] is every tile that velum_tile_level can name within the distance, between the lowest base and the highest top
 * of the states (500 m to spare), also after the eye has moved by 5 % of its distance to the place; data_keys[data[i]]
 * is the tile that holds its fields, in both states. keys ascend; data_keys stand nearest first, each once. */
typedef struct core_tile_set {
    uint32_t key_count;
    uint32_t data_count;
    uint32_t *keys;
    uint32_t *data;
    uint32_t *data_keys;
    double *data_nearest_m; /* least distance to the eye of what a data key stands for */
    double distance_m;      /* that was used */
} core_tile_set;

/* states: one or two, the same order as the page callback's; a null state counts as no weather. The set is
 * bit-identical for the same inputs. VELUM_ERROR_ARGUMENT (eye not finite, detail out of range), VELUM_DEGRADED (more
 * than CORE_TILE_SET_MAX_KEYS: the farthest are left out), VELUM_ERROR_OUT_OF_MEMORY. `set` is finished or zeroed
 * before. */
velum_result core_tile_set_init(core_tile_set *set, const core_tile_eye *eye, const core_state *const *states,
                                uint32_t state_count, core_error *error);
void core_tile_set_finish(core_tile_set *set);

/* The page that holds a slot of a data key in state 0 or 1, VELUM_PAGE_NONE without cloud there; VELUM_SLOT_COUNT +
 * slot asks for its fringe. */
typedef uint32_t (*core_tile_page_fn)(void *context, uint32_t state, uint32_t data_key, uint32_t slot);

/* Entries of the table for so many keys: a power of two, at least twice as many, at least 64. */
uint32_t core_tile_table_entries(uint32_t key_count);
/* Words of a table of so many entries: entries * VELUM_TABLE_WORDS, and the fringes. */
uint32_t core_tile_table_words(const core_tile_set *set, uint32_t state_count, core_tile_page_fn page, void *context,
                               uint32_t entries);
/* Fills as many words. `entries` is a power of two above key_count. */
void core_tile_table_build(const core_tile_set *set, uint32_t state_count, core_tile_page_fn page, void *context,
                           uint32_t *words, uint32_t entries);
/* The words of a key's entry, or null: the lookup that the GPU does. */
const uint32_t *core_tile_table_find(const uint32_t *words, uint32_t entries, uint32_t key);

#endif
