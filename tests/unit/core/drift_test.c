#include "synthetic.h"

#include "core/drift.h"

#include <math.h>
#include <string.h>

static void weights_are_a_linear_fade(void **unused) {
    (void)unused;
    uint32_t alone = 0;
    for (int i = -20000; i < 20000; i++) {
        core_drift d = core_drift_at(i * 1.3, 7);
        assert_float_equal(d.weight[0] + d.weight[1], 1.0f, 1e-6f);
        for (int p = 0; p < 2; p++) {
            assert_true(d.weight[p] >= 0.0f && d.weight[p] <= 1.0f);
            assert_true(fabsf(d.tau_s[p]) <= (float)(CORE_DRIFT_CYCLE_S / 2.0));
            for (int axis = 0; axis < 3; axis++) {
                assert_true(d.offset[p][axis] >= 0.0f && d.offset[p][axis] < 1.0f);
            }
        }
        alone += d.weight[0] == 1.0f || d.weight[1] == 1.0f;
    }
    assert_true(alone > 0.79 * 40000); /* 4,800 s of each 6,000 */
}

/* As time goes, a phase that has weight moves with it; it is exchanged only while its weight is 0. */
static void phases_that_show_are_continuous(void **unused) {
    (void)unused;
    const double origins[] = {-3e4, 0.0, 9.9999e8};
    uint32_t exchanged = 0;
    for (size_t o = 0; o < 3; o++) {
        core_drift last = core_drift_at(origins[o], 3);
        for (int i = 1; i < 60000; i++) {
            core_drift d = core_drift_at(origins[o] + i, 3);
            for (int p = 0; p < 2; p++) {
                assert_float_equal(d.weight[p], last.weight[p], 0.001f);
                if (d.weight[p] > 0.002f || last.weight[p] > 0.002f) {
                    assert_int_equal(d.cycle[p], last.cycle[p]);
                    assert_float_equal(d.tau_s[p] - last.tau_s[p], 1.0f, 1e-3f);
                    assert_memory_equal(d.offset[p], last.offset[p], sizeof d.offset[p]);
                }
                exchanged += d.cycle[p] != last.cycle[p];
            }
            last = d;
        }
    }
    assert_true(exchanged >= 27 && exchanged <= 33); /* once a life of 6,000 s */
}

static void lives_differ_and_time_can_be_sought(void **unused) {
    (void)unused;
    core_drift a = core_drift_at(123456.0, 5);
    core_drift b = core_drift_at(123456.0 + 12000.0, 5);
    core_drift c = core_drift_at(123456.0, 6);
    core_drift again = core_drift_at(123456.0, 5);
    assert_memory_equal(a.tau_s, again.tau_s, sizeof a.tau_s);
    assert_memory_equal(a.offset, again.offset, sizeof a.offset);
    assert_memory_equal(a.weight, again.weight, sizeof a.weight);
    assert_float_equal(a.tau_s[0], b.tau_s[0], 1e-3f);
    assert_true(memcmp(a.offset, b.offset, sizeof a.offset) != 0);
    assert_true(memcmp(a.offset, c.offset, sizeof a.offset) != 0);
    core_drift odd = core_drift_at((double)NAN, 5);
    assert_float_equal(odd.weight[0] + odd.weight[1], 1.0f, 1e-6f);
    odd = core_drift_at(-(double)INFINITY, 5);
    assert_float_equal(odd.weight[0] + odd.weight[1], 1.0f, 1e-6f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(weights_are_a_linear_fade),
        cmocka_unit_test(phases_that_show_are_continuous),
        cmocka_unit_test(lives_differ_and_time_can_be_sought),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
