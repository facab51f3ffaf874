/* The host's ground: the float arithmetic of its shader against double, and the cameras of channels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "view_geometry.h"

#include <math.h>
#include <string.h>

static const double a_m = 6378137.0, b_m = 6356752.314245179;

/* As ground.comp does it. 0: no ground. */
static float shader_depth(const struct host_view_arguments *view, const float d[3]) {
    const float stretched[3] = {d[0], d[1], d[2] * view->surface[0]};
    float a = (d[0] * stretched[0] + d[1] * stretched[1] + d[2] * stretched[2]) * view->surface[1];
    float b = d[0] * view->gradient[0] + d[1] * view->gradient[1] + d[2] * view->gradient[2];
    float discriminant = b * b - a * view->surface[2];
    return b < 0 && discriminant > 0 ? view->surface[2] / (sqrtf(discriminant) - b) : 0;
}

static double exact_depth(const double eye[3], const double d[3]) {
    long double s = (long double)a_m / (long double)b_m;
    long double e[3] = {eye[0], eye[1], eye[2] * s}, v[3] = {d[0], d[1], d[2] * s};
    long double a = v[0] * v[0] + v[1] * v[1] + v[2] * v[2];
    long double b = e[0] * v[0] + e[1] * v[1] + e[2] * v[2];
    long double c = e[0] * e[0] + e[1] * e[1] + e[2] * e[2] - (long double)a_m * (long double)a_m;
    long double root = b * b - a * c;
    return b < 0 && root > 0 ? (double)(c / (sqrtl(root) - b)) : 0;
}

static void make_pose(double lat, double lon, double height, double heading, double pitch, struct eye_pose *pose) {
    pose->camera = (velum_scenario_camera){
        .lat_deg = lat, .lon_deg = lon, .height_m = height, .heading_deg = heading, .pitch_deg = pitch};
    velum_scenario_pose_ecef(&pose->camera, pose->position_m, pose->right, pose->up, pose->forward);
}

static void ground_is_where_the_ellipsoid_is(void **state) {
    static const double heights[] = {2, 30, 300, 3000, 12000, 40000};
    static const double latitudes[] = {-90, -35, 0, 0.001, 50, 90};
    int hits = 0;
    (void)state;
    for (int h = 0; h < 6; h++) {
        for (int l = 0; l < 6; l++) {
            for (double pitch = -90; pitch <= -1; pitch += 8.9) {
                const velum_scenario_channel channel = {.hfov_deg = 60};
                struct eye_pose pose;
                velum_view_frame frame;
                struct host_view_arguments arguments = {.sun = {0}};
                make_pose(latitudes[l], 180, heights[h], 33, pitch, &pose);
                view_geometry_frame(&pose, &channel, 640, 360, &frame);
                view_geometry_ground(&frame, 640, 360, 0, &arguments);
                double d[3] = {0};
                float f[3];
                for (int i = 0; i < 3; i++) {
                    f[i] = (float)frame.forward_ecef[i];
                    d[i] = (double)f[i];
                }
                double exact = exact_depth(pose.position_m, d);
                double found = (double)shader_depth(&arguments, f);
                if (exact == 0 || found == 0) {
                    /* Only at the horizon may they disagree. */
                    assert_true(exact == found || pitch > -8);
                    continue;
                }
                assert_true(fabs(found - exact) <= 2e-4 * exact + 0.01);
                hits++;
            }
        }
    }
    assert_true(hits > 200);
}

static void an_eye_under_the_ground_sees_ground(void **state) {
    const velum_scenario_channel channel = {.hfov_deg = 60};
    struct eye_pose pose;
    velum_view_frame frame;
    struct host_view_arguments arguments = {.sun = {0}};
    float down[3];
    (void)state;
    make_pose(45, 10, -400, 0, -90, &pose);
    view_geometry_frame(&pose, &channel, 64, 64, &frame);
    view_geometry_ground(&frame, 64, 64, 0, &arguments);
    for (int i = 0; i < 3; i++) {
        down[i] = (float)frame.forward_ecef[i];
    }
    assert_float_equal(shader_depth(&arguments, down), 1.0f, 0.01f);
}

static void patterns_are_anchored_to_the_world(void **state) {
    const velum_scenario_channel channel = {.hfov_deg = 60};
    struct eye_pose pose;
    velum_view_frame frame;
    struct host_view_arguments first = {.sun = {0}}, second = {.sun = {0}};
    (void)state;
    make_pose(45, 10, 1000, 0, 0, &pose);
    view_geometry_frame(&pose, &channel, 64, 64, &frame);
    view_geometry_ground(&frame, 64, 64, 0, &first);
    frame.position_ecef_m[0] += 1234.5;
    view_geometry_ground(&frame, 64, 64, 0, &second);
    double moved = ((double)second.field_cell[0] - (double)first.field_cell[0] + (double)second.field_part[0] -
                    (double)first.field_part[0]) *
                   (double)HOST_PATTERN_FIELD_M;
    assert_true(fabs(moved - 1234.5) < 0.01);
    assert_float_equal(second.field_part[1], first.field_part[1], 0);
}

static void channels_meet_at_their_edges(void **state) {
    /* Two channels of 40 degrees, yawed 40 apart, share the ray at their common edge. */
    const velum_scenario_channel left = {.yaw_deg = -40, .hfov_deg = 40}, middle = {.hfov_deg = 40};
    struct eye_pose pose;
    velum_view_frame l, m;
    (void)state;
    make_pose(50, 8, 300, 90, 0, &pose);
    view_geometry_frame(&pose, &left, 640, 360, &l);
    view_geometry_frame(&pose, &middle, 640, 360, &m);
    double u[3], v[3], nu = 0, nv = 0, cosine = 0;
    for (int i = 0; i < 3; i++) {
        u[i] = l.forward_ecef[i] + (double)l.tan_right * l.right_ecef[i];
        v[i] = m.forward_ecef[i] + (double)m.tan_left * m.right_ecef[i];
        nu += u[i] * u[i];
        nv += v[i] * v[i];
        cosine += u[i] * v[i];
    }
    assert_true(cosine / sqrt(nu * nv) > 1 - 1e-12);
    assert_float_equal(m.tan_top, m.tan_right * 360 / 640, 1e-6f);
    assert_true(m.tan_bottom < m.tan_top);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ground_is_where_the_ellipsoid_is),
        cmocka_unit_test(an_eye_under_the_ground_sees_ground),
        cmocka_unit_test(patterns_are_anchored_to_the_world),
        cmocka_unit_test(channels_meet_at_their_edges),
    };
    return cmocka_run_group_tests_name("ground", tests, NULL, NULL);
}
