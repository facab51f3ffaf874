/* States for tests, made of plain data. */
#ifndef SYNTHETIC_H
#define SYNTHETIC_H

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "core/noise.h"
#include "core/oracle.h"
#include "core/state.h"
#include "core/tile_cache.h"

static inline velum_layer layer_of(int32_t genus, float coverage, float base_m, float top_m) {
    return (velum_layer){.struct_size = sizeof(velum_layer),
                         .genus = genus,
                         .coverage = coverage,
                         .base_m = base_m,
                         .top_m = top_m,
                         .water_g_m3 = 0.3f,
                         .radius_um = 10.0f};
}

static inline velum_cell cell_of(int32_t kind, uint64_t id, const velum_layer *layers, uint32_t count) {
    return (velum_cell){.struct_size = sizeof(velum_cell),
                        .flags = VELUM_CELL_HAS_LAYERS,
                        .id = id,
                        .kind = kind,
                        .layers = layers,
                        .layer_count = count};
}

static inline velum_state_desc desc_of(const velum_cell *cells, uint32_t count) {
    return (velum_state_desc){.struct_size = sizeof(velum_state_desc), .cells = cells, .cell_count = count};
}

/* The state, which must be accepted. */
core_state *state_of(const velum_state_desc *desc, const core_state *base, uint64_t id);
/* This layer over the whole planet. */
core_state *state_of_layer(velum_layer layer, uint64_t id);
/* The state from a to b, with all its detail and tiles from the cache. */
core_oracle oracle_over(const core_noise *noise, core_tile_cache *cache, const core_state *a, const core_state *b,
                        double time_s);

/* A grid of 144 x 73 nodes (2.5 degrees) and stations as dense as the real ones, from a fixed generator. */
typedef struct synthetic_world {
    velum_grid grid;
    velum_cell *nodes;
    velum_layer *node_layers;
    velum_cell *stations;
    velum_layer *station_layers;
    velum_state_desc desc;
} synthetic_world;
void synthetic_world_init(synthetic_world *world, uint32_t station_count);
void synthetic_world_finish(synthetic_world *world);

/* splitmix64, 0..1 */
double random_unit(uint64_t *state);

double seconds_now(void);

#endif
