#include "compute.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "../asked_device.h"

typedef struct compute_buffer {
    VkBuffer buffer;
    VkDeviceMemory memory;
    void *mapped;
} compute_buffer;

static bool ok(VkResult result, const char *call) {
    if (result != VK_SUCCESS) {
        fprintf(stderr, "%s: VkResult %d\n", call, (int)result);
    }
    return result == VK_SUCCESS;
}

static bool choose_physical(compute_device *device, char reason[256]) {
    VkPhysicalDevice found[16];
    uint32_t count = 16;
    VkResult result = vkEnumeratePhysicalDevices(device->instance, &count, found);
    if ((result != VK_SUCCESS && result != VK_INCOMPLETE) || count == 0) {
        snprintf(reason, 256, "no Vulkan device");
        return false;
    }
    int32_t asked;
    if (!asked_device(&asked) || asked >= (int32_t)count) {
        snprintf(reason, 256, "VELUM_TEST_DEVICE: there are devices 0 to %u", count - 1);
        return false;
    }
    uint32_t index = asked < 0 ? 0 : (uint32_t)asked;
    for (uint32_t i = 0; i < count && asked < 0; i++) {
        VkPhysicalDeviceProperties properties;
        vkGetPhysicalDeviceProperties(found[i], &properties);
        if (properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU && properties.apiVersion >= VK_API_VERSION_1_3) {
            index = i;
            break;
        }
    }
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(found[index], &properties);
    if (properties.apiVersion < VK_API_VERSION_1_3) {
        snprintf(reason, 256, "%.128s has no Vulkan 1.3", properties.deviceName);
        return false;
    }
    device->physical = found[index];
    device->processor = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    snprintf(device->name, sizeof device->name, "%s", properties.deviceName);
    vkGetPhysicalDeviceMemoryProperties(device->physical, &device->memory);

    VkQueueFamilyProperties families[16];
    count = 16;
    vkGetPhysicalDeviceQueueFamilyProperties(device->physical, &count, families);
    for (device->family = 0; device->family < count; device->family++) {
        if (families[device->family].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            return true;
        }
    }
    snprintf(reason, 256, "%.128s has no compute queue", properties.deviceName);
    return false;
}

static bool create_pool_and_sampler(compute_device *device) {
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = device->family};
    const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                         .magFilter = VK_FILTER_LINEAR,
                                         .minFilter = VK_FILTER_LINEAR,
                                         .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                         .addressModeU = VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                         .addressModeV = VK_SAMPLER_ADDRESS_MODE_REPEAT,
                                         .addressModeW = VK_SAMPLER_ADDRESS_MODE_REPEAT};
    return ok(vkCreateCommandPool(device->device, &pool, NULL, &device->pool), "vkCreateCommandPool") &&
           ok(vkCreateSampler(device->device, &sampler, NULL, &device->sampler), "vkCreateSampler");
}

bool compute_borrow(compute_device *device, VkInstance instance, VkPhysicalDevice physical, VkDevice lent,
                    uint32_t family) {
    *device =
        (compute_device){.instance = instance, .physical = physical, .device = lent, .family = family, .lent = true};
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(physical, &properties);
    vkGetPhysicalDeviceMemoryProperties(physical, &device->memory);
    vkGetDeviceQueue(lent, family, 0, &device->queue);
    device->processor = properties.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
    snprintf(device->name, sizeof device->name, "%s", properties.deviceName);
    if (!create_pool_and_sampler(device)) {
        compute_close(device);
        return false;
    }
    return true;
}

bool compute_open(compute_device *device, char reason[256]) {
    *device = (compute_device){0};
    const VkApplicationInfo application = {.sType = VK_STRUCTURE_TYPE_APPLICATION_INFO,
                                           .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo instance = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                           .pApplicationInfo = &application};
    if (vkCreateInstance(&instance, NULL, &device->instance) != VK_SUCCESS) {
        snprintf(reason, 256, "no Vulkan 1.3 driver");
        device->instance = VK_NULL_HANDLE;
        return false;
    }
    if (!choose_physical(device, reason)) {
        goto error;
    }
    snprintf(reason, 256, "%.128s: the device cannot be made", device->name);
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = device->family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    /* SPIR-V 1.6 gives the local size by id. */
    VkPhysicalDeviceVulkan13Features features = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES,
                                                 .maintenance4 = VK_TRUE};
    const VkDeviceCreateInfo info = {.pNext = &features,
                                     .sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue};
    if (!ok(vkCreateDevice(device->physical, &info, NULL, &device->device), "vkCreateDevice")) {
        goto error;
    }
    vkGetDeviceQueue(device->device, device->family, 0, &device->queue);
    if (!create_pool_and_sampler(device)) {
        goto error;
    }
    return true;
error:
    compute_close(device);
    return false;
}

void compute_close(compute_device *device) {
    if (device->device) {
        vkDestroySampler(device->device, device->sampler, NULL);
        vkDestroyCommandPool(device->device, device->pool, NULL);
    }
    if (device->device && !device->lent) {
        vkDestroyDevice(device->device, NULL);
    }
    if (device->instance && !device->lent) {
        vkDestroyInstance(device->instance, NULL);
    }
    *device = (compute_device){0};
}

static bool allocate(const compute_device *device, VkMemoryRequirements needed, VkMemoryPropertyFlags flags,
                     VkDeviceMemory *memory) {
    for (uint32_t i = 0; i < device->memory.memoryTypeCount; i++) {
        if ((needed.memoryTypeBits >> i & 1u) && (device->memory.memoryTypes[i].propertyFlags & flags) == flags) {
            const VkMemoryAllocateInfo info = {
                .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = needed.size, .memoryTypeIndex = i};
            return ok(vkAllocateMemory(device->device, &info, NULL, memory), "vkAllocateMemory");
        }
    }
    fprintf(stderr, "no memory type\n");
    return false;
}

static void buffer_destroy(const compute_device *device, compute_buffer *buffer) {
    vkDestroyBuffer(device->device, buffer->buffer, NULL);
    vkFreeMemory(device->device, buffer->memory, NULL);
    *buffer = (compute_buffer){0};
}

static bool buffer_create(const compute_device *device, size_t bytes, VkBufferUsageFlags usage,
                          compute_buffer *buffer) {
    *buffer = (compute_buffer){0};
    const VkBufferCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_BUFFER_CREATE_INFO, .size = bytes ? bytes : 16, .usage = usage};
    if (!ok(vkCreateBuffer(device->device, &info, NULL, &buffer->buffer), "vkCreateBuffer")) {
        return false;
    }
    VkMemoryRequirements needed;
    vkGetBufferMemoryRequirements(device->device, buffer->buffer, &needed);
    const VkMemoryPropertyFlags flags = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    if (!allocate(device, needed, flags, &buffer->memory) ||
        !ok(vkBindBufferMemory(device->device, buffer->buffer, buffer->memory, 0), "vkBindBufferMemory") ||
        !ok(vkMapMemory(device->device, buffer->memory, 0, VK_WHOLE_SIZE, 0, &buffer->mapped), "vkMapMemory")) {
        buffer_destroy(device, buffer);
        return false;
    }
    return true;
}

static bool begin(const compute_device *device, VkCommandBuffer *commands) {
    const VkCommandBufferAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO, .commandPool = device->pool, .commandBufferCount = 1};
    const VkCommandBufferBeginInfo start = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
    return ok(vkAllocateCommandBuffers(device->device, &info, commands), "vkAllocateCommandBuffers") &&
           ok(vkBeginCommandBuffer(*commands, &start), "vkBeginCommandBuffer");
}

static bool submit(const compute_device *device, VkCommandBuffer commands) {
    const VkSubmitInfo info = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &commands};
    return ok(vkQueueSubmit(device->queue, 1, &info, VK_NULL_HANDLE), "vkQueueSubmit") &&
           ok(vkQueueWaitIdle(device->queue), "vkQueueWaitIdle");
}

bool compute_filters(const compute_device *device, VkFormat format) {
    VkFormatProperties properties;
    vkGetPhysicalDeviceFormatProperties(device->physical, format, &properties);
    return properties.optimalTilingFeatures & VK_FORMAT_FEATURE_SAMPLED_IMAGE_FILTER_LINEAR_BIT;
}

static void transition(VkCommandBuffer commands, VkImage image, uint32_t layers, VkImageLayout from, VkImageLayout to) {
    const VkImageMemoryBarrier barrier = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER,
        .srcAccessMask = VK_ACCESS_MEMORY_WRITE_BIT,
        .dstAccessMask = VK_ACCESS_MEMORY_READ_BIT | VK_ACCESS_MEMORY_WRITE_BIT,
        .oldLayout = from,
        .newLayout = to,
        .srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED,
        .image = image,
        .subresourceRange = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = layers}};
    vkCmdPipelineBarrier(commands, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, VK_PIPELINE_STAGE_ALL_COMMANDS_BIT, 0, 0, NULL,
                         0, NULL, 1, &barrier);
}

/* layers 0: a volume. */
static bool create_texture(compute_device *device, VkFormat format, uint32_t side, uint32_t layers, const void *texels,
                           size_t bytes, compute_texture *texture) {
    *texture = (compute_texture){0};
    compute_buffer staging = {0};
    VkCommandBuffer commands = VK_NULL_HANDLE;
    const VkImageCreateInfo info = {.sType = VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO,
                                    .imageType = layers ? VK_IMAGE_TYPE_2D : VK_IMAGE_TYPE_3D,
                                    .format = format,
                                    .extent = {side, side, layers ? 1 : side},
                                    .mipLevels = 1,
                                    .arrayLayers = layers ? layers : 1,
                                    .samples = VK_SAMPLE_COUNT_1_BIT,
                                    .tiling = VK_IMAGE_TILING_OPTIMAL,
                                    .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    if (!ok(vkCreateImage(device->device, &info, NULL, &texture->image), "vkCreateImage")) {
        goto error;
    }
    VkMemoryRequirements needed;
    vkGetImageMemoryRequirements(device->device, texture->image, &needed);
    if (!allocate(device, needed, 0, &texture->memory) ||
        !ok(vkBindImageMemory(device->device, texture->image, texture->memory, 0), "vkBindImageMemory")) {
        goto error;
    }
    const VkImageViewCreateInfo view = {
        .sType = VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO,
        .image = texture->image,
        .viewType = layers ? VK_IMAGE_VIEW_TYPE_2D_ARRAY : VK_IMAGE_VIEW_TYPE_3D,
        .format = format,
        .subresourceRange = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .levelCount = 1, .layerCount = info.arrayLayers}};
    if (!ok(vkCreateImageView(device->device, &view, NULL, &texture->view), "vkCreateImageView") ||
        !buffer_create(device, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, &staging) || !begin(device, &commands)) {
        goto error;
    }
    memcpy(staging.mapped, texels, bytes);
    transition(commands, texture->image, info.arrayLayers, VK_IMAGE_LAYOUT_UNDEFINED,
               VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    const VkBufferImageCopy copy = {
        .imageSubresource = {.aspectMask = VK_IMAGE_ASPECT_COLOR_BIT, .layerCount = info.arrayLayers},
        .imageExtent = info.extent};
    vkCmdCopyBufferToImage(commands, staging.buffer, texture->image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    transition(commands, texture->image, info.arrayLayers, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
               VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL);
    if (!ok(vkEndCommandBuffer(commands), "vkEndCommandBuffer") || !submit(device, commands)) {
        goto error;
    }
    vkFreeCommandBuffers(device->device, device->pool, 1, &commands);
    buffer_destroy(device, &staging);
    return true;
error:
    if (commands) {
        vkFreeCommandBuffers(device->device, device->pool, 1, &commands);
    }
    buffer_destroy(device, &staging);
    compute_texture_destroy(device, texture);
    return false;
}

bool compute_texture_create(compute_device *device, VkFormat format, uint32_t side, const void *texels, size_t bytes,
                            compute_texture *texture) {
    return create_texture(device, format, side, 0, texels, bytes, texture);
}

bool compute_array_create(compute_device *device, VkFormat format, uint32_t side, uint32_t layers, const void *texels,
                          size_t bytes, compute_texture *texture) {
    return create_texture(device, format, side, layers, texels, bytes, texture);
}

void compute_texture_destroy(compute_device *device, compute_texture *texture) {
    vkDestroyImageView(device->device, texture->view, NULL);
    vkDestroyImage(device->device, texture->image, NULL);
    vkFreeMemory(device->device, texture->memory, NULL);
    *texture = (compute_texture){0};
}

/* What one run makes and unmakes. */
typedef struct run {
    compute_buffer input, output;
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkShaderModule module;
    VkPipeline pipeline;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    VkCommandBuffer commands;
} run;

static bool create_pipeline(compute_device *device, const compute_job *job, run *r) {
    VkDescriptorSetLayoutBinding bindings[COMPUTE_BIND_COUNT];
    uint32_t count = 0;
    for (uint32_t i = 0; i < COMPUTE_BIND_COUNT; i++) {
        if (i >= COMPUTE_BIND_TEXTURE_0 && !job->textures[i - COMPUTE_BIND_TEXTURE_0]) {
            continue;
        }
        VkDescriptorType type = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
        if (i == COMPUTE_BIND_UNIFORM) {
            type = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        } else if (i >= COMPUTE_BIND_TEXTURE_0) {
            type = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
        }
        bindings[count++] = (VkDescriptorSetLayoutBinding){
            .binding = i, .descriptorType = type, .descriptorCount = 1, .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    const VkDescriptorSetLayoutCreateInfo set_layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = count, .pBindings = bindings};
    if (!ok(vkCreateDescriptorSetLayout(device->device, &set_layout, NULL, &r->set_layout), "set layout")) {
        return false;
    }
    const VkPushConstantRange range = {.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT, .size = sizeof(uint32_t)};
    const VkPipelineLayoutCreateInfo layout = {.sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO,
                                               .setLayoutCount = 1,
                                               .pSetLayouts = &r->set_layout,
                                               .pushConstantRangeCount = 1,
                                               .pPushConstantRanges = &range};
    const VkShaderModuleCreateInfo module = {
        .sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO, .codeSize = job->spirv_bytes, .pCode = job->spirv};
    if (!ok(vkCreatePipelineLayout(device->device, &layout, NULL, &r->layout), "vkCreatePipelineLayout") ||
        !ok(vkCreateShaderModule(device->device, &module, NULL, &r->module), "vkCreateShaderModule")) {
        return false;
    }
    const VkComputePipelineCreateInfo pipeline = {
        .sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                  .module = r->module,
                  .pName = "main"},
        .layout = r->layout};
    return ok(vkCreateComputePipelines(device->device, VK_NULL_HANDLE, 1, &pipeline, NULL, &r->pipeline), "pipeline");
}

static bool create_set(compute_device *device, const compute_job *job, run *r) {
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 2},
                                          {VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 1},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, COMPUTE_TEXTURES}};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 3, .pPoolSizes = sizes};
    if (!ok(vkCreateDescriptorPool(device->device, &pool, NULL, &r->pool), "vkCreateDescriptorPool")) {
        return false;
    }
    const VkDescriptorSetAllocateInfo set = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                             .descriptorPool = r->pool,
                                             .descriptorSetCount = 1,
                                             .pSetLayouts = &r->set_layout};
    if (!ok(vkAllocateDescriptorSets(device->device, &set, &r->set), "vkAllocateDescriptorSets")) {
        return false;
    }
    VkPhysicalDeviceProperties properties;
    vkGetPhysicalDeviceProperties(device->physical, &properties);
    VkDescriptorBufferInfo buffers[COMPUTE_BIND_TEXTURE_0] = {{.buffer = r->input.buffer, .range = VK_WHOLE_SIZE},
                                                              {.buffer = r->output.buffer, .range = VK_WHOLE_SIZE},
                                                              {.buffer = r->input.buffer, .range = job->input_bytes}};
    VkDescriptorImageInfo images[COMPUTE_TEXTURES];
    for (uint32_t i = 0; i < COMPUTE_BIND_COUNT; i++) {
        VkWriteDescriptorSet write = {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                      .dstSet = r->set,
                                      .dstBinding = i,
                                      .descriptorCount = 1,
                                      .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
        if (i < COMPUTE_BIND_TEXTURE_0) {
            write.pBufferInfo = &buffers[i];
        }
        if (i == COMPUTE_BIND_UNIFORM) {
            write.descriptorType = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
            if (job->input_bytes > properties.limits.maxUniformBufferRange) {
                continue;
            }
        }
        if (i >= COMPUTE_BIND_TEXTURE_0) {
            uint32_t n = i - COMPUTE_BIND_TEXTURE_0;
            if (!job->textures[n]) {
                continue;
            }
            images[n] = (VkDescriptorImageInfo){.sampler = device->sampler,
                                                .imageView = job->textures[n]->view,
                                                .imageLayout = VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL};
            write.descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER;
            write.pImageInfo = &images[n];
        }
        vkUpdateDescriptorSets(device->device, 1, &write, 0, NULL);
    }
    return true;
}

static bool record(compute_device *device, const compute_job *job, run *r) {
    if (!begin(device, &r->commands)) {
        return false;
    }
    vkCmdBindPipeline(r->commands, VK_PIPELINE_BIND_POINT_COMPUTE, r->pipeline);
    vkCmdBindDescriptorSets(r->commands, VK_PIPELINE_BIND_POINT_COMPUTE, r->layout, 0, 1, &r->set, 0, NULL);
    vkCmdPushConstants(r->commands, r->layout, VK_SHADER_STAGE_COMPUTE_BIT, 0, sizeof job->invocations,
                       &job->invocations);
    vkCmdDispatch(r->commands, (job->invocations + COMPUTE_GROUP - 1) / COMPUTE_GROUP, 1, 1);
    const VkMemoryBarrier barrier = {.sType = VK_STRUCTURE_TYPE_MEMORY_BARRIER,
                                     .srcAccessMask = VK_ACCESS_SHADER_WRITE_BIT,
                                     .dstAccessMask = VK_ACCESS_HOST_READ_BIT};
    vkCmdPipelineBarrier(r->commands, VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT, VK_PIPELINE_STAGE_HOST_BIT, 0, 1, &barrier,
                         0, NULL, 0, NULL);
    return ok(vkEndCommandBuffer(r->commands), "vkEndCommandBuffer");
}

static double now_s(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

bool compute_run(compute_device *device, compute_job *job) {
    run r = {0};
    bool done = false;
    const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT;
    if (!buffer_create(device, job->input_bytes, usage, &r.input) ||
        !buffer_create(device, job->output_bytes, usage, &r.output)) {
        goto error;
    }
    memcpy(r.input.mapped, job->input, job->input_bytes);
    memset(r.output.mapped, 0xa5, job->output_bytes);
    if (!create_pipeline(device, job, &r) || !create_set(device, job, &r) || !record(device, job, &r)) {
        goto error;
    }
    job->seconds = 1e9;
    for (uint32_t i = 0; i < (job->repeats ? job->repeats : 1); i++) {
        double start = now_s();
        if (!submit(device, r.commands)) {
            goto error;
        }
        double taken = now_s() - start;
        job->seconds = taken < job->seconds ? taken : job->seconds;
    }
    memcpy(job->output, r.output.mapped, job->output_bytes);
    done = true;
error:
    if (r.commands) {
        vkFreeCommandBuffers(device->device, device->pool, 1, &r.commands);
    }
    vkDestroyDescriptorPool(device->device, r.pool, NULL);
    vkDestroyPipeline(device->device, r.pipeline, NULL);
    vkDestroyShaderModule(device->device, r.module, NULL);
    vkDestroyPipelineLayout(device->device, r.layout, NULL);
    vkDestroyDescriptorSetLayout(device->device, r.set_layout, NULL);
    buffer_destroy(device, &r.output);
    buffer_destroy(device, &r.input);
    return done;
}
