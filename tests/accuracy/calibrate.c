/* velum-calibrate: writes shaders/shared/calibration.h: what the profiles of shared/density.h must be scaled by so that
 * coverage, water path and tops are those that were asked for.
 *
 * Found for each kind of cloud at half cover, its usual optical depth and thickness; then how that changes with the
 * share of the optical depth that counts as covered, with thickness, and towards overcast. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "columns.h"
#include "shared/hash.h"
#include "trial.h"

velum_calibration trial_calibration = {1.0f, 1.0f, 1.0f};

#define COLUMNS 20000
#define STEPS 48
#define ROUNDS 12
/* Of covered columns, those that the top cuts off: twice the percentile that stands for it. */
#define CUT_SHARE 0.02f
#define OVERCAST 0.993

enum { KINDS = 10 };

typedef struct kind_knot {
    const char *name;
    int slot;
    float kind;
    const column_case *usual;
} kind_knot;

static int compare(const void *a, const void *b) {
    float x = *(const float *)a;
    float y = *(const float *)b;
    return (x > y) - (x < y);
}

/* The factor of `reach` at which CUT_SHARE of covered columns are cloud at the top. */
static float reach_factor(const core_noise *noise, const column_case *of, float coverage) {
    static float left[COLUMNS];
    const double origin[3] = {(double)VELUM_WGS84_A_M, 0.0, 0.0};
    const core_drift drift = core_drift_at(1000.0, 7);
    const core_cloud_noise cloud = core_cloud_noise_at(noise, (uint32_t)of->slot, origin, &drift);
    const velum_slot_fields fields = {.coverage = coverage,
                                      .base_m = of->base_m,
                                      .top_m = of->top_m,
                                      .extinction_1_m = of->extinction_1_m,
                                      .kind = of->kind};
    const velum_profile p = velum_profile_of(of->slot, fields);
    const float sky = fminf(coverage * p.coverage_scale, 1.0f);
    /* Of softness, from where on a top is seen; of ice, which is thin, from farther in. */
    const float thinned = velum_thinned(p, 1.0f);
    const float seen = 0.06f / sqrtf(thinned > 0.0f ? (1.0f - thinned) * p.density_scale * velum_water(p, 1.0f) : 1.0f);
    for (uint32_t i = 0; i < COLUMNS; i++) {
        float at[3];
        for (uint32_t axis = 0; axis < 3; axis++) {
            at[axis] = 1.0e5f * velum_hash_unit(velum_hash_2(i, axis));
        }
        float e = velum_excess(p, coverage, 1.0f - sky * ((float)i + 0.5f) / COLUMNS);
        float lump = core_cloud_lump(&cloud, &fields, at);
        float carved = velum_carve(p, 1.0f, lump, core_cloud_fine(&cloud, &fields, at));
        float fine_carved = carved - velum_carve(p, 1.0f, lump, VELUM_FINE_NONE);
        left[i] = e - carved - seen * velum_softness(p, e, fine_carved, thinned);
    }
    qsort(left, COLUMNS, sizeof left[0], compare);
    int cut = (int)((float)COLUMNS * CUT_SHARE * coverage / sky);
    return fmaxf(left[COLUMNS - 1 - cut] * trial_calibration.reach / p.reach, 0.02f);
}

static bool solve(const core_noise *noise, const column_case *of, float coverage, velum_calibration *found) {
    trial_calibration = (velum_calibration){1.2f, 2.0f, 1.0f};
    float low = 0.5f;
    float high = 5.0f;
    column_stats s;
    for (int round = 0; round < ROUNDS; round++) {
        trial_calibration.reach = reach_factor(noise, of, coverage);
        if (!columns_measure_anywhere(noise, of, coverage, COLUMNS, STEPS, &s)) {
            return false;
        }
        trial_calibration.density /= fmaxf((float)s.water, 0.05f);
        if (coverage < 1.0f) {
            trial_calibration.coverage *= coverage / fmaxf((float)s.coverage, 0.05f);
        } else {
            *(s.coverage < OVERCAST ? &low : &high) = trial_calibration.coverage;
            trial_calibration.coverage = 0.5f * (low + high);
        }
    }
    *found = trial_calibration;
    printf("  %-3s %.3f: coverage %.3f density %.3f reach %.3f (is: %.4f, water %.3f, top %+.1f m)\n", of->name,
           (double)coverage, (double)found->coverage, (double)found->density, (double)found->reach, s.coverage, s.water,
           s.top_error_m);
    return true;
}

typedef struct row {
    float thickness_m, s0, s_share, s_octave, s_over_1, s_over_2, w0, w_octave, w_over_1, w_over_2, r0, r_over_1,
        r_over_2;
} row;

/* u and v of 1 + u t + v t^2, which is `half` at t = 1/2 and `full` at 1. */
static void over_terms(float half, float full, float *u, float *v) {
    float a = full - 1.0f;
    float b = half - 1.0f;
    *v = 2.0f * a - 4.0f * b;
    *u = 4.0f * b - a;
}

static bool measure_kind(const core_noise *noise, const kind_knot *knot, row *out) {
    column_case usual = *knot->usual;
    usual.slot = knot->slot;
    usual.kind = knot->kind;
    usual.name = knot->name;
    const float thickness_m = usual.top_m - usual.base_m;
    const float depth = usual.extinction_1_m * thickness_m;
    velum_calibration plain;
    velum_calibration thick;
    velum_calibration thin;
    velum_calibration twice;
    velum_calibration half;
    velum_calibration seven;
    velum_calibration eight;
    column_case of = usual;
    of.extinction_1_m = 500.0f / thickness_m;
    bool ok = solve(noise, &usual, 0.5f, &plain) && solve(noise, &of, 0.5f, &thick);
    of.extinction_1_m = 5.0f / thickness_m;
    ok = ok && solve(noise, &of, 0.5f, &thin);
    of.top_m = of.base_m + 2.0f * thickness_m;
    of.extinction_1_m = 0.5f * depth / thickness_m;
    ok = ok && solve(noise, &of, 0.5f, &twice);
    of.top_m = of.base_m + 0.5f * thickness_m;
    of.extinction_1_m = 2.0f * depth / thickness_m;
    ok = ok && solve(noise, &of, 0.5f, &half) && solve(noise, &usual, 0.875f, &seven) &&
         solve(noise, &usual, 1.0f, &eight);
    if (!ok) {
        return false;
    }
    *out = (row){.thickness_m = thickness_m, .r0 = plain.reach};
    const float share_low = sqrtf(0.5f / 500.0f);
    const float share_high = sqrtf(0.1f);
    const float share = sqrtf(fminf(0.1f, 0.5f / depth));
    out->s_share = (thin.coverage - thick.coverage) / (share_high - share_low);
    out->s0 = plain.coverage - out->s_share * share;
    out->s_octave = 0.5f * (twice.coverage - half.coverage);
    over_terms(seven.coverage / plain.coverage, eight.coverage / plain.coverage, &out->s_over_1, &out->s_over_2);
    const float water = plain.density * plain.coverage;
    out->w0 = water;
    out->w_octave = 0.5f * (twice.density * twice.coverage - half.density * half.coverage);
    over_terms(seven.density * seven.coverage / water, eight.density * eight.coverage / water, &out->w_over_1,
               &out->w_over_2);
    over_terms(seven.reach / plain.reach, eight.reach / plain.reach, &out->r_over_1, &out->r_over_2);
    return true;
}

static void write_row(FILE *file, const char *indent, const char *lead, const row *r, const char *tail) {
    fprintf(file,
            "%s%svelum_calibration_make(%.1ff, %.4ff, %.4ff, %.4ff, %.4ff, %.4ff, %.4ff, %.4ff, %.4ff, %.4ff, %.4ff, "
            "%.4ff, %.4ff)%s\n",
            indent, lead, (double)r->thickness_m, (double)r->s0, (double)r->s_share, (double)r->s_octave,
            (double)r->s_over_1, (double)r->s_over_2, (double)r->w0, (double)r->w_octave, (double)r->w_over_1,
            (double)r->w_over_2, (double)r->r0, (double)r->r_over_1, (double)r->r_over_2, tail);
}

static const char head[] =
    "/* Measured by tests/accuracy/velum-calibrate over the noise and the profiles; see density.h. Do not edit. */\n"
    "#ifndef VELUM_CALIBRATION_H\n#define VELUM_CALIBRATION_H\n\n#include \"slots.h\"\n\n"
    "/* Factors of a profile's. */\n"
    "VELUM_STRUCT(velum_calibration) {\n    float coverage, density, reach;\n};\n\n"
    "/* Of one kind of cloud: at half cover and its usual thickness, how that changes with the square root of the "
    "share of\n"
    " * the optical depth that counts as covered, with each octave of thickness, and from 3/4 cover to overcast. */\n"
    "VELUM_STRUCT(velum_calibration_row) {\n    float thickness_m;\n"
    "    float s0, s_share, s_octave, s_over_1, s_over_2; /* coverage */\n"
    "    float w0, w_octave, w_over_1, w_over_2;          /* coverage x density */\n"
    "    float r0, r_over_1, r_over_2;                    /* reach */\n};\n\n"
    "VELUM_FN velum_calibration_row velum_calibration_make(float thickness_m, float s0, float s_share, float "
    "s_octave,\n"
    "                                                      float s_over_1, float s_over_2, float w0, float w_octave,\n"
    "                                                      float w_over_1, float w_over_2, float r0, float r_over_1,\n"
    "                                                      float r_over_2) {\n"
    "    velum_calibration_row r;\n    r.thickness_m = thickness_m;\n    r.s0 = s0;\n    r.s_share = s_share;\n"
    "    r.s_octave = s_octave;\n    r.s_over_1 = s_over_1;\n    r.s_over_2 = s_over_2;\n    r.w0 = w0;\n"
    "    r.w_octave = w_octave;\n    r.w_over_1 = w_over_1;\n    r.w_over_2 = w_over_2;\n    r.r0 = r0;\n"
    "    r.r_over_1 = r_over_1;\n    r.r_over_2 = r_over_2;\n    return r;\n}\n\n"
    "VELUM_FN velum_calibration velum_calibration_from(velum_calibration_row r, float coverage, float thickness_m,\n"
    "                                                  float optical_depth) {\n"
    "    float share = VELUM_SQRT(VELUM_MIN(0.1f, 0.5f / VELUM_MAX(optical_depth, 1.0e-3f)));\n"
    "    float octaves = velum_clamp(VELUM_LOG2(VELUM_MAX(thickness_m, 1.0f) / r.thickness_m), -2.0f, 1.5f);\n"
    "    float t = velum_overcast(coverage);\n"
    "    velum_calibration c;\n"
    "    c.coverage = (r.s0 + r.s_share * share + r.s_octave * octaves) * (1.0f + t * (r.s_over_1 + t * r.s_over_2));\n"
    "    c.density = (r.w0 + r.w_octave * octaves) * (1.0f + t * (r.w_over_1 + t * r.w_over_2)) / c.coverage;\n"
    "    c.reach = r.r0 * (1.0f + t * (r.r_over_1 + t * r.r_over_2));\n    return c;\n}\n\n"
    "VELUM_FN velum_calibration velum_calibration_mix(velum_calibration a, velum_calibration b, float t) {\n"
    "    velum_calibration c;\n    c.coverage = velum_mix(a.coverage, b.coverage, t);\n"
    "    c.density = velum_mix(a.density, b.density, t);\n    c.reach = velum_mix(a.reach, b.reach, t);\n    return "
    "c;\n}\n\n";

static void write_pair(FILE *file, const char *indent, const row *a, const row *b, const char *t) {
    write_row(file, indent, "a = ", a, ";");
    write_row(file, indent, "b = ", b, ";");
    fprintf(file, "%st = %s;\n", indent, t);
}

static void write_one(FILE *file, const row *a) {
    write_row(file, "        ", "a = ", a, ";");
    fputs("        b = a;\n        t = 0.0f;\n", file);
}

static void write_table(FILE *file, const row rows[KINDS]) {
    fputs(head, file);
    fputs("VELUM_FN velum_calibration velum_calibration_of(int slot, float kind, float coverage, float thickness_m,\n"
          "                                                float optical_depth) {\n"
          "    velum_calibration_row a;\n    velum_calibration_row b;\n    float t;\n",
          file);
    fputs("    if (slot == VELUM_SLOT_LOW || slot == VELUM_SLOT_LOW_2) {\n", file);
    write_pair(file, "        ", &rows[0], &rows[1], "kind");
    fputs("    } else if (slot == VELUM_SLOT_CUMULUS) {\n", file);
    write_one(file, &rows[2]);
    fputs("    } else if (slot == VELUM_SLOT_STORM) {\n", file);
    write_one(file, &rows[3]);
    fputs("    } else if (slot == VELUM_SLOT_MIDDLE) {\n        if (kind < 0.5f) {\n", file);
    write_pair(file, "            ", &rows[4], &rows[5], "2.0f * kind");
    fputs("        } else {\n", file);
    write_pair(file, "            ", &rows[5], &rows[6], "2.0f * kind - 1.0f");
    fputs("        }\n    } else {\n        if (kind < 0.5f) {\n", file);
    write_pair(file, "            ", &rows[7], &rows[8], "2.0f * kind");
    fputs("        } else {\n", file);
    write_pair(file, "            ", &rows[8], &rows[9], "2.0f * kind - 1.0f");
    fputs("        }\n    }\n"
          "    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),\n"
          "                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);\n"
          "}\n\n#endif\n",
          file);
}

/* Rows of the kinds that are named: all of them take ten minutes. */
static bool measure_named(const core_noise *noise, const kind_knot knots[KINDS], char **names, int count) {
    for (int i = 0; i < count; i++) {
        int k = 0;
        while (k < KINDS && strcmp(names[i], knots[k].name) != 0) {
            k++;
        }
        row r;
        if (k == KINDS || !measure_kind(noise, &knots[k], &r)) {
            fprintf(stderr, "velum-calibrate: %s %s\n", names[i], k == KINDS ? "is no kind" : "was not measured");
            return false;
        }
        write_row(stdout, "", "", &r, "");
    }
    return true;
}

int main(int argc, char **argv) {
    if (argc < 2 || (argc > 2) != (strcmp(argv[1], "-") == 0)) {
        fprintf(stderr, "usage: velum-calibrate OUTPUT (shaders/shared/calibration.h, then clang-format)\n"
                        "       velum-calibrate - KIND... (rows of it)\n");
        return 2;
    }
    const kind_knot knots[KINDS] = {
        {"St", VELUM_SLOT_LOW, 0.0f, &column_cases[0]},     {"Sc", VELUM_SLOT_LOW, 1.0f, &column_cases[1]},
        {"Cu", VELUM_SLOT_CUMULUS, 0.0f, &column_cases[2]}, {"Cb", VELUM_SLOT_STORM, 1.0f, &column_cases[3]},
        {"As", VELUM_SLOT_MIDDLE, 0.0f, &column_cases[4]},  {"Ns", VELUM_SLOT_MIDDLE, 0.5f, &column_cases[5]},
        {"Ac", VELUM_SLOT_MIDDLE, 1.0f, &column_cases[6]},  {"Cs", VELUM_SLOT_HIGH, 0.0f, &column_cases[7]},
        {"Ci", VELUM_SLOT_HIGH, 0.5f, &column_cases[8]},    {"Cc", VELUM_SLOT_HIGH, 1.0f, &column_cases[9]},
    };
    row rows[KINDS];
    const core_noise *noise = core_noise_built();
    if (argc > 2) {
        return measure_named(noise, knots, argv + 2, argc - 2) ? 0 : 1;
    }
    bool ok = true;
    for (int k = 0; k < KINDS && ok; k++) {
        ok = measure_kind(noise, &knots[k], &rows[k]);
    }
    FILE *file = ok ? fopen(argv[1], "w") : NULL;
    if (!file) {
        fprintf(stderr, "velum-calibrate: %s\n", ok ? "cannot write the output" : "no memory");
        return 1;
    }
    write_table(file, rows);
    return fclose(file) == 0 ? 0 : 1;
}
