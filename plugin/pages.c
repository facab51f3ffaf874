#include "pages.h"

#include <stdlib.h>
#include <string.h>

#include "core/tile_bounds.h"
#include "core/tile_spans.h"

_Static_assert(PAGES_MAX % VELUM_PAGES_A_LAYER == 0, "layers are full");

enum { SPAN_BYTES = VELUM_SPAN_WORDS * sizeof(uint32_t) };

void *stage_take(stage *s, VkDeviceSize size, VkDeviceSize *offset) {
    VkDeviceSize start = (s->used + 63u) & ~(VkDeviceSize)63u;
    if (start > s->buffer.size || s->buffer.size - start < size) {
        return NULL;
    }
    *offset = start;
    s->used = start + size;
    return (char *)s->buffer.mapped + start;
}

bool pages_init(pages *p, gpu *g, VkDeviceSize stage_bytes) {
    *p = (pages){0};
    p->copy_capacity = (uint32_t)(stage_bytes / (2 * CORE_TILE_PAGE_BYTES)) + 1;
    p->page = calloc(PAGES_MAX, sizeof *p->page);
    p->names = calloc(PAGES_NAMES, sizeof *p->names);
    p->buckets = calloc(PAGES_BUCKETS, sizeof *p->buckets);
    p->copies_a = calloc(p->copy_capacity, sizeof *p->copies_a);
    p->copies_b = calloc(p->copy_capacity, sizeof *p->copies_b);
    p->copies_spans = calloc(p->copy_capacity, sizeof *p->copies_spans);
    const gpu_image_desc desc = {.format = VK_FORMAT_R16G16B16A16_UNORM,
                                 .type = VK_IMAGE_TYPE_2D,
                                 .view_type = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                 .extent = {VELUM_TILE_SIDE * VELUM_PAGE_COLUMNS, VELUM_TILE_SIDE * VELUM_PAGE_ROWS, 1},
                                 .layers = PAGES_MAX / VELUM_PAGES_A_LAYER,
                                 .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    if (!p->page || !p->names || !p->buckets || !p->copies_a || !p->copies_b || !p->copies_spans) {
        g->result = VK_ERROR_OUT_OF_HOST_MEMORY;
        return false;
    }
    return gpu_image_init(g, &p->a, &desc) && gpu_image_init(g, &p->b, &desc) &&
           gpu_buffer_init(g, &p->spans, PAGES_MAX * SPAN_BYTES,
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, GPU_MEMORY_DEVICE);
}

void pages_finish(pages *p, gpu *g) {
    gpu_image_finish(g, &p->a);
    gpu_image_finish(g, &p->b);
    free(p->page);
    free(p->names);
    free(p->buckets);
    free(p->copies_a);
    free(p->copies_b);
    free(p->copies_spans);
    free(p->copies_bounds);
    free(p->known);
    gpu_buffer_finish(g, &p->spans);
    gpu_buffer_finish(g, &p->bounds);
    *p = (pages){0};
}

void pages_begin_frame(pages *p) {
    p->frame++;
    p->used_now = 0;
}

static void touch(pages *p, uint32_t index) {
    if (p->page[index].frame != p->frame) {
        p->page[index].frame = p->frame;
        p->used_now++;
    }
}

bool pages_keep(pages *p, uint32_t index, uint64_t contents) {
    if (index >= PAGES_MAX || p->page[index].contents != contents) {
        return false;
    }
    touch(p, index);
    return true;
}

bool pages_full(const pages *p, float share) {
    return (float)p->used_now > share * (float)PAGES_MAX;
}

static uint64_t mix(uint64_t h) {
    h ^= h >> 31;
    h *= 0xbf58476d1ce4e5b9u;
    return h ^ (h >> 29);
}

/* What the page of a slot holds; a fringe has one texture of its own. */
static void texels_of(const core_tile *tile, uint32_t slot, const uint16_t *sides[2]) {
    const core_tile_slot *from = &tile->slot[slot % VELUM_SLOT_COUNT];
    sides[0] = slot < VELUM_SLOT_COUNT ? from->a : from->fringe;
    sides[1] = slot < VELUM_SLOT_COUNT ? from->b : from->fringe;
}

static void hash(uint64_t *h, const void *bytes, size_t count) {
    for (size_t i = 0; i < count; i += 8) {
        uint64_t word;
        memcpy(&word, (const char *)bytes + i, sizeof word);
        *h = (*h ^ word) * 0x9e3779b97f4a7c15u;
        *h ^= *h >> 32;
    }
}

/* Of key, slot and texels; bounds and spans of a fringe depend on its cloud, too. Never 0. */
static uint64_t contents_of(const core_tile *tile, uint32_t slot) {
    uint64_t h = mix(((uint64_t)tile->key << 8) | slot | 0x5a00000000000000u);
    const uint16_t *sides[2];
    texels_of(tile, slot, sides);
    hash(&h, sides[0], CORE_TILE_PAGE_BYTES);
    hash(&h, sides[1], CORE_TILE_PAGE_BYTES);
    if (slot >= VELUM_SLOT_COUNT) {
        velum_page_bounds bounds;
        core_tile_fringe_bounds(tile, slot - VELUM_SLOT_COUNT, &bounds);
        hash(&h, &bounds, sizeof bounds);
        uint32_t spans[VELUM_SPAN_WORDS];
        core_tile_spans(tile, slot, spans);
        hash(&h, spans, sizeof spans);
    }
    h = mix(h);
    return h ? h : 1;
}

static page_name *name_of(pages *p, const core_tile *tile, uint32_t slot) {
    uint64_t h = mix(tile->state * 0x9e3779b97f4a7c15u ^ ((uint64_t)tile->key << 8 | slot));
    page_name *name = &p->names[h & (PAGES_NAMES - 1)];
    if (name->contents == 0 || name->state != tile->state || name->key != tile->key || name->slot != slot) {
        *name = (page_name){tile->state, contents_of(tile, slot), tile->key, slot};
    }
    return name;
}

static uint32_t *bucket_of(pages *p, uint64_t contents) {
    return &p->buckets[(contents >> 17) & (PAGES_BUCKETS - 1)];
}

static void evict(pages *p, uint32_t index) {
    if (p->page[index].contents) {
        uint32_t *at = bucket_of(p, p->page[index].contents);
        while (*at != index + 1) {
            at = &p->page[*at - 1].next;
        }
        *at = p->page[index].next;
        p->page[index] = (page_entry){0};
    }
}

static VkBufferImageCopy copy_of(VkDeviceSize offset, uint32_t index) {
    const uint32_t column = index % VELUM_PAGE_COLUMNS, row = index / VELUM_PAGE_COLUMNS % VELUM_PAGE_ROWS;
    return (VkBufferImageCopy){
        .bufferOffset = offset,
        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, index / VELUM_PAGES_A_LAYER, 1},
        .imageOffset = {(int32_t)(column * VELUM_TILE_SIDE), (int32_t)(row * VELUM_TILE_SIDE), 0},
        .imageExtent = {VELUM_TILE_SIDE, VELUM_TILE_SIDE, 1}};
}

bool pages_want_bounds(pages *p, gpu *g) {
    if (p->has_bounds) {
        return true;
    }
    p->copies_bounds = calloc(p->copy_capacity, sizeof *p->copies_bounds);
    p->known = calloc(PAGES_MAX, sizeof *p->known);
    if (!p->copies_bounds || !p->known) {
        free(p->copies_bounds);
        free(p->known);
        p->copies_bounds = NULL;
        p->known = NULL;
        g->result = VK_ERROR_OUT_OF_HOST_MEMORY;
        return false;
    }
    if (!gpu_buffer_init(g, &p->bounds, PAGES_MAX * sizeof(velum_page_bounds),
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, GPU_MEMORY_DEVICE)) {
        free(p->copies_bounds);
        free(p->known);
        p->copies_bounds = NULL;
        p->known = NULL;
        return false;
    }
    for (uint32_t i = 0; i < PAGES_MAX; i++) {
        evict(p, i);
    }
    p->has_bounds = true;
    return true;
}

uint32_t pages_get(pages *p, stage *s, const core_tile *tile, uint32_t slot, uint64_t *contents) {
    *contents = name_of(p, tile, slot)->contents;
    uint32_t *bucket = bucket_of(p, *contents);
    for (uint32_t i = *bucket; i != 0; i = p->page[i - 1].next) {
        if (p->page[i - 1].contents == *contents) {
            touch(p, i - 1);
            return i - 1;
        }
    }
    uint32_t oldest = VELUM_PAGE_NONE;
    for (uint32_t i = 0; i < PAGES_MAX; i++) {
        if (p->page[i].frame != p->frame && (oldest == VELUM_PAGE_NONE || p->page[i].frame < p->page[oldest].frame)) {
            oldest = i;
            if (p->page[i].contents == 0) {
                break;
            }
        }
    }
    VkDeviceSize offset = 0;
    if (oldest == VELUM_PAGE_NONE || p->copy_count == p->copy_capacity ||
        s->used + s->reserve + 2 * CORE_TILE_PAGE_BYTES + SPAN_BYTES > s->buffer.size) {
        return VELUM_PAGE_NONE;
    }
    const VkDeviceSize texels = 2 * CORE_TILE_PAGE_BYTES;
    char *bytes = stage_take(s, texels + SPAN_BYTES + (p->has_bounds ? sizeof(velum_page_bounds) : 0), &offset);
    if (!bytes) {
        return VELUM_PAGE_NONE;
    }
    const uint16_t *sides[2];
    texels_of(tile, slot, sides);
    memcpy(bytes, sides[0], CORE_TILE_PAGE_BYTES);
    memcpy(bytes + CORE_TILE_PAGE_BYTES, sides[1], CORE_TILE_PAGE_BYTES);
    uint32_t spans[VELUM_SPAN_WORDS];
    core_tile_spans(tile, slot, spans);
    memcpy(bytes + texels, spans, sizeof spans);
    p->copies_spans[p->copy_count] = (VkBufferCopy){offset + texels, oldest * sizeof spans, sizeof spans};
    if (p->has_bounds) {
        velum_page_bounds bounds = {0};
        if (slot < VELUM_SLOT_COUNT) {
            core_tile_bounds(tile, slot, &bounds);
        } else {
            core_tile_fringe_bounds(tile, slot - VELUM_SLOT_COUNT, &bounds);
        }
        memcpy(bytes + texels + SPAN_BYTES, &bounds, sizeof bounds);
        p->known[oldest] = bounds;
        p->copies_bounds[p->copy_count] =
            (VkBufferCopy){offset + texels + SPAN_BYTES, oldest * sizeof bounds, sizeof bounds};
    }
    evict(p, oldest);
    p->page[oldest] = (page_entry){.contents = *contents, .next = *bucket};
    *bucket = oldest + 1;
    touch(p, oldest);
    p->copies_a[p->copy_count] = copy_of(offset, oldest);
    p->copies_b[p->copy_count] = copy_of(offset + CORE_TILE_PAGE_BYTES, oldest);
    p->copy_count++;
    p->uploaded++;
    return oldest;
}

void pages_record(pages *p, gpu *g, VkCommandBuffer commands, VkBuffer staged) {
    if (p->copy_count > 0) {
        g->CmdCopyBufferToImage(commands, staged, p->a.image, VK_IMAGE_LAYOUT_GENERAL, p->copy_count, p->copies_a);
        g->CmdCopyBufferToImage(commands, staged, p->b.image, VK_IMAGE_LAYOUT_GENERAL, p->copy_count, p->copies_b);
        g->CmdCopyBuffer(commands, staged, p->spans.buffer, p->copy_count, p->copies_spans);
        if (p->has_bounds) {
            g->CmdCopyBuffer(commands, staged, p->bounds.buffer, p->copy_count, p->copies_bounds);
        }
    }
    p->copy_count = 0;
}
