/* Places and attitudes: WGS84, camera keyframes, channels. Directions and positions are ECEF. */
#ifndef VELUM_WEATHER_POSE_H
#define VELUM_WEATHER_POSE_H

#include <velum_weather/weather.h>

/* Exact at multiples of 90 degrees, so that poles are ordinary places. */
void pose_sincos_deg(double angle_deg, double *sine, double *cosine);

/* East, north and the ellipsoid's normal at a place. */
void pose_local_axes(double lat_deg, double lon_deg, double east[3], double north[3], double up[3]);

/* The inverse of velum_scenario_pose_ecef: longitude -180..180, heading 0..360 (excluded), roll -180..180; where pitch
 * is
 * +-90, roll is 0. time_s is left as it is. */
void pose_from_ecef(const double position_m[3], const double right[3], const double up[3], const double forward[3],
                    velum_scenario_camera *out);

/* From one keyframe (share 0) to the next (1). */
void pose_interpolate(const velum_scenario_camera *from, const velum_scenario_camera *to, double share,
                      velum_scenario_camera *out);

#endif
