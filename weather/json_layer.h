/* The weather of a place as JSON: layers, visibility, wind and so on, alike in scenarios and GeoJSON properties. */
#ifndef VELUM_WEATHER_JSON_LAYER_H
#define VELUM_WEATHER_JSON_LAYER_H

#include "json.h"

/* Members that json_read_weather() reads, and those that json_read_region() reads besides. */
#define JSON_WEATHER_KEYS                                                                                              \
    "layers", "visibility_m", "fog_top_m", "elevation_m", "wind_from_deg", "wind_m_s", "gust_m_s", "temperature_c",    \
        "dew_point_c", "precipitation", "precipitation_mm_h", "thunderstorm"
#define JSON_REGION_KEYS "transition_m", "merge", "priority"

/* Members of `object` become the cell's properties and flags; its layers are memory of the set. */
velum_result json_read_weather(const json_document *document, const json_node *object, velum_weather_set *set,
                               velum_cell *cell);
/* The same and what only regions have; refuses one without weather. */
velum_result json_read_region(const json_document *document, const json_node *object, velum_weather_set *set,
                              velum_cell *cell);

/* What a layer of this genus is made of unless it says otherwise: water, water_g_m3, radius_um. */
void json_layer_defaults(int32_t genus, int32_t water, velum_layer *layer);

#endif
