#include "scenario.h"

#include "error.h"
#include "json.h"
#include "scenario_weather.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_CAMERAS = 1000000, MAX_CHANNELS = 64, MAX_EXTRAS = 1024 };
static const double MOST_TIME_S = 1e9;

/* ------------------------------------------------------------------ time */

static int digits(const char **text, int count, int least, int most, int *out) {
    *out = 0;
    for (int i = 0; i < count; i++, ++*text) {
        if (**text < '0' || **text > '9') {
            return 0;
        }
        *out = *out * 10 + (**text - '0');
    }
    return *out >= least && *out <= most;
}

static int character(const char **text, char expected) {
    return *(*text)++ == expected;
}

/* Days since 1970-01-01 of the Gregorian calendar (Hinnant 2013, "chrono-compatible low-level date algorithms"). */
static int days_of(int year, int month, int day) {
    int y = month <= 2 ? year - 1 : year;
    int era = y / 400, of_era = y - era * 400;
    int of_year = (153 * (month + (month > 2 ? -3 : 9)) + 2) / 5 + day - 1;
    return era * 146097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719468;
}

int scenario_parse_utc(const char *text, double *unix_s) {
    static const int month_days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int year, month, day, hour, minute, second = 0;
    double fraction = 0;
    if (!digits(&text, 4, 1900, 2199, &year) || !character(&text, '-') || !digits(&text, 2, 1, 12, &month) ||
        !character(&text, '-') || !digits(&text, 2, 1, 31, &day) || !character(&text, 'T') ||
        !digits(&text, 2, 0, 23, &hour) || !character(&text, ':') || !digits(&text, 2, 0, 59, &minute)) {
        return 0;
    }
    int leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    if (day > month_days[month - 1] + (month == 2 && leap)) {
        return 0;
    }
    if (*text == ':') {
        text++;
        if (!digits(&text, 2, 0, 59, &second)) {
            return 0;
        }
        if (*text == '.') {
            double weight = 0.1;
            if (*++text < '0' || *text > '9') {
                return 0;
            }
            for (; *text >= '0' && *text <= '9'; text++, weight /= 10) {
                fraction += weight * (*text - '0');
            }
        }
    }
    if (strcmp(text, "Z") != 0) {
        return 0;
    }
    *unix_s = days_of(year, month, day) * 86400.0 + hour * 3600.0 + minute * 60.0 + second + fraction;
    return 1;
}

/* ------------------------------------------------------------------ fields */

static velum_result read_start(const json_document *document, velum_scenario *scenario) {
    const json_node *root = json_document_root(document);
    const char *start = NULL;
    TRY(json_read_string(document, root, "start", JSON_OPTIONAL, 0, 64, &start));
    if (start && !scenario_parse_utc(start, &scenario->start_unix_s)) {
        return json_refuse(document, json_member(document, root, "start"),
                           "a time in UTC, 1900 to 2199, like \"2014-12-18T08:00:00Z\"");
    }
    if (!start && scenario->sun == VELUM_SCENARIO_SUN_COMPUTED) {
        return json_refuse_missing(document, root, "start",
                                   "a time like \"2014-12-18T08:00:00Z\" where \"sun\" gives no angles");
    }
    return VELUM_OK;
}

static velum_result read_sun(const json_document *document, velum_scenario *scenario) {
    static const char *const keys[] = {"azimuth_deg", "elevation_deg", "illuminance_lx", NULL};
    const json_node *sun = json_member(document, json_document_root(document), "sun");
    for (int i = 0; i < 3; i++) {
        scenario->sun_illuminance_lx[i] = 128000;
    }
    if (!sun) {
        return VELUM_OK;
    }
    TRY(json_expect_keys(document, sun, keys));
    int angles = json_member(document, sun, "azimuth_deg") || json_member(document, sun, "elevation_deg");
    TRY(json_read_double(document, sun, "azimuth_deg", angles, -360, 360, &scenario->sun_azimuth_deg));
    TRY(json_read_double(document, sun, "elevation_deg", angles, -90, 90, &scenario->sun_elevation_deg));
    scenario->sun = angles ? VELUM_SCENARIO_SUN_FIXED : VELUM_SCENARIO_SUN_COMPUTED;
    return json_read_floats(document, sun, "illuminance_lx", JSON_OPTIONAL, 3, 0, 1e9, scenario->sun_illuminance_lx);
}

static velum_result read_surroundings(const json_document *document, velum_scenario *scenario) {
    static const json_word atmospheres[] = {{"earth", 0}, {"none", 1}};
    static const char *const ground_keys[] = {"albedo", NULL};
    const json_node *root = json_document_root(document);
    int32_t none = 0;
    TRY(json_read_word(document, root, "atmosphere", JSON_OPTIONAL, atmospheres, 2, &none));
    scenario->atmosphere_none = (uint32_t)none;
    for (int i = 0; i < 3; i++) {
        scenario->ground_albedo[i] = 0.1f;
    }
    const json_node *ground = json_member(document, root, "ground");
    if (ground) {
        TRY(json_expect_keys(document, ground, ground_keys));
        TRY(json_read_floats(document, ground, "albedo", JSON_OPTIONAL, 3, 0, 1, scenario->ground_albedo));
    }
    return json_read_float(document, root, "geoid_undulation_m", JSON_OPTIONAL, -200, 200,
                           &scenario->geoid_undulation_m);
}

static velum_result read_camera(const json_document *document, const json_node *node,
                                const velum_scenario_camera *before, velum_scenario_camera *camera) {
    static const char *const keys[] = {"time_s",      "lat_deg",   "lon_deg",  "height_m",
                                       "heading_deg", "pitch_deg", "roll_deg", NULL};
    TRY(json_expect_keys(document, node, keys));
    TRY(json_read_double(document, node, "time_s", before != NULL, -MOST_TIME_S, MOST_TIME_S, &camera->time_s));
    if (before && !(camera->time_s > before->time_s)) {
        return json_refuse(document, json_member(document, node, "time_s"),
                           "more than %.9g, the time of the keyframe before", before->time_s);
    }
    TRY(json_read_double(document, node, "lat_deg", JSON_REQUIRED, -90, 90, &camera->lat_deg));
    TRY(json_read_double(document, node, "lon_deg", JSON_REQUIRED, -180, 180, &camera->lon_deg));
    TRY(json_read_double(document, node, "height_m", JSON_REQUIRED, -1e4, 5e7, &camera->height_m));
    TRY(json_read_double(document, node, "heading_deg", JSON_OPTIONAL, -360, 360, &camera->heading_deg));
    TRY(json_read_double(document, node, "pitch_deg", JSON_OPTIONAL, -90, 90, &camera->pitch_deg));
    return json_read_double(document, node, "roll_deg", JSON_OPTIONAL, -180, 180, &camera->roll_deg);
}

static velum_result read_cameras(const json_document *document, velum_scenario *scenario) {
    const json_node *root = json_document_root(document);
    const json_node *array = json_member(document, root, "camera");
    if (!array) {
        return json_refuse_missing(document, root, "camera", "an array of at least 1");
    }
    TRY(json_expect_array(document, array, 1, MAX_CAMERAS));
    scenario->cameras = calloc(array->count, sizeof *scenario->cameras);
    if (!scenario->cameras) {
        return weather_out_of_memory(document->error, document->name);
    }
    for (const json_node *node = json_first(document, array); node; node = json_next(document, node)) {
        velum_scenario_camera *camera = &scenario->cameras[scenario->camera_count];
        TRY(read_camera(document, node, scenario->camera_count++ ? camera - 1 : NULL, camera));
    }
    return VELUM_OK;
}

/* Names become parts of file names. */
static int is_name(const char *name) {
    return *name && strlen(name) < sizeof((velum_scenario_channel *)0)->name &&
           strspn(name, "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-") == strlen(name);
}

static velum_result read_size(const json_document *document, const json_node *node, velum_scenario_channel *channel) {
    const json_node *size = json_member(document, node, "size");
    if (!size) {
        return VELUM_OK;
    }
    TRY(json_expect_array(document, size, 2, 2));
    uint32_t *out[] = {&channel->width, &channel->height};
    const json_node *element = json_first(document, size);
    for (int i = 0; i < 2; i++, element = json_next(document, element)) {
        int64_t value = 0;
        TRY(json_whole_number(document, element, 1, 8192, &value));
        *out[i] = (uint32_t)value;
    }
    return VELUM_OK;
}

static velum_result read_channel(const json_document *document, const json_node *node, velum_scenario *scenario,
                                 velum_scenario_channel *channel) {
    static const char *const keys[] = {"name", "yaw_deg", "pitch_deg", "roll_deg", "hfov_deg", "size", NULL};
    const char *name = NULL;
    TRY(json_expect_keys(document, node, keys));
    TRY(json_read_string(document, node, "name", JSON_REQUIRED, 1, sizeof channel->name - 1, &name));
    if (!is_name(name)) {
        return json_refuse(document, json_member(document, node, "name"), "letters, digits, _ and -");
    }
    for (const velum_scenario_channel *other = scenario->channels; other < channel; other++) {
        if (strcmp(other->name, name) == 0) {
            return json_refuse(document, json_member(document, node, "name"), "a name that no other channel has");
        }
    }
    snprintf(channel->name, sizeof channel->name, "%s", name);
    TRY(json_read_double(document, node, "yaw_deg", JSON_OPTIONAL, -360, 360, &channel->yaw_deg));
    TRY(json_read_double(document, node, "pitch_deg", JSON_OPTIONAL, -90, 90, &channel->pitch_deg));
    TRY(json_read_double(document, node, "roll_deg", JSON_OPTIONAL, -180, 180, &channel->roll_deg));
    TRY(json_read_double(document, node, "hfov_deg", JSON_OPTIONAL, 0.01, 170, &channel->hfov_deg));
    return read_size(document, node, channel);
}

static velum_result read_channels(const json_document *document, velum_scenario *scenario) {
    static const velum_scenario_channel default_channel = {
        .name = "main", .hfov_deg = 60, .width = 1280, .height = 720};
    const json_node *array = json_member(document, json_document_root(document), "channels");
    if (array) {
        TRY(json_expect_array(document, array, 1, MAX_CHANNELS));
    }
    scenario->channels = calloc(array ? array->count : 1, sizeof *scenario->channels);
    if (!scenario->channels) {
        return weather_out_of_memory(document->error, document->name);
    }
    if (!array) {
        scenario->channels[scenario->channel_count++] = default_channel;
    }
    for (const json_node *node = json_first(document, array); node; node = json_next(document, node)) {
        velum_scenario_channel *channel = &scenario->channels[scenario->channel_count++];
        *channel = default_channel;
        TRY(read_channel(document, node, scenario, channel));
    }
    return VELUM_OK;
}

static velum_result read_scenario(const json_document *document, velum_scenario *scenario) {
    static const char *const keys[] = {
        "velum",  "title",   "start",  "duration_s",         "seed",     "sun", "atmosphere",
        "ground", "weather", "camera", "geoid_undulation_m", "channels", NULL};
    const json_node *root = json_document_root(document);
    int64_t version = 0, seed = 0;
    const char *title = "";
    TRY(json_expect_object(document, root));
    TRY(json_read_integer(document, root, "velum", JSON_REQUIRED, 1, 1, &version));
    TRY(json_expect_keys(document, root, keys));
    TRY(json_read_string(document, root, "title", JSON_OPTIONAL, 0, sizeof scenario->title - 1, &title));
    snprintf(scenario->title, sizeof scenario->title, "%s", title);
    TRY(json_read_double(document, root, "duration_s", JSON_OPTIONAL, 0, MOST_TIME_S, &scenario->duration_s));
    TRY(json_read_integer(document, root, "seed", JSON_OPTIONAL, 0, INT64_MAX, &seed));
    scenario->seed = (uint64_t)seed;
    TRY(read_sun(document, scenario));
    TRY(read_start(document, scenario));
    TRY(read_surroundings(document, scenario));
    TRY(read_cameras(document, scenario));
    return read_channels(document, scenario);
}

/* ------------------------------------------------------------------ whole scenarios */

static velum_result load(const char *name, const char *directory, const char *text, uint64_t size,
                         const scenario_extra *extras, uint32_t extra_count, velum_scenario **out,
                         velum_weather_report *report, velum_weather_error *error) {
    json_document document = {0};
    velum_scenario *scenario = calloc(1, sizeof *scenario);
    velum_result result =
        scenario ? json_document_init(&document, name, text, size, error) : weather_out_of_memory(error, name);
    if (result < 0) {
        goto error;
    }
    result = read_scenario(&document, scenario);
    if (result < 0) {
        goto error;
    }
    result = scenario_read_weather(&document, directory, extras, extra_count, scenario, report);
    if (result < 0) {
        goto error;
    }
    *out = scenario;
    scenario = NULL;
error:
    json_document_finish(&document);
    velum_scenario_destroy(scenario);
    return result < 0 ? result : VELUM_OK;
}

velum_result velum_scenario_load_memory(const char *name, const char *directory, const char *text, uint64_t size,
                                        velum_scenario **out, velum_weather_report *report,
                                        velum_weather_error *error) {
    if (!out || (!text && size)) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, name, 0, 0, "%s: found null", out ? "text" : "out");
    }
    *out = NULL;
    return load(name ? name : "", directory ? directory : "", text ? text : "", size, NULL, 0, out, report, error);
}

static velum_result read_extras(const char *const *paths, uint32_t count, scenario_extra *extras,
                                velum_weather_error *error) {
    for (uint32_t i = 0; i < count; i++) {
        extras[i].path = paths[i];
        TRY(weather_read_file(paths[i], &extras[i].bytes, &extras[i].size, error));
        extras[i].kind = scenario_extra_kind(extras[i].bytes, extras[i].size);
    }
    return VELUM_OK;
}

velum_result velum_scenario_load(const char *path, const char *const *extra, uint32_t extra_count, velum_scenario **out,
                                 velum_weather_report *report, velum_weather_error *error) {
    if (!out || !path || (!extra && extra_count) || extra_count > MAX_EXTRAS) {
        return weather_fail(error, VELUM_ERROR_ARGUMENT, path, 0, 0, "%s",
                            !out    ? "out: found null"
                            : !path ? "path: found null"
                            : extra ? "extra_count: found too many further sources, expected at most 1024"
                                    : "extra: found null");
    }
    *out = NULL;
    char *text = NULL, *directory = NULL;
    size_t size = 0;
    scenario_extra *extras = calloc(extra_count + 1u, sizeof *extras);
    velum_result result = extras ? weather_read_file(path, &text, &size, error) : weather_out_of_memory(error, path);
    if (result < 0) {
        goto error;
    }
    const char *slash = strrchr(path, '/');
    directory = strndup(path, slash ? (size_t)(slash - path) + 1 : 0);
    if (!directory) {
        result = weather_out_of_memory(error, path);
        goto error;
    }
    result = read_extras(extra, extra_count, extras, error);
    if (result < 0) {
        goto error;
    }
    result = load(path, directory, text, size, extras, extra_count, out, report, error);
error:
    for (uint32_t i = 0; extras && i < extra_count; i++) {
        free(extras[i].bytes);
    }
    free(extras);
    free(directory);
    free(text);
    return result;
}

void velum_scenario_destroy(velum_scenario *scenario) {
    if (scenario) {
        for (uint32_t i = 0; i < scenario->key_count; i++) {
            velum_weather_set_destroy(scenario->keys[i].set);
        }
        free(scenario->keys);
        free(scenario->cameras);
        free(scenario->channels);
        free(scenario);
    }
}
