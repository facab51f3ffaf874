#include "inspect.h"

#include "files.h"
#include "json.h"
#include "png.h"
#include "progress.h"
#include "report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

static const double pi = 3.14159265358979323846;

static const char *const genus_names[] = {NULL, "Ci", "Cc", "Cs", "Ac", "As", "Ns", "Sc", "St", "Cu", "Cb"};
static const char *const precipitation_names[] = {"none", "rain", "snow", "drizzle", "hail", "sleet"};

static const char *name_of(const char *const *names, size_t count, int32_t index) {
    return index >= 0 && (size_t)index < count ? names[index] : NULL;
}

bool inspect_check(const struct options *options) {
    velum_scenario *scenario = NULL;
    velum_weather_report *report = calloc(1, sizeof *report);
    if (!report) {
        report_error("out of memory");
        return false;
    }
    if (!scene_load_scenario(options, &scenario, report)) {
        free(report);
        return false;
    }
    char start[32] = "?";
    time_t seconds = (time_t)scenario->start_unix_s;
    struct tm utc;
    if (gmtime_r(&seconds, &utc)) {
        strftime(start, sizeof start, "%Y-%m-%dT%H:%M:%SZ", &utc);
    }
    printf("%s: \"%s\", from %s, %g s\n", options->scenario, scenario->title, start, scenario->duration_s);
    printf("weather: %u keyframes; camera: %u keyframes; channels:", scenario->key_count, scenario->camera_count);
    for (uint32_t i = 0; i < scenario->channel_count; i++) {
        printf(" %s %ux%u", scenario->channels[i].name, scenario->channels[i].width, scenario->channels[i].height);
    }
    printf("\ngrid nodes: %u, from %u of %u GRIB2 messages\n", report->grid_nodes, report->grib_messages_used,
           report->grib_messages_seen);
    printf("stations: %u read, %u refused\n", report->stations_read, report->stations_refused);
    printf("regions: %u read, %u refused\n", report->regions_read, report->regions_refused);
    printf("layers: %u\n", report->layers);
    uint32_t count = report->refusal_count < 256 ? report->refusal_count : 256;
    for (uint32_t i = 0; i < count; i++) {
        printf("refused: %s\n", report->refusals[i].text);
    }
    uint32_t refused = report->stations_refused + report->regions_refused;
    if (refused > count) {
        printf("refused: %u more\n", refused - count);
    }
    velum_scenario_destroy(scenario);
    free(report);
    if (fflush(stdout) != 0) {
        report_error("cannot write to stdout");
        return false;
    }
    return true;
}

static json_t *point_object(const velum_point_answer *answer) {
    json_t *object = json_object();
    json_object_set_new(object, "lat_deg", json_number(answer->lat_deg));
    json_object_set_new(object, "lon_deg", json_number(answer->lon_deg));
    json_object_set_new(object, "height_hae_m", json_number(answer->height_hae_m));
    json_object_set_new(object, "extinction_1_m", json_number((double)answer->extinction_1_m));
    json_object_set_new(object, "water_g_m3", json_number((double)answer->water_g_m3));
    json_object_set_new(object, "coverage", json_number((double)answer->coverage));
    json_object_set_new(object, "base_m", json_number((double)answer->base_m));
    json_object_set_new(object, "top_m", json_number((double)answer->top_m));
    json_object_set_new(object, "visibility_m", json_number((double)answer->visibility_m));
    json_object_set_new(object, "wind_ecef_m_s", json_floats(answer->wind_ecef_m_s, 3));
    json_object_set_new(object, "precipitation_mm_h", json_number((double)answer->precipitation_mm_h));
    const char *kind = name_of(precipitation_names, 6, answer->precipitation);
    json_object_set_new(object, "precipitation", kind ? json_string(kind) : json_integer(answer->precipitation));
    json_object_set_new(object, "temperature_k",
                        answer->temperature_k > 0 ? json_number((double)answer->temperature_k) : json_null());
    const char *genus = name_of(genus_names, 11, answer->genus);
    json_object_set_new(object, "genus", genus ? json_string(genus) : json_null());
    return object;
}

static json_t *line_object(const velum_line_answer *answer, double length_m) {
    json_t *object = json_object();
    json_object_set_new(object, "length_m", json_number(length_m));
    json_object_set_new(object, "optical_depth", json_number(answer->optical_depth));
    json_object_set_new(object, "transmittance", json_number(answer->transmittance));
    json_object_set_new(object, "first_contact_m",
                        answer->has_contact ? json_number(answer->first_contact_m) : json_null());
    return object;
}

static bool add_line(struct scene *scene, json_t *object, const char *name, const struct eye_pose *pose,
                     const double direction[3], double length_m, double time_s) {
    velum_line_query query = {.struct_size = sizeof query, .time_s = time_s};
    velum_line_answer answer = {.struct_size = sizeof answer};
    for (int i = 0; i < 3; i++) {
        query.from_ecef_m[i] = pose->position_m[i];
        query.to_ecef_m[i] = pose->position_m[i] + length_m * direction[i];
    }
    velum_result result = scene->plugin.world->query_line(scene->world, &query, &answer);
    if (result < 0) {
        plugin_report(&scene->plugin, name, result);
        return false;
    }
    json_object_set_new(object, name, line_object(&answer, length_m));
    return true;
}

bool inspect_probe(const struct options *options) {
    static const double up_m = 30000, forward_m = 100000;
    struct scene scene;
    struct eye_pose pose;
    json_t *object = NULL;
    bool done = false;
    if (!scene_init(&scene, options)) {
        goto error;
    }
    scene_pose(&scene, options->at_s, &pose);
    velum_point_query query = {.struct_size = sizeof query, .time_s = options->at_s};
    velum_point_answer answer = {.struct_size = sizeof answer};
    memcpy(query.position_ecef_m, pose.position_m, sizeof query.position_ecef_m);
    velum_result result = scene.plugin.world->query_point(scene.world, &query, &answer);
    if (result < 0) {
        plugin_report(&scene.plugin, "probe", result);
        goto error;
    }
    double top[3], up[3];
    scene_point(pose.camera.lat_deg, pose.camera.lon_deg, pose.camera.height_m + 1000, top);
    for (int i = 0; i < 3; i++) {
        up[i] = (top[i] - pose.position_m[i]) / 1000;
    }
    object = json_object();
    json_object_set_new(object, "time_s", json_number(options->at_s));
    json_object_set_new(object, "point", point_object(&answer));
    if (!add_line(&scene, object, "up", &pose, up, up_m, options->at_s) ||
        !add_line(&scene, object, "forward", &pose, pose.forward, forward_m, options->at_s)) {
        goto error;
    }
    done = json_print(object, stdout, JSON_INDENT(2));
    object = NULL;
    if (!done) {
        report_error("cannot write to stdout");
    }

error:
    json_decref(object);
    scene_finish(&scene);
    return done;
}

enum { FIELDS = 3 };
static const char *const field_names[FIELDS] = {"coverage", "base", "top"};
static const char *const field_units[FIELDS] = {"1", "m MSL", "m MSL"};
static const double field_white[FIELDS] = {1, 20000, 20000};

/* One raster of latitude and longitude. */
struct raster {
    const char *name;
    double south_deg, north_deg, west_deg, east_deg;
    uint32_t columns, rows;
};

static struct raster raster_around(const char *name, const velum_scenario_camera *camera, double side_m) {
    const double metres_a_degree = 111320;
    double half_lat = 0.5 * side_m / metres_a_degree;
    double cosine = fmax(cos(camera->lat_deg * pi / 180), 1e-3);
    double half_lon = fmin(half_lat / cosine, 180);
    return (struct raster){.name = name,
                           .south_deg = fmax(camera->lat_deg - half_lat, -90),
                           .north_deg = fmin(camera->lat_deg + half_lat, 90),
                           .west_deg = camera->lon_deg - half_lon,
                           .east_deg = camera->lon_deg + half_lon,
                           .columns = 192,
                           .rows = 192};
}

static double wrap_longitude(double lon_deg) {
    return lon_deg - 360 * floor((lon_deg + 180) / 360);
}

static bool sample_raster(struct scene *scene, const struct raster *raster, double time_s, uint8_t *pixels[FIELDS],
                          struct progress *progress, uint64_t *done) {
    double lat_step = (raster->north_deg - raster->south_deg) / raster->rows;
    double lon_step = (raster->east_deg - raster->west_deg) / raster->columns;
    for (uint32_t y = 0; y < raster->rows; y++) {
        for (uint32_t x = 0; x < raster->columns; x++) {
            velum_point_query query = {.struct_size = sizeof query, .time_s = time_s, .footprint_m = lat_step * 111320};
            velum_point_answer answer = {.struct_size = sizeof answer};
            scene_point(raster->north_deg - (y + 0.5) * lat_step,
                        wrap_longitude(raster->west_deg + (x + 0.5) * lon_step), 0, query.position_ecef_m);
            velum_result result = scene->plugin.world->query_point(scene->world, &query, &answer);
            if (result < 0) {
                plugin_report(&scene->plugin, "tiles", result);
                return false;
            }
            const double values[FIELDS] = {(double)answer.coverage, (double)answer.base_m, (double)answer.top_m};
            for (int f = 0; f < FIELDS; f++) {
                double grey = 255 * fmin(fmax(values[f] / field_white[f], 0), 1);
                pixels[f][(size_t)y * raster->columns + x] = (uint8_t)lrint(grey);
            }
        }
        progress_update(progress, ++*done);
    }
    return true;
}

static json_t *raster_object(const struct raster *raster, const char *file, int field) {
    json_t *object = json_object();
    json_object_set_new(object, "file", json_string(file));
    json_object_set_new(object, "field", json_string(field_names[field]));
    json_object_set_new(object, "unit", json_string(field_units[field]));
    json_object_set_new(object, "black", json_number(0));
    json_object_set_new(object, "white", json_number(field_white[field]));
    json_object_set_new(object, "south_deg", json_number(raster->south_deg));
    json_object_set_new(object, "north_deg", json_number(raster->north_deg));
    json_object_set_new(object, "west_deg", json_number(raster->west_deg));
    json_object_set_new(object, "east_deg", json_number(raster->east_deg));
    json_object_set_new(object, "columns", json_integer(raster->columns));
    json_object_set_new(object, "rows", json_integer(raster->rows));
    return object;
}

static bool write_raster(const struct options *options, const struct raster *raster, uint8_t *pixels[FIELDS],
                         json_t *list) {
    for (int f = 0; f < FIELDS; f++) {
        char name[64], path[FILES_PATH_MAX];
        snprintf(name, sizeof name, "%s_%s.png", raster->name, field_names[f]);
        if (!files_join(options->out, name, path) || !png_write(path, raster->columns, raster->rows, 1, pixels[f])) {
            return false;
        }
        json_array_append_new(list, raster_object(raster, name, f));
    }
    return true;
}

static bool write_list(const struct options *options, json_t *list) {
    char path[FILES_PATH_MAX], temporary[FILES_PATH_MAX];
    if (!files_join(options->out, "tiles.json", path) || !files_temporary(path, temporary)) {
        return false;
    }
    FILE *file = fopen(temporary, "w");
    bool done = file && json_print(json_incref(list), file, JSON_INDENT(1));
    if (file && fclose(file) != 0) {
        done = false;
    }
    if (!done) {
        report_error("%s: cannot write", path);
        files_discard(temporary);
        return false;
    }
    return files_commit(temporary, path);
}

bool inspect_tiles(const struct options *options) {
    struct scene scene = {.scenario = NULL};
    struct eye_pose pose;
    struct progress progress = {.shown = false};
    uint8_t *pixels[FIELDS] = {NULL};
    struct files_folder made;
    uint64_t rows = 0;
    bool done = false;
    json_t *list = json_array();
    if (!files_prepare_folder(options->out, &made) || !scene_init(&scene, options)) {
        goto error;
    }
    scene_pose(&scene, options->at_s, &pose);
    const struct raster rasters[] = {
        raster_around("near_32km", &pose.camera, 32e3),
        raster_around("middle_256km", &pose.camera, 256e3),
        raster_around("far_2048km", &pose.camera, 2048e3),
        {"globe", -90, 90, -180, 180, 360, 180},
    };
    uint64_t total = 0;
    for (size_t i = 0; i < sizeof rasters / sizeof rasters[0]; i++) {
        total += rasters[i].rows;
    }
    for (int f = 0; f < FIELDS; f++) {
        pixels[f] = malloc(360 * 192);
        if (!pixels[f]) {
            report_error("out of memory");
            goto error;
        }
    }
    progress_start(&progress, total);
    for (size_t i = 0; i < sizeof rasters / sizeof rasters[0]; i++) {
        if (!sample_raster(&scene, &rasters[i], options->at_s, pixels, &progress, &rows) ||
            !write_raster(options, &rasters[i], pixels, list)) {
            goto error;
        }
    }
    done = write_list(options, list);

error:
    progress_finish(&progress);
    for (int f = 0; f < FIELDS; f++) {
        free(pixels[f]);
    }
    json_decref(list);
    scene_finish(&scene);
    if (!done) {
        files_remove_empty(&made);
    }
    return done;
}
