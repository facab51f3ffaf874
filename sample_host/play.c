#include "play.h"

#include "device.h"
#include "exr.h"
#include "files.h"
#include "png.h"
#include "progress.h"
#include "renderer.h"
#include "report.h"
#include "stats.h"
#include "windows.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum {
    SETTLE_ONE = 32,   /* frames of a single picture: each pixel is marched in 1 of 16 frames, so twice */
    SETTLE_FIRST = 16, /* frames before the first picture of a sequence */
    PICTURES_MAX = 1000000,
    REFERENCE_PATHS = 64, /* a pixel, where nothing is asked for */
    REFERENCE_LEAST = 8   /* before its error is believed */
};

bool play_times(const struct options *options, double duration_s, struct play_times *out) {
    double from = options->has_at ? options->at_s : options->has_from ? options->from_s : 0;
    double to = options->has_at ? from : options->has_to ? options->to_s : fmax(duration_s, from);
    double fps = options->fps > 0 ? options->fps : 1;
    double count = floor(fabs(to - from) * fps + 1e-6) + 1;
    if (count > PICTURES_MAX) {
        report_error("play: %.0f pictures are wanted; at most %d are made", count, PICTURES_MAX);
        return false;
    }
    *out = (struct play_times){.from_s = from, .step_s = (to < from ? -1 : 1) / fps, .count = (uint64_t)count};
    return true;
}

static double now_ms(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return 1e3 * (double)time.tv_sec + 1e-6 * (double)time.tv_nsec;
}

static bool write_png(const struct renderer_channel *channel, const char *path, uint8_t *pixels) {
    const uint8_t *from = channel->readback.mapped;
    size_t count = (size_t)channel->width * channel->height;
    for (size_t i = 0; i < count; i++) {
        pixels[3 * i] = from[4 * i];
        pixels[3 * i + 1] = from[4 * i + 1];
        pixels[3 * i + 2] = from[4 * i + 2];
    }
    return png_write(path, channel->width, channel->height, 3, pixels);
}

/* The presets know no variance. */
static bool write_exr(const struct renderer_channel *channel, const char *path, bool reference) {
    const char *mapped = channel->readback.mapped;
    const float *luminance = (const float *)(mapped + channel->luminance_at);
    const float *transmittance = (const float *)(mapped + channel->transmittance_at);
    const float *distance = (const float *)(mapped + channel->distance_at);
    const float *variance = (const float *)(mapped + channel->variance_at);
    const struct exr_channel channels[] = {
        {"A", transmittance + 3, 4}, {"B", luminance + 2, 4},      {"G", luminance + 1, 4},
        {"R", luminance, 4},         {"TB", transmittance + 2, 4}, {"TG", transmittance + 1, 4},
        {"TR", transmittance, 4},    {"V", variance, 1},           {"Z", distance, 1},
    };
    const uint32_t count = sizeof channels / sizeof channels[0];
    struct exr_channel written[sizeof channels / sizeof channels[0]];
    uint32_t used = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (reference || channels[i].data != variance) {
            written[used++] = channels[i];
        }
    }
    return exr_write(path, channel->width, channel->height, written, used);
}

static bool write_pictures(const struct renderer *renderer, const struct options *options, const char *folder,
                           uint64_t picture, uint8_t *pixels) {
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        const struct renderer_channel *channel = &renderer->channels[i];
        char name[96], path[FILES_PATH_MAX];
        snprintf(name, sizeof name, "%s_%06llu.png", channel->info.name, (unsigned long long)picture);
        if (options->png && !(files_join(folder, name, path) && write_png(channel, path, pixels))) {
            return false;
        }
        snprintf(name, sizeof name, "%s_%06llu.exr", channel->info.name, (unsigned long long)picture);
        if (options->exr && !(files_join(folder, name, path) &&
                              write_exr(channel, path, options->quality == VELUM_QUALITY_REFERENCE))) {
            return false;
        }
    }
    return true;
}

/* Thousandths of what is asked of the reference that all channels have; 1000: enough. */
static bool reference_progress(const struct options *options, const struct renderer *renderer, uint32_t *out) {
    struct plugin *plugin = &renderer->scene->plugin;
    *out = 1000;
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        velum_view_stats view = {.struct_size = sizeof view};
        velum_result result = plugin->engine->get_stats(renderer->channels[i].view, &view);
        if (result < 0) {
            plugin_report(plugin, "statistics", result);
            return false;
        }
        double share = 0;
        if (renderer->path_limit > 0) {
            share = (double)view.paths_per_pixel / (double)renderer->path_limit;
        }
        /* A picture of few paths does not know its error yet. */
        if (options->error > 0 && view.paths_per_pixel >= REFERENCE_LEAST) {
            double ratio = options->error / fmax((double)view.relative_error, 1e-9);
            share = fmax(share, fmin(ratio * ratio, 1));
        }
        *out = (uint32_t)fmin((double)*out, floor(1000 * fmin(share, 1)));
    }
    return true;
}

/* The reference at one time: frames until it has what was asked for; the newest is read back. */
static bool play_reference(const struct options *options, struct renderer *renderer, struct frame_request *request,
                           struct stats *stats, struct progress *progress, uint64_t picture) {
    uint32_t share = 0;
    request->reset = true;
    for (uint32_t k = 0;; k++) {
        double start_ms = now_ms();
        request->read_back = share == 1000;
        if (!renderer_record(renderer, request) || !renderer_submit(renderer, NULL, 0, NULL, 0) ||
            !renderer_wait(renderer) ||
            !stats_write(stats, renderer, picture, k, request->time_s, now_ms() - start_ms)) {
            return false;
        }
        if (request->read_back) {
            return true;
        }
        request->reset = false;
        if (!reference_progress(options, renderer, &share)) {
            return false;
        }
        progress_update(progress, 1000 * picture + share);
    }
}

static bool play_pictures(const struct options *options, struct renderer *renderer, const struct play_times *times,
                          const char *folder, struct stats *stats, struct progress *progress) {
    bool anew = options->settle > 0 || options->has_at;
    uint32_t settle_next = anew ? (options->settle > 0 ? options->settle : SETTLE_ONE) : 1;
    uint32_t settle_first = anew ? settle_next : SETTLE_FIRST;
    struct frame_request request = {.exposure = 1};
    size_t most = 0;
    uint64_t done = 0;
    bool warned = false;
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        size_t count = (size_t)renderer->channels[i].width * renderer->channels[i].height;
        most = count > most ? count : most;
    }
    uint8_t *pixels = malloc(3 * most);
    if (!pixels || !renderer_exposure(renderer, times->from_s, &request.exposure)) {
        free(pixels);
        return false;
    }
    bool reference = options->quality == VELUM_QUALITY_REFERENCE;
    renderer->path_limit = options->spp == 0 && options->error == 0 ? REFERENCE_PATHS : options->spp;
    progress_start(progress, reference ? 1000 * times->count : settle_first + (times->count - 1) * settle_next);
    for (uint64_t i = 0; i < times->count; i++) {
        uint32_t settle = i == 0 ? settle_first : settle_next;
        request.time_s = times->from_s + (double)i * times->step_s;
        if (reference && !play_reference(options, renderer, &request, stats, progress, i)) {
            goto error;
        }
        for (uint32_t k = 0; !reference && k < settle; k++) {
            double start_ms = now_ms();
            request.reset = k == 0 && (anew || i == 0);
            request.read_back = k + 1 == settle;
            if (!renderer_record(renderer, &request) || !renderer_submit(renderer, NULL, 0, NULL, 0) ||
                !renderer_wait(renderer) || !stats_write(stats, renderer, i, k, request.time_s, now_ms() - start_ms)) {
                goto error;
            }
            progress_update(progress, ++done);
        }
        if (renderer->incomplete && !warned) {
            report_warning("picture %llu lacks detail: tiles were missing", (unsigned long long)i);
            warned = true;
        }
        if (!write_pictures(renderer, options, folder, i, pixels)) {
            goto error;
        }
    }
    free(pixels);
    return true;

error:
    free(pixels);
    return false;
}

static bool play_headless(const struct options *options) {
    const char *folder = options->out ? options->out : "out";
    const struct device_info info = {.device = options->device, .validate = options->validate};
    struct scene scene = {.scenario = NULL};
    struct device device = {.instance = VK_NULL_HANDLE};
    struct renderer renderer = {.device = NULL};
    struct progress progress = {.shown = false};
    struct stats stats = {.path = NULL};
    struct play_times times = {.count = 0};
    struct files_folder made;
    bool done = files_prepare_folder(folder, &made) && stats_open(&stats, options->stats) &&
                scene_init(&scene, options) && play_times(options, scene.scenario->duration_s, &times) &&
                device_init(&device, &scene.plugin, &info);
    if (done) {
        const struct renderer_info setup = {
            .options = options, .frames_in_flight = 1, .full_precision = options->exr, .readback = true};
        done = renderer_init(&renderer, &scene, &device, &setup) &&
               play_pictures(options, &renderer, &times, folder, &stats, &progress);
    }
    progress_finish(&progress);
    uint32_t channels = renderer.channel_count;
    renderer_finish(&renderer);
    device_finish(&device);
    scene_finish(&scene);
    done = stats_close(&stats) && done;
    if (!done) {
        files_remove_empty(&made);
    }
    if (atomic_load(&device.messages) > 0) {
        report_error("%u validation messages", atomic_load(&device.messages));
        done = false;
    }
    if (done) {
        printf("%llu pictures in %s\n", (unsigned long long)times.count * channels, folder);
    }
    return done;
}

bool play(const struct options *options) {
    if (options->window || (!options->out && !options->has_at && !options->settle && windows_display_exists())) {
        return windows_play(options);
    }
    return play_headless(options);
}
