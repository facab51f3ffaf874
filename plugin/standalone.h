/* A device of our own, for hosts without Vulkan: one queue, one command buffer, calls that wait. */
#ifndef PLUGIN_STANDALONE_H
#define PLUGIN_STANDALONE_H

#include <velum/standalone.h>

#include "engine.h"

#define STANDALONE_FUNCTIONS(X)                                                                                        \
    X(AllocateCommandBuffers)                                                                                          \
    X(BeginCommandBuffer)                                                                                              \
    X(CmdCopyImageToBuffer)                                                                                            \
    X(CreateCommandPool)                                                                                               \
    X(CreateFence)                                                                                                     \
    X(DestroyCommandPool)                                                                                              \
    X(DestroyDevice)                                                                                                   \
    X(DestroyFence)                                                                                                    \
    X(EndCommandBuffer)                                                                                                \
    X(GetDeviceQueue)                                                                                                  \
    X(QueueSubmit)                                                                                                     \
    X(ResetCommandPool)                                                                                                \
    X(ResetFences)                                                                                                     \
    X(WaitForFences)

/* Images of one view of a call, and where their pixels are read back. */
typedef struct target {
    uint32_t width, height;
    gpu_image luminance, transmittance, distance, variance, depth;
    gpu_buffer pixels; /* luminance, transmittance, distance, variance; before: depth */
} target;

typedef struct standalone {
    log_sink sink;
    void *library;
    PFN_vkGetInstanceProcAddr get;
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkDevice device;
    uint32_t family;
    VkQueue queue;
    VkCommandPool pool;
    VkCommandBuffer commands;
    VkFence fence;
    engine *e;
    uint64_t serial;
    target *targets;
    uint32_t target_count;
    gpu_buffer shadow_pixels;
    PFN_vkDestroyInstance DestroyInstance;
    PFN_vkDestroyDebugUtilsMessengerEXT DestroyDebugUtilsMessengerEXT;
#define X(name) PFN_vk##name name;
    STANDALONE_FUNCTIONS(X)
#undef X
} standalone;

velum_result standalone_create(const velum_standalone_desc *desc, velum_engine **out);
velum_result standalone_render(standalone *s, const velum_frame_info *frame, const velum_eye_frame *eyes,
                               uint32_t eye_count, uint32_t eye_stride, const velum_pixels *views, uint32_t view_count,
                               uint32_t view_stride);
velum_result standalone_render_shadow(standalone *s, const velum_frame_info *frame, shadow *map,
                                      const velum_shadow_frame *shadow_frame, float *transmittance, uint64_t count);
/* Frees targets and read-back buffers. */
void standalone_release(void *owner);

#endif
