/* The groups of one METAR or SPECI report (ICAO Annex 3, WMO FM 15/16, and US practice) as figures. */
#ifndef VELUM_WEATHER_METAR_DECODE_H
#define VELUM_WEATHER_METAR_DECODE_H

#include <stddef.h>
#include <stdint.h>

enum { METAR_MAX_CLOUDS = 8 };

enum { METAR_FEW = 1, METAR_SCT, METAR_BKN, METAR_OVC };

typedef struct metar_cloud {
    int amount;     /* METAR_FEW ... */
    float height_m; /* above the station; NaN: not known */
    int32_t genus;  /* VELUM_GENUS_* if the group says so (CB: Cb, TCU: Cu), else 0 */
    int towering;   /* TCU */
} metar_cloud;

/* Bits of present weather. */
enum {
    METAR_FOG = 0x1,
    METAR_SHALLOW = 0x2, /* MI, BC, PR: fog that does not lie over the station */
    METAR_MIST = 0x4,
    METAR_HAZE = 0x8, /* HZ, FU, DU, SA, VA */
    METAR_SHOWER = 0x10,
    METAR_THUNDER = 0x20,
    METAR_STEADY = 0x40, /* rain or snow, not showers or drizzle */
    METAR_UNKNOWN = 0x80 /* UP */
};

typedef struct metar_report {
    char station[8];
    uint32_t minute_of_month;
    int has_wind, is_variable;
    float wind_from_deg, wind_m_s, gust_m_s;
    int has_visibility;
    float visibility_m;
    int has_sky;                 /* a sky group, CAVOK or a report of no cloud */
    int is_obscured;             /* VV */
    float vertical_visibility_m; /* NaN: not known */
    metar_cloud clouds[METAR_MAX_CLOUDS];
    uint32_t cloud_count;
    int has_temperature, has_dew_point;
    float temperature_k, dew_point_k;
    uint32_t weather; /* METAR_FOG ... */
    float precipitation_mm_h;
    int32_t precipitation; /* VELUM_PRECIPITATION_* */
} metar_report;

/* Decodes the first `size` characters. Returns 1, or 0 with the reason why the report is of no use and the place of the
 * group at fault. The station's name is set as soon as it is known. */
int metar_decode(const char *text, size_t size, metar_report *report, char reason[96], size_t *offset);

#endif
