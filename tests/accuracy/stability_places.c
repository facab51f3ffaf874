/* Where the eye and the sun stand, and the picture's size. */
#include "stability.h"

#include <math.h>
#include <string.h>

#define DEG (acos(-1.0) / 180.0)

/* One camera in one layer: the transmittance of the picture against the world's own line query. Of several calls the
 * worst. */
static bool slab_case(trial *t, const char *layers, const stage_camera *c, uint32_t width, uint32_t height) {
    trial_weather w = trial_no_air(layers);
    double worst;
    if (!trial_load(t, &w) || !trial_open(t, width, height) || !trial_draw(t, c, 0.0, VELUM_VIEW_CUT, TRIAL_SETTLE) ||
        !trial_transmittance(t, c, 0.0, &worst, NULL)) {
        return false;
    }
    float least = 1.0f, most = 0.0f;
    for (uint32_t i = 0; i < t->now.count; i++) {
        least = fminf(least, t->now.transmittance[3 * i + 1]);
        most = fmaxf(most, t->now.transmittance[3 * i + 1]);
    }
    size_t used = strlen(t->text);
    snprintf(t->text + used, sizeof t->text - used, "%s%.3g..%.3g", used ? ", " : "transmittance ", (double)least,
             (double)most);
    t->value = used ? trial_worse(worst, t->value) : worst;
    return true;
}

static bool horizon(trial *t) {
    stage_camera c = trial_camera(0.0, 0.0, 300.0, 90.0, 0.6, 0.01);
    return slab_case(t, TRIAL_SLAB("1000", "1100", "1e-5", "0.85"), &c, TRIAL_WIDE, TRIAL_HIGH);
}

static bool tangent(trial *t) {
    /* The top's own horizon from 3000 m: acos((a + 1100) / (a + 3000)) below level. */
    double dip_deg = acos((6378137.0 + 1100.0) / (6378137.0 + 3000.0)) / DEG;
    stage_camera c = trial_camera(0.0, 0.0, 3000.0, 90.0, -dip_deg, 0.004);
    return slab_case(t, TRIAL_SLAB("1000", "1100", "1e-5", "0.85"), &c, TRIAL_WIDE, TRIAL_HIGH);
}

static bool eye_at(trial *t, double height_m, double pitch_deg, double tan_x) {
    stage_camera c = trial_camera(0.0, 0.0, height_m, 90.0, pitch_deg, tan_x);
    return slab_case(t, TRIAL_SLAB("1000", "2000", "0.001", "0.85"), &c, TRIAL_WIDE, TRIAL_HIGH);
}

static bool on_base(trial *t) {
    return eye_at(t, 1000.0, 20.0, 0.5);
}

static bool on_top(trial *t) {
    return eye_at(t, 2000.0, -20.0, 0.5);
}

static bool in_cloud(trial *t) {
    return eye_at(t, 1500.0, 0.0, 1.0);
}

static bool orbit(trial *t) {
    stage_camera c = trial_camera(30.0, 40.0, 400000.0, 0.0, -80.0, 0.3);
    return slab_case(t, TRIAL_SLAB("1000", "2000", "0.001", "0.85"), &c, TRIAL_WIDE, TRIAL_HIGH);
}

/* The planet's edge, through the layer, from space. */
static bool orbit_limb(trial *t) {
    double dip_deg = acos((6378137.0 + 1500.0) / (6378137.0 + 400000.0)) / DEG;
    stage_camera c = trial_camera(0.0, 0.0, 400000.0, 90.0, -dip_deg, 0.001);
    return slab_case(t, TRIAL_SLAB("1000", "2000", "1e-5", "0.85"), &c, TRIAL_WIDE, TRIAL_HIGH);
}

/* One pose written in two ways. */
static bool same_pose(trial *t, const stage_camera *a, const stage_camera *b, double lat_deg, double lon_deg) {
    trial_weather w = trial_air(TRIAL_CUMULUS("0.45"), 30.0);
    picture kept = {0};
    w.lat_deg = lat_deg;
    w.lon_deg = lon_deg;
    bool ok = trial_settle(t, &w, a, 0.0) && trial_keep(t, &kept) && trial_settle(t, &w, b, 0.0);
    t->value = ok ? trial_difference(t, &kept) : NAN;
    picture_finish(&kept);
    return ok;
}

static bool pole(trial *t) {
    stage_camera a = trial_camera(90.0, 0.0, 300.0, 0.0, 12.0, 0.6);
    stage_camera b = trial_camera(90.0, 90.0, 300.0, 90.0, 12.0, 0.6);
    return same_pose(t, &a, &b, 70.0, 0.0);
}

static bool antimeridian(trial *t) {
    stage_camera a = trial_camera(-17.0, 180.0, 300.0, 90.0, 12.0, 0.6);
    stage_camera b = trial_camera(-17.0, -180.0, 300.0, 90.0, 12.0, 0.6);
    return same_pose(t, &a, &b, -17.0, 180.0);
}

/* Mean luminance under a cumulus sky with the sun at so many heights; value: the greatest ratio of one to the one
 * before, or of the one before to it where `both_ways`. */
static bool sun_sweep(trial *t, const double *elevations_deg, int count, int first, bool both_ways) {
    double before = INFINITY, value = 0.0;
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        trial_weather w = trial_air(TRIAL_CUMULUS("0.45"), elevations_deg[i]);
        stage_camera c = trial_camera(50.0, 8.5, 300.0, 90.0, 12.0, 0.6);
        if (!trial_settle(t, &w, &c, 0.0)) {
            return false;
        }
        double mean = trial_mean(t);
        if (i >= first) {
            value = trial_worse(value, mean / before);
            value = both_ways ? trial_worse(value, before / mean) : value;
        }
        before = mean;
        if (used < sizeof t->text) {
            used += (size_t)snprintf(t->text + used, sizeof t->text - used, "%s%g: %.3g",
                                     i ? ", " : "cd/m2 at degrees ", elevations_deg[i], mean);
        }
    }
    t->value = value;
    return true;
}

static bool low_sun(trial *t) {
    static const double elevations_deg[] = {90.0, 30.0, 0.0, -0.5, -6.0, -18.0};
    /* The camera looks away from the zenith: 90 and 30 degrees are not ordered. */
    return sun_sweep(t, elevations_deg, 6, 2, false);
}

static bool sunset(trial *t) {
    static const double elevations_deg[] = {0.5, 0.4, 0.3, 0.2, 0.1, 0.0, -0.1, -0.2, -0.3, -0.4, -0.5};
    return sun_sweep(t, elevations_deg, 11, 1, true);
}

static bool one_pixel(trial *t) {
    stage_camera c = trial_camera(0.0, 0.0, 300.0, 90.0, 40.0, 0.02);
    c.tan_y = c.tan_x;
    return slab_case(t, TRIAL_SLAB("1000", "2000", "0.001", "0.85"), &c, 1, 1);
}

static bool wide_8192(trial *t) {
    stage_camera c = trial_camera(0.0, 0.0, 300.0, 90.0, 30.0, 1.0);
    c.tan_y = c.tan_x * 8.0 / 8192.0;
    return slab_case(t, TRIAL_SLAB("1000", "2000", "0.001", "0.85"), &c, 8192, 8);
}

const stability_case stability_places[] = {
    {"horizon", "steps over a flat earth never leave the layer", "roots of the sphere, without cancellation",
     TRIAL_AGAINST_QUERY, 0.002, horizon},
    {"tangent", "a thin chord falls between steps", "the interval within the layer is found first", TRIAL_AGAINST_QUERY,
     0.002, tangent},
    {"eye_on_base", "inside or outside by rounding: a band of nothing or of everything",
     "one interval, closed at the eye", TRIAL_AGAINST_QUERY, 0.002, on_base},
    {"eye_on_top", "the same", "the same", TRIAL_AGAINST_QUERY, 0.002, on_top},
    {"eye_in_cloud", "the march begins at the layer's face behind the eye", "it begins at the eye", TRIAL_AGAINST_QUERY,
     0.002, in_cloud},
    {"pole", "longitude is singular: a star of seams", "ECEF and cube faces",
     "difference of one pose written in two ways", 1e-3, pole},
    {"antimeridian", "longitude jumps by 360 degrees", "ECEF and cube faces",
     "difference of one pose written in two ways", 1e-3, antimeridian},
    {"orbit_400km", "floats of the planet's size: layers flicker", "positions relative to the eye", TRIAL_AGAINST_QUERY,
     0.002, orbit},
    {"orbit_limb", "rays miss the sphere by rounding: a ragged edge", "the closest point is formed first",
     TRIAL_AGAINST_QUERY, 0.002, orbit_limb},
    {"low_sun", "division by the sine of the sun's height; light from below ground",
     "the planet's shadow, and air that is lit after sunset",
     "as the sun sinks from 30 to -18 degrees: greatest ratio of a mean to the one before", 1.0, low_sun},
    {"sunset", "light goes out from one frame to the next",
     "the sun's light goes through curved air, and its disc sets",
     "for each tenth of a degree: greatest ratio of two means", 1.5, sunset},
    {"one_pixel", "division by width - 1; an empty dispatch", "middles of pixels; groups rounded up",
     TRIAL_AGAINST_QUERY, 0.002, one_pixel},
    {"wide_8192", "indices and groups beyond limits", "the limit is stated and tested", TRIAL_AGAINST_QUERY, 0.002,
     wide_8192},
    {NULL, NULL, NULL, NULL, 0.0, NULL},
};
