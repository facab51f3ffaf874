/* Velum ABI, part 5: the host's Vulkan device. Table "velum.vulkan/1". Needs Vulkan's own headers.
 *
 * The host asks for the requirements, makes instance and device with them, and lends both. Velum records into the
 * host's command buffers and submits nothing: it owns no queue, waits for nothing and never idles the device. It loads
 * every entry point through get_instance_proc_addr. The device must outlive the engine.
 *
 * Command buffers: primary, recording, outside a render pass, of a family with compute. After each record call the
 * bound compute pipeline, descriptor sets and push constants are undefined; nothing else is touched. Record calls of a
 * frame go into command buffers that are submitted in the order of the calls, all under the frame's submit_serial. */
#ifndef VELUM_VULKAN_H
#define VELUM_VULKAN_H

#include "engine.h"
#include <vulkan/vulkan_core.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Static data of the plugin. */
typedef struct velum_vulkan_requirements {
    uint32_t struct_size;
    uint32_t api_version; /* lowest VkInstance and VkDevice version: Vulkan 1.3 */
    uint32_t instance_extension_count;
    uint32_t device_extension_count;
    const char *const *instance_extensions;
    const char *const *device_extensions;
    const VkPhysicalDeviceFeatures *features;           /* to be enabled at least; VK_TRUE where needed */
    const VkPhysicalDeviceVulkan11Features *features11; /* sType set, pNext null */
    const VkPhysicalDeviceVulkan12Features *features12;
    const VkPhysicalDeviceVulkan13Features *features13;
} velum_vulkan_requirements;

/* The lent device. All handles stay the host's. */
typedef struct velum_vulkan_lend {
    uint32_t struct_size;
    uint32_t flags;     /* 0 */
    velum_world *world; /* the weather to show; must outlive the engine */
    velum_log_fn log;   /* may be null */
    void *log_context;
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    VkInstance instance;
    VkPhysicalDevice physical_device;
    VkDevice device;
    uint32_t api_version;             /* that the instance was made with */
    uint32_t queue_family;            /* of the command buffers that will be recorded into */
    uint32_t frames_in_flight;        /* most frames between begin_frame and their completion, 1..4 */
    uint32_t enabled_extension_count; /* device extensions that are enabled */
    const char *const *enabled_extensions;
    const VkPhysicalDeviceFeatures *enabled_features; /* what was enabled; null: the requirements were */
    const void *pipeline_cache; /* a blob from get_pipeline_cache, of any version and device, or null */
    uint64_t pipeline_cache_size;
} velum_vulkan_lend;

/* Images of a view. `luminance` and `transmittance` are written whole in the sub-rectangle, alpha = luminance-weighted
 * mean transmittance in both. All in VK_IMAGE_LAYOUT_GENERAL at entry and exit, owned by queue_family, with earlier
 * use finished (VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, shader write, is the first use) and the writes made available by
 * a barrier of the host's after. The depth image is in VK_IMAGE_LAYOUT_GENERAL or SHADER_READ_ONLY_OPTIMAL, as
 * depth_layout says, and only read, by the compute stage. With layers 0 the output views are 2D; with layers >= 1
 * they are 2D arrays and array_layer of the view's frame selects (resolve_layered.spv.h serves them). */
typedef struct velum_vulkan_images {
    uint32_t struct_size;
    uint32_t flags;            /* 0 */
    VkImageView luminance;     /* VK_FORMAT_R16G16B16A16_SFLOAT or VK_FORMAT_R32G32B32A32_SFLOAT, storage */
    VkImageView transmittance; /* the same format as luminance */
    VkImageView distance;      /* VK_FORMAT_R32_SFLOAT, storage: mean distance of cloud, m, 0 where there is none;
                                  may be null */
    VkImageView depth;         /* single sample, any format with a float or depth aspect to sample; may be null */
    VkImageLayout depth_layout;
    VkFormat format;        /* of luminance and transmittance */
    uint32_t width, height; /* of the images */
    uint32_t layers;        /* 0: 2D views; else 2D array views of so many layers */
    uint32_t reserved;
    VkImageView variance; /* VK_FORMAT_R32_SFLOAT, storage, as distance: variance of the mean luminance Y, (cd/m2)^2,
                             not scaled; written by VELUM_QUALITY_REFERENCE alone; may be null */
} velum_vulkan_images;

/* The shadow map's image, for the host's descriptor: R16_UNORM or R16_SFLOAT transmittance of cloud between the world
 * and the sun, one array layer per level; VK_IMAGE_LAYOUT_GENERAL at all times. Sample it with velum_shadow.glsl. Valid
 * as long as the shadow object. The host puts a barrier (compute write to its own read) behind record_shadow. */
typedef struct velum_vulkan_shadow {
    uint32_t struct_size;
    uint32_t levels;
    VkImage image;
    VkImageView view;  /* 2D array */
    VkSampler sampler; /* linear, clamped */
    VkFormat format;
    uint32_t texels;
} velum_vulkan_shadow;

typedef struct velum_vulkan_api {
    uint32_t struct_size;
    uint32_t reserved;

    /* [any] */
    velum_result(VELUM_CALL *get_requirements)(velum_vulkan_requirements *out);

    /* [any] Whether a physical device can serve. VELUM_ERROR_UNSUPPORTED: `reason` (may be null) gets the first missing
     * feature, extension or limit, in words. */
    velum_result(VELUM_CALL *check_device)(PFN_vkGetInstanceProcAddr get_instance_proc_addr, VkInstance instance,
                                           VkPhysicalDevice device, char *reason, uint32_t reason_size);

    /* [control] */
    velum_result(VELUM_CALL *create_engine)(const velum_vulkan_lend *lend, velum_engine **out);

    /* [control] size null: error. data null: *size gets the size. Else at most *size bytes are written. */
    velum_result(VELUM_CALL *get_pipeline_cache)(velum_engine *engine, void *data, uint64_t *size);

    /* [render] Once a frame, after begin_frame: uploads, tables, and what the eyes named share. */
    velum_result(VELUM_CALL *record_shared)(velum_engine *engine, VkCommandBuffer commands, const velum_eye_frame *eyes,
                                            uint32_t eye_count, uint32_t eye_stride);

    /* [render] After record_shared, once a frame for each view of an eye named there. VELUM_INCOMPLETE: a tile was
     * missing. */
    velum_result(VELUM_CALL *record_view)(velum_view *view, VkCommandBuffer commands, const velum_view_frame *frame,
                                          const velum_vulkan_images *images);

    /* [render] After record_shared. VELUM_UNCHANGED: the map held already; nothing was recorded. */
    velum_result(VELUM_CALL *record_shadow)(velum_shadow *shadow, VkCommandBuffer commands,
                                            const velum_shadow_frame *frame);

    /* [any] */
    velum_result(VELUM_CALL *get_shadow_image)(velum_shadow *shadow, velum_vulkan_shadow *out);
} velum_vulkan_api;

#define VELUM_VULKAN_API_ID "velum.vulkan/1"

#ifdef __cplusplus
}
#endif
#endif
