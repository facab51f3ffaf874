/* The shared functions on a device against the same text compiled as C.
 *
 * Bounds are for any conforming device: Vulkan 1.3 (appendix "Precision and Operation of SPIR-V Instructions") allows
 * 2.5 ulp in divisions, 3 + 2|x| ulp in exp2, 2^-21 in log2 near 1 and 3 ulp elsewhere, and fused multiply-adds. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "air.spv.h"
#include "case_air.h"
#include "case_density.h"
#include "case_hash.h"
#include "case_phase.h"
#include "case_planet.h"
#include "case_sample.h"
#include "case_tile.h"
#include "compute.h"
#include "density.spv.h"
#include "hash.spv.h"
#include "phase.spv.h"
#include "planet.spv.h"
#include "sample.spv.h"
#include "tile.spv.h"
#include "value_inputs.h"

enum { CASES = 1 << 16, OUT_MAX = 19 };

/* |device - C| <= (absolute + relative |C|) * scale; both 0: the same bits. */
typedef struct bound {
    const char *name;
    double absolute, relative;
} bound;

typedef struct value_case {
    const uint32_t *spirv;
    size_t spirv_bytes;
    uint32_t in_words, out_words;
    void (*fill)(uint32_t i, uint32_t *in);
    void (*evaluate)(const uint32_t *in, uint32_t *out);
    double (*scale)(const uint32_t *in, const uint32_t *out, uint32_t n); /* null: 1; negative: nothing is promised */
    const bound *bounds;
} value_case;

static compute_device device;
static char no_device[256];

static int open_device(void **state) {
    (void)state;
    compute_open(&device, no_device);
    return 0;
}
static int close_device(void **state) {
    (void)state;
    compute_close(&device);
    return 0;
}

static void compare(const value_case *c, const uint32_t *in, const uint32_t *got, const uint32_t *expected) {
    uint32_t failures = 0;
    for (uint32_t n = 0; n < c->out_words; n++) {
        double worst = 0.0;
        double worst_absolute = 0.0;
        double worst_relative = 0.0;
        uint32_t compared = 0;
        const bound *b = &c->bounds[n];
        for (uint32_t i = 0; i < CASES; i++) {
            uint32_t word = got[i * c->out_words + n];
            uint32_t want = expected[i * c->out_words + n];
            double scale = c->scale ? c->scale(in + i * c->in_words, expected + i * c->out_words, n) : 1.0;
            if (scale < 0.0) { /* beside a border, whole numbers are neighbours */
                bool whole = b->absolute == 0.0 && b->relative == 0.0;
                failures += whole && word != want && word + 1u != want && word != want + 1u;
                continue;
            }
            compared++;
            bool good = word == want;
            if (!good && (b->absolute > 0.0 || b->relative > 0.0)) {
                double x = word_float(word);
                double y = word_float(want);
                double error = fabs(x - y);
                double allowed = (b->absolute + b->relative * fabs(y)) * scale;
                good = error <= allowed || (isnan(x) && isnan(y));
                worst = fmax(worst, error / allowed);
                worst_absolute = fmax(worst_absolute, error / scale);
                worst_relative = fmax(worst_relative, error / scale / fmax(fabs(y), 1e-30));
            }
            if (!good && ++failures <= 8) {
                print_error("%s of case %u: device %08x %.9g, C %08x %.9g\n", b->name, i, word,
                            (double)word_float(word), want, (double)word_float(want));
            }
        }
        print_message("%-14s %5u compared, greatest error %.2g absolute, %.2g relative, %.2f of the bound\n", b->name,
                      compared, worst_absolute, worst_relative, worst);
        assert_true(compared > CASES / 2);
    }
    assert_int_equal(failures, 0);
}

static void check(const value_case *c) {
    if (!device.device) {
        print_message("no device: %s\n", no_device);
        skip();
    }
    uint32_t *in = calloc(CASES, sizeof *in * c->in_words);
    uint32_t *got = calloc(CASES, sizeof *got * c->out_words);
    uint32_t *expected = calloc(CASES, sizeof *expected * c->out_words);
    assert_true(in && got && expected);
    for (uint32_t i = 0; i < CASES; i++) {
        c->fill(i, in + i * c->in_words);
        c->evaluate(in + i * c->in_words, expected + i * c->out_words);
    }
    compute_job job = {.spirv = c->spirv,
                       .spirv_bytes = c->spirv_bytes,
                       .input = in,
                       .input_bytes = CASES * sizeof *in * c->in_words,
                       .output = got,
                       .output_bytes = CASES * sizeof *got * c->out_words,
                       .invocations = CASES};
    bool run = compute_run(&device, &job);
    if (run) {
        compare(c, in, got, expected);
    }
    free(expected);
    free(got);
    free(in);
    assert_true(run);
}

static void hashes_and_keys_are_the_same_bit_for_bit(void **state) {
    (void)state;
    static const bound bounds[] = {{"hash", 0, 0},      {"hash_2", 0, 0}, {"hash_3", 0, 0},    {"hash_4", 0, 0},
                                   {"hash_unit", 0, 0}, {"key", 0, 0},    {"level", 0, 0},     {"face", 0, 0},
                                   {"x", 0, 0},         {"y", 0, 0},      {"table_hash", 0, 0}};
    check(
        &(value_case){hash_spirv, sizeof hash_spirv, CASE_HASH_IN, CASE_HASH_OUT, fill_hash, case_hash, NULL, bounds});
}

/* How far from a border of levels, in levels; a device's log2 may err by 3 ulp of 12 and the ratio by 3 ulp. */
#define LEVEL_BORDER 4e-6

static double tile_scale(const uint32_t *in, const uint32_t *out, uint32_t n) {
    (void)out;
    double ratio = 4.0 * (double)word_float(in[4]) * 1e7 / fmax((double)word_float(in[3]), 1.0);
    double level = log2(fmax(ratio, 1.0));
    bool border = fabs(level - round(level)) < LEVEL_BORDER && ratio > 0.9 && level < 13.0;
    return n == 1 && border ? -1.0 : 1.0;
}

static void tiles_have_the_same_faces_and_levels(void **state) {
    (void)state;
    static const bound bounds[] = {{"face", 0, 0}, {"level", 0, 0},           {"u", 1e-6, 0},
                                   {"v", 1e-6, 0}, {"coordinate u", 6e-7, 0}, {"coordinate v", 6e-7, 0}};
    check(&(value_case){tile_spirv, sizeof tile_spirv, CASE_TILE_IN, CASE_TILE_OUT, fill_tile, case_tile, tile_scale,
                        bounds});
}

/* Heights come from numbers of |r| a: they err with distance. Spans err with the discriminant's error over its root. */
static double planet_scale(const uint32_t *in, const uint32_t *out, uint32_t n) {
    double scale = 1.0;
    if (n == 0) {
        double r = sqrt(pow(word_float(in[8]), 2) + pow(word_float(in[9]), 2) + pow(word_float(in[10]), 2));
        scale = 0.01 + 1e-6 * (r + fabs((double)word_float(out[0])));
    } else if (n >= 4) {
        double e[3];
        double d[3];
        double a = 0.0;
        double b = 0.0;
        for (uint32_t k = 0; k < 3; k++) {
            d[k] = (double)word_float(in[11 + k]) * (k == 2 ? (double)VELUM_SCALE_Z : 1.0);
            e[k] = (double)word_float(in[k]) * (double)word_float(in[3]);
            a += d[k] * d[k];
            b += e[k] * d[k];
        }
        double over = word_float(in[14]);
        double c = (double)word_float(in[4]) - over * (2.0 * (double)VELUM_WGS84_A_M + over);
        double discriminant = b * b - a * c;
        double error = fabs(c) < 1.1e10 ? 1e-6 * (b * b + fabs(c)) + 1.0 : 4.0 * (double)VELUM_WGS84_A_M;
        if (fabs(c) > 0.9e10 && fabs(c) < 1.1e10) {
            error = fmax(error, 4.0 * (double)VELUM_WGS84_A_M);
        }
        if (discriminant < 2.0 * error && discriminant > -2.0 * error) {
            return -1.0; /* touches, or just fails to */
        }
        double root = sqrt(fmax(discriminant, error));
        double far = fabs(b) + root;
        scale = 1e-3 + error / root + 1e-6 * far;
        /* The near root is c over the far one, and c itself carries the eye's error. */
        scale = fmax(scale, 1.0 / far);
    }
    return scale;
}

static void places_and_spans_agree(void **state) {
    (void)state;
    static const bound bounds[] = {{"height_m", 1, 0}, {"nx", 3e-7, 0},   {"ny", 3e-7, 0},
                                   {"nz", 3e-7, 0},    {"enter_m", 1, 0}, {"leave_m", 1, 0}};
    check(&(value_case){planet_spirv, sizeof planet_spirv, CASE_PLANET_IN, CASE_PLANET_OUT, fill_planet, case_planet,
                        planet_scale, bounds});
}

static void phase_functions_agree(void **state) {
    (void)state;
    static const bound bounds[] = {
        {"hg", 0, 1e-5},          {"draine", 0, 1e-5},   {"mean_cosine", 1e-7, 1e-5}, {"g_hg", 0, 1e-6},
        {"g_draine", 0, 1e-6},    {"alpha", 0, 2e-6},    {"weight_draine", 0, 1e-6},  {"droplet_at", 0, 3e-4},
        {"cloud water", 0, 1e-4}, {"cloud ice", 0, 1e-5}};
    check(&(value_case){phase_spirv, sizeof phase_spirv, CASE_PHASE_IN, CASE_PHASE_OUT, fill_phase, case_phase, NULL,
                        bounds});
}

static double air_scale(const uint32_t *in, const uint32_t *out, uint32_t n) {
    double scale = 1.0;
    if (n == 4) {
        scale = 1.0 + fabs((double)word_float(in[0])) + fabs((double)word_float(in[2]));
    } else if (n == 8) {
        /* mu = (longest^2 - rho^2 - d^2) / (2 r d): its error grows as the distance d to the top shrinks. */
        double h = word_float(out[7]);
        double d = (1e5 - h) + (double)word_float(in[3]) * 1e6;
        scale = d < 100.0 ? -1.0 : 1.0 + 1e5 / d;
    }
    return scale;
}

static void air_agrees(void **state) {
    (void)state;
    static const bound bounds[] = {
        {"rayleigh", 1e-30, 2e-5}, {"aerosol", 1e-30, 4e-5}, {"ozone", 5e-7, 0}, {"fog_density", 1e-6, 0},
        {"fog_column", 3e-7, 0},   {"u", 1e-5, 0},           {"v", 1e-6, 0},     {"height_m", 0.02, 1e-6},
        {"mu", 3e-6, 0},           {"horizon_mu", 0, 1e-6}};
    check(&(value_case){air_spirv, sizeof air_spirv, CASE_AIR_IN, CASE_AIR_OUT, fill_air, case_air, air_scale, bounds});
}

static void fields_and_mixes_agree(void **state) {
    (void)state;
    static const bound bounds[] = {{"height", 1e-3, 1e-6},   {"extinction", 0, 1e-5}, {"wind", 1e-5, 1e-6},
                                   {"from_height", 3e-7, 0}, {"from_ext.", 3e-7, 0},  {"from_wind", 3e-7, 0},
                                   {"rank_mix", 2e-6, 0},    {"detail_mix", 1e-6, 0}, {"coverage", 3e-7, 0},
                                   {"base_m", 0, 1e-6},      {"top_m", 0, 1e-6},      {"extinction", 0, 4e-5},
                                   {"wind_x", 1e-4, 0},      {"wind_y", 1e-4, 0},     {"wind_z", 1e-4, 0},
                                   {"kind", 1e-6, 0},        {"noise x", 3e-4, 0},    {"noise y", 3e-4, 0},
                                   {"noise z", 3e-4, 0},     {"north_m", 2.0, 1e-6},  {"waves_m", 0.5, 0}};
    check(&(value_case){sample_spirv, sizeof sample_spirv, CASE_SAMPLE_IN, CASE_SAMPLE_OUT, fill_sample, case_sample,
                        NULL, bounds});
}

static double density_scale(const uint32_t *in, const uint32_t *out, uint32_t n) {
    (void)out;
    double base = word_float(in[2]);
    double top = word_float(in[3]);
    double height = word_float(in[6]);
    bool number = !isnan(height) && !isnan(word_float(in[1]));
    double scale = 1.0;
    if (!number && n > 0) {
        scale = -1.0;
    } else if (number && n == 0) {
        double z = (height - base) / (top - base);
        scale = in[0] < VELUM_SLOT_UNIFORM && fabs(z - 1.0) < 1e-6 ? -1.0 : (double)word_float(in[4]);
    } else if (n == 1) {
        scale = 1.0 / fmax((double)word_float(in[1]), 1e-3);
    } else if (n == 2 && (height < base || height > top)) {
        scale = -1.0;
    }
    return scale;
}

static void extinction_agrees(void **state) {
    (void)state;
    static const bound bounds[] = {{"extinction", 3e-4, 0}, {"excess", 2e-6, 0},    {"threshold", 1e-5, 0},
                                   {"periods", 0, 0},       {"lean x", 0.02, 1e-6}, {"lean y", 0.02, 1e-6},
                                   {"lean z", 0.02, 1e-6}};
    check(&(value_case){density_spirv, sizeof density_spirv, CASE_DENSITY_IN, CASE_DENSITY_OUT, fill_density,
                        case_density, density_scale, bounds});
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hashes_and_keys_are_the_same_bit_for_bit),
        cmocka_unit_test(tiles_have_the_same_faces_and_levels),
        cmocka_unit_test(places_and_spans_agree),
        cmocka_unit_test(phase_functions_agree),
        cmocka_unit_test(air_agrees),
        cmocka_unit_test(fields_and_mixes_agree),
        cmocka_unit_test(extinction_agrees),
    };
    return cmocka_run_group_tests(tests, open_device, close_device);
}
