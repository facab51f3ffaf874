#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "handle.h"
#include "standalone.h"
#include "tables.h"

/* A new place can need more tiles than fit the stage: frames without views bring the rest. */
enum { WARM_UPS = 32 };

static void finish_target(standalone *s, target *t) {
    gpu *g = &s->e->g;
    gpu_image_finish(g, &t->luminance);
    gpu_image_finish(g, &t->transmittance);
    gpu_image_finish(g, &t->distance);
    gpu_image_finish(g, &t->variance);
    gpu_image_finish(g, &t->depth);
    gpu_buffer_finish(g, &t->pixels);
    *t = (target){0};
}

void standalone_release(void *owner) {
    standalone *s = owner;
    for (uint32_t i = 0; i < s->target_count; i++) {
        finish_target(s, &s->targets[i]);
    }
    free(s->targets);
    gpu_buffer_finish(&s->e->g, &s->shadow_pixels);
    s->targets = NULL;
    s->target_count = 0;
}

static VkDeviceSize pixels_at(const target *t, uint32_t part) {
    static const VkDeviceSize before[5] = {0, 16, 32, 36, 40};
    return before[part] * t->width * t->height;
}

static bool init_target(standalone *s, target *t, uint32_t width, uint32_t height) {
    gpu *g = &s->e->g;
    if (t->width == width && t->height == height) {
        return true;
    }
    finish_target(s, t);
    t->width = width;
    t->height = height;
    gpu_image_desc desc = {.format = VK_FORMAT_R32G32B32A32_SFLOAT,
                           .type = VK_IMAGE_TYPE_2D,
                           .view_type = VK_IMAGE_VIEW_TYPE_2D,
                           .extent = {width, height, 1},
                           .layers = 1,
                           .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT};
    bool ok = gpu_image_init(g, &t->luminance, &desc) && gpu_image_init(g, &t->transmittance, &desc);
    desc.format = VK_FORMAT_R32_SFLOAT;
    ok = ok && gpu_image_init(g, &t->distance, &desc) && gpu_image_init(g, &t->variance, &desc);
    desc.usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    ok = ok && gpu_image_init(g, &t->depth, &desc) &&
         gpu_buffer_init(g, &t->pixels, pixels_at(t, 4) + 4ull * width * height,
                         VK_BUFFER_USAGE_TRANSFER_SRC_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT, GPU_MEMORY_READBACK);
    if (!ok) {
        finish_target(s, t);
    }
    return ok;
}

static bool init_targets(standalone *s, uint32_t count) {
    if (count > s->target_count) {
        target *grown = realloc(s->targets, count * sizeof *grown);
        if (!grown) {
            s->e->g.result = VK_ERROR_OUT_OF_HOST_MEMORY;
            return false;
        }
        memset(grown + s->target_count, 0, (count - s->target_count) * sizeof *grown);
        s->targets = grown;
        s->target_count = count;
    }
    return true;
}

static bool check_vk(standalone *s, VkResult result, const char *call) {
    return gpu_check(&s->e->g, result, call, __FILE__, __LINE__);
}

static velum_result begin(standalone *s, const velum_frame_info *frame) {
    velum_frame_info f = *frame;
    f.submit_serial = ++s->serial;
    f.completed_serial = s->serial - 1;
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    velum_result result = engine_begin_frame(s->e, &f);
    if (result < 0) {
        s->serial--;
        return result;
    }
    if (!check_vk(s, s->ResetCommandPool(s->device, s->pool, 0), "ResetCommandPool") ||
        !check_vk(s, s->BeginCommandBuffer(s->commands, &info), "BeginCommandBuffer")) {
        engine_end_frame(s->e);
        return gpu_result(&s->e->g);
    }
    return result;
}

/* Ends, submits and waits, also after a failure: what was recorded counts as done from here on. */
static velum_result finish(standalone *s, velum_result result) {
    engine_end_frame(s->e);
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &s->commands};
    if (!check_vk(s, s->EndCommandBuffer(s->commands), "EndCommandBuffer") ||
        !check_vk(s, s->ResetFences(s->device, 1, &s->fence), "ResetFences") ||
        !check_vk(s, s->QueueSubmit(s->queue, 1, &submit, s->fence), "QueueSubmit") ||
        !check_vk(s, s->WaitForFences(s->device, 1, &s->fence, VK_TRUE, UINT64_MAX), "WaitForFences")) {
        result = result < 0 ? result : gpu_result(&s->e->g);
    }
    bool inside = s->e->inside;
    s->e->inside = false;
    engine_complete(s->e, s->serial);
    s->e->inside = inside;
    return result;
}

/* The frame's shared part; on return the frame is open unless the result is an error. */
static velum_result open_frame(standalone *s, const velum_frame_info *frame, const velum_eye_frame *eyes,
                               uint32_t eye_count, uint32_t eye_stride) {
    for (uint32_t i = 0;; i++) {
        velum_result result = begin(s, frame);
        if (result < 0) {
            return result;
        }
        result = record_shared(s->e, s->commands, eyes, eye_count, eye_stride);
        if (result == VELUM_INCOMPLETE && i < WARM_UPS) {
            result = finish(s, VELUM_OK);
            if (result < 0) {
                return result;
            }
            continue;
        }
        return result < 0 ? finish(s, result) : result;
    }
}

static void upload_depth(standalone *s, target *t, const float *depth) {
    gpu *g = &s->e->g;
    VkDeviceSize at = pixels_at(t, 4);
    memcpy((char *)t->pixels.mapped + at, depth, 4ull * t->width * t->height);
    gpu_image_make_general(g, s->commands, &t->depth);
    VkBufferImageCopy copy = {
        .bufferOffset = at, .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = t->depth.extent};
    g->CmdCopyBufferToImage(s->commands, t->pixels.buffer, t->depth.image, VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
    gpu_barrier(g, s->commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
}

static void download(standalone *s, const gpu_image *image, VkBuffer to, VkDeviceSize at) {
    VkBufferImageCopy copy = {.bufferOffset = at,
                              .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, image->layers},
                              .imageExtent = image->extent};
    s->CmdCopyImageToBuffer(s->commands, image->image, VK_IMAGE_LAYOUT_GENERAL, to, 1, &copy);
}

static velum_result record_pixels(standalone *s, target *t, const velum_pixels *p, view *v, velum_view_frame *f) {
    gpu *g = &s->e->g;
    gpu_image *images[] = {&t->luminance, &t->transmittance, &t->distance, &t->variance};
    for (size_t i = 0; i < 4; i++) {
        gpu_image_make_general(g, s->commands, images[i]);
    }
    if (p->depth) {
        upload_depth(s, t, p->depth);
    }
    const velum_vulkan_images lent = {.struct_size = sizeof lent,
                                      .luminance = t->luminance.view,
                                      .transmittance = t->transmittance.view,
                                      .distance = t->distance.view,
                                      .variance = t->variance.view,
                                      .depth = p->depth ? t->depth.view : VK_NULL_HANDLE,
                                      .depth_layout = VK_IMAGE_LAYOUT_GENERAL,
                                      .format = VK_FORMAT_R32G32B32A32_SFLOAT,
                                      .width = t->width,
                                      .height = t->height};
    velum_result result = record_view(v, s->commands, f, &lent);
    if (result < 0) {
        return result;
    }
    gpu_barrier(g, s->commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT);
    const uint32_t parts = v->eye->quality == VELUM_QUALITY_REFERENCE ? 4 : 3;
    for (uint32_t i = 0; i < parts; i++) {
        download(s, images[i], t->pixels.buffer, pixels_at(t, i));
    }
    gpu_barrier(g, s->commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
    return result;
}

static void read_pixels(const target *t, const velum_pixels *p, bool has_variance) {
    const char *mapped = t->pixels.mapped;
    uint64_t count = (uint64_t)t->width * t->height;
    float *const rgb[2] = {p->luminance_rgb, p->transmittance_rgb};
    for (uint32_t part = 0; part < 2; part++) {
        const char *from = mapped + pixels_at(t, part);
        for (uint64_t i = 0; rgb[part] && i < count; i++) {
            memcpy(&rgb[part][3 * i], from + 16 * i, 12);
        }
    }
    if (p->distance_m) {
        memcpy(p->distance_m, mapped + pixels_at(t, 2), 4 * count);
    }
    if (p->variance && has_variance) {
        memcpy(p->variance, mapped + pixels_at(t, 3), 4 * count);
    } else if (p->variance) {
        memset(p->variance, 0, 4 * count);
    }
}

/* One view of a call, checked. */
typedef struct job {
    velum_pixels pixels;
    velum_view_frame frame;
    view *v;
} job;

static bool check_job(checker *check, const engine *e, job *j, uint32_t index) {
    velum_pixels *p = &j->pixels;
    j->v = handle_get(p->view, HANDLE_VIEW);
    if (!j->v || j->v->eye->e != e) {
        return check_fail(check, VELUM_ERROR_HANDLE, "views[%u].view: not a live view of this engine", index);
    }
    if (!check_flags(check, "views.flags", p->flags, 0) ||
        !check_in(check, "views.frame", &j->frame, sizeof j->frame, p->frame, V1_VIEW_FRAME)) {
        return false;
    }
    uint32_t width = j->frame.width ? j->frame.width : j->v->width;
    uint32_t height = j->frame.height ? j->frame.height : j->v->height;
    if (p->width != width || p->height != height) {
        return check_fail(check, VELUM_ERROR_ARGUMENT, "views[%u].width, height: found %u x %u, expected %u x %u",
                          index, p->width, p->height, width, height);
    }
    if (width > j->v->width || height > j->v->height) {
        return check_fail(check, VELUM_ERROR_ARGUMENT, "views[%u].frame: found %u x %u, expected at most %u x %u",
                          index, width, height, j->v->width, j->v->height);
    }
    j->frame.x = j->frame.y = j->frame.array_layer = 0;
    return true;
}

velum_result standalone_render(standalone *s, const velum_frame_info *frame, const velum_eye_frame *eyes,
                               uint32_t eye_count, uint32_t eye_stride, const velum_pixels *views, uint32_t view_count,
                               uint32_t view_stride) {
    engine *e = s->e;
    checker check = {&e->sink, "engine", "render", VELUM_OK};
    velum_frame_info f;
    if (!check_in(&check, "frame", &f, sizeof f, frame, V1_FRAME_INFO) ||
        !check_zero(&check, "frame.submit_serial", f.submit_serial) ||
        !check_zero(&check, "frame.completed_serial", f.completed_serial) ||
        !check_count(&check, "view_count", view_count, 0, FRAME_RECORDS) ||
        !check_array(&check, "views", views, view_count, &view_stride, V1_PIXELS)) {
        return check.result;
    }
    job *jobs = calloc(view_count + 1u, sizeof *jobs);
    if (!jobs) {
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "no memory");
        return check.result;
    }
    velum_result result = VELUM_OK;
    for (uint32_t i = 0; i < view_count; i++) {
        if (!check_in(&check, "views", &jobs[i].pixels, sizeof jobs[i].pixels,
                      (const char *)views + (size_t)i * view_stride, V1_PIXELS) ||
            !check_job(&check, e, &jobs[i], i)) {
            result = check.result;
            goto done;
        }
    }
    e->inside = true;
    bool ok = init_targets(s, view_count);
    for (uint32_t i = 0; ok && i < view_count; i++) {
        ok = init_target(s, &s->targets[i], jobs[i].pixels.width, jobs[i].pixels.height);
    }
    if (!ok) {
        result = gpu_result(&e->g);
        goto done;
    }
    result = open_frame(s, &f, eyes, eye_count, eye_stride);
    if (result < 0) {
        goto done;
    }
    velum_result worst = result;
    for (uint32_t i = 0; i < view_count && result >= 0; i++) {
        result = record_pixels(s, &s->targets[i], &jobs[i].pixels, jobs[i].v, &jobs[i].frame);
        worst = result == VELUM_INCOMPLETE ? result : worst;
    }
    result = finish(s, result < 0 ? result : worst);
    for (uint32_t i = 0; i < view_count && result >= 0; i++) {
        read_pixels(&s->targets[i], &jobs[i].pixels, jobs[i].v->eye->quality == VELUM_QUALITY_REFERENCE);
    }
done:
    e->inside = false;
    free(jobs);
    return result;
}

/* IEEE 754 binary16. */
static float float_of_half(uint16_t h) {
    int exponent = (h >> 10) & 31;
    float fraction = (float)(h & 1023);
    float value = exponent == 0    ? ldexpf(fraction, -24)
                  : exponent == 31 ? (fraction > 0.0f ? NAN : INFINITY)
                                   : ldexpf(fraction + 1024.0f, exponent - 25);
    return h & 0x8000 ? -value : value;
}

velum_result standalone_render_shadow(standalone *s, const velum_frame_info *frame, shadow *map,
                                      const velum_shadow_frame *shadow_frame, float *transmittance, uint64_t count) {
    engine *e = s->e;
    gpu *g = &e->g;
    checker check = {&e->sink, "shadow", "render_shadow", VELUM_OK};
    velum_frame_info f;
    uint64_t texels = (uint64_t)map->levels * map->texels * map->texels;
    if (!check_in(&check, "frame", &f, sizeof f, frame, V1_FRAME_INFO) ||
        !check_zero(&check, "frame.submit_serial", f.submit_serial) ||
        !check_zero(&check, "frame.completed_serial", f.completed_serial) ||
        !check_pointer(&check, "transmittance", transmittance) ||
        !check_count(&check, "count", count, texels, texels)) {
        return check.result;
    }
    velum_result result = VELUM_OK;
    e->inside = true;
    if (s->shadow_pixels.size != 2 * texels) {
        gpu_buffer_finish(g, &s->shadow_pixels);
        if (!gpu_buffer_init(g, &s->shadow_pixels, 2 * texels, VK_BUFFER_USAGE_TRANSFER_DST_BIT, GPU_MEMORY_READBACK)) {
            result = gpu_result(g);
            goto done;
        }
    }
    velum_result standing = VELUM_INCOMPLETE;
    for (uint32_t i = 0; standing == VELUM_INCOMPLETE && i <= WARM_UPS; i++) {
        result = open_frame(s, &f, NULL, 0, 0);
        if (result < 0) {
            goto done;
        }
        standing = record_shadow(map, s->commands, shadow_frame);
        if (standing >= 0) {
            gpu_barrier(g, s->commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT);
            download(s, &map->image, s->shadow_pixels.buffer, 0);
            gpu_barrier(g, s->commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                        VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
        }
        result = finish(s, standing);
        if (result < 0) {
            goto done;
        }
    }
    for (uint64_t i = 0; i < texels; i++) {
        uint16_t half;
        memcpy(&half, (const char *)s->shadow_pixels.mapped + 2 * i, sizeof half);
        transmittance[i] = float_of_half(half);
    }
done:
    e->inside = false;
    return result;
}

static standalone *owner_of(velum_engine *handle, const char *call, velum_result *result) {
    engine *e = handle_get(handle, HANDLE_ENGINE);
    if (!e) {
        *result = handle_fail(handle, HANDLE_ENGINE, call);
        return NULL;
    }
    if (!e->owner) {
        *result = log_fail(&e->sink, VELUM_ERROR_STATE, "engine", "%s: not a standalone engine", call);
    }
    return e->owner;
}

static velum_result VELUM_CALL render(velum_engine *handle, const velum_frame_info *frame, const velum_eye_frame *eyes,
                                      uint32_t eye_count, uint32_t eye_stride, const velum_pixels *views,
                                      uint32_t view_count, uint32_t view_stride) {
    velum_result result = VELUM_OK;
    standalone *s = owner_of(handle, "render", &result);
    return s ? standalone_render(s, frame, eyes, eye_count, eye_stride, views, view_count, view_stride) : result;
}

static velum_result VELUM_CALL render_shadow(velum_engine *handle, const velum_frame_info *frame, velum_shadow *map,
                                             const velum_shadow_frame *shadow_frame, float *transmittance,
                                             uint64_t count) {
    velum_result result = VELUM_OK;
    standalone *s = owner_of(handle, "render_shadow", &result);
    if (!s) {
        return result;
    }
    shadow *m = handle_get(map, HANDLE_SHADOW);
    if (!m || m->e != s->e) {
        return handle_fail(map, HANDLE_SHADOW, "render_shadow");
    }
    return standalone_render_shadow(s, frame, m, shadow_frame, transmittance, count);
}

static velum_result VELUM_CALL create_engine(const velum_standalone_desc *desc, velum_engine **out) {
    return standalone_create(desc, out);
}

const velum_standalone_api velum_standalone_table = {.struct_size = sizeof velum_standalone_table,
                                                     .create_engine = create_engine,
                                                     .render = render,
                                                     .render_shadow = render_shadow};
