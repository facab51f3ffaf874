/* GeoJSON (RFC 7946): features with Polygon or MultiPolygon become regions. */
#ifndef VELUM_WEATHER_GEOJSON_H
#define VELUM_WEATHER_GEOJSON_H

#include "json.h"

/* What the features of a document become is appended to the set; VELUM_ERROR_OUT_OF_MEMORY leaves the set changed. */
velum_result geojson_read_document(velum_weather_set *set, json_document *document, velum_weather_report *report);

#endif
