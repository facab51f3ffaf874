/* What --stats says of a plan. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "stats.h"

#include <string.h>

static const char *text_of(json_t *object, const char *key) {
    const char *text = json_string_value(json_object_get(object, key));
    assert_non_null(text);
    return text;
}

static double number_of(json_t *object, const char *key) {
    json_t *value = json_object_get(object, key);
    assert_true(json_is_number(value));
    return json_number_value(value);
}

static void every_field_of_a_plan_is_told(void **state) {
    (void)state;
    const velum_plan plan = {.struct_size = sizeof plan,
                             .flags = VELUM_PLAN_STEP_THROUGH | VELUM_PLAN_LIGHT_ALL,
                             .active_layers = 5,
                             .march_steps = 17,
                             .light_steps = 3,
                             .ray_rate = 4,
                             .octaves = 2,
                             .blending = 1,
                             .step_m = 110.0f,
                             .step_growth = 0.25f,
                             .distance_m = 5e5f,
                             .integrator = VELUM_INTEGRATOR_TRAPEZOID,
                             .scattering = VELUM_SCATTERING_OCTAVES,
                             .sun_depth = VELUM_SUN_DEPTH_MAP,
                             .long_step = 8.0f,
                             .thin_density = 0.5f,
                             .exit_transmittance = 0.125f,
                             .standing_ray_rate = 32,
                             .finer_rays = 1,
                             .finer_blocks = 9,
                             .every_pixel = 1,
                             .volume_cell_m = 250.0f};
    json_t *object = stats_plan(&plan);
    assert_int_equal(json_object_size(object), sizeof plan / 4 - 1); /* all but struct_size */
    json_t *flags = json_object_get(object, "flags");
    assert_int_equal(json_array_size(flags), 2);
    assert_string_equal(json_string_value(json_array_get(flags, 0)), "step_through");
    assert_string_equal(json_string_value(json_array_get(flags, 1)), "light_all");
    assert_int_equal(number_of(object, "active_layers"), 5);
    assert_int_equal(number_of(object, "march_steps"), 17);
    assert_int_equal(number_of(object, "light_steps"), 3);
    assert_int_equal(number_of(object, "ray_rate"), 4);
    assert_int_equal(number_of(object, "octaves"), 2);
    assert_int_equal(number_of(object, "blending"), 1);
    assert_true(number_of(object, "step_m") == 110.0);
    assert_true(number_of(object, "step_growth") == 0.25);
    assert_true(number_of(object, "distance_m") == 5e5);
    assert_string_equal(text_of(object, "integrator"), "trapezoid");
    assert_string_equal(text_of(object, "scattering"), "octaves");
    assert_string_equal(text_of(object, "sun_depth"), "map");
    assert_true(number_of(object, "long_step") == 8.0);
    assert_true(number_of(object, "thin_density") == 0.5);
    assert_true(number_of(object, "exit_transmittance") == 0.125);
    assert_true(number_of(object, "standing_ray_rate") == 32.0);
    assert_true(number_of(object, "finer_rays") == 1.0);
    assert_true(number_of(object, "finer_blocks") == 9.0);
    assert_true(number_of(object, "every_pixel") == 1.0);
    assert_true(number_of(object, "volume_cell_m") == 250.0);
    json_decref(object);
}

/* A newer plugin may know more. */
static void what_is_unknown_is_a_number(void **state) {
    (void)state;
    const velum_plan plan = {.struct_size = sizeof plan, .flags = 1u << 31, .integrator = 99, .sun_depth = 4};
    json_t *object = stats_plan(&plan);
    assert_int_equal(json_integer_value(json_array_get(json_object_get(object, "flags"), 0)), 31);
    assert_int_equal(number_of(object, "integrator"), 99);
    assert_int_equal(number_of(object, "sun_depth"), 4);
    assert_string_equal(text_of(object, "scattering"), "closure");
    json_decref(object);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(every_field_of_a_plan_is_told),
                                       cmocka_unit_test(what_is_unknown_is_a_number)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
