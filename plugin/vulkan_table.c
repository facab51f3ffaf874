#include "engine.h"
#include "handle.h"
#include "tables.h"

#define OBJECT(type, name, handle, which, call)                                                                        \
    type *name = handle_get(handle, which);                                                                            \
    if (!name) {                                                                                                       \
        return handle_fail(handle, which, call);                                                                       \
    }

static velum_result refuse_standalone(const engine *e, const char *call) {
    return e->owner ? log_fail(&e->sink, VELUM_ERROR_STATE, "engine", "%s: not legal on a standalone engine", call)
                    : VELUM_OK;
}

static velum_result VELUM_CALL get_requirements(velum_vulkan_requirements *out) {
    if (!out) {
        return VELUM_ERROR_ARGUMENT;
    }
    if (out->struct_size < V1_VULKAN_REQUIREMENTS) {
        return VELUM_ERROR_STRUCT_SIZE;
    }
    write_struct(out, gpu_requirements(), sizeof *out);
    return VELUM_OK;
}

static velum_result VELUM_CALL check_device(PFN_vkGetInstanceProcAddr get, VkInstance instance, VkPhysicalDevice device,
                                            char *reason, uint32_t reason_size) {
    if (!get || !instance || !device) {
        return VELUM_ERROR_ARGUMENT;
    }
    return gpu_check_device(get, instance, device, reason, reason_size);
}

static velum_result VELUM_CALL create_engine(const velum_vulkan_lend *lend, velum_engine **out) {
    log_sink sink = {0};
    checker check = {&sink, "engine", "create_engine", VELUM_OK};
    velum_vulkan_lend l;
    if (!check_pointer(&check, "out", out) || !check_in(&check, "lend", &l, sizeof l, lend, V1_VULKAN_LEND)) {
        return check.result;
    }
    sink = (log_sink){l.log, l.log_context};
    world *w = handle_get(l.world, HANDLE_WORLD);
    if (!w) {
        check_fail(&check, VELUM_ERROR_HANDLE, "lend.world: not a live world");
        return check.result;
    }
    return engine_create(&l, w, true, out);
}

static velum_result VELUM_CALL get_pipeline_cache(velum_engine *handle, void *data, uint64_t *size) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "get_pipeline_cache")
    if (!size) {
        return log_fail(&e->sink, VELUM_ERROR_ARGUMENT, "engine", "get_pipeline_cache: size: found null");
    }
    return pipelines_get_cache(&e->passes, &e->g, data, size);
}

static velum_result VELUM_CALL table_record_shared(velum_engine *handle, VkCommandBuffer commands,
                                                   const velum_eye_frame *eyes, uint32_t eye_count,
                                                   uint32_t eye_stride) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "record_shared")
    velum_result result = refuse_standalone(e, "record_shared");
    return result < 0 ? result : record_shared(e, commands, eyes, eye_count, eye_stride);
}

static velum_result VELUM_CALL table_record_view(velum_view *handle, VkCommandBuffer commands,
                                                 const velum_view_frame *frame, const velum_vulkan_images *images) {
    OBJECT(view, v, handle, HANDLE_VIEW, "record_view")
    velum_result result = refuse_standalone(v->eye->e, "record_view");
    return result < 0 ? result : record_view(v, commands, frame, images);
}

static velum_result VELUM_CALL table_record_shadow(velum_shadow *handle, VkCommandBuffer commands,
                                                   const velum_shadow_frame *frame) {
    OBJECT(shadow, s, handle, HANDLE_SHADOW, "record_shadow")
    velum_result result = refuse_standalone(s->e, "record_shadow");
    return result < 0 ? result : record_shadow(s, commands, frame);
}

static velum_result VELUM_CALL get_shadow_image(velum_shadow *handle, velum_vulkan_shadow *out) {
    OBJECT(shadow, s, handle, HANDLE_SHADOW, "get_shadow_image")
    checker check = {&s->e->sink, "shadow", "get_shadow_image", VELUM_OK};
    if (!check_out(&check, "out", out, V1_VULKAN_SHADOW)) {
        return check.result;
    }
    velum_vulkan_shadow answer = {.levels = s->levels,
                                  .image = s->image.image,
                                  .view = s->image.view,
                                  .sampler = s->e->passes.linear,
                                  .format = s->image.format,
                                  .texels = s->texels};
    write_struct(out, &answer, sizeof answer);
    return VELUM_OK;
}

const velum_vulkan_api velum_vulkan_table = {.struct_size = sizeof velum_vulkan_table,
                                             .get_requirements = get_requirements,
                                             .check_device = check_device,
                                             .create_engine = create_engine,
                                             .get_pipeline_cache = get_pipeline_cache,
                                             .record_shared = table_record_shared,
                                             .record_view = table_record_view,
                                             .record_shadow = table_record_shadow,
                                             .get_shadow_image = get_shadow_image};
