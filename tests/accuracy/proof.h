/* The long proof of the reference: what its parts share. */
#ifndef ACCURACY_PROOF_H
#define ACCURACY_PROOF_H

#include <math.h>
#include <stdio.h>

#include "tests/gpu/reference_slab.h"

#define PROOF_PI 3.14159265358979323846
#define PROOF_SLAB_M 240.0 /* thick: low over the planet */

typedef struct proof {
    const char *shared; /* has accuracy/slab_*.csv */
    double error;       /* relative standard error at which a figure is measured well enough... */
    double seconds;     /* ... or it has taken so long */
    int first, last;    /* rows of tables, and cases of the furnace, from 1 */
    uint32_t suns;      /* of one round of the furnace */
    slab_rig rig;
    uint32_t failures, skipped;
} proof;

/* A mean of independent measurements, each counted by its paths. */
typedef struct proof_mean {
    double sum, square, weight;
} proof_mean;

void proof_add(proof_mean *m, double value, double error, double weight);
double proof_value(const proof_mean *m);
double proof_error(const proof_mean *m); /* absolute */

/* One line: what, the figure, its bound, the verdict. Counts failures. */
void proof_tell(proof *p, bool ok, const char *figure_and_bound, ...) __attribute__((format(printf, 3, 4)));
/* 4 standard errors, and 0.5 % where those are 0.15 % or less. */
bool proof_meets(double found, double error, double expected);
/* Of deviations over their standard errors: nearly normal in its square root (Fisher 1922). */
void proof_tell_chi2(proof *p, const char *what, int count, double chi2);
/* A file of --shared's accuracy folder, to be closed; skips the part without it. */
FILE *proof_table(proof *p, const char *name);
/* Whether a row of a table, or a case of the furnace, was asked for. */
bool proof_wants(const proof *p, int row);
double proof_now_s(void);
/* Of the place at t along a direction, over the ellipsoid, by GeographicLib; ECEF. */
double proof_height_at(const double from[3], const double to[3], double t);
/* Henyey and Greenstein's function, in double precision. */
double proof_phase(double g, double cosine);
/* Five-point Gauss-Legendre, -1..1. */
extern const double proof_node[5], proof_weight[5];

/* pi I / (mu0 F0) of the rig's slab, until it is known well enough. */
void proof_measure(proof *p, const slab_case *c, double thickness_m, proof_mean *out);

/* proof_flux.c */
void proof_flux(void **state);   /* every row of slab_flux.csv */
void proof_energy(void **state); /* what goes into a white slab comes out */
/* proof_light.c */
void proof_furnace(void **state);
void proof_reciprocity(void **state);
void proof_extinction(void **state); /* none, and a half-space */
/* proof_air.c */
void proof_air(void **state); /* first order, against quadrature */
/* proof_first_order.c */
void proof_first_order(void **state); /* against double-precision quadrature over the ellipsoid */
void proof_curvature(void **state);   /* what plane-parallel is wrong by */

#endif
