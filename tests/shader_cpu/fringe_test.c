/* Scud and precipitation as functions of their arguments: the published relations, and what must hold anywhere. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "shared/fringe.h"

static velum_slot_fields fields_of(float coverage, float base_m, float top_m, float extinction_1_m, float kind) {
    return (velum_slot_fields){
        .coverage = coverage, .base_m = base_m, .top_m = top_m, .extinction_1_m = extinction_1_m, .kind = kind};
}

static float fall_of(double rate_mm_h) {
    return (float)pow(rate_mm_h, 0.25);
}

/* Extinction of drops N0 exp(-L D), efficiency 2, by the trapezoidal rule: 2 pi / 4 of the sum of D^2 N. */
static double of_spectrum(double n0_1_m4, double slope_1_m) {
    const double step_m = 1e-5;
    double sum = 0.0;
    for (int i = 1; i < 20000; i++) {
        const double d = i * step_m;
        sum += d * d * n0_1_m4 * exp(-slope_1_m * d) * step_m;
    }
    return 0.5 * acos(-1.0) * sum;
}

static void rain_extinguishes_as_its_drops_do(void **state) {
    (void)state;
    static const struct {
        float kind;
        double n0_1_m4, slope_1_m;
    } spectra[] = {{VELUM_FALL_SHOWER, 1.4e6, 3000.0}, /* Joss et al. 1968 */
                   {VELUM_FALL_RAIN, 8.0e6, 4100.0},   /* Marshall & Palmer 1948 */
                   {VELUM_FALL_DRIZZLE, 3.0e7, 5700.0}};
    for (size_t i = 0; i < sizeof spectra / sizeof spectra[0]; i++) {
        static const double rates[] = {1.0, 10.0, 100.0};
        for (int k = 0; k < 3; k++) {
            const double published = of_spectrum(spectra[i].n0_1_m4, spectra[i].slope_1_m * pow(rates[k], -0.21));
            const double found = (double)velum_fall_extinction_1_m(fall_of(rates[k]), spectra[i].kind);
            assert_true(fabs(found / published - 1.0) < 0.005);
        }
    }
    /* Within what others have measured for all rain, 0.16 to 0.36 R^0.63..0.68 1/km (Atlas 1953; Shipley et al. 1974).
     */
    assert_true(velum_fall_extinction_1_m(1.0f, VELUM_FALL_SHOWER) >= 1.6e-4f);
    assert_true(velum_fall_extinction_1_m(1.0f, VELUM_FALL_RAIN) <= 3.7e-4f);
}

static void snow_extinguishes_ten_times_as_much(void **state) {
    (void)state;
    static const double rates[] = {1.0, 2.0, 4.0};
    for (int k = 0; k < 3; k++) {
        /* Melted diameters (Gunn & Marshall 1958); sections of flakes of a tenth of the density. */
        const double n0 = 3.8e6 * pow(rates[k], -0.87);
        const double slope = 2550.0 * pow(rates[k], -0.48);
        const double published = of_spectrum(n0, slope) * pow(10.0, 2.0 / 3.0);
        const double found = (double)velum_fall_extinction_1_m(fall_of(rates[k]), VELUM_FALL_SNOW);
        assert_true(fabs(found / published - 1.0) < 0.02);
        const double over_rain = found / (double)velum_fall_extinction_1_m(fall_of(rates[k]), VELUM_FALL_RAIN);
        assert_true(over_rain > 7.0 && over_rain < 12.0);
    }
}

static void extinction_grows_with_rate_and_with_smallness(void **state) {
    (void)state;
    for (int k = 0; k <= 20; k++) {
        const float kind = (float)k / 20.0f;
        float last = 0.0f;
        assert_true(velum_fall_extinction_1_m(0.0f, kind) == 0.0f);
        for (double rate = 0.001; rate < 500.0; rate *= 1.3) {
            const float now = velum_fall_extinction_1_m(fall_of(rate), kind);
            assert_true(now > last);
            assert_true(k == 0 || now > velum_fall_extinction_1_m(fall_of(rate), kind - 0.05f));
            last = now;
        }
    }
}

/* d sqrt(P) / d depth = - rho k (1 - RH) / 2 in steps of a metre, P in kg m-2 s-1, 1 - RH = depth / 2500 m. */
static double evaporated_mm_h(double rate_mm_h, double depth_m) {
    double root = sqrt(rate_mm_h / 3600.0);
    for (double d = 0.5; d < depth_m; d += 1.0) {
        root -= 0.5 * 1.1 * 1e-5 * d / 2500.0;
    }
    return root > 0.0 ? 3600.0 * root * root : 0.0;
}

static void what_is_left_is_what_has_not_evaporated(void **state) {
    (void)state;
    static const double rates[] = {0.02, 0.3, 4.0, 60.0};
    for (int i = 0; i < 4; i++) {
        for (double depth_m = 0.0; depth_m < 9000.0; depth_m += 500.0) {
            const double left = pow((double)velum_fall_left(fall_of(rates[i]), (float)depth_m), 4.0);
            assert_true(fabs(left - evaporated_mm_h(rates[i], depth_m)) < 0.01 * rates[i]);
        }
    }
}

/* Columns of all ranks; the layer's own profile. */
static void drizzle_from_altostratus_is_virga_and_a_shower_is_not(void **state) {
    (void)state;
    const velum_slot_fields as = fields_of(1.0f, 3400.0f, 5000.0f, 0.02f, VELUM_KIND_AS);
    const velum_profile p = velum_profile_of(VELUM_SLOT_MIDDLE, as);
    const velum_fringe light = {.fall = fall_of(0.1), .fall_kind = VELUM_FALL_SNOW};
    const velum_span_m span = velum_fall_span(as, light);
    assert_true(span.low > 1000.0f && span.low < 1400.0f); /* 3400 m less 3900 m times 0.1^(1/4) */
    float last = 1.0f;
    for (float h = as.base_m; h > 0.0f; h -= 25.0f) {
        const float now = velum_fall_1_m(p, as, light, 1.0f, h, 0.5f);
        assert_true(now <= last && (h <= span.low) == (now == 0.0f));
        last = now;
    }
    const velum_slot_fields cb = fields_of(0.9f, 1100.0f, 11000.0f, 0.06f, VELUM_KIND_CB);
    const velum_fringe heavy = {.fall = fall_of(40.0), .fall_kind = VELUM_FALL_SHOWER};
    const velum_profile tower = velum_profile_of(VELUM_SLOT_STORM, cb);
    const float base = velum_fall_1_m(tower, cb, heavy, 1.0f, 1100.0f, 0.5f);
    assert_true(fabs((double)(base / velum_fall_extinction_1_m(heavy.fall, VELUM_FALL_SHOWER)) - 1.0) < 1e-5);
    assert_true(velum_fall_1_m(tower, cb, heavy, 1.0f, 0.0f, 0.5f) > 0.9f * base);
}

static void it_falls_only_from_thick_columns_and_within_its_bounds(void **state) {
    (void)state;
    static const struct {
        int slot;
        float kind;
    } kinds[] = {{VELUM_SLOT_LOW, VELUM_KIND_ST},   {VELUM_SLOT_LOW, VELUM_KIND_SC}, {VELUM_SLOT_CUMULUS, 0.0f},
                 {VELUM_SLOT_STORM, VELUM_KIND_CB}, {VELUM_SLOT_MIDDLE, 0.5f},       {VELUM_SLOT_MIDDLE, 0.0f},
                 {VELUM_SLOT_HIGH, VELUM_KIND_CI}};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const velum_slot_fields f = fields_of(0.7f, 1500.0f, 4000.0f, 0.05f, kinds[i].kind);
        const velum_profile p = velum_profile_of(kinds[i].slot, f);
        const velum_fringe g = {.scud = 0.8f, .fall = fall_of(5.0), .fall_kind = VELUM_FALL_RAIN};
        const velum_span_m fall = velum_fall_span(f, g);
        const velum_span_m scud = velum_scud_span(f, g);
        float most = 0.0f;
        for (float h = -700.0f; h < 4000.0f; h += 7.0f) {
            for (int k = -4; k <= 20; k++) {
                const float e = (float)k / 20.0f;
                for (int n = 0; n <= 4; n++) {
                    const float noise = 0.25f * (float)n;
                    const float rain = velum_fall_1_m(p, f, g, e, h, noise);
                    const float rags = velum_scud_1_m(p, f, g, e, h, noise);
                    assert_true(rain >= 0.0f && rain <= velum_fall_most_1_m(g));
                    assert_true(rags >= 0.0f && rags <= velum_scud_most_1_m(f, g));
                    assert_true(rain == 0.0f || (h >= fall.low && h <= fall.high && e > 0.0f));
                    assert_true(rags == 0.0f || (h >= scud.low && h <= scud.high && e > 0.0f));
                    most = fmaxf(most, rain);
                }
            }
        }
        /* A bound, and not a boundless one. */
        assert_true(most > 0.6f * velum_fall_most_1_m(g));
    }
}

/* No band lies at the base of what stands on none: under the edge of an anvil. */
static void bands_lie_under_towers(void **state) {
    (void)state;
    const velum_fringe g = {.transition_m = 600.0f};
    for (int k = 0; k <= 20; k++) {
        const velum_slot_fields f = fields_of(0.6f, 1000.0f, 11000.0f, 0.06f, 0.05f * (float)k);
        const velum_profile p = velum_profile_of(VELUM_SLOT_STORM, f);
        for (int i = 0; i <= 20; i++) {
            const float e = 0.05f * (float)i;
            const bool stands = e > velum_threshold(p, 0.0f) + 1e-6f;
            assert_true((velum_band_1_m(p, f, g, e, 900.0f) > 0.0f) == stands);
        }
    }
}

static void scud_grows_with_what_is_asked_for_and_is_none_for_none(void **state) {
    (void)state;
    const velum_slot_fields f = fields_of(1.0f, 900.0f, 1800.0f, 0.06f, VELUM_KIND_SC);
    const velum_profile p = velum_profile_of(VELUM_SLOT_LOW, f);
    double last_sum = 0.0;
    float last_low_m = 1e9f;
    for (int s = 0; s <= 10; s++) {
        const velum_fringe g = {.scud = 0.1f * (float)s};
        const velum_fringe less = {.scud = fmaxf(0.1f * (float)s - 0.1f, 0.0f)};
        double sum = 0.0;
        float low_m = 1e9f;
        for (float h = 300.0f; h < 1000.0f; h += 5.0f) {
            for (int n = 0; n <= 20; n++) {
                const float noise = 0.05f * (float)n;
                for (float e = 0.02f; e < 0.5f; e += 0.02f) {
                    assert_true(velum_scud_1_m(p, f, g, e, h, noise) >= velum_scud_1_m(p, f, less, e, h, noise));
                }
                const float now = velum_scud_1_m(p, f, g, 0.5f, h, noise);
                assert_true(now >= velum_scud_1_m(p, f, less, 0.5f, h, noise));
                assert_true(s > 0 || now == 0.0f);
                sum += (double)now;
                low_m = now > 0.0f ? fminf(low_m, h) : low_m;
            }
        }
        assert_true(s == 0 || (sum > last_sum && low_m <= last_low_m));
        last_sum = sum;
        last_low_m = low_m;
    }
    assert_true(last_low_m < 600.0f && last_low_m >= 400.0f); /* 500 m under the base at most */
}

/* What has no cloud over it ends in the air, the lower the farther out it hangs, and not flat at the base; where no
 * tower stands, under the edge of a storm's anvil, there is none. */
static void scud_ends_in_the_air_where_no_cloud_is_over_it(void **state) {
    (void)state;
    static const struct {
        int slot;
        float kind;
    } kinds[] = {{VELUM_SLOT_LOW, VELUM_KIND_SC},
                 {VELUM_SLOT_CUMULUS, 0.0f},
                 {VELUM_SLOT_STORM, VELUM_KIND_CB},
                 {VELUM_SLOT_STORM, 0.7f}};
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        const velum_slot_fields f = fields_of(0.6f, 900.0f, 3000.0f, 0.06f, kinds[i].kind);
        const velum_profile p = velum_profile_of(kinds[i].slot, f);
        const velum_fringe g = {.scud = 1.0f};
        const float stands = velum_threshold(p, 0.0f);
        const float whole = velum_carve(p, 0.0f, 0.0f, 0.5f);
        float last_top_m = 0.0f;
        for (int k = -10; k <= 10; k++) {
            const float e = stands + whole * 0.1f * (float)k;
            float top_m = 0.0f;
            for (float h = 300.0f; h < 1000.0f; h += 2.0f) {
                top_m = velum_scud_1_m(p, f, g, e, h, 0.8f) > 0.0f ? h : top_m;
            }
            assert_true(k > 0 || top_m == 0.0f);
            assert_true(top_m >= last_top_m);
            assert_true(k > 5 || top_m < f.base_m - 60.0f);
            last_top_m = top_m;
        }
        assert_true(last_top_m > f.base_m - 60.0f);
        assert_true(velum_scud_1_m(p, f, g, stands + 0.7f, f.base_m, 0.8f) > 0.0f);
    }
}

/* Steps of half a metre change it by little. */
static void nothing_of_it_has_an_edge(void **state) {
    (void)state;
    const velum_slot_fields f = fields_of(1.0f, 1200.0f, 4000.0f, 0.06f, 0.5f);
    const velum_profile p = velum_profile_of(VELUM_SLOT_MIDDLE, f);
    const velum_fringe g = {.scud = 0.6f, .fall = fall_of(0.01), .fall_kind = VELUM_FALL_RAIN};
    for (int part = 0; part < 3; part++) { /* the last: scud that hangs at a rim */
        const velum_span_m span = part ? velum_scud_span(f, g) : velum_fall_span(f, g);
        const float most = part ? velum_scud_most_1_m(f, g) : velum_fall_most_1_m(g);
        const float e = part == 2 ? velum_threshold(p, 0.0f) + 0.08f : 0.5f;
        float last = 0.0f;
        for (int i = 0; i <= 4000; i++) {
            const float h = velum_mix(span.low, span.high, (float)i / 4000.0f);
            const float now = part ? velum_scud_1_m(p, f, g, e, h, 0.75f) : velum_fall_1_m(p, f, g, 0.8f, h, 0.5f);
            assert_true(fabsf(now - last) < 0.02f * most);
            last = now;
        }
        assert_true(last < 0.01f * most);
    }
}

/* Where one state has no such layer, the other's fringe stays what it is. */
static void states_mix_by_coverage(void **state) {
    (void)state;
    const velum_fringe rain = {.scud = 0.5f, .fall = 1.5f, .fall_kind = VELUM_FALL_RAIN};
    const velum_fringe snow = {.scud = 0.1f, .fall = 1.0f, .fall_kind = VELUM_FALL_SNOW};
    const velum_fringe dry = {0};
    velum_fringe mixed = velum_fringe_mix(rain, dry, 0.0f);
    assert_true(mixed.scud == 0.5f && mixed.fall == 1.5f && mixed.fall_kind == VELUM_FALL_RAIN);
    mixed = velum_fringe_mix(dry, snow, 1.0f);
    assert_true(mixed.fall == 1.0f && mixed.fall_kind == VELUM_FALL_SNOW);
    /* What stops raining does not turn to another kind. */
    mixed = velum_fringe_mix(snow, dry, 0.5f);
    assert_true(mixed.fall == 0.5f && mixed.fall_kind == VELUM_FALL_SNOW);
    mixed = velum_fringe_mix(rain, snow, 0.5f);
    assert_true(mixed.fall_kind > VELUM_FALL_RAIN && mixed.fall_kind < VELUM_FALL_SNOW);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rain_extinguishes_as_its_drops_do),
        cmocka_unit_test(snow_extinguishes_ten_times_as_much),
        cmocka_unit_test(extinction_grows_with_rate_and_with_smallness),
        cmocka_unit_test(what_is_left_is_what_has_not_evaporated),
        cmocka_unit_test(drizzle_from_altostratus_is_virga_and_a_shower_is_not),
        cmocka_unit_test(it_falls_only_from_thick_columns_and_within_its_bounds),
        cmocka_unit_test(bands_lie_under_towers),
        cmocka_unit_test(scud_grows_with_what_is_asked_for_and_is_none_for_none),
        cmocka_unit_test(scud_ends_in_the_air_where_no_cloud_is_over_it),
        cmocka_unit_test(nothing_of_it_has_an_edge),
        cmocka_unit_test(states_mix_by_coverage),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
