/* A latitude-longitude grid of nodes, ready for bilinear reading. */
#ifndef VELUM_CORE_GRID_H
#define VELUM_CORE_GRID_H

#include "cell.h"

#define CORE_GRID_V1_SIZE 64u

typedef struct core_grid {
    atomic_uint references;
    double lat_first_deg, lon_first_deg, lat_step_deg, lon_step_deg;
    uint32_t columns, rows;
    bool closed;             /* round the globe */
    core_cell_fields *nodes; /* rows * columns, then the poles */
    core_cell_slot *slots;
    /* Of a closed grid: the mean of the row next to a pole stands for the pole. 0: the pole of the first row. */
    bool has_pole[2];
    uint32_t slot_mask, merged;
    uint32_t slot_count;
    float min_base_m, max_top_m; /* MSL; min > max: no cloud */
    bool has_uniform[2];
    core_slot_layer uniform[2];
} core_grid;

velum_result core_grid_create(const velum_grid *grid, core_grid **out, core_error *error);
core_grid *core_grid_ref(core_grid *grid);
void core_grid_unref(core_grid *grid);
size_t core_grid_bytes(const core_grid *grid);

/* The nodes around a place and their weights (in sum 1). Entries may repeat. */
typedef struct core_grid_place {
    uint32_t node[4];
    float weight[4];
} core_grid_place;
core_grid_place core_grid_at(const core_grid *grid, double lat_deg, double lon_deg);

/* Signed distance to the border, m, negative inside; -1e9 for a grid without border. */
double core_grid_border_m(const core_grid *grid, double lat_deg, double lon_deg);
/* The texel that its spacing at a latitude asks for. */
double core_grid_texel_m(const core_grid *grid, double lat_deg);

#endif
