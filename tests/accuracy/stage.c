#include "stage.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "../abi/keep_drivers.h"
#include "../bench/commit.h"

#define DEG (3.14159265358979323846 / 180.0)

double stage_now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

void stage_fail(const stage *s, const char *what, velum_result result) {
    fprintf(stderr, REPORT_PROGRAM ": %s: %s: %s: %s\n", what, velum_result_name(result), s->host.log.object,
            s->host.log.message);
}

/* G. Fowler, L. C. Noll, K.-P. Vo 1991. */
uint64_t stage_hash(uint64_t hash, const void *data, size_t size) {
    const unsigned char *bytes = data;
    hash ^= 14695981039346656037u;
    for (size_t i = 0; i < size; i++) {
        hash = (hash ^ bytes[i]) * 1099511628211u;
    }
    return hash;
}

char *stage_read_file(const char *path, size_t *out_size) {
    FILE *file = fopen(path, "rb");
    char *text = NULL;
    long size = -1;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        size = ftell(file);
        rewind(file);
    }
    if (size >= 0 && size < (1l << 30)) {
        text = malloc((size_t)size + 1);
    }
    if (!text || fread(text, 1, (size_t)size, file) != (size_t)size) {
        fprintf(stderr, REPORT_PROGRAM ": %s: cannot read: %s\n", path, strerror(errno));
        free(text);
        text = NULL;
    } else {
        text[size] = '\0';
        *out_size = (size_t)size;
    }
    if (file) {
        fclose(file);
    }
    return text;
}

static void stage_log(void *context, int32_t severity, const char *object, const char *message) {
    stage *s = context;
    const char *end = message ? strchr(message, ';') : NULL;
    if (severity == VELUM_LOG_INFO && end && strncmp(message, "on ", 3) == 0) {
        snprintf(s->device_name, sizeof s->device_name, "%.*s", (int)(end - message - 3), message + 3);
    }
    test_log_write(&s->host.log, severity, object, message);
}

static void find_plugin(void) {
    char path[1024];
    ssize_t length = readlink("/proc/self/exe", path, sizeof path - 64);
    if (getenv("VELUM_PLUGIN") || length <= 0) {
        return;
    }
    path[length] = '\0';
    char *slash = strrchr(path, '/');
    if (slash) {
        strcpy(slash, "/../../plugin/libvelum.so");
        setenv("VELUM_PLUGIN", path, 0);
    }
}

/* As the plugin's file says it (plugin/revision.c), else of all of that file. */
static bool find_revision(stage *s) {
    static const char mark[] = "velum reference revision ";
    size_t size = 0;
    char *bytes = stage_read_file(getenv("VELUM_PLUGIN"), &size);
    const char *found = bytes ? memmem(bytes, size, mark, sizeof mark - 1) : NULL;
    if (found && (size_t)(bytes + size - found) > sizeof mark - 1 + 16) {
        s->revision = strtoull(found + sizeof mark - 1, NULL, 16);
    } else if (bytes) {
        s->revision = stage_hash(0, bytes, size);
    }
    free(bytes);
    return bytes != NULL;
}

bool stage_init(stage *s, int32_t device) {
    *s = (stage){.device = device, .scenes = ACCURACY_SCENES, .shared = getenv("VELUM_SHARED")};
    if (!s->shared) {
        s->shared = ACCURACY_SHARED;
    }
    find_plugin();
    if (!test_host_open(&s->host)) {
        return false;
    }
    if (!find_revision(s)) {
        stage_finish(s);
        return false;
    }
    return true;
}

static void drop_shadow(stage *s) {
    if (s->shadow) {
        s->host.engine->destroy_shadow(s->shadow);
    }
    s->shadow = NULL;
}

static void leave_world(stage *s) {
    drop_shadow(s);
    if (s->engine) {
        velum_result result = s->host.engine->destroy(s->engine);
        if (result < 0) {
            stage_fail(s, "destroy engine", result);
        }
    }
    if (s->world) {
        s->host.world->destroy(s->world);
    }
    s->engine = NULL;
    s->world = NULL;
}

void stage_finish(stage *s) {
    if (s->host.library) {
        leave_world(s);
    }
    velum_scenario_destroy(s->scenario);
    s->scenario = NULL;
    test_host_close(&s->host);
}

static bool make_engine(stage *s) {
    const velum_standalone_desc desc = {
        .struct_size = sizeof desc, .world = s->world, .log = stage_log, .log_context = s, .device = s->device};
    velum_result result = s->host.standalone->create_engine(&desc, &s->engine);
    keep_drivers();
    if (result < 0) {
        stage_fail(s, "create engine", result);
    }
    return result >= 0;
}

/* A world and its engine serve all scenes of one seed. */
static bool enter_world(stage *s, uint64_t seed) {
    if (s->world && s->seed == seed) {
        return true;
    }
    leave_world(s);
    s->seed = seed;
    const velum_world_desc desc = {.struct_size = sizeof desc, .seed = seed, .log = stage_log, .log_context = s};
    velum_result result = s->host.world->create(&desc, &s->world);
    if (result < 0) {
        stage_fail(s, "create world", result);
        return false;
    }
    return make_engine(s);
}

static bool take_scenario(stage *s, velum_scenario *scenario, float wind_east_m_s) {
    drop_shadow(s);
    velum_scenario_destroy(s->scenario);
    s->scenario = scenario;
    if (!enter_world(s, scenario->seed)) {
        return false;
    }
    velum_result result = commit_scenario(s->host.world, s->world, scenario, wind_east_m_s);
    if (result < 0) {
        stage_fail(s, "commit", result);
        return false;
    }
    velum_scenario_sun(scenario, 0.0, s->sun);
    s->atmosphere = scenario->atmosphere_none ? VELUM_ATMOSPHERE_NONE : VELUM_ATMOSPHERE_EARTH;
    memcpy(s->ground_albedo, scenario->ground_albedo, sizeof s->ground_albedo);
    memcpy(s->sun_lx, scenario->sun_illuminance_lx, sizeof s->sun_lx);
    return true;
}

int stage_load(stage *s, const scene_row *scene, float wind_east_m_s) {
    static const char *const real[2] = {"data/gfs.t12z.pgrbf120.2p5deg.grib2", "data/metars-20141218.csv"};
    char path[1024], sources[2][1024];
    const char *extra[2] = {sources[0], sources[1]};
    snprintf(path, sizeof path, "%s/%s.json", s->scenes, scene->name);
    s->scenario_hash = 0;
    for (int i = -1; i < (scene->real ? 2 : 0); i++) {
        if (i >= 0) {
            snprintf(sources[i], sizeof sources[i], "%s/%s", s->shared, real[i]);
            if (access(sources[i], R_OK) != 0) {
                fprintf(stderr, "%s: skipped: no %s (VELUM_SHARED names the folder)\n", scene->name, sources[i]);
                return STAGE_SKIPPED;
            }
        }
        size_t size = 0;
        char *bytes = stage_read_file(i < 0 ? path : sources[i], &size);
        if (!bytes) {
            return STAGE_FAILED;
        }
        s->scenario_hash = stage_hash(s->scenario_hash, bytes, size);
        free(bytes);
    }
    velum_scenario *scenario = NULL;
    static velum_weather_report report;
    velum_weather_error error = {.text = ""};
    velum_result result = velum_scenario_load(path, extra, scene->real ? 2 : 0, &scenario, &report, &error);
    if (result < 0) {
        fprintf(stderr, REPORT_PROGRAM ": %s\n", error.text);
        return STAGE_FAILED;
    }
    return take_scenario(s, scenario, wind_east_m_s) ? STAGE_OK : STAGE_FAILED;
}

int stage_load_text(stage *s, const char *text, float wind_east_m_s) {
    velum_scenario *scenario = NULL;
    velum_weather_error error = {.text = ""};
    s->scenario_hash = stage_hash(0, text, strlen(text));
    velum_result result = velum_scenario_load_memory("case", ".", text, strlen(text), &scenario, NULL, &error);
    if (result < 0) {
        fprintf(stderr, REPORT_PROGRAM ": %s\n", error.text);
        return STAGE_FAILED;
    }
    return take_scenario(s, scenario, wind_east_m_s) ? STAGE_OK : STAGE_FAILED;
}

void stage_camera_init(const stage *s, uint32_t width, uint32_t height, stage_camera *out) {
    double right[3], up[3], forward[3];
    velum_scenario_camera pose;
    velum_scenario_pose(s->scenario, 0.0, &pose);
    velum_scenario_pose_ecef(&pose, out->position_m, right, up, forward);
    velum_scenario_channel_axes(&s->scenario->channels[0], right, up, forward, out->right, out->up, out->forward);
    out->tan_x = tan(0.5 * s->scenario->channels[0].hfov_deg * DEG);
    out->tan_y = out->tan_x * height / width;
}

void stage_camera_place(stage_camera *c, double lat_deg, double lon_deg, double height_m, double heading_deg,
                        double pitch_deg, double roll_deg) {
    const velum_scenario_camera pose = {.lat_deg = lat_deg,
                                        .lon_deg = lon_deg,
                                        .height_m = height_m,
                                        .heading_deg = heading_deg,
                                        .pitch_deg = pitch_deg,
                                        .roll_deg = roll_deg};
    velum_scenario_pose_ecef(&pose, c->position_m, c->right, c->up, c->forward);
}

bool stage_prepare(stage *s, const stage_camera *c, uint32_t width, double time_s) {
    velum_prepare_eye eye = {.struct_size = sizeof eye,
                             .time_s = time_s,
                             .pixel_rad = fmax(2.0 * c->tan_x / width / (1.0 + c->tan_x * c->tan_x), 1e-6)};
    memcpy(eye.position_ecef_m, c->position_m, sizeof eye.position_ecef_m);
    const velum_prepare_info info = {.struct_size = sizeof info, .eyes = &eye, .eye_count = 1};
    velum_result result = s->host.world->prepare(s->world, &info);
    if (result < 0) {
        stage_fail(s, "prepare", result);
    }
    return result >= 0;
}

velum_result stage_view_init(stage *s, stage_view *v, int32_t quality, uint32_t width, uint32_t height) {
    *v = (stage_view){.width = width, .height = height};
    const velum_eye_desc eye = {.struct_size = sizeof eye,
                                .flags = quality == VELUM_QUALITY_REFERENCE ? 0 : VELUM_EYE_STUDY,
                                .quality = quality};
    velum_result result = s->host.engine->create_eye(s->engine, &eye, &v->eye);
    if (result >= 0) {
        const velum_view_desc view = {.struct_size = sizeof view, .width = width, .height = height, .name = "accuracy"};
        result = s->host.engine->create_view(v->eye, &view, &v->view);
    }
    if (result < 0) {
        stage_view_finish(v, s);
    }
    return result;
}

void stage_view_finish(stage_view *v, stage *s) {
    if (v->view) {
        s->host.engine->destroy_view(v->view);
    }
    if (v->eye) {
        s->host.engine->destroy_eye(v->eye);
    }
    *v = (stage_view){0};
}

static velum_frame_info frame_info(const stage *s, double time_s) {
    velum_frame_info frame = {.struct_size = sizeof frame, .time_s = time_s, .atmosphere = s->atmosphere};
    memcpy(frame.sun_direction_ecef, s->sun, sizeof frame.sun_direction_ecef);
    memcpy(frame.sun_illuminance_lx, s->sun_lx, sizeof frame.sun_illuminance_lx);
    memcpy(frame.ground_albedo, s->ground_albedo, sizeof frame.ground_albedo);
    return frame;
}

/* One for each scene: a map follows a world that changes only by and by. */
bool stage_cast_shadow(stage *s, const stage_camera *c) {
    const velum_shadow_desc desc = {.struct_size = sizeof desc, .levels = 4, .texels = 256, .extent_m = 8192.0f};
    const uint64_t count = 4u * 256u * 256u;
    const velum_frame_info frame = frame_info(s, 0.0);
    velum_shadow_frame where = {.struct_size = sizeof where};
    memcpy(where.centre_ecef_m, c->position_m, sizeof where.centre_ecef_m);
    drop_shadow(s);
    float *map = calloc(count, sizeof *map);
    velum_result result = map ? s->host.engine->create_shadow(s->engine, &desc, &s->shadow) : VELUM_ERROR_OUT_OF_MEMORY;
    if (result >= 0) {
        result = s->host.standalone->render_shadow(s->engine, &frame, s->shadow, &where, map, count);
    }
    free(map);
    if (result < 0) {
        stage_fail(s, "shadow map", result);
    }
    return result >= 0;
}

bool stage_check_shadow(stage *s, const stage_camera *c, double time_s, uint32_t *out_wrong) {
    const velum_shadow_desc desc = {.struct_size = sizeof desc, .levels = 2, .texels = 64, .extent_m = 8192.0f};
    enum { COUNT = 2 * 64 * 64 };
    const velum_frame_info frame = frame_info(s, time_s);
    velum_shadow_frame where = {.struct_size = sizeof where};
    memcpy(where.centre_ecef_m, c->position_m, sizeof where.centre_ecef_m);
    velum_shadow *shadow = NULL;
    float *map = malloc(COUNT * sizeof *map);
    velum_result result = map ? s->host.engine->create_shadow(s->engine, &desc, &shadow) : VELUM_ERROR_OUT_OF_MEMORY;
    if (result >= 0) {
        result = s->host.standalone->render_shadow(s->engine, &frame, shadow, &where, map, COUNT);
    }
    *out_wrong = 0;
    for (int i = 0; i < COUNT && result >= 0; i++) {
        *out_wrong += map[i] >= 0.0f && map[i] <= 1.0f ? 0 : 1;
    }
    free(map);
    if (shadow) {
        s->host.engine->destroy_shadow(shadow);
    }
    if (result < 0) {
        stage_fail(s, "shadow map", result);
    }
    return result >= 0;
}

velum_result stage_draw(stage *s, stage_view *v, const stage_camera *c, double time_s, uint32_t flags, picture *out,
                        stage_cost *cost) {
    const velum_frame_info frame = frame_info(s, time_s);
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = v->eye};
    eye.flags = flags & VELUM_VIEW_CUT ? VELUM_EYE_RESET : 0;
    memcpy(eye.position_ecef_m, c->position_m, sizeof eye.position_ecef_m);
    velum_view_frame view = {.struct_size = sizeof view,
                             .flags = (s->hides_ground ? 0u : VELUM_VIEW_GROUND) | flags,
                             .tan_left = (float)-c->tan_x,
                             .tan_right = (float)c->tan_x,
                             .tan_bottom = (float)-c->tan_y,
                             .tan_top = (float)c->tan_y,
                             .width = out->width,
                             .height = out->height,
                             .depth_convention = VELUM_DEPTH_DISTANCE,
                             .luminance_scale = 1.0f};
    memcpy(view.position_ecef_m, c->position_m, sizeof view.position_ecef_m);
    memcpy(view.right_ecef, c->right, sizeof view.right_ecef);
    memcpy(view.up_ecef, c->up, sizeof view.up_ecef);
    memcpy(view.forward_ecef, c->forward, sizeof view.forward_ecef);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = v->view,
                                 .frame = &view,
                                 .luminance_rgb = out->rgb,
                                 .transmittance_rgb = out->transmittance,
                                 .distance_m = out->distance,
                                 .depth = v->depth,
                                 .variance = out->variance,
                                 .width = out->width,
                                 .height = out->height};
    double start_ms = stage_now_ms();
    velum_result result = s->host.standalone->render(s->engine, &frame, &eye, 1, 0, &pixels, 1, 0);
    double wall_ms = stage_now_ms() - start_ms;
    if (result < 0) {
        return result;
    }
    picture_update_luminance(out);
    velum_view_stats stats = {.struct_size = sizeof stats};
    if (cost) {
        *cost = (stage_cost){.wall_ms = wall_ms, .view_ms = wall_ms};
        if (s->host.engine->get_stats(v->view, &stats) == VELUM_OK) {
            double view_ms = (double)stats.march_ms + (double)stats.resolve_ms;
            cost->view_ms = view_ms > 0.0 ? view_ms : wall_ms;
            cost->shared_ms = (double)stats.shared_ms;
            cost->rays = (double)stats.rays;
            cost->samples = (double)stats.samples;
            cost->light_samples = (double)stats.light_samples;
        }
    }
    return result;
}
