#include "vulkan_device.h"

#include <dlfcn.h>
#include <stdio.h>
#include <string.h>

#include "keep_drivers.h"

typedef union symbol {
    void *symbol;
    PFN_vkGetInstanceProcAddr function;
} symbol;

static PFN_vkVoidFunction instance_function(const vulkan_device *device, const char *name) {
    return device->get_instance_proc_addr(device->instance, name);
}

static bool create_instance(vulkan_device *device, const velum_vulkan_requirements *needed) {
    PFN_vkCreateInstance create = (PFN_vkCreateInstance)instance_function(device, "vkCreateInstance");
    VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "tests", .apiVersion = needed->api_version};
    VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                 .pApplicationInfo = &application,
                                 .enabledExtensionCount = needed->instance_extension_count,
                                 .ppEnabledExtensionNames = needed->instance_extensions};
    return create && create(&info, NULL, &device->instance) == VK_SUCCESS;
}

static bool find_family(vulkan_device *device) {
    PFN_vkGetPhysicalDeviceQueueFamilyProperties get = (PFN_vkGetPhysicalDeviceQueueFamilyProperties)instance_function(
        device, "vkGetPhysicalDeviceQueueFamilyProperties");
    VkQueueFamilyProperties families[16];
    uint32_t count = 16;
    get(device->physical, &count, families);
    for (device->family = 0; device->family < count; device->family++) {
        if (families[device->family].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            return true;
        }
    }
    return false;
}

static bool find_physical(vulkan_device *device, test_host *host, char reason[256]) {
    PFN_vkEnumeratePhysicalDevices enumerate =
        (PFN_vkEnumeratePhysicalDevices)instance_function(device, "vkEnumeratePhysicalDevices");
    PFN_vkGetPhysicalDeviceProperties properties =
        (PFN_vkGetPhysicalDeviceProperties)instance_function(device, "vkGetPhysicalDeviceProperties");
    PFN_vkGetPhysicalDeviceMemoryProperties memory =
        (PFN_vkGetPhysicalDeviceMemoryProperties)instance_function(device, "vkGetPhysicalDeviceMemoryProperties");
    VkPhysicalDevice devices[16];
    uint32_t count = 16;
    VkResult result = enumerate(device->instance, &count, devices);
    if ((result != VK_SUCCESS && result != VK_INCOMPLETE) || count == 0) {
        snprintf(reason, 256, "no Vulkan device");
        return false;
    }
    for (uint32_t pass = 0; pass < 2; pass++) {
        for (uint32_t i = 0; i < count; i++) {
            VkPhysicalDeviceProperties found;
            properties(devices[i], &found);
            bool processor = found.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
            device->physical = devices[i];
            if (processor == (pass == 1) &&
                host->vulkan->check_device(device->get_instance_proc_addr, device->instance, devices[i], reason, 256) ==
                    VELUM_OK &&
                find_family(device)) {
                memory(device->physical, &device->memory);
                device->is_processor = processor;
                snprintf(device->name, sizeof device->name, "%s", found.deviceName);
                return true;
            }
        }
    }
    return false;
}

static bool create_device(vulkan_device *device, const velum_vulkan_requirements *needed) {
    VkPhysicalDeviceVulkan13Features features13 = *needed->features13;
    VkPhysicalDeviceVulkan12Features features12 = *needed->features12;
    VkPhysicalDeviceVulkan11Features features11 = *needed->features11;
    VkPhysicalDeviceFeatures2 features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &features11, .features = *needed->features};
    features11.pNext = &features12;
    features12.pNext = &features13;
    features13.pNext = NULL;
    const float priority = 1.0f;
    VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                     .queueFamilyIndex = device->family,
                                     .queueCount = 1,
                                     .pQueuePriorities = &priority};
    VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                               .pNext = &features,
                               .queueCreateInfoCount = 1,
                               .pQueueCreateInfos = &queue,
                               .enabledExtensionCount = needed->device_extension_count,
                               .ppEnabledExtensionNames = needed->device_extensions};
    PFN_vkCreateDevice create = (PFN_vkCreateDevice)instance_function(device, "vkCreateDevice");
    if (create(device->physical, &info, NULL, &device->device) != VK_SUCCESS) {
        return false;
    }
    PFN_vkGetDeviceProcAddr get = (PFN_vkGetDeviceProcAddr)instance_function(device, "vkGetDeviceProcAddr");
    bool found = true;
#define VULKAN_DEVICE_LOAD(name)                                                                                       \
    device->name = (PFN_##name)get(device->device, #name);                                                             \
    found = found && device->name;
    VULKAN_DEVICE_FUNCTIONS(VULKAN_DEVICE_LOAD)
#undef VULKAN_DEVICE_LOAD
    return found;
}

static bool create_slots(vulkan_device *device) {
    device->vkGetDeviceQueue(device->device, device->family, 0, &device->queue);
    VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                    .flags = VK_COMMAND_POOL_CREATE_RESET_COMMAND_BUFFER_BIT,
                                    .queueFamilyIndex = device->family};
    if (device->vkCreateCommandPool(device->device, &pool, NULL, &device->pool) != VK_SUCCESS) {
        return false;
    }
    VkCommandBufferAllocateInfo buffers = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                           .commandPool = device->pool,
                                           .commandBufferCount = VULKAN_DEVICE_SLOTS};
    if (device->vkAllocateCommandBuffers(device->device, &buffers, device->commands) != VK_SUCCESS) {
        return false;
    }
    VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO, .flags = VK_FENCE_CREATE_SIGNALED_BIT};
    for (uint32_t i = 0; i < VULKAN_DEVICE_SLOTS; i++) {
        if (device->vkCreateFence(device->device, &fence, NULL, &device->fences[i]) != VK_SUCCESS) {
            return false;
        }
    }
    return true;
}

bool vulkan_device_open(vulkan_device *device, test_host *host, char reason[256]) {
    *device = (vulkan_device){0};
    velum_vulkan_requirements needed = {.struct_size = sizeof needed};
    symbol loader;
    device->loader = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    loader.symbol = device->loader ? dlsym(device->loader, "vkGetInstanceProcAddr") : NULL;
    device->get_instance_proc_addr = loader.function;
    snprintf(reason, 256, "no Vulkan loader");
    if (!loader.symbol) {
        goto error;
    }
    snprintf(reason, 256, "the plugin states no requirements");
    if (host->vulkan->get_requirements(&needed) != VELUM_OK) {
        goto error;
    }
    snprintf(reason, 256, "no Vulkan instance");
    if (!create_instance(device, &needed) || !find_physical(device, host, reason)) {
        goto error;
    }
    device->extension_count = needed.device_extension_count;
    device->extensions = needed.device_extensions;
    snprintf(reason, 256, "%.200s: no device can be made of the requirements", device->name);
    if (!create_device(device, &needed) || !create_slots(device)) {
        goto error;
    }
    keep_drivers();
    reason[0] = '\0';
    return true;
error:
    vulkan_device_close(device);
    return false;
}

void vulkan_device_close(vulkan_device *device) {
    if (device->device && device->vkDestroyDevice) {
        for (uint32_t i = 0; i < VULKAN_DEVICE_SLOTS; i++) {
            if (device->fences[i]) {
                device->vkWaitForFences(device->device, 1, &device->fences[i], VK_TRUE, UINT64_MAX);
                device->vkDestroyFence(device->device, device->fences[i], NULL);
            }
        }
        for (uint32_t i = 0; i < device->image_count; i++) {
            device->vkDestroyImageView(device->device, device->images[i].view, NULL);
            device->vkDestroyImage(device->device, device->images[i].image, NULL);
            device->vkFreeMemory(device->device, device->images[i].memory, NULL);
        }
        device->vkDestroyCommandPool(device->device, device->pool, NULL);
        device->vkDestroyDevice(device->device, NULL);
    }
    if (device->instance) {
        PFN_vkDestroyInstance destroy = (PFN_vkDestroyInstance)instance_function(device, "vkDestroyInstance");
        destroy(device->instance, NULL);
    }
    if (device->loader) {
        dlclose(device->loader);
    }
    *device = (vulkan_device){0};
}

velum_vulkan_lend vulkan_device_lend(vulkan_device *device, test_host *host, velum_world *world) {
    return (velum_vulkan_lend){.struct_size = sizeof(velum_vulkan_lend),
                               .world = world,
                               .log = test_log_write,
                               .log_context = &host->log,
                               .get_instance_proc_addr = device->get_instance_proc_addr,
                               .instance = device->instance,
                               .physical_device = device->physical,
                               .device = device->device,
                               .api_version = VK_API_VERSION_1_3,
                               .queue_family = device->family,
                               .frames_in_flight = VULKAN_DEVICE_SLOTS,
                               .enabled_extension_count = device->extension_count,
                               .enabled_extensions = device->extensions};
}

static uint32_t memory_type(const vulkan_device *device, uint32_t bits) {
    for (uint32_t i = 0; i < device->memory.memoryTypeCount; i++) {
        if (bits >> i & 1u && device->memory.memoryTypes[i].propertyFlags & VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT) {
            return i;
        }
    }
    return 0;
}

VkImageView vulkan_device_image(vulkan_device *device, VkFormat format, uint32_t width, uint32_t height) {
    if (device->image_count == VULKAN_DEVICE_IMAGES) {
        return VK_NULL_HANDLE;
    }
    vulkan_image *image = &device->images[device->image_count];
    *image = (vulkan_image){0};
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = VK_IMAGE_TYPE_2D,
                              .format = format,
                              .extent = {width, height, 1},
                              .mipLevels = 1,
                              .arrayLayers = 1,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .tiling = VK_IMAGE_TILING_OPTIMAL,
                              .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                       VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    if (device->vkCreateImage(device->device, &info, NULL, &image->image) != VK_SUCCESS) {
        return VK_NULL_HANDLE;
    }
    VkMemoryRequirements needed;
    device->vkGetImageMemoryRequirements(device->device, image->image, &needed);
    VkMemoryAllocateInfo allocate = {.sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO,
                                     .allocationSize = needed.size,
                                     .memoryTypeIndex = memory_type(device, needed.memoryTypeBits)};
    VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                  .image = image->image,
                                  .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                  .format = format,
                                  .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    if (device->vkAllocateMemory(device->device, &allocate, NULL, &image->memory) != VK_SUCCESS ||
        device->vkBindImageMemory(device->device, image->image, image->memory, 0) != VK_SUCCESS ||
        device->vkCreateImageView(device->device, &view, NULL, &image->view) != VK_SUCCESS) {
        goto error;
    }
    VkCommandBuffer commands = vulkan_device_begin(device, 0);
    if (!commands) {
        goto error;
    }
    VkImageMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
                                    .dstAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                    .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                    .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                                    .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                    .image = image->image,
                                    .subresourceRange = view.subresourceRange};
    device->vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, 0,
                                 0, NULL, 0, NULL, 1, &barrier);
    if (!vulkan_device_submit(device, 0) || !vulkan_device_wait(device, 0)) {
        goto error;
    }
    device->image_count++;
    return image->view;
error:
    device->vkDestroyImageView(device->device, image->view, NULL);
    device->vkDestroyImage(device->device, image->image, NULL);
    device->vkFreeMemory(device->device, image->memory, NULL);
    return VK_NULL_HANDLE;
}

bool vulkan_device_images(vulkan_device *device, uint32_t width, uint32_t height, velum_vulkan_images *out) {
    *out = (velum_vulkan_images){
        .struct_size = sizeof *out, .format = VK_FORMAT_R16G16B16A16_SFLOAT, .width = width, .height = height};
    out->luminance = vulkan_device_image(device, out->format, width, height);
    out->transmittance = vulkan_device_image(device, out->format, width, height);
    out->distance = vulkan_device_image(device, VK_FORMAT_R32_SFLOAT, width, height);
    return out->luminance && out->transmittance && out->distance;
}

bool vulkan_device_depth(vulkan_device *device, float distance_m, velum_vulkan_images *images) {
    images->depth = vulkan_device_image(device, VK_FORMAT_R32_SFLOAT, images->width, images->height);
    images->depth_layout = VK_IMAGE_LAYOUT_GENERAL;
    VkCommandBuffer commands = images->depth ? vulkan_device_begin(device, 0) : NULL;
    if (!commands) {
        return false;
    }
    const VkClearColorValue everywhere = {.float32 = {distance_m}};
    const VkImageSubresourceRange all = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    device->vkCmdClearColorImage(commands, device->images[device->image_count - 1].image, VK_IMAGE_LAYOUT_GENERAL,
                                 &everywhere, 1, &all);
    return vulkan_device_submit(device, 0) && vulkan_device_wait(device, 0);
}

VkCommandBuffer vulkan_device_begin(vulkan_device *device, uint32_t slot) {
    VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                     .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    return device->vkBeginCommandBuffer(device->commands[slot], &info) == VK_SUCCESS ? device->commands[slot] : NULL;
}

/* A full barrier ends each submission: images are written again by the next. */
bool vulkan_device_submit(vulkan_device *device, uint32_t slot) {
    VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                               .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
                               .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT};
    device->vkCmdPipelineBarrier(device->commands[slot], VK_PIPELINE_STAGE_ALL_COMMANDS_BIT,
                                 VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 1, &barrier, 0, NULL, 0, NULL);
    VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &device->commands[slot]};
    return device->vkEndCommandBuffer(device->commands[slot]) == VK_SUCCESS &&
           device->vkResetFences(device->device, 1, &device->fences[slot]) == VK_SUCCESS &&
           device->vkQueueSubmit(device->queue, 1, &info, device->fences[slot]) == VK_SUCCESS;
}

bool vulkan_device_wait(vulkan_device *device, uint32_t slot) {
    return device->vkWaitForFences(device->device, 1, &device->fences[slot], VK_TRUE, UINT64_MAX) == VK_SUCCESS;
}
