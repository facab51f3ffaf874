/* The picture's last step: neutral, monotonic, bounded. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "shaders/tone_map.h"

static void srgb_meets_the_standard(void **state) {
    (void)state;
    /* IEC 61966-2-1: 0.5 is code 187.516 of 255; the two branches meet at 0.0031308. */
    assert_float_equal(tone_srgb(0.0f), 0.0f, 1e-7f);
    assert_float_equal(tone_srgb(1.0f), 1.0f, 1e-6f);
    assert_float_equal(tone_srgb(0.5f) * 255, 187.516f, 0.01f);
    assert_float_equal(tone_srgb(0.0031308f), 12.92f * 0.0031308f, 1e-6f);
    assert_float_equal(tone_srgb(0.0031309f), tone_srgb(0.0031308f), 1e-5f);
    assert_float_equal(tone_srgb(7.0f), 1.0f, 1e-6f);
}

static void grey_stays_grey(void **state) {
    (void)state;
    for (float ev = -12; ev < 8; ev += 0.25f) {
        float value = 0.18f * exp2f(ev);
        float r = tone_map(value, value, value, 0), g = tone_map(value, value, value, 1);
        float b = tone_map(value, value, value, 2);
        assert_float_equal(r, g, 1.0f / 255);
        assert_float_equal(b, g, 1.0f / 255);
    }
}

static void brighter_is_never_darker(void **state) {
    (void)state;
    float before = 0;
    for (float ev = -10; ev < 10; ev += 0.05f) {
        float value = 0.18f * exp2f(ev);
        float code = tone_map(value, value, value, 1);
        assert_true(code >= before - 1e-4f);
        before = code;
    }
    assert_true(before > 0.97f);
    assert_true(tone_map(0, 0, 0, 1) < 0.01f);
}

static void hostile_light_stays_in_range(void **state) {
    (void)state;
    const float values[] = {0, -1, 1e-30f, 0.18f, 1, 1e6f};
    for (size_t i = 0; i < 6 * 6 * 6; i++) {
        for (int c = 0; c < 3; c++) {
            float code = tone_map(values[i % 6], values[i / 6 % 6], values[i / 36], c);
            assert_true(code >= 0 && code <= 1);
        }
    }
}

static float code_of(float grey) {
    return 255 * tone_map(grey, grey, grey, 1);
}

static void sunlit_cloud_is_white_and_has_shapes(void **state) {
    (void)state;
    assert_true(code_of(1) > 220 && code_of(1) < 245);
    assert_true(code_of(1) - code_of(0.5f) > 25);
    assert_true(code_of(0.5f) - code_of(0.25f) > 25);
    assert_true(code_of(2) - code_of(1) > 8); /* about the sun too */
}

static void middle_grey_is_in_the_middle(void **state) {
    (void)state;
    assert_true(code_of(0.18f) > 110 && code_of(0.18f) < 150);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(srgb_meets_the_standard),      cmocka_unit_test(grey_stays_grey),
        cmocka_unit_test(brighter_is_never_darker),     cmocka_unit_test(hostile_light_stays_in_range),
        cmocka_unit_test(middle_grey_is_in_the_middle), cmocka_unit_test(sunlit_cloud_is_white_and_has_shapes),
    };
    return cmocka_run_group_tests_name("tone map", tests, NULL, NULL);
}
