/* Cases in which renderers of cloud fail, each with a bound of its own. */
#ifndef ACCURACY_STABILITY_H
#define ACCURACY_STABILITY_H

#include "program.h"

typedef struct trial {
    stage *s;
    int32_t quality;
    stage_view v;
    picture now;
    bool is_new;           /* weather of which no shadow map has been looked at */
    uint32_t invalid;      /* pixels of all frames, and texels of shadow maps, so far: see trial_draw */
    double greatest_cd_m2; /* that the weather can shine with */
    double value;          /* what was measured; NaN breaks any bound */
    char text[256];        /* more of it */
} trial;

typedef struct stability_case {
    const char *name;
    const char *usual;     /* what fails in the usual method */
    const char *ours;      /* what Velum does */
    const char *measured;  /* what trial.value is */
    double bound;          /* of it */
    bool (*run)(trial *t); /* false: failed, said */
} stability_case;

extern const stability_case stability_places[], stability_media[], stability_times[]; /* each ends with a null name */

enum { TRIAL_WIDE = 64, TRIAL_HIGH = 36, TRIAL_SETTLE = 64 };

#define TRIAL_SLAB(base, top, extinction, hg)                                                                          \
    "{\"type\": \"St\", \"structure\": \"uniform\", \"coverage\": 1, \"base_m\": " base ", \"top_m\": " top            \
    ", \"extinction_1_m\": " extinction ", \"phase\": {\"hg\": " hg "}}"
#define TRIAL_CUMULUS(coverage) "{\"type\": \"Cu\", \"coverage\": " coverage ", \"base_m\": 1000, \"top_m\": 2000}"
#define TRIAL_AGAINST_QUERY "transmittance against the line query, beside 1 % of itself"

typedef struct trial_weather {
    const char *layers; /* JSON: what stands inside "layers": [] */
    const char *atmosphere;
    double sun_azimuth_deg, sun_elevation_deg;
    double albedo;           /* of the ground */
    double lat_deg, lon_deg; /* where the sun is given */
    float wind_east_m_s;
} trial_weather;

trial_weather trial_no_air(const char *layers);
trial_weather trial_air(const char *layers, double sun_elevation_deg);
stage_camera trial_camera(double lat_deg, double lon_deg, double height_m, double heading_deg, double pitch_deg,
                          double tan_x);

bool trial_load(trial *t, const trial_weather *weather);
/* A new view; the one before goes. */
bool trial_open(trial *t, uint32_t width, uint32_t height);
void trial_close(trial *t);
/* Frames of the whole view; the first with `flags`. Counts as invalid: what is no number, infinite or negative;
 * transmittance above 1; light above greatest_cd_m2, which is what a NaN becomes where a pass clamps it. */
bool trial_draw(trial *t, const stage_camera *c, double time_s, uint32_t flags, uint32_t frames);
/* The weather, a view of TRIAL_WIDE x TRIAL_HIGH, settled. */
bool trial_settle(trial *t, const trial_weather *weather, const stage_camera *c, double time_s);
/* Of the first plan, changed. */
bool trial_plan(trial *t, void (*change)(velum_plan *plan, double value), double value);
/* Over 64 pixels, tau of the world's own line query (air is not in it): greatest |T - exp(-tau)| - 0.01 exp(-tau), and
 * mean |T - exp(-tau)| (may be null). */
bool trial_transmittance(trial *t, const stage_camera *c, double time_s, double *out_worst, double *out_mean);
/* Unit, through the middle of a pixel. */
void trial_ray(const trial *t, const stage_camera *c, uint32_t x, uint32_t y, double out[3]);
/* Relative root mean square difference of luminance between the view's picture and another. */
double trial_difference(const trial *t, const picture *other);
bool trial_keep(const trial *t, picture *out); /* a copy */
double trial_mean(const trial *t);
/* The greater of them; NaN stays. */
double trial_worse(double a, double b);

#endif
