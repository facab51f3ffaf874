/* Polygons whose edges are straight in latitude and longitude (RFC 7946): inside by even-odd, distance to the edge. */
#ifndef VELUM_CORE_POLYGON_H
#define VELUM_CORE_POLYGON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <velum/weather.h>

typedef struct core_polygon core_polygon;

typedef struct core_lat_lon_box {
    double south, north, west, east; /* degrees; west <= east, longitudes as the polygon gives them */
} core_lat_lon_box;

/* Rings must be checked before. Null: out of memory. Edges along the antimeridian that two parts of one polygon share,
 * and edges along a pole, are no boundary. */
core_polygon *core_polygon_create(const velum_lat_lon *points, const uint32_t *ring_sizes, uint32_t ring_count);
void core_polygon_destroy(core_polygon *polygon);

size_t core_polygon_bytes(const core_polygon *polygon);
/* Area over perimeter, m: at most the inradius (half the width of a strip, a quarter of a square's side). */
double core_polygon_breadth_m(const core_polygon *polygon);
double core_polygon_longest_edge_m(const core_polygon *polygon);

/* Signed distance from a place to the boundary, m, negative inside; beyond +-reach_m just +-reach_m. The metric is that
 * of the ellipsoid at the place. */
double core_polygon_distance_m(const core_polygon *polygon, double lat_deg, double lon_deg, double reach_m);

#endif
