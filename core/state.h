/* A weather state: an immutable, checked, indexed copy of what the host committed. */
#ifndef VELUM_CORE_STATE_H
#define VELUM_CORE_STATE_H

#include <stdint.h>
#include <velum/weather.h>

#include "result.h"

typedef struct core_state core_state;

#define CORE_STATE_MAX_CELLS (1u << 20)
#define CORE_STATE_MAX_NODES (1u << 23)
#define CORE_POLYGON_MAX_POINTS (1u << 20)

/* Checks `desc` whole and copies it deeply. `base` is the state that desc->base_state names, null for a whole state.
 * In a delta a geoid undulation of 0 keeps the base's. `id` names the new state. *out has one reference; it is null
 * after an error. */
velum_result core_state_create(const velum_state_desc *desc, const core_state *base, uint64_t id, core_state **out,
                               core_error *error);

/* Reference counts are atomic; the state itself never changes, so any thread may read it. Null is legal. */
core_state *core_state_ref(core_state *state);
void core_state_unref(core_state *state);

uint64_t core_state_id(const core_state *state);
uint32_t core_state_cell_count(const core_state *state); /* grid nodes included */
uint64_t core_state_bytes(const core_state *state);      /* what is shared with the base counted in both */
float core_state_undulation_m(const core_state *state);
uint32_t core_state_slot_mask(const core_state *state);     /* slots that any cell uses */
uint32_t core_state_merged_layers(const core_state *state); /* layers that share a slot with another of their cell */
/* Lowest base and highest top of all layers, HAE. False: there is no cloud at all. */
bool core_state_height_range(const core_state *state, float *min_base_m, float *max_top_m);

/* Phase function and albedo of a UNIFORM slot: of the first cell (by rank, priority, id) that uses it. */
typedef struct core_uniform_phase {
    float albedo;
    float hg_asymmetry;
    bool has_hg; /* false: the cloud's own phase function */
} core_uniform_phase;
core_uniform_phase core_state_uniform_phase(const core_state *state, uint32_t slot);

#endif
