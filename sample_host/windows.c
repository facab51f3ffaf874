#include "windows.h"

#include "renderer.h"
#include "report.h"
#include "stats.h"
#include "swapchain.h"

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double seek_s = 10;
enum { MONITORS_MAX = 64 };

struct player {
    double time_s, from_s, to_s;
    double direction;
    bool paused, jumped, closed;
};

struct window {
    GLFWwindow *handle;
    struct swapchain swapchain;
    bool acquired;
    char line[RENDERER_LINE_MAX];
};

struct windows {
    struct window *list;
    uint32_t count;
    struct player player;
    double frame_ms; /* running mean */
};

bool windows_display_exists(void) {
    const char *x11 = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    return (x11 && *x11) || (wayland && *wayland);
}

static void on_key(GLFWwindow *handle, int key, int scancode, int action, int modifiers) {
    struct player *player = glfwGetWindowUserPointer(handle);
    (void)scancode, (void)modifiers;
    if (action == GLFW_RELEASE) {
        return;
    }
    switch (key) {
    case GLFW_KEY_Q:
    case GLFW_KEY_ESCAPE: player->closed = true; break;
    case GLFW_KEY_SPACE: player->paused = !player->paused; break;
    case GLFW_KEY_R: player->direction = -player->direction; break;
    case GLFW_KEY_LEFT:
    case GLFW_KEY_RIGHT:
        player->time_s += key == GLFW_KEY_LEFT ? -seek_s : seek_s;
        player->jumped = true;
        break;
    default: break;
    }
}

static void advance(struct player *player, double elapsed_s) {
    if (!player->paused) {
        player->time_s += player->direction * elapsed_s;
    }
    player->time_s = fmin(fmax(player->time_s, player->from_s), player->to_s);
}

static bool report_glfw(const char *what) {
    const char *text = NULL;
    glfwGetError(&text);
    report_error("window: %s: %s", what, text ? text : "unknown error");
    return false;
}

/* From left to right, then downwards: GLFW names the primary one first. */
static uint32_t list_monitors(GLFWmonitor *out[MONITORS_MAX]) {
    int count = 0;
    GLFWmonitor **monitors = glfwGetMonitors(&count);
    uint32_t used = 0;
    for (; used < MONITORS_MAX && (int)used < count; used++) {
        int x = 0, y = 0;
        uint32_t at = used;
        glfwGetMonitorPos(monitors[used], &x, &y);
        for (; at > 0; at--) {
            int other_x = 0, other_y = 0;
            glfwGetMonitorPos(out[at - 1], &other_x, &other_y);
            if (other_x < x || (other_x == x && other_y <= y)) {
                break;
            }
            out[at] = out[at - 1];
        }
        out[at] = monitors[used];
    }
    return used;
}

/* All of one monitor; it stays when another window is chosen. */
static GLFWwindow *open_whole(GLFWmonitor *monitor, const char *title) {
    const GLFWvidmode *mode = glfwGetVideoMode(monitor);
    if (!mode) {
        return NULL;
    }
    glfwWindowHint(GLFW_AUTO_ICONIFY, GLFW_FALSE);
    glfwWindowHint(GLFW_RED_BITS, mode->redBits);
    glfwWindowHint(GLFW_GREEN_BITS, mode->greenBits);
    glfwWindowHint(GLFW_BLUE_BITS, mode->blueBits);
    glfwWindowHint(GLFW_REFRESH_RATE, mode->refreshRate);
    return glfwCreateWindow(mode->width, mode->height, title, monitor, NULL);
}

/* Its own monitor, whole, where there is one for each; else shared among the monitors, beside the one before. */
static GLFWwindow *open_window(const struct renderer_channel *channel, uint32_t index, uint32_t count, int *next_x) {
    GLFWmonitor *monitors[MONITORS_MAX];
    uint32_t monitor_count = list_monitors(monitors);
    char title[96];
    snprintf(title, sizeof title, "Velum: %s", channel->info.name);
    glfwWindowHint(GLFW_CLIENT_API, GLFW_NO_API);
    if (monitor_count > 1 && monitor_count >= count) {
        return open_whole(monitors[index], title);
    }
    GLFWwindow *handle = glfwCreateWindow((int)channel->width, (int)channel->height, title, NULL, NULL);
    if (handle && count > 1) {
        int x = *next_x, y = 40;
        if (monitor_count > 1) {
            uint32_t monitor = index * monitor_count / count;
            uint32_t first = (monitor * count + monitor_count - 1) / monitor_count;
            glfwGetMonitorPos(monitors[monitor], &x, &y);
            x += (int)((index - first) * channel->width);
            y += 40;
        }
        glfwSetWindowPos(handle, x, y);
        *next_x += (int)channel->width;
    }
    return handle;
}

static bool open_windows(struct windows *windows, struct renderer *renderer) {
    int next_x = 0;
    windows->list = calloc(renderer->channel_count, sizeof *windows->list);
    if (!windows->list) {
        report_error("out of memory");
        return false;
    }
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        struct window *window = &windows->list[i];
        VkSurfaceKHR surface = VK_NULL_HANDLE;
        int width = 0, height = 0;
        window->handle = open_window(&renderer->channels[i], i, renderer->channel_count, &next_x);
        windows->count = i + 1;
        if (!window->handle) {
            return report_glfw(renderer->channels[i].info.name);
        }
        glfwSetWindowUserPointer(window->handle, &windows->player);
        glfwSetKeyCallback(window->handle, on_key);
        if (!device_ok(glfwCreateWindowSurface(renderer->device->instance, window->handle, NULL, &surface),
                       "glfwCreateWindowSurface")) {
            return false;
        }
        glfwGetFramebufferSize(window->handle, &width, &height);
        if (!swapchain_init(&window->swapchain, renderer->device, surface, (uint32_t)width, (uint32_t)height)) {
            return false;
        }
    }
    return true;
}

static void close_windows(struct windows *windows, struct device *device) {
    for (uint32_t i = 0; i < windows->count; i++) {
        swapchain_finish(&windows->list[i].swapchain, device);
        if (windows->list[i].handle) {
            glfwDestroyWindow(windows->list[i].handle);
        }
    }
    free(windows->list);
    *windows = (struct windows){.count = 0};
}

static bool follow_sizes(struct windows *windows, struct renderer *renderer) {
    for (uint32_t i = 0; i < windows->count; i++) {
        struct window *window = &windows->list[i];
        int width = 0, height = 0;
        if (!window->swapchain.out_of_date) {
            continue;
        }
        glfwGetFramebufferSize(window->handle, &width, &height);
        vkDeviceWaitIdle(renderer->device->handle);
        if (!swapchain_resize(&window->swapchain, renderer->device, (uint32_t)width, (uint32_t)height)) {
            return false;
        }
    }
    return true;
}

static void draw_figures(struct windows *windows, struct renderer *renderer) {
    for (uint32_t i = 0; i < windows->count; i++) {
        const struct renderer_channel *channel = &renderer->channels[i];
        velum_view_stats stats = {.struct_size = sizeof stats};
        renderer->scene->plugin.engine->get_stats(channel->view, &stats);
        snprintf(windows->list[i].line, sizeof windows->list[i].line,
                 "%s t=%.1f s%s %.1f fps %.1f ms (march %.1f resolve %.1f) rays %.1fk samples %.2fM",
                 channel->info.name, windows->player.time_s, windows->player.paused ? " paused" : "",
                 1000 / fmax(windows->frame_ms, 0.001), windows->frame_ms, (double)stats.march_ms,
                 (double)stats.resolve_ms, (double)stats.rays / 1e3,
                 (double)(stats.samples + stats.light_samples) / 1e6);
    }
}

static bool present(struct windows *windows, struct device *device) {
    enum { MAX = OPTIONS_CHANNELS_MAX };
    VkSwapchainKHR swapchains[MAX];
    VkSemaphore waits[MAX];
    VkResult results[MAX];
    uint32_t images[MAX], indices[MAX], count = 0;
    for (uint32_t i = 0; i < windows->count; i++) {
        const struct swapchain *swapchain = &windows->list[i].swapchain;
        if (windows->list[i].acquired) {
            swapchains[count] = swapchain->handle;
            waits[count] = swapchain->presentable[swapchain->current];
            images[count] = swapchain->current;
            indices[count++] = i;
        }
    }
    const VkPresentInfoKHR info = {.sType = VK_STRUCTURE_TYPE_PRESENT_INFO_KHR,
                                   .waitSemaphoreCount = count,
                                   .pWaitSemaphores = waits,
                                   .swapchainCount = count,
                                   .pSwapchains = swapchains,
                                   .pImageIndices = images,
                                   .pResults = results};
    if (count == 0) {
        return true;
    }
    vkQueuePresentKHR(device->queue, &info);
    for (uint32_t k = 0; k < count; k++) {
        if (results[k] == VK_ERROR_OUT_OF_DATE_KHR || results[k] == VK_SUBOPTIMAL_KHR) {
            windows->list[indices[k]].swapchain.out_of_date = true;
        } else if (!device_ok(results[k], "vkQueuePresentKHR")) {
            return false;
        }
    }
    return true;
}

static bool show_frame(struct windows *windows, struct renderer *renderer, const struct frame_request *request) {
    VkSemaphore waits[OPTIONS_CHANNELS_MAX], signals[OPTIONS_CHANNELS_MAX];
    uint32_t count = 0;
    uint32_t slot = (uint32_t)(renderer->submitted % renderer->slot_count);
    VkCommandBuffer commands = renderer_record(renderer, request);
    if (!commands) {
        return false;
    }
    for (uint32_t i = 0; i < windows->count; i++) {
        struct window *window = &windows->list[i];
        window->acquired = swapchain_acquire(&window->swapchain, renderer->device, slot);
        if (window->acquired) {
            swapchain_fill(&window->swapchain, commands, &renderer->channels[i].picture);
            waits[count] = window->swapchain.acquired[slot];
            signals[count++] = window->swapchain.presentable[window->swapchain.current];
        } else if (!window->swapchain.out_of_date) {
            return false;
        }
    }
    return renderer_submit(renderer, waits, count, signals, count) && present(windows, renderer->device);
}

static bool any_closed(const struct windows *windows) {
    bool closed = windows->player.closed;
    for (uint32_t i = 0; i < windows->count; i++) {
        closed = closed || glfwWindowShouldClose(windows->list[i].handle);
    }
    return closed;
}

static bool run(struct windows *windows, struct renderer *renderer, struct stats *stats) {
    struct player *player = &windows->player;
    const char *lines[OPTIONS_CHANNELS_MAX];
    struct frame_request request = {.time_s = player->time_s, .reset = true, .lines = lines};
    double before_s = glfwGetTime(), adapted_s = before_s;
    float wanted = 1;
    if (!renderer_exposure(renderer, player->time_s, &request.exposure)) {
        return false;
    }
    wanted = request.exposure;
    for (uint64_t frame = 0; !any_closed(windows); frame++) {
        glfwPollEvents();
        double now_s = glfwGetTime();
        double elapsed_s = now_s - before_s;
        before_s = now_s;
        windows->frame_ms = frame < 2 ? 1e3 * elapsed_s : 0.9 * windows->frame_ms + 0.1 * 1e3 * elapsed_s;
        advance(player, frame == 0 ? 0 : elapsed_s);
        if (now_s - adapted_s > 1) {
            adapted_s = now_s;
            if (!renderer_exposure(renderer, player->time_s, &wanted)) {
                return false;
            }
        }
        /* As an eye does, within a second or so. */
        request.exposure *= powf(wanted / request.exposure, 1 - expf((float)-elapsed_s));
        request.time_s = player->time_s;
        request.reset = player->jumped || frame == 0;
        player->jumped = false;
        draw_figures(windows, renderer);
        for (uint32_t i = 0; i < windows->count; i++) {
            lines[i] = windows->list[i].line;
        }
        if (!follow_sizes(windows, renderer) || !show_frame(windows, renderer, &request) ||
            !stats_write(stats, renderer, frame, 0, request.time_s, 1e3 * elapsed_s)) {
            return false;
        }
    }
    return true;
}

bool windows_play(const struct options *options) {
    struct scene scene = {.scenario = NULL};
    struct device device = {.instance = VK_NULL_HANDLE};
    struct renderer renderer = {.device = NULL};
    struct windows windows = {.count = 0};
    struct stats stats = {.path = NULL};
    bool done = false;
    if (!windows_display_exists()) {
        report_error("--window: there is no display (neither DISPLAY nor WAYLAND_DISPLAY is set)");
        return false;
    }
    if (!glfwInit()) {
        return report_glfw("no display (--out DIR makes pictures without one)");
    }
    uint32_t extension_count = 0;
    const char **extensions = glfwGetRequiredInstanceExtensions(&extension_count);
    if (!extensions) {
        report_glfw("Vulkan");
        goto error;
    }
    const struct device_info info = {.device = options->device,
                                     .validate = options->validate,
                                     .present = true,
                                     .instance_extensions = extensions,
                                     .instance_extension_count = extension_count};
    const struct renderer_info setup = {.options = options, .frames_in_flight = RENDERER_SLOTS_MAX};
    if (!stats_open(&stats, options->stats) || !scene_init(&scene, options) ||
        !device_init(&device, &scene.plugin, &info) || !renderer_init(&renderer, &scene, &device, &setup)) {
        goto error;
    }
    double from = options->has_from ? options->from_s : 0;
    double to = options->has_to ? options->to_s : fmax(scene.scenario->duration_s, from);
    windows.player = (struct player){
        .time_s = from, .from_s = fmin(from, to), .to_s = fmax(from, to), .direction = to < from ? -1 : 1};
    if (!options->has_from && !options->has_to) {
        windows.player.from_s = 0;
    }
    done = open_windows(&windows, &renderer) && run(&windows, &renderer, &stats);

error:
    if (device.handle) {
        vkDeviceWaitIdle(device.handle);
    }
    close_windows(&windows, &device);
    renderer_finish(&renderer);
    device_finish(&device);
    scene_finish(&scene);
    glfwTerminate();
    done = stats_close(&stats) && done;
    if (atomic_load(&device.messages) > 0) {
        report_error("%u validation messages", atomic_load(&device.messages));
        done = false;
    }
    return done;
}
