#include "grib_column.h"
#include "grib_decode.h"

#include "error.h"
#include "set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CENTRE_NCEP = 7, ANY = -1, SURFACE_GROUND = 1, SURFACE_ISOBARIC = 100, SURFACE_ABOVE_GROUND = 103 };

/* On pressure levels. */
enum { LEVEL_HEIGHT, LEVEL_TEMPERATURE, LEVEL_EAST, LEVEL_NORTH, LEVEL_WATER, LEVEL_ICE, LEVEL_SLOTS };

/* On one surface. The decks come first, in the order of GRIB_DECK_*. */
enum {
    PLANE_COVER = 0,
    PLANE_BASE = PLANE_COVER + GRIB_DECKS,
    PLANE_TOP = PLANE_BASE + GRIB_DECKS,
    PLANE_ELEVATION = PLANE_TOP + GRIB_DECKS,
    PLANE_TEMPERATURE,
    PLANE_DEW_POINT,
    PLANE_HUMIDITY,
    PLANE_EAST,
    PLANE_NORTH,
    PLANE_GUST,
    PLANE_PRECIPITATION,
    PLANE_CONVECTIVE,
    PLANE_RAIN,
    PLANE_SNOW,
    PLANE_PELLETS,
    PLANE_CAPE,
    PLANE_VISIBILITY,
    PLANE_SLOTS
};

typedef struct field_rule {
    int plane; /* 1: PLANE_*; 0: LEVEL_* */
    int slot;
    int discipline, category, parameter; /* local parameters (192 and above) are NCEP's */
    int surface;
    double surface_value; /* of SURFACE_ABOVE_GROUND */
    double scale;
    double min, max; /* after scaling */
    const char *what;
} field_rule;

static const field_rule rules[] = {
    {0, LEVEL_HEIGHT, 0, 3, 5, SURFACE_ISOBARIC, 0, 1, -5000, 60000, "geopotential height (gpm)"},
    {0, LEVEL_HEIGHT, 0, 3, 4, SURFACE_ISOBARIC, 0, 1 / 9.80665, -5000, 60000, "geopotential (as gpm)"},
    {0, LEVEL_TEMPERATURE, 0, 0, 0, SURFACE_ISOBARIC, 0, 1, 120, 360, "temperature (K)"},
    {0, LEVEL_EAST, 0, 2, 2, SURFACE_ISOBARIC, 0, 1, -250, 250, "eastward wind (m/s)"},
    {0, LEVEL_NORTH, 0, 2, 3, SURFACE_ISOBARIC, 0, 1, -250, 250, "northward wind (m/s)"},
    {0, LEVEL_WATER, 0, 1, 22, SURFACE_ISOBARIC, 0, 1, -1e-3, 0.05, "cloud water (kg/kg)"},
    {0, LEVEL_WATER, 0, 1, 83, SURFACE_ISOBARIC, 0, 1, -1e-3, 0.05, "cloud water (kg/kg)"},
    {0, LEVEL_ICE, 0, 1, 23, SURFACE_ISOBARIC, 0, 1, -1e-3, 0.05, "cloud ice (kg/kg)"},
    {0, LEVEL_ICE, 0, 1, 84, SURFACE_ISOBARIC, 0, 1, -1e-3, 0.05, "cloud ice (kg/kg)"},
    {1, PLANE_COVER + GRIB_DECK_LOW, 0, 6, 1, 214, 0, 0.01, -0.01, 1.01, "low cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_LOW, 0, 6, 3, ANY, 0, 0.01, -0.01, 1.01, "low cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_MIDDLE, 0, 6, 1, 224, 0, 0.01, -0.01, 1.01, "middle cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_MIDDLE, 0, 6, 4, ANY, 0, 0.01, -0.01, 1.01, "middle cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_HIGH, 0, 6, 1, 234, 0, 0.01, -0.01, 1.01, "high cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_HIGH, 0, 6, 5, ANY, 0, 0.01, -0.01, 1.01, "high cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_CONVECTIVE, 0, 6, 1, 244, 0, 0.01, -0.01, 1.01, "convective cloud cover (0..1)"},
    {1, PLANE_COVER + GRIB_DECK_CONVECTIVE, 0, 6, 2, ANY, 0, 0.01, -0.01, 1.01, "convective cloud cover (0..1)"},
    {1, PLANE_BASE + GRIB_DECK_LOW, 0, 3, 0, 212, 0, 1, 1000, 115000, "pressure at low cloud bottom (Pa)"},
    {1, PLANE_BASE + GRIB_DECK_MIDDLE, 0, 3, 0, 222, 0, 1, 1000, 115000, "pressure at middle cloud bottom (Pa)"},
    {1, PLANE_BASE + GRIB_DECK_HIGH, 0, 3, 0, 232, 0, 1, 1000, 115000, "pressure at high cloud bottom (Pa)"},
    {1, PLANE_BASE + GRIB_DECK_CONVECTIVE, 0, 3, 0, 242, 0, 1, 1000, 115000,
     "pressure at convective cloud bottom (Pa)"},
    {1, PLANE_TOP + GRIB_DECK_LOW, 0, 3, 0, 213, 0, 1, 1000, 115000, "pressure at low cloud top (Pa)"},
    {1, PLANE_TOP + GRIB_DECK_MIDDLE, 0, 3, 0, 223, 0, 1, 1000, 115000, "pressure at middle cloud top (Pa)"},
    {1, PLANE_TOP + GRIB_DECK_HIGH, 0, 3, 0, 233, 0, 1, 1000, 115000, "pressure at high cloud top (Pa)"},
    {1, PLANE_TOP + GRIB_DECK_CONVECTIVE, 0, 3, 0, 243, 0, 1, 1000, 115000, "pressure at convective cloud top (Pa)"},
    {1, PLANE_ELEVATION, 0, 3, 5, SURFACE_GROUND, 0, 1, -600, 9500, "elevation of the surface (m)"},
    {1, PLANE_TEMPERATURE, 0, 0, 0, SURFACE_ABOVE_GROUND, 2, 1, 120, 360, "temperature at 2 m (K)"},
    {1, PLANE_DEW_POINT, 0, 0, 6, SURFACE_ABOVE_GROUND, 2, 1, 120, 360, "dew point at 2 m (K)"},
    {1, PLANE_HUMIDITY, 0, 1, 1, SURFACE_ABOVE_GROUND, 2, 1, -10, 150, "relative humidity at 2 m (%)"},
    {1, PLANE_EAST, 0, 2, 2, SURFACE_ABOVE_GROUND, 10, 1, -150, 150, "eastward wind at 10 m (m/s)"},
    {1, PLANE_NORTH, 0, 2, 3, SURFACE_ABOVE_GROUND, 10, 1, -150, 150, "northward wind at 10 m (m/s)"},
    {1, PLANE_GUST, 0, 2, 22, SURFACE_GROUND, 0, 1, 0, 200, "gust (m/s)"},
    {1, PLANE_PRECIPITATION, 0, 1, 7, SURFACE_GROUND, 0, 3600, -0.1, 500, "precipitation (mm/h)"},
    {1, PLANE_CONVECTIVE, 0, 1, 196, SURFACE_GROUND, 0, 3600, -0.1, 500, "convective precipitation (mm/h)"},
    {1, PLANE_CONVECTIVE, 0, 1, 37, SURFACE_GROUND, 0, 3600, -0.1, 500, "convective precipitation (mm/h)"},
    {1, PLANE_RAIN, 0, 1, 192, SURFACE_GROUND, 0, 1, 0, 1, "categorical rain"},
    {1, PLANE_RAIN, 0, 1, 33, SURFACE_GROUND, 0, 1, 0, 1, "categorical rain"},
    {1, PLANE_SNOW, 0, 1, 195, SURFACE_GROUND, 0, 1, 0, 1, "categorical snow"},
    {1, PLANE_SNOW, 0, 1, 36, SURFACE_GROUND, 0, 1, 0, 1, "categorical snow"},
    {1, PLANE_PELLETS, 0, 1, 194, SURFACE_GROUND, 0, 1, 0, 1, "categorical ice pellets"},
    {1, PLANE_PELLETS, 0, 1, 35, SURFACE_GROUND, 0, 1, 0, 1, "categorical ice pellets"},
    {1, PLANE_CAPE, 0, 7, 6, SURFACE_GROUND, 0, 1, -100, 20000, "CAPE (J/kg)"},
    {1, PLANE_VISIBILITY, 0, 19, 0, SURFACE_GROUND, 0, 1, 0, 1e6, "visibility (m)"},
};

typedef struct plane {
    float *values; /* null: not in the file */
    int instant;
} plane;

typedef struct grib_fields {
    const char *name;
    int has_grid;
    uint32_t grid_message;
    grib_grid grid;
    plane planes[PLANE_SLOTS];
    uint32_t level_count;
    float level_pa[GRIB_MAX_LEVELS];
    plane levels[GRIB_MAX_LEVELS][LEVEL_SLOTS];
    uint32_t used, seen;
} grib_fields;

static void fields_finish(grib_fields *fields) {
    for (int i = 0; i < PLANE_SLOTS; ++i) {
        free(fields->planes[i].values);
    }
    for (uint32_t i = 0; i < fields->level_count; ++i) {
        for (int j = 0; j < LEVEL_SLOTS; ++j) {
            free(fields->levels[i][j].values);
        }
    }
}

static const field_rule *rule_of(const grib_field *field) {
    for (size_t i = 0; i < sizeof(rules) / sizeof(rules[0]); ++i) {
        const field_rule *rule = &rules[i];
        if (rule->discipline == (int)field->discipline && rule->category == (int)field->category &&
            rule->parameter == (int)field->parameter &&
            (rule->surface == ANY || rule->surface == (int)field->surface) &&
            (rule->parameter < 192 || field->centre == CENTRE_NCEP) &&
            (rule->surface != SURFACE_ABOVE_GROUND || fabs(field->surface_value - rule->surface_value) < 0.5)) {
            return rule;
        }
    }
    return NULL;
}

/* Null: the file has more levels than we take, or one that is of no use. */
static plane *plane_of(grib_fields *fields, const field_rule *rule, const grib_field *field) {
    if (rule->plane) {
        return &fields->planes[rule->slot];
    }
    const float pressure_pa = (float)field->surface_value;
    if (!(pressure_pa >= 1000.0f && pressure_pa <= 115000.0f)) {
        return NULL;
    }
    uint32_t at = 0;
    while (at < fields->level_count && fields->level_pa[at] > pressure_pa) {
        ++at;
    }
    if (at == fields->level_count || fields->level_pa[at] != pressure_pa) {
        if (fields->level_count == GRIB_MAX_LEVELS) {
            return NULL;
        }
        for (uint32_t i = fields->level_count; i > at; --i) {
            fields->level_pa[i] = fields->level_pa[i - 1];
            memcpy(fields->levels[i], fields->levels[i - 1], sizeof(fields->levels[i]));
        }
        fields->level_pa[at] = pressure_pa;
        memset(fields->levels[at], 0, sizeof(fields->levels[at]));
        ++fields->level_count;
    }
    return &fields->levels[at][rule->slot];
}

static velum_result check_grid(grib_fields *fields, const grib_field *field, velum_weather_error *error) {
    grib_grid grid;
    const velum_result result = grib_field_grid(field, fields->name, &grid, error);
    if (result) {
        return result;
    }
    if (!fields->has_grid) {
        fields->grid = grid;
        fields->grid_message = field->number;
        fields->has_grid = 1;
        return VELUM_OK;
    }
    const grib_grid *first = &fields->grid;
    if (grid.columns != first->columns || grid.rows != first->rows || grid.lat_first_deg != first->lat_first_deg ||
        grid.lon_first_deg != first->lon_first_deg || grid.lat_step_deg != first->lat_step_deg ||
        grid.lon_step_deg != first->lon_step_deg) {
        return weather_fail_message(error, VELUM_ERROR_UNSUPPORTED, fields->name, field->number,
                                    "grid: found %u x %u from latitude %g, longitude %g, expected that of message %u: "
                                    "%u x %u from %g, %g",
                                    grid.columns, grid.rows, grid.lat_first_deg, grid.lon_first_deg,
                                    fields->grid_message, first->columns, first->rows, first->lat_first_deg,
                                    first->lon_first_deg);
    }
    return VELUM_OK;
}

static velum_result scale_and_check(const grib_fields *fields, const grib_field *field, const field_rule *rule,
                                    float *values, velum_weather_error *error) {
    const uint32_t nodes = fields->grid.columns * fields->grid.rows;
    const double slack = 1e-6 * fmax(fabs(rule->min), fabs(rule->max));
    for (uint32_t i = 0; i < nodes; ++i) {
        const double value = (double)values[i] * rule->scale;
        if (isnan(values[i])) {
            continue;
        }
        if (!(value >= rule->min - slack && value <= rule->max + slack)) {
            return weather_fail_message(error, VELUM_ERROR_ARGUMENT, fields->name, field->number,
                                        "%s: found %g at row %u, column %u, expected %g to %g", rule->what, value,
                                        i / fields->grid.columns + 1, i % fields->grid.columns + 1, rule->min,
                                        rule->max);
        }
        values[i] = (float)value;
    }
    return VELUM_OK;
}

static velum_result take_field(grib_fields *fields, const grib_field *field, velum_weather_error *error) {
    const field_rule *rule = rule_of(field);
    plane *target = rule ? plane_of(fields, rule, field) : NULL;
    /* The first of its kind holds; a value at a point in time goes before a mean. */
    if (!target || (target->values && (target->instant || !field->instant))) {
        return VELUM_OK;
    }
    velum_result result = check_grid(fields, field, error);
    if (result) {
        return result;
    }
    const size_t nodes = (size_t)fields->grid.columns * fields->grid.rows;
    float *values = malloc(nodes * sizeof(*values));
    if (!values) {
        return weather_out_of_memory(error, fields->name);
    }
    result = grib_field_decode(field, fields->name, &fields->grid, values, error);
    result = result ? result : scale_and_check(fields, field, rule, values, error);
    if (result) {
        free(values);
        return result;
    }
    fields->used += target->values == NULL;
    free(target->values);
    target->values = values;
    target->instant = field->instant;
    return VELUM_OK;
}

static velum_result read_fields(grib_fields *fields, const void *data, size_t size, velum_weather_error *error) {
    grib_reader reader;
    grib_reader_init(&reader, fields->name, data, size);
    for (;;) {
        grib_field field;
        int got = 0;
        velum_result result = grib_reader_next(&reader, &field, &got, error);
        if (result || !got) {
            return result;
        }
        ++fields->seen;
        result = take_field(fields, &field, error);
        if (result) {
            return result;
        }
    }
}

static velum_result check_clouds(const grib_fields *fields, velum_weather_error *error) {
    for (int i = 0; i < GRIB_DECKS; ++i) {
        if (fields->planes[PLANE_COVER + i].values) {
            return VELUM_OK;
        }
    }
    return weather_fail_message(error, VELUM_ERROR_UNSUPPORTED, fields->name, 0,
                                "no cloud fields in %u messages: expected the cover of low, middle, high or convective "
                                "cloud",
                                fields->seen);
}

static float at(const plane *source, uint32_t node, float absent) {
    return source->values && !isnan(source->values[node]) ? source->values[node] : absent;
}

static void take_profile(const grib_fields *fields, const grib_profile *standard, const float *log_pressure,
                         uint32_t node, grib_profile *profile) {
    profile->count = 0;
    for (uint32_t i = 0; i < fields->level_count; ++i) {
        const plane *level = fields->levels[i];
        const float height_m = at(&level[LEVEL_HEIGHT], node, NAN);
        const uint32_t to = profile->count;
        /* A profile rises, or log p says nothing about height. */
        if (isnan(height_m) || (to && grib_geometric_height_m(height_m) <= profile->height_m[to - 1])) {
            continue;
        }
        const float water = at(&level[LEVEL_WATER], node, NAN), ice = at(&level[LEVEL_ICE], node, NAN);
        profile->pressure_pa[to] = fields->level_pa[i];
        profile->log_pressure[to] = log_pressure[i];
        profile->height_m[to] = grib_geometric_height_m(height_m);
        profile->temperature_k[to] = at(&level[LEVEL_TEMPERATURE], node, NAN);
        profile->wind_east_m_s[to] = at(&level[LEVEL_EAST], node, NAN);
        profile->wind_north_m_s[to] = at(&level[LEVEL_NORTH], node, NAN);
        profile->water_kg_kg[to] = isnan(water) ? ice : water + (isnan(ice) ? 0.0f : fmaxf(ice, 0.0f));
        if (isnan(profile->temperature_k[to])) {
            profile->temperature_k[to] = grib_profile_temperature_k(standard, fields->level_pa[i]);
        }
        ++profile->count;
    }
    if (profile->count < 2) {
        *profile = *standard;
    }
}

/* Without pressures of bottoms and tops: the decks' usual places. */
static const float usual_base_pa[GRIB_DECKS] = {92500.0f, 90000.0f, 65000.0f, 35000.0f};
static const float usual_top_pa[GRIB_DECKS] = {82000.0f, 60000.0f, 55000.0f, 27500.0f};

static void take_decks(const grib_fields *fields, uint32_t node, grib_deck decks[GRIB_DECKS]) {
    for (int i = 0; i < GRIB_DECKS; ++i) {
        const plane *base = &fields->planes[PLANE_BASE + i], *top = &fields->planes[PLANE_TOP + i];
        const int is_bounded = base->values && top->values;
        decks[i].cover = fminf(fmaxf(at(&fields->planes[PLANE_COVER + i], node, 0.0f), 0.0f), 1.0f);
        decks[i].base_pa = is_bounded ? at(base, node, 0.0f) : usual_base_pa[i];
        decks[i].top_pa = is_bounded ? at(top, node, 0.0f) : usual_top_pa[i];
    }
}

static int32_t precipitation_kind(const grib_fields *fields, uint32_t node, float temperature_k) {
    const float rain = at(&fields->planes[PLANE_RAIN], node, 0.0f), snow = at(&fields->planes[PLANE_SNOW], node, 0.0f);
    const float pellets = at(&fields->planes[PLANE_PELLETS], node, 0.0f);
    if (snow >= 0.5f && snow >= rain) {
        return VELUM_PRECIPITATION_SNOW;
    }
    if (pellets >= 0.5f && pellets >= rain) {
        return VELUM_PRECIPITATION_SLEET;
    }
    if (rain < 0.5f && temperature_k > 0.0f && temperature_k < 273.65f) {
        return VELUM_PRECIPITATION_SNOW;
    }
    return VELUM_PRECIPITATION_RAIN;
}

/* Magnus formula, Alduchov and Eskridge 1996. */
static float dew_point_k(float temperature_k, float humidity_percent) {
    const float celsius = temperature_k - 273.15f;
    const float gamma =
        logf(fminf(fmaxf(humidity_percent, 1.0f), 100.0f) / 100.0f) + 17.625f * celsius / (243.04f + celsius);
    return 273.15f + 243.04f * gamma / (17.625f - gamma);
}

/* Surface properties of the cell; the layers' share of them goes to *surface. */
static void take_surface(const grib_fields *fields, const grib_profile *profile, uint32_t node, velum_cell *cell,
                         grib_surface *surface) {
    const plane *planes = fields->planes;
    const float temperature_k = at(&planes[PLANE_TEMPERATURE], node, 0.0f);
    const float humidity = at(&planes[PLANE_HUMIDITY], node, NAN);
    cell->flags = VELUM_CELL_HAS_LAYERS;
    cell->elevation_m = at(&planes[PLANE_ELEVATION], node, 0.0f);
    const float east = at(&planes[PLANE_EAST], node, profile->wind_east_m_s[0]);
    const float north = at(&planes[PLANE_NORTH], node, profile->wind_north_m_s[0]);
    if (!isnan(east) && !isnan(north)) {
        cell->flags |= VELUM_CELL_HAS_WIND;
        cell->wind_east_m_s = east;
        cell->wind_north_m_s = north;
        cell->gust_m_s = fmaxf(at(&planes[PLANE_GUST], node, 0.0f), 0.0f);
    }
    if (temperature_k > 0.0f) {
        cell->flags |= VELUM_CELL_HAS_TEMPERATURE;
        cell->temperature_k = temperature_k;
        cell->dew_point_k =
            at(&planes[PLANE_DEW_POINT], node, isnan(humidity) ? 0.0f : dew_point_k(temperature_k, humidity));
    }
    if (planes[PLANE_VISIBILITY].values && !isnan(planes[PLANE_VISIBILITY].values[node])) {
        cell->flags |= VELUM_CELL_HAS_VISIBILITY;
        cell->visibility_m = fmaxf(planes[PLANE_VISIBILITY].values[node], 1.0f);
    }
    surface->elevation_m = cell->elevation_m;
    surface->cape_j_kg = at(&planes[PLANE_CAPE], node, NAN);
    surface->precipitation_mm_h = fmaxf(at(&planes[PLANE_PRECIPITATION], node, 0.0f), 0.0f);
    surface->convective_mm_h =
        fminf(fmaxf(at(&planes[PLANE_CONVECTIVE], node, 0.0f), 0.0f), surface->precipitation_mm_h);
    surface->precipitation = precipitation_kind(fields, node, temperature_k);
    if (planes[PLANE_PRECIPITATION].values) {
        cell->flags |= VELUM_CELL_HAS_PRECIPITATION;
        if (surface->precipitation_mm_h > 0.01f) {
            cell->precipitation_mm_h = fminf(surface->precipitation_mm_h, 500.0f);
            cell->precipitation = surface->precipitation;
        }
    }
}

static velum_result make_grid(velum_weather_set *set, const grib_fields *fields, uint32_t *layer_count) {
    const uint32_t nodes = fields->grid.columns * fields->grid.rows;
    velum_cell *cells = weather_set_alloc(set, nodes, sizeof(*cells));
    if (!cells) {
        return VELUM_ERROR_OUT_OF_MEMORY;
    }
    float log_pressure[GRIB_MAX_LEVELS];
    for (uint32_t i = 0; i < fields->level_count; ++i) {
        log_pressure[i] = logf(fields->level_pa[i]);
    }
    grib_profile standard, profile;
    grib_standard_profile(&standard);
    for (uint32_t node = 0; node < nodes; ++node) {
        velum_cell *cell = &cells[node];
        cell->struct_size = sizeof(*cell);
        cell->id = weather_set_next_id(set);
        cell->kind = VELUM_CELL_STATION;
        cell->lat_deg = fields->grid.lat_first_deg + node / fields->grid.columns * fields->grid.lat_step_deg;
        cell->lon_deg = fields->grid.lon_first_deg + node % fields->grid.columns * fields->grid.lon_step_deg;
        grib_deck decks[GRIB_DECKS];
        grib_surface surface;
        velum_layer layers[GRIB_DECKS];
        take_profile(fields, &standard, log_pressure, node, &profile);
        take_decks(fields, node, decks);
        take_surface(fields, &profile, node, cell, &surface);
        const uint32_t count = grib_column_layers(&profile, decks, &surface, layers);
        velum_layer *own = weather_set_layers(set, cell, count);
        if (count && !own) {
            return VELUM_ERROR_OUT_OF_MEMORY;
        }
        if (count) {
            memcpy(own, layers, count * sizeof(*own));
        }
        cell->thunderstorm = surface.convective_mm_h > 2.5f && surface.cape_j_kg >= 500.0f;
        *layer_count += count;
    }
    return weather_set_take_grid(set, &(velum_grid){.struct_size = sizeof(velum_grid),
                                                    .lat_first_deg = fields->grid.lat_first_deg,
                                                    .lon_first_deg = fields->grid.lon_first_deg,
                                                    .lat_step_deg = fields->grid.lat_step_deg,
                                                    .lon_step_deg = fields->grid.lon_step_deg,
                                                    .columns = fields->grid.columns,
                                                    .rows = fields->grid.rows,
                                                    .cells = cells,
                                                    .cell_stride = sizeof(velum_cell)});
}

velum_result velum_weather_read_grib_memory(velum_weather_set *set, const char *name, const void *data, uint64_t size,
                                            velum_weather_report *report, velum_weather_error *error) {
    if (!set || (!data && size) || size > SIZE_MAX) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, 0, 0, "found a null set or null data");
    }
    grib_fields *fields = calloc(1, sizeof(*fields));
    if (!fields) {
        return weather_out_of_memory(error, name);
    }
    fields->name = name ? name : "GRIB2";
    const weather_set_mark_point mark = weather_set_mark(set);
    uint32_t layers = 0;
    velum_result result = read_fields(fields, data ? data : "", (size_t)size, error);
    result = result ? result : check_clouds(fields, error);
    if (!result) {
        result = make_grid(set, fields, &layers);
        if (result) {
            weather_set_rollback(set, &mark);
            weather_out_of_memory(error, fields->name);
        }
    }
    if (!result && report) {
        report->grid_nodes += fields->grid.columns * fields->grid.rows;
        report->grib_messages_used += fields->used;
        report->grib_messages_seen += fields->seen;
        report->layers += layers;
    }
    fields_finish(fields);
    free(fields);
    return result;
}

velum_result velum_weather_read_grib(velum_weather_set *set, const char *path, velum_weather_report *report,
                                     velum_weather_error *error) {
    char *bytes = NULL;
    size_t size = 0;
    velum_result result = weather_read_file(path, &bytes, &size, error);
    if (!result) {
        result = velum_weather_read_grib_memory(set, path, bytes, size, report, error);
    }
    free(bytes);
    return result;
}
