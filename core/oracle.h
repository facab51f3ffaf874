/* What the weather is at a point and along a line: the picture's own density function, on the CPU. */
#ifndef VELUM_CORE_ORACLE_H
#define VELUM_CORE_ORACLE_H

#include "column.h"
#include "drift.h"
#include "geodesy.h"
#include "noise.h"
#include "result.h"
#include "tile.h"

/* The tile of a key, with a reference for the oracle; `state` is that of the weather. Null: out of memory. */
typedef core_tile *(*core_oracle_tile_fn)(void *context, const core_state *state, uint32_t key);

/* All that holds at one time. Lent: it must outlive the calls. */
typedef struct core_oracle {
    const core_noise *noise;
    const core_state *state[2]; /* null: no weather; the same where nothing blends */
    float blend;                /* share of state[1], 0..1 */
    core_drift drift;
    float detail; /* as in velum_tile_level */
    core_oracle_tile_fn tile;
    void *tile_context;
} core_oracle;

/* Footprint for the finest detail: 0. Tiles are those that a picture uses whose pixels are as large as the footprint
 * and a thousandth of their distance wide. */
#define CORE_ORACLE_PIXEL_RAD 0.001

typedef struct core_oracle_point {
    core_geodetic place;
    float slot_extinction_1_m[VELUM_SLOT_COUNT];
    float extinction_1_m; /* of cloud, its transition band, scud and precipitation */
    float water_g_m3;     /* of cloud proper, at the genus's usual radius */
    float coverage;       /* greatest of the layers over the place */
    float base_m, top_m;  /* MSL, of the lowest layer over the place; 0, 0: none */
    float visibility_m;   /* of air, haze, fog and cloud */
    float wind_ecef_m_s[3];
    float precipitation_mm_h;
    int32_t precipitation; /* VELUM_PRECIPITATION_* */
    float temperature_k;   /* surface; 0: not known */
    int32_t genus;         /* of the layer with most extinction, else of the lowest; 0: none */
} core_oracle_point;

/* VELUM_ERROR_ARGUMENT: not finite, or within 6000 km of the earth's centre. VELUM_ERROR_OUT_OF_MEMORY. */
velum_result core_oracle_at(const core_oracle *oracle, const double ecef_m[3], double footprint_m,
                            core_oracle_point *out, core_error *error);

/* Extinction of cloud, scud and precipitation alone: what an inner loop wants. */
velum_result core_oracle_extinction(const core_oracle *oracle, const double ecef_m[3], double footprint_m,
                                    float *extinction_1_m, core_error *error);

typedef struct core_oracle_line {
    double optical_depth; /* of cloud, within 1e-3 (relative, or absolute below 1) */
    bool has_contact;
    double first_contact_m; /* from `from`: where extinction first exceeds the threshold, within 1 m */
} core_oracle_line;

velum_result core_oracle_along(const core_oracle *oracle, const double from_m[3], const double to_m[3],
                               double footprint_m, float contact_1_m, core_oracle_line *out, core_error *error);

#endif
