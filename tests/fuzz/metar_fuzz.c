#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <velum_weather/weather.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A small table, so that a report without a position does not read the system's one for each input. */
static char table_path[] = "/tmp/velum-metar-fuzz-XXXXXX";

static void remove_table(void) {
    unlink(table_path);
}

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    static const char table[] = "[eddf]\nlocation = (0.8735373, 0.1500983)\n";
    (void)argc;
    (void)argv;
    const int file = mkstemp(table_path);
    if (file < 0 || write(file, table, sizeof(table) - 1) < 0) {
        abort();
    }
    close(file);
    atexit(remove_table);
    return 0;
}

static void check(const velum_weather_set *set) {
    velum_state_desc state;
    velum_weather_set_state(set, &state);
    for (uint32_t i = 0; i < state.cell_count; ++i) {
        const velum_cell *cell = &state.cells[i];
        for (uint32_t j = 0; j < cell->layer_count; ++j) {
            const velum_layer *layer = &cell->layers[j];
            if (!(layer->coverage > 0.0f && layer->coverage <= 1.0f) || !(layer->top_m > layer->base_m) ||
                !(layer->top_m <= 25000.0f) || !(layer->base_m >= -500.0f) || !isfinite(layer->water_g_m3)) {
                abort();
            }
        }
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_report *report = calloc(1, sizeof(*report));
    velum_weather_error error = {0};
    const velum_weather_station_options options = {.table_path = table_path};
    if (set && report) {
        const velum_result result =
            velum_weather_read_metar_memory(set, "fuzz.csv", (const char *)data, size, &options, report, &error);
        if ((result != VELUM_OK) != (error.text[0] != '\0')) {
            abort();
        }
        check(set);
    }
    free(report);
    velum_weather_set_destroy(set);
    return 0;
}
