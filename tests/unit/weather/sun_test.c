#include "sun.h"

#include "pose.h"
#include "scenario.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "near.h"

static const double DEG = 0.017453292519943295;

/* Declination and the longitude of the subsolar point (with geocentric latitude = declination). */
static void subsolar(const char *utc, double *declination_deg, double *lon_deg) {
    double unix_s = 0, d[3];
    assert_true(scenario_parse_utc(utc, &unix_s));
    sun_direction(unix_s, d);
    assert_near(d[0] * d[0] + d[1] * d[1] + d[2] * d[2], 1, 1e-12);
    *declination_deg = asin(d[2]) / DEG;
    *lon_deg = atan2(d[1], d[0]) / DEG;
}

static double hms(double h, double m, double s) {
    return (h + m / 60 + s / 3600) * 15;
}

/* Meeus, Astronomical Algorithms (1998), example 25.b: 1992 October 13, 0h TD (59 s later than UTC): apparent
 * alpha = 13h13m30.749s, delta = -7d47'01.74"; sidereal time at Greenwich from his expression 12.4 (mean) less 1.0 s.
 */
static void agrees_with_meeus(void **state) {
    (void)state;
    double declination_deg, lon_deg;
    subsolar("1992-10-12T23:59:01Z", &declination_deg, &lon_deg);
    double days = 2448908.5 - 59.0 / 86400 - 2451545.0;
    double sidereal_deg = fmod(280.46061837 + 360.98564736629 * days, 360) + 360;
    double expected = hms(13, 13, 30.749) - sidereal_deg;
    assert_near(declination_deg, -(7 + 47 / 60.0 + 1.74 / 3600), 0.0005);
    assert_near(remainder(lon_deg - expected, 360), 0, 0.006); /* equation of the equinoxes: below 0.0053 */
}

/* Equinoxes and solstices, UTC to the minute (U.S. Naval Observatory, Earth's Seasons). */
static void seasons_begin_on_time(void **state) {
    (void)state;
    double declination_deg, lon_deg;
    subsolar("2024-03-20T03:06:00Z", &declination_deg, &lon_deg);
    assert_near(declination_deg, 0, 0.001);
    subsolar("2024-09-22T12:44:00Z", &declination_deg, &lon_deg);
    assert_near(declination_deg, 0, 0.001);
    subsolar("2024-06-20T20:51:00Z", &declination_deg, &lon_deg);
    assert_near(declination_deg, 23.4383, 0.002);
    subsolar("2014-12-21T23:03:00Z", &declination_deg, &lon_deg);
    assert_near(declination_deg, -23.4354, 0.003);
}

/* The equation of time is within 0.1 minute of zero about 15 April, and 16.4 minutes about 3 November (Meeus, ch. 28).
 */
static void noon_follows_the_equation_of_time(void **state) {
    (void)state;
    double declination_deg, lon_deg;
    subsolar("2023-04-15T14:00:00Z", &declination_deg, &lon_deg);
    assert_near(lon_deg, -30, 0.05);
    subsolar("2023-11-03T12:00:00Z", &declination_deg, &lon_deg);
    assert_near(lon_deg, -16.45 / 4, 0.02);
    subsolar("2023-11-03T06:00:00Z", &declination_deg, &lon_deg);
    assert_true(lon_deg > 85.7 && lon_deg < 86.1); /* in the east in the morning */
}

/* NREL, Solar Position Algorithm (Reda and Andreas 2004), appendix A.5: 2003-10-17 19:30:30 UTC, 39.742476 N,
 * 105.1786 W, 1830.14 m: topocentric zenith without the refraction of 0.0163 degree: 50.11162 + 0.01633; azimuth
 * 194.34024. Ours is geocentric: parallax is below 0.0025 degree. */
static void agrees_with_the_solar_position_algorithm(void **state) {
    (void)state;
    double unix_s = 0, d[3], east[3], north[3], up[3];
    assert_true(scenario_parse_utc("2003-10-17T19:30:30Z", &unix_s));
    sun_direction(unix_s, d);
    pose_local_axes(39.742476, -105.1786, east, north, up);
    double e = 0, n = 0, u = 0;
    for (int i = 0; i < 3; i++) {
        e += d[i] * east[i];
        n += d[i] * north[i];
        u += d[i] * up[i];
    }
    assert_near(90 - asin(u) / DEG, 50.12795, 0.01);
    assert_near(fmod(atan2(e, n) / DEG + 360, 360), 194.34024, 0.01);
}

/* libnova remembers: what was asked before must not show. */
static void the_same_time_gives_the_same_bits(void **state) {
    (void)state;
    double a[3], b[3], other[3];
    sun_direction(1.4e9, a);
    sun_direction(1.4e9 + 4000, other);
    sun_direction(1.4e9, b);
    assert_memory_equal(a, b, sizeof a);
    sun_direction(1.4e9 - 4000, other);
    sun_direction(1.4e9, b);
    assert_memory_equal(a, b, sizeof a);
    sun_direction(-3e9, other);
    sun_direction(1.4e9, b);
    assert_memory_equal(a, b, sizeof a);
}

static void a_fixed_sun_stays(void **state) {
    (void)state;
    velum_scenario_camera cameras[] = {{.lat_deg = 0, .lon_deg = 0}, {.time_s = 10, .lat_deg = 40, .lon_deg = 50}};
    velum_scenario scenario = {.sun = VELUM_SCENARIO_SUN_FIXED,
                               .sun_azimuth_deg = 90,
                               .sun_elevation_deg = 30,
                               .cameras = cameras,
                               .camera_count = 2};
    double a[3], b[3];
    velum_scenario_sun(&scenario, 0, a);
    assert_near(a[0], 0.5, 1e-15);
    assert_near(a[1], sqrt(0.75), 1e-15);
    assert_near(a[2], 0, 1e-15);
    velum_scenario_sun(&scenario, 10, b);
    assert_memory_equal(a, b, sizeof a);
}

static void a_computed_sun_moves_west(void **state) {
    (void)state;
    velum_scenario scenario = {.start_unix_s = 1418889600};
    double a[3], b[3];
    velum_scenario_sun(&scenario, 0, a);
    velum_scenario_sun(&scenario, 3600, b);
    double turned = remainder(atan2(b[1], b[0]) - atan2(a[1], a[0]), 6.283185307179586) / DEG;
    assert_near(turned, -15, 0.02);
    sun_direction(1418889600 + 3600, a);
    assert_memory_equal(a, b, sizeof a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(agrees_with_meeus),
        cmocka_unit_test(seasons_begin_on_time),
        cmocka_unit_test(noon_follows_the_equation_of_time),
        cmocka_unit_test(agrees_with_the_solar_position_algorithm),
        cmocka_unit_test(the_same_time_gives_the_same_bits),
        cmocka_unit_test(a_fixed_sun_stays),
        cmocka_unit_test(a_computed_sun_moves_west),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
