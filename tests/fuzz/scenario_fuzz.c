#include <math.h>
#include <stdlib.h>
#include <velum_weather/weather.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Whatever is accepted can be flown. */
static void fly(const velum_scenario *scenario) {
    double position[3], right[3], up[3], forward[3], sun[3];
    if (scenario->key_count == 0 || scenario->camera_count == 0 || scenario->channel_count == 0) {
        abort();
    }
    for (uint32_t i = 1; i < scenario->key_count; i++) {
        const velum_scenario_key *key = &scenario->keys[i];
        if (!(key->time_s > key[-1].time_s) || !(key->transition_s <= key->time_s - key[-1].time_s)) {
            abort();
        }
    }
    for (int i = 0; i <= 8; i++) {
        velum_scenario_camera pose;
        double first = scenario->cameras[0].time_s, last = scenario->cameras[scenario->camera_count - 1].time_s;
        velum_scenario_pose(scenario, first + (last - first) * i / 8, &pose);
        velum_scenario_pose_ecef(&pose, position, right, up, forward);
        if (!(fabs(pose.lat_deg) <= 90) || !isfinite(position[0] + position[1] + position[2]) ||
            !(fabs(forward[0] * forward[0] + forward[1] * forward[1] + forward[2] * forward[2] - 1) < 1e-9)) {
            abort();
        }
    }
    velum_scenario_channel_axes(scenario->channels, right, up, forward, right, up, forward);
    velum_scenario_sun(scenario, 0, sun);
    if (!(fabs(sun[0] * sun[0] + sun[1] * sun[1] + sun[2] * sun[2] - 1) < 1e-9)) {
        abort();
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    velum_scenario *scenario = NULL;
    velum_weather_report *report = calloc(1, sizeof *report);
    velum_weather_error error = {0};
    if (report) {
        velum_result result = velum_scenario_load_memory("fuzz.json", "/nonexistent", (const char *)data, size,
                                                         &scenario, report, &error);
        if ((result != VELUM_OK) != (error.text[0] != '\0') || (result == VELUM_OK) != (scenario != NULL)) {
            abort();
        }
        if (scenario) {
            fly(scenario);
        }
    }
    velum_scenario_destroy(scenario);
    free(report);
    return 0;
}
