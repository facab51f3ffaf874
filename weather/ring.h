/* Rings of polygons, as they stand in files. */
#ifndef VELUM_WEATHER_RING_H
#define VELUM_WEATHER_RING_H

#include <stdint.h>
#include <velum/weather.h>

/* VELUM_OK: no two edges of the ring (without its closing position) cross, edges straight in latitude and longitude.
 * VELUM_ERROR_ARGUMENT: some do, *at says where. Touching is no crossing, nor is what overshoots by less than 0.1 m.
 * Rings whose edges lie so densely that the search would take more than linear time count as simple. */
velum_result weather_ring_check(const velum_lat_lon *points, uint32_t count, velum_lat_lon *at);

#endif
