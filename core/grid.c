#include "grid.h"

#include "geodesy.h"
#include "state.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Static_assert(sizeof(velum_grid) >= CORE_GRID_V1_SIZE, "frozen size");

#define DEGREE_M (CORE_RADIUS_M * CORE_DEG)

static velum_result refuse(core_error *error, const char *field, double found, const char *expected) {
    return core_fail(error, VELUM_ERROR_ARGUMENT, "grid, %s: found %.9g, expected %s", field, found, expected);
}

static velum_result check(const velum_grid *grid, core_error *error) {
    if (grid->flags != 0 || grid->reserved != 0) {
        return core_fail(error, VELUM_ERROR_FLAGS, "grid, %s: found 0x%x, expected 0",
                         grid->flags ? "flags" : "reserved", grid->flags ? grid->flags : grid->reserved);
    }
    if (!(grid->lat_first_deg >= -90.0 && grid->lat_first_deg <= 90.0)) {
        return refuse(error, "lat_first_deg", grid->lat_first_deg, "-90..90");
    }
    if (!(grid->lon_first_deg >= -180.0 && grid->lon_first_deg <= 360.0)) {
        return refuse(error, "lon_first_deg", grid->lon_first_deg, "-180..360");
    }
    if (grid->columns < 1 || grid->rows < 1 || (uint64_t)grid->columns * grid->rows > CORE_STATE_MAX_NODES) {
        return core_fail(error, VELUM_ERROR_ARGUMENT,
                         "grid, columns and rows: found %u and %u, expected both above 0, at most %u nodes",
                         grid->columns, grid->rows, CORE_STATE_MAX_NODES);
    }
    if (!(fabs(grid->lat_step_deg) >= 1e-6 && fabs(grid->lat_step_deg) <= 180.0)) {
        return refuse(error, "lat_step_deg", grid->lat_step_deg, "a size of 1e-6..180");
    }
    double last = grid->lat_first_deg + grid->lat_step_deg * (grid->rows - 1);
    if (!(fabs(last) <= 90.0 + 1e-4 * fabs(grid->lat_step_deg))) {
        return refuse(error, "lat_step_deg", grid->lat_step_deg, "rows within -90..90");
    }
    if (!(grid->lon_step_deg >= 1e-6 && grid->lon_step_deg <= 360.0)) {
        return refuse(error, "lon_step_deg", grid->lon_step_deg, "1e-6..360");
    }
    if (grid->lon_step_deg * grid->columns > 360.0 * (1.0 + 1e-4 / grid->columns)) {
        return refuse(error, "lon_step_deg", grid->lon_step_deg, "columns that reach round the globe once at most");
    }
    if (!grid->cells) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "grid, cells: found null, expected an array");
    }
    return VELUM_OK;
}

static double row_lat(const core_grid *grid, uint32_t row) {
    return fmin(fmax(grid->lat_first_deg + grid->lat_step_deg * row, -90.0), 90.0);
}

/* The mean of a row stands for the pole, so that all its longitudes are one place. */
static void make_pole(core_grid *grid, uint32_t row, core_cell_fields *pole, core_cell_slot slots[VELUM_SLOT_COUNT]) {
    float sum[VELUM_SLOT_COUNT][CORE_FIELD_COUNT] = {{0}};
    float share = 1.0f / (float)grid->columns;
    memset(pole, 0, sizeof *pole);
    pole->flags = ~0u;
    for (uint32_t i = 0; i < grid->columns; i++) {
        const core_cell_fields *node = &grid->nodes[(size_t)row * grid->columns + i];
        pole->flags &= node->flags;
        pole->slot_mask |= node->slot_mask;
        for (uint32_t s = 0; s < node->slot_count; s++) {
            const core_cell_slot *slot = &grid->slots[node->first_slot + s];
            for (uint32_t f = 0; f < CORE_FIELD_COUNT; f++) {
                sum[slot->slot][f] += slot->field[f] * share;
            }
        }
        for (uint32_t f = 0; f < CORE_SURFACE_COUNT; f++) {
            pole->surface[f] += node->surface[f] * share;
        }
    }
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (pole->slot_mask & (1u << slot)) {
            core_cell_slot *out = &slots[pole->slot_count++];
            out->slot = slot;
            memcpy(out->field, sum[slot], sizeof out->field);
        }
    }
}

velum_result core_grid_create(const velum_grid *from, core_grid **out, core_error *error) {
    velum_grid own;
    core_grid *grid = NULL;
    core_cell_reading *reading = NULL;
    size_t capacity = 0;
    *out = NULL;
    if (!core_copy_struct(&own, sizeof own, from, CORE_GRID_V1_SIZE)) {
        return core_fail(error, VELUM_ERROR_STRUCT_SIZE, "grid, struct_size: found %u, expected at least %u",
                         from->struct_size, CORE_GRID_V1_SIZE);
    }
    velum_result result = check(&own, error);
    if (result != VELUM_OK) {
        return result;
    }
    uint32_t stride = own.cell_stride ? own.cell_stride : own.cells->struct_size;
    if (stride < CORE_CELL_V1_SIZE) {
        return core_fail(error, VELUM_ERROR_STRUCT_SIZE, "grid, cell_stride: found %u, expected at least %u", stride,
                         CORE_CELL_V1_SIZE);
    }
    size_t count = (size_t)own.columns * own.rows;
    reading = malloc(sizeof *reading);
    grid = calloc(1, sizeof *grid);
    if (!grid) {
        goto error;
    }
    atomic_init(&grid->references, 1);
    if (!reading) {
        goto error;
    }
    grid->lat_first_deg = own.lat_first_deg;
    grid->lon_first_deg = own.lon_first_deg;
    grid->lat_step_deg = own.lat_step_deg;
    grid->lon_step_deg = own.lon_step_deg;
    grid->columns = own.columns;
    grid->rows = own.rows;
    grid->closed = own.lon_step_deg * own.columns > 360.0 * (1.0 - 1e-4 / own.columns);
    grid->min_base_m = 1e9f;
    grid->max_top_m = -1e9f;
    grid->nodes = calloc(count + 2, sizeof *grid->nodes);
    capacity = count * 2 + 2 * VELUM_SLOT_COUNT;
    grid->slots = malloc(capacity * sizeof *grid->slots);
    if (!grid->nodes || !grid->slots) {
        goto error;
    }
    for (size_t i = 0; i < count; i++) {
        char where[64];
        uint32_t row = (uint32_t)(i / own.columns);
        uint32_t column = (uint32_t)(i % own.columns);
        snprintf(where, sizeof where, "grid row %u, column %u", row, column);
        result = core_cell_read(reading, (const velum_cell *)((const char *)own.cells + i * stride), true,
                                row_lat(grid, row), own.lon_first_deg + own.lon_step_deg * column, where, error);
        if (result != VELUM_OK) {
            goto refused;
        }
        if (capacity - grid->slot_count < 3 * VELUM_SLOT_COUNT) {
            capacity *= 2;
            core_cell_slot *more = realloc(grid->slots, capacity * sizeof *more);
            if (!more) {
                goto error;
            }
            grid->slots = more;
        }
        grid->nodes[i] = reading->fields;
        grid->nodes[i].first_slot = grid->slot_count;
        memcpy(&grid->slots[grid->slot_count], reading->slots, reading->slot_count * sizeof *grid->slots);
        grid->slot_count += reading->slot_count;
        grid->slot_mask |= reading->fields.slot_mask;
        grid->merged += reading->layers.merged;
        grid->min_base_m = fminf(grid->min_base_m, reading->min_base_m);
        grid->max_top_m = fmaxf(grid->max_top_m, reading->max_top_m);
        for (uint32_t u = 0; u < 2; u++) {
            if (reading->layers.mask & (1u << (VELUM_SLOT_UNIFORM + u)) && !grid->has_uniform[u]) {
                grid->has_uniform[u] = true;
                grid->uniform[u] = reading->layers.slot[VELUM_SLOT_UNIFORM + u];
            }
        }
    }
    for (uint32_t end = 0; grid->closed && end < 2; end++) {
        uint32_t row = end == 0 ? 0 : own.rows - 1;
        if (90.0 - fabs(row_lat(grid, row)) <= 1.01 * fabs(own.lat_step_deg)) {
            grid->has_pole[end] = true;
            make_pole(grid, row, &grid->nodes[count + end], &grid->slots[grid->slot_count]);
            grid->nodes[count + end].first_slot = grid->slot_count;
            grid->slot_count += grid->nodes[count + end].slot_count;
        }
    }
    free(reading);
    *out = grid;
    return VELUM_OK;
error:
    result =
        core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "grid of %u by %u nodes: out of memory", own.columns, own.rows);
refused:
    free(reading);
    core_grid_unref(grid);
    return result;
}

core_grid *core_grid_ref(core_grid *grid) {
    if (grid) {
        atomic_fetch_add_explicit(&grid->references, 1, memory_order_relaxed);
    }
    return grid;
}

void core_grid_unref(core_grid *grid) {
    if (grid && atomic_fetch_sub_explicit(&grid->references, 1, memory_order_acq_rel) == 1) {
        free(grid->nodes);
        free(grid->slots);
        free(grid);
    }
}

size_t core_grid_bytes(const core_grid *grid) {
    return sizeof *grid + ((size_t)grid->columns * grid->rows + 2) * sizeof *grid->nodes +
           grid->slot_count * sizeof *grid->slots;
}

core_grid_place core_grid_at(const core_grid *grid, double lat_deg, double lon_deg) {
    uint32_t count = grid->columns * grid->rows;
    double y = (lat_deg - grid->lat_first_deg) / grid->lat_step_deg;
    double x = (lon_deg - grid->lon_first_deg) / grid->lon_step_deg;
    double around = 360.0 / grid->lon_step_deg;
    x -= floor(x / around) * around;
    if (!grid->closed && x > grid->columns - 1) {
        /* Outside: the nearer end. */
        x = x - (grid->columns - 1) < around - x ? grid->columns - 1 : 0.0;
    }
    uint32_t i0 = (uint32_t)core_min(floor(x), (double)grid->columns - 1.0);
    uint32_t i1 = i0 + 1 < grid->columns ? i0 + 1 : grid->closed ? 0 : i0;
    float tx = (float)core_min(core_max(x - i0, 0.0), 1.0);
    uint32_t last = grid->rows - 1;
    uint32_t row0;
    uint32_t row1;
    float ty;
    core_grid_place place;
    /* Rows on a pole, or between the last row and a pole, read the pole. */
    for (uint32_t end = 0; end < 2; end++) {
        double row_deg = row_lat(grid, end == 0 ? 0 : last);
        double gap = 90.0 - fabs(row_deg);
        bool beyond = end == 0 ? y < 0.0 : y > last;
        if (grid->has_pole[end] && gap > 1e-6 && beyond) {
            ty = (float)core_min(fabs(lat_deg - row_deg) / gap, 1.0);
            row0 = (end == 0 ? 0 : last) * grid->columns;
            place = (core_grid_place){{row0 + i0, row0 + i1, count + end, count + end},
                                      {(1.0f - tx) * (1.0f - ty), tx * (1.0f - ty), ty, 0.0f}};
            return place;
        }
    }
    y = core_min(core_max(y, 0.0), (double)last);
    row0 = (uint32_t)y;
    row1 = row0 < last ? row0 + 1 : last;
    ty = (float)(y - row0);
    place = (core_grid_place){
        {row0 * grid->columns + i0, row0 * grid->columns + i1, row1 * grid->columns + i0, row1 * grid->columns + i1},
        {(1.0f - tx) * (1.0f - ty), tx * (1.0f - ty), (1.0f - tx) * ty, tx * ty}};
    for (uint32_t end = 0; end < 2; end++) {
        uint32_t row = end == 0 ? 0 : last;
        if (grid->has_pole[end] && 90.0 - fabs(row_lat(grid, row)) <= 1e-6) {
            if (row0 == row) {
                place.node[0] = place.node[1] = count + end;
            }
            if (row1 == row) {
                place.node[2] = place.node[3] = count + end;
            }
        }
    }
    return place;
}

double core_grid_border_m(const core_grid *grid, double lat_deg, double lon_deg) {
    double a = row_lat(grid, 0);
    double b = row_lat(grid, grid->rows - 1);
    double north = core_max(a, b);
    double south = core_min(a, b);
    double step = fabs(grid->lat_step_deg);
    double y = -1e9;
    double x = -1e9;
    /* A border that is a pole, or has only the pole beyond, is none. */
    if (!(grid->closed && 90.0 - north <= 1.01 * step)) {
        y = core_max(y, (lat_deg - north) * DEGREE_M);
    }
    if (!(grid->closed && south + 90.0 <= 1.01 * step)) {
        y = core_max(y, (south - lat_deg) * DEGREE_M);
    }
    if (!grid->closed) {
        double width = grid->lon_step_deg * (grid->columns - 1);
        double east = lon_deg - grid->lon_first_deg;
        east -= floor(east / 360.0) * 360.0;
        double outside = core_min(east - width, 360.0 - east);
        double excess = east <= width ? -core_min(east, width - east) : outside;
        x = excess * DEGREE_M * cos(lat_deg * CORE_DEG);
    }
    return x > 0.0 && y > 0.0 ? hypot(x, y) : core_max(x, y);
}

double core_grid_texel_m(const core_grid *grid, double lat_deg) {
    double north_m = fabs(grid->lat_step_deg) * DEGREE_M;
    double east_m = grid->lon_step_deg * DEGREE_M * cos(lat_deg * CORE_DEG);
    return core_max(core_min(north_m, east_m) / 8.0, north_m / 32.0);
}
