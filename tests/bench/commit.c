#include "commit.h"

#include <stdlib.h>

/* The cells with other winds, in one block: cells, then their layers. */
static velum_cell *blown(const velum_state_desc *state, float wind_east_m_s) {
    size_t layers = 0;
    for (uint32_t i = 0; i < state->cell_count; i++) {
        layers += state->cells[i].layer_count;
    }
    size_t cell_bytes = (state->cell_count + 1u) * sizeof(velum_cell);
    velum_cell *cells = malloc(cell_bytes + (layers + 1u) * sizeof(velum_layer));
    if (!cells) {
        return NULL;
    }
    velum_layer *next = (velum_layer *)(void *)((char *)cells + cell_bytes);
    for (uint32_t i = 0; i < state->cell_count; i++) {
        cells[i] = state->cells[i];
        for (uint32_t k = 0; k < cells[i].layer_count; k++) {
            next[k] = state->cells[i].layers[k];
            next[k].wind_east_m_s += wind_east_m_s;
        }
        cells[i].layers = next;
        next += cells[i].layer_count;
    }
    return cells;
}

velum_result commit_scenario(const velum_world_api *api, velum_world *world, const velum_scenario *scenario,
                             float wind_east_m_s) {
    velum_timeline_key *keys = calloc(scenario->key_count + 1u, sizeof *keys);
    velum_result result = keys ? VELUM_OK : VELUM_ERROR_OUT_OF_MEMORY;
    for (uint32_t i = 0; i < scenario->key_count && result >= 0; i++) {
        velum_state_desc state = {.struct_size = sizeof state};
        velum_weather_set_state(scenario->keys[i].set, &state);
        state.geoid_undulation_m = scenario->geoid_undulation_m;
        velum_cell *cells = wind_east_m_s != 0.0f ? blown(&state, wind_east_m_s) : NULL;
        state.cells = cells ? cells : state.cells;
        keys[i] = (velum_timeline_key){.struct_size = sizeof keys[i],
                                       .time_s = scenario->keys[i].time_s,
                                       .transition_s = scenario->keys[i].transition_s};
        result =
            wind_east_m_s != 0.0f && !cells ? VELUM_ERROR_OUT_OF_MEMORY : api->commit(world, &state, &keys[i].state);
        free(cells);
    }
    if (result >= 0) {
        result = api->set_timeline(world, keys, scenario->key_count, 0);
    }
    free(keys);
    return result;
}
