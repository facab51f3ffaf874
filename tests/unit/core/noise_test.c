/* The noises tile, are uniform where shared/density.h takes them to be, and stay what they are. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "core/noise_make.h"
#include "shared/hash.h"

#define SAMPLES 400000

static int find_noise(void **state) {
    *state = (void *)(uintptr_t)core_noise_built();
    return 0;
}

static int compare(const void *a, const void *b) {
    float x = *(const float *)a;
    float y = *(const float *)b;
    return (x > y) - (x < y);
}

static float random_unit(uint32_t i, uint32_t axis) {
    return velum_hash_unit(velum_hash_2(i, axis));
}

static void filtered_shape_is_uniform(void **state) {
    float *values = malloc(SAMPLES * sizeof *values);
    assert_non_null(values);
    for (uint32_t i = 0; i < SAMPLES; i++) {
        values[i] = core_noise_shape(*state, random_unit(i, 1), random_unit(i, 2), random_unit(i, 3));
    }
    qsort(values, SAMPLES, sizeof *values, compare);
    double worst = 0.0;
    for (uint32_t i = 0; i < SAMPLES; i++) {
        worst = fmax(worst, fabs(values[i] - (i + 0.5) / SAMPLES));
    }
    free(values);
    assert_true(worst < 0.004);
}

/* What keeps coverage over a 50 km square: no plane of texels and no eighth of the cube has more or less than its
 * share. */
static void shape_is_uniform_in_planes_and_eighths(void **state) {
    const core_noise *noise = *state;
    const uint32_t n = CORE_NOISE_SHAPE_SIDE;
    static const float coverages[] = {0.125f, 0.375f, 0.625f, 0.875f};
    for (size_t c = 0; c < 4; c++) {
        uint32_t all = 0;
        uint32_t planes[3][CORE_NOISE_SHAPE_SIDE] = {{0}};
        uint32_t eighths[8] = {0};
        for (uint32_t i = 0; i < CORE_NOISE_SHAPE_BYTES; i++) {
            uint32_t x = i % n;
            uint32_t y = i / n % n;
            uint32_t z = i / n / n;
            if ((float)noise->shape[i] > 255.0f * (1.0f - coverages[c])) {
                all++;
                planes[0][x]++;
                planes[1][y]++;
                planes[2][z]++;
                eighths[(z / 64 * 2 + y / 64) * 2 + x / 64]++;
            }
        }
        double share = (double)all / CORE_NOISE_SHAPE_BYTES;
        for (uint32_t i = 0; i < 3 * n; i++) {
            assert_true(fabs((double)planes[i / n][i % n] / (n * n) - share) < 0.012);
        }
        for (uint32_t i = 0; i < 8; i++) {
            assert_true(fabs((double)eighths[i] / (64 * 64 * 64) - share) < 0.03);
        }
    }
}

static void noises_tile(void **state) {
    for (uint32_t i = 0; i < 200; i++) {
        float x = floorf(1024.0f * random_unit(i, 1)) / 1024.0f;
        float y = floorf(1024.0f * random_unit(i, 2)) / 1024.0f;
        float z = floorf(1024.0f * random_unit(i, 3)) / 1024.0f;
        assert_true(core_noise_shape(*state, x, y, z) == core_noise_shape(*state, x + 3.0f, y - 2.0f, z + 1.0f));
        assert_true(core_noise_detail(*state, x, y, z) == core_noise_detail(*state, x - 1.0f, y + 4.0f, z - 7.0f));
    }
    /* No seam: steps over the border are no larger than steps inside. */
    double inside = 0.0;
    double border = 0.0;
    for (uint32_t i = 0; i < 4000; i++) {
        float y = random_unit(i, 4);
        float z = random_unit(i, 5);
        float at = 0.1f + 0.8f * random_unit(i, 6);
        const float step = 0.5f / CORE_NOISE_SHAPE_SIDE;
        inside += fabsf(core_noise_shape(*state, at - step, y, z) - core_noise_shape(*state, at + step, y, z));
        border += fabsf(core_noise_shape(*state, 1.0f - step, y, z) - core_noise_shape(*state, step, y, z));
    }
    assert_true(border > 0.0 && border < 1.2 * inside);
}

static void filter_meets_texel_centres(void **state) {
    const core_noise *noise = *state;
    for (uint32_t i = 0; i < 500; i++) {
        uint32_t at = velum_hash(i) % CORE_NOISE_SHAPE_BYTES;
        const float n = CORE_NOISE_SHAPE_SIDE;
        float value = core_noise_shape(noise, ((float)(at % 128) + 0.5f) / n, ((float)(at / 128 % 128) + 0.5f) / n,
                                       ((float)(at / 16384) + 0.5f) / n);
        assert_true(fabsf(value - (float)noise->shape[at] / 255.0f) < 1e-5f);
    }
}

static void detail_is_centred_and_wide(void **state) {
    const core_noise *noise = *state;
    double sum = 0.0;
    double squares = 0.0;
    for (uint32_t i = 0; i < CORE_NOISE_DETAIL_BYTES; i++) {
        sum += noise->detail[i];
        squares += (double)noise->detail[i] * noise->detail[i];
    }
    double mean = sum / CORE_NOISE_DETAIL_BYTES;
    double deviation = sqrt(squares / CORE_NOISE_DETAIL_BYTES - mean * mean);
    assert_true(fabs(mean / 255.0 - 0.5) < 0.005);
    assert_true(fabs(deviation / 255.0 - 0.2) < 0.01);
}

static void hostile_places_stay_inside(void **state) {
    static const float places[] = {NAN, INFINITY, -INFINITY, 1e30f, -1e30f, -1e-30f, 0.99999994f};
    for (size_t i = 0; i < 7; i++) {
        float shape = core_noise_shape(*state, places[i], 0.3f, places[i]);
        assert_true(isnan(shape) || (shape >= 0.0f && shape <= 1.0f));
        float detail = core_noise_detail(*state, 0.3f, places[i], 0.1f);
        assert_true(isnan(detail) || (detail >= 0.0f && detail <= 1.0f));
    }
}

static void noise_is_the_same_each_time(void **state) {
    core_noise *again = malloc(sizeof *again);
    assert_non_null(again);
    assert_true(core_noise_make(again));
    assert_memory_equal(again, *state, sizeof *again);
    free(again);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(filtered_shape_is_uniform),
        cmocka_unit_test(shape_is_uniform_in_planes_and_eighths),
        cmocka_unit_test(noises_tile),
        cmocka_unit_test(filter_meets_texel_centres),
        cmocka_unit_test(detail_is_centred_and_wide),
        cmocka_unit_test(hostile_places_stay_inside),
        cmocka_unit_test(noise_is_the_same_each_time),
    };
    return cmocka_run_group_tests_name("noise", tests, find_noise, NULL);
}
