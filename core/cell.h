/* One cell, checked and made ready for evaluation. Private to core's state, column and tiles. */
#ifndef VELUM_CORE_CELL_H
#define VELUM_CORE_CELL_H

#include <stdatomic.h>
#include <stdint.h>
#include <velum/weather.h>

#include "polygon.h"
#include "result.h"
#include "slots.h"

#define CORE_CELL_V1_SIZE 176u
#define CORE_LAYER_V1_SIZE 72u
#define CORE_CELL_MAX_LAYERS 16u
#define CORE_STATION_RADIUS_M 60000.0

/* The fields of one slot, each but the first times coverage: sums of them blend linearly. */
enum {
    CORE_FIELD_COVERAGE,
    CORE_FIELD_BASE,
    CORE_FIELD_TOP,
    CORE_FIELD_LOG_EXTINCTION,
    CORE_FIELD_WIND_X, /* ECEF; of global cells: east */
    CORE_FIELD_WIND_Y, /*                        north */
    CORE_FIELD_WIND_Z,
    CORE_FIELD_KIND,
    CORE_FIELD_FULL, /* the coverage that the layer has where its cell acts alone */
    CORE_FIELD_SCUD,
    CORE_FIELD_TRANSITION,
    CORE_FIELD_FALL,      /* fourth root of the rate, (mm/h)^1/4 */
    CORE_FIELD_FALL_KIND, /* VELUM_FALL_*, times that */
    CORE_FIELD_COUNT
};

typedef struct core_cell_slot {
    uint32_t slot;
    float field[CORE_FIELD_COUNT];
} core_cell_slot;

/* Properties of the surface, linear. */
enum {
    CORE_SURFACE_LOG_VISIBILITY,
    CORE_SURFACE_FOG_TOP,
    CORE_SURFACE_ELEVATION,
    CORE_SURFACE_WIND_X,
    CORE_SURFACE_WIND_Y,
    CORE_SURFACE_WIND_Z,
    CORE_SURFACE_GUST,
    CORE_SURFACE_TEMPERATURE,
    CORE_SURFACE_TEMPERATURE_KNOWN,
    CORE_SURFACE_DEW_POINT,
    CORE_SURFACE_DEW_POINT_KNOWN,
    CORE_SURFACE_THUNDERSTORM,
    CORE_SURFACE_PRECIPITATION, /* by kind, six */
    CORE_SURFACE_COUNT = CORE_SURFACE_PRECIPITATION + 6
};

typedef struct core_cell_fields {
    uint32_t flags;     /* VELUM_CELL_*; HAS_PRECIPITATION also where the layers decide on it */
    uint8_t slot_count; /* entries */
    uint8_t slot_mask;
    uint16_t reserved;
    uint32_t first_slot; /* in the owner's array */
    float surface[CORE_SURFACE_COUNT];
} core_cell_fields;

typedef struct core_cell {
    atomic_uint references;
    uint64_t id;
    int32_t kind, priority;
    double lat_deg, lon_deg;
    double normal[3];
    double position_m[3];
    double east[3], north[3];
    double radius_m; /* station */
    double half_east_m, half_north_m, corner_m, sin_rotation, cos_rotation;
    double transition_m;
    double breadth_m; /* a sharp edge's ramp is never wider to either side than this */
    double reach_m;   /* no effect farther than this from normal, along the sphere */
    double cap_normal[3];
    core_polygon *polygon;
    core_cell_fields fields;
    core_slot_layer uniform[2];  /* what UNIFORM slots need beside their fields */
    float min_base_m, max_top_m; /* MSL, fringes too; min > max: no cloud */
    uint32_t merged;
    uint32_t slot_count;
    core_cell_slot slots[VELUM_SLOT_COUNT];
} core_cell;

/* Reads and checks a cell. `where` names it in errors ("cell 12", "grid row 3, column 5"). `slots` (room for
 * VELUM_SLOT_COUNT) and `fields` receive what it says; winds as ECEF at the place (lat, lon), or east and north if
 * `global`. */
typedef struct core_cell_reading {
    velum_cell cell;
    core_slot_layers layers;
    core_cell_fields fields;
    core_cell_slot slots[VELUM_SLOT_COUNT];
    uint32_t slot_count;
    float min_base_m, max_top_m;
} core_cell_reading;
velum_result core_cell_read(core_cell_reading *reading, const velum_cell *cell, bool grid_node, double lat_deg,
                            double lon_deg, const char *where, core_error *error);

/* A standalone cell (global, station, region). */
velum_result core_cell_create(const velum_cell *cell, core_cell **out, core_error *error);
core_cell *core_cell_ref(core_cell *cell);
void core_cell_unref(core_cell *cell);
size_t core_cell_bytes(const core_cell *cell);

/* Rank (global 0, station 1, region 2), priority, id. */
int core_cell_compare(const core_cell *a, const core_cell *b);

/* Signed distance of a place to the edge of a region, m, negative inside, exact within reach_m and no less than it
 * beyond. Latitude and longitude are read for polygons only. */
double core_cell_region_distance_m(const core_cell *cell, const double normal[3], double lat_deg, double lon_deg,
                                   double reach_m);
/* Great-circle distance of a place to the cell's own point. */
double core_cell_point_distance_m(const core_cell *cell, const double normal[3]);

#endif
