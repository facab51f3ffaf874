/* A Vulkan device made from the plugin's requirements, as a host makes it: the loader opened at run time, one compute
 * queue, a few command buffers. */
#ifndef TESTS_ABI_VULKAN_DEVICE_H
#define TESTS_ABI_VULKAN_DEVICE_H

#include "host.h"

enum { VULKAN_DEVICE_SLOTS = 2, VULKAN_DEVICE_IMAGES = 64 };

#define VULKAN_DEVICE_FUNCTIONS(X)                                                                                     \
    X(vkAllocateCommandBuffers)                                                                                        \
    X(vkAllocateMemory)                                                                                                \
    X(vkBeginCommandBuffer)                                                                                            \
    X(vkBindImageMemory)                                                                                               \
    X(vkCmdClearColorImage)                                                                                            \
    X(vkCmdPipelineBarrier)                                                                                            \
    X(vkCreateCommandPool)                                                                                             \
    X(vkCreateFence)                                                                                                   \
    X(vkCreateImage)                                                                                                   \
    X(vkCreateImageView)                                                                                               \
    X(vkDestroyCommandPool)                                                                                            \
    X(vkDestroyDevice)                                                                                                 \
    X(vkDestroyFence)                                                                                                  \
    X(vkDestroyImage)                                                                                                  \
    X(vkDestroyImageView)                                                                                              \
    X(vkEndCommandBuffer)                                                                                              \
    X(vkFreeMemory)                                                                                                    \
    X(vkGetDeviceQueue)                                                                                                \
    X(vkGetImageMemoryRequirements)                                                                                    \
    X(vkQueueSubmit)                                                                                                   \
    X(vkResetFences)                                                                                                   \
    X(vkWaitForFences)

typedef struct vulkan_image {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
} vulkan_image;

typedef struct vulkan_device {
    void *loader;
    PFN_vkGetInstanceProcAddr get_instance_proc_addr;
    VkInstance instance;
    VkPhysicalDevice physical;
    VkPhysicalDeviceMemoryProperties memory;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
    uint32_t extension_count;
    const char *const *extensions;
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    bool is_processor; /* a software device */
    VkCommandPool pool;
    VkCommandBuffer commands[VULKAN_DEVICE_SLOTS];
    VkFence fences[VULKAN_DEVICE_SLOTS];
    vulkan_image images[VULKAN_DEVICE_IMAGES];
    uint32_t image_count;
#define VULKAN_DEVICE_MEMBER(name) PFN_##name name;
    VULKAN_DEVICE_FUNCTIONS(VULKAN_DEVICE_MEMBER)
#undef VULKAN_DEVICE_MEMBER
} vulkan_device;

/* The first device that the plugin accepts, a GPU before a processor. False: there is none; `reason` says why. */
bool vulkan_device_open(vulkan_device *device, test_host *host, char reason[256]);
void vulkan_device_close(vulkan_device *device);
velum_vulkan_lend vulkan_device_lend(vulkan_device *device, test_host *host, velum_world *world);

/* A storage image in GENERAL, kept until the device is closed. Null: out of memory. */
VkImageView vulkan_device_image(vulkan_device *device, VkFormat format, uint32_t width, uint32_t height);
/* Luminance, transmittance, distance of one size. */
bool vulkan_device_images(vulkan_device *device, uint32_t width, uint32_t height, velum_vulkan_images *out);

/* Depth for them, VELUM_DEPTH_DISTANCE: one surface, so far away. False: out of memory. */
bool vulkan_device_depth(vulkan_device *device, float distance_m, velum_vulkan_images *images);

/* Begins the slot's command buffer; submits it; waits for it. */
VkCommandBuffer vulkan_device_begin(vulkan_device *device, uint32_t slot);
bool vulkan_device_submit(vulkan_device *device, uint32_t slot);
bool vulkan_device_wait(vulkan_device *device, uint32_t slot);

#endif
