#include "gpu.h"

#include "report.h"

static bool find_memory(const struct device *device, uint32_t types, VkMemoryPropertyFlags wanted, uint32_t *out) {
    for (uint32_t i = 0; i < device->memory.memoryTypeCount; i++) {
        if ((types >> i & 1) && (device->memory.memoryTypes[i].propertyFlags & wanted) == wanted) {
            *out = i;
            return true;
        }
    }
    return false;
}

static bool allocate(struct device *device, const VkMemoryRequirements *requirements, uint32_t type,
                     VkDeviceMemory *out) {
    const VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = requirements->size, .memoryTypeIndex = type};
    return device_ok(vkAllocateMemory(device->handle, &info, NULL, out), "vkAllocateMemory");
}

bool gpu_buffer_create(struct device *device, VkDeviceSize size, VkBufferUsageFlags usage, bool host_reads,
                       struct gpu_buffer *out) {
    const VkMemoryPropertyFlags needed = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkBufferCreateInfo info = {.sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = size, .usage = usage};
    VkMemoryRequirements requirements;
    uint32_t type = 0;
    *out = (struct gpu_buffer){.size = size};
    if (!device_ok(vkCreateBuffer(device->handle, &info, NULL, &out->handle), "vkCreateBuffer")) {
        out->handle = VK_NULL_HANDLE;
        return false;
    }
    vkGetBufferMemoryRequirements(device->handle, out->handle, &requirements);
    if (!(host_reads &&
          find_memory(device, requirements.memoryTypeBits, needed | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, &type)) &&
        !find_memory(device, requirements.memoryTypeBits, needed, &type)) {
        report_error("Vulkan: no memory that the host can map");
        return false;
    }
    return allocate(device, &requirements, type, &out->memory) &&
           device_ok(vkBindBufferMemory(device->handle, out->handle, out->memory, 0), "vkBindBufferMemory") &&
           device_ok(vkMapMemory(device->handle, out->memory, 0, VK_WHOLE_SIZE, 0, &out->mapped), "vkMapMemory");
}

void gpu_buffer_destroy(struct device *device, struct gpu_buffer *buffer) {
    if (buffer && device->handle) {
        vkDestroyBuffer(device->handle, buffer->handle, NULL);
        vkFreeMemory(device->handle, buffer->memory, NULL);
        *buffer = (struct gpu_buffer){.size = 0};
    }
}

bool gpu_image_create(struct device *device, uint32_t width, uint32_t height, VkFormat format, struct gpu_image *out) {
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = VK_IMAGE_TYPE_2D,
                                    .format = format,
                                    .extent = {width, height, 1},
                                    .mipLevels = 1,
                                    .arrayLayers = 1,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .tiling = VK_IMAGE_TILING_OPTIMAL,
                                    .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT |
                                             VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    VkMemoryRequirements requirements;
    uint32_t type = 0;
    *out = (struct gpu_image){.format = format, .width = width, .height = height};
    if (!device_ok(vkCreateImage(device->handle, &info, NULL, &out->handle), "vkCreateImage")) {
        out->handle = VK_NULL_HANDLE;
        return false;
    }
    vkGetImageMemoryRequirements(device->handle, out->handle, &requirements);
    if (!find_memory(device, requirements.memoryTypeBits, VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, &type) &&
        !find_memory(device, requirements.memoryTypeBits, 0, &type)) {
        report_error("Vulkan: no memory for an image");
        return false;
    }
    if (!allocate(device, &requirements, type, &out->memory) ||
        !device_ok(vkBindImageMemory(device->handle, out->handle, out->memory, 0), "vkBindImageMemory")) {
        return false;
    }
    const VkImageViewCreateInfo view = {.sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
                                        .image = out->handle,
                                        .viewType = VK_IMAGE_VIEW_TYPE_2D,
                                        .format = format,
                                        .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    if (!device_ok(vkCreateImageView(device->handle, &view, NULL, &out->view), "vkCreateImageView")) {
        out->view = VK_NULL_HANDLE;
        return false;
    }
    return true;
}

void gpu_image_destroy(struct device *device, struct gpu_image *image) {
    if (image && device->handle) {
        vkDestroyImageView(device->handle, image->view, NULL);
        vkDestroyImage(device->handle, image->handle, NULL);
        vkFreeMemory(device->handle, image->memory, NULL);
        *image = (struct gpu_image){.width = 0};
    }
}

bool gpu_pipeline_create(struct device *device, const uint32_t *spirv, size_t spirv_size, const uint32_t *constant,
                         VkDescriptorSetLayout set_layout, struct gpu_pipeline *out) {
    *out = (struct gpu_pipeline){.set_layout = set_layout};
    const VkPipelineLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = 1, .pSetLayouts = &set_layout};
    const VkShaderModuleCreateInfo module_info = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = spirv_size, .pCode = spirv};
    VkShaderModule module = VK_NULL_HANDLE;
    if (!device_ok(vkCreatePipelineLayout(device->handle, &layout, NULL, &out->layout), "vkCreatePipelineLayout")) {
        out->layout = VK_NULL_HANDLE;
        return false;
    }
    if (!device_ok(vkCreateShaderModule(device->handle, &module_info, NULL, &module), "vkCreateShaderModule")) {
        return false;
    }
    const VkSpecializationMapEntry entry = {.constantID = 0, .size = sizeof *constant};
    const VkSpecializationInfo specialisation = {
        .mapEntryCount = 1, .pMapEntries = &entry, .dataSize = sizeof *constant, .pData = constant};
    const VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                              .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                        .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                        .module = module,
                                                        .pName = "main",
                                                        .pSpecializationInfo = constant ? &specialisation : NULL},
                                              .layout = out->layout};
    VkResult result = vkCreateComputePipelines(device->handle, VK_NULL_HANDLE, 1, &info, NULL, &out->handle);
    vkDestroyShaderModule(device->handle, module, NULL);
    return device_ok(result, "vkCreateComputePipelines");
}

void gpu_pipeline_destroy(struct device *device, struct gpu_pipeline *pipeline) {
    if (pipeline && device->handle) {
        vkDestroyPipeline(device->handle, pipeline->handle, NULL);
        vkDestroyPipelineLayout(device->handle, pipeline->layout, NULL);
        *pipeline = (struct gpu_pipeline){.handle = VK_NULL_HANDLE};
    }
}

void gpu_barrier(VkCommandBuffer commands, VkPipelineStageFlags2 from_stage, VkAccessFlags2 from_access,
                 VkPipelineStageFlags2 to_stage, VkAccessFlags2 to_access) {
    const VkMemoryBarrier2 barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER_2,
                                      .srcStageMask = from_stage,
                                      .srcAccessMask = from_access,
                                      .dstStageMask = to_stage,
                                      .dstAccessMask = to_access};
    const VkDependencyInfo dependency = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .memoryBarrierCount = 1, .pMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

void gpu_image_barrier(VkCommandBuffer commands, VkImage image, VkPipelineStageFlags2 stages,
                       VkAccessFlags2 from_access, VkAccessFlags2 to_access, VkImageLayout from, VkImageLayout to) {
    const VkImageMemoryBarrier2 barrier = {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
                                           .srcStageMask = stages,
                                           .srcAccessMask = from_access,
                                           .dstStageMask = stages,
                                           .dstAccessMask = to_access,
                                           .oldLayout = from,
                                           .newLayout = to,
                                           .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                           .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
                                           .image = image,
                                           .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1}};
    const VkDependencyInfo dependency = {
        .sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO, .imageMemoryBarrierCount = 1, .pImageMemoryBarriers = &barrier};
    vkCmdPipelineBarrier2(commands, &dependency);
}

void gpu_image_to_general(VkCommandBuffer commands, VkImage image) {
    gpu_image_barrier(commands, image, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_TRANSFER_BIT, 0,
                      VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_GENERAL);
}

void gpu_copy_image(VkCommandBuffer commands, const struct gpu_image *image, const struct gpu_buffer *to,
                    VkDeviceSize offset) {
    const VkBufferImageCopy region = {.bufferOffset = offset,
                                      .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                      .imageExtent = {image->width, image->height, 1}};
    vkCmdCopyImageToBuffer(commands, image->handle, VK_IMAGE_LAYOUT_GENERAL, to->handle, 1, &region);
}
