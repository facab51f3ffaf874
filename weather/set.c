#include "set.h"

#include <stdalign.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 256 * 1024 };

/* Far above any set; below what an allocator or a sanitizer takes for a mistake. */
static const size_t max_alloc_bytes = (size_t)1 << 36;

typedef struct block {
    struct block *before;
    size_t capacity;
    size_t used;
    alignas(max_align_t) unsigned char bytes[];
} block;

struct velum_weather_set {
    velum_cell *cells;
    uint32_t cell_count;
    uint32_t cell_capacity;
    uint64_t next_id;
    int has_grid;
    velum_grid grid;
    block *newest;
};

velum_weather_set *velum_weather_set_create(void) {
    velum_weather_set *set = calloc(1, sizeof(*set));
    if (set) {
        set->next_id = 1;
    }
    return set;
}

static void free_blocks(velum_weather_set *set, const block *until) {
    while (set->newest != until) {
        block *before = set->newest->before;
        free(set->newest);
        set->newest = before;
    }
}

void velum_weather_set_destroy(velum_weather_set *set) {
    if (!set) {
        return;
    }
    free_blocks(set, NULL);
    free(set->cells);
    free(set);
}

void velum_weather_set_state(const velum_weather_set *set, velum_state_desc *out) {
    if (!out) {
        return;
    }
    memset(out, 0, sizeof(*out));
    out->struct_size = sizeof(*out);
    out->cell_stride = sizeof(velum_cell);
    if (set) {
        out->grid = set->has_grid ? &set->grid : NULL;
        out->cells = set->cells;
        out->cell_count = set->cell_count;
    }
}

velum_cell *weather_set_add_cell(velum_weather_set *set) {
    if (set->cell_count == set->cell_capacity) {
        const uint32_t capacity = set->cell_capacity ? set->cell_capacity * 2 : 64;
        if (capacity <= set->cell_capacity) {
            return NULL;
        }
        velum_cell *cells = realloc(set->cells, capacity * sizeof(*cells));
        if (!cells) {
            return NULL;
        }
        set->cells = cells;
        set->cell_capacity = capacity;
    }
    velum_cell *cell = &set->cells[set->cell_count++];
    memset(cell, 0, sizeof(*cell));
    cell->struct_size = sizeof(*cell);
    cell->layer_stride = sizeof(velum_layer);
    cell->id = set->next_id++;
    return cell;
}

uint32_t weather_set_cell_count(const velum_weather_set *set) {
    return set->cell_count;
}

velum_cell *weather_set_cell(velum_weather_set *set, uint32_t index) {
    return index < set->cell_count ? &set->cells[index] : NULL;
}

uint64_t weather_set_next_id(velum_weather_set *set) {
    return set->next_id++;
}

void *weather_set_alloc(velum_weather_set *set, size_t count, size_t size) {
    const size_t alignment = alignof(max_align_t);
    if (size && count > max_alloc_bytes / size) {
        return NULL;
    }
    size_t bytes = count * size;
    bytes = bytes ? (bytes + alignment - 1) / alignment * alignment : alignment;
    if (!set->newest || set->newest->capacity - set->newest->used < bytes) {
        const size_t capacity = bytes > BLOCK_BYTES ? bytes : BLOCK_BYTES;
        block *fresh = calloc(1, sizeof(*fresh) + capacity);
        if (!fresh) {
            return NULL;
        }
        fresh->before = set->newest;
        fresh->capacity = capacity;
        set->newest = fresh;
    }
    void *memory = set->newest->bytes + set->newest->used;
    set->newest->used += bytes;
    return memory;
}

velum_layer *weather_set_layers(velum_weather_set *set, velum_cell *cell, uint32_t count) {
    cell->layers = NULL;
    cell->layer_count = 0;
    cell->layer_stride = sizeof(velum_layer);
    if (!count) {
        return NULL;
    }
    velum_layer *layers = weather_set_alloc(set, count, sizeof(*layers));
    if (!layers) {
        return NULL;
    }
    for (uint32_t i = 0; i < count; ++i) {
        layers[i].struct_size = sizeof(layers[i]);
    }
    cell->layers = layers;
    cell->layer_count = count;
    return layers;
}

velum_result weather_set_take_grid(velum_weather_set *set, const velum_grid *grid) {
    if (!grid || !grid->cells) {
        return VELUM_ERROR_ARGUMENT;
    }
    set->grid = *grid;
    set->has_grid = 1;
    return VELUM_OK;
}

weather_set_mark_point weather_set_mark(const velum_weather_set *set) {
    return (weather_set_mark_point){.cell_count = set->cell_count,
                                    .has_grid = set->has_grid,
                                    .next_id = set->next_id,
                                    .grid = set->grid,
                                    .block = set->newest,
                                    .block_used = set->newest ? set->newest->used : 0};
}

void weather_set_rollback(velum_weather_set *set, const weather_set_mark_point *mark) {
    free_blocks(set, mark->block);
    if (set->newest) {
        memset(set->newest->bytes + mark->block_used, 0, set->newest->used - mark->block_used);
        set->newest->used = mark->block_used;
    }
    set->cell_count = mark->cell_count;
    set->has_grid = mark->has_grid;
    set->grid = mark->grid;
    set->next_id = mark->next_id;
}
