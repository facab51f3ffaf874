/* The slab of the radiative-transfer tables, as the reference sees it: a uniform layer low over the planet, no air. */
#ifndef REFERENCE_SLAB_H
#define REFERENCE_SLAB_H

#include <stdio.h>

#include "fixture.h"

enum { SLAB_SIDE = 16, SLAB_PIXELS = SLAB_SIDE * SLAB_SIDE };

typedef struct slab_rig {
    fixture f;
    velum_eye *eye;
    velum_view *view;
    float light[SLAB_PIXELS * 3], through[SLAB_PIXELS * 3], variance[SLAB_PIXELS];
    velum_view_stats stats;
    double time_s; /* each measurement has one of its own, and so its own random numbers */
} slab_rig;

typedef struct slab_case {
    double albedo, g, tau, mu0; /* mu0: cosine of the sun's zenith angle */
    bool up;                    /* radiance that leaves the top upward; else the bottom, downward */
    double mu, phi_deg;         /* of propagation; 0: the sun's own azimuth of propagation */
    double expected;            /* pi I / (mu0 F0) */
} slab_case;

/* Skips the test where there is no device. */
void slab_rig_init(slab_rig *rig);
void slab_rig_init_preset(slab_rig *rig, int32_t quality);
void slab_rig_finish(slab_rig *rig);
void slab_rig_layer(slab_rig *rig, const slab_case *c, double thickness_m);
/* Greatest order of scattering; 0: all. */
void slab_rig_order(slab_rig *rig, uint32_t order);
/* Pictures until every pixel has so many paths, into light, through and variance. */
void slab_rig_render(slab_rig *rig, const velum_frame_info *frame, const double position_ecef_m[3],
                     const velum_view_frame *camera, bool reset, uint32_t paths);
/* pi I / (mu0 F0), its standard error, and the transmittance along the view. */
double slab_rig_measure(slab_rig *rig, const slab_case *c, double thickness_m, uint32_t paths, double *error,
                        double *through);
/* pi I / (mu0 F0) in a preset, after so many frames. */
double slab_rig_settle(slab_rig *rig, const slab_case *c, double thickness_m, uint32_t frames);
/* A file of tests/data, to be closed. */
FILE *slab_table(const char *name);
/* One row of tests/data/slab_rows.csv or of the tables it is from: ssa,g,tau,mu0,side,mu,phi_deg,BRF... */
bool slab_case_parse(const char *line, slab_case *out);

#endif
