/* A scenario, and the plugin's world that holds its weather. */
#ifndef HOST_SCENE_H
#define HOST_SCENE_H

#include "options.h"
#include "plugin.h"

#include <stdbool.h>
#include <velum_weather/weather.h>

struct scene {
    velum_scenario *scenario;
    struct plugin plugin;
    velum_world *world;
    bool has_pose; /* of the command line: stands for the scenario's camera */
    velum_scenario_camera pose;
};

/* Where the eye is, and its axes in ECEF. */
struct eye_pose {
    velum_scenario_camera camera;
    double position_m[3];
    double right[3], up[3], forward[3];
};

/* Reads the scenario only. `report` may be null. Failures are reported. */
bool scene_load_scenario(const struct options *options, velum_scenario **out, velum_weather_report *report);

/* Scenario, plugin, world, states, timeline. Failures are reported; finish is legal after them. */
bool scene_init(struct scene *scene, const struct options *options);
void scene_finish(struct scene *scene);

void scene_pose(const struct scene *scene, double time_s, struct eye_pose *out);

/* A point over latitude and longitude, ECEF. */
void scene_point(double lat_deg, double lon_deg, double height_m, double position_m[3]);

#endif
