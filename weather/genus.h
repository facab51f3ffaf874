/* What a genus is made of when a source does not say: water content, effective radius, thickness. FORMAT.md states the
 * figures and their sources. */
#ifndef VELUM_WEATHER_GENUS_H
#define VELUM_WEATHER_GENUS_H

#include <stdint.h>
#include <velum/weather.h>

/* Colder than this in the middle, a layer is ice. Cumulus and cumulonimbus go by their base. */
#define WEATHER_ICE_TEMPERATURE_K 258.15f

/* Effective radius of ice in cirrus at -50 C: Hess et al. 1998. */
#define WEATHER_COLD_ICE_RADIUS_UM 57.4f

typedef struct weather_genus {
    float water_g_m3;     /* typical, liquid */
    float water_min_g_m3; /* bounds of what a source may say, liquid */
    float water_max_g_m3;
    float ice_min_g_m3;
    float ice_max_g_m3;
    float radius_um;   /* liquid */
    float thickness_m; /* typical */
} weather_genus;

const weather_genus *weather_genus_of(int32_t genus);

/* Sets water, water_g_m3 and radius_um. source_g_m3: water content in cloud by the source; NaN or 0: not known. */
void weather_genus_fill(velum_layer *layer, float temperature_k, float base_temperature_k, float source_g_m3);

/* A layer that leaves much of the sky clear is shallow: a sheet or field of this cover is no thicker. Cu, Cb: infinite.
 */
float weather_thickness_limit_m(int32_t genus, float coverage);

#endif
