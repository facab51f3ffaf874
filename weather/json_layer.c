#include "json_layer.h"

#include "genus.h"
#include "set.h"

#include <math.h>

static const double DEG = 0.017453292519943295;
static const double MOST_WIND_M_S = 125;
enum { MAX_LAYERS = 16 };

static const json_word GENERA[] = {{"Ci", VELUM_GENUS_CI}, {"Cc", VELUM_GENUS_CC}, {"Cs", VELUM_GENUS_CS},
                                   {"Ac", VELUM_GENUS_AC}, {"As", VELUM_GENUS_AS}, {"Ns", VELUM_GENUS_NS},
                                   {"Sc", VELUM_GENUS_SC}, {"St", VELUM_GENUS_ST}, {"Cu", VELUM_GENUS_CU},
                                   {"Cb", VELUM_GENUS_CB}};
static const json_word WATERS[] = {{"liquid", VELUM_WATER_LIQUID}, {"ice", VELUM_WATER_ICE}};
static const json_word STRUCTURES[] = {{"cloud", 0}, {"uniform", VELUM_LAYER_UNIFORM}};
static const json_word PRECIPITATIONS[] = {{"none", VELUM_PRECIPITATION_NONE}, {"rain", VELUM_PRECIPITATION_RAIN},
                                           {"snow", VELUM_PRECIPITATION_SNOW}, {"drizzle", VELUM_PRECIPITATION_DRIZZLE},
                                           {"hail", VELUM_PRECIPITATION_HAIL}, {"sleet", VELUM_PRECIPITATION_SLEET}};
#define COUNT(array) ((uint32_t)(sizeof(array) / sizeof((array)[0])))

void json_layer_defaults(int32_t genus, int32_t water, velum_layer *layer) {
    const weather_genus *typical = weather_genus_of(genus);
    layer->water = water;
    layer->water_g_m3 =
        water == VELUM_WATER_ICE ? sqrtf(typical->ice_min_g_m3 * typical->ice_max_g_m3) : typical->water_g_m3;
    layer->radius_um = water == VELUM_WATER_ICE ? WEATHER_COLD_ICE_RADIUS_UM : typical->radius_um;
}

/* "wind_from_deg" and "wind_m_s": both or neither. *given: 1 if they are there. */
static velum_result read_wind(const json_document *document, const json_node *object, float *east_m_s, float *north_m_s,
                              uint32_t *given) {
    double from_deg = 0, speed_m_s = 0;
    int any = json_member(document, object, "wind_from_deg") || json_member(document, object, "wind_m_s");
    TRY(json_read_double(document, object, "wind_from_deg", any, 0, 360, &from_deg));
    TRY(json_read_double(document, object, "wind_m_s", any, 0, MOST_WIND_M_S, &speed_m_s));
    *east_m_s = (float)(-speed_m_s * sin(from_deg * DEG));
    *north_m_s = (float)(-speed_m_s * cos(from_deg * DEG));
    *given = (uint32_t)any;
    return VELUM_OK;
}

static velum_result read_precipitation(const json_document *document, const json_node *object, float *rate_mm_h,
                                       int32_t *kind, uint32_t *given) {
    const json_node *rate = json_member(document, object, "precipitation_mm_h");
    *kind = rate ? VELUM_PRECIPITATION_RAIN : VELUM_PRECIPITATION_NONE;
    TRY(json_read_word(document, object, "precipitation", JSON_OPTIONAL, PRECIPITATIONS, COUNT(PRECIPITATIONS), kind));
    TRY(json_read_float(document, object, "precipitation_mm_h", *kind != VELUM_PRECIPITATION_NONE, 0, 500, rate_mm_h));
    if (*kind == VELUM_PRECIPITATION_NONE && *rate_mm_h > 0) {
        return json_refuse(document, rate, "0 where \"precipitation\" is \"none\"");
    }
    if (*rate_mm_h <= 0) {
        *kind = VELUM_PRECIPITATION_NONE;
    }
    *given = rate || json_member(document, object, "precipitation");
    return VELUM_OK;
}

/* Fields for measurements: a layer without noise, its extinction, albedo and phase as given. */
static velum_result read_optics(const json_document *document, const json_node *object, velum_layer *layer) {
    int32_t structure = 0;
    TRY(json_read_word(document, object, "structure", JSON_OPTIONAL, STRUCTURES, COUNT(STRUCTURES), &structure));
    layer->flags |= (uint32_t)structure;
    const json_node *extinction = json_member(document, object, "extinction_1_m");
    if (extinction) {
        if (json_member(document, object, "water_g_m3") || json_member(document, object, "radius_um")) {
            return json_refuse(document, extinction, "either extinction_1_m or water_g_m3 and radius_um, not both");
        }
        TRY(json_read_float(document, object, "extinction_1_m", JSON_REQUIRED, 0, 10, &layer->extinction_1_m));
        layer->flags |= VELUM_LAYER_EXTINCTION;
    }
    const json_node *albedo = json_member(document, object, "albedo");
    const json_node *phase = json_member(document, object, "phase");
    if ((albedo || phase) && !structure) {
        return json_refuse(document, albedo ? albedo : phase, "it only where \"structure\" is \"uniform\"");
    }
    if (albedo) {
        TRY(json_read_float(document, object, "albedo", JSON_REQUIRED, 0, 1, &layer->albedo));
        layer->flags |= VELUM_LAYER_ALBEDO;
    }
    if (phase) {
        static const char *const keys[] = {"hg", NULL};
        TRY(json_expect_keys(document, phase, keys));
        TRY(json_read_float(document, phase, "hg", JSON_REQUIRED, -0.999, 0.999, &layer->hg_asymmetry));
        layer->flags |= VELUM_LAYER_PHASE_HG;
    }
    return VELUM_OK;
}

static velum_result read_layer(const json_document *document, const json_node *object, velum_layer *layer) {
    static const char *const keys[] = {"type",         "coverage",       "base_m",
                                       "top_m",        "water",          "water_g_m3",
                                       "radius_um",    "wind_from_deg",  "wind_m_s",
                                       "transition_m", "scud",           "precipitation",
                                       "structure",    "extinction_1_m", "precipitation_mm_h",
                                       "albedo",       "phase",          NULL};
    uint32_t given = 0;
    TRY(json_expect_keys(document, object, keys));
    TRY(json_read_word(document, object, "type", JSON_REQUIRED, GENERA, COUNT(GENERA), &layer->genus));
    int32_t water = layer->genus <= VELUM_GENUS_CS ? VELUM_WATER_ICE : VELUM_WATER_LIQUID; /* Ci, Cc, Cs */
    TRY(json_read_word(document, object, "water", JSON_OPTIONAL, WATERS, COUNT(WATERS), &water));
    json_layer_defaults(layer->genus, water, layer);
    TRY(read_optics(document, object, layer));
    int uniform = (layer->flags & VELUM_LAYER_UNIFORM) != 0;
    layer->coverage = 1;
    TRY(json_read_float(document, object, "coverage", !uniform, uniform ? 1 : 0, 1, &layer->coverage));
    TRY(json_read_float(document, object, "base_m", JSON_REQUIRED, -500, 25000, &layer->base_m));
    TRY(json_read_float(document, object, "top_m", JSON_REQUIRED, -500, 25000, &layer->top_m));
    if (!(layer->top_m > layer->base_m)) {
        return json_refuse(document, json_member(document, object, "top_m"), "a number above base_m, %.9g",
                           (double)layer->base_m);
    }
    TRY(json_read_float(document, object, "water_g_m3", JSON_OPTIONAL, 0, 20, &layer->water_g_m3));
    TRY(json_read_float(document, object, "radius_um", JSON_OPTIONAL, 0.5, 500, &layer->radius_um));
    TRY(read_wind(document, object, &layer->wind_east_m_s, &layer->wind_north_m_s, &given));
    TRY(json_read_float(document, object, "transition_m", JSON_OPTIONAL, 0, 25000, &layer->transition_m));
    TRY(json_read_float(document, object, "scud", JSON_OPTIONAL, 0, 1, &layer->scud));
    return read_precipitation(document, object, &layer->precipitation_mm_h, &layer->precipitation, &given);
}

static velum_result read_layers(const json_document *document, const json_node *node, velum_weather_set *set,
                                velum_cell *cell) {
    TRY(json_expect_array(document, node, 0, MAX_LAYERS));
    velum_layer *layers = weather_set_layers(set, cell, node->count);
    if (node->count && !layers) {
        return VELUM_ERROR_OUT_OF_MEMORY;
    }
    uint32_t i = 0;
    for (const json_node *layer = json_first(document, node); layer; layer = json_next(document, layer)) {
        TRY(read_layer(document, layer, &layers[i++]));
    }
    cell->flags |= VELUM_CELL_HAS_LAYERS;
    return VELUM_OK;
}

velum_result json_read_weather(const json_document *document, const json_node *object, velum_weather_set *set,
                               velum_cell *cell) {
    const json_node *layers = json_member(document, object, "layers");
    if (layers) {
        TRY(read_layers(document, layers, set, cell));
    }
    if (json_member(document, object, "visibility_m")) {
        TRY(json_read_float(document, object, "visibility_m", JSON_REQUIRED, 1, 1e6, &cell->visibility_m));
        cell->flags |= VELUM_CELL_HAS_VISIBILITY;
    }
    TRY(json_read_float(document, object, "fog_top_m", JSON_OPTIONAL, -500, 25000, &cell->fog_top_m));
    TRY(json_read_float(document, object, "elevation_m", JSON_OPTIONAL, -500, 9000, &cell->elevation_m));

    uint32_t given = 0;
    TRY(read_wind(document, object, &cell->wind_east_m_s, &cell->wind_north_m_s, &given));
    cell->flags |= given ? VELUM_CELL_HAS_WIND : 0;
    const json_node *gust = json_member(document, object, "gust_m_s");
    if (gust && !given) {
        return json_refuse(document, gust, "it only beside wind_m_s");
    }
    TRY(json_read_float(document, object, "gust_m_s", JSON_OPTIONAL, 0, MOST_WIND_M_S, &cell->gust_m_s));

    const json_node *dew_point = json_member(document, object, "dew_point_c");
    int has_temperature = json_member(document, object, "temperature_c") || dew_point;
    float temperature_c = 0, dew_point_c = 0;
    TRY(json_read_float(document, object, "temperature_c", has_temperature, -100, 70, &temperature_c));
    TRY(json_read_float(document, object, "dew_point_c", JSON_OPTIONAL, -120, 70, &dew_point_c));
    if (dew_point && dew_point_c > temperature_c) {
        return json_refuse(document, dew_point, "at most temperature_c, %.9g", (double)temperature_c);
    }
    if (has_temperature) {
        cell->temperature_k = temperature_c + 273.15f;
        cell->dew_point_k = dew_point ? dew_point_c + 273.15f : 0;
        cell->flags |= VELUM_CELL_HAS_TEMPERATURE;
    }
    TRY(read_precipitation(document, object, &cell->precipitation_mm_h, &cell->precipitation, &given));
    cell->flags |= given ? VELUM_CELL_HAS_PRECIPITATION : 0;
    return json_read_bool(document, object, "thunderstorm", JSON_OPTIONAL, &cell->thunderstorm);
}

velum_result json_read_region(const json_document *document, const json_node *object, velum_weather_set *set,
                              velum_cell *cell) {
    uint32_t merge = 0;
    int64_t priority = 0;
    TRY(json_read_weather(document, object, set, cell));
    TRY(json_read_double(document, object, "transition_m", JSON_OPTIONAL, 0, 500000, &cell->transition_m));
    TRY(json_read_bool(document, object, "merge", JSON_OPTIONAL, &merge));
    TRY(json_read_integer(document, object, "priority", JSON_OPTIONAL, -1000, 1000, &priority));
    cell->priority = (int32_t)priority;
    if (!cell->flags && !cell->thunderstorm) {
        return json_refuse(document, object, "one with \"layers\", \"visibility_m\" or other weather");
    }
    cell->flags |= merge ? VELUM_CELL_MERGE_LAYERS : 0;
    return VELUM_OK;
}
