/* WGS84. geodesy.cpp holds what GeographicLib computes; the closed forms inline below are for inner loops. */
#ifndef VELUM_CORE_GEODESY_H
#define VELUM_CORE_GEODESY_H

#include <math.h>
#include <stdbool.h>

#include "shared/planet.h"

#ifdef __cplusplus
extern "C" {
#endif

#define CORE_WGS84_A_M 6378137.0
#define CORE_WGS84_F (1.0 / 298.257223563)
#define CORE_WGS84_E2 (CORE_WGS84_F * (2.0 - CORE_WGS84_F))
#define CORE_WGS84_B_M (CORE_WGS84_A_M * (1.0 - CORE_WGS84_F))
#define CORE_PI 3.14159265358979323846
#define CORE_DEG (CORE_PI / 180.0)
#define CORE_RADIUS_M 6371008.8 /* mean of the axes, (2a + b) / 3 */

typedef struct core_geodetic {
    double lat_deg, lon_deg; /* lon -180..180 */
    double height_m;         /* HAE */
} core_geodetic;

/* By GeographicLib. False: not finite, or the library refused; the output is then zeroed. */
bool core_ecef_from_geodetic(const core_geodetic *place, double ecef_m[3]);
bool core_geodetic_from_ecef(const double ecef_m[3], core_geodetic *place);
/* The shortest geodesic from 1 to 2: distance and azimuth at 1, clockwise from north. */
bool core_geodesic_inverse(double lat1_deg, double lon1_deg, double lat2_deg, double lon2_deg, double *distance_m,
                           double *azimuth_deg);
bool core_geodesic_direct(double lat1_deg, double lon1_deg, double azimuth_deg, double distance_m, double *lat2_deg,
                          double *lon2_deg);

/* The eye as shaders want it: formed in double, rounded once. */
bool core_eye_geometry(const double ecef_m[3], velum_eye_geometry *out);

/* Height above the ellipsoid, in double, by the scaled sphere: z times a/b turns the ellipsoid into a sphere of radius
 * a. Within 0.4 mm at 20 km of the exact height, at every latitude. */
double core_height_scaled(const double ecef_m[3]);

/* Of finite numbers: fmin and fmax, which look at NaN, are calls. */
static inline double core_min(double a, double b) {
    return a < b ? a : b;
}
static inline double core_max(double a, double b) {
    return a > b ? a : b;
}

/* Geodetic normal of a latitude and longitude. */
static inline void core_normal(double lat_deg, double lon_deg, double normal[3]) {
    double cos_lat = cos(lat_deg * CORE_DEG);
    normal[0] = cos_lat * cos(lon_deg * CORE_DEG);
    normal[1] = cos_lat * sin(lon_deg * CORE_DEG);
    normal[2] = sin(lat_deg * CORE_DEG);
}
static inline double core_normal_lat_deg(const double normal[3]) {
    return atan2(normal[2], sqrt(normal[0] * normal[0] + normal[1] * normal[1])) / CORE_DEG;
}
static inline double core_normal_lon_deg(const double normal[3]) {
    return atan2(normal[1], normal[0]) / CORE_DEG;
}
/* ECEF of the point at height (HAE) over the place with that normal. */
static inline void core_position(const double normal[3], double height_m, double ecef_m[3]) {
    double n = CORE_WGS84_A_M / sqrt(1.0 - CORE_WGS84_E2 * normal[2] * normal[2]);
    ecef_m[0] = (n + height_m) * normal[0];
    ecef_m[1] = (n + height_m) * normal[1];
    ecef_m[2] = (n * (1.0 - CORE_WGS84_E2) + height_m) * normal[2];
}
/* East and north at a place; at a pole east is that of longitude 0. */
static inline void core_east_north(const double normal[3], double east[3], double north[3]) {
    double p = sqrt(normal[0] * normal[0] + normal[1] * normal[1]);
    double c = p > 1e-15 ? normal[0] / p : 1.0;
    double s = p > 1e-15 ? normal[1] / p : 0.0;
    east[0] = -s;
    east[1] = c;
    east[2] = 0.0;
    north[0] = -normal[2] * c;
    north[1] = -normal[2] * s;
    north[2] = p;
}

#ifdef __cplusplus
}
#endif
#endif
