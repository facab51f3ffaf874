#include "gpu.h"

#include <stdio.h>
#include <string.h>

static const char *result_name(VkResult result) {
    switch (result) {
    case VK_NOT_READY: return "VK_NOT_READY";
    case VK_INCOMPLETE: return "VK_INCOMPLETE";
    case VK_ERROR_OUT_OF_HOST_MEMORY: return "VK_ERROR_OUT_OF_HOST_MEMORY";
    case VK_ERROR_OUT_OF_DEVICE_MEMORY: return "VK_ERROR_OUT_OF_DEVICE_MEMORY";
    case VK_ERROR_INITIALIZATION_FAILED: return "VK_ERROR_INITIALIZATION_FAILED";
    case VK_ERROR_DEVICE_LOST: return "VK_ERROR_DEVICE_LOST";
    case VK_ERROR_MEMORY_MAP_FAILED: return "VK_ERROR_MEMORY_MAP_FAILED";
    case VK_ERROR_LAYER_NOT_PRESENT: return "VK_ERROR_LAYER_NOT_PRESENT";
    case VK_ERROR_EXTENSION_NOT_PRESENT: return "VK_ERROR_EXTENSION_NOT_PRESENT";
    case VK_ERROR_FEATURE_NOT_PRESENT: return "VK_ERROR_FEATURE_NOT_PRESENT";
    case VK_ERROR_INCOMPATIBLE_DRIVER: return "VK_ERROR_INCOMPATIBLE_DRIVER";
    case VK_ERROR_TOO_MANY_OBJECTS: return "VK_ERROR_TOO_MANY_OBJECTS";
    case VK_ERROR_FORMAT_NOT_SUPPORTED: return "VK_ERROR_FORMAT_NOT_SUPPORTED";
    case VK_ERROR_FRAGMENTED_POOL: return "VK_ERROR_FRAGMENTED_POOL";
    case VK_ERROR_OUT_OF_POOL_MEMORY: return "VK_ERROR_OUT_OF_POOL_MEMORY";
    case VK_ERROR_UNKNOWN: return "VK_ERROR_UNKNOWN";
    default: return "another VkResult";
    }
}

bool gpu_check(gpu *g, VkResult result, const char *call, const char *file, int line) {
    if (result >= 0) {
        return true;
    }
    g->result = result;
    const char *slash = strrchr(file, '/');
    const char *parenthesis = strchr(call, '(');
    int length = parenthesis ? (int)(parenthesis - call) : (int)strlen(call);
    log_write(g->sink, VELUM_LOG_ERROR, "device", "vk%.*s: %s (%d) at %s:%d", length, call, result_name(result),
              (int)result, slash ? slash + 1 : file, line);
    return false;
}

bool gpu_is_software(const gpu *g) {
    return g->properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
}

velum_result gpu_result(const gpu *g) {
    switch (g->result) {
    case VK_ERROR_OUT_OF_HOST_MEMORY:
    case VK_ERROR_OUT_OF_DEVICE_MEMORY:
    case VK_ERROR_OUT_OF_POOL_MEMORY:
    case VK_ERROR_FRAGMENTED_POOL:
    case VK_ERROR_TOO_MANY_OBJECTS: return VELUM_ERROR_OUT_OF_MEMORY;
    case VK_ERROR_DEVICE_LOST: return VELUM_ERROR_DEVICE_LOST;
    default: return VELUM_ERROR_VULKAN;
    }
}

/* vkGet*ProcAddr give functions as PFN_vkVoidFunction; a union says so without a cast that compilers warn of. */
typedef union any_function {
    PFN_vkVoidFunction from;
#define X(name) PFN_vk##name name;
    GPU_INSTANCE_FUNCTIONS(X)
    GPU_DEVICE_FUNCTIONS(X)
#undef X
    PFN_vkGetPhysicalDeviceFeatures2 GetPhysicalDeviceFeatures2;
    PFN_vkEnumerateDeviceExtensionProperties EnumerateDeviceExtensionProperties;
} any_function;

velum_result gpu_init(gpu *g, const velum_vulkan_lend *lend, const log_sink *sink) {
    *g = (gpu){.sink = sink, .physical = lend->physical_device, .device = lend->device};
    any_function f;
#define X(name)                                                                                                        \
    f.from = lend->get_instance_proc_addr(lend->instance, "vk" #name);                                                 \
    if (!f.from) {                                                                                                     \
        return log_fail(sink, VELUM_ERROR_UNSUPPORTED, "device", "create_engine: vk" #name " is missing");             \
    }                                                                                                                  \
    g->name = f.name;
    GPU_INSTANCE_FUNCTIONS(X)
#undef X
#define X(name)                                                                                                        \
    f.from = g->GetDeviceProcAddr(lend->device, "vk" #name);                                                           \
    if (!f.from) {                                                                                                     \
        return log_fail(sink, VELUM_ERROR_UNSUPPORTED, "device", "create_engine: vk" #name " is missing");             \
    }                                                                                                                  \
    g->name = f.name;
    GPU_DEVICE_FUNCTIONS(X)
#undef X
    VkPhysicalDeviceProperties2 properties = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2};
    g->GetPhysicalDeviceProperties2(g->physical, &properties);
    g->properties = properties.properties;
    g->GetPhysicalDeviceMemoryProperties(g->physical, &g->memory);
    VkQueueFamilyProperties families[32];
    uint32_t count = 32;
    g->GetPhysicalDeviceQueueFamilyProperties(g->physical, &count, families);
    if (lend->queue_family >= count) {
        return log_fail(sink, VELUM_ERROR_ARGUMENT, "device",
                        "create_engine: lend.queue_family: found %u, expected 0..%u", lend->queue_family, count - 1);
    }
    if (!(families[lend->queue_family].queueFlags & VK_QUEUE_COMPUTE_BIT)) {
        return log_fail(sink, VELUM_ERROR_ARGUMENT, "device",
                        "create_engine: lend.queue_family: family %u has no compute", lend->queue_family);
    }
    g->has_timestamps =
        families[lend->queue_family].timestampValidBits >= 36 && g->properties.limits.timestampPeriod > 0.0f;
    return VELUM_OK;
}

bool gpu_buffer_init(gpu *g, gpu_buffer *buffer, VkDeviceSize size, VkBufferUsageFlags usage, gpu_memory_kind kind) {
    *buffer = (gpu_buffer){.size = size};
    VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    if (!VK(g, CreateBuffer(g->device, &info, NULL, &buffer->buffer))) {
        buffer->buffer = VK_NULL_HANDLE;
        return false;
    }
    VkMemoryRequirements requirements;
    g->GetBufferMemoryRequirements(g->device, buffer->buffer, &requirements);
    if (!gpu_allocate(g, &requirements, kind, true, &buffer->allocation) ||
        !VK(g, BindBufferMemory(g->device, buffer->buffer, gpu_allocation_memory(&buffer->allocation),
                                buffer->allocation.offset))) {
        gpu_buffer_finish(g, buffer);
        return false;
    }
    buffer->mapped = gpu_allocation_mapped(&buffer->allocation);
    return true;
}

bool gpu_buffer_view(gpu *g, gpu_buffer *buffer, VkFormat format, VkDeviceSize bytes) {
    const VkBufferViewCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO, .buffer = buffer->buffer, .format = format, .range = bytes};
    if (!VK(g, CreateBufferView(g->device, &info, NULL, &buffer->texels))) {
        buffer->texels = VK_NULL_HANDLE;
        return false;
    }
    return true;
}

void gpu_buffer_finish(gpu *g, gpu_buffer *buffer) {
    if (buffer->texels) {
        g->DestroyBufferView(g->device, buffer->texels, NULL);
    }
    if (buffer->buffer) {
        g->DestroyBuffer(g->device, buffer->buffer, NULL);
    }
    gpu_release(g, &buffer->allocation);
    *buffer = (gpu_buffer){0};
}

bool gpu_image_init(gpu *g, gpu_image *image, const gpu_image_desc *desc) {
    *image = (gpu_image){.format = desc->format,
                         .extent = desc->extent,
                         .layers = desc->layers,
                         .is_storage = (desc->usage & VK_IMAGE_USAGE_STORAGE_BIT) != 0};
    VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                              .imageType = desc->type,
                              .format = desc->format,
                              .extent = desc->extent,
                              .mipLevels = 1,
                              .arrayLayers = desc->layers,
                              .samples = VK_SAMPLE_COUNT_1_BIT,
                              .tiling = VK_IMAGE_TILING_OPTIMAL,
                              .usage = desc->usage | (image->is_storage ? VK_IMAGE_USAGE_TRANSFER_DST_BIT : 0u),
                              .initialLayout = VK_IMAGE_LAYOUT_UNDEFINED};
    if (!VK(g, CreateImage(g->device, &info, NULL, &image->image))) {
        image->image = VK_NULL_HANDLE;
        return false;
    }
    VkMemoryRequirements requirements;
    g->GetImageMemoryRequirements(g->device, image->image, &requirements);
    if (!gpu_allocate(g, &requirements, GPU_MEMORY_DEVICE, false, &image->allocation) ||
        !VK(g, BindImageMemory(g->device, image->image, gpu_allocation_memory(&image->allocation),
                               image->allocation.offset))) {
        gpu_image_finish(g, image);
        return false;
    }
    VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                  .image = image->image,
                                  .viewType = desc->view_type,
                                  .format = desc->format,
                                  .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, desc->layers}};
    if (!VK(g, CreateImageView(g->device, &view, NULL, &image->view))) {
        image->view = VK_NULL_HANDLE;
        gpu_image_finish(g, image);
        return false;
    }
    return true;
}

bool gpu_image_init_storage(gpu *g, gpu_image *image, VkFormat format, uint32_t width, uint32_t height) {
    const gpu_image_desc desc = {.format = format,
                                 .type = VK_IMAGE_TYPE_2D,
                                 .view_type = VK_IMAGE_VIEW_TYPE_2D,
                                 .extent = {width, height, 1},
                                 .layers = 1,
                                 .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT};
    return gpu_image_init(g, image, &desc);
}

void gpu_image_finish(gpu *g, gpu_image *image) {
    if (image->view) {
        g->DestroyImageView(g->device, image->view, NULL);
    }
    if (image->image) {
        g->DestroyImage(g->device, image->image, NULL);
    }
    gpu_release(g, &image->allocation);
    *image = (gpu_image){0};
}

void gpu_image_make_general(gpu *g, VkCommandBuffer commands, gpu_image *image) {
    if (image->general) {
        return;
    }
    image->general = true;
    const VkPipelineStageFlags2 used_by = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT;
    const VkAccessFlags2 used = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                                VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;
    VkImageMemoryBarrier2 barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                     .dstStageMask = image->is_storage ? VK_PIPELINE_STAGE_2_CLEAR_BIT : used_by,
                                     .dstAccessMask = image->is_storage ? VK_ACCESS_2_TRANSFER_WRITE_BIT : used,
                                     .oldLayout = VK_IMAGE_LAYOUT_UNDEFINED,
                                     .newLayout = VK_IMAGE_LAYOUT_GENERAL,
                                     .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                     .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                     .image = image->image,
                                     .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, image->layers}};
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    g->CmdPipelineBarrier2(commands, &info);
    if (image->is_storage) {
        const VkClearColorValue zero = {.uint32 = {0}};
        g->CmdClearColorImage(commands, image->image, VK_IMAGE_LAYOUT_GENERAL, &zero, 1, &barrier.subresourceRange);
        gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_CLEAR_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, used_by, used);
    }
}

void gpu_barrier(gpu *g, VkCommandBuffer commands, VkPipelineStageFlags2 from, VkAccessFlags2 from_access,
                 VkPipelineStageFlags2 to, VkAccessFlags2 to_access) {
    VkMemoryBarrier2 barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                .srcStageMask = from,
                                .srcAccessMask = from_access,
                                .dstStageMask = to,
                                .dstAccessMask = to_access};
    VkDependencyInfo info = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    g->CmdPipelineBarrier2(commands, &info);
}

const velum_vulkan_requirements *gpu_requirements(void) {
    static const VkPhysicalDeviceFeatures features = {.shaderStorageImageExtendedFormats = VK_TRUE,
                                                      .shaderStorageImageWriteWithoutFormat = VK_TRUE};
    static const VkPhysicalDeviceVulkan11Features features11 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES};
    static const VkPhysicalDeviceVulkan12Features features12 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES};
    static const VkPhysicalDeviceVulkan13Features features13 = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
        .synchronization2 = VK_TRUE,
        .maintenance4 = VK_TRUE};
    static const velum_vulkan_requirements requirements = {.struct_size = sizeof requirements,
                                                           .api_version = VK_API_VERSION_1_3,
                                                           .features = &features,
                                                           .features11 = &features11,
                                                           .features12 = &features12,
                                                           .features13 = &features13};
    return &requirements;
}

static bool format_can(PFN_vkGetPhysicalDeviceFormatProperties2 get, VkPhysicalDevice device, VkFormat format,
                       VkFormatFeatureFlags wanted) {
    VkFormatProperties2 properties = {.sType = VK_STRUCTURE_TYPE_FORMAT_PROPERTIES_2};
    get(device, format, &properties);
    return (properties.formatProperties.optimalTilingFeatures & wanted) == wanted;
}

velum_result gpu_check_device(PFN_vkGetInstanceProcAddr get, VkInstance instance, VkPhysicalDevice device, char *reason,
                              uint32_t reason_size) {
    any_function properties2, features2, formats;
    properties2.from = get(instance, "vkGetPhysicalDeviceProperties2");
    features2.from = get(instance, "vkGetPhysicalDeviceFeatures2");
    formats.from = get(instance, "vkGetPhysicalDeviceFormatProperties2");
    const char *missing = NULL;
    if (!properties2.from || !features2.from || !formats.from) {
        missing = "an instance of Vulkan 1.1 or newer";
        goto done;
    }
    VkPhysicalDeviceSubgroupProperties subgroup = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_SUBGROUP_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2,
                                              .pNext = &subgroup};
    properties2.GetPhysicalDeviceProperties2(device, &properties);
    if (properties.properties.apiVersion < VK_API_VERSION_1_3) {
        missing = "Vulkan 1.3";
        goto done;
    }
    VkPhysicalDeviceVulkan13Features features13 = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
    VkPhysicalDeviceFeatures2 features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &features13};
    features2.GetPhysicalDeviceFeatures2(device, &features);
    const VkFormatFeatureFlags both =
        VK_FORMAT_FEATURE_STORAGE_IMAGE_BIT | VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    const VkFormatFeatureFlags texture = VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
    if (!features.features.shaderStorageImageWriteWithoutFormat) {
        missing = "the feature shaderStorageImageWriteWithoutFormat";
    } else if (!features.features.shaderStorageImageExtendedFormats) {
        missing = "the feature shaderStorageImageExtendedFormats";
    } else if (!features13.synchronization2) {
        missing = "the feature synchronization2";
    } else if (!features13.maintenance4) {
        missing = "the feature maintenance4";
    } else if (!(subgroup.supportedOperations & VK_SUBGROUP_FEATURE_ARITHMETIC_BIT) ||
               !(subgroup.supportedStages & VK_SHADER_STAGE_COMPUTE_BIT)) {
        missing = "subgroup arithmetic in compute shaders";
    } else if (properties.properties.limits.maxPerStageDescriptorStorageImages < 10) {
        missing = "10 storage images a stage";
    } else if (properties.properties.limits.maxPerStageDescriptorStorageBuffers < 7) {
        missing = "7 storage buffers a stage";
    } else if (properties.properties.limits.maxPerStageDescriptorSampledImages < 17) {
        missing = "17 sampled images a stage";
    } else if (properties.properties.limits.maxTexelBufferElements < GPU_TEXELS_LEAST) {
        missing = "texel buffers of 33554432 texels";
    } else if (!format_can(formats.GetPhysicalDeviceFormatProperties2, device, VK_FORMAT_R16G16B16A16_UNORM, texture) ||
               !format_can(formats.GetPhysicalDeviceFormatProperties2, device, VK_FORMAT_R16_UNORM, texture)) {
        missing = "linear filtering of R16G16B16A16_UNORM and R16_UNORM";
    } else if (!format_can(formats.GetPhysicalDeviceFormatProperties2, device, VK_FORMAT_R16G16B16A16_SFLOAT, both)) {
        missing = "storage images of R16G16B16A16_SFLOAT";
    } else if (!format_can(formats.GetPhysicalDeviceFormatProperties2, device, VK_FORMAT_R16G16_SFLOAT, both)) {
        missing = "storage images of R16G16_SFLOAT";
    } else if (!format_can(formats.GetPhysicalDeviceFormatProperties2, device, VK_FORMAT_R16_SFLOAT, both)) {
        missing = "storage images of R16_SFLOAT";
    }
done:
    if (reason && reason_size > 0) {
        snprintf(reason, reason_size, "%s%s", missing ? "missing: " : "", missing ? missing : "");
    }
    return missing ? VELUM_ERROR_UNSUPPORTED : VELUM_OK;
}
