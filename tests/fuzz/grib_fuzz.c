#include <stdlib.h>
#include <velum_weather/weather.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_report *report = calloc(1, sizeof(*report));
    velum_weather_error error = {0};
    if (set && report) {
        const velum_result result = velum_weather_read_grib_memory(set, "fuzz.grib2", data, size, report, &error);
        if ((result != VELUM_OK) != (error.text[0] != '\0')) {
            abort();
        }
    }
    free(report);
    velum_weather_set_destroy(set);
    return 0;
}
