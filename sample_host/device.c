#include "device.h"

#include "options.h"
#include "report.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEVICES_MAX = 16, FAMILIES_MAX = 32, INSTANCE_EXTENSIONS_MAX = 32 };

static const char validation_layer[] = "VK_LAYER_KHRONOS_validation";

bool device_ok(VkResult result, const char *call) {
    if (result < 0) {
        report_error("Vulkan: %s failed (VkResult %d)", call, (int)result);
    }
    return result >= 0;
}

static VkBool32 VKAPI_PTR print_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                        VkDebugUtilsMessageTypeFlagsEXT types,
                                        const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    struct device *device = user;
    (void)severity, (void)types;
    atomic_fetch_add(&device->messages, 1);
    report_error("validation: %s", data->pMessage);
    return VK_FALSE;
}

static bool add_extension(const char **list, uint32_t *count, uint32_t max, const char *name) {
    for (uint32_t i = 0; i < *count; i++) {
        if (strcmp(list[i], name) == 0) {
            return true;
        }
    }
    if (*count == max) {
        report_error("Vulkan: too many extensions are wanted");
        return false;
    }
    list[(*count)++] = name;
    return true;
}

static bool has_validation_layer(void) {
    uint32_t count = 0;
    bool found = false;
    if (vkEnumerateInstanceLayerProperties(&count, NULL) != VK_SUCCESS || count == 0) {
        return false;
    }
    VkLayerProperties *layers = calloc(count, sizeof *layers);
    if (layers && vkEnumerateInstanceLayerProperties(&count, layers) >= 0) {
        for (uint32_t i = 0; i < count; i++) {
            found = found || strcmp(layers[i].layerName, validation_layer) == 0;
        }
    }
    free(layers);
    return found;
}

static bool create_instance(struct device *device, const struct device_info *info,
                            const velum_vulkan_requirements *requirements) {
    const char *extensions[INSTANCE_EXTENSIONS_MAX];
    uint32_t count = 0;
    for (uint32_t i = 0; i < requirements->instance_extension_count; i++) {
        if (!add_extension(extensions, &count, INSTANCE_EXTENSIONS_MAX, requirements->instance_extensions[i])) {
            return false;
        }
    }
    for (uint32_t i = 0; i < info->instance_extension_count; i++) {
        if (!add_extension(extensions, &count, INSTANCE_EXTENSIONS_MAX, info->instance_extensions[i])) {
            return false;
        }
    }
    if (info->validate && (!add_extension(extensions, &count, INSTANCE_EXTENSIONS_MAX, "VK_EXT_debug_utils") ||
                           !add_extension(extensions, &count, INSTANCE_EXTENSIONS_MAX, "VK_EXT_validation_features"))) {
        return false;
    }
    if (info->validate && !has_validation_layer()) {
        report_error("--validate: the layer %s is not installed (Debian: vulkan-validationlayers)", validation_layer);
        return false;
    }
    const VkValidationFeatureEnableEXT synchronisation = VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = print_message,
        .pUserData = device};
    const VkValidationFeaturesEXT validation = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                                .pNext = &messenger,
                                                .enabledValidationFeatureCount = 1,
                                                .pEnabledValidationFeatures = &synchronisation};
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .pApplicationName = "velum-host",
                                           .apiVersion = requirements->api_version};
    const char *const layer = validation_layer;
    const VkInstanceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                         .pNext = info->validate ? &validation : NULL,
                                         .pApplicationInfo = &application,
                                         .enabledLayerCount = info->validate ? 1 : 0,
                                         .ppEnabledLayerNames = &layer,
                                         .enabledExtensionCount = count,
                                         .ppEnabledExtensionNames = extensions};
    VkResult result = vkCreateInstance(&create, NULL, &device->instance);
    if (result != VK_SUCCESS) {
        device->instance = VK_NULL_HANDLE;
        report_error("Vulkan: no instance of version 1.3 with what is needed (VkResult %d); is a driver installed "
                     "(Debian: mesa-vulkan-drivers)?",
                     (int)result);
        return false;
    }
    if (info->validate) {
        PFN_vkCreateDebugUtilsMessengerEXT create_messenger = (PFN_vkCreateDebugUtilsMessengerEXT)vkGetInstanceProcAddr(
            device->instance, "vkCreateDebugUtilsMessengerEXT");
        return create_messenger && device_ok(create_messenger(device->instance, &messenger, NULL, &device->messenger),
                                             "vkCreateDebugUtilsMessengerEXT");
    }
    return true;
}

static bool find_family(VkPhysicalDevice physical, bool present, uint32_t *out) {
    VkQueueFamilyProperties families[FAMILIES_MAX];
    uint32_t count = FAMILIES_MAX;
    vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families);
    const VkQueueFlags both = VK_QUEUE_GRAPHICS_BIT | VK_QUEUE_COMPUTE_BIT;
    for (uint32_t i = 0; i < count; i++) {
        if ((families[i].queueFlags & both) == both) {
            *out = i;
            return true;
        }
    }
    for (uint32_t i = 0; !present && i < count; i++) {
        if (families[i].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            *out = i;
            return true;
        }
    }
    return false;
}

static bool has_swapchain(VkPhysicalDevice physical) {
    uint32_t count = 0;
    bool found = false;
    if (vkEnumerateDeviceExtensionProperties(physical, NULL, &count, NULL) != VK_SUCCESS || count == 0) {
        return false;
    }
    VkExtensionProperties *extensions = calloc(count, sizeof *extensions);
    if (extensions && vkEnumerateDeviceExtensionProperties(physical, NULL, &count, extensions) >= 0) {
        for (uint32_t i = 0; i < count; i++) {
            found = found || strcmp(extensions[i].extensionName, VK_KHR_SWAPCHAIN_EXTENSION_NAME) == 0;
        }
    }
    free(extensions);
    return found;
}

static bool can_serve(const struct device *device, const struct plugin *plugin, const struct device_info *info,
                      VkPhysicalDevice physical, uint32_t *family, char *reason, uint32_t reason_size) {
    velum_result result =
        plugin->vulkan->check_device(vkGetInstanceProcAddr, device->instance, physical, reason, reason_size);
    if (result < 0) {
        if (reason[0] == '\0') {
            snprintf(reason, reason_size, "%s", velum_result_name(result));
        }
        return false;
    }
    if (!find_family(physical, info->present, family)) {
        snprintf(reason, reason_size, "no queue with %s", info->present ? "graphics and compute" : "compute");
        return false;
    }
    if (info->present && !has_swapchain(physical)) {
        snprintf(reason, reason_size, "no " VK_KHR_SWAPCHAIN_EXTENSION_NAME);
        return false;
    }
    return true;
}

static bool choose(struct device *device, const struct plugin *plugin, const struct device_info *info) {
    static const int rank[] = {[VK_PHYSICAL_DEVICE_TYPE_OTHER] = 1,
                               [VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU] = 4,
                               [VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU] = 5,
                               [VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU] = 3,
                               [VK_PHYSICAL_DEVICE_TYPE_CPU] = 2};
    VkPhysicalDevice devices[DEVICES_MAX];
    uint32_t count = DEVICES_MAX;
    int best = 0;
    char reason[256] = "", refused[512] = "";
    if (!device_ok(vkEnumeratePhysicalDevices(device->instance, &count, devices), "vkEnumeratePhysicalDevices")) {
        return false;
    }
    if (info->device >= 0 && (uint32_t)info->device >= count) {
        if (count > 1) {
            report_error("--device: found %d, expected 0 to %u, or auto or cpu", (int)info->device, count - 1);
        } else {
            report_error("--device: found %d, expected %s", (int)info->device,
                         count ? "0, auto or cpu: there is one device" : "auto: there is no Vulkan device");
        }
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        VkPhysicalDeviceProperties properties;
        uint32_t family = 0;
        vkGetPhysicalDeviceProperties(devices[i], &properties);
        if ((info->device >= 0 && (uint32_t)info->device != i) ||
            (info->device == DEVICE_CPU && properties.deviceType != VK_PHYSICAL_DEVICE_TYPE_CPU)) {
            continue;
        }
        reason[0] = '\0';
        if (!can_serve(device, plugin, info, devices[i], &family, reason, sizeof reason)) {
            snprintf(refused, sizeof refused, "device %u (%.200s): %s", i, properties.deviceName, reason);
            continue;
        }
        int value = (unsigned)properties.deviceType < 5 ? rank[properties.deviceType] : 1;
        if (value > best) {
            best = value;
            device->physical = devices[i];
            device->properties = properties;
            device->family = family;
        }
    }
    if (best > 0) {
        return true;
    }
    if (refused[0]) {
        report_error("%s", refused);
    } else {
        report_error("no %sVulkan device; is a driver installed (Debian: mesa-vulkan-drivers)?",
                     info->device == DEVICE_CPU ? "CPU " : "");
    }
    return false;
}

static bool create_device(struct device *device, const struct device_info *info,
                          const velum_vulkan_requirements *requirements) {
    VkPhysicalDeviceVulkan11Features features11 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    VkPhysicalDeviceVulkan12Features features12 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    VkPhysicalDeviceVulkan13Features features13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    if (requirements->features) {
        device->features = *requirements->features;
    }
    if (requirements->features11) {
        features11 = *requirements->features11;
    }
    if (requirements->features12) {
        features12 = *requirements->features12;
    }
    if (requirements->features13) {
        features13 = *requirements->features13;
    }
    features12.timelineSemaphore = VK_TRUE;
    features13.synchronization2 = VK_TRUE;
    features11.pNext = &features12;
    features12.pNext = &features13;
    features13.pNext = NULL;
    for (uint32_t i = 0; i < requirements->device_extension_count; i++) {
        if (!add_extension(device->extensions, &device->extension_count, DEVICE_EXTENSIONS_MAX,
                           requirements->device_extensions[i])) {
            return false;
        }
    }
    if (info->present && !add_extension(device->extensions, &device->extension_count, DEVICE_EXTENSIONS_MAX,
                                        VK_KHR_SWAPCHAIN_EXTENSION_NAME)) {
        return false;
    }
    const float priority = 1;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = device->family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkDeviceCreateInfo create = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                       .pNext = &features11,
                                       .queueCreateInfoCount = 1,
                                       .pQueueCreateInfos = &queue,
                                       .enabledExtensionCount = device->extension_count,
                                       .ppEnabledExtensionNames = device->extensions,
                                       .pEnabledFeatures = &device->features};
    if (!device_ok(vkCreateDevice(device->physical, &create, NULL, &device->handle), "vkCreateDevice")) {
        device->handle = VK_NULL_HANDLE;
        return false;
    }
    vkGetDeviceQueue(device->handle, device->family, 0, &device->queue);
    vkGetPhysicalDeviceMemoryProperties(device->physical, &device->memory);
    return true;
}

bool device_init(struct device *device, struct plugin *plugin, const struct device_info *info) {
    *device = (struct device){.instance = VK_NULL_HANDLE};
    velum_vulkan_requirements requirements = {.struct_size = sizeof requirements};
    velum_result result = plugin->vulkan->get_requirements(&requirements);
    if (result < 0) {
        plugin_report(plugin, "requirements of the plugin", result);
        return false;
    }
    return create_instance(device, info, &requirements) && choose(device, plugin, info) &&
           create_device(device, info, &requirements);
}

void device_finish(struct device *device) {
    if (!device) {
        return;
    }
    if (device->handle) {
        vkDestroyDevice(device->handle, NULL);
        device->handle = VK_NULL_HANDLE;
    }
    if (device->messenger) {
        PFN_vkDestroyDebugUtilsMessengerEXT destroy_messenger =
            (PFN_vkDestroyDebugUtilsMessengerEXT)vkGetInstanceProcAddr(device->instance,
                                                                       "vkDestroyDebugUtilsMessengerEXT");
        if (destroy_messenger) {
            destroy_messenger(device->instance, device->messenger, NULL);
        }
        device->messenger = VK_NULL_HANDLE;
    }
    if (device->instance) {
        vkDestroyInstance(device->instance, NULL);
        device->instance = VK_NULL_HANDLE;
    }
}
