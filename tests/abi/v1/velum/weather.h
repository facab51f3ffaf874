/* Velum ABI, part 2: the words of weather, as plain data. Made by a host directly, or by libvelum-weather from files.
 *
 * Latitudes and longitudes are geodetic, WGS84, degrees. Heights of layers are metres above mean sea level (MSL).
 * Every struct may be zero-initialised; 0 in an optional field means "not given" where its comment says so. */
#ifndef VELUM_WEATHER_H
#define VELUM_WEATHER_H

#include "abi.h"

#ifdef __cplusplus
extern "C" {
#endif

/* Genera of the WMO cloud atlas. */
enum {
    VELUM_GENUS_CI = 1, /* cirrus */
    VELUM_GENUS_CC = 2, /* cirrocumulus */
    VELUM_GENUS_CS = 3, /* cirrostratus */
    VELUM_GENUS_AC = 4, /* altocumulus */
    VELUM_GENUS_AS = 5, /* altostratus */
    VELUM_GENUS_NS = 6, /* nimbostratus */
    VELUM_GENUS_SC = 7, /* stratocumulus */
    VELUM_GENUS_ST = 8, /* stratus */
    VELUM_GENUS_CU = 9, /* cumulus */
    VELUM_GENUS_CB = 10 /* cumulonimbus */
};

enum { VELUM_WATER_LIQUID = 0, VELUM_WATER_ICE = 1 };

enum {
    VELUM_PRECIPITATION_NONE = 0,
    VELUM_PRECIPITATION_RAIN = 1,
    VELUM_PRECIPITATION_SNOW = 2,
    VELUM_PRECIPITATION_DRIZZLE = 3,
    VELUM_PRECIPITATION_HAIL = 4,
    VELUM_PRECIPITATION_SLEET = 5
};

/* Layer flags. */
#define VELUM_LAYER_UNIFORM 0x1u    /* no noise, coverage 1, sharp edges: for measurements */
#define VELUM_LAYER_EXTINCTION 0x2u /* extinction_1_m is given; water_g_m3 and radius_um are not used */
#define VELUM_LAYER_PHASE_HG 0x4u   /* hg_asymmetry is given: a Henyey-Greenstein phase function; UNIFORM layers only */
#define VELUM_LAYER_ALBEDO 0x8u     /* albedo is given (otherwise 1); UNIFORM layers only */

/* One layer of cloud. Extinction is 3 WC / (2 rho r_eff) (geometric optics, efficiency 2; Hess et al. 1998), with rho
 * the density of water (1000 kg/m3) or of ice (917 kg/m3). */
typedef struct velum_layer {
    uint32_t struct_size;
    uint32_t flags;           /* VELUM_LAYER_* */
    int32_t genus;            /* VELUM_GENUS_* */
    int32_t water;            /* VELUM_WATER_* */
    float coverage;           /* share of the area, seen from the nadir, 0..1 */
    float base_m;             /* MSL, -500..25000 */
    float top_m;              /* MSL, above base_m, at most 25000 */
    float water_g_m3;         /* mean water content in cloud, 0..20 */
    float radius_um;          /* effective radius, 0.5..500 */
    float extinction_1_m;     /* 0..10; see VELUM_LAYER_EXTINCTION */
    float albedo;             /* single-scattering albedo, 0..1; see VELUM_LAYER_ALBEDO */
    float hg_asymmetry;       /* -0.999..0.999; see VELUM_LAYER_PHASE_HG */
    float wind_east_m_s;      /* wind vector (towards), in the frame of east and north at the cell's own place; */
    float wind_north_m_s;     /*   of a global cell: at every place (fading to 0 within 1 degree of a pole) */
    float transition_m;       /* 0..25000: depth of the transition band, under the base and (of sheets: St, As, Ns, Cs,
                                 and partly Sc) over the tops of the cloud, in which the layer thins out from half of its
                                 extinction to nothing; base_m and top_m stay those of the cloud proper. 0: none. Not of
                                 UNIFORM layers */
    float scud;               /* 0..1: ragged fragments under the base, more and deeper with it, to 120 m + 380 m times
                                 scud below the base, not under 0.3 of its height; 0: none. Not of UNIFORM layers */
    float precipitation_mm_h; /* 0..500: that falls from the layer, water equivalent, at its base, under its thick
                                 parts. Of UNIFORM layers no effect in the picture */
    int32_t precipitation;    /* VELUM_PRECIPITATION_*; of NONE with a rate: rain */
} velum_layer;

/* What falls is seen, and extinguishes, 1/km with R in mm/h: rain 0.365 R^0.63 (the drops of Marshall & Palmer 1948),
 * from Cu and Cb 0.163 R^0.63, drizzle 0.509 R^0.63 (Joss et al. 1968), hail as rain from Cb, snow 3.34 R^0.57 (Gunn &
 * Marshall 1958, flakes of a tenth of the density of water), sleet in between; in streaks about that mean. It lags
 * behind the layer's wind and evaporates on its way down: at depth d under the base R (1 - (d / D)^2)^2 is left of it,
 * D = 3900 m R^1/4 (Sundqvist 1988, in air whose humidity falls by 4 % each 100 m). Where D ends above the surface it
 * is virga. Base, top, coverage and water content are those of the cloud without it and without scud. */

enum {
    VELUM_CELL_GLOBAL = 1,   /* everywhere: the background */
    VELUM_CELL_STATION = 2,  /* acts around a point and fades into what lies below it */
    VELUM_CELL_POLYGON = 3,  /* rings of latitude and longitude; edges straight in latitude and longitude (RFC 7946) */
    VELUM_CELL_RECTANGLE = 4 /* CIGI environmental region: rectangle with rounded corners, turned about its centre */
};

/* What a cell does to the properties of what lies below it (background grid < stations < regions, then by priority). */
#define VELUM_CELL_MERGE_LAYERS 0x1u /* its layers join those below instead of replacing them */
#define VELUM_CELL_HAS_LAYERS 0x2u   /* without it the layers below stay (with it, 0 layers mean a clear sky) */
#define VELUM_CELL_HAS_VISIBILITY 0x4u
#define VELUM_CELL_HAS_WIND 0x8u /* surface wind */
#define VELUM_CELL_HAS_PRECIPITATION 0x10u
#define VELUM_CELL_HAS_TEMPERATURE 0x20u

/* A vertex of a polygon. */
typedef struct velum_lat_lon {
    double lat_deg;
    double lon_deg;
} velum_lat_lon;

typedef struct velum_cell {
    uint32_t struct_size;
    uint32_t flags;     /* VELUM_CELL_* */
    uint64_t id;        /* unique in a state; names the cell in delta commits and in logs */
    int32_t kind;       /* VELUM_CELL_GLOBAL ... */
    int32_t priority;   /* among cells of the same rank: higher lies above */
    double lat_deg;     /* of the centre: -90..90; nodes, stations, rectangles */
    double lon_deg;     /* -180..360 */
    double radius_m;    /* station: full effect within half of it, none beyond it; 1000..500000, 0 = 60000 */
    double half_east_m; /* rectangle: half its width and height before rotation, along geodesics, > 0 */
    double half_north_m;
    double corner_radius_m; /* 0..min(half_east_m, half_north_m) */
    double rotation_deg;    /* clockwise, seen from above */
    double transition_m;    /* polygon and rectangle: width of the transition perimeter, outside the edge; >= 0.
                               The effect is 1 up to the edge and 0 beyond edge + transition; with 0 it is sharp */
    const velum_lat_lon
        *points; /* polygon: all rings in turn, each closed implicitly; outer rings and holes by even-odd */
    uint32_t point_count;
    uint32_t ring_count;
    const uint32_t *ring_sizes; /* ring_count numbers of points, in sum point_count */
    const velum_layer *layers;
    uint32_t layer_count; /* at most 16 */
    uint32_t layer_stride;
    float visibility_m;  /* meteorological optical range (5 % contrast), surface; 1..1e6 */
    float fog_top_m;     /* MSL; the low visibility reaches up to here; 0: 300 m above the surface elevation */
    float elevation_m;   /* of the surface, MSL */
    float wind_east_m_s; /* surface wind, towards */
    float wind_north_m_s;
    float gust_m_s;
    float temperature_k;
    float dew_point_k;
    float precipitation_mm_h;
    int32_t precipitation; /* VELUM_PRECIPITATION_* */
    uint32_t thunderstorm; /* 1: reported */
    uint32_t reserved;
} velum_cell;

/* A regular latitude-longitude grid of nodes; it ranks above global cells and below stations. cells[j * columns + i]
 * stands at latitude lat_first_deg + j lat_step_deg and longitude lon_first_deg + i lon_step_deg; its kind, lat_deg and
 * lon_deg are not read. A grid whose columns reach round the globe is closed over the antimeridian. Outside it nothing
 * is added. */
typedef struct velum_grid {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    double lat_first_deg;
    double lon_first_deg;
    double lat_step_deg; /* may be negative (north to south) */
    double lon_step_deg; /* > 0 */
    uint32_t columns;
    uint32_t rows;
    const velum_cell *cells; /* rows * columns */
    uint32_t cell_stride;
    uint32_t reserved;
} velum_grid;

/* A weather state, whole or as a change of an earlier one. */
typedef struct velum_state_desc {
    uint32_t struct_size;
    uint32_t flags;          /* 0 */
    uint64_t base_state;     /* 0: whole; else the id of the state that this one changes */
    const velum_grid *grid;  /* may be null (delta: null keeps the base's grid) */
    const velum_cell *cells; /* global, station and region cells; in a delta those added or replaced, by id */
    uint32_t cell_count;
    uint32_t cell_stride;
    const uint64_t *removed_ids; /* delta only */
    uint32_t removed_count;
    float geoid_undulation_m; /* HAE = MSL + undulation; -200..200 */
} velum_state_desc;

/* A key of the timeline: from time_s - transition_s to time_s the weather blends from the key before into `state`,
 * which then holds. The first key holds from the beginning of time. */
typedef struct velum_timeline_key {
    uint32_t struct_size;
    uint32_t reserved;
    double time_s;       /* strictly increasing */
    double transition_s; /* >= 0; at most the distance to the key before */
    uint64_t state;      /* from commit() */
} velum_timeline_key;

#ifdef __cplusplus
}
#endif
#endif
