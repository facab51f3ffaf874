/* Cases in which renderers of cloud fail, each with a bound of its own. */
#ifndef ACCURACY_STABILITY_H
#define ACCURACY_STABILITY_H

#include "program.h"

typedef struct trial {
    stage *s;
    int32_t quality;
    stage_view v;
    picture now;
    uint32_t invalid; /* pixels of all frames so far */
    double value;     /* what was measured; NaN breaks any bound */
    char text[160];   /* more of it */
} trial;

typedef struct stability_case {
    const char *name;
    const char *usual;     /* what fails in the usual method */
    const char *ours;      /* what Velum does */
    const char *measured;  /* what trial.value is */
    double bound;          /* of it */
    bool (*run)(trial *t); /* false: failed, said */
} stability_case;

extern const stability_case stability_cases[]; /* ends with a null name */

typedef struct trial_weather {
    const char *layers; /* JSON: what stands inside "layers": [] */
    const char *atmosphere;
    double sun_azimuth_deg, sun_elevation_deg;
    double lat_deg, lon_deg; /* where the sun is given */
    float wind_east_m_s;
} trial_weather;

bool trial_load(trial *t, const trial_weather *weather);
/* A new view; the one before goes. */
bool trial_open(trial *t, uint32_t width, uint32_t height);
void trial_close(trial *t);
/* Frames of the whole view; the first with `flags`. */
bool trial_draw(trial *t, const stage_camera *c, double time_s, uint32_t flags, uint32_t frames);
/* Of the first plan, changed. */
bool trial_plan(trial *t, void (*change)(velum_plan *plan, double value), double value);
/* Over 64 pixels, tau of the world's own line query (air is not in it): greatest |T - exp(-tau)| - 0.01 exp(-tau), and
 * mean |T - exp(-tau)| (may be null). */
bool trial_transmittance(trial *t, const stage_camera *c, double time_s, double *out_worst, double *out_mean);
/* Relative root mean square difference of luminance between the view's picture and another. */
double trial_difference(const trial *t, const picture *other);
bool trial_keep(const trial *t, picture *out); /* a copy */
double trial_mean(const trial *t);

#endif
