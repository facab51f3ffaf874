/* The column of one grid node: cloud decks of a forecast model made into layers. Rules: FORMAT.md, "GRIB2". */
#ifndef VELUM_WEATHER_GRIB_COLUMN_H
#define VELUM_WEATHER_GRIB_COLUMN_H

#include <stdint.h>
#include <velum/weather.h>

enum { GRIB_DECK_LOW, GRIB_DECK_CONVECTIVE, GRIB_DECK_MIDDLE, GRIB_DECK_HIGH, GRIB_DECKS, GRIB_MAX_LEVELS = 64 };

/* Pressure levels from below. Winds and water may be NaN: not known there. */
typedef struct grib_profile {
    uint32_t count;                      /* at least 2 */
    float log_pressure[GRIB_MAX_LEVELS]; /* of Pa, falling */
    float pressure_pa[GRIB_MAX_LEVELS];
    float height_m[GRIB_MAX_LEVELS]; /* MSL */
    float temperature_k[GRIB_MAX_LEVELS];
    float wind_east_m_s[GRIB_MAX_LEVELS], wind_north_m_s[GRIB_MAX_LEVELS];
    float water_kg_kg[GRIB_MAX_LEVELS]; /* cloud water and ice, mean over the node */
} grib_profile;

typedef struct grib_deck {
    float cover; /* 0..1; 0: no cloud */
    float base_pa, top_pa;
} grib_deck;

typedef struct grib_surface {
    float elevation_m;
    float cape_j_kg; /* NaN: not known */
    float precipitation_mm_h, convective_mm_h;
    int32_t precipitation; /* VELUM_PRECIPITATION_* */
} grib_surface;

/* Geometric height of a geopotential height (ICAO Doc 7488: earth radius 6,356,766 m). */
float grib_geometric_height_m(float geopotential_m);

/* The ICAO standard atmosphere (Doc 7488) up to 32 km, for files without heights or temperatures. */
void grib_standard_profile(grib_profile *profile);

/* Height (linear in log p, extrapolated) and temperature at a pressure. */
float grib_profile_height_m(const grib_profile *profile, float pressure_pa);
float grib_profile_temperature_k(const grib_profile *profile, float pressure_pa);
/* Cloud water between two pressures, g/m2. */
float grib_profile_water_path_g_m2(const grib_profile *profile, float base_pa, float top_pa);

/* Makes the layers from below and returns their number. */
uint32_t grib_column_layers(const grib_profile *profile, const grib_deck decks[GRIB_DECKS], const grib_surface *surface,
                            velum_layer layers[GRIB_DECKS]);

#endif
