/* Light that cloud or fog has scattered more than once, as a table over plane-parallel layers: source function (radiance
 * that a metre adds, over its extinction) at a depth below one face and above the other, by all orders but the first from
 * the sun, and by all orders from an even sky. It is made for each phase function by adding and doubling
 * (core/scattering_table.h). What it holds are binary logarithms, so that thin and thick, bright and dark are
 * interpolated alike: c0 + c1 cos(phi) + c2 cos(2 phi) + c3 cos(3 phi) about the sun's azimuth; of the sun's light over
 * velum_scattering_shape, which has the forward peak that nodes are too wide for. */
#ifndef VELUM_SCATTERING_H
#define VELUM_SCATTERING_H

#include "air.h"
#include "phase_sample.h"

/* Nodes: optical depths 2^k, of the cloud towards the lit face (x) and away from it (y); direction of the light, mu
 * from -1 to 1 evenly, within blocks of the sun's height, mu_sun = sin^2 of even angles (z). After these blocks one of
 * the sky: from beyond the lit face (c0), and from beyond the other (c1). Tables stand side by side in x. */
#define VELUM_SCATTERING_DEPTH_LOW (-5)
#define VELUM_SCATTERING_DEPTHS 14
#define VELUM_SCATTERING_MUS 16
#define VELUM_SCATTERING_SUNS 13
#define VELUM_SCATTERING_SLICES (VELUM_SCATTERING_MUS * (VELUM_SCATTERING_SUNS + 1))

/* VELUM_SLOT_UNIFORM and the next, then cloud of droplets and of ice, and fog. */
#define VELUM_SCATTERING_TABLES 5
#define VELUM_SCATTERING_WATER 2
#define VELUM_SCATTERING_ICE 3
#define VELUM_SCATTERING_FOG 4

/* Streams in a half space. What phase functions have beyond twice as many moments goes straight on: the part
 * `velum_scattering_peak` of all scattering (delta-M, Wiscombe 1977). */
#define VELUM_SCATTERING_STREAMS 12
#define VELUM_SCATTERING_MOMENTS 24

VELUM_FN float velum_scattering_depth_node(float depth) {
    float node = VELUM_LOG2(VELUM_MAX(depth, 1.0e-9f)) - VELUM_TO_FLOAT(VELUM_SCATTERING_DEPTH_LOW);
    return velum_clamp(node, 0.0f, VELUM_TO_FLOAT(VELUM_SCATTERING_DEPTHS - 1));
}
VELUM_FN float velum_scattering_mu_node(float mu) {
    return velum_clamp(0.5f + 0.5f * mu, 0.0f, 1.0f) * VELUM_TO_FLOAT(VELUM_SCATTERING_MUS - 1);
}
/* acos(1 - 2 mu) is twice the angle whose sin^2 is mu. */
VELUM_FN float velum_scattering_sun_node(float mu_sun) {
    float angle = VELUM_ACOS(velum_clamp(1.0f - 2.0f * mu_sun, -1.0f, 1.0f));
    return angle * (VELUM_TO_FLOAT(VELUM_SCATTERING_SUNS - 1) / 3.14159265f);
}

/* Cosine of the azimuth between light and sun, of their heights (mu, that of the sun's light being -mu_sun) and the
 * cosine of the angle between them. */
VELUM_FN float velum_scattering_azimuth(float mu, float mu_sun, float cos_sun) {
    float sines = VELUM_SQRT(VELUM_MAX((1.0f - mu * mu) * (1.0f - mu_sun * mu_sun), 1.0e-8f));
    return velum_clamp((cos_sun + mu * mu_sun) / sines, -1.0f, 1.0f);
}

/* For sun of illuminance 1: cd/m2, over velum_scattering_shape. */
VELUM_FN float velum_scattering_value(float c0, float c1, float c2, float c3, float cos_azimuth) {
    float c = cos_azimuth;
    return VELUM_EXP2(c0 - c2 + c * (c1 - 3.0f * c3 + c * (2.0f * c2 + c * 4.0f * c3)));
}

/* How light that scatters twice and more stands about the sun: the orders that have kept to the forward peak, after
 * k >= 1 turns on the way down to an optical depth of `turning` along the sun (Poisson's shares), each Henyey and
 * Greenstein's of g^(k + 1) (Riley et al. 2004), and an even share for all else. `g`: mean cosine of what the peak of
 * velum_scattering_peak leaves; `turning`: without that peak. */
VELUM_FN float velum_scattering_shape(float cos_sun, float g, float turning) {
    float keeps = VELUM_MAX(g, 0.0f);
    float depth = VELUM_MAX(turning, 1.0e-4f);
    float none = VELUM_EXP(-depth);
    float one = none * depth;
    /* All but the first together, by their mean order. */
    float rest = VELUM_MAX(1.0f - none - one, 0.0f);
    float order = depth < 0.05f ? 2.0f + depth * (1.0f / 3.0f) : (depth - one) / rest;
    return 0.1f * VELUM_INV_4PI + one * velum_phase_hg(cos_sun, keeps * keeps) +
           rest * velum_phase_hg(cos_sun, VELUM_POW(keeps, order + 1.0f));
}

/* The mean cosine that a peak leaves. */
VELUM_FN float velum_scattering_rest(float mean_cosine, float peak) {
    return (mean_cosine - peak) / VELUM_MAX(1.0f - peak, 1.0e-6f);
}

/* Optical depth along the sun at which the table takes its shape: within its nodes. */
VELUM_FN float velum_scattering_turning(float above, float mu_sun, float scale) {
    float least = VELUM_EXP2(VELUM_TO_FLOAT(VELUM_SCATTERING_DEPTH_LOW));
    return scale * VELUM_MAX(above, least) / VELUM_MAX(VELUM_ABS(mu_sun), 1.0e-3f);
}

/* Below the first node what scatters twice goes with the whole depth. */
VELUM_FN float velum_scattering_thin(float depth) {
    return VELUM_MIN(depth * VELUM_EXP2(VELUM_TO_FLOAT(-VELUM_SCATTERING_DEPTH_LOW - 1)), 1.0f);
}

/* Moment l of Henyey and Greenstein's function: g^l, of a negative g too. */
VELUM_FN float velum_phase_hg_moment(float g, int l) {
    float power = l == 0 ? 1.0f : VELUM_POW(VELUM_ABS(g), VELUM_TO_FLOAT(l));
    return g < 0.0f && l % 2 == 1 ? -power : power;
}

/* Moment l of a phase function: mean of the Legendre polynomial of cos. cos^2 P_l is a sum of P_l-2, P_l and P_l+2. */
VELUM_FN float velum_phase_lobes_moment(velum_phase_lobes p, int l) {
    float n = VELUM_TO_FLOAT(l);
    float g = p.g_second;
    float power = velum_phase_hg_moment(g, l);
    float own = (n + 1.0f) * (n + 1.0f) / ((2.0f * n + 1.0f) * (2.0f * n + 3.0f)) +
                (l < 1 ? 0.0f : n * n / ((2.0f * n - 1.0f) * (2.0f * n + 1.0f)));
    float after = (n + 1.0f) * (n + 2.0f) / ((2.0f * n + 1.0f) * (2.0f * n + 3.0f));
    float before = l < 2 ? 0.0f : n * (n - 1.0f) / (4.0f * n * n - 1.0f) * velum_phase_hg_moment(g, l - 2);
    float square = power * (own + after * g * g) + before;
    float second = (power + p.alpha_second * square) / (1.0f + p.alpha_second * (1.0f + 2.0f * g * g) * (1.0f / 3.0f));
    return velum_mix(velum_phase_hg_moment(p.g_first, l), second, p.weight_second);
}

/* Share of scattering that counts as going straight on. */
VELUM_FN float velum_scattering_peak(velum_phase_lobes p) {
    float mean = velum_phase_lobes_moment(p, 1);
    return mean > 0.0f ? VELUM_MAX(velum_phase_lobes_moment(p, VELUM_SCATTERING_MOMENTS), 0.0f) : 0.0f;
}

/* Of velum_phase_lobes_cloud: its peak, and velum_scattering_rest. */
#define VELUM_SCATTERING_WATER_PEAK 0.440796465f
#define VELUM_SCATTERING_WATER_REST 0.784175992f
#define VELUM_SCATTERING_ICE_PEAK 0.145994768f
#define VELUM_SCATTERING_ICE_REST 0.707261741f

/* Henyey and Greenstein's function for sunlight that has gone straight on `straight` times on the mean before, which
 * the peak takes for nothing: who has done so k times scatters by the function's own k + 1st convolution, which is
 * Henyey and Greenstein's again, of g^(k + 1) (Riley et al. 2004), or by what the peak leaves. */
VELUM_FN float velum_scattering_first(float cos_sun, float g, float peak, float straight) {
    float wide = (1.0f - peak) * velum_phase_hg(cos_sun, velum_scattering_rest(g, peak));
    /* No loop: software devices count their rounds over all of a ray. */
    float none = VELUM_EXP(-straight);
    float one = none * straight;
    float two = one * straight * 0.5f;
    float three = two * straight * (1.0f / 3.0f);
    float g2 = g * g;
    float few = one * velum_phase_hg(cos_sun, g2) + two * velum_phase_hg(cos_sun, g2 * g) +
                three * velum_phase_hg(cos_sun, g2 * g2);
    /* All others as one, of their mean order. */
    float rest = VELUM_MAX(1.0f - none - one - two - three, 0.0f);
    float order = VELUM_MAX((straight - one - 2.0f * two - 3.0f * three) / VELUM_MAX(rest, 1.0e-6f), 4.0f) + 1.0f;
    few = few + rest * velum_phase_hg(cos_sun, VELUM_POW(VELUM_MAX(g, 0.0f), order));
    return wide + none * (velum_phase_hg(cos_sun, g) - wide) + peak * few;
}

#endif
