/* How far the noise has drifted, in closed form. Where wind differs from place to place, noise cannot be carried for
 * ever: two phases are reset in turn and blended. A phase lives for CORE_DRIFT_CYCLE_S; the next one sets in
 * CORE_DRIFT_FADE_S before it ends. */
#ifndef VELUM_CORE_DRIFT_H
#define VELUM_CORE_DRIFT_H

#include <stdint.h>

#define CORE_DRIFT_CYCLE_S 7200.0
#define CORE_DRIFT_FADE_S 1200.0

typedef struct core_drift {
    float tau_s[2];  /* displacement is the local wind times this; -CYCLE/2..CYCLE/2 */
    float weight[2]; /* linear fade, in sum 1; for fields of unit variance w / sqrt(w0^2 + w1^2) keeps the variance */
    float offset[2][3]; /* of the noise, in periods, 0..1, of that phase's life */
    int64_t cycle[2];
} core_drift;

/* A pure function of time and seed, continuous wherever a weight is not 0. Not finite counts as 0. */
core_drift core_drift_at(double time_s, uint64_t seed);

#endif
