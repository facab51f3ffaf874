#include "drift.h"

#include <math.h>

/* Lives follow each other at this distance; life n is centred on n PERIOD_S: a flight begins with one life alone. */
#define PERIOD_S (CORE_DRIFT_CYCLE_S - CORE_DRIFT_FADE_S)

/* splitmix64 (Steele, Lea & Flood 2014). */
static uint64_t mix64(uint64_t x) {
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static void set_phase(core_drift *drift, uint32_t phase, int64_t cycle, double time_s, double weight, uint64_t seed) {
    double tau_s = time_s - (double)cycle * PERIOD_S;
    drift->tau_s[phase] = (float)fmax(fmin(tau_s, 0.5 * CORE_DRIFT_CYCLE_S), -0.5 * CORE_DRIFT_CYCLE_S);
    drift->weight[phase] = (float)weight;
    drift->cycle[phase] = cycle;
    uint64_t hash = mix64(seed ^ mix64((uint64_t)cycle));
    for (uint32_t axis = 0; axis < 3; axis++) {
        drift->offset[phase][axis] = (float)(hash >> 40) * 0x1p-24f;
        hash = mix64(hash);
    }
}

core_drift core_drift_at(double time_s, uint64_t seed) {
    core_drift drift;
    if (!isfinite(time_s) || fabs(time_s) > 1e15) {
        time_s = 0.0;
    }
    int64_t cycle = (int64_t)floor(time_s / PERIOD_S + 0.5);
    double into_s = time_s - ((double)cycle - 0.5) * PERIOD_S;
    /* The neighbour whose life is nearer, and how far the fade to or from it has come. */
    double before_s = into_s + 0.5 * CORE_DRIFT_FADE_S;
    double after_s = PERIOD_S - into_s + 0.5 * CORE_DRIFT_FADE_S;
    int64_t other = before_s < after_s ? cycle - 1 : cycle + 1;
    double weight = fmin(fmin(before_s, after_s) / CORE_DRIFT_FADE_S, 1.0);
    uint32_t phase = (uint32_t)(cycle & 1);
    set_phase(&drift, phase, cycle, time_s, weight, seed);
    set_phase(&drift, phase ^ 1u, other, time_s, 1.0 - weight, seed);
    return drift;
}
