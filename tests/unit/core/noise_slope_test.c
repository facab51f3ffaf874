/* What the reference believes of the noise holds: how fast ranks change, and how far away they are high. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "core/noise_slope.h"

enum { TRIALS = 200000 };

static float unit(uint32_t *state) {
    *state = *state * 747796405u + 2891336453u;
    uint32_t word = ((*state >> ((*state >> 28) + 4)) ^ *state) * 277803737u;
    return (float)(((word >> 22) ^ word) >> 8) * 0x1p-24f;
}

/* A point within a distance of another. */
static void near_by(uint32_t *random, const float q[3], float distance, float out[3]) {
    float v[3];
    float square;
    do {
        square = 0.0f;
        for (int k = 0; k < 3; k++) {
            v[k] = 2.0f * unit(random) - 1.0f;
            square += v[k] * v[k];
        }
    } while (square > 1.0f || square < 1e-6f);
    for (int k = 0; k < 3; k++) {
        out[k] = q[k] + v[k] * distance;
    }
}

static uint32_t cell(const float q[3], int side, float shift) {
    uint32_t at = 0;
    for (int k = 2; k >= 0; k--) {
        at = at * (uint32_t)side + ((uint32_t)(int)floorf(q[k] * (float)side - shift) & (uint32_t)(side - 1));
    }
    return at;
}

static void slopes_hold(void **state) {
    const core_noise *noise = *state;
    uint8_t *slope = malloc(VELUM_SLOPE_BYTES);
    assert_non_null(slope);
    assert_true(core_noise_slope(noise, slope));
    uint32_t random = 1;
    float closest = 0.0f;
    for (int i = 0; i < TRIALS; i++) {
        const float q[3] = {unit(&random), unit(&random), unit(&random)};
        float p[3];
        near_by(&random, q, VELUM_SLOPE_RADIUS * unit(&random), p);
        float off =
            sqrtf((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
        float change = fabsf(core_noise_shape(noise, p[0], p[1], p[2]) - core_noise_shape(noise, q[0], q[1], q[2]));
        float most = (float)slope[cell(q, VELUM_SLOPE_SIDE, 0.5f)] * VELUM_SLOPE_UNIT * off;
        assert_true(change <= most + 1e-4f);
        closest = fmaxf(closest, change / fmaxf(most, 1e-3f));
    }
    assert_true(closest > 0.5f); /* a bound that is of use */
    free(slope);
}

static void distances_hold(void **state) {
    const core_noise *noise = *state;
    uint8_t *away = malloc(VELUM_AWAY_BYTES);
    assert_non_null(away);
    assert_true(core_noise_away(noise, away));
    uint32_t random = 2;
    int far = 0;
    for (int i = 0; i < TRIALS; i++) {
        const float q[3] = {unit(&random), unit(&random), unit(&random)};
        const int level = (int)(unit(&random) * VELUM_AWAY_LEVELS);
        const float shift = 0.5f * (float)VELUM_AWAY_SIDE / (float)CORE_NOISE_SHAPE_SIDE;
        const size_t at =
            (size_t)level * VELUM_AWAY_SIDE * VELUM_AWAY_SIDE * VELUM_AWAY_SIDE + cell(q, VELUM_AWAY_SIDE, shift);
        float distance = (float)away[at] * (VELUM_AWAY_UNIT / (float)VELUM_AWAY_SIDE);
        float p[3];
        near_by(&random, q, distance, p);
        if (distance > 0.0f) {
            assert_true(core_noise_shape(noise, p[0], p[1], p[2]) <= velum_away_rank(level));
            far++;
        }
    }
    assert_true(far > TRIALS / 20);
    free(away);
}

static void detail_slope_holds(void **state) {
    const core_noise *noise = *state;
    const float slope = core_noise_detail_slope(noise);
    uint32_t random = 3;
    float steepest = 0.0f;
    for (int i = 0; i < TRIALS; i++) {
        const float q[3] = {unit(&random), unit(&random), unit(&random)};
        float p[3];
        near_by(&random, q, 0.02f, p);
        float off =
            sqrtf((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) + (p[2] - q[2]) * (p[2] - q[2]));
        float change = fabsf(core_noise_detail(noise, p[0], p[1], p[2]) - core_noise_detail(noise, q[0], q[1], q[2]));
        assert_true(change <= slope * off + 1e-4f);
        steepest = fmaxf(steepest, change / fmaxf(off, 1e-4f));
    }
    assert_true(steepest > 0.3f * slope);
}

static int find_noise(void **state) {
    *state = (void *)(uintptr_t)core_noise_built();
    return 0;
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(slopes_hold), cmocka_unit_test(distances_hold),
                                       cmocka_unit_test(detail_slope_holds)};
    return cmocka_run_group_tests(tests, find_noise, NULL);
}
