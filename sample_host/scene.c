#include "scene.h"

#include "report.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

bool scene_load_scenario(const struct options *options, velum_scenario **out, velum_weather_report *report) {
    velum_weather_error error = {.text = ""};
    velum_result result =
        velum_scenario_load(options->scenario, options->weather, options->weather_count, out, report, &error);
    if (result < 0) {
        fprintf(stderr, "%s\n", error.text[0] ? error.text : velum_result_name(result));
        return false;
    }
    return true;
}

/* A scenario without a duration stands: it goes on for ever. */
static bool check_time(const char *name, bool given, double time_s, const velum_scenario *scenario) {
    if (given && scenario->duration_s > 0 && time_s > scenario->duration_s) {
        report_error("%s: found %.9g, expected 0 to %.9g, the scenario's duration (s)", name, time_s,
                     scenario->duration_s);
        return false;
    }
    return true;
}

static bool commit_states(struct scene *scene) {
    const velum_scenario *scenario = scene->scenario;
    const velum_world_api *api = scene->plugin.world;
    bool done = false;
    velum_timeline_key *keys = calloc(scenario->key_count + 1, sizeof *keys);
    if (!keys) {
        report_error("out of memory");
        return false;
    }
    for (uint32_t i = 0; i < scenario->key_count; i++) {
        velum_state_desc state = {.struct_size = sizeof state};
        velum_weather_set_state(scenario->keys[i].set, &state);
        state.geoid_undulation_m = scenario->geoid_undulation_m;
        keys[i] = (velum_timeline_key){.struct_size = sizeof keys[i],
                                       .time_s = scenario->keys[i].time_s,
                                       .transition_s = scenario->keys[i].transition_s};
        velum_result result = api->commit(scene->world, &state, &keys[i].state);
        if (result < 0) {
            char what[64];
            snprintf(what, sizeof what, "weather at %g s", scenario->keys[i].time_s);
            plugin_report(&scene->plugin, what, result);
            goto error;
        }
    }
    if (scenario->key_count > 0) {
        velum_result result = api->set_timeline(scene->world, keys, scenario->key_count, sizeof *keys);
        if (result < 0) {
            plugin_report(&scene->plugin, "timeline", result);
            goto error;
        }
    }
    done = true;

error:
    free(keys);
    return done;
}

bool scene_init(struct scene *scene, const struct options *options) {
    *scene = (struct scene){.has_pose = options->has_pose, .pose = options->pose};
    if (!scene_load_scenario(options, &scene->scenario, NULL) ||
        !check_time("--at", options->has_at, options->at_s, scene->scenario) ||
        !check_time("--from", options->has_from, options->from_s, scene->scenario) ||
        !check_time("--to", options->has_to, options->to_s, scene->scenario) ||
        !plugin_load(&scene->plugin, options->plugin)) {
        return false;
    }
    const velum_world_desc desc = {
        .struct_size = sizeof desc, .seed = scene->scenario->seed, .log = plugin_log, .log_context = &scene->plugin};
    velum_result result = scene->plugin.world->create(&desc, &scene->world);
    if (result < 0) {
        plugin_report(&scene->plugin, "world", result);
        return false;
    }
    return commit_states(scene);
}

void scene_finish(struct scene *scene) {
    if (!scene) {
        return;
    }
    if (scene->world) {
        velum_result result = scene->plugin.world->destroy(scene->world);
        if (result < 0) {
            plugin_report(&scene->plugin, "world", result);
        }
        scene->world = NULL;
    }
    plugin_unload(&scene->plugin);
    velum_scenario_destroy(scene->scenario);
    scene->scenario = NULL;
}

void scene_pose(const struct scene *scene, double time_s, struct eye_pose *out) {
    if (scene->has_pose) {
        out->camera = scene->pose;
    } else {
        velum_scenario_pose(scene->scenario, time_s, &out->camera);
    }
    velum_scenario_pose_ecef(&out->camera, out->position_m, out->right, out->up, out->forward);
}

void scene_point(double lat_deg, double lon_deg, double height_m, double position_m[3]) {
    const velum_scenario_camera pose = {.lat_deg = lat_deg, .lon_deg = lon_deg, .height_m = height_m};
    double right[3], up[3], forward[3];
    velum_scenario_pose_ecef(&pose, position_m, right, up, forward);
}
