/* What a frame in flight owns: its share of the uniforms, a stage, descriptor sets, timestamps, counters. */
#include <string.h>

#include "engine.h"

bool frame_slot_init(engine *e, frame_slot *slot, uint32_t index) {
    gpu *g = &e->g;
    slot->uniform_first = (VkDeviceSize)index * FRAME_UNIFORM_BYTES;
    VkDeviceSize bytes = STAGE_TOTAL_BYTES / e->frames_in_flight;
    if (!gpu_buffer_init(g, &slot->staged.buffer, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, GPU_MEMORY_UPLOAD) ||
        !gpu_buffer_init(g, &slot->counters, (VkDeviceSize)FRAME_RECORDS * COUNTER_STRIDE,
                         VK_BUFFER_USAGE_TRANSFER_DST_BIT, GPU_MEMORY_READBACK)) {
        return false;
    }
    slot->staged.reserve = bytes / 4;
    if (g->has_timestamps) {
        VkQueryPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO,
                                      .queryType = VK_QUERY_TYPE_TIMESTAMP,
                                      .queryCount = FRAME_QUERIES};
        if (!VK(g, CreateQueryPool(g->device, &info, NULL, &slot->queries))) {
            slot->queries = VK_NULL_HANDLE;
            return false;
        }
    }
    return true;
}

void frame_slot_finish(engine *e, frame_slot *slot) {
    gpu *g = &e->g;
    gpu_buffer_finish(g, &slot->staged.buffer);
    gpu_buffer_finish(g, &slot->counters);
    for (uint32_t i = 0; i < FRAME_POOLS; i++) {
        if (slot->pool[i]) {
            g->DestroyDescriptorPool(g->device, slot->pool[i], NULL);
        }
    }
    if (slot->queries) {
        g->DestroyQueryPool(g->device, slot->queries, NULL);
    }
    *slot = (frame_slot){0};
}

bool frame_slot_begin(engine *e, frame_slot *slot) {
    slot->staged.used = 0;
    slot->uniform_used = 0;
    slot->pool_now = 0;
    slot->query_count = 0;
    slot->shared_query = FRAME_QUERIES;
    slot->shadow_queries = 0;
    slot->record_count = 0;
    for (uint32_t i = 0; i < FRAME_POOLS && slot->pool[i]; i++) {
        if (!VK(&e->g, ResetDescriptorPool(e->g.device, slot->pool[i], 0))) {
            return false;
        }
    }
    return true;
}

bool frame_uniform(engine *e, const void *block, uint32_t size, uint32_t *offset) {
    VkDeviceSize alignment = e->g.properties.limits.minUniformBufferOffsetAlignment;
    frame_slot *slot = e->now;
    VkDeviceSize start = (slot->uniform_used + alignment - 1) / alignment * alignment;
    if (start + size > FRAME_UNIFORM_BYTES) {
        log_fail(&e->sink, VELUM_ERROR_OUT_OF_MEMORY, "engine",
                 "too many views in one frame: no room for their blocks");
        return false;
    }
    memcpy((char *)e->uniforms.mapped + slot->uniform_first + start, block, size);
    slot->uniform_used = start + size;
    *offset = (uint32_t)(slot->uniform_first + start);
    return true;
}

static bool create_pool(gpu *g, VkDescriptorPool *out) {
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, 2 * FRAME_POOL_SETS},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 5 * FRAME_POOL_SETS},
                                          {VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER, 3 * FRAME_POOL_SETS},
                                          {VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 8 * FRAME_POOL_SETS},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_IMAGE, 7 * FRAME_POOL_SETS}};
    VkDescriptorPoolCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO,
                                       .maxSets = FRAME_POOL_SETS,
                                       .poolSizeCount = sizeof sizes / sizeof sizes[0],
                                       .pPoolSizes = sizes};
    if (!VK(g, CreateDescriptorPool(g->device, &info, NULL, out))) {
        *out = VK_NULL_HANDLE;
        return false;
    }
    return true;
}

bool frame_set(engine *e, VkDescriptorSetLayout layout, VkDescriptorSet *out) {
    gpu *g = &e->g;
    frame_slot *slot = e->now;
    for (; slot->pool_now < FRAME_POOLS; slot->pool_now++) {
        VkDescriptorPool *pool = &slot->pool[slot->pool_now];
        if (!*pool && !create_pool(g, pool)) {
            return false;
        }
        VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                            .descriptorPool = *pool,
                                            .descriptorSetCount = 1,
                                            .pSetLayouts = &layout};
        VkResult result = g->AllocateDescriptorSets(g->device, &info, out);
        if (result == VK_SUCCESS) {
            return true;
        }
        if (result != VK_ERROR_OUT_OF_POOL_MEMORY && result != VK_ERROR_FRAGMENTED_POOL) {
            return gpu_check(g, result, "AllocateDescriptorSets", __FILE__, __LINE__);
        }
    }
    g->result = VK_ERROR_OUT_OF_POOL_MEMORY;
    log_write(&e->sink, VELUM_LOG_ERROR, "engine", "too many views in one frame: no descriptor sets are left");
    return false;
}

uint32_t frame_queries(engine *e, uint32_t count) {
    frame_slot *slot = e->now;
    if (!slot->queries || slot->query_count + count > FRAME_QUERIES) {
        return FRAME_QUERIES;
    }
    slot->query_count += count;
    return slot->query_count - count;
}

void frame_timestamp(engine *e, VkCommandBuffer commands, uint32_t query) {
    if (query < FRAME_QUERIES) {
        e->g.CmdWriteTimestamp2(commands, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, e->now->queries, query);
    }
}

bool frame_engine_set(engine *e, const gpu_image *sky, VkDescriptorSet *out) {
    gpu *g = &e->g;
    const pipelines *p = &e->passes;
    if (!frame_set(e, p->set_engine, out)) {
        return false;
    }
    const shadow *s = e->bound_shadow;
    const VkDescriptorImageInfo images[VELUM_BIND_COUNT] = {
        [VELUM_BIND_TILES_A] = {p->linear, e->pages.a.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_TILES_B] = {p->linear, e->pages.b.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_SHAPE] = {p->repeat, e->shape.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_DETAIL] = {p->repeat, e->detail.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_AIR] = {p->linear, e->air.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_AIR_OUT] = {VK_NULL_HANDLE, e->air.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_SKY] = {p->linear, sky->view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_SKY_OUT] = {VK_NULL_HANDLE, sky->view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_GLOW] = {p->linear, e->glow.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_GLOW_OUT] = {VK_NULL_HANDLE, e->glow.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_SHADOW] = {p->linear, s ? s->image.view : e->white.view, VK_IMAGE_LAYOUT_GENERAL},
        [VELUM_BIND_SCATTERING] = {p->linear, e->scattering.view, VK_IMAGE_LAYOUT_GENERAL}};
    const VkDescriptorBufferInfo buffers[VELUM_BIND_COUNT] = {
        [VELUM_BIND_EYE] = {e->uniforms.buffer, 0, sizeof(velum_eye_block)},
        [VELUM_BIND_TABLE] = {e->tables.buffer.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_SPANS] = {e->pages.spans.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_SHADOW_BLOCK] = {e->uniforms.buffer, 0, sizeof(velum_shadow_block)}};
    VkWriteDescriptorSet writes[VELUM_BIND_COUNT];
    for (uint32_t i = 0; i < VELUM_BIND_COUNT; i++) {
        bool is_buffer = buffers[i].buffer != VK_NULL_HANDLE;
        bool is_words = i == VELUM_BIND_TABLE || i == VELUM_BIND_SPANS;
        bool is_storage = i == VELUM_BIND_AIR_OUT || i == VELUM_BIND_SKY_OUT || i == VELUM_BIND_GLOW_OUT;
        writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                           .dstSet = *out,
                                           .dstBinding = i,
                                           .descriptorCount = 1,
                                           .descriptorType = is_words     ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                                             : is_buffer  ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC
                                                             : is_storage ? VK_DESCRIPTOR_TYPE_STORAGE_IMAGE
                                                                          : VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                           .pImageInfo = is_buffer ? NULL : &images[i],
                                           .pBufferInfo = is_buffer ? &buffers[i] : NULL};
    }
    g->UpdateDescriptorSets(g->device, VELUM_BIND_COUNT, writes, 0, NULL);
    return true;
}
