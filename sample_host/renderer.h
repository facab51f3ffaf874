/* Frames of all channels: the plugin's passes, the host's ground before them, the composition after them. */
#ifndef HOST_RENDERER_H
#define HOST_RENDERER_H

#include "cover.h"
#include "device.h"
#include "files.h"
#include "gpu.h"
#include "scene.h"

#include <stdbool.h>

enum { RENDERER_SLOTS_MAX = 2, RENDERER_LINE_MAX = 160 };

struct renderer_channel {
    velum_scenario_channel info;
    uint32_t width, height;
    velum_view *view;
    struct gpu_image colour, depth, luminance, transmittance, distance, variance, picture;
    /* picture (RGBA, 8 bits); in full precision also luminance, transmittance (RGBA, float), distance,
     * variance (float) */
    struct gpu_buffer readback;
    VkDeviceSize luminance_at, transmittance_at, distance_at, variance_at;
    struct gpu_buffer arguments[RENDERER_SLOTS_MAX], overlay[RENDERER_SLOTS_MAX];
    VkDescriptorSet sets[RENDERER_SLOTS_MAX];
    velum_view_frame frame;
};

struct renderer_slot {
    VkCommandPool pool;
    VkCommandBuffer commands;
    struct gpu_buffer shadow_block;
    uint64_t serial; /* of its newest submission */
};

struct renderer {
    struct device *device;
    struct scene *scene;
    velum_engine *engine;
    char cache_path[FILES_PATH_MAX]; /* of the pipeline cache; "": none is kept */
    velum_eye *eye;
    velum_shadow *shadow;
    struct renderer_channel *channels;
    uint32_t channel_count;
    struct renderer_slot slots[RENDERER_SLOTS_MAX];
    uint32_t slot_count;
    VkSemaphore timeline;      /* its value: the newest serial that is done */
    uint64_t begun, submitted; /* newest serials */
    VkDescriptorPool descriptors;
    VkDescriptorSetLayout set_layout;
    VkSampler sampler;
    struct gpu_pipeline ground, ground_depth, compose;
    struct eye_pose pose; /* of the newest frame */
    struct cover_answers cover_over_eye, cover_over_ground;
    bool full_precision;
    uint32_t path_limit; /* of the reference; 0: none */
    bool incomplete;     /* the newest frame lacked tiles */
};

struct renderer_info {
    const struct options *options;
    uint32_t frames_in_flight; /* 1..RENDERER_SLOTS_MAX */
    bool full_precision;       /* floats of 32 bits, not scaled */
    bool readback;
};

/* One frame of all channels. */
struct frame_request {
    double time_s;
    bool reset;               /* start anew */
    float exposure;           /* 1 / cd/m2 */
    bool read_back;           /* fill the readback buffers */
    const char *const *lines; /* over the pictures, one a channel; null: none */
};

/* Failures are reported; finish is legal after them. */
bool renderer_init(struct renderer *renderer, struct scene *scene, struct device *device,
                   const struct renderer_info *info);
void renderer_finish(struct renderer *renderer);

/* 1 / luminance that suits a time at the scene's pose. */
bool renderer_exposure(struct renderer *renderer, double time_s, float *out);

/* Records everything; the command buffer (returned) stays open for the caller's own. Null: failed (reported). With
 * `lines` or `read_back` the pictures are in VK_IMAGE_LAYOUT_GENERAL, visible to transfers and to compute shaders. */
VkCommandBuffer renderer_record(struct renderer *renderer, const struct frame_request *request);

/* Ends the command buffer and submits it. Semaphores of the caller's; counts may be 0. */
bool renderer_submit(struct renderer *renderer, const VkSemaphore *wait, uint32_t wait_count, const VkSemaphore *signal,
                     uint32_t signal_count);

/* Until the device has done all that was submitted. */
bool renderer_wait(struct renderer *renderer);

#endif
