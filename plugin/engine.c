#include "engine.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "handle.h"

static void engine_free(engine *e) {
    gpu *g = &e->g;
    pages_finish(&e->pages, g);
    table_space_finish(&e->tables, g);
    gpu_image *images[] = {&e->shape, &e->detail,     &e->air,     &e->glow,
                           &e->white, &e->scattering, &e->nothing, &e->nothing_layered};
    for (size_t i = 0; i < sizeof images / sizeof images[0]; i++) {
        gpu_image_finish(g, images[i]);
    }
    gpu_buffer_finish(g, &e->uniforms);
    gpu_buffer_finish(g, &e->counters);
    gpu_buffer_finish(g, &e->noise_slope);
    gpu_buffer_finish(g, &e->noise_upload);
    for (uint32_t i = 0; i < FRAMES_MAX; i++) {
        frame_slot_finish(e, &e->slots[i]);
    }
    pipelines_finish(&e->passes, g);
    gpu_finish(g);
    world_weather_finish(&e->weather);
    free(e);
}

static bool init_table(engine *e, gpu_image *image, VkFormat format, uint32_t width, uint32_t height,
                       VkImageViewType type) {
    const gpu_image_desc desc = {.format = format,
                                 .type = VK_IMAGE_TYPE_2D,
                                 .view_type = type,
                                 .extent = {width, height, 1},
                                 .layers = 1,
                                 .usage = VK_IMAGE_USAGE_STORAGE_BIT | VK_IMAGE_USAGE_SAMPLED_BIT};
    return gpu_image_init(&e->g, image, &desc);
}

static bool init_resources(engine *e) {
    gpu *g = &e->g;
    const VkFormat half = VK_FORMAT_R16G16B16A16_SFLOAT;
    const VkImageViewType flat = VK_IMAGE_VIEW_TYPE_2D;
    bool ok = gpu_buffer_init(g, &e->uniforms, (VkDeviceSize)e->frames_in_flight * FRAME_UNIFORM_BYTES,
                              VK_BUFFER_USAGE_UNIFORM_BUFFER_BIT, GPU_MEMORY_UPLOAD) &&
              gpu_buffer_init(g, &e->counters, (VkDeviceSize)FRAME_RECORDS * COUNTER_STRIDE,
                              VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT |
                                  VK_BUFFER_USAGE_TRANSFER_SRC_BIT,
                              GPU_MEMORY_DEVICE) &&
              pages_init(&e->pages, g, STAGE_TOTAL_BYTES / e->frames_in_flight) && table_space_init(&e->tables, g) &&
              noise_volumes_init(e) && scattering_init(e) &&
              init_table(e, &e->air, half, VELUM_AIR_W, VELUM_AIR_H, flat) &&
              init_table(e, &e->glow, half, VELUM_GLOW_SIDE, 2 * VELUM_GLOW_SIDE, flat) &&
              init_table(e, &e->nothing, VK_FORMAT_R32_SFLOAT, 1, 1, flat) &&
              init_table(e, &e->nothing_layered, VK_FORMAT_R32_SFLOAT, 1, 1, VK_IMAGE_VIEW_TYPE_2D_ARRAY);
    for (uint32_t i = 0; ok && i < e->frames_in_flight; i++) {
        ok = frame_slot_init(e, &e->slots[i], i);
    }
    return ok;
}

static velum_result check_lend(const velum_vulkan_lend *lend, const log_sink *sink) {
    checker check = {sink, "engine", "create_engine", VELUM_OK};
    if (!check_flags(&check, "lend.flags", lend->flags, 0) || !check_pointer(&check, "lend.instance", lend->instance) ||
        !check_pointer(&check, "lend.physical_device", lend->physical_device) ||
        !check_pointer(&check, "lend.device", lend->device) ||
        !check_count(&check, "lend.frames_in_flight", lend->frames_in_flight, 1, FRAMES_MAX) ||
        (lend->enabled_extension_count > 0 &&
         !check_pointer(&check, "lend.enabled_extensions", lend->enabled_extensions))) {
        return check.result;
    }
    if (!lend->get_instance_proc_addr) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "lend.get_instance_proc_addr: found null");
        return check.result;
    }
    if (lend->api_version < VK_API_VERSION_1_3) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "lend.api_version: found %u.%u, expected 1.3 at least",
                   VK_API_VERSION_MAJOR(lend->api_version), VK_API_VERSION_MINOR(lend->api_version));
        return check.result;
    }
    if (lend->enabled_features && (!lend->enabled_features->shaderStorageImageWriteWithoutFormat ||
                                   !lend->enabled_features->shaderStorageImageExtendedFormats)) {
        check_fail(&check, VELUM_ERROR_UNSUPPORTED,
                   "lend.enabled_features: shaderStorageImageWriteWithoutFormat and shaderStorageImageExtendedFormats "
                   "are needed");
        return check.result;
    }
    char reason[128];
    velum_result result =
        gpu_check_device(lend->get_instance_proc_addr, lend->instance, lend->physical_device, reason, sizeof reason);
    if (result < 0) {
        check_fail(&check, result, "the device cannot serve: %s", reason);
    }
    return check.result;
}

velum_result engine_create(const velum_vulkan_lend *lend, world *w, bool arrays, velum_engine **out) {
    const log_sink sink = {lend->log, lend->log_context};
    velum_result result = check_lend(lend, &sink);
    if (result < 0) {
        return result;
    }
    engine *e = calloc(1, sizeof *e);
    if (!e) {
        return log_fail(&sink, VELUM_ERROR_OUT_OF_MEMORY, "engine", "create_engine: no memory");
    }
    e->sink = sink;
    e->w = w;
    e->frames_in_flight = lend->frames_in_flight;
    result = gpu_init(&e->g, lend, &e->sink);
    if (result < 0) {
        free(e);
        return result;
    }
    result = pipelines_init(&e->passes, &e->g, lend->pipeline_cache, lend->pipeline_cache_size, arrays);
    if (result < 0) {
        goto error;
    }
    if (!init_resources(e)) {
        result = gpu_result(&e->g);
        goto error;
    }
    e->handle = handle_create(HANDLE_ENGINE, e, w->handle, &e->sink);
    if (!e->handle) {
        result = log_fail(&sink, VELUM_ERROR_OUT_OF_MEMORY, "engine", "create_engine: too many objects");
        goto error;
    }
    atomic_fetch_add(&w->engines, 1);
    *out = e->handle;
    log_write(&e->sink, VELUM_LOG_INFO, "engine", "on %s; %.1f MB of device memory", e->g.properties.deviceName,
              (double)engine_weather_bytes(e) / 1e6);
    return VELUM_OK;
error:
    engine_free(e);
    return result;
}

velum_result engine_destroy(engine *e) {
    checker check = {&e->sink, "engine", "destroy", VELUM_OK};
    if (e->state != ENGINE_IDLE || e->inside) {
        check_fail(&check, VELUM_ERROR_STATE, "not legal inside a frame");
    } else if (e->eye_count > 0 || e->shadow_count > 0) {
        check_fail(&check, VELUM_ERROR_STATE, "%u eyes and %u shadow maps of it live", e->eye_count, e->shadow_count);
    } else if (e->completed_serial < e->newest_serial) {
        check_fail(&check, VELUM_ERROR_STATE, "submissions up to %llu are in flight, %llu are complete",
                   (unsigned long long)e->newest_serial, (unsigned long long)e->completed_serial);
    }
    if (check.result < 0) {
        return check.result;
    }
    objects_bury(e);
    handle_destroy(e->handle);
    if (e->release_owner) {
        e->release_owner(e->owner);
    }
    world *w = e->w;
    void *owner = e->owner;
    void (*destroy_owner)(void *) = e->destroy_owner;
    engine_free(e);
    atomic_fetch_sub(&w->engines, 1);
    if (destroy_owner) {
        destroy_owner(owner);
    }
    return VELUM_OK;
}

uint64_t engine_weather_bytes(const engine *e) {
    uint64_t bytes = e->pages.a.allocation.size + e->pages.b.allocation.size + e->pages.spans.allocation.size +
                     e->tables.buffer.allocation.size + e->shape.allocation.size + e->detail.allocation.size +
                     e->air.allocation.size + e->glow.allocation.size + e->scattering.allocation.size +
                     e->uniforms.allocation.size + e->counters.allocation.size;
    for (uint32_t i = 0; i < e->frames_in_flight; i++) {
        bytes += e->slots[i].staged.buffer.allocation.size + e->slots[i].counters.allocation.size;
    }
    for (const eye *y = e->eyes; y; y = y->next) {
        bytes += y->sky.allocation.size;
    }
    return bytes;
}

static void take_completed(engine *e, uint64_t serial) {
    e->completed_serial = serial;
    for (uint32_t i = 0; i < e->frames_in_flight; i++) {
        stats_read(e, &e->slots[(e->frames + i) % e->frames_in_flight]); /* the oldest first */
    }
    objects_bury(e);
}

velum_result engine_complete(engine *e, uint64_t completed_serial) {
    checker check = {&e->sink, "engine", "complete", VELUM_OK};
    if (e->state != ENGINE_IDLE || e->inside) {
        check_fail(&check, VELUM_ERROR_STATE, "not legal inside a frame");
        return check.result;
    }
    if (completed_serial < e->completed_serial) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "completed_serial: found %llu after %llu",
                   (unsigned long long)completed_serial, (unsigned long long)e->completed_serial);
        return check.result;
    }
    take_completed(e, completed_serial);
    return VELUM_OK;
}

static bool check_frame(checker *check, const engine *e, const velum_frame_info *f) {
    if (!check_flags(check, "frame.flags", f->flags, 0) ||
        !check_range(check, "frame.time_s", f->time_s, -1e15, 1e15) ||
        !check_unit(check, "frame.sun_direction_ecef", f->sun_direction_ecef) ||
        !check_range(check, "frame.sun_angular_radius_rad", (double)f->sun_angular_radius_rad, 0.0, 0.5) ||
        !check_range(check, "frame.atmosphere", f->atmosphere, VELUM_ATMOSPHERE_EARTH, VELUM_ATMOSPHERE_NONE)) {
        return false;
    }
    for (int i = 0; i < 3; i++) {
        if (!check_range(check, "frame.sun_illuminance_lx", (double)f->sun_illuminance_lx[i], 0.0, 1e9) ||
            !check_range(check, "frame.ground_albedo", (double)f->ground_albedo[i], 0.0, 1.0)) {
            return false;
        }
    }
    if (f->submit_serial <= e->newest_serial) {
        return check_fail(check, VELUM_ERROR_ARGUMENT, "frame.submit_serial: found %llu, expected above %llu",
                          (unsigned long long)f->submit_serial, (unsigned long long)e->newest_serial);
    }
    if (f->completed_serial >= f->submit_serial || f->completed_serial < e->completed_serial) {
        return check_fail(check, VELUM_ERROR_ARGUMENT, "frame.completed_serial: found %llu, expected %llu..%llu",
                          (unsigned long long)f->completed_serial, (unsigned long long)e->completed_serial,
                          (unsigned long long)(f->submit_serial - 1));
    }
    return true;
}

velum_result engine_begin_frame(engine *e, const velum_frame_info *frame) {
    checker check = {&e->sink, "engine", "begin_frame", VELUM_OK};
    velum_frame_info f;
    if (e->state != ENGINE_IDLE) {
        check_fail(&check, VELUM_ERROR_STATE, "the frame before has not ended");
        return check.result;
    }
    if (!check_in(&check, "frame", &f, sizeof f, frame, V1_FRAME_INFO) || !check_frame(&check, e, &f)) {
        return check.result;
    }
    frame_slot *slot = &e->slots[e->frames % e->frames_in_flight];
    if (slot->serial > f.completed_serial) {
        check_fail(&check, VELUM_ERROR_STATE,
                   "more than the %u frames in flight that were stated (%llu is not complete)", e->frames_in_flight,
                   (unsigned long long)slot->serial);
        return check.result;
    }
    take_completed(e, f.completed_serial);
    if (!frame_slot_begin(e, slot)) {
        return gpu_result(&e->g);
    }
    double length =
        sqrt(f.sun_direction_ecef[0] * f.sun_direction_ecef[0] + f.sun_direction_ecef[1] * f.sun_direction_ecef[1] +
             f.sun_direction_ecef[2] * f.sun_direction_ecef[2]);
    for (int i = 0; i < 3; i++) {
        f.sun_direction_ecef[i] /= length;
    }
    if (f.sun_angular_radius_rad == 0.0f) {
        f.sun_angular_radius_rad = 0.004654f;
    }
    world_weather_finish(&e->weather);
    world_weather_at(e->w, f.time_s, &e->weather);
    e->drift = core_drift_at(f.time_s, e->w->seed);
    if (e->drift.weight[0] == 0.0f) {
        /* Shaders that do not mix (blocks_mix) take the first phase. */
        const core_drift d = e->drift;
        e->drift = (core_drift){
            .tau_s = {d.tau_s[1], d.tau_s[0]}, .weight = {d.weight[1], d.weight[0]}, .cycle = {d.cycle[1], d.cycle[0]}};
        memcpy(e->drift.offset[0], d.offset[1], sizeof d.offset[1]);
        memcpy(e->drift.offset[1], d.offset[0], sizeof d.offset[0]);
    }
    e->frame = f;
    e->now = slot;
    e->frames++;
    slot->serial = f.submit_serial;
    e->newest_serial = f.submit_serial;
    pages_begin_frame(&e->pages);
    e->bound_shadow = NULL;
    e->state = ENGINE_BEGUN;
    return VELUM_OK;
}

velum_result engine_end_frame(engine *e) {
    if (e->state == ENGINE_IDLE) {
        return log_fail(&e->sink, VELUM_ERROR_STATE, "engine", "end_frame: no frame has begun");
    }
    e->state = ENGINE_IDLE;
    e->now = NULL;
    return VELUM_OK;
}
