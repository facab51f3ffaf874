#include "renderer.h"

#include "cache.h"
#include "report.h"
#include "shaders/host_arguments.h"
#include "text.h"

#include "compose_spirv.h"
#include "ground_spirv.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static bool select_channels(struct renderer *renderer, const struct options *options) {
    const velum_scenario *scenario = renderer->scene->scenario;
    uint32_t wanted = options->channel_count ? options->channel_count : scenario->channel_count;
    if (wanted == 0) {
        report_error("%s: the scenario has no channel", options->scenario);
        return false;
    }
    renderer->channels = calloc(wanted, sizeof *renderer->channels);
    if (!renderer->channels) {
        report_error("out of memory");
        return false;
    }
    for (uint32_t i = 0; i < wanted; i++) {
        uint32_t from = 0;
        if (options->channel_count) {
            while (from < scenario->channel_count && strcmp(scenario->channels[from].name, options->channels[i]) != 0) {
                from++;
            }
        } else {
            from = i;
        }
        if (from == scenario->channel_count) {
            report_error("--channels: found '%s', which is no channel of %s", options->channels[i], options->scenario);
            return false;
        }
        struct renderer_channel *channel = &renderer->channels[i];
        channel->info = scenario->channels[from];
        channel->width = options->width ? options->width : channel->info.width;
        channel->height = options->height ? options->height : channel->info.height;
        uint32_t most = renderer->device->properties.limits.maxImageDimension2D;
        if (channel->width > most || channel->height > most) {
            report_error("channel '%s': %ux%u; the device takes at most %ux%u", channel->info.name, channel->width,
                         channel->height, most, most);
            return false;
        }
    }
    renderer->channel_count = wanted;
    return true;
}

static void find_cache(struct renderer *renderer) {
    VkPhysicalDeviceIDProperties id = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_ID_PROPERTIES};
    VkPhysicalDeviceProperties2 properties = {.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &id};
    vkGetPhysicalDeviceProperties2(renderer->device->physical, &properties);
    cache_path(id.deviceUUID, properties.properties.driverVersion, renderer->cache_path);
}

static void keep_cache(struct renderer *renderer) {
    struct plugin *plugin = &renderer->scene->plugin;
    uint64_t size = 0;
    void *blob = NULL;
    if (!renderer->cache_path[0]) {
        return;
    }
    if (plugin->vulkan->get_pipeline_cache(renderer->engine, NULL, &size) >= 0 && (blob = malloc((size_t)size)) &&
        plugin->vulkan->get_pipeline_cache(renderer->engine, blob, &size) >= 0) {
        cache_write(renderer->cache_path, blob, (size_t)size);
    }
    free(blob);
    plugin->message[0] = '\0'; /* a cache that cannot be had is no failure */
}

static bool create_engine(struct renderer *renderer, const struct renderer_info *info) {
    struct device *device = renderer->device;
    struct plugin *plugin = &renderer->scene->plugin;
    size_t cache_size = 0;
    void *cache = NULL;
    if (!info->options->no_cache) {
        find_cache(renderer);
        cache = renderer->cache_path[0] ? cache_read(renderer->cache_path, &cache_size) : NULL;
    }
    const velum_vulkan_lend lend = {.struct_size = sizeof lend,
                                    .world = renderer->scene->world,
                                    .log = plugin_log,
                                    .log_context = plugin,
                                    .get_instance_proc_addr = vkGetInstanceProcAddr,
                                    .instance = device->instance,
                                    .physical_device = device->physical,
                                    .device = device->handle,
                                    .api_version = VK_API_VERSION_1_3,
                                    .queue_family = device->family,
                                    .frames_in_flight = renderer->slot_count,
                                    .enabled_extension_count = device->extension_count,
                                    .enabled_extensions = device->extensions,
                                    .enabled_features = &device->features,
                                    .pipeline_cache = cache,
                                    .pipeline_cache_size = cache ? cache_size : 0};
    const char *what = "engine";
    velum_result result = plugin->vulkan->create_engine(&lend, &renderer->engine);
    free(cache);
    if (result >= 0) {
        const velum_eye_desc eye = {.struct_size = sizeof eye,
                                    .quality = info->options->quality,
                                    .budget_ms = (float)info->options->budget_ms,
                                    .budget_error = (float)info->options->budget_error};
        what = "eye";
        result = plugin->engine->create_eye(renderer->engine, &eye, &renderer->eye);
    }
    if (result >= 0) {
        const velum_shadow_desc shadow = {.struct_size = sizeof shadow};
        what = "shadow map";
        result = plugin->engine->create_shadow(renderer->engine, &shadow, &renderer->shadow);
    }
    for (uint32_t i = 0; result >= 0 && i < renderer->channel_count; i++) {
        struct renderer_channel *channel = &renderer->channels[i];
        const velum_view_desc view = {
            .struct_size = sizeof view, .width = channel->width, .height = channel->height, .name = channel->info.name};
        what = channel->info.name;
        result = plugin->engine->create_view(renderer->eye, &view, &channel->view);
    }
    if (result < 0) {
        plugin_report(plugin, what, result);
    }
    return result >= 0;
}

static bool create_images(struct renderer *renderer, struct renderer_channel *channel, bool readback) {
    struct device *device = renderer->device;
    const VkFormat colour = renderer->full_precision ? VK_FORMAT_R32G32B32A32_SFLOAT : VK_FORMAT_R16G16B16A16_SFLOAT;
    uint32_t width = channel->width, height = channel->height;
    if (!gpu_image_create(device, width, height, VK_FORMAT_R32G32B32A32_SFLOAT, &channel->colour) ||
        !gpu_image_create(device, width, height, VK_FORMAT_R32_SFLOAT, &channel->depth) ||
        !gpu_image_create(device, width, height, colour, &channel->luminance) ||
        !gpu_image_create(device, width, height, colour, &channel->transmittance) ||
        !gpu_image_create(device, width, height, VK_FORMAT_R32_SFLOAT, &channel->distance) ||
        !gpu_image_create(device, width, height, VK_FORMAT_R32_SFLOAT, &channel->variance) ||
        !gpu_image_create(device, width, height, VK_FORMAT_R8G8B8A8_UNORM, &channel->picture)) {
        return false;
    }
    for (uint32_t s = 0; s < renderer->slot_count; s++) {
        if (!gpu_buffer_create(device, sizeof(struct host_view_arguments), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, false,
                               &channel->arguments[s]) ||
            !gpu_buffer_create(device, TEXT_BITS_SIZE(RENDERER_LINE_MAX), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, false,
                               &channel->overlay[s])) {
            return false;
        }
    }
    VkDeviceSize pixels = (VkDeviceSize)width * height;
    VkDeviceSize texel = renderer->full_precision ? 16 : 0;
    channel->luminance_at = (pixels * 4 + 15) / 16 * 16;
    channel->transmittance_at = channel->luminance_at + pixels * texel;
    channel->distance_at = channel->transmittance_at + pixels * texel;
    channel->variance_at = channel->distance_at + pixels * texel / 4;
    return !readback || gpu_buffer_create(device, channel->variance_at + pixels * texel / 4,
                                          VK_BUFFER_USAGE_TRANSFER_DST_BIT, true, &channel->readback);
}

static bool create_slots(struct renderer *renderer) {
    VkDevice device = renderer->device->handle;
    for (uint32_t s = 0; s < renderer->slot_count; s++) {
        struct renderer_slot *slot = &renderer->slots[s];
        const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                              .queueFamilyIndex = renderer->device->family};
        if (!device_ok(vkCreateCommandPool(device, &pool, NULL, &slot->pool), "vkCreateCommandPool")) {
            slot->pool = VK_NULL_HANDLE;
            return false;
        }
        const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                      .commandPool = slot->pool,
                                                      .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                      .commandBufferCount = 1};
        if (!device_ok(vkAllocateCommandBuffers(device, &commands, &slot->commands), "vkAllocateCommandBuffers") ||
            !gpu_buffer_create(renderer->device, sizeof(velum_shadow_block), VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, false,
                               &slot->shadow_block)) {
            return false;
        }
    }
    const VkSemaphoreTypeCreateInfo type = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO,
                                            .semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE};
    const VkSemaphoreCreateInfo semaphore = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, .pNext = &type};
    return device_ok(vkCreateSemaphore(device, &semaphore, NULL, &renderer->timeline), "vkCreateSemaphore");
}

static bool create_layout(struct renderer *renderer) {
    static const VkDescriptorType types[] = {
        [HOST_BINDING_VIEW] = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
        [HOST_BINDING_SHADOW_BLOCK] = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER,
        [HOST_BINDING_SHADOW_MAP] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [HOST_BINDING_COLOUR] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [HOST_BINDING_DEPTH] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [HOST_BINDING_LUMINANCE] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [HOST_BINDING_TRANSMITTANCE] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [HOST_BINDING_PICTURE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [HOST_BINDING_OVERLAY] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
    };
    enum { COUNT = sizeof types / sizeof types[0] };
    const uint32_t depth_only = VK_FALSE;
    VkDevice device = renderer->device->handle;
    uint32_t sets = renderer->channel_count * renderer->slot_count;
    VkDescriptorSetLayoutBinding bindings[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        bindings[i] = (VkDescriptorSetLayoutBinding){
            .binding = i, .descriptorType = types[i], .descriptorCount = 1, .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = COUNT, .pBindings = bindings};
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER, 2 * sets},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 3 * sets},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 3 * sets},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, sets}};
    const VkDescriptorPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                             .maxSets = sets,
                                             .poolSizeCount = 4,
                                             .pPoolSizes = sizes};
    const VkSamplerCreateInfo sampler = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                         .addressModeU = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                         .addressModeV = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE,
                                         .addressModeW = VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE};
    return device_ok(vkCreateDescriptorSetLayout(device, &layout, NULL, &renderer->set_layout),
                     "vkCreateDescriptorSetLayout") &&
           device_ok(vkCreateDescriptorPool(device, &pool, NULL, &renderer->descriptors), "vkCreateDescriptorPool") &&
           device_ok(vkCreateSampler(device, &sampler, NULL, &renderer->sampler), "vkCreateSampler") &&
           gpu_pipeline_create(renderer->device, ground_spirv, sizeof ground_spirv, NULL, renderer->set_layout,
                               &renderer->ground) &&
           gpu_pipeline_create(renderer->device, ground_spirv, sizeof ground_spirv, &depth_only, renderer->set_layout,
                               &renderer->ground_depth) &&
           gpu_pipeline_create(renderer->device, compose_spirv, sizeof compose_spirv, NULL, renderer->set_layout,
                               &renderer->compose);
}

static void write_set(struct renderer *renderer, struct renderer_channel *channel, uint32_t slot,
                      const velum_vulkan_shadow *shadow) {
    enum { COUNT = HOST_BINDING_OVERLAY + 1 };
    const VkDescriptorBufferInfo buffers[COUNT] = {
        [HOST_BINDING_VIEW] = {channel->arguments[slot].handle, 0, VK_WHOLE_SIZE},
        [HOST_BINDING_SHADOW_BLOCK] = {renderer->slots[slot].shadow_block.handle, 0, VK_WHOLE_SIZE},
        [HOST_BINDING_OVERLAY] = {channel->overlay[slot].handle, 0, VK_WHOLE_SIZE}};
    const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
    const VkDescriptorImageInfo images[COUNT] = {
        [HOST_BINDING_SHADOW_MAP] = {shadow->sampler, shadow->view, general},
        [HOST_BINDING_COLOUR] = {VK_NULL_HANDLE, channel->colour.view, general},
        [HOST_BINDING_DEPTH] = {VK_NULL_HANDLE, channel->depth.view, general},
        [HOST_BINDING_LUMINANCE] = {renderer->sampler, channel->luminance.view, general},
        [HOST_BINDING_TRANSMITTANCE] = {renderer->sampler, channel->transmittance.view, general},
        [HOST_BINDING_PICTURE] = {VK_NULL_HANDLE, channel->picture.view, general}};
    VkWriteDescriptorSet writes[COUNT];
    for (uint32_t i = 0; i < COUNT; i++) {
        bool sampled = i == HOST_BINDING_SHADOW_MAP || i == HOST_BINDING_LUMINANCE || i == HOST_BINDING_TRANSMITTANCE;
        VkDescriptorType type = sampled ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE;
        if (buffers[i].buffer) {
            type = i == HOST_BINDING_OVERLAY ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER : VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER;
        }
        writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                           .dstSet = channel->sets[slot],
                                           .dstBinding = i,
                                           .descriptorCount = 1,
                                           .descriptorType = type,
                                           .pImageInfo = &images[i],
                                           .pBufferInfo = &buffers[i]};
    }
    vkUpdateDescriptorSets(renderer->device->handle, COUNT, writes, 0, NULL);
}

static bool create_sets(struct renderer *renderer) {
    struct plugin *plugin = &renderer->scene->plugin;
    velum_vulkan_shadow shadow = {.struct_size = sizeof shadow};
    velum_result result = plugin->vulkan->get_shadow_image(renderer->shadow, &shadow);
    if (result < 0) {
        plugin_report(plugin, "shadow map", result);
        return false;
    }
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        for (uint32_t s = 0; s < renderer->slot_count; s++) {
            struct renderer_channel *channel = &renderer->channels[i];
            const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                                      .descriptorPool = renderer->descriptors,
                                                      .descriptorSetCount = 1,
                                                      .pSetLayouts = &renderer->set_layout};
            if (!device_ok(vkAllocateDescriptorSets(renderer->device->handle, &info, &channel->sets[s]),
                           "vkAllocateDescriptorSets")) {
                return false;
            }
            write_set(renderer, channel, s, &shadow);
        }
    }
    return true;
}

bool renderer_init(struct renderer *renderer, struct scene *scene, struct device *device,
                   const struct renderer_info *info) {
    *renderer = (struct renderer){
        .scene = scene, .device = device, .slot_count = info->frames_in_flight, .full_precision = info->full_precision};
    if (!select_channels(renderer, info->options) || !create_engine(renderer, info) || !create_slots(renderer) ||
        !create_layout(renderer)) {
        return false;
    }
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        if (!create_images(renderer, &renderer->channels[i], info->readback)) {
            return false;
        }
    }
    return create_sets(renderer);
}

static void finish_channel(struct renderer *renderer, struct renderer_channel *channel) {
    struct device *device = renderer->device;
    gpu_image_destroy(device, &channel->colour);
    gpu_image_destroy(device, &channel->depth);
    gpu_image_destroy(device, &channel->luminance);
    gpu_image_destroy(device, &channel->transmittance);
    gpu_image_destroy(device, &channel->distance);
    gpu_image_destroy(device, &channel->variance);
    gpu_image_destroy(device, &channel->picture);
    gpu_buffer_destroy(device, &channel->readback);
    for (uint32_t s = 0; s < RENDERER_SLOTS_MAX; s++) {
        gpu_buffer_destroy(device, &channel->arguments[s]);
        gpu_buffer_destroy(device, &channel->overlay[s]);
    }
}

static void destroy_engine(struct renderer *renderer) {
    struct plugin *plugin = &renderer->scene->plugin;
    velum_result result = VELUM_OK;
    plugin->engine->complete(renderer->engine, renderer->begun);
    keep_cache(renderer);
    for (uint32_t i = 0; result >= 0 && i < renderer->channel_count; i++) {
        result = plugin->engine->destroy_view(renderer->channels[i].view);
    }
    if (result >= 0) {
        result = plugin->engine->destroy_shadow(renderer->shadow);
    }
    if (result >= 0) {
        result = plugin->engine->destroy_eye(renderer->eye);
    }
    if (result >= 0) {
        result = plugin->engine->destroy(renderer->engine);
    }
    if (result < 0) {
        plugin_report(plugin, "engine", result);
    }
    renderer->engine = NULL;
}

void renderer_finish(struct renderer *renderer) {
    if (!renderer || !renderer->device) {
        return;
    }
    VkDevice device = renderer->device->handle;
    if (device) {
        vkDeviceWaitIdle(device);
    }
    if (renderer->engine) {
        destroy_engine(renderer);
    }
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        finish_channel(renderer, &renderer->channels[i]);
    }
    free(renderer->channels);
    gpu_pipeline_destroy(renderer->device, &renderer->ground);
    gpu_pipeline_destroy(renderer->device, &renderer->ground_depth);
    gpu_pipeline_destroy(renderer->device, &renderer->compose);
    if (device) {
        for (uint32_t s = 0; s < RENDERER_SLOTS_MAX; s++) {
            gpu_buffer_destroy(renderer->device, &renderer->slots[s].shadow_block);
            vkDestroyCommandPool(device, renderer->slots[s].pool, NULL);
        }
        vkDestroySampler(device, renderer->sampler, NULL);
        vkDestroyDescriptorPool(device, renderer->descriptors, NULL);
        vkDestroyDescriptorSetLayout(device, renderer->set_layout, NULL);
        vkDestroySemaphore(device, renderer->timeline, NULL);
    }
    *renderer = (struct renderer){.device = NULL};
}
