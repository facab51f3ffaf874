/* The host's Vulkan instance and device, made from the plugin's requirements, and one queue. */
#ifndef HOST_DEVICE_H
#define HOST_DEVICE_H

#include "plugin.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

enum { DEVICE_EXTENSIONS_MAX = 32 };

struct device {
    VkInstance instance;
    VkDebugUtilsMessengerEXT messenger;
    VkPhysicalDevice physical;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    VkDevice handle;
    uint32_t family;
    VkQueue queue;
    VkPhysicalDeviceFeatures features; /* enabled */
    const char *extensions[DEVICE_EXTENSIONS_MAX];
    uint32_t extension_count;
    atomic_uint messages; /* of validation */
};

struct device_info {
    int32_t device; /* index, DEVICE_AUTO, DEVICE_CPU */
    bool validate;
    bool present; /* graphics queue and swapchain */
    const char *const *instance_extensions;
    uint32_t instance_extension_count;
};

/* Failures are reported in one line; finish is legal after them. The struct must not move while it lives. */
bool device_init(struct device *device, struct plugin *plugin, const struct device_info *info);
void device_finish(struct device *device);

/* Reports a failed call; true if it succeeded. */
bool device_ok(VkResult result, const char *call);

#endif
