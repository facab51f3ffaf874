#include "pose.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "near.h"

static void assert_vector(const double found[3], double x, double y, double z, double epsilon) {
    assert_near(found[0], x, epsilon);
    assert_near(found[1], y, epsilon);
    assert_near(found[2], z, epsilon);
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void assert_right_handed(const double right[3], const double up[3], const double forward[3]) {
    assert_near(dot(right, right), 1, 1e-13);
    assert_near(dot(up, up), 1, 1e-13);
    assert_near(dot(forward, forward), 1, 1e-13);
    assert_near(dot(right, up), 0, 1e-13);
    for (int i = 0; i < 3; i++) { /* right x up = -forward */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        assert_near(right[j] * up[k] - right[k] * up[j], -forward[i], 1e-13);
    }
}

/* Known corners of the ellipsoid: a = 6378137 m, b = 6356752.314245 m. */
static void positions_follow_wgs84(void **state) {
    (void)state;
    double p[3], r[3], u[3], f[3];
    velum_scenario_camera pose = {.height_m = 100};
    velum_scenario_pose_ecef(&pose, p, r, u, f);
    assert_vector(p, 6378237, 0, 0, 1e-6);
    assert_vector(r, 0, 1, 0, 0); /* heading north: right is east, forward is the pole, up is x */
    assert_vector(u, 1, 0, 0, 0);
    assert_vector(f, 0, 0, 1, 0);
    pose.lat_deg = 90;
    velum_scenario_pose_ecef(&pose, p, r, u, f);
    assert_vector(p, 0, 0, 6356752.314245 + 100, 1e-5);
    assert_near(p[0], 0, 0);
    /* EPSG guidance note 7-2 (method 9602): 53d48'33.820" N, 2d07'46.380" E, 73.0 m */
    pose = (velum_scenario_camera){
        .lat_deg = 53 + 48 / 60.0 + 33.820 / 3600, .lon_deg = 2 + 7 / 60.0 + 46.380 / 3600, .height_m = 73};
    velum_scenario_pose_ecef(&pose, p, r, u, f);
    assert_vector(p, 3771793.968, 140253.342, 5124304.349, 2e-3);
}

static void attitudes_turn_the_right_way(void **state) {
    (void)state;
    double p[3], r[3], u[3], f[3];
    const double s = sin(0.1), c = cos(0.1), deg = 0.1 * 57.29577951308232;
    /* at lat 0, lon 0: east y, north z, up x */
    velum_scenario_camera east = {.heading_deg = 90};
    velum_scenario_pose_ecef(&east, p, r, u, f);
    assert_vector(f, 0, 1, 0, 0);
    assert_vector(r, 0, 0, -1, 0);
    velum_scenario_camera climbing = {.pitch_deg = deg};
    velum_scenario_pose_ecef(&climbing, p, r, u, f);
    assert_vector(f, s, 0, c, 1e-15);
    assert_vector(r, 0, 1, 0, 1e-15);
    velum_scenario_camera banking = {.roll_deg = deg};
    velum_scenario_pose_ecef(&banking, p, r, u, f);
    assert_vector(r, -s, c, 0, 1e-15); /* the right wing is down */
    assert_vector(u, c, s, 0, 1e-15);
    velum_scenario_camera all = {.lat_deg = -33, .lon_deg = 151, .heading_deg = 217, .pitch_deg = -12, .roll_deg = 140};
    velum_scenario_pose_ecef(&all, p, r, u, f);
    assert_right_handed(r, u, f);
}

static void poses_come_back_from_ecef(void **state) {
    (void)state;
    static const double latitudes[] = {-90, -89.9999, -60, -0.001, 0, 33.3, 89, 89.99999, 90};
    static const double longitudes[] = {-180, -179.99, -45, 0, 10, 90, 179.5};
    static const double headings[] = {0, 45, 180, 271, 359.5};
    static const double pitches[] = {-90, -80, 0, 5, 89.9, 90};
    static const double heights[] = {-100, 0, 11000, 4e7};
    for (unsigned i = 0; i < 9 * 7 * 5 * 6 * 4; i++) {
        unsigned n = i;
        velum_scenario_camera pose = {.lat_deg = latitudes[n % 9], .roll_deg = -30};
        pose.lon_deg = longitudes[(n /= 9) % 7];
        pose.heading_deg = headings[(n /= 7) % 5];
        pose.pitch_deg = pitches[(n /= 5) % 6];
        pose.height_m = heights[(n /= 6) % 4];
        double p[3], r[3], u[3], f[3], p2[3], r2[3], u2[3], f2[3];
        velum_scenario_camera back = {0};
        velum_scenario_pose_ecef(&pose, p, r, u, f);
        pose_from_ecef(p, r, u, f, &back);
        velum_scenario_pose_ecef(&back, p2, r2, u2, f2);
        assert_vector(p2, p[0], p[1], p[2], 1e-7);
        assert_vector(r2, r[0], r[1], r[2], 1e-9);
        assert_vector(u2, u[0], u[1], u[2], 1e-9);
        assert_vector(f2, f[0], f[1], f[2], 1e-9);
        assert_near(back.lat_deg, pose.lat_deg, 1e-12);
        assert_near(back.height_m, pose.height_m, 1e-7);
        assert_true(back.heading_deg >= 0 && back.heading_deg < 360);
        if (fabs(pose.lat_deg) < 90) {
            assert_near(fmod(back.lon_deg - pose.lon_deg + 360, 360), 0, 1e-9);
            if (fabs(pose.pitch_deg) < 90) {
                assert_near(fmod(back.heading_deg - pose.heading_deg + 540, 360), 180, 1e-6);
                assert_near(back.roll_deg, -30, 1e-6);
            }
        }
    }
}

static void channels_turn_in_the_body_frame(void **state) {
    (void)state;
    const double s = sin(0.2), c = cos(0.2), deg = 0.2 * 57.29577951308232;
    const double r0[3] = {1, 0, 0}, u0[3] = {0, 1, 0}, f0[3] = {0, 0, -1};
    double r[3], u[3], f[3];
    velum_scenario_channel yaw = {.yaw_deg = deg}, pitch = {.pitch_deg = deg}, roll = {.roll_deg = deg};
    velum_scenario_channel_axes(&yaw, r0, u0, f0, r, u, f);
    assert_vector(f, s, 0, -c, 1e-15);
    assert_vector(r, c, 0, s, 1e-15);
    velum_scenario_channel_axes(&pitch, r0, u0, f0, r, u, f);
    assert_vector(f, 0, s, -c, 1e-15);
    assert_vector(u, 0, c, s, 1e-15);
    velum_scenario_channel_axes(&roll, r0, u0, f0, r, u, f);
    assert_vector(r, c, -s, 0, 1e-15);
    velum_scenario_channel all = {.yaw_deg = -130, .pitch_deg = 40, .roll_deg = 77};
    velum_scenario_channel_axes(&all, r0, u0, f0, r, u, f);
    assert_right_handed(r, u, f);
    /* in place */
    memcpy(r, r0, sizeof r), memcpy(u, u0, sizeof u), memcpy(f, f0, sizeof f);
    velum_scenario_channel_axes(&yaw, r, u, f, r, u, f);
    assert_vector(f, s, 0, -c, 1e-15);
}

/* Three views of 40 degrees at yaw -40, 0, 40 meet edge to edge. */
static void neighbouring_channels_meet(void **state) {
    (void)state;
    const double edge = tan(20 / 57.29577951308232);
    double p[3], er[3], eu[3], ef[3], r[3], u[3], f[3];
    velum_scenario_camera pose = {.lat_deg = 50, .lon_deg = 8, .heading_deg = 70, .pitch_deg = 3, .roll_deg = 10};
    velum_scenario_channel right = {.yaw_deg = 40};
    velum_scenario_pose_ecef(&pose, p, er, eu, ef);
    velum_scenario_channel_axes(&right, er, eu, ef, r, u, f);
    for (int i = 0; i < 3; i++) {
        assert_near(f[i] - r[i] * edge, ef[i] + er[i] * edge, 1e-14);
    }
}

static velum_scenario_camera at(const velum_scenario_camera *cameras, uint32_t count, double time_s) {
    velum_scenario scenario = {.cameras = (velum_scenario_camera *)cameras, .camera_count = count};
    velum_scenario_camera out;
    velum_scenario_pose(&scenario, time_s, &out);
    assert_near(out.time_s, time_s, 0);
    return out;
}

static void keyframes_hold_and_are_met(void **state) {
    (void)state;
    const velum_scenario_camera keys[] = {
        {.time_s = 10, .lat_deg = 50, .lon_deg = 8, .height_m = 300, .heading_deg = 350, .pitch_deg = 1, .roll_deg = 2},
        {.time_s = 20, .lat_deg = 51, .lon_deg = 9, .height_m = 500, .heading_deg = 10},
        {.time_s = 40, .lat_deg = 51, .lon_deg = 10, .height_m = 500, .heading_deg = 90}};
    assert_near(at(keys, 3, -5).lat_deg, 50, 0);
    assert_near(at(keys, 3, 10).heading_deg, 350, 0);
    assert_near(at(keys, 3, 20).lon_deg, 9, 0);
    assert_near(at(keys, 3, 99).heading_deg, 90, 0);
    velum_scenario_camera half = at(keys, 3, 15);
    assert_near(half.height_m, 400, 1e-9);
    assert_near(half.lat_deg, 50.5, 0.01);
    assert_near(fmod(half.heading_deg + 180, 360), 180, 1); /* through north, the short way */
    velum_scenario_camera before = at(keys, 3, 20 - 1e-6), after = at(keys, 3, 20 + 1e-6);
    assert_near(before.lat_deg, after.lat_deg, 1e-6);
    assert_near(before.heading_deg, after.heading_deg, 1e-4);
    assert_true(isfinite(at(keys, 1, 15).lat_deg) && at(keys, 1, 15).lat_deg == 50);
}

static void ways_lead_over_antimeridian_and_pole(void **state) {
    (void)state;
    const velum_scenario_camera fiji[] = {{.time_s = 0, .lat_deg = -17, .lon_deg = 179, .heading_deg = 90},
                                          {.time_s = 2, .lat_deg = -17, .lon_deg = -179, .heading_deg = 90}};
    assert_near(fabs(at(fiji, 2, 1).lon_deg), 180, 1e-9);
    assert_near(at(fiji, 2, 0.5).lon_deg, 179.5, 1e-3);
    assert_near(at(fiji, 2, 1.5).lon_deg, -179.5, 1e-3);

    const velum_scenario_camera pole[] = {
        {.time_s = 0, .lat_deg = 89, .lon_deg = 30, .height_m = 1000, .heading_deg = 0, .pitch_deg = 0},
        {.time_s = 2, .lat_deg = 89, .lon_deg = -150, .height_m = 1000, .heading_deg = 180, .pitch_deg = 0}};
    velum_scenario_camera top = at(pole, 2, 1);
    assert_near(top.lat_deg, 90, 1e-9);
    assert_near(top.pitch_deg, 0, 1e-9);
    velum_scenario_camera quarter = at(pole, 2, 0.5);
    assert_near(quarter.lat_deg, 89.5, 1e-9);
    assert_near(quarter.lon_deg, 30, 1e-9);
    assert_near(quarter.pitch_deg, 0, 1e-9);
    assert_near(fmod(quarter.heading_deg + 180, 360), 180, 1e-6);
    velum_scenario_camera beyond = at(pole, 2, 1.5);
    assert_near(beyond.lon_deg, -150, 1e-9);
    assert_near(beyond.heading_deg, 180, 1e-6);
    /* straight ahead all the way: the forward axis turns evenly in one plane */
    double p[3], r[3], u[3], f[3], f2[3];
    for (double t = 0; t < 1.95; t += 0.1) {
        velum_scenario_camera a = at(pole, 2, t), b = at(pole, 2, t + 0.05);
        velum_scenario_pose_ecef(&a, p, r, u, f);
        velum_scenario_pose_ecef(&b, p, r, u, f2);
        assert_near(acos(fmin(1, dot(f, f2))) * 57.29577951308232, 0.05, 1e-4);
    }
}

static void opposite_keyframes_stay_finite(void **state) {
    (void)state;
    const velum_scenario_camera keys[] = {
        {.time_s = 0, .lat_deg = 0, .lon_deg = 0, .heading_deg = 0, .pitch_deg = 90},
        {.time_s = 1, .lat_deg = 0, .lon_deg = 180, .heading_deg = 180},
        {.time_s = 2, .lat_deg = 90, .lon_deg = 0, .heading_deg = 0},
        {.time_s = 3, .lat_deg = -90, .lon_deg = 0, .heading_deg = 0, .roll_deg = 180}};
    for (double t = 0; t <= 3; t += 0.03125) {
        velum_scenario_camera pose = at(keys, 4, t);
        double p[3], r[3], u[3], f[3];
        assert_true(isfinite(pose.lat_deg) && isfinite(pose.lon_deg) && isfinite(pose.heading_deg) &&
                    isfinite(pose.pitch_deg) && isfinite(pose.roll_deg));
        velum_scenario_pose_ecef(&pose, p, r, u, f);
        assert_right_handed(r, u, f);
    }
    velum_scenario scenario = {.cameras = (velum_scenario_camera *)keys, .camera_count = 4};
    velum_scenario_camera first;
    velum_scenario_pose(&scenario, NAN, &first);
    assert_near(first.pitch_deg, 90, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(positions_follow_wgs84),
        cmocka_unit_test(attitudes_turn_the_right_way),
        cmocka_unit_test(poses_come_back_from_ecef),
        cmocka_unit_test(channels_turn_in_the_body_frame),
        cmocka_unit_test(neighbouring_channels_meet),
        cmocka_unit_test(keyframes_hold_and_are_met),
        cmocka_unit_test(ways_lead_over_antimeridian_and_pole),
        cmocka_unit_test(opposite_keyframes_stay_finite),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
