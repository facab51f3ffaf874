/* One decoded report made into a station cell and its layers. Rules: FORMAT.md, "METAR". */
#ifndef VELUM_WEATHER_METAR_CELL_H
#define VELUM_WEATHER_METAR_CELL_H

#include "metar_decode.h"

#include <velum/weather.h>

/* Layers from below; returns their number. */
uint32_t metar_layers(const metar_report *report, float elevation_m, velum_layer layers[METAR_MAX_CLOUDS + 1]);

/* Flags and surface properties of the cell; elevation_m must be set, layers are the caller's. */
void metar_fill_cell(const metar_report *report, velum_cell *cell);

#endif
