#include "genus.h"

#include <math.h>

/* Liquid water content and radius: Hess, Koepke and Schult 1998, OPAC (stratus continental 0.28 g/m3, 7.3 um; cumulus
 * continental 0.26, 5.8 and maritime 0.44, 12.7), and Miles, Verlinde and Clothiaux 2000 for stratocumulus. */
static const weather_genus genera[] = {
    [VELUM_GENUS_CI] = {0.05f, 0.01f, 0.2f, 0.002f, 0.15f, 7.0f, 1200.0f},
    [VELUM_GENUS_CC] = {0.05f, 0.01f, 0.2f, 0.002f, 0.10f, 7.0f, 400.0f},
    [VELUM_GENUS_CS] = {0.05f, 0.01f, 0.2f, 0.002f, 0.15f, 7.0f, 1500.0f},
    [VELUM_GENUS_AC] = {0.15f, 0.05f, 0.5f, 0.010f, 0.30f, 8.0f, 600.0f},
    [VELUM_GENUS_AS] = {0.15f, 0.05f, 0.5f, 0.020f, 0.30f, 8.0f, 1500.0f},
    [VELUM_GENUS_NS] = {0.30f, 0.10f, 0.8f, 0.040f, 0.50f, 10.0f, 3000.0f},
    [VELUM_GENUS_SC] = {0.25f, 0.08f, 0.8f, 0.020f, 0.30f, 9.0f, 400.0f},
    [VELUM_GENUS_ST] = {0.28f, 0.08f, 0.6f, 0.020f, 0.30f, 7.3f, 300.0f},
    [VELUM_GENUS_CU] = {0.35f, 0.15f, 1.5f, 0.050f, 0.50f, 9.0f, 800.0f},
    [VELUM_GENUS_CB] = {0.60f, 0.30f, 3.0f, 0.100f, 1.00f, 12.0f, 8000.0f},
};

const weather_genus *weather_genus_of(int32_t genus) {
    return &genera[genus >= VELUM_GENUS_CI && genus <= VELUM_GENUS_CB ? genus : VELUM_GENUS_SC];
}

/* Climatological ice water content of cirrus: Liou 1992, after Heymsfield and Platt 1984. */
static float ice_water_g_m3(float temperature_k) {
    const float below_253 = 253.0f - fminf(temperature_k, 253.0f);
    return expf(-7.6f + 4.0f * expf(-0.2443e-3f * powf(below_253, 2.445f)));
}

/* Effective radius of ice: a line through cirrus at -25 C (92 um) and at -50 C of Hess et al. 1998. */
static float ice_radius_um(float temperature_k) {
    return fminf(fmaxf(92.0f + (temperature_k - 248.15f) * (92.0f - WEATHER_COLD_ICE_RADIUS_UM) / 25.0f, 25.0f),
                 100.0f);
}

void weather_genus_fill(velum_layer *layer, float temperature_k, float base_temperature_k, float source_g_m3) {
    const weather_genus *typical = weather_genus_of(layer->genus);
    const int convective = layer->genus == VELUM_GENUS_CU || layer->genus == VELUM_GENUS_CB;
    const int is_known = source_g_m3 > 0.0f;
    if ((convective ? base_temperature_k : temperature_k) < WEATHER_ICE_TEMPERATURE_K) {
        const float climate = ice_water_g_m3(temperature_k);
        layer->water = VELUM_WATER_ICE;
        layer->radius_um = ice_radius_um(temperature_k);
        layer->water_g_m3 = fmaxf(is_known ? source_g_m3 : 0.0f, climate);
        layer->water_g_m3 = fminf(fmaxf(layer->water_g_m3, typical->ice_min_g_m3), typical->ice_max_g_m3);
    } else {
        layer->water = VELUM_WATER_LIQUID;
        layer->radius_um = typical->radius_um;
        layer->water_g_m3 = is_known ? fminf(fmaxf(source_g_m3, typical->water_min_g_m3), typical->water_max_g_m3)
                                     : typical->water_g_m3;
    }
}

float weather_thickness_limit_m(int32_t genus, float coverage) {
    float shallow_m;
    switch (genus) {
    case VELUM_GENUS_CU: return 600.0f + 3000.0f * coverage;
    case VELUM_GENUS_CB: return INFINITY;
    case VELUM_GENUS_CI:
    case VELUM_GENUS_CC:
    case VELUM_GENUS_CS: shallow_m = 800.0f; break;
    default: shallow_m = 400.0f;
    }
    return shallow_m / fmaxf(1.0f - coverage, 1e-3f);
}
