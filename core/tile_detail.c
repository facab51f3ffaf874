#include "tile_detail.h"

#include "geodesy.h"
#include "state_private.h"

#include <math.h>

/* A coarser tile blurs an edge by one texel of ramp and one of interpolation; it may stand for a place only if the edge
 * is farther away than so many of its texels. */
#define CLEAR_TEXELS 2.5

core_tile_cap core_tile_cap_of(uint32_t key) {
    core_tile_cap cap = {.level = velum_tile_key_level(key)};
    core_tile_normal(key, 0.5, 0.5, cap.normal);
    for (uint32_t corner = 0; corner < 4; corner++) {
        double chord2 = 0.0;
        double *n = cap.corner[corner];
        core_tile_normal(key, corner & 1u ? 1.0 : 0.0, corner & 2u ? 1.0 : 0.0, n);
        for (int i = 0; i < 3; i++) {
            chord2 += (n[i] - cap.normal[i]) * (n[i] - cap.normal[i]);
        }
        cap.radius_m = fmax(cap.radius_m, 2.0 * CORE_RADIUS_M * asin(fmin(0.5 * sqrt(chord2), 1.0)));
    }
    cap.radius_m *= 1.01;
    return cap;
}

uint32_t core_level_of_texel(double texel_m) {
    double level = ceil(log2(core_tile_texel_m(0) / fmax(texel_m, 1.0)));
    return (uint32_t)fmin(fmax(level, 0.0), (double)VELUM_TILE_LEVEL_MAX);
}

static double cap_distance_m(const core_cell *cell, const core_tile_cap *cap) {
    double chord2 = 0.0;
    for (int i = 0; i < 3; i++) {
        double d = cell->cap_normal[i] - cap->normal[i];
        chord2 += d * d;
    }
    return 2.0 * CORE_RADIUS_M * asin(fmin(0.5 * sqrt(chord2), 1.0)) * 0.99 - cap->radius_m - cell->reach_m;
}

bool core_cell_matters(const core_cell *cell, const core_tile_cap *cap) {
    return cell->fields.flags & VELUM_CELL_HAS_LAYERS &&
           cap_distance_m(cell, cap) <= CLEAR_TEXELS * core_tile_texel_m(VELUM_TILE_DATA_LEVEL_MIN);
}

bool core_cell_touches(const core_cell *cell, const core_tile_cap *cap) {
    return cell->fields.flags & VELUM_CELL_HAS_LAYERS && cap_distance_m(cell, cap) <= 0.0;
}

/* The texel that a station or region asks for over the cap. */
static double cell_texel_m(const core_cell *cell, const core_tile_cap *cap, double lat_deg, double lon_deg) {
    double reach_m = CLEAR_TEXELS * core_tile_texel_m(VELUM_TILE_DATA_LEVEL_MIN) + cap->radius_m;
    double own_m;
    double gap_m;
    if (cell->kind == VELUM_CELL_STATION) {
        own_m = cell->radius_m / 8.0;
        gap_m = core_cell_point_distance_m(cell, cap->normal) - cell->radius_m;
    } else {
        double distance_m =
            core_cell_region_distance_m(cell, cap->normal, lat_deg, lon_deg, reach_m + cell->transition_m);
        /* Storms end in less than half of it (core_blend_coverage). */
        own_m = cell->transition_m / (cell->fields.slot_mask & (1u << VELUM_SLOT_STORM) ? 8.0 : 4.0);
        gap_m = distance_m < 0.0 ? -distance_m : distance_m - cell->transition_m;
    }
    return fmax(own_m, (gap_m * 0.99 - cap->radius_m) / CLEAR_TEXELS);
}

uint32_t core_detail_level(const core_state *state, const uint32_t *cells, uint32_t count, const core_tile_cap *cap) {
    uint32_t most = cap->level;
    uint32_t level = most < VELUM_TILE_DATA_LEVEL_MIN ? most : VELUM_TILE_DATA_LEVEL_MIN;
    double lat_deg = core_normal_lat_deg(cap->normal);
    double lon_deg = core_normal_lon_deg(cap->normal);
    if (state->grid && state->grid->slot_mask) {
        double highest_deg = fmin(fabs(lat_deg) + cap->radius_m / (CORE_RADIUS_M * CORE_DEG), 90.0);
        double gap_m = (fabs(core_grid_border_m(state->grid, lat_deg, lon_deg)) * 0.99 - cap->radius_m) / CLEAR_TEXELS;
        double texel_m = fmin(core_grid_texel_m(state->grid, highest_deg), gap_m);
        uint32_t wanted = core_level_of_texel(texel_m);
        level = level > wanted ? level : wanted;
    }
    if (state->first_station > 0) {
        double gap_m = (90.0 - CORE_POLE_FADE_DEG - fabs(lat_deg)) * CORE_DEG * CORE_RADIUS_M - cap->radius_m;
        uint32_t wanted = core_level_of_texel(fmax(CORE_POLE_FADE_TEXEL_M, gap_m / CLEAR_TEXELS));
        level = level > wanted ? level : wanted;
    }
    for (uint32_t i = 0; i < count && level < most; i++) {
        const core_cell *cell = state->cells[cells[i]];
        if (core_cell_matters(cell, cap)) {
            uint32_t wanted = core_level_of_texel(cell_texel_m(cell, cap, lat_deg, lon_deg));
            level = level > wanted ? level : wanted;
        }
    }
    return level < most ? level : most;
}

uint32_t core_tile_detail_level(const core_state *state, uint32_t key) {
    core_tile_cap cap = core_tile_cap_of(key);
    uint32_t level = core_detail_level(state, NULL, 0, &cap);
    for (uint32_t i = state->first_station; i < state->cell_count && level < cap.level; i++) {
        uint32_t wanted = core_detail_level(state, &i, 1, &cap);
        level = level > wanted ? level : wanted;
    }
    return level;
}
