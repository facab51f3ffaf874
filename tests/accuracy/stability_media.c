/* What the air is filled with: extinction, thickness, coverage, phase. */
#include "stability.h"

#include <math.h>
#include <string.h>

#define BASE_M 1000.0
#define TOP_M 2000.0
#define SUN_LX 128000.0
#define LAYER(extinction) TRIAL_SLAB("1000", "2000", extinction, "0.85")

static double phase_hg(double cosine, double g) {
    return (1.0 - g * g) / pow(1.0 + g * g - 2.0 * g * cosine, 1.5) / (4.0 * acos(-1.0));
}

static double sun_cosine(const trial *t, const double ray[3]) {
    const double *sun = t->s->sun;
    return ray[0] * sun[0] + ray[1] * sun[1] + ray[2] * sun[2];
}

/* Light scattered once in the layer between BASE_M and TOP_M at the equator's beginning, over a flat ground. */
static double first_order(const trial *t, const double ray[3], double height_m, double extinction_1_m, double g) {
    const double rise = ray[0]; /* the normal there is the first axis */
    const double mu_sun = t->s->sun[0];
    const double cosine = sun_cosine(t, ray);
    double near_m = fmin(fmax(height_m, BASE_M), TOP_M), far_m = rise > 0.0 ? TOP_M : BASE_M;
    double depth = extinction_1_m * (far_m - near_m) / rise;
    double near_depth = extinction_1_m * (TOP_M - near_m) / mu_sun;
    double slope = 1.0 - rise / mu_sun; /* of both depths together */
    double share = fabs(slope * depth) < 1e-9 ? depth : -expm1(-slope * depth) / slope;
    return SUN_LX * phase_hg(cosine, g) * exp(-near_depth) * share;
}

/* All orders of a peak so narrow that light hardly leaves its way: n turns of Henyey and Greenstein's function are one
 * of g^n. */
static double narrow_orders(double cosine, double depth, double g) {
    double share = SUN_LX * exp(-depth), sum = 0.0;
    for (int n = 1; n <= 40; n++) {
        share *= depth / n;
        sum += share * phase_hg(cosine, pow(g, n));
    }
    return sum;
}

static void set_step(velum_plan *plan, double value) {
    plan->step_m = (float)value;
    plan->step_growth = 0.0f;
    plan->march_steps = 4096;
    plan->ray_rate = 1;
    plan->standing_ray_rate = 0;
}

typedef struct step_pose {
    const char *name;
    double height_m, pitch_deg;
} step_pose;

static const step_pose step_poses[] = {{"below", 300.0, 50.0}, {"above", 2500.0, -50.0}, {"within", 1500.0, 30.0}};

/* A layer seen by steps of so many metres, one ray a pixel. */
static bool draw_steps(trial *t, const char *layers, const stage_camera *c, double step_m) {
    trial_weather w = trial_no_air(layers);
    return (!layers || trial_load(t, &w)) && trial_open(t, 16, 9) && trial_draw(t, c, 0.0, VELUM_VIEW_CUT, 1) &&
           trial_plan(t, set_step, step_m) && trial_draw(t, c, 0.0, VELUM_VIEW_CUT, 8);
}

static const double steps_m[] = {1.0, 10.0, 100.0, 1000.0, 10000.0};

typedef enum steps_value { SPREAD, TRANSMITTANCE, ABSOLUTE } steps_value;

static bool steps_of(trial *t, const char *layers, double extinction_1_m, const step_pose *pose, steps_value kind) {
    stage_camera c = trial_camera(0.0, 0.0, pose->height_m, 90.0, pose->pitch_deg, 0.2);
    double finest = 0.0;
    for (int k = 0; k < 5; k++) {
        double value = 0.0, expected = 0.0, worst;
        if (!draw_steps(t, k == 0 ? layers : NULL, &c, steps_m[k])) {
            return false;
        }
        double mean = trial_mean(t);
        finest = k == 0 ? mean : finest;
        if (kind == SPREAD) {
            value = fabs(mean / finest - 1.0);
        } else if (kind == TRANSMITTANCE) {
            if (!trial_transmittance(t, &c, 0.0, &worst, NULL)) {
                return false;
            }
            value = worst;
        } else {
            for (uint32_t i = 0; i < t->now.count; i++) {
                double ray[3];
                trial_ray(t, &c, i % t->now.width, i / t->now.width, ray);
                expected += first_order(t, ray, pose->height_m, extinction_1_m, 0.85) / t->now.count;
            }
            value = fabs(mean / expected - 1.0);
        }
        if (!(value <= t->value)) {
            t->value = trial_worse(value, t->value);
            snprintf(t->text, sizeof t->text, "worst from %s, %g 1/m, steps of %g m", pose->name, extinction_1_m,
                     steps_m[k]);
        }
    }
    return true;
}

static bool step_sweep(trial *t, int first, int last, steps_value kind) {
    static const struct {
        const char *layers;
        double extinction_1_m;
    } slabs[] = {{LAYER("1e-7"), 1e-7}, {LAYER("1e-5"), 1e-5}, {LAYER("1e-3"), 1e-3}, {LAYER("0.01"), 0.01},
                 {LAYER("0.1"), 0.1},   {LAYER("1"), 1.0},     {LAYER("10"), 10.0}};
    bool ok = true;
    t->value = 0.0;
    for (int i = first; i <= last && ok; i++) {
        for (int k = 0; k < 3 && ok; k++) {
            ok = steps_of(t, slabs[i].layers, slabs[i].extinction_1_m, &step_poses[k], kind);
        }
    }
    return ok;
}

static bool steps_thin(trial *t) {
    return step_sweep(t, 0, 2, SPREAD);
}

static bool steps_dense(trial *t) {
    return step_sweep(t, 3, 6, SPREAD);
}

static bool steps_through(trial *t) {
    return step_sweep(t, 0, 6, TRANSMITTANCE);
}

static bool thin_light(trial *t) {
    return step_sweep(t, 0, 1, ABSOLUTE);
}

/* Two layers, the upper of little cloud: the order in which a long step takes them shows. */
static bool two_layers(trial *t) {
    static const char layers[] =
        TRIAL_SLAB("1000", "1200", "0.05", "0.85") "," TRIAL_SLAB("1400", "1600", "0.01", "0.5");
    t->value = 0.0;
    for (int k = 0; k < 2; k++) {
        if (!steps_of(t, layers, 0.05, &step_poses[k], SPREAD)) {
            return false;
        }
    }
    return true;
}

static bool thin_layer(trial *t) {
    static const char layers[] = TRIAL_SLAB("1000", "1001", "0.5", "0.85");
    static const double poses[][2] = {{300.0, 30.0}, {11000.0, -40.0}, {300.0, 3.0}};
    t->value = 0.0;
    for (int i = 0; i < 3; i++) {
        trial_weather w = trial_no_air(layers);
        stage_camera c = trial_camera(0.0, 0.0, poses[i][0], 90.0, poses[i][1], i == 2 ? 0.02 : 0.5);
        double worst;
        if (!trial_settle(t, &w, &c, 0.0) || !trial_transmittance(t, &c, 0.0, &worst, NULL)) {
            return false;
        }
        t->value = trial_worse(worst, t->value);
    }
    return true;
}

static stage_camera upward(void) {
    return trial_camera(50.0, 8.5, 300.0, 90.0, 60.0, 0.6);
}

/* Against no layer at all. */
static bool next_to_nothing(trial *t, const char *layers) {
    const trial_weather none = trial_air("", 40.0), some = trial_air(layers, 40.0);
    const stage_camera c = upward();
    picture clear = {0};
    bool ok = trial_settle(t, &none, &c, 0.0) && trial_keep(t, &clear) && trial_settle(t, &some, &c, 0.0);
    t->value = ok ? trial_difference(t, &clear) : NAN;
    picture_finish(&clear);
    return ok;
}

static bool coverage_0(trial *t) {
    return next_to_nothing(t, TRIAL_CUMULUS("0"));
}

static bool coverage_least(trial *t) {
    return next_to_nothing(t, TRIAL_CUMULUS("1e-6"));
}

static bool coverage_1(trial *t) {
    const trial_weather w = trial_air(TRIAL_CUMULUS("1"), 40.0);
    const stage_camera c = upward();
    if (!trial_settle(t, &w, &c, 0.0)) {
        return false;
    }
    t->value = 0.0;
    for (uint32_t k = 0; k < t->now.count; k++) {
        t->value += t->now.transmittance[3 * k + 1] > 0.6f ? 1.0 / t->now.count : 0.0;
    }
    return true;
}

/* Light of cloud ends at 960,000 cd/m2; the sun's disc is 2e9. */
#define CLOUD_MOST_CD_M2 960000.0

static bool forward_peak(trial *t) {
    const double g = 0.999;
    trial_weather w = trial_no_air(TRIAL_SLAB("1000", "2000", "0.001", "0.999"));
    w.sun_azimuth_deg = 90.0;
    t->greatest_cd_m2 = CLOUD_MOST_CD_M2;
    const stage_camera c = trial_camera(0.0, 0.0, 300.0, 90.0, 45.0, 0.05);
    uint32_t cut = 0, compared = 0;
    if (!trial_settle(t, &w, &c, 0.0)) {
        return false;
    }
    t->value = 0.0;
    for (uint32_t i = 0; i < t->now.count; i++) {
        double ray[3];
        trial_ray(t, &c, i % t->now.width, i / t->now.width, ray);
        double expected = narrow_orders(sun_cosine(t, ray), 1e-3 * (TOP_M - BASE_M) / ray[0], g);
        cut += expected > CLOUD_MOST_CD_M2 ? 1 : 0;
        /* Elsewhere it has left its way. */
        if (expected > 1e5) {
            expected = fmin(expected, CLOUD_MOST_CD_M2);
            t->value = trial_worse(t->value, fabs((double)t->now.luminance[i] / expected - 1.0));
            compared++;
        }
    }
    t->value = compared > 0 ? t->value : NAN;
    snprintf(t->text, sizeof t->text, "%u pixels near the peak, %u of them end at %g cd/m2", compared, cut,
             CLOUD_MOST_CD_M2);
    return true;
}

const stability_case stability_media[] = {
    {"steps_through", "the step that meets a face counts whole or not at all", "its share within the faces counts",
     "transmittance against the line query, beside 1 % of itself, 1e-7 to 10 1/m, steps of 1 m to 10 km, from below, "
     "above and within",
     0.002, steps_through},
    {"steps_thin", "energy grows or is lost with the step; next to nothing is nothing",
     "the light of a step in closed form; thin steps keep their digits",
     "spread of mean luminance over steps of 1 m to 10 km, 1e-7 to 1e-3 1/m, from below, above and within", 0.05,
     steps_thin},
    {"steps_dense", "the same; the light of a whole step is taken from one place in it",
     "the light of a step in closed form",
     "spread of mean luminance over steps of 1 m to 10 km, 0.01 to 10 1/m, from below, above and within", 0.05,
     steps_dense},
    {"steps_thin_light", "the same", "the same",
     "mean luminance against single scattering in double precision, 1e-7 and 1e-5 1/m, steps of 1 m to 10 km", 0.05,
     thin_light},
    {"steps_two_layers", "a step over two layers mixes them", "the nearer comes first",
     "spread of mean luminance over steps of 1 m to 10 km, from below and above", 0.05, two_layers},
    {"layer_1m", "falls between steps", "at least one sample in every layer that is crossed",
     "transmittance against the line query, beside 1 % of itself; 30 and 3 degrees from below, and from 11 km", 0.002,
     thin_layer},
    {"coverage_0", "thresholds at the end of the noise: specks", "quantiles of the noise",
     "difference from no layer at all", 1e-6, coverage_0},
    {"coverage_1e-6", "thresholds at the end of the noise: specks", "quantiles of the noise",
     "difference from no layer at all", 1e-3, coverage_least},
    {"coverage_1", "thresholds at the end of the noise: holes", "quantiles of the noise",
     "share of the sky that shows through (transmittance above exp(-0.5))", 0.02, coverage_1},
    {"forward_peak_0.999", "the peak overflows half floats, or burns",
     "the phase function's own peak; light of cloud ends at 960,000 cd/m2, as bright as a picture near the sun can use",
     "luminance against all orders of a narrow peak, ended there: greatest relative difference near the peak", 0.05,
     forward_peak},
    {NULL, NULL, NULL, NULL, 0.0, NULL},
};
