#include "sun.h"

#include "pose.h"

#include <libnova/dynamical_time.h>
#include <libnova/julian_day.h>
#include <libnova/nutation.h>
#include <libnova/sidereal_time.h>
#include <libnova/solar.h>
#include <math.h>
#include <pthread.h>
#include <velum_weather/weather.h>

static const double DEG = 0.017453292519943295;

/* libnova 0.16 keeps its newest nutation and earth position in statics: one caller at a time. */
static pthread_mutex_t libnova_lock = PTHREAD_MUTEX_INITIALIZER;

/* Ecliptic longitude and latitude from the equinox of J2000 to that of the date (Meeus 1998, equations 21.5 to 21.7):
 * libnova 0.16 gives the sun in the former, and takes it for the latter. */
static void precess(double ephemeris_day, double *longitude_deg, double *latitude_deg) {
    double t = (ephemeris_day - 2451545.0) / 36525, sin_e, cos_e, sin_b, cos_b, sin_l, cos_l;
    double eta_deg = t * (47.0029 + t * (-0.03302 + t * 0.00006)) / 3600;
    double node_deg = 174.876384 + t * (-869.8089 + t * 0.03536) / 3600;
    double p_deg = t * (5029.0966 + t * (1.11113 - t * 0.000006)) / 3600;
    pose_sincos_deg(eta_deg, &sin_e, &cos_e);
    pose_sincos_deg(*latitude_deg, &sin_b, &cos_b);
    pose_sincos_deg(node_deg - *longitude_deg, &sin_l, &cos_l);
    double a = cos_e * cos_b * sin_l - sin_e * sin_b, b = cos_b * cos_l, c = cos_e * sin_b + sin_e * cos_b * sin_l;
    *longitude_deg = p_deg + node_deg - atan2(a, b) / DEG;
    *latitude_deg = asin(c) / DEG;
}

void sun_direction(double unix_s, double direction[3]) {
    struct ln_helio_posn sun = {0};
    struct ln_nutation nutation = {0};
    double julian_day = 2440587.5 + unix_s / 86400;

    pthread_mutex_lock(&libnova_lock);
    double ephemeris_day = ln_get_jde(julian_day);
    ln_get_nutation(ephemeris_day + 1000, &nutation); /* else a value up to 0.1 day old may come back */
    ln_get_nutation(ephemeris_day, &nutation);
    ln_get_solar_geom_coords(ephemeris_day, &sun);
    double sidereal_deg = ln_get_mean_sidereal_time(julian_day) * 15;
    pthread_mutex_unlock(&libnova_lock);

    precess(ephemeris_day, &sun.L, &sun.B);
    /* Meeus (1998), chapters 12 and 25. Aberration by hand: ln_get_solar_equ_coords takes 1/360 of it. */
    double longitude_deg = sun.L + nutation.longitude - 20.4898 / 3600 / sun.R;
    double obliquity_deg = nutation.ecliptic + nutation.obliquity;
    double sin_l, cos_l, sin_b, cos_b, sin_e, cos_e, sin_t, cos_t;
    pose_sincos_deg(obliquity_deg, &sin_e, &cos_e);
    pose_sincos_deg(longitude_deg, &sin_l, &cos_l);
    pose_sincos_deg(sun.B, &sin_b, &cos_b);
    pose_sincos_deg(sidereal_deg + nutation.longitude * cos_e, &sin_t, &cos_t);
    double x = cos_b * cos_l, y = cos_b * sin_l * cos_e - sin_b * sin_e;
    direction[0] = x * cos_t + y * sin_t;
    direction[1] = y * cos_t - x * sin_t;
    direction[2] = cos_b * sin_l * sin_e + sin_b * cos_e;
}

void velum_scenario_sun(const velum_scenario *scenario, double time_s, double direction[3]) {
    if (scenario->sun != VELUM_SCENARIO_SUN_FIXED) {
        sun_direction(scenario->start_unix_s + time_s, direction);
        return;
    }
    double east[3], north[3], up[3], sin_a, cos_a, sin_h, cos_h;
    const velum_scenario_camera origin = {0};
    const velum_scenario_camera *camera = scenario->camera_count ? &scenario->cameras[0] : &origin;
    pose_local_axes(camera->lat_deg, camera->lon_deg, east, north, up);
    pose_sincos_deg(scenario->sun_azimuth_deg, &sin_a, &cos_a);
    pose_sincos_deg(scenario->sun_elevation_deg, &sin_h, &cos_h);
    for (int i = 0; i < 3; i++) {
        direction[i] = cos_h * (sin_a * east[i] + cos_a * north[i]) + sin_h * up[i];
    }
}
