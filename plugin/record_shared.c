/* Once a frame: uploads, tables, what eyes share. */
#include <string.h>

#include "blocks.h"
#include "handle.h"
#include "history.h"

tiles_context record_tiles_context(engine *e, uint32_t *budget, VkBufferCopy *copies, uint32_t copy_capacity) {
    return (tiles_context){.w = e->w,
                           .weather = &e->weather,
                           .p = &e->pages,
                           .s = &e->now->staged,
                           .space = &e->tables,
                           .sink = &e->sink,
                           .budget = budget,
                           .copies = copies,
                           .copy_capacity = copy_capacity};
}

void record_uploads(engine *e, VkCommandBuffer commands, const tiles_context *context) {
    gpu *g = &e->g;
    if (e->pages.copy_count == 0 && context->copy_count == 0) {
        return;
    }
    /* What was drawn before may still read the pages and tables that are replaced. */
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_2_COPY_BIT,
                VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
    VkBuffer staged = e->now->staged.buffer.buffer;
    pages_record(&e->pages, g, commands, staged);
    if (context->copy_count > 0) {
        g->CmdCopyBuffer(commands, staged, e->tables.buffer.buffer, context->copy_count, context->copies);
    }
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}

void record_layers(engine *e, VkCommandBuffer commands, pass which, uint32_t width, uint32_t height, uint32_t layers) {
    e->g.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.pipeline[which]);
    e->g.CmdDispatch(commands, (width + VELUM_GROUP - 1) / VELUM_GROUP, (height + VELUM_GROUP - 1) / VELUM_GROUP,
                     layers);
}

void record_dispatch(engine *e, VkCommandBuffer commands, pass which, uint32_t width, uint32_t height) {
    record_layers(e, commands, which, width, height, 1);
}

static void compute_to_compute(engine *e, VkCommandBuffer commands) {
    gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                    VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
}

static velum_result record_begin(engine *e, VkCommandBuffer commands) {
    gpu *g = &e->g;
    frame_slot *slot = e->now;
    if (slot->queries) {
        g->CmdResetQueryPool(commands, slot->queries, 0, FRAME_QUERIES);
    }
    slot->shared_query = frame_queries(e, 2);
    frame_timestamp(e, commands, slot->shared_query);
    gpu_image *images[] = {&e->pages.a, &e->pages.b, &e->air, &e->glow, &e->nothing, &e->nothing_layered};
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        gpu_image_make_general(g, commands, images[i]);
    }
    e->bound_shadow = e->newest_shadow ? e->newest_shadow : e->shadows;
    for (shadow *s = e->shadows; s; s = s->next) {
        gpu_image_make_general(g, commands, &s->image);
        s->last_serial = e->newest_serial;
    }
    if (!e->filled) {
        velum_result result = noise_volumes_record(e, commands);
        if (result < 0) {
            return result;
        }
        gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    }
    return scattering_record(e, commands);
}

/* The eyes of the call, checked whole before anything is recorded. */
static bool read_eyes(checker *check, engine *e, const velum_eye_frame *eyes, uint32_t count, uint32_t stride,
                      velum_eye_frame *out, eye **out_eyes) {
    if (!check_array(check, "eyes", eyes, count, &stride, V1_EYE_FRAME)) {
        return false;
    }
    if (count > EYES_MAX) {
        return check_fail(check, VELUM_ERROR_ARGUMENT, "eye_count: found %u, expected at most %u", count, EYES_MAX);
    }
    for (uint32_t i = 0; i < count; i++) {
        velum_eye_frame *f = &out[i];
        if (!check_in(check, "eye", f, sizeof *f, (const char *)eyes + (size_t)i * stride, V1_EYE_FRAME) ||
            !check_flags(check, "eye.flags", f->flags, VELUM_EYE_RESET) ||
            !check_position(check, "eye.position_ecef_m", f->position_ecef_m)) {
            return false;
        }
        eye *y = handle_get(f->eye, HANDLE_EYE);
        if (!y || y->e != e) {
            return check_fail(check, VELUM_ERROR_HANDLE, "eyes[%u].eye: not a live eye of this engine", i);
        }
        for (uint32_t k = 0; k < i; k++) {
            if (out_eyes[k] == y) {
                return check_fail(check, VELUM_ERROR_ARGUMENT, "eyes[%u].eye: named twice", i);
            }
        }
        out_eyes[i] = y;
    }
    return true;
}

static bool record_sky(engine *e, eye *y, VkCommandBuffer commands) {
    const velum_eye_block *b = &y->block;
    const sky_key key = sky_key_of(b);
    y->sky_rests = sky_key_same(&key, &y->sky_wanted) ? y->sky_rests + 1 : 0;
    y->sky_wanted = key;
    const bool still_does =
        y->sky_rests < REPEATS_MOST ? sky_key_near(&y->sky_made, &key) : sky_key_same(&y->sky_made, &key);
    if (y->sky_count > 0 && !y->reset && still_does) {
        return true;
    }
    velum_shadow_block none = {0};
    uint32_t offsets[2];
    if (!frame_uniform(e, b, sizeof *b, &offsets[0]) || !frame_uniform(e, &none, sizeof none, &offsets[1])) {
        return false;
    }
    e->g.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.layout_engine, 0, 1, &y->set, 2,
                               offsets);
    if (!e->air_ready) {
        record_dispatch(e, commands, PASS_AIR, VELUM_AIR_W, VELUM_AIR_H);
        compute_to_compute(e, commands);
        record_dispatch(e, commands, PASS_GLOW, VELUM_GLOW_SIDE, 2 * VELUM_GLOW_SIDE);
        compute_to_compute(e, commands);
        e->air_ready = true;
    }
    record_dispatch(e, commands, b->drift[1] > 0.0f ? PASS_SKY_FOG : PASS_SKY, VELUM_SKY_COLUMNS, VELUM_SKY_H);
    y->sky_made = key;
    y->sky_count++;
    return true;
}

velum_result record_shared(engine *e, VkCommandBuffer commands, const velum_eye_frame *eyes, uint32_t count,
                           uint32_t stride) {
    checker check = {&e->sink, "engine", "record_shared", VELUM_OK};
    velum_eye_frame frames[EYES_MAX];
    eye *list[EYES_MAX];
    VkBufferCopy copies[EYES_MAX];
    if (e->state != ENGINE_BEGUN) {
        check_fail(&check, VELUM_ERROR_STATE,
                   e->state == ENGINE_IDLE ? "no frame has begun" : "called twice in a frame");
        return check.result;
    }
    if (!check_pointer(&check, "commands", commands) || !read_eyes(&check, e, eyes, count, stride, frames, list)) {
        return check.result;
    }
    static const pass needed[] = {PASS_AIR, PASS_GLOW, PASS_SKY, PASS_SKY_FOG};
    if (count > 0 && !pipelines_need(&e->passes, &e->g, needed, sizeof needed / sizeof needed[0])) {
        return gpu_result(&e->g);
    }
    velum_result result = record_begin(e, commands);
    if (result < 0) {
        return result;
    }
    e->now->eye_count = count;
    uint32_t budget = e->owner ? UINT32_MAX : world_is_prepared(e->w) ? 0 : RENDER_TILES;
    tiles_context context = record_tiles_context(e, &budget, copies, EYES_MAX);
    velum_result worst = VELUM_OK;
    for (uint32_t i = 0; i < count; i++) {
        eye *y = list[i];
        result = tiles_update(&y->tiles, &context, frames[i].position_ecef_m, 0.0);
        y->incomplete = result == VELUM_INCOMPLETE;
        y->degraded = result == VELUM_DEGRADED;
        if (result < 0) {
            record_uploads(e, commands, &context);
            return result;
        }
        worst = result == VELUM_INCOMPLETE || worst == VELUM_OK ? result : worst;
    }
    record_uploads(e, commands, &context);

    /* The tables and skies that are written anew were read by the frame before. */
    compute_to_compute(e, commands);
    for (uint32_t i = 0; i < count; i++) {
        eye *y = list[i];
        memcpy(y->position_ecef_m, frames[i].position_ecef_m, sizeof y->position_ecef_m);
        y->reset = (frames[i].flags & VELUM_EYE_RESET) != 0;
        y->last_serial = e->newest_serial;
        gpu_image_make_general(&e->g, commands, &y->sky);
        plan_make(e, y);
        blocks_wind(e, &y->tiles, y->position_ecef_m, &y->wind);
        if (!blocks_fill_eye(e, &y->tiles, y->position_ecef_m, &y->plan, &y->block)) {
            check_fail(&check, VELUM_ERROR_ARGUMENT, "eyes[%u].position_ecef_m: no place on the earth", i);
            return check.result;
        }
        if (!frame_engine_set(e, &y->sky, &y->set)) {
            return gpu_result(&e->g);
        }
        if (!record_sky(e, y, commands)) {
            return VELUM_ERROR_OUT_OF_MEMORY;
        }
        y->frame = e->frames;
    }
    compute_to_compute(e, commands);
    frame_timestamp(e, commands, e->now->shared_query < FRAME_QUERIES ? e->now->shared_query + 1 : FRAME_QUERIES);
    e->state = ENGINE_SHARED;
    return worst;
}
