#include "synthetic.h"

#include "core/timeline.h"

#include <math.h>
#include <string.h>

static velum_timeline_key key_of(double time_s, double transition_s, uint64_t state) {
    return (velum_timeline_key){
        .struct_size = sizeof(velum_timeline_key), .time_s = time_s, .transition_s = transition_s, .state = state};
}

static void a_timeline_blends_and_holds(void **unused) {
    (void)unused;
    const velum_timeline_key keys[] = {key_of(0.0, 0.0, 11), key_of(1000.0, 600.0, 22), key_of(2000.0, 0.0, 33),
                                       key_of(3000.0, 1000.0, 11)};
    core_timeline line = {0};
    assert_int_equal(core_timeline_init(&line, keys, 4, 0, NULL), VELUM_OK);
    const struct {
        double time_s;
        uint64_t a, b;
        float blend;
    } cases[] = {{-1e9, 11, 11, 0.0f},   {0.0, 11, 11, 0.0f},       {400.0, 11, 11, 0.0f},
                 {700.0, 11, 22, 0.5f},  {550.0, 11, 22, 0.15625f}, {1000.0, 22, 22, 0.0f},
                 {1999.9, 22, 22, 0.0f}, {2000.0, 33, 33, 0.0f},    {2500.0, 33, 11, 0.5f},
                 {3000.0, 11, 11, 0.0f}, {1e12, 11, 11, 0.0f},      {(double)NAN, 11, 11, 0.0f}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        core_timeline_place place = core_timeline_at(&line, cases[i].time_s);
        assert_int_equal(place.state_a, cases[i].a);
        assert_int_equal(place.state_b, cases[i].b);
        assert_float_equal(place.blend, cases[i].blend, 1e-6f);
    }
    /* Share of state 22, forward and backward: continuous, the same for the same time. */
    float share[1201];
    for (int i = 0; i <= 1200; i++) {
        core_timeline_place place = core_timeline_at(&line, i);
        share[i] =
            place.state_a == 22 ? 1.0f - place.blend * (place.state_b != 22) : place.blend * (place.state_b == 22);
        assert_true(i == 0 || fabsf(share[i] - share[i - 1]) < 0.003f);
    }
    for (int i = 1200; i >= 0; i--) {
        core_timeline_place place = core_timeline_at(&line, i);
        float again =
            place.state_a == 22 ? 1.0f - place.blend * (place.state_b != 22) : place.blend * (place.state_b == 22);
        assert_true(again == share[i]);
    }
    assert_true(core_timeline_names(&line, 33));
    assert_false(core_timeline_names(&line, 34));
    core_timeline_finish(&line);
    assert_int_equal(core_timeline_at(&line, 5.0).state_a, 0);
    core_timeline_finish(NULL);
}

static void hostile_timelines_are_refused(void **unused) {
    (void)unused;
    core_timeline line = {0};
    core_error error = {0};
#define CASE(change, code, expected)                                                                                   \
    do {                                                                                                               \
        velum_timeline_key keys[2] = {key_of(0.0, 0.0, 1), key_of(10.0, 5.0, 2)};                                      \
        keys[1].change;                                                                                                \
        assert_int_equal(core_timeline_init(&line, keys, 2, sizeof *keys, &error), code);                              \
        assert_non_null(strstr(error.text, expected));                                                                 \
        assert_null(line.keys);                                                                                        \
    } while (0)
    CASE(time_s = 0.0, VELUM_ERROR_ARGUMENT, "key 1, time_s");
    CASE(time_s = (double)NAN, VELUM_ERROR_ARGUMENT, "key 1, time_s");
    CASE(transition_s = 11.0, VELUM_ERROR_ARGUMENT, "key 1, transition_s");
    CASE(transition_s = -1.0, VELUM_ERROR_ARGUMENT, "key 1, transition_s");
    CASE(transition_s = (double)INFINITY, VELUM_ERROR_ARGUMENT, "key 1, transition_s");
    CASE(state = 0, VELUM_ERROR_ARGUMENT, "key 1, state");
    CASE(reserved = 1, VELUM_ERROR_FLAGS, "key 1, reserved");
    CASE(struct_size = 31, VELUM_ERROR_STRUCT_SIZE, "key 1, struct_size");
#undef CASE
    assert_int_equal(core_timeline_init(&line, NULL, 2, 0, &error), VELUM_ERROR_ARGUMENT);
    assert_int_equal(core_timeline_init(&line, NULL, 0, 0, &error), VELUM_OK);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_timeline_blends_and_holds),
        cmocka_unit_test(hostile_timelines_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
