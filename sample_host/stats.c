#include "stats.h"

#include "files.h"
#include "json.h"
#include "report.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

bool stats_open(struct stats *stats, const char *path) {
    struct files_folder made;
    *stats = (struct stats){.path = path};
    if (!path) {
        return true;
    }
    if (!files_prepare_parent(path, &made)) {
        return false;
    }
    stats->file = fopen(path, "w");
    if (!stats->file) {
        report_error("%s: cannot write: %s", path, strerror(errno));
    }
    return stats->file != NULL;
}

/* A name, or the number of what this host does not know. */
static json_t *named(const char *const *names, uint32_t count, uint32_t value) {
    return value < count ? json_string(names[value]) : json_integer(value);
}

static json_t *flags_array(uint32_t flags) {
    static const char *const names[] = {"step_through", "base_search", "light_all"};
    json_t *array = json_array();
    for (uint32_t bit = 0; bit < 32; bit++) {
        if (flags & 1u << bit) {
            json_array_append_new(array, named(names, sizeof names / sizeof names[0], bit));
        }
    }
    return array;
}

json_t *stats_plan(const velum_plan *plan) {
    static const char *const integrators[] = {"energy", "before", "after", "trapezoid"};
    static const char *const scatterings[] = {"closure", "octaves", "volume"};
    static const char *const sun_depths[] = {"steps", "coarse", "fine", "map"};
    json_t *object = json_object();
    json_object_set_new(object, "flags", flags_array(plan->flags));
    json_object_set_new(object, "active_layers", json_integer(plan->active_layers));
    json_object_set_new(object, "march_steps", json_integer(plan->march_steps));
    json_object_set_new(object, "light_steps", json_integer(plan->light_steps));
    json_object_set_new(object, "ray_rate", json_integer(plan->ray_rate));
    json_object_set_new(object, "standing_ray_rate", json_integer(plan->standing_ray_rate));
    json_object_set_new(object, "finer_rays", json_integer(plan->finer_rays));
    json_object_set_new(object, "finer_blocks", json_integer(plan->finer_blocks));
    json_object_set_new(object, "every_pixel", json_integer(plan->every_pixel));
    json_object_set_new(object, "volume_cell_m", json_number((double)plan->volume_cell_m));
    json_object_set_new(object, "octaves", json_integer(plan->octaves));
    json_object_set_new(object, "blending", json_integer(plan->blending));
    json_object_set_new(object, "step_m", json_number((double)plan->step_m));
    json_object_set_new(object, "step_growth", json_number((double)plan->step_growth));
    json_object_set_new(object, "distance_m", json_number((double)plan->distance_m));
    json_object_set_new(object, "integrator", named(integrators, 4, plan->integrator));
    json_object_set_new(object, "scattering", named(scatterings, 3, plan->scattering));
    json_object_set_new(object, "sun_depth", named(sun_depths, 4, plan->sun_depth));
    json_object_set_new(object, "long_step", json_number((double)plan->long_step));
    json_object_set_new(object, "thin_density", json_number((double)plan->thin_density));
    json_object_set_new(object, "exit_transmittance", json_number((double)plan->exit_transmittance));
    return object;
}

static json_t *reasons_array(const char *text) {
    json_t *array = json_array();
    while (text && *text) {
        size_t length = strcspn(text, "\n");
        if (length > 0) {
            json_array_append_new(array, json_stringn(text, length));
        }
        text += length + (text[length] == '\n');
    }
    return array;
}

static void set_view_stats(json_t *object, const velum_view_stats *view) {
    json_object_set_new(object, "incomplete", json_boolean(view->incomplete));
    json_object_set_new(object, "revision", json_integer((json_int_t)view->revision));
    json_object_set_new(object, "rays", json_integer((json_int_t)view->rays));
    json_object_set_new(object, "samples", json_integer((json_int_t)view->samples));
    json_object_set_new(object, "light_samples", json_integer((json_int_t)view->light_samples));
    json_object_set_new(object, "march_ms", json_number((double)view->march_ms));
    json_object_set_new(object, "resolve_ms", json_number((double)view->resolve_ms));
    json_object_set_new(object, "shared_ms", json_number((double)view->shared_ms));
    json_object_set_new(object, "shadow_ms", json_number((double)view->shadow_ms));
    json_object_set_new(object, "weather_bytes", json_integer((json_int_t)view->weather_bytes));
    json_object_set_new(object, "paths_per_pixel", json_integer(view->paths_per_pixel));
    json_object_set_new(object, "relative_error", json_number((double)view->relative_error));
    json_object_set_new(object, "view_bytes", json_integer((json_int_t)view->view_bytes));
}

bool stats_write(struct stats *stats, struct renderer *renderer, uint64_t picture, uint32_t settle, double time_s,
                 double wall_ms) {
    struct plugin *plugin = &renderer->scene->plugin;
    if (!stats->file) {
        return true;
    }
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    velum_result result = plugin->engine->get_plan(renderer->eye, &plan, &reasons);
    for (uint32_t i = 0; result >= 0 && i < renderer->channel_count; i++) {
        const struct renderer_channel *channel = &renderer->channels[i];
        velum_view_stats view = {.struct_size = sizeof view};
        result = plugin->engine->get_stats(channel->view, &view);
        if (result < 0) {
            break;
        }
        json_t *object = json_object();
        json_object_set_new(object, "frame", json_integer((json_int_t)renderer->submitted));
        json_object_set_new(object, "picture", json_integer((json_int_t)picture));
        json_object_set_new(object, "settle", json_integer(settle));
        json_object_set_new(object, "time_s", json_number(time_s));
        json_object_set_new(object, "channel", json_string(channel->info.name));
        json_object_set_new(object, "width", json_integer(channel->width));
        json_object_set_new(object, "height", json_integer(channel->height));
        json_object_set_new(object, "wall_ms", json_number(wall_ms));
        set_view_stats(object, &view);
        json_object_set_new(object, "plan", stats_plan(&plan));
        json_object_set_new(object, "reasons", reasons_array(reasons));
        if (!json_print(object, stats->file, JSON_COMPACT)) {
            report_error("%s: cannot write: %s", stats->path, strerror(errno));
            return false;
        }
    }
    if (result < 0) {
        plugin_report(plugin, "statistics", result);
    }
    return result >= 0;
}

bool stats_close(struct stats *stats) {
    FILE *file = stats->file;
    struct stat status;
    stats->file = NULL;
    if (file && fclose(file) != 0) {
        report_error("%s: cannot write: %s", stats->path, strerror(errno));
        return false;
    }
    if (file && stat(stats->path, &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0) {
        unlink(stats->path);
    }
    return true;
}
