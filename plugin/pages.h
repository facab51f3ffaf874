/* The pages: what tiles look like on the device. Two texture arrays that all eyes of an engine share; a page holds one
 * slot of one tile of one state, and a layer VELUM_PAGES_A_LAYER of them. Pages are known by their contents, so a tile
 * that a commit did not touch keeps its page, and nothing is sent twice. Least recently used out. */
#ifndef PLUGIN_PAGES_H
#define PLUGIN_PAGES_H

#include "core/tile.h"
#include "gpu.h"
#include "shared/reference.h"

enum { PAGES_MAX = 1792, PAGES_NAMES = 1 << 14, PAGES_BUCKETS = 4096 };

typedef struct page_entry {
    uint64_t contents; /* 0: empty */
    uint64_t frame;    /* newest that asked for it */
    uint32_t next;     /* of the bucket, + 1 */
} page_entry;

/* What the contents of (state, key, slot) are known to be. */
typedef struct page_name {
    uint64_t state;
    uint64_t contents;
    uint32_t key, slot;
} page_name;

/* Written by the host, copied from by the device: one for each frame in flight. */
typedef struct stage {
    gpu_buffer buffer;
    VkDeviceSize used;
    VkDeviceSize reserve; /* that pages leave to tables */
} stage;

void *stage_take(stage *s, VkDeviceSize size, VkDeviceSize *offset); /* null: full */

typedef struct pages {
    gpu_image a, b;
    uint32_t used_now; /* pages asked for in this frame */
    uint64_t frame;
    uint64_t uploaded; /* since creation */
    page_entry *page;
    page_name *names;
    uint32_t *buckets;                      /* page + 1 */
    VkBufferImageCopy *copies_a, *copies_b; /* of this record call */
    uint32_t copy_count, copy_capacity;
    gpu_buffer spans; /* VELUM_SPAN_WORDS words of each page */
    VkBufferCopy *copies_spans;
    gpu_buffer bounds; /* velum_page_bounds of each page, once pages_want_bounds was called */
    VkBufferCopy *copies_bounds;
    bool has_bounds;
    velum_page_bounds *known; /* the same, by page */
} pages;

bool pages_init(pages *p, gpu *g, VkDeviceSize stage_bytes);
void pages_finish(pages *p, gpu *g);
void pages_begin_frame(pages *p);
/* From now on pages come with bounds for the reference; those that are there come anew. False: no memory. */
bool pages_want_bounds(pages *p, gpu *g);

/* Keeps a page for this frame; false if it no longer holds those contents. */
bool pages_keep(pages *p, uint32_t index, uint64_t contents);
/* The page of a tile's slot, or with VELUM_SLOT_COUNT + slot that of its fringe; VELUM_PAGE_NONE if there is no room
 * for it (on the stage or among the pages). */
uint32_t pages_get(pages *p, stage *s, const core_tile *tile, uint32_t slot, uint64_t *contents);
bool pages_full(const pages *p, float share);

/* Copies what was staged since; nothing if there is none. Barriers are the caller's. */
void pages_record(pages *p, gpu *g, VkCommandBuffer commands, VkBuffer staged);

#endif
