/* Phase functions: share of scattered light for each steradian, 1/sr, over the sphere 1. `c`: cosine of the angle by
 * which light turns. */
#ifndef VELUM_PHASE_H
#define VELUM_PHASE_H

#include "dialect.h"

#ifndef VULKAN
#include <stdbool.h>
#endif

#define VELUM_INV_4PI 0.07957747154594767f

/* Henyey & Greenstein 1941. 1 + g^2 - 2 g c is formed without cancellation near the forward peak. */
VELUM_FN float velum_phase_hg(float c, float g) {
    float d = (1.0f - g) * (1.0f - g) + 2.0f * g * (1.0f - c);
    d = VELUM_MAX(d, 1.0e-8f);
    return VELUM_INV_4PI * (1.0f - g * g) / (d * VELUM_SQRT(d));
}

/* Draine 2003, equation 3. */
VELUM_FN float velum_phase_draine(float c, float g, float alpha) {
    return velum_phase_hg(c, g) * (1.0f + alpha * c * c) / (1.0f + alpha * (1.0f + 2.0f * g * g) * (1.0f / 3.0f));
}

/* Mean cosine of Draine's function (Draine 2003, equation 4). */
VELUM_FN float velum_phase_draine_mean_cosine(float g, float alpha) {
    float g2 = g * g;
    return g * (1.0f + alpha * (3.0f + 2.0f * g2) * 0.2f) / (1.0f + alpha * (1.0f + 2.0f * g2) * (1.0f / 3.0f));
}

/* Droplets: a Henyey-Greenstein and a Draine lobe (Jendersie & d'Eon 2023), diameter 5..50 um. */
VELUM_STRUCT(velum_phase_droplet) {
    float g_hg, g_draine, alpha, weight_draine;
};
VELUM_FN velum_phase_droplet velum_phase_droplet_of(float diameter_um) {
    velum_phase_droplet p;
    float d = velum_clamp(diameter_um, 5.0f, 50.0f);
    p.g_hg = VELUM_EXP(-0.0990567f / (d - 1.67154f));
    p.g_draine = VELUM_EXP(-2.20679f / (d + 3.91029f) - 0.428934f);
    p.alpha = VELUM_EXP(3.62489f - 8.29288f / (d + 5.52825f));
    p.weight_draine = VELUM_EXP(-0.599085f / (d - 0.641583f) - 0.665888f);
    return p;
}
VELUM_FN float velum_phase_droplet_at(velum_phase_droplet p, float c) {
    return velum_mix(velum_phase_hg(c, p.g_hg), velum_phase_draine(c, p.g_draine, p.alpha), p.weight_draine);
}

/* The fit at a diameter of 20 um (effective radius 10 um). */
#define VELUM_DROPLET_20_G_HG 0.994610049f
#define VELUM_DROPLET_20_G_DRAINE 0.593790585f
#define VELUM_DROPLET_20_ALPHA 27.1136937f
#define VELUM_DROPLET_20_WEIGHT 0.498159484f

/* Ice: large rough crystals. Half of what they scatter is diffracted forward (van de Hulst 1957), the other half is
 * refracted and reflected; a two-term Henyey-Greenstein function (Kattawar 1975) with the mean cosine 0.75 of the
 * roughened aggregates of MODIS collection 6 (Platnick et al. 2017). */
#define VELUM_ICE_G_FORWARD 0.95f
#define VELUM_ICE_G_WIDE 0.55f
VELUM_FN float velum_phase_ice(float c) {
    return 0.5f * (velum_phase_hg(c, VELUM_ICE_G_FORWARD) + velum_phase_hg(c, VELUM_ICE_G_WIDE));
}

VELUM_FN float velum_phase_cloud(float c, bool ice) {
    float value;
    if (ice) {
        value = velum_phase_ice(c);
    } else {
        value = velum_mix(velum_phase_hg(c, VELUM_DROPLET_20_G_HG),
                          velum_phase_draine(c, VELUM_DROPLET_20_G_DRAINE, VELUM_DROPLET_20_ALPHA),
                          VELUM_DROPLET_20_WEIGHT);
    }
    return value;
}

#endif
