/* A view of the reference: a slice of paths, then all pixels as they stand. */
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "blocks.h"
#include "core/noise_slope.h"
#include "shared/hash.h"
#include "shared/phase.h"
#include "shared/reference.h"

enum { PATHS_MAX = 1 << 17, PATHS_MIN = 256, ROUND_MAX = 64, GROUPS_MAX = 2048 };
/* Fewer paths do not fill a GPU: a slice then takes as long as its longest path, however few it has. */
enum { PATHS_FULL = 1 << 15 };

/* Software devices end loops early (reference.comp): their lanes are few, interrupted, and taken up again. */
enum { SOFTWARE_GROUPS_MAX = 32, SOFTWARE_ROUNDS = 40, SOFTWARE_PATHS = 4096 };

/* Of a submission; a slice may take half as long again. */
#define SLICE_MS 30.0f
/* So long it may take where it does not fill the device: an operating system may take a device that hangs for seconds
 * from its process. */
#define SLICE_MOST_MS 250.0f
/* Fewer flights about the sun are drawn than collisions. */
#define BRANCHES 0.3f
#define WORTH 0.2f

velum_result reference_enable(engine *e) {
    gpu *g = &e->g;
    velum_result result = pipelines_add_reference(&e->passes, g);
    if (result < 0) {
        return result;
    }
    if (!e->noise_slope.buffer) {
        const VkDeviceSize bytes = VELUM_SLOPE_BYTES + VELUM_AWAY_BYTES;
        if (!gpu_buffer_init(g, &e->noise_slope, bytes, VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, GPU_MEMORY_UPLOAD)) {
            return gpu_result(g);
        }
        const core_noise *noise = core_noise_built();
        if (!core_noise_slope(noise, e->noise_slope.mapped) ||
            !core_noise_away(noise, (uint8_t *)e->noise_slope.mapped + VELUM_SLOPE_BYTES)) {
            gpu_buffer_finish(g, &e->noise_slope);
            g->result = VK_ERROR_OUT_OF_HOST_MEMORY;
            return gpu_result(g);
        }
        e->detail_slope = core_noise_detail_slope(noise);
    }
    return pages_want_bounds(&e->pages, g) ? VELUM_OK : gpu_result(g);
}

static bool init_storage(gpu *g, gpu_buffer *buffer, VkDeviceSize bytes) {
    return gpu_buffer_init(g, buffer, bytes,
                           VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_SRC_BIT |
                               VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                           GPU_MEMORY_DEVICE);
}

/* One work group for each thread: each takes paths as long as there are any. */
static uint32_t software_groups(void) {
    long threads = sysconf(_SC_NPROCESSORS_ONLN);
    return threads < 1 ? 1 : threads > SOFTWARE_GROUPS_MAX ? SOFTWARE_GROUPS_MAX : (uint32_t)threads;
}

static uint32_t dispatches_of(const reference *r) {
    return (r->rounds + SOFTWARE_ROUNDS - 1) / SOFTWARE_ROUNDS;
}

static uint32_t rounds_of(const reference *r) {
    return r->rounds / dispatches_of(r);
}

bool reference_init(view *v) {
    gpu *g = &v->eye->e->g;
    reference *r = &v->reference;
    const VkDeviceSize pixels = (VkDeviceSize)v->width * v->height * sizeof(velum_reference_pixel);
    if (pixels > g->properties.limits.maxStorageBufferRange) {
        log_write(g->sink, VELUM_LOG_ERROR, v->name,
                  "create_view: the reference takes at most %u pixels on this device",
                  (unsigned)(g->properties.limits.maxStorageBufferRange / sizeof(velum_reference_pixel)));
        g->result = VK_ERROR_OUT_OF_DEVICE_MEMORY;
        return false;
    }
    const bool software = gpu_is_software(g);
    r->path_room = software ? SOFTWARE_PATHS : PATHS_MIN;
    r->rounds = 64;
    if (!init_storage(g, &r->paths, (software ? SOFTWARE_PATHS : PATHS_MAX) * sizeof(velum_reference_path)) ||
        !init_storage(g, &r->pixels, pixels) ||
        !init_storage(g, &r->lanes,
                      (software ? SOFTWARE_GROUPS_MAX : 1) * VELUM_REFERENCE_GROUP * sizeof(velum_reference_lane)) ||
        !init_storage(g, &r->slice_words, sizeof(uint32_t) * VELUM_SLICE_WORDS)) {
        return false;
    }
    v->bytes = r->lanes.allocation.size + r->paths.allocation.size + r->pixels.allocation.size +
               r->slice_words.allocation.size;
    return true;
}

void reference_finish(gpu *g, view *v) {
    reference *r = &v->reference;
    gpu_buffer_finish(g, &r->lanes);
    gpu_buffer_finish(g, &r->paths);
    gpu_buffer_finish(g, &r->pixels);
    gpu_buffer_finish(g, &r->slice_words);
    free(r->key);
    r->key = NULL;
}

static uint32_t turns_of(const reference *r) {
    return r->side * r->side * VELUM_REFERENCE_BLOCK;
}

static void next_slice(reference *r, uint32_t limit) {
    const uint32_t all = turns_of(r);
    r->turn += r->turns;
    if (r->turns > 0 && r->turn >= all) {
        r->turn = 0;
        r->done += r->paths_now;
    }
    r->begun = false;
    r->slice++;
    r->turns = 0;
    if (r->turn == 0) {
        uint32_t most = limit == 0 ? ROUND_MAX : limit > r->done ? limit - r->done : 0;
        uint32_t paths = r->path_room / all;
        paths = paths < 1 ? 1 : paths > ROUND_MAX ? ROUND_MAX : paths;
        r->paths_now = paths < most ? paths : most;
    }
    if (r->paths_now > 0) {
        uint32_t count = r->path_room / r->paths_now;
        r->turns = count < all - r->turn ? count : all - r->turn;
    }
}

static float adapted(float now, float wanted, float growth) {
    wanted = wanted < growth * now ? wanted : growth * now;
    return wanted > 0.25f * now ? wanted : 0.25f * now;
}

/* Rounds take what they take, on a software device. */
static void adapt_rounds(reference *r, const frame_record *record, float ms) {
    const float wanted = adapted((float)r->rounds, (float)record->rounds * SLICE_MS / ms, 2.0f);
    r->rounds = wanted < 16.0f ? 16 : wanted > 1e5f ? 100000 : (uint32_t)wanted;
}

/* Elsewhere paths do; while they do not fill the device, as many as do not take too long. */
static void adapt_paths(reference *r, const frame_record *record, float ms) {
    if (record->paths < r->path_room && ms < SLICE_MOST_MS) {
        return; /* the last of a round is a small one */
    }
    float wanted = (float)record->paths * SLICE_MS / ms;
    if (wanted < PATHS_FULL) {
        const float most = (float)record->paths * SLICE_MOST_MS / ms;
        wanted = most < PATHS_FULL ? most : PATHS_FULL;
    }
    wanted = adapted((float)r->path_room, wanted, 4.0f);
    r->path_room = wanted < PATHS_MIN ? PATHS_MIN : wanted > PATHS_MAX ? PATHS_MAX : (uint32_t)wanted;
}

void reference_learn(view *v, const frame_record *record, const uint32_t *slice_words, float ms) {
    reference *r = &v->reference;
    memcpy(&v->stats.relative_error, &slice_words[VELUM_SLICE_ERROR], sizeof(float));
    v->stats.paths_per_pixel = r->done;
    if (record->slice != r->slice || record->paths == 0) {
        return;
    }
    bool complete = slice_words[VELUM_SLICE_DONE] == record->paths;
    const bool software = gpu_is_software(&v->eye->e->g);
    if (ms > 0.0f && software && !complete) {
        adapt_rounds(r, record, ms);
    } else if (ms > 0.0f && !software && complete) {
        adapt_paths(r, record, ms);
    }
    r->complete = r->complete || complete;
    if (complete && r->turn + r->turns >= turns_of(r)) {
        v->stats.paths_per_pixel += r->paths_now;
    }
}

/* Slot of the narrowest forward peak among what clouds there are; VELUM_SLOT_COUNT: none. */
static uint32_t narrowest(const velum_eye_block *block) {
    uint32_t slot = VELUM_SLOT_COUNT;
    float g = -2.0f;
    for (uint32_t i = 0; i < VELUM_SLOT_COUNT; i++) {
        float own = i >= VELUM_SLOT_UNIFORM ? block->slots[i].optics[1]
                    : i == VELUM_SLOT_HIGH  ? VELUM_ICE_G_FORWARD
                                            : VELUM_DROPLET_20_G_HG;
        if (block->table[2] & (1u << i) && own > g) {
            g = own;
            slot = i;
        }
    }
    return slot;
}

/* True: nothing that is there can be kept. */
static bool changed(view *v, const velum_view_block *block, bool cut) {
    const eye *y = v->eye;
    const engine *e = y->e;
    reference *r = &v->reference;
    reference_key key;
    memset(&key, 0, sizeof key);
    key.eye = y->block;
    key.view = *block;
    key.view.scale[0] = key.view.depth[3] = 0.0f;
    key.view.size[2] = key.view.size[3] = key.view.frame[2] = 0;
    key.tables = y->tiles.built;
    for (int i = 0; i < 2; i++) {
        key.state[i] = e->weather.state[i] ? core_state_id(e->weather.state[i]) : 0;
    }
    bool same = !cut && r->key && memcmp(r->key, &key, sizeof key) == 0;
    if (!r->key) {
        r->key = malloc(sizeof *r->key);
    }
    if (r->key) {
        *r->key = key;
    }
    return !same;
}

/* The greatest extinction of each slot in any page of the eye's table. */
static void learn_bounds(view *v) {
    const engine *e = v->eye->e;
    const tiles *t = &v->eye->tiles;
    float *most = v->reference.most_1_m;
    memset(most, 0, sizeof v->reference.most_1_m);
    for (uint32_t i = 0; t->words && i < t->entries; i++) {
        const uint32_t *entry = t->words + (size_t)i * VELUM_TABLE_WORDS;
        for (uint32_t slot = 0; entry[0] != VELUM_TILE_KEY_NONE && slot < VELUM_SLOT_COUNT; slot++) {
            for (int state = 0; state < 2; state++) {
                uint32_t page = entry[VELUM_TABLE_PAGES + slot] >> 16 * state & 0xffffu;
                if (page < PAGES_MAX) {
                    float own = e->pages.known[page].most[1] * 1.0005f;
                    most[slot] = own > most[slot] ? own : most[slot];
                }
            }
        }
    }
}

/* Begins a slice where the last is complete. */
static void take_slice(reference *r, uint32_t blocks, uint32_t limit, bool anew, velum_view_block *block) {
    if (anew) {
        r->side = 1;
        while ((uint64_t)r->side * r->side < blocks) {
            r->side++;
        }
        r->turn = r->turns = r->done = r->paths_now = 0;
    }
    if (anew || r->complete || r->turns == 0) {
        next_slice(r, limit);
        r->complete = false;
    }
    const uint32_t slice[4] = {r->turn, r->turns, r->paths_now, r->done};
    memcpy(block->march_size, slice, sizeof slice);
    block->steps[1] = r->side;
}

typedef struct binding {
    VkDescriptorSet sets[2];
    uint32_t offsets[3], again; /* eye, shadow, view */
    VkPipeline tracer;
} binding;

static bool write_set(engine *e, const view *v, const velum_vulkan_images *images, uint32_t counter,
                      VkDescriptorSet *out) {
    const pipelines *p = &e->passes;
    const reference *r = &v->reference;
    if (!frame_set(e, p->set_reference, out)) {
        return false;
    }
    const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
    VkImageView nothing = images->layers ? e->nothing_layered.view : e->nothing.view;
    const VkDescriptorImageInfo image[VELUM_BIND_REFERENCE_COUNT] = {
        [VELUM_BIND_REFERENCE_OUT_VARIANCE] = {VK_NULL_HANDLE, images->variance ? images->variance : nothing, general},
        [VELUM_BIND_OUT_LUMINANCE] = {VK_NULL_HANDLE, images->luminance, general},
        [VELUM_BIND_OUT_TRANSMITTANCE] = {VK_NULL_HANDLE, images->transmittance, general},
        [VELUM_BIND_OUT_DISTANCE] = {VK_NULL_HANDLE, images->distance ? images->distance : nothing, general},
        [VELUM_BIND_DEPTH] = {p->nearest, images->depth ? images->depth : e->air.view,
                              images->depth ? images->depth_layout : general}};
    const VkDescriptorBufferInfo buffer[VELUM_BIND_REFERENCE_COUNT] = {
        [VELUM_BIND_VIEW] = {e->uniforms.buffer, 0, sizeof(velum_view_block)},
        [VELUM_BIND_REFERENCE_PATHS] = {r->paths.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_REFERENCE_PIXELS] = {r->pixels.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_REFERENCE_BOUNDS] = {e->pages.bounds.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_REFERENCE_NOISE] = {e->noise_slope.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_REFERENCE_LANES] = {r->lanes.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_REFERENCE_ERROR] = {r->slice_words.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_COUNTERS] = {e->counters.buffer, (VkDeviceSize)counter * COUNTER_STRIDE, 4 * VELUM_COUNTER_WORDS}};
    VkWriteDescriptorSet writes[VELUM_BIND_REFERENCE_COUNT];
    uint32_t count = 0;
    for (uint32_t i = 0; i < VELUM_BIND_REFERENCE_COUNT; i++) {
        bool is_buffer = buffer[i].buffer != VK_NULL_HANDLE;
        if (!is_buffer && !image[i].imageView) {
            continue;
        }
        writes[count++] =
            (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                   .dstSet = *out,
                                   .dstBinding = i,
                                   .descriptorCount = 1,
                                   .descriptorType = i == VELUM_BIND_VIEW    ? VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC
                                                     : is_buffer             ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                                     : i == VELUM_BIND_DEPTH ? VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER
                                                                             : VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
                                   .pImageInfo = is_buffer ? NULL : &image[i],
                                   .pBufferInfo = is_buffer ? &buffer[i] : NULL};
    }
    e->g.UpdateDescriptorSets(e->g.device, count, writes, 0, NULL);
    return true;
}

/* Two bindings: of the first dispatch, and of those that take lanes up again. */
static bool bind_init(view *v, const velum_vulkan_images *images, const velum_view_block *block, uint32_t counter,
                      binding *out) {
    eye *y = v->eye;
    engine *e = y->e;
    const velum_shadow_block none = {0};
    velum_view_block first = *block;
    velum_view_block again = *block;
    velum_eye_block seen = y->block;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        seen.slots[slot].bounds[3] = v->reference.most_1_m[slot];
    }
    first.steps[2] = v->reference.begun && gpu_is_software(&e->g) ? 1 : 0;
    again.steps[2] = 1;
    out->sets[0] = y->set;
    if (!frame_uniform(e, &seen, sizeof seen, &out->offsets[0]) ||
        !frame_uniform(e, &none, sizeof none, &out->offsets[1]) ||
        !frame_uniform(e, &first, sizeof first, &out->offsets[2]) ||
        !frame_uniform(e, &again, sizeof again, &out->again)) {
        e->g.result = VK_ERROR_OUT_OF_HOST_MEMORY;
        return false;
    }
    out->tracer = pipelines_tracer(&e->passes, &e->g, blocks_mix(e), y->block.ground[3] != 0.0f, y->block.table[2],
                                   y->block.table[3] != 0);
    return out->tracer && write_set(e, v, images, counter, &out->sets[1]);
}

static void bind(const engine *e, VkCommandBuffer commands, const binding *b, bool again) {
    const uint32_t offsets[3] = {b->offsets[0], b->offsets[1], again ? b->again : b->offsets[2]};
    e->g.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.layout_reference, 0, 2, b->sets, 3,
                               offsets);
}

static void compute_barrier(gpu *g, VkCommandBuffer commands) {
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
                VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT |
                    VK_ACCESS_2_TRANSFER_READ_BIT);
}

static void record_passes(view *v, VkCommandBuffer commands, const binding *bound, const velum_view_block *block,
                          bool layered, bool anew, uint32_t counter, uint32_t query) {
    engine *e = v->eye->e;
    gpu *g = &e->g;
    reference *r = &v->reference;
    const VkDeviceSize at = (VkDeviceSize)counter * COUNTER_STRIDE;
    const VkDeviceSize bytes = sizeof(uint32_t) * VELUM_COUNTER_WORDS;
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    const VkAccessFlags2 access = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    /* The frame before used what is written now. */
    gpu_barrier(g, commands, compute | VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                compute | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, access | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    g->CmdFillBuffer(commands, e->counters.buffer, at, bytes, 0);
    const VkDeviceSize error_at = sizeof(uint32_t) * VELUM_SLICE_ERROR;
    const uint32_t paths = block->march_size[1] * block->march_size[2];
    if (!r->begun) {
        g->CmdFillBuffer(commands, r->slice_words.buffer, 0, anew ? sizeof(uint32_t) * VELUM_SLICE_WORDS : error_at, 0);
    }
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                compute | VK_PIPELINE_STAGE_2_COPY_BIT, access | VK_ACCESS_2_TRANSFER_READ_BIT);
    frame_timestamp(e, commands, query);
    bind(e, commands, bound, false);
    if (paths > 0) {
        const bool software = gpu_is_software(g);
        const uint32_t lanes = pipelines_reference_lanes(g);
        const uint32_t groups = (paths + lanes - 1) / lanes;
        const uint32_t most = software ? software_groups() : GROUPS_MAX;
        g->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, bound->tracer);
        for (uint32_t i = 0; i < (software ? dispatches_of(r) : 1); i++) {
            if (i == 1) {
                bind(e, commands, bound, true);
            }
            g->CmdDispatch(commands, software || groups > most ? most : groups, 1, 1);
            compute_barrier(g, commands);
        }
        bind(e, commands, bound, false);
    }
    frame_timestamp(e, commands, query < FRAME_QUERIES ? query + 1 : FRAME_QUERIES);
    record_dispatch(e, commands, layered ? PASS_REFERENCE_RESOLVE_LAYERED : PASS_REFERENCE_RESOLVE, block->size[0],
                    block->size[1]);
    compute_barrier(g, commands);
    /* What the pixels have taken in now is not taken in again. */
    const VkBufferCopy taken = {sizeof(uint32_t) * VELUM_SLICE_DONE, sizeof(uint32_t) * VELUM_SLICE_TAKEN,
                                sizeof(uint32_t)};
    g->CmdCopyBuffer(commands, r->slice_words.buffer, r->slice_words.buffer, 1, &taken);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                compute | VK_PIPELINE_STAGE_2_COPY_BIT, access | VK_ACCESS_2_TRANSFER_READ_BIT);
    if (r->turns > 0 && r->turn + r->turns >= turns_of(r)) {
        g->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.pipeline[PASS_REFERENCE_ERROR]);
        g->CmdDispatch(commands, 1, 1, 1);
        compute_barrier(g, commands);
    }
    frame_timestamp(e, commands, query < FRAME_QUERIES ? query + 2 : FRAME_QUERIES);
    const VkBufferCopy counters = {at, at, bytes};
    const VkBufferCopy words = {0, at + bytes, sizeof(uint32_t) * VELUM_SLICE_WORDS};
    g->CmdCopyBuffer(commands, e->counters.buffer, e->now->counters.buffer, 1, &counters);
    g->CmdCopyBuffer(commands, r->slice_words.buffer, e->now->counters.buffer, 1, &words);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT,
                VK_ACCESS_2_HOST_READ_BIT);
}

velum_result record_reference(view *v, VkCommandBuffer commands, const velum_view_frame *frame,
                              const velum_vulkan_images *images, velum_view_block *block, bool cut) {
    eye *y = v->eye;
    engine *e = y->e;
    frame_slot *slot = e->now;
    reference *r = &v->reference;
    uint32_t peak = narrowest(&y->block);
    block->march[0] = peak < VELUM_SLOT_COUNT ? BRANCHES : 0.0f;
    block->march[1] = (float)peak;
    block->march[2] = e->detail_slope;
    block->march[3] = WORTH;
    memset(block->march_size, 0, sizeof block->march_size);
    memset(block->steps, 0, sizeof block->steps);
    block->steps[0] = y->plan.octaves;
    block->frame[0] = 0;
    /* Pictures of different times have noise of their own. */
    uint32_t time[2];
    memcpy(time, &e->frame.time_s, sizeof time);
    block->frame[3] = velum_hash_3((uint32_t)e->w->seed, time[0], time[1]);
    block->frame[1] &= ~VELUM_VIEW_BLOCK_CUT;
    bool anew = changed(v, block, cut);
    if (anew) {
        block->frame[1] |= VELUM_VIEW_BLOCK_CUT;
        learn_bounds(v);
    }
    take_slice(r, velum_reference_blocks(frame->width, frame->height), frame->path_limit, anew, block);
    block->steps[3] = gpu_is_software(&e->g) ? rounds_of(r) : 0x7fffffffu;
    uint32_t counter = slot->record_count;
    binding bound;
    if (!bind_init(v, images, block, counter, &bound)) {
        free(r->key);
        r->key = NULL;
        return gpu_result(&e->g);
    }
    uint32_t query = frame_queries(e, 3);
    record_passes(v, commands, &bound, block, images->layers != 0, anew, counter, query);
    r->begun = true;
    slot->record[slot->record_count++] = (frame_record){.v = v,
                                                        .query = query,
                                                        .slice = r->slice,
                                                        .paths = block->march_size[1] * block->march_size[2],
                                                        .rounds = dispatches_of(r) * rounds_of(r),
                                                        .stats = {.incomplete = y->incomplete,
                                                                  .frame = e->newest_serial,
                                                                  .revision = e->weather.revision,
                                                                  .weather_bytes = engine_weather_bytes(e),
                                                                  .view_bytes = v->bytes}};
    v->frame = e->frames;
    v->last_serial = e->newest_serial;
    return y->incomplete ? VELUM_INCOMPLETE : y->degraded ? VELUM_DEGRADED : VELUM_OK;
}
