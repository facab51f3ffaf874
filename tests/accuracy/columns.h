/* Columns of cloud over constant input: what share of a square is covered, by how much water, between which heights. */
#ifndef VELUM_TESTS_COLUMNS_H
#define VELUM_TESTS_COLUMNS_H

#include "core/cloud_sample.h"

typedef struct column_case {
    const char *name;
    int slot;
    float kind;
    float base_m, top_m;
    float extinction_1_m;
    float wind_m_s; /* along parallels */
} column_case;

/* Typical layers of the ten genera: heights and thicknesses of the mid-latitudes (WMO International Cloud Atlas), water
 * and radii after Hess et al. 1998. */
#define COLUMN_CASES 10
extern const column_case column_cases[COLUMN_CASES];

typedef struct column_stats {
    double coverage; /* share of columns whose vertical optical depth exceeds 0.5, or a tenth of the layer's nominal one
                        where that is less */
    double water;    /* mean water path over that asked for: coverage x water content x thickness */
    double base_error_m, top_error_m; /* 1st and 99th percentile of covered columns, less what was asked for */
} column_stats;

/* n x n columns over a square around a place, `steps` points in each. False: out of memory. */
bool columns_measure(const core_noise *noise, const column_case *of, float coverage, double lat_deg, double lon_deg,
                     double side_m, int n, int steps, column_stats *out);

/* The same over the whole of the noise, ranks taken evenly: what calibration goes by. */
bool columns_measure_anywhere(const core_noise *noise, const column_case *of, float coverage, int count, int steps,
                              column_stats *out);

#endif
