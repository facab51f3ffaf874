#include <math.h>
#include <stdlib.h>
#include <velum_weather/weather.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void check(const velum_weather_set *set) {
    velum_state_desc state;
    velum_weather_set_state(set, &state);
    for (uint32_t i = 0; i < state.cell_count; i++) {
        const velum_cell *cell = &state.cells[i];
        uint64_t points = 0;
        for (uint32_t r = 0; r < cell->ring_count; r++) {
            points += cell->ring_sizes[r];
        }
        if (cell->kind != VELUM_CELL_POLYGON || points != cell->point_count || points < 3) {
            abort();
        }
        for (uint32_t p = 0; p < cell->point_count; p++) {
            if (!(fabs(cell->points[p].lat_deg) <= 90) || !(fabs(cell->points[p].lon_deg) <= 180)) {
                abort();
            }
        }
        for (uint32_t l = 0; l < cell->layer_count; l++) {
            const velum_layer *layer = &cell->layers[l];
            if (!(layer->coverage >= 0 && layer->coverage <= 1) || !(layer->top_m > layer->base_m) ||
                !isfinite(layer->wind_east_m_s)) {
                abort();
            }
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_report *report = calloc(1, sizeof *report);
    velum_weather_error error = {0};
    if (set && report) {
        velum_result result =
            velum_weather_read_geojson_memory(set, "fuzz.geojson", (const char *)data, size, report, &error);
        velum_state_desc state;
        velum_weather_set_state(set, &state);
        if ((result != VELUM_OK) != (error.text[0] != '\0') || (result == VELUM_OK) != (state.cell_count > 0) ||
            (result == VELUM_OK && state.cell_count != report->regions_read)) {
            abort();
        }
        check(set);
    }
    free(report);
    velum_weather_set_destroy(set);
    return 0;
}
