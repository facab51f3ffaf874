/* Hashes, and the mixing of ranks, details and states, against what they promise. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>

#include "shared/hash.h"
#include "shared/sample.h"

#define SAMPLES 100000

/* pcg_output_rxs_m_xs_32_32 after one step of the generator with multiplier 747796405, increment 2891336453 (O'Neill's
 * pcg_variants.h), written out. */
static void hash_is_pcg(void **state) {
    (void)state;
    for (uint64_t i = 0; i < 1000; i++) {
        uint64_t x = i * 4292923u % 4294967296u;
        uint64_t s = (x * 747796405u + 2891336453u) % 4294967296u;
        uint64_t word = ((s >> ((s >> 28) + 4)) ^ s) * 277803737u % 4294967296u;
        assert_int_equal(velum_hash((uint32_t)x), (uint32_t)((word >> 22) ^ word));
    }
}

static void hash_units_are_even(void **state) {
    (void)state;
    uint32_t counts[16] = {0};
    for (uint32_t i = 0; i < 160000; i++) {
        float unit = velum_hash_unit(velum_hash_4(i & 31u, i >> 5u & 31u, i >> 10u, 9u));
        assert_true(unit >= 0.0f && unit < 1.0f);
        counts[(uint32_t)(unit * 16.0f)]++;
    }
    for (int i = 0; i < 16; i++) {
        assert_true(counts[i] > 9500 && counts[i] < 10500);
    }
}

static int compare(const void *a, const void *b) {
    float x = *(const float *)a;
    float y = *(const float *)b;
    return (x > y) - (x < y);
}

static void mixed_ranks_are_uniform(void **state) {
    (void)state;
    static const float weights[] = {0.0f, 1e-5f, 0.02f, 0.25f, 0.5f, 0.8f, 0.9999f, 1.0f};
    float *values = malloc(SAMPLES * sizeof *values);
    assert_non_null(values);
    for (int w = 0; w < 8; w++) {
        for (uint32_t i = 0; i < SAMPLES; i++) {
            values[i] =
                velum_rank_mix(velum_hash_unit(velum_hash_2(i, 1)), velum_hash_unit(velum_hash_2(i, 2)), weights[w]);
        }
        qsort(values, SAMPLES, sizeof *values, compare);
        for (uint32_t i = 0; i < SAMPLES; i++) {
            /* Kolmogorov-Smirnov: 1.95 / sqrt(n) is passed once in a thousand. */
            assert_true(fabs((double)values[i] - (i + 0.5) / SAMPLES) < 1.95 / sqrt(SAMPLES));
        }
    }
    free(values);
}

static void mixed_ranks_begin_and_end_with_one_alone(void **state) {
    (void)state;
    for (int i = 0; i <= 10; i++) {
        float a = 0.1f * (float)i;
        float b = 1.0f - 0.07f * (float)i;
        assert_true(velum_rank_mix(a, b, 0.0f) == a && velum_rank_mix(a, b, 1.0f) == b);
        assert_true(fabsf(velum_rank_mix(a, b, 1e-4f) - a) < 1e-3f);
        assert_true(fabsf(velum_rank_mix(a, b, 0.9999f) - b) < 1e-3f);
        assert_true(fabsf(velum_detail_mix(a, b, 0.0f) - a) < 1e-6f);
        assert_true(fabsf(velum_detail_mix(a, b, 1.0f) - b) < 1e-6f);
    }
}

static void mixed_details_keep_their_variance(void **state) {
    (void)state;
    for (int w = 0; w <= 4; w++) {
        double sum = 0.0;
        double squares = 0.0;
        for (uint32_t i = 0; i < SAMPLES; i++) {
            float a = 0.3f + 0.4f * velum_hash_unit(velum_hash_2(i, 1));
            float b = 0.3f + 0.4f * velum_hash_unit(velum_hash_2(i, 2));
            double x = (double)velum_detail_mix(a, b, 0.25f * (float)w);
            sum += x;
            squares += x * x;
        }
        double mean = sum / SAMPLES;
        assert_true(fabs(mean - 0.5) < 2e-3);
        assert_true(fabs((squares / SAMPLES - mean * mean) / (0.16 / 12.0) - 1.0) < 0.02);
    }
}

static void states_mix_by_their_coverage(void **state) {
    (void)state;
    const velum_slot_fields a = {.coverage = 0.8f, .base_m = 1000, .top_m = 2000, .extinction_1_m = 0.04f, .kind = 1};
    const velum_slot_fields none = {.coverage = 0.0f, .base_m = 0, .top_m = 1, .extinction_1_m = 1e-7f};
    /* Fading out, a cloud keeps its height. */
    velum_slot_fields f = velum_fields_mix(a, none, 0.75f);
    assert_true(fabsf(f.coverage - 0.2f) < 1e-6f && fabsf(f.base_m - 1000.0f) < 1e-3f);
    assert_true(fabsf(f.extinction_1_m / 0.04f - 1.0f) < 1e-5f && f.kind == 1.0f);
    f = velum_fields_mix(none, none, 0.3f);
    assert_true(f.coverage == 0.0f && isfinite(f.base_m) && isfinite(f.extinction_1_m));
    const velum_slot_fields b = {.coverage = 0.4f, .base_m = 1600, .top_m = 3000, .extinction_1_m = 0.04f, .kind = 0};
    f = velum_fields_mix(a, b, 0.5f);
    assert_true(fabsf(f.coverage - 0.6f) < 1e-6f && fabsf(f.base_m - 1200.0f) < 0.01f);
    f = velum_fields_mix(a, b, 1.0f);
    assert_true(f.base_m == 1600.0f && f.kind == 0.0f);
}

static void texels_give_back_fields(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 1000; i++) {
        float height_m = -1000.0f + 26000.0f * velum_hash_unit(velum_hash_2(i, 1));
        float wind_m_s = -127.0f + 254.0f * velum_hash_unit(velum_hash_2(i, 2));
        float extinction = expf(-15.0f + 17.0f * velum_hash_unit(velum_hash_2(i, 3)));
        float h = roundf(65535.0f * velum_texel_from_height(height_m)) / 65535.0f;
        float w = roundf(65535.0f * velum_texel_from_wind(wind_m_s)) / 65535.0f;
        float e = roundf(65535.0f * velum_texel_from_extinction(extinction)) / 65535.0f;
        velum_slot_fields f = velum_fields_of_texels(0.5f, h, h, e, w, w, w, 1.0f);
        assert_true(fabsf(f.base_m - height_m) < 0.25f && fabsf(f.wind_x_m_s - wind_m_s) < 0.003f);
        assert_true(fabsf(f.extinction_1_m / extinction - 1.0f) < 2e-4f);
    }
    float calm = roundf(65535.0f * velum_texel_from_wind(0.0f)) / 65535.0f;
    assert_true(fabsf(velum_texel_wind_m_s(calm)) < 1e-4f);
}

static void extinction_is_only_between_base_and_top(void **state) {
    (void)state;
    velum_slot_fields f = {.coverage = 1.0f, .base_m = 1000, .top_m = 2000, .extinction_1_m = 0.04f};
    for (int slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        f.kind = slot == VELUM_SLOT_STORM ? VELUM_KIND_CB : 0.0f;
        assert_true(velum_slot_extinction(slot, f, 999.0f, 1.0f, 1.0f, 1.0f) == 0.0f);
        assert_true(velum_slot_extinction(slot, f, 2001.0f, 1.0f, 1.0f, 1.0f) == 0.0f);
        assert_true(velum_slot_extinction(slot, f, 1500.0f, 1.0f, 1.0f, 1.0f) > 0.0f);
        velum_slot_fields clear = f;
        clear.coverage = 0.0f;
        assert_true(velum_slot_extinction(slot, clear, 1500.0f, 1.0f, 1.0f, 1.0f) == 0.0f);
    }
    /* Uniform: the layer's own extinction, faces included. */
    assert_true(velum_slot_extinction(VELUM_SLOT_UNIFORM, f, 1000.0f, 0.0f, 0.0f, 0.5f) == 0.04f);
    assert_true(velum_slot_extinction(VELUM_SLOT_UNIFORM, f, 2000.0f, 0.0f, 0.0f, 0.5f) == 0.04f);
}

/* Under the edge of a storm's anvil nothing stands, and in its middle all of an overcast: the fewer towers the nearer
 * the edge, at any height; an anvil is there all the same, thinner than towers. */
static void storms_are_anvils_alone_at_their_edges(void **state) {
    (void)state;
    velum_slot_fields f = {.coverage = 0.7f, .base_m = 1000.0f, .top_m = 11000.0f, .extinction_1_m = 0.06f};
    float last[64] = {0};
    for (int k = 0; k <= 20; k++) {
        f.kind = 0.05f * (float)k;
        const velum_profile p = velum_profile_of(VELUM_SLOT_STORM, f);
        for (int i = 0; i < 64; i++) {
            const float z = ((float)i + 0.5f) / 64.0f;
            const float now = velum_body(p, 0.8f, z, 10000.0f * z, 1.0f, 1.0f);
            assert_true(now >= last[i] * 0.999f || z > VELUM_ICE_LOW);
            assert_true(k > 0 || z > VELUM_ANVIL_LOW || now == 0.0f);
            assert_true(k < 20 || now > 0.0f || z > VELUM_ANVIL_HIGH);
            last[i] = now;
        }
        const float anvil = velum_body(p, 0.8f, VELUM_ICE_HIGH + 0.04f, 8800.0f, 1.0f, 1.0f);
        assert_true(anvil > 0.0f && anvil < 0.2f * p.density_scale);
    }
}

/* Between two height fractions the threshold is no lower than its bound, which is the threshold itself at one of them.
 */
static void thresholds_are_no_lower_between_two_heights(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 2000; i++) {
        const velum_slot_fields f = {.coverage = velum_hash_unit(velum_hash_2(i, 1)),
                                     .base_m = 1000.0f,
                                     .top_m = 9000.0f,
                                     .extinction_1_m = 0.05f,
                                     .kind = velum_hash_unit(velum_hash_2(i, 2))};
        const velum_profile p = velum_profile_of((int)(i % VELUM_SLOT_UNIFORM), f);
        const float a = velum_hash_unit(velum_hash_2(i, 3));
        const float b = velum_hash_unit(velum_hash_2(i, 4));
        const float low = fminf(a, b);
        const float high = fmaxf(a, b);
        const float least = velum_threshold_between(p, low, high);
        for (int k = 0; k <= 50; k++) {
            const float z = low + (high - low) * (float)k / 50.0f;
            assert_true(velum_threshold(p, z) >= least - 1e-6f);
            assert_true(velum_threshold(p, z) >= velum_threshold_least(p, z));
        }
        assert_float_equal(velum_threshold_between(p, low, low), velum_threshold(p, low), 1e-6f);
    }
}

/* Wisps where a column is hardly covered and where fine detail leaves crumbs, crisp hearts; ice as soft as it is thin;
 * rolls alike everywhere. */
static void rims_are_softer_than_hearts(void **state) {
    (void)state;
    velum_slot_fields f = {
        .coverage = 0.5f, .base_m = 1000.0f, .top_m = 2400.0f, .extinction_1_m = 0.05f, .kind = 0.5f};
    const velum_profile heap = velum_profile_of(VELUM_SLOT_CUMULUS, f);
    assert_true(heap.rim > 1.0f);
    assert_float_equal(velum_softness(heap, 0.0f, 1.0f, 0.0f), heap.rim * heap.softness, 1e-6);
    assert_float_equal(velum_softness(heap, 1.0f, 0.0f, 0.0f), heap.rim * heap.softness, 1e-6);
    assert_float_equal(velum_softness(heap, 1.0f, 1.0f, 0.0f), heap.softness, 1e-6);
    assert_float_equal(velum_softness(heap, 0.2f, 0.2f, 1.0f), VELUM_ANVIL_SOFTNESS, 1e-6);
    float thinner = INFINITY;
    float smaller = INFINITY;
    for (int i = 0; i <= 100; i++) {
        const float x = 0.01f * (float)i;
        assert_true(velum_softness(heap, x, 1.0f, 0.0f) <= thinner);
        assert_true(velum_softness(heap, 1.0f, x, 0.0f) <= smaller);
        thinner = velum_softness(heap, x, 1.0f, 0.0f);
        smaller = velum_softness(heap, 1.0f, x, 0.0f);
    }
    /* A crumb, which all finer detail would take, and a flank that detail has carved: of one column and one margin. */
    const float e = 0.9f;
    const float z = 0.5f;
    const float margin = 0.02f;
    const float crumb_lump = 0.6f - (e - velum_threshold(heap, z) - margin) / heap.amplitude;
    const float flank_lump = crumb_lump + 0.22f / heap.amplitude;
    const float flank_fine = VELUM_FINE_NONE - 0.22f / heap.erosion;
    assert_float_equal(velum_margin(heap, e, z, crumb_lump, VELUM_FINE_NONE), margin, 1e-5);
    assert_float_equal(velum_margin(heap, e, z, flank_lump, flank_fine), margin, 1e-5);
    assert_true(velum_body(heap, e, z, 700.0f, crumb_lump, VELUM_FINE_NONE) <
                0.25f * velum_body(heap, e, z, 700.0f, flank_lump, flank_fine));
    f.kind = 1.0f;
    const velum_profile rolls = velum_profile_of(VELUM_SLOT_LOW, f);
    assert_float_equal(velum_softness(rolls, 0.0f, 0.0f, 0.0f), velum_softness(rolls, 1.0f, 1.0f, 0.0f), 1e-6);
}

/* Tiles and the reference skip by these bounds. */
static void anvils_cover_no_faster_than_their_bounds(void **state) {
    (void)state;
    const float step = 1.0e-3f;
    double slope = 0.0;
    double metre = 0.0;
    for (float wind_m_s = 1.0f; wind_m_s <= 120.0f; wind_m_s += 1.0f) {
        velum_slot_fields f = {.base_m = 0.0f, .top_m = VELUM_ANVIL_COVER_M, .kind = 1.0f, .wind_x_m_s = wind_m_s};
        velum_slot_fields farther = f;
        farther.wind_x_m_s += 0.01f;
        const double none = (double)velum_beside(f);
        const double far_m = (double)velum_anvil_m(f);
        const double more_m = (double)velum_anvil_m(farther) - far_m;
        for (f.coverage = 0.0f; f.coverage <= 1.0f - step; f.coverage += step) {
            velum_slot_fields more = f;
            more.coverage += step;
            farther.coverage = f.coverage;
            assert_true(velum_beside(f) >= 0.0f && (double)velum_beside(f) <= none);
            slope = fmax(slope, fabs((double)velum_beside(more) - (double)velum_beside(f)) / ((double)step * none));
            if (more_m > 0.1 * 0.01 * VELUM_ANVIL_LAG_S) {
                metre = fmax(metre, ((double)velum_beside(farther) - (double)velum_beside(f)) / more_m);
            }
        }
    }
    assert_true(slope <= (double)VELUM_BESIDE_SLOPE && slope > 0.9 * (double)VELUM_BESIDE_SLOPE);
    assert_true(metre <= (double)VELUM_BESIDE_1_M && metre > 0.9 * (double)VELUM_BESIDE_1_M);
}

static void extinction_stays_finite_and_positive(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 200000; i++) {
        velum_slot_fields f = {.coverage = velum_hash_unit(velum_hash_2(i, 1)),
                               .base_m = -900.0f,
                               .top_m = -900.0f + 25000.0f * powf(velum_hash_unit(velum_hash_2(i, 2)), 6.0f),
                               .extinction_1_m = expf(-15.0f + 17.0f * velum_hash_unit(velum_hash_2(i, 3))),
                               .kind = velum_hash_unit(velum_hash_2(i, 4))};
        float height_m = f.base_m + (f.top_m - f.base_m) * velum_hash_unit(velum_hash_2(i, 5));
        float found = velum_slot_extinction(
            (int)(i % VELUM_SLOT_COUNT), f, height_m, velum_hash_unit(velum_hash_2(i, 6)),
            2.0f * velum_hash_unit(velum_hash_2(i, 7)) - 1.0f, velum_hash_unit(velum_hash_2(i, 8)));
        assert_true(isfinite(found) && found >= 0.0f && found < 20.0f * f.extinction_1_m);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hash_is_pcg),
        cmocka_unit_test(hash_units_are_even),
        cmocka_unit_test(mixed_ranks_are_uniform),
        cmocka_unit_test(mixed_ranks_begin_and_end_with_one_alone),
        cmocka_unit_test(mixed_details_keep_their_variance),
        cmocka_unit_test(states_mix_by_their_coverage),
        cmocka_unit_test(texels_give_back_fields),
        cmocka_unit_test(extinction_is_only_between_base_and_top),
        cmocka_unit_test(storms_are_anvils_alone_at_their_edges),
        cmocka_unit_test(thresholds_are_no_lower_between_two_heights),
        cmocka_unit_test(rims_are_softer_than_hearts),
        cmocka_unit_test(anvils_cover_no_faster_than_their_bounds),
        cmocka_unit_test(extinction_stays_finite_and_positive),
    };
    return cmocka_run_group_tests_name("sample", tests, NULL, NULL);
}
