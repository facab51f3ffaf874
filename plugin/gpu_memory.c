/* Device memory: few large blocks, cut first-fit. Buffers and images stand in blocks of their own, so
 * bufferImageGranularity has no say. */
#include <stdlib.h>
#include <string.h>

#include "gpu.h"

enum { BLOCK_BYTES = 16 << 20 };

typedef struct span {
    VkDeviceSize offset, size;
} span;

struct gpu_block {
    gpu_block *next;
    VkDeviceMemory memory;
    VkDeviceSize size;
    uint32_t type;
    bool linear;
    void *mapped;
    span *free; /* ascending, never touching */
    uint32_t free_count, free_capacity;
};

static bool insert_free(gpu_block *block, uint32_t at, span s) {
    if (block->free_count == block->free_capacity) {
        uint32_t capacity = block->free_capacity ? 2 * block->free_capacity : 8;
        span *grown = realloc(block->free, capacity * sizeof *grown);
        if (!grown) {
            return false;
        }
        block->free = grown;
        block->free_capacity = capacity;
    }
    memmove(&block->free[at + 1], &block->free[at], (block->free_count - at) * sizeof *block->free);
    block->free[at] = s;
    block->free_count++;
    return true;
}

static void remove_free(gpu_block *block, uint32_t at) {
    block->free_count--;
    memmove(&block->free[at], &block->free[at + 1], (block->free_count - at) * sizeof *block->free);
}

static bool cut(gpu_block *block, VkDeviceSize size, VkDeviceSize alignment, VkDeviceSize *offset) {
    for (uint32_t i = 0; i < block->free_count; i++) {
        span s = block->free[i];
        VkDeviceSize start = (s.offset + alignment - 1) / alignment * alignment;
        VkDeviceSize before = start - s.offset;
        if (s.size < before || s.size - before < size) {
            continue;
        }
        VkDeviceSize after = s.size - before - size;
        if (before > 0 && after > 0) {
            if (!insert_free(block, i + 1, (span){start + size, after})) {
                return false;
            }
            block->free[i].size = before;
        } else if (before > 0) {
            block->free[i].size = before;
        } else if (after > 0) {
            block->free[i] = (span){start + size, after};
        } else {
            remove_free(block, i);
        }
        *offset = start;
        return true;
    }
    return false;
}

static void destroy_block(gpu *g, gpu_block *block) {
    if (block) {
        if (block->memory) {
            g->FreeMemory(g->device, block->memory, NULL);
        }
        free(block->free);
        free(block);
    }
}

static gpu_block *create_block(gpu *g, VkDeviceSize size, uint32_t type, bool linear) {
    gpu_block *block = calloc(1, sizeof *block);
    if (!block || !insert_free(block, 0, (span){0, size})) {
        destroy_block(g, block);
        g->result = VK_ERROR_OUT_OF_HOST_MEMORY;
        return NULL;
    }
    block->size = size;
    block->type = type;
    block->linear = linear;
    VkMemoryAllocateInfo info = {
        .sType = VK_STRUCTURE_TYPE_MEMORY_ALLOCATE_INFO, .allocationSize = size, .memoryTypeIndex = type};
    if (!VK(g, AllocateMemory(g->device, &info, NULL, &block->memory))) {
        block->memory = VK_NULL_HANDLE;
        destroy_block(g, block);
        return NULL;
    }
    if ((g->memory.memoryTypes[type].propertyFlags & VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT) && linear &&
        !VK(g, MapMemory(g->device, block->memory, 0, VK_WHOLE_SIZE, 0, &block->mapped))) {
        destroy_block(g, block);
        return NULL;
    }
    block->next = g->blocks;
    g->blocks = block;
    return block;
}

static bool find_type(const gpu *g, uint32_t bits, gpu_memory_kind kind, uint32_t *type) {
    const VkMemoryPropertyFlags host = VK_MEMORY_PROPERTY_HOST_VISIBLE_BIT | VK_MEMORY_PROPERTY_HOST_COHERENT_BIT;
    const VkMemoryPropertyFlags wanted[3][2] = {
        {VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT, 0}, {host, host}, {host | VK_MEMORY_PROPERTY_HOST_CACHED_BIT, host}};
    for (uint32_t attempt = 0; attempt < 2; attempt++) {
        for (uint32_t i = 0; i < g->memory.memoryTypeCount; i++) {
            VkMemoryPropertyFlags flags = g->memory.memoryTypes[i].propertyFlags;
            if ((bits & (1u << i)) && (flags & wanted[kind][attempt]) == wanted[kind][attempt] &&
                !(flags & VK_MEMORY_PROPERTY_PROTECTED_BIT)) {
                *type = i;
                return true;
            }
        }
    }
    return false;
}

bool gpu_allocate(gpu *g, const VkMemoryRequirements *requirements, gpu_memory_kind kind, bool linear,
                  gpu_allocation *out) {
    uint32_t type = 0;
    if (!find_type(g, requirements->memoryTypeBits, kind, &type)) {
        g->result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
        log_write(g->sink, VELUM_LOG_ERROR, "device", "no memory type of kind %d among 0x%x", (int)kind,
                  requirements->memoryTypeBits);
        return false;
    }
    VkDeviceSize offset = 0;
    gpu_block *block = g->blocks;
    while (block && (block->type != type || block->linear != linear ||
                     !cut(block, requirements->size, requirements->alignment, &offset))) {
        block = block->next;
    }
    if (!block) {
        VkDeviceSize size = requirements->size > BLOCK_BYTES / 2 ? requirements->size : BLOCK_BYTES;
        block = create_block(g, size, type, linear);
        if (!block || !cut(block, requirements->size, requirements->alignment, &offset)) {
            return false;
        }
    }
    *out = (gpu_allocation){block, offset, requirements->size};
    g->allocated_bytes += requirements->size;
    return true;
}

void gpu_release(gpu *g, gpu_allocation *allocation) {
    gpu_block *block = allocation->block;
    if (!block) {
        return;
    }
    g->allocated_bytes -= allocation->size;
    uint32_t i = 0;
    while (i < block->free_count && block->free[i].offset < allocation->offset) {
        i++;
    }
    /* Without memory for the list the range is lost until the block goes: no harm but size. */
    if (insert_free(block, i, (span){allocation->offset, allocation->size})) {
        if (i + 1 < block->free_count && block->free[i].offset + block->free[i].size == block->free[i + 1].offset) {
            block->free[i].size += block->free[i + 1].size;
            remove_free(block, i + 1);
        }
        if (i > 0 && block->free[i - 1].offset + block->free[i - 1].size == block->free[i].offset) {
            block->free[i - 1].size += block->free[i].size;
            remove_free(block, i);
        }
    }
    if (block->free_count == 1 && block->free[0].size == block->size) {
        gpu_block **at = &g->blocks;
        while (*at != block) {
            at = &(*at)->next;
        }
        *at = block->next;
        destroy_block(g, block);
    }
    *allocation = (gpu_allocation){0};
}

VkDeviceMemory gpu_allocation_memory(const gpu_allocation *allocation) {
    return allocation->block->memory;
}

void *gpu_allocation_mapped(const gpu_allocation *allocation) {
    return allocation->block->mapped ? (char *)allocation->block->mapped + allocation->offset : NULL;
}

void gpu_finish(gpu *g) {
    while (g->blocks) {
        gpu_block *next = g->blocks->next;
        destroy_block(g, g->blocks);
        g->blocks = next;
    }
}
