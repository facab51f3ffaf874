/* render and render_shadow of "velum.standalone/1": every field of every struct out of its range is refused by name,
 * and the picture after it all is the picture before. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "engine_fixture.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static test_host host;

static const field_rule frame_rules[] = {
    RULE(velum_frame_info, time_s, FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_frame_info, sun_direction_ecef[0], "sun_direction_ecef", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_frame_info, sun_direction_ecef[2], "sun_direction_ecef", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_frame_info, sun_illuminance_lx[0], "sun_illuminance_lx", FIELD_F32, 0, INFINITY),
    RULE_AS(velum_frame_info, sun_illuminance_lx[2], "sun_illuminance_lx", FIELD_F32, 0, INFINITY),
    RULE(velum_frame_info, sun_angular_radius_rad, FIELD_F32, 0, INFINITY),
    RULE_AS(velum_frame_info, ground_albedo[0], "ground_albedo", FIELD_F32, 0, 1),
    RULE_AS(velum_frame_info, ground_albedo[2], "ground_albedo", FIELD_F32, 0, 1),
    RULE(velum_frame_info, atmosphere, FIELD_I32, VELUM_ATMOSPHERE_EARTH, VELUM_ATMOSPHERE_NONE),
};

static const field_rule view_rules[] = {
    RULE_AS(velum_view_frame, position_ecef_m[0], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, position_ecef_m[2], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, right_ecef[0], "right_ecef", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, up_ecef[1], "up_ecef", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, forward_ecef[2], "forward_ecef", FIELD_F64, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, tan_left, "tan_", FIELD_F32, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, tan_right, "tan_", FIELD_F32, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, tan_bottom, "tan_", FIELD_F32, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, tan_top, "tan_", FIELD_F32, -INFINITY, INFINITY),
    RULE_AS(velum_view_frame, jitter_x, "jitter", FIELD_F32, -1, 1),
    RULE_AS(velum_view_frame, jitter_y, "jitter", FIELD_F32, -1, 1),
    RULE(velum_view_frame, depth_convention, FIELD_I32, VELUM_DEPTH_REVERSED_INFINITE, VELUM_DEPTH_DISTANCE),
    RULE(velum_view_frame, luminance_scale, FIELD_F32, 0, INFINITY),
};

static void frames_are_checked(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    /* The picture of a fresh view, for the end. */
    f.eye_frame.flags = VELUM_EYE_RESET;
    assert_true(engine_fixture_render(&f) >= 0);
    float *before = calloc(FIXTURE_PIXELS * 3, sizeof(float));
    assert_non_null(before);
    memcpy(before, f.luminance, FIXTURE_PIXELS * 3 * sizeof(float));
    f.eye_frame.flags = 0;

    misuse m = engine_fixture_misuse(&f, "render", engine_fixture_render);
    misuse_struct(&m, &f.frame, sizeof f.frame, true, 0);
    misuse_rules(&m, &f.frame, frame_rules, COUNT(frame_rules), false);
    velum_frame_info frame = f.frame;
    for (int i = 0; i < 3; i++) {
        f.frame.sun_direction_ecef[i] *= 1.01; /* unit within 1e-3 */
    }
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "sun_direction_ecef");
    memset(f.frame.sun_direction_ecef, 0, sizeof f.frame.sun_direction_ecef);
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "sun_direction_ecef");
    f.frame = frame;
    f.frame.submit_serial = 1;
    misuse_expect(&m, VELUM_ERROR_FLAGS, "submit_serial");
    f.frame = frame;
    f.frame.completed_serial = 1;
    misuse_expect(&m, VELUM_ERROR_FLAGS, "completed_serial");
    f.frame = frame;

    misuse_struct(&m, &f.eye_frame, sizeof f.eye_frame, true, VELUM_EYE_RESET);
    static const field_rule eye_rules[] = {
        RULE_AS(velum_eye_frame, position_ecef_m[0], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_eye_frame, position_ecef_m[1], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
    };
    misuse_rules(&m, &f.eye_frame, eye_rules, COUNT(eye_rules), false);

    misuse_struct(&m, &f.view_frame, sizeof f.view_frame, true, 0xfu);
    misuse_rules(&m, &f.view_frame, view_rules, COUNT(view_rules), false);
    velum_view_frame view = f.view_frame;
    f.view_frame.tan_left = f.view_frame.tan_right;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "tan_");
    f.view_frame = view;
    f.view_frame.tan_bottom = 1.0f;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "tan_");
    f.view_frame = view;
    f.view_frame.position_ecef_m[0] += 10500.0; /* within 10 km of its eye's */
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "position_ecef_m");
    f.view_frame = view;
    memcpy(f.view_frame.up_ecef, f.view_frame.right_ecef, sizeof f.view_frame.up_ecef);
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "");
    f.view_frame = view;
    for (int i = 0; i < 3; i++) {
        f.view_frame.right_ecef[i] = -f.view_frame.right_ecef[i]; /* left-handed */
    }
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "");
    f.view_frame = view;
    static const uint32_t rectangles[][4] = {

        {0, 0, FIXTURE_WIDTH + 1, FIXTURE_HEIGHT},
        {0, 0, FIXTURE_WIDTH, FIXTURE_HEIGHT + 1},
        {UINT32_MAX, 0, 2, 2},
        {0, UINT32_MAX, 2, 2},
        {2, 2, UINT32_MAX, 2},
    };
    for (size_t i = 0; i < COUNT(rectangles); i++) {
        f.view_frame.x = rectangles[i][0];
        f.view_frame.y = rectangles[i][1];
        f.view_frame.width = rectangles[i][2];
        f.view_frame.height = rectangles[i][3];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "");
    }
    f.view_frame = view;
    f.pixels.depth = f.distance;
    static const int32_t conventions[] = {VELUM_DEPTH_REVERSED_INFINITE, VELUM_DEPTH_REVERSED, VELUM_DEPTH_FORWARD};
    for (size_t i = 0; i < COUNT(conventions); i++) {
        f.view_frame.depth_convention = conventions[i];
        f.view_frame.depth_far_m = 1000.0f;
        const float nears[] = {0.0f, -1.0f, NAN, INFINITY};
        for (size_t j = 0; j < COUNT(nears); j++) {
            f.view_frame.depth_near_m = nears[j];
            misuse_expect(&m, VELUM_ERROR_ARGUMENT, "depth_near_m");
        }
        f.view_frame.depth_near_m = 1.0f;
        const float fars[] = {0.5f, -1.0f, NAN};
        for (size_t j = 0; j < COUNT(fars) && i > 0; j++) {
            f.view_frame.depth_far_m = fars[j];
            misuse_expect(&m, VELUM_ERROR_ARGUMENT, "depth_far_m");
        }
    }
    f.view_frame = view;
    f.pixels.depth = NULL;

    misuse_struct(&m, &f.pixels, sizeof f.pixels, true, 0);
    velum_pixels pixels = f.pixels;
    f.pixels.frame = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "frame");
    f.pixels = pixels;
    f.pixels.width = FIXTURE_WIDTH - 1;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "width");
    f.pixels = pixels;
    f.pixels.height = FIXTURE_HEIGHT + 1;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "height");
    f.pixels = pixels;
    f.eye_stride = 8;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.eye_stride = 0;
    f.view_stride = 8;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.view_stride = 0;
    assert_true(m.tried > 200);
    assert_int_equal(m.wrong, 0);

    test_log_clear(&host.log);
    assert_int_equal(host.standalone->render(f.engine, NULL, &f.eye_frame, 1, 0, &f.pixels, 1, 0),
                     VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.standalone->render(f.engine, &f.frame, NULL, 1, 0, &f.pixels, 1, 0), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.standalone->render(f.engine, &f.frame, &f.eye_frame, 1, 0, NULL, 1, 0), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 3);
    /* A view of an eye that is not in the frame, and one view twice. */
    assert_true(host.standalone->render(f.engine, &f.frame, NULL, 0, 0, &f.pixels, 1, 0) < 0);
    velum_pixels twice[2] = {f.pixels, f.pixels};
    assert_true(host.standalone->render(f.engine, &f.frame, &f.eye_frame, 1, 0, twice, 2, 0) < 0);
    assert_int_equal(host.log.failures, 5);

    f.eye_frame.flags = VELUM_EYE_RESET;
    assert_true(engine_fixture_render(&f) >= 0);
    assert_memory_equal(before, f.luminance, FIXTURE_PIXELS * 3 * sizeof(float));
    free(before);
    engine_fixture_finish(&f);
}

static void shadow_frames_are_checked(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    misuse m = engine_fixture_misuse(&f, "render_shadow", engine_fixture_shadow);
    misuse_expect_ok(&m, "the shadow map as it is");
    misuse_struct(&m, &f.shadow_frame, sizeof f.shadow_frame, true, 0);
    static const field_rule rules[] = {
        RULE_AS(velum_shadow_frame, centre_ecef_m[0], "centre_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_shadow_frame, centre_ecef_m[2], "centre_ecef_m", FIELD_F64, -INFINITY, INFINITY),
    };
    misuse_rules(&m, &f.shadow_frame, rules, COUNT(rules), false);
    misuse_struct(&m, &f.frame, sizeof f.frame, true, 0);
    misuse_rules(&m, &f.frame, frame_rules, COUNT(frame_rules), false);
    static const uint64_t counts[] = {0, 1, FIXTURE_TEXELS * FIXTURE_TEXELS - 1, FIXTURE_TEXELS * FIXTURE_TEXELS + 1,
                                      UINT64_MAX};
    for (size_t i = 0; i < COUNT(counts); i++) {
        f.shadow_count = counts[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "count");
    }
    f.shadow_count = FIXTURE_TEXELS * FIXTURE_TEXELS;
    misuse_expect_ok(&m, "the shadow map as it was");
    assert_int_equal(m.wrong, 0);
    test_log_clear(&host.log);
    assert_int_equal(
        host.standalone->render_shadow(f.engine, NULL, f.shadow, &f.shadow_frame, f.shadow_map, f.shadow_count),
        VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.standalone->render_shadow(f.engine, &f.frame, f.shadow, NULL, f.shadow_map, f.shadow_count),
                     VELUM_ERROR_ARGUMENT);
    assert_int_equal(
        host.standalone->render_shadow(f.engine, &f.frame, f.shadow, &f.shadow_frame, NULL, f.shadow_count),
        VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 3);
    engine_fixture_finish(&f);
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(frames_are_checked),
        cmocka_unit_test(shadow_frames_are_checked),
    };
    int failed = cmocka_run_group_tests_name("abi frame misuse", tests, NULL, NULL);
    test_host_close(&host);
    return failed;
}
