/* When a sky that was drawn still does: changes that do not show, one by one. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "plugin/sky_key.h"

static velum_eye_block noon(void) {
    velum_eye_block b = {.up = {0.0f, 0.0f, 1.0f, 1500.0f},
                         .sun = {0.6f, 0.0f, 0.8f, 1.0f},
                         .sun_lx = {128000.0f, 128000.0f, 128000.0f, 0.00465f},
                         .ground = {0.1f, 0.2f, 0.3f, 1.0f},
                         .drift = {0.0f, 0.0f, 100.0f, 2e-5f}};
    for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
        b.shades[k][0] = 0.5f;
        b.shades[k][3] = 1.0f;
    }
    return b;
}

static bool still_does(const velum_eye_block *a, const velum_eye_block *b) {
    const sky_key made = sky_key_of(a), wanted = sky_key_of(b);
    return sky_key_near(&made, &wanted);
}

static void a_sky_does_for_itself(void **state) {
    (void)state;
    const velum_eye_block b = noon();
    const sky_key key = sky_key_of(&b);
    assert_true(sky_key_same(&key, &key));
    assert_true(still_does(&b, &b));
}

/* A member, by a step that does not show and by one that does. */
static void small_changes_do_not_show(void **state) {
    (void)state;
    velum_eye_block now = noon();
    const velum_eye_block made = now;
    const struct {
        float *at;
        float small, great;
    } changes[] = {
        {&now.up[3], 2.0f, 5.0f},      {&now.sun_lx[1], 100.0f, 1000.0f}, {&now.ground[0], 5e-5f, 1e-2f},
        {&now.ground[3], 0.0f, -1.0f}, {&now.shades[7][0], 3e-4f, 5e-3f}, {&now.shades[31][1], 5e-6f, 1e-3f},
        {&now.drift[1], 0.0f, 1e-5f},  {&now.drift[3], 1e-8f, 1e-6f},     {&now.span[2], 0.5f, 5.0f},
    };
    for (size_t i = 0; i < sizeof changes / sizeof changes[0]; i++) {
        const float before = *changes[i].at;
        *changes[i].at = before + changes[i].small;
        assert_true(still_does(&made, &now));
        *changes[i].at = before + changes[i].great;
        assert_false(still_does(&made, &now));
        *changes[i].at = NAN;
        assert_false(still_does(&made, &now));
        *changes[i].at = before;
    }
}

/* Sun and eye that turn together see the same sky; the sun alone does not. */
static void the_sun_counts_by_its_height(void **state) {
    (void)state;
    const velum_eye_block made = noon();
    velum_eye_block now = made;
    for (int i = 0; i < 2; i++) {
        const double turn = i == 0 ? 2e-5 : 2e-4;
        const double zenith = atan2(0.6, 0.8) + turn;
        now.sun[0] = (float)sin(zenith);
        now.sun[2] = (float)cos(zenith);
        assert_int_equal(still_does(&made, &now), i == 0);
        now.up[0] = (float)sin(turn);
        now.up[2] = (float)cos(turn);
        assert_true(still_does(&made, &now));
        now.up[0] = 0.0f;
        now.up[2] = 1.0f;
    }
}

static void fog_and_the_ground_count_by_small_steps(void **state) {
    (void)state;
    velum_eye_block made = noon();
    made.drift[1] = 0.01f;
    made.up[3] = 150.0f;
    velum_eye_block now = made;
    now.up[3] += 0.3f;
    assert_false(still_does(&made, &now));
    made.up[3] += 200.0f;
    now.up[3] += 200.0f;
    assert_true(still_does(&made, &now));
    made.up[3] = 2.0f;
    now.up[3] = 2.05f;
    assert_false(still_does(&made, &now));
    now.up[3] = 2.01f;
    assert_true(still_does(&made, &now));
    now.drift[2] += 1.0f;
    assert_false(still_does(&made, &now));
    made.drift[1] = now.drift[1] = 0.0f; /* no fog: its top is nothing */
    assert_true(still_does(&made, &now));
}

/* Seen from orbit the rim of the air turns with the eye's height. */
static void from_orbit_the_horizon_counts(void **state) {
    (void)state;
    velum_eye_block made = noon();
    made.up[3] = 400000.0f;
    velum_eye_block now = made;
    now.up[3] += 30.0f;
    assert_true(still_does(&made, &now));
    now.up[3] += 300.0f;
    assert_false(still_does(&made, &now));
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sky_does_for_itself),         cmocka_unit_test(small_changes_do_not_show),
        cmocka_unit_test(the_sun_counts_by_its_height),  cmocka_unit_test(fog_and_the_ground_count_by_small_steps),
        cmocka_unit_test(from_orbit_the_horizon_counts),
    };
    return cmocka_run_group_tests_name("sky key", tests, NULL, NULL);
}
