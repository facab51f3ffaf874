/* What column.c, tile.c and tile_set.c see of a state. */
#ifndef VELUM_CORE_STATE_PRIVATE_H
#define VELUM_CORE_STATE_PRIVATE_H

#include "cell.h"
#include "geodesy.h"
#include "grid.h"
#include "state.h"

/* Cells by bins of 2 degrees of latitude and longitude, each cell in every bin that it can reach. */
#define CORE_INDEX_ROWS 90u
#define CORE_INDEX_COLUMNS 180u
typedef struct core_index {
    uint32_t *start; /* ROWS * COLUMNS + 1 */
    uint32_t *items; /* in the order of the cells */
} core_index;

/* A station as the inner loop sees it: beyond the chord it has no effect. */
typedef struct core_station_point {
    float normal[3];
    float chord2; /* rounded up */
    int32_t priority;
} core_station_point;

struct core_state {
    atomic_uint references;
    uint64_t id;
    float undulation_m;
    core_grid *grid;   /* may be null */
    core_cell **cells; /* by core_cell_compare: globals, stations, regions */
    uint32_t cell_count;
    uint32_t first_station, first_region;
    core_index stations, regions;
    core_station_point *station_points; /* one an item of the stations' index */
    uint32_t base_level;                /* texels of this level hold all but the regions, everywhere */
    uint32_t slot_mask;
    uint32_t merged;
    float min_base_m, max_top_m; /* MSL */
    core_uniform_phase uniform[2];
    uint64_t bytes;
};

static inline uint32_t core_index_bin(double lat_deg, double lon_deg) {
    uint32_t row = (uint32_t)core_min(core_max((lat_deg + 90.0) * 0.5, 0.0), (double)CORE_INDEX_ROWS - 1.0);
    uint32_t column = (uint32_t)core_min(core_max((lon_deg + 180.0) * 0.5, 0.0), (double)CORE_INDEX_COLUMNS - 1.0);
    return row * CORE_INDEX_COLUMNS + column;
}

/* The blended fields of a place, each but the first times coverage; heights MSL, winds not yet tangent. */
typedef struct core_blend {
    uint32_t mask;
    float slot[VELUM_SLOT_COUNT][CORE_FIELD_COUNT];
    float surface[CORE_SURFACE_COUNT];
} core_blend;
void core_blend_at(const core_state *state, const double normal[3], double texel_m, bool with_surface, core_blend *out);
/* The same in two steps: all but the regions, then one region after the other, in order. */
void core_blend_base_at(const core_state *state, const double normal[3], double lat_deg, double lon_deg, double texel_m,
                        bool with_surface, core_blend *out);
void core_blend_region(const core_cell *cell, const double normal[3], double lat_deg, double lon_deg, double texel_m,
                       bool with_surface, core_blend *blend);

/* How full a slot is, 0..1: its coverage over that of the cells that made it. Below 1 where a sheet ends or gives way
 * to less cloud. There it thins out instead of breaking into columns as tall as it is: its top, times coverage, MSL;
 * and the logarithm of its extinction. Storms end in anvils, which cover as much as ever, with fewer towers, less scud
 * and less rain. */
float core_blend_fullness(const float *field);
float core_blend_coverage(uint32_t slot, const float *field);
float core_blend_top(uint32_t slot, const float *field);
float core_blend_log_extinction(uint32_t slot, const float *field);
float core_blend_kind(uint32_t slot, const float *field);
float core_blend_scud(uint32_t slot, const float *field);
float core_blend_fall(uint32_t slot, const float *field);

/* Over the last degree before a pole the wind of global cells fades out. */
#define CORE_POLE_FADE_DEG 1.0

/* Half the width of a sharp edge's ramp, in texels. */
#define CORE_EDGE_TEXELS 1.0

#endif
