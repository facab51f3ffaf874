#include <math.h>
#include <string.h>

#include "stability.h"

#define SLAB(base, top, extinction, hg)                                                                                \
    "{\"type\": \"St\", \"structure\": \"uniform\", \"coverage\": 1, \"base_m\": " base ", \"top_m\": " top            \
    ", \"extinction_1_m\": " extinction ", \"phase\": {\"hg\": " hg "}}"
#define CUMULUS(coverage) "{\"type\": \"Cu\", \"coverage\": " coverage ", \"base_m\": 1000, \"top_m\": 2000}"

enum { WIDE = 64, HIGH = 36, SETTLE = 48 };

static stage_camera camera_at(double lat_deg, double lon_deg, double height_m, double heading_deg, double pitch_deg,
                              double tan_x) {
    stage_camera c = {.tan_x = tan_x, .tan_y = tan_x * HIGH / WIDE};
    stage_camera_place(&c, lat_deg, lon_deg, height_m, heading_deg, pitch_deg, 0.0);
    return c;
}

static trial_weather no_air(const char *layers) {
    return (trial_weather){.layers = layers, .atmosphere = "none", .sun_elevation_deg = 45.0};
}

static trial_weather air(const char *layers, double sun_elevation_deg) {
    return (trial_weather){.layers = layers,
                           .atmosphere = "earth",
                           .sun_azimuth_deg = 160.0,
                           .sun_elevation_deg = sun_elevation_deg,
                           .lat_deg = 50.0,
                           .lon_deg = 8.5};
}

/* One camera in one layer: the transmittance of the picture against the world's own line query. */
static bool slab_case(trial *t, const char *layers, const stage_camera *c, uint32_t width, uint32_t height) {
    trial_weather w = no_air(layers);
    double worst;
    bool ok = trial_load(t, &w) && trial_open(t, width, height) && trial_draw(t, c, 0.0, VELUM_VIEW_CUT, SETTLE) &&
              trial_transmittance(t, c, 0.0, &worst, NULL);
    if (ok) {
        float least = 1.0f, most = 0.0f;
        for (uint32_t i = 0; i < t->now.count; i++) {
            least = fminf(least, t->now.transmittance[3 * i + 1]);
            most = fmaxf(most, t->now.transmittance[3 * i + 1]);
        }
        size_t used = strlen(t->text);
        snprintf(t->text + used, sizeof t->text - used, "%stransmittance %.3g..%.3g", used ? ", " : "", (double)least,
                 (double)most);
        /* Of several pictures the worst; NaN stays. */
        t->value = used && !(worst > t->value || isnan(worst)) ? t->value : worst;
    }
    return ok;
}

static bool horizon(trial *t) {
    stage_camera c = camera_at(0.0, 0.0, 300.0, 90.0, 0.6, 0.01);
    return slab_case(t, SLAB("1000", "1100", "1e-5", "0.85"), &c, WIDE, HIGH);
}

static bool tangent(trial *t) {
    /* The top's own horizon from 3000 m: acos((a + 1100) / (a + 3000)) below level. */
    double dip_deg = acos((6378137.0 + 1100.0) / (6378137.0 + 3000.0)) * 180.0 / acos(-1.0);
    stage_camera c = camera_at(0.0, 0.0, 3000.0, 90.0, -dip_deg, 0.004);
    return slab_case(t, SLAB("1000", "1100", "1e-5", "0.85"), &c, WIDE, HIGH);
}

static bool on_base(trial *t) {
    stage_camera c = camera_at(0.0, 0.0, 1000.0, 90.0, 20.0, 0.5);
    return slab_case(t, SLAB("1000", "2000", "0.001", "0.85"), &c, WIDE, HIGH);
}

static bool on_top(trial *t) {
    stage_camera c = camera_at(0.0, 0.0, 2000.0, 90.0, -20.0, 0.5);
    return slab_case(t, SLAB("1000", "2000", "0.001", "0.85"), &c, WIDE, HIGH);
}

static bool in_cloud(trial *t) {
    stage_camera c = camera_at(0.0, 0.0, 1500.0, 90.0, 0.0, 1.0);
    return slab_case(t, SLAB("1000", "2000", "0.001", "0.85"), &c, WIDE, HIGH);
}

static bool orbit(trial *t) {
    stage_camera c = camera_at(30.0, 40.0, 400000.0, 0.0, -80.0, 0.3);
    return slab_case(t, SLAB("1000", "2000", "0.001", "0.85"), &c, WIDE, HIGH);
}

static bool thin_layer(trial *t) {
    stage_camera below = camera_at(0.0, 0.0, 300.0, 90.0, 30.0, 0.5);
    stage_camera above = camera_at(0.0, 0.0, 11000.0, 90.0, -40.0, 0.5);
    return slab_case(t, SLAB("1000", "1001", "0.5", "0.85"), &below, WIDE, HIGH) &&
           slab_case(t, SLAB("1000", "1001", "0.5", "0.85"), &above, WIDE, HIGH);
}

static bool one_pixel(trial *t) {
    stage_camera c = camera_at(0.0, 0.0, 300.0, 90.0, 40.0, 0.02);
    c.tan_y = c.tan_x;
    return slab_case(t, SLAB("1000", "2000", "0.001", "0.85"), &c, 1, 1);
}

static bool wide_8192(trial *t) {
    stage_camera c = camera_at(0.0, 0.0, 300.0, 90.0, 30.0, 1.0);
    c.tan_y = c.tan_x * 8.0 / 8192.0;
    return slab_case(t, SLAB("1000", "2000", "0.001", "0.85"), &c, 8192, 8);
}

/* One pose written in two ways. */
static bool same_pose(trial *t, const stage_camera *a, const stage_camera *b, double lat_deg, double lon_deg) {
    trial_weather w = air(CUMULUS("0.45"), 30.0);
    picture kept = {0};
    w.lat_deg = lat_deg;
    w.lon_deg = lon_deg;
    bool ok = trial_load(t, &w) && trial_open(t, WIDE, HIGH) && trial_draw(t, a, 0.0, VELUM_VIEW_CUT, SETTLE) &&
              trial_keep(t, &kept) && trial_open(t, WIDE, HIGH) && trial_draw(t, b, 0.0, VELUM_VIEW_CUT, SETTLE);
    if (ok) {
        t->value = trial_difference(t, &kept);
    }
    picture_finish(&kept);
    return ok;
}

static bool pole(trial *t) {
    stage_camera a = camera_at(90.0, 0.0, 300.0, 0.0, 12.0, 0.6);
    stage_camera b = camera_at(90.0, 90.0, 300.0, 90.0, 12.0, 0.6);
    return same_pose(t, &a, &b, 70.0, 0.0);
}

static bool antimeridian(trial *t) {
    stage_camera a = camera_at(-17.0, 180.0, 300.0, 90.0, 12.0, 0.6);
    stage_camera b = camera_at(-17.0, -180.0, 300.0, 90.0, 12.0, 0.6);
    return same_pose(t, &a, &b, -17.0, 180.0);
}

/* Value: the greatest ratio of a mean to that of the next higher sun; above 1 the sky would brighten as the sun sets.
 */
static bool low_sun(trial *t) {
    static const double elevations_deg[] = {90.0, 30.0, 0.0, -0.5, -6.0, -18.0};
    double before = INFINITY;
    size_t used = 0;
    t->value = 0.0;
    for (int i = 0; i < 6; i++) {
        trial_weather w = air(CUMULUS("0.45"), elevations_deg[i]);
        stage_camera c = camera_at(50.0, 8.5, 300.0, 90.0, 12.0, 0.6);
        if (!trial_load(t, &w) || !trial_open(t, WIDE, HIGH) || !trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, SETTLE)) {
            return false;
        }
        double mean = trial_mean(t);
        /* The camera looks away from the zenith: 90 and 30 degrees are not ordered. */
        t->value = i < 2 ? t->value : fmax(t->value, mean / before);
        before = fmax(mean, 1e-30);
        used += (size_t)snprintf(t->text + used, used < sizeof t->text ? sizeof t->text - used : 0, "%s%g deg %.3g",
                                 i ? ", " : "cd/m2 at ", elevations_deg[i], mean);
    }
    return true;
}

static void set_step(velum_plan *plan, double value) {
    plan->step_m = (float)value;
    plan->step_growth = 0.0f;
    plan->march_steps = 4096;
    plan->ray_rate = 1;
}

/* Value: the greatest relative spread of mean luminance between steps of 1 m and longer ones. Transmittance: text. */
static bool step_sweep(trial *t, int first, int last) {
    static const char *const layers[] = {SLAB("1000", "2000", "1e-7", "0.85"), SLAB("1000", "2000", "1e-5", "0.85"),
                                         SLAB("1000", "2000", "1e-3", "0.85"), SLAB("1000", "2000", "0.1", "0.85"),
                                         SLAB("1000", "2000", "10", "0.85")};
    static const double steps_m[] = {1.0, 10.0, 100.0, 1000.0, 10000.0};
    double worst_transmittance = 0.0;
    size_t used = 0;
    t->value = 0.0;
    for (int i = first; i <= last; i++) {
        double finest = 0.0;
        for (int k = 0; k < 5; k++) {
            trial_weather w = no_air(layers[i]);
            stage_camera c = camera_at(0.0, 0.0, 300.0, 90.0, 50.0, 0.2);
            double worst;
            if ((k == 0 && !trial_load(t, &w)) || !trial_open(t, 16, 9) || !trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, 1) ||
                !trial_plan(t, set_step, steps_m[k]) || !trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, 8) ||
                !trial_transmittance(t, &c, 0.0, &worst, NULL)) {
                return false;
            }
            double mean = trial_mean(t);
            finest = k == 0 ? fmax(mean, 1e-30) : finest;
            worst_transmittance = fmax(worst_transmittance, worst);
            t->value = fmax(t->value, fabs(mean / finest - 1.0));
            used += (size_t)snprintf(t->text + used, used < sizeof t->text ? sizeof t->text - used : 0, "%s%+.3f",
                                     k == 0 ? (i == first ? "" : "; ") : " ", mean / finest - 1.0);
        }
    }
    return worst_transmittance <= 0.002;
}

static bool thin_steps(trial *t) {
    return step_sweep(t, 0, 2);
}

static bool dense_steps(trial *t) {
    return step_sweep(t, 3, 4);
}

/* Value: that of coverage 0 against no layer at all. */
static bool coverage_ends(trial *t) {
    static const char *const layers[] = {"", CUMULUS("0"), CUMULUS("1e-6"), CUMULUS("1")};
    picture clear = {0};
    bool ok = true;
    double few = NAN, gaps = NAN;
    for (int i = 0; i < 4 && ok; i++) {
        trial_weather w = air(layers[i], 40.0);
        stage_camera c = camera_at(50.0, 8.5, 300.0, 90.0, 60.0, 0.6);
        ok = trial_load(t, &w) && trial_open(t, WIDE, HIGH) && trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, SETTLE);
        if (ok && i == 0) {
            ok = trial_keep(t, &clear);
        } else if (ok && i == 1) {
            t->value = trial_difference(t, &clear);
        } else if (ok && i == 2) {
            few = trial_difference(t, &clear);
        } else if (ok) {
            uint32_t open = 0;
            for (uint32_t k = 0; k < t->now.count; k++) {
                open += t->now.transmittance[3 * k + 1] > 0.5f ? 1 : 0;
            }
            gaps = (double)open / t->now.count;
        }
    }
    snprintf(t->text, sizeof t->text, "coverage 1e-6 differs by %.3g; of coverage 1 %.3g is open", few, gaps);
    picture_finish(&clear);
    return ok;
}

/* Value: the brightest pixel over the single-scattering peak of the phase function, E P(0) / (1 - T) or less. */
static bool forward_peak(trial *t) {
    trial_weather w = no_air(SLAB("1000", "2000", "0.001", "0.999"));
    w.sun_azimuth_deg = 90.0;
    stage_camera c = camera_at(0.0, 0.0, 300.0, 90.0, 45.0, 0.3);
    if (!trial_load(t, &w) || !trial_open(t, WIDE, HIGH) || !trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, SETTLE)) {
        return false;
    }
    double brightest = 0.0, g = 0.999;
    for (uint32_t i = 0; i < t->now.count; i++) {
        brightest = fmax(brightest, (double)t->now.luminance[i]);
    }
    double peak = 128000.0 * (1.0 - g * g) / pow(1.0 - g, 3.0) / (4.0 * acos(-1.0));
    t->value = brightest / peak;
    snprintf(t->text, sizeof t->text, "mean %.3g, brightest %.3g cd/m2", trial_mean(t), brightest);
    return true;
}

/* Value: how much more the picture changes in 1/60 s late than at time 0, in parts of the luminance. */
static bool long_time(trial *t) {
    static const double times_s[] = {0.0, 31557600.0, 1e9};
    double change[3] = {0};
    for (int i = 0; i < 3; i++) {
        trial_weather w = air(CUMULUS("0.45"), 40.0);
        picture kept = {0};
        stage_camera c = camera_at(50.0, 8.5, 300.0, 90.0, 20.0, 0.6);
        w.wind_east_m_s = 10.0f;
        bool ok = trial_load(t, &w) && trial_open(t, WIDE, HIGH) &&
                  trial_draw(t, &c, times_s[i], VELUM_VIEW_CUT, SETTLE) && trial_keep(t, &kept) &&
                  trial_draw(t, &c, times_s[i] + 1.0 / 60.0, VELUM_VIEW_CUT, SETTLE);
        change[i] = ok ? trial_difference(t, &kept) : NAN;
        picture_finish(&kept);
        if (!ok) {
            return false;
        }
    }
    t->value = fmax(change[1], change[2]) - change[0];
    snprintf(t->text, sizeof t->text, "change in 1/60 s: %.4g at 0, %.4g after a year, %.4g at 1e9 s", change[0],
             change[1], change[2]);
    return true;
}

/* Value: how much further the picture is from the world's own queries late than early, over three times each. */
static bool late_queries(trial *t) {
    static const double starts_s[] = {0.0, 31557600.0, 1e9 - 2e5};
    double mean[3] = {0}, worst, one;
    for (int i = 0; i < 9; i++) {
        double time_s = starts_s[i / 3] + 5e4 * (i % 3);
        trial_weather w = no_air(CUMULUS("0.45"));
        stage_camera c = camera_at(50.0, 8.5, 300.0, 90.0, 20.0, 0.6);
        w.wind_east_m_s = 10.0f;
        if (!trial_load(t, &w) || !trial_open(t, WIDE, HIGH) || !trial_draw(t, &c, time_s, VELUM_VIEW_CUT, SETTLE) ||
            !trial_transmittance(t, &c, time_s, &worst, &one)) {
            return false;
        }
        mean[i / 3] += one / 3.0;
    }
    t->value = fmax(mean[1], mean[2]) - mean[0];
    snprintf(t->text, sizeof t->text, "mean %.3g at 0, %.3g after a year, %.3g at 1e9 s", mean[0], mean[1], mean[2]);
    return true;
}

/* What history does to a settled picture: `disturb` ends where `c` stands, at time 0. */
static bool settled_after(trial *t, bool (*disturb)(trial *t, const stage_camera *c), float wind_east_m_s) {
    trial_weather w = air(CUMULUS("0.45"), 40.0);
    picture fresh = {0};
    stage_camera c = camera_at(50.0, 8.5, 300.0, 90.0, 15.0, 0.6);
    w.wind_east_m_s = wind_east_m_s;
    bool ok = trial_load(t, &w) && trial_open(t, WIDE, HIGH) && trial_draw(t, &c, 0.0, VELUM_VIEW_CUT, SETTLE) &&
              trial_keep(t, &fresh) && trial_open(t, WIDE, HIGH) && disturb(t, &c);
    double first = ok ? trial_difference(t, &fresh) : NAN;
    ok = ok && trial_draw(t, &c, 0.0, 0, SETTLE);
    t->value = ok ? trial_difference(t, &fresh) : NAN;
    snprintf(t->text, sizeof t->text, "%.3g in the first frame", first);
    picture_finish(&fresh);
    return ok;
}

static bool jump(trial *t, const stage_camera *c, uint32_t flags) {
    stage_camera far = camera_at(40.0, 20.0, 5000.0, 200.0, -20.0, 0.6);
    return trial_draw(t, &far, 0.0, VELUM_VIEW_CUT, SETTLE) && trial_draw(t, c, 0.0, flags, 1);
}

static bool disturb_teleport(trial *t, const stage_camera *c) {
    return jump(t, c, 0);
}

static bool disturb_cut(trial *t, const stage_camera *c) {
    return jump(t, c, VELUM_VIEW_CUT);
}

static bool disturb_halt(trial *t, const stage_camera *c) {
    for (int i = 30; i >= 0; i--) {
        stage_camera moving = *c;
        for (int k = 0; k < 3; k++) {
            moving.position_m[k] -= 250.0 / 60.0 * i * c->forward[k];
        }
        if (!trial_draw(t, &moving, 0.0, i == 30 ? VELUM_VIEW_CUT : 0, 1)) {
            return false;
        }
    }
    return true;
}

static bool disturb_clock(trial *t, const stage_camera *c) {
    for (int i = 30; i >= 0; i--) {
        if (!trial_draw(t, c, i / 3.0, i == 30 ? VELUM_VIEW_CUT : 0, 1)) {
            return false;
        }
    }
    return true;
}

/* Sizes of the sub-rectangle change every frame, up to the view's own. */
static bool disturb_size(trial *t, const stage_camera *c) {
    picture all = t->now;
    bool ok = true;
    for (uint32_t i = 0; i < 40 && ok; i++) {
        t->now.width = i == 39 ? WIDE : 1 + (i * 37) % WIDE;
        t->now.height = i == 39 ? HIGH : 1 + (i * 23) % HIGH;
        t->now.count = t->now.width * t->now.height;
        ok = trial_draw(t, c, 0.0, i == 0 ? VELUM_VIEW_CUT : 0, 1);
    }
    t->now = all;
    return ok;
}

static bool teleport(trial *t) {
    return settled_after(t, disturb_teleport, 0.0f);
}

static bool cut(trial *t) {
    return settled_after(t, disturb_cut, 0.0f);
}

static bool halt(trial *t) {
    return settled_after(t, disturb_halt, 0.0f);
}

static bool reversed_clock(trial *t) {
    return settled_after(t, disturb_clock, 50.0f);
}

static bool resized(trial *t) {
    return settled_after(t, disturb_size, 0.0f);
}

#define AGAINST_QUERY "transmittance against the line query, beside 1 % of itself"
#define AFTER "difference from a fresh settled picture, 48 frames later"

const stability_case stability_cases[] = {
    {"horizon", "flat-earth steps never leave the layer", "roots of the sphere, without cancellation", AGAINST_QUERY,
     0.002, horizon},
    {"tangent", "a thin chord falls between steps", "the interval in the layer is found first", AGAINST_QUERY, 0.002,
     tangent},
    {"eye_on_base", "inside or outside by rounding: a band of nothing or everything", "one interval, closed at the eye",
     AGAINST_QUERY, 0.002, on_base},
    {"eye_on_top", "the same", "the same", AGAINST_QUERY, 0.002, on_top},
    {"eye_in_cloud", "march begins at the layer's face behind the eye", "begins at the eye", AGAINST_QUERY, 0.002,
     in_cloud},
    {"pole", "longitude is singular: a star of seams", "ECEF and cube faces",
     "difference of one pose written in two ways", 1e-3, pole},
    {"antimeridian", "longitude jumps by 360 degrees", "ECEF and cube faces", "the same", 1e-3, antimeridian},
    {"orbit_400km", "floats of the planet's size: layers flicker", "positions relative to the eye", AGAINST_QUERY,
     0.002, orbit},
    {"low_sun", "division by the sine of the sun's height; light from below ground",
     "shadow of the planet, twilight air", "brightest step as the sun sets: mean over the mean before", 1.0, low_sun},
    {"steps_thin", "energy grows or is lost with the step", "energy-conserving integration",
     "spread of mean luminance over steps of 1 m to 10 km, 1e-7 to 1e-3 1/m (transmittance within 0.002)", 0.05,
     thin_steps},
    {"steps_dense", "the same; the light of a whole step is taken from one place in it", "the same",
     "spread of mean luminance over steps of 1 m to 10 km, 0.1 to 10 1/m (transmittance within 0.002)", 0.05,
     dense_steps},
    {"layer_1m", "falls between steps", "at least one sample in every layer that is crossed", AGAINST_QUERY, 0.002,
     thin_layer},
    {"coverage_ends", "thresholds at the ends of the noise: specks at 0, holes at 1", "quantiles of the noise",
     "coverage 0 against no layer", 1e-6, coverage_ends},
    {"forward_peak_0.999", "the peak overflows half floats, or burns",
     "luminance is scaled; the peak stays the phase function's", "brightest pixel over the peak of the phase function",
     1.0, forward_peak},
    {"year_and_1e9s", "float time: the noise swims and jitters", "time and phase in double, modulo the period",
     "change in 1/60 s, late less early", 0.02, long_time},
    {"queries_late", "the same", "the same, and one density for picture and queries",
     "mean difference of transmittance from the line query, late less early", 0.02, late_queries},
    {"teleport", "ghosts of the old place", "history that does not fit is dropped", AFTER, 0.02, teleport},
    {"cut", "the first frames show the old place", "a cut begins anew", AFTER, 0.02, cut},
    {"halt", "the smear stays", "a progressive mean settles anew", AFTER, 0.02, halt},
    {"reversed_clock", "history from the future", "the same time gives the same picture", AFTER, 0.02, reversed_clock},
    {"resized", "history of another size is read out of range", "history begins anew", AFTER, 0.02, resized},
    {"one_pixel", "division by width - 1; empty dispatch", "pixel centres; groups rounded up", AGAINST_QUERY, 0.002,
     one_pixel},
    {"wide_8192", "indices and groups beyond limits", "the limit is stated and tested", AGAINST_QUERY, 0.002,
     wide_8192},
    {NULL, NULL, NULL, NULL, 0.0, NULL},
};
