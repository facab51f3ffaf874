#include "state.h"

#include "geodesy.h"
#include "state_private.h"
#include "tile_detail.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define STATE_V1_SIZE 56u
_Static_assert(sizeof(velum_state_desc) >= STATE_V1_SIZE, "frozen size");

#define MAX_INDEX_ITEMS (1u << 28)
#define BIN_COUNT (CORE_INDEX_ROWS * CORE_INDEX_COLUMNS)

static int by_order(const void *a, const void *b) {
    return core_cell_compare(*(core_cell *const *)a, *(core_cell *const *)b);
}

static int by_id(const void *a, const void *b) {
    uint64_t x = (*(core_cell *const *)a)->id;
    uint64_t y = (*(core_cell *const *)b)->id;
    return (x > y) - (x < y);
}

/* ---------------------------------------------------------------- the index */

typedef struct bin_range {
    uint32_t row_first, row_last;
    uint32_t column_first, column_count;
} bin_range;

/* Bins that a cell's cap touches: a box in latitude and longitude around the circle. */
static bin_range bins_of(const core_cell *cell) {
    double reach_deg = cell->reach_m / (CORE_RADIUS_M * CORE_DEG) * 1.01 + 0.05;
    bin_range range = {0, CORE_INDEX_ROWS - 1, 0, CORE_INDEX_COLUMNS};
    if (!(reach_deg < 80.0)) {
        return range;
    }
    double lat = core_normal_lat_deg(cell->cap_normal);
    double lon = core_normal_lon_deg(cell->cap_normal);
    range.row_first = core_index_bin(fmax(lat - reach_deg, -90.0), 0.0) / CORE_INDEX_COLUMNS;
    range.row_last = core_index_bin(fmin(lat + reach_deg, 90.0), 0.0) / CORE_INDEX_COLUMNS;
    if (fabs(lat) + reach_deg >= 89.0) {
        return range;
    }
    double half = asin(fmin(sin(reach_deg * CORE_DEG) / cos(lat * CORE_DEG), 1.0)) / CORE_DEG + 0.01;
    int32_t first = (int32_t)floor((lon - half + 180.0) * 0.5);
    int32_t last = (int32_t)floor((lon + half + 180.0) * 0.5);
    if (last - first + 1 < (int32_t)CORE_INDEX_COLUMNS) {
        range.column_first = (uint32_t)(first + 2 * (int32_t)CORE_INDEX_COLUMNS) % CORE_INDEX_COLUMNS;
        range.column_count = (uint32_t)(last - first + 1);
    }
    return range;
}

static bool index_build(core_index *index, core_cell *const *cells, uint32_t first, uint32_t end) {
    index->start = calloc(BIN_COUNT + 2, sizeof *index->start);
    if (!index->start) {
        return false;
    }
    /* Counted two places on, so that filling leaves each start where it belongs. */
    for (uint32_t c = first; c < end; c++) {
        bin_range range = bins_of(cells[c]);
        for (uint32_t row = range.row_first; row <= range.row_last; row++) {
            for (uint32_t k = 0; k < range.column_count; k++) {
                index->start[row * CORE_INDEX_COLUMNS + (range.column_first + k) % CORE_INDEX_COLUMNS + 2]++;
            }
        }
    }
    uint64_t total = 0;
    for (uint32_t bin = 0; bin < BIN_COUNT; bin++) {
        total += index->start[bin + 2];
        if (total > MAX_INDEX_ITEMS) {
            return false;
        }
        index->start[bin + 2] = (uint32_t)total;
    }
    index->items = malloc((total + 1) * sizeof *index->items);
    if (!index->items) {
        return false;
    }
    for (uint32_t c = first; c < end; c++) {
        bin_range range = bins_of(cells[c]);
        for (uint32_t row = range.row_first; row <= range.row_last; row++) {
            for (uint32_t k = 0; k < range.column_count; k++) {
                uint32_t bin = row * CORE_INDEX_COLUMNS + (range.column_first + k) % CORE_INDEX_COLUMNS;
                index->items[index->start[bin + 1]++] = c;
            }
        }
    }
    return true;
}

static bool make_station_points(core_state *state) {
    uint32_t count = state->stations.start[BIN_COUNT];
    state->station_points = malloc((count + 1u) * sizeof *state->station_points);
    if (!state->station_points) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        const core_cell *cell = state->cells[state->stations.items[i]];
        core_station_point *point = &state->station_points[i];
        double chord = 2.0 * sin(0.5 * cell->radius_m / CORE_RADIUS_M);
        for (int axis = 0; axis < 3; axis++) {
            point->normal[axis] = (float)cell->normal[axis];
        }
        point->priority = cell->priority;
        point->chord2 = (float)((chord + 1e-6) * (chord + 1e-6));
    }
    return true;
}

/* ---------------------------------------------------------------- making */

static velum_result read_desc(const velum_state_desc *from, const core_state *base, velum_state_desc *desc,
                              core_error *error) {
    if (!from) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "state: found null, expected a velum_state_desc");
    }
    if (!core_copy_struct(desc, sizeof *desc, from, STATE_V1_SIZE)) {
        return core_fail(error, VELUM_ERROR_STRUCT_SIZE, "state, struct_size: found %u, expected at least %u",
                         from->struct_size, STATE_V1_SIZE);
    }
    if (desc->flags != 0) {
        return core_fail(error, VELUM_ERROR_FLAGS, "state, flags: found 0x%x, expected 0", desc->flags);
    }
    if (desc->base_state != 0 && (!base || base->id != desc->base_state)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT,
                         "state, base_state: found %" PRIu64 ", expected 0 or the id of a live state",
                         desc->base_state);
    }
    if (desc->cell_count > CORE_STATE_MAX_CELLS) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "state, cell_count: found %u, expected at most %u",
                         desc->cell_count, CORE_STATE_MAX_CELLS);
    }
    if (desc->cell_count > 0 && !desc->cells) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "state, cells: found null, expected %u cells", desc->cell_count);
    }
    if (desc->removed_count > 0 && (desc->base_state == 0 || !desc->removed_ids)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "state, removed_ids: found %s, expected ids in a change only",
                         desc->removed_ids ? "ids in a whole state" : "null");
    }
    if (desc->removed_count > CORE_STATE_MAX_CELLS) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "state, removed_count: found %u, expected at most %u",
                         desc->removed_count, CORE_STATE_MAX_CELLS);
    }
    if (!(desc->geoid_undulation_m >= -200.0f && desc->geoid_undulation_m <= 200.0f)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "state, geoid_undulation_m: found %g, expected -200..200",
                         (double)desc->geoid_undulation_m);
    }
    if (desc->cell_count > 0 && desc->cell_stride == 0) {
        desc->cell_stride = desc->cells->struct_size;
    }
    if (desc->cell_count > 0 && desc->cell_stride < CORE_CELL_V1_SIZE) {
        return core_fail(error, VELUM_ERROR_STRUCT_SIZE, "state, cell_stride: found %u, expected at least %u",
                         desc->cell_stride, CORE_CELL_V1_SIZE);
    }
    return VELUM_OK;
}

/* The index of an id in cells sorted by id, or count. */
static uint32_t find_id(core_cell *const *cells, uint32_t count, uint64_t id) {
    uint32_t low = 0;
    uint32_t high = count;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (cells[middle]->id < id) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < count && cells[low]->id == id ? low : count;
}

/* The base's cells without those removed or replaced go to the state, with references. */
static velum_result take_base(core_state *state, const core_state *base, const velum_state_desc *desc,
                              core_cell *const *fresh, core_error *error) {
    velum_result result = VELUM_OK;
    core_cell **sorted = malloc((base->cell_count + 1u) * sizeof *sorted);
    if (!sorted) {
        return core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "state: out of memory");
    }
    if (base->cell_count > 0) {
        memcpy(sorted, base->cells, base->cell_count * sizeof *sorted);
    }
    qsort(sorted, base->cell_count, sizeof *sorted, by_id);
    bool *gone = calloc(base->cell_count + 1u, sizeof *gone);
    if (!gone) {
        result = core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "state: out of memory");
        goto error;
    }
    for (uint32_t i = 0; i < desc->removed_count; i++) {
        uint32_t at = find_id(sorted, base->cell_count, desc->removed_ids[i]);
        if (at == base->cell_count || gone[at]) {
            result = core_fail(error, VELUM_ERROR_ARGUMENT,
                               "state, removed_ids[%u]: found %" PRIu64 ", expected the id of a cell of state %" PRIu64
                               ", once",
                               i, desc->removed_ids[i], base->id);
            goto error;
        }
        gone[at] = true;
    }
    for (uint32_t i = 0; i < base->cell_count; i++) {
        if (!gone[i] && find_id(fresh, desc->cell_count, sorted[i]->id) == desc->cell_count) {
            state->cells[state->cell_count++] = core_cell_ref(sorted[i]);
        }
    }
error:
    free(gone);
    free(sorted);
    return result;
}

static void note_uniform(core_state *state, uint32_t which, const core_slot_layer *layer, bool *known) {
    if (!known[which]) {
        known[which] = true;
        state->uniform[which] =
            (core_uniform_phase){layer->albedo, layer->hg_asymmetry, (layer->flags & VELUM_LAYER_PHASE_HG) != 0};
    }
}

/* What holds for the state as a whole. */
static void summarise(core_state *state) {
    bool known[2] = {false, false};
    state->min_base_m = 1e9f;
    state->max_top_m = -1e9f;
    state->uniform[0] = state->uniform[1] = (core_uniform_phase){1.0f, 0.0f, false};
    state->bytes = sizeof *state + state->cell_count * sizeof *state->cells +
                   2 * (BIN_COUNT + 2) * sizeof *state->stations.start +
                   (state->stations.start[BIN_COUNT] + state->regions.start[BIN_COUNT]) * sizeof(uint32_t);
    double texel_m = state->first_station > 0 ? CORE_POLE_FADE_TEXEL_M : core_tile_texel_m(0);
    for (uint32_t i = 0; i < state->cell_count; i++) {
        const core_cell *cell = state->cells[i];
        state->slot_mask |= cell->fields.slot_mask;
        state->merged += cell->merged;
        state->min_base_m = fminf(state->min_base_m, cell->min_base_m);
        state->max_top_m = fmaxf(state->max_top_m, cell->max_top_m);
        state->bytes += core_cell_bytes(cell);
        if (cell->kind == VELUM_CELL_STATION && cell->fields.flags & VELUM_CELL_HAS_LAYERS) {
            texel_m = fmin(texel_m, cell->radius_m / 8.0);
        }
        for (uint32_t u = 0; u < 2; u++) {
            if (cell->fields.slot_mask & (1u << (VELUM_SLOT_UNIFORM + u))) {
                note_uniform(state, u, &cell->uniform[u], known);
            }
        }
    }
    if (state->grid) {
        const core_grid *grid = state->grid;
        state->slot_mask |= grid->slot_mask;
        state->merged += grid->merged;
        state->min_base_m = fminf(state->min_base_m, grid->min_base_m);
        state->max_top_m = fmaxf(state->max_top_m, grid->max_top_m);
        state->bytes += core_grid_bytes(grid);
        /* The border of a regional grid is sharp. */
        texel_m = fmin(texel_m, core_grid_border_m(grid, 0.0, 0.0) > -1e8 ? 0.0 : core_grid_texel_m(grid, 90.0));
        for (uint32_t u = 0; u < 2; u++) {
            if (grid->has_uniform[u]) {
                note_uniform(state, u, &grid->uniform[u], known);
            }
        }
    }
    state->base_level = core_level_of_texel(texel_m);
}

velum_result core_state_create(const velum_state_desc *from, const core_state *base, uint64_t id, core_state **out,
                               core_error *error) {
    velum_state_desc desc;
    core_state *state = NULL;
    core_cell **fresh = NULL;
    uint32_t fresh_count = 0;
    *out = NULL;
    velum_result result = read_desc(from, base, &desc, error);
    if (result != VELUM_OK) {
        return result;
    }
    if (desc.base_state == 0) {
        base = NULL;
    }
    uint32_t room = desc.cell_count + (base ? base->cell_count : 0);
    state = calloc(1, sizeof *state);
    fresh = calloc(desc.cell_count + 1u, sizeof *fresh);
    if (!state || !fresh) {
        result = core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "state of %u cells: out of memory", room);
        goto error;
    }
    atomic_init(&state->references, 1);
    state->id = id;
    state->undulation_m = base && desc.geoid_undulation_m == 0.0f ? base->undulation_m : desc.geoid_undulation_m;
    state->cells = calloc(room + 1u, sizeof(core_cell *));
    if (!state->cells) {
        result = core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "state of %u cells: out of memory", room);
        goto error;
    }
    for (; fresh_count < desc.cell_count; fresh_count++) {
        const char *at = (const char *)desc.cells + (size_t)fresh_count * desc.cell_stride;
        result = core_cell_create((const velum_cell *)at, &fresh[fresh_count], error);
        if (result != VELUM_OK) {
            goto error;
        }
    }
    qsort(fresh, fresh_count, sizeof *fresh, by_id);
    for (uint32_t i = 1; i < fresh_count; i++) {
        if (fresh[i]->id == fresh[i - 1]->id) {
            result = core_fail(error, VELUM_ERROR_ARGUMENT, "cell %" PRIu64 ", id: found twice, expected once",
                               fresh[i]->id);
            goto error;
        }
    }
    if (desc.grid) {
        result = core_grid_create(desc.grid, &state->grid, error);
        if (result != VELUM_OK) {
            goto error;
        }
    } else if (base) {
        state->grid = core_grid_ref(base->grid);
    }
    if (base) {
        result = take_base(state, base, &desc, fresh, error);
        if (result != VELUM_OK) {
            goto error;
        }
    }
    for (uint32_t i = 0; i < fresh_count; i++) {
        state->cells[state->cell_count++] = fresh[i];
        fresh[i] = NULL;
    }
    qsort(state->cells, state->cell_count, sizeof(core_cell *), by_order);
    uint32_t first_station = 0;
    while (first_station < state->cell_count && state->cells[first_station]->kind == VELUM_CELL_GLOBAL) {
        first_station++;
    }
    uint32_t first_region = first_station;
    while (first_region < state->cell_count && state->cells[first_region]->kind == VELUM_CELL_STATION) {
        first_region++;
    }
    if (!index_build(&state->stations, state->cells, first_station, first_region) || !make_station_points(state) ||
        !index_build(&state->regions, state->cells, first_region, state->cell_count)) {
        result = core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "state of %u cells: no memory for its index",
                           state->cell_count);
        goto error;
    }
    state->first_station = first_station;
    state->first_region = first_region;
    summarise(state);
    free(fresh);
    *out = state;
    return VELUM_OK;
error:
    for (uint32_t i = 0; fresh && i < desc.cell_count; i++) {
        core_cell_unref(fresh[i]);
    }
    free(fresh);
    if (state) {
        atomic_store(&state->references, 1);
        core_state_unref(state);
    }
    return result;
}

core_state *core_state_ref(core_state *state) {
    if (state) {
        atomic_fetch_add_explicit(&state->references, 1, memory_order_relaxed);
    }
    return state;
}

void core_state_unref(core_state *state) {
    if (!state || atomic_fetch_sub_explicit(&state->references, 1, memory_order_acq_rel) != 1) {
        return;
    }
    for (uint32_t i = 0; i < state->cell_count; i++) {
        core_cell_unref(state->cells[i]);
    }
    free(state->cells);
    free(state->stations.start);
    free(state->stations.items);
    free(state->station_points);
    free(state->regions.start);
    free(state->regions.items);
    core_grid_unref(state->grid);
    free(state);
}

/* ---------------------------------------------------------------- reading */

uint64_t core_state_id(const core_state *state) {
    return state->id;
}

uint32_t core_state_cell_count(const core_state *state) {
    return state->cell_count + (state->grid ? state->grid->columns * state->grid->rows : 0);
}

uint64_t core_state_bytes(const core_state *state) {
    return state->bytes;
}

float core_state_undulation_m(const core_state *state) {
    return state->undulation_m;
}

uint32_t core_state_slot_mask(const core_state *state) {
    return state->slot_mask;
}

uint32_t core_state_merged_layers(const core_state *state) {
    return state->merged;
}

bool core_state_height_range(const core_state *state, float *min_base_m, float *max_top_m) {
    bool any = state->min_base_m < state->max_top_m;
    *min_base_m = any ? state->min_base_m + state->undulation_m : 0.0f;
    *max_top_m = any ? state->max_top_m + state->undulation_m : 0.0f;
    return any;
}

core_uniform_phase core_state_uniform_phase(const core_state *state, uint32_t slot) {
    return state->uniform[slot == VELUM_SLOT_UNIFORM_2 ? 1 : 0];
}
