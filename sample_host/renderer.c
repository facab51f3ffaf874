#include "renderer.h"

#include "report.h"
#include "text.h"
#include "view_geometry.h"

#include <math.h>
#include <string.h>

static const VkPipelineStageFlags2 compute_stage = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
static const VkPipelineStageFlags2 transfer_stage = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
static const VkAccessFlags2 compute_access = VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_SHADER_WRITE_BIT;

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Outward normal of the ellipsoid under a camera. */
static void vertical(const velum_scenario_camera *camera, double out[3]) {
    double low[3], high[3];
    scene_point(camera->lat_deg, camera->lon_deg, 0, low);
    scene_point(camera->lat_deg, camera->lon_deg, 1000, high);
    for (int i = 0; i < 3; i++) {
        out[i] = (high[i] - low[i]) / 1000;
    }
}

static double sun_sine(const struct renderer *renderer, const struct eye_pose *pose, double time_s) {
    double sun[3], up[3];
    velum_scenario_sun(renderer->scene->scenario, time_s, sun);
    vertical(&pose->camera, up);
    return dot(sun, up);
}

bool renderer_exposure(struct renderer *renderer, double time_s, float *out) {
    const velum_scenario *scenario = renderer->scene->scenario;
    struct cloud_cover cover;
    struct eye_pose pose;
    scene_pose(renderer->scene, time_s, &pose);
    if (!cover_around(renderer->scene, &renderer->cover_over_eye, &pose.camera, pose.camera.height_m, time_s, &cover)) {
        return false;
    }
    *out = (float)daylight_exposure(sun_sine(renderer, &pose, time_s), scenario->sun_illuminance_lx,
                                    !scenario->atmosphere_none, &cover);
    return true;
}

bool renderer_wait(struct renderer *renderer) {
    const VkSemaphoreWaitInfo wait = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                      .semaphoreCount = 1,
                                      .pSemaphores = &renderer->timeline,
                                      .pValues = &renderer->submitted};
    struct plugin *plugin = &renderer->scene->plugin;
    if (!device_ok(vkWaitSemaphores(renderer->device->handle, &wait, UINT64_MAX), "vkWaitSemaphores")) {
        return false;
    }
    velum_result result = plugin->engine->complete(renderer->engine, renderer->submitted);
    if (result < 0) {
        plugin_report(plugin, "frame", result);
    }
    return result >= 0;
}

static bool prepare(struct renderer *renderer, double time_s) {
    struct plugin *plugin = &renderer->scene->plugin;
    velum_prepare_eye eye = {.struct_size = sizeof eye, .time_s = time_s, .pixel_rad = 1};
    memcpy(eye.position_ecef_m, renderer->pose.position_m, sizeof eye.position_ecef_m);
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        const struct renderer_channel *channel = &renderer->channels[i];
        eye.pixel_rad = fmin(eye.pixel_rad, view_geometry_pixel_rad(&channel->frame, channel->width, channel->height));
    }
    const velum_prepare_info info = {.struct_size = sizeof info, .eyes = &eye, .eye_count = 1};
    velum_result result = plugin->world->prepare(renderer->scene->world, &info);
    if (result < 0) {
        plugin_report(plugin, "tiles", result);
    }
    return result >= 0;
}

static bool wait_for_slot(struct renderer *renderer, struct renderer_slot *slot, uint64_t *completed) {
    VkDevice device = renderer->device->handle;
    const VkSemaphoreWaitInfo wait = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO,
                                      .semaphoreCount = 1,
                                      .pSemaphores = &renderer->timeline,
                                      .pValues = &slot->serial};
    const VkCommandBufferBeginInfo begin = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                            .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    return device_ok(vkWaitSemaphores(device, &wait, UINT64_MAX), "vkWaitSemaphores") &&
           device_ok(vkGetSemaphoreCounterValue(device, renderer->timeline, completed), "vkGetSemaphoreCounterValue") &&
           device_ok(vkResetCommandPool(device, slot->pool, 0), "vkResetCommandPool") &&
           device_ok(vkBeginCommandBuffer(slot->commands, &begin), "vkBeginCommandBuffer");
}

/* Everything of the host's own passes that is the same for all channels. */
struct lighting {
    double sun[3];
    struct daylight daylight;
    double shadow_origin_m[3];
};

static velum_result begin_frame(struct renderer *renderer, const struct frame_request *request, uint64_t completed,
                                struct renderer_slot *slot, struct lighting *lighting) {
    const velum_scenario *scenario = renderer->scene->scenario;
    struct plugin *plugin = &renderer->scene->plugin;
    velum_frame_info frame = {.struct_size = sizeof frame,
                              .submit_serial = renderer->submitted + 1,
                              .completed_serial = completed,
                              .time_s = request->time_s,
                              .atmosphere = scenario->atmosphere_none ? VELUM_ATMOSPHERE_NONE : VELUM_ATMOSPHERE_EARTH};
    memcpy(frame.sun_direction_ecef, lighting->sun, sizeof frame.sun_direction_ecef);
    memcpy(frame.sun_illuminance_lx, scenario->sun_illuminance_lx, sizeof frame.sun_illuminance_lx);
    memcpy(frame.ground_albedo, scenario->ground_albedo, sizeof frame.ground_albedo);
    velum_eye_frame eye = {
        .struct_size = sizeof eye, .flags = request->reset ? VELUM_EYE_RESET : 0, .eye = renderer->eye};
    memcpy(eye.position_ecef_m, renderer->pose.position_m, sizeof eye.position_ecef_m);
    velum_shadow_frame shadow = {.struct_size = sizeof shadow};
    scene_point(renderer->pose.camera.lat_deg, renderer->pose.camera.lon_deg, (double)scenario->geoid_undulation_m,
                shadow.centre_ecef_m);
    velum_shadow_geometry geometry = {.struct_size = sizeof geometry};

    velum_result result = plugin->engine->begin_frame(renderer->engine, &frame);
    if (result >= 0) {
        renderer->begun = frame.submit_serial;
        result = plugin->vulkan->record_shared(renderer->engine, slot->commands, &eye, 1, sizeof eye);
    }
    if (result >= 0) {
        result = plugin->vulkan->record_shadow(renderer->shadow, slot->commands, &shadow);
    }
    if (result >= 0) {
        result = plugin->engine->get_shadow_geometry(renderer->shadow, &geometry);
    }
    memcpy(lighting->shadow_origin_m, geometry.origin_ecef_m, sizeof geometry.origin_ecef_m);
    memcpy(slot->shadow_block.mapped, &geometry.block, sizeof geometry.block);
    return result;
}

/* A frame that only settles is seen by nobody. */
static bool composed(const struct frame_request *request) {
    return request->read_back || request->lines;
}

/* Fields where the ground is of their colour; water and snow are almost even. */
static float pattern_strength(const float albedo[3]) {
    float least = fminf(albedo[0], albedo[1]);
    float ratio = least / fmaxf(albedo[2], 1e-3f);
    float green = fminf(fmaxf((ratio - 1) / 0.2f, 0), 1);
    return fmaxf(green, 0.12f);
}

static void fill_arguments(struct renderer *renderer, struct renderer_channel *channel, uint32_t slot,
                           const struct frame_request *request, const struct lighting *lighting) {
    const velum_scenario *scenario = renderer->scene->scenario;
    struct host_view_arguments arguments = {.sun = {0}};
    view_geometry_ground(&channel->frame, channel->width, channel->height, (double)scenario->geoid_undulation_m,
                         &arguments);
    for (int i = 0; i < 3; i++) {
        arguments.shadow_offset[i] = (float)(renderer->pose.position_m[i] - lighting->shadow_origin_m[i]);
        arguments.sun[i] = (float)lighting->sun[i];
        arguments.sun_lx[i] = lighting->daylight.sun_lx[i];
        arguments.sky_lx[i] = lighting->daylight.sky_lx[i];
        arguments.albedo[i] = scenario->ground_albedo[i];
    }
    arguments.albedo[3] = scenario->atmosphere_none ? 0 : pattern_strength(scenario->ground_albedo);
    arguments.region_cell[3] = request->exposure;
    arguments.wood_cell[3] = 1 / channel->frame.luminance_scale;
    if (request->lines) {
        uint32_t columns =
            text_draw(request->lines[channel - renderer->channels], RENDERER_LINE_MAX, channel->overlay[slot].mapped);
        arguments.region_part[3] = (float)columns;
        arguments.wood_part[3] = channel->width >= 1280 ? 2.0f : 1.0f;
    }
    memcpy(channel->arguments[slot].mapped, &arguments, sizeof arguments);
}

static void dispatch(const struct gpu_pipeline *pipeline, VkCommandBuffer commands,
                     const struct renderer_channel *channel, uint32_t slot) {
    const uint32_t group = HOST_GROUP_SIZE;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->handle);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline->layout, 0, 1, &channel->sets[slot], 0,
                            NULL);
    vkCmdDispatch(commands, (channel->width + group - 1) / group, (channel->height + group - 1) / group, 1);
}

static velum_result record_view(struct renderer *renderer, struct renderer_channel *channel, VkCommandBuffer commands) {
    const velum_vulkan_images images = {.struct_size = sizeof images,
                                        .luminance = channel->luminance.view,
                                        .transmittance = channel->transmittance.view,
                                        .distance = channel->distance.view,
                                        .variance = channel->variance.view,
                                        .depth = channel->depth.view,
                                        .depth_layout = VK_IMAGE_LAYOUT_GENERAL,
                                        .format = channel->luminance.format,
                                        .width = channel->width,
                                        .height = channel->height};
    return renderer->scene->plugin.vulkan->record_view(channel->view, commands, &channel->frame, &images);
}

static void place_views(struct renderer *renderer, const struct frame_request *request) {
    const velum_scenario *scenario = renderer->scene->scenario;
    scene_pose(renderer->scene, request->time_s, &renderer->pose);
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        struct renderer_channel *channel = &renderer->channels[i];
        view_geometry_frame(&renderer->pose, &channel->info, channel->width, channel->height, &channel->frame);
        channel->frame.path_limit = renderer->path_limit;
        channel->frame.luminance_scale = renderer->full_precision ? 1 : request->exposure;
        if (!scenario->atmosphere_none) {
            channel->frame.flags |= VELUM_VIEW_SUN_DISC;
        }
    }
}

static void copy_back(struct renderer *renderer, VkCommandBuffer commands) {
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        const struct renderer_channel *channel = &renderer->channels[i];
        gpu_copy_image(commands, &channel->picture, &channel->readback, 0);
        if (!renderer->full_precision) {
            continue;
        }
        gpu_copy_image(commands, &channel->luminance, &channel->readback, channel->luminance_at);
        gpu_copy_image(commands, &channel->transmittance, &channel->readback, channel->transmittance_at);
        gpu_copy_image(commands, &channel->distance, &channel->readback, channel->distance_at);
        gpu_copy_image(commands, &channel->variance, &channel->readback, channel->variance_at);
    }
    gpu_barrier(commands, transfer_stage, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT,
                VK_ACCESS_2_HOST_READ_BIT);
}

VkCommandBuffer renderer_record(struct renderer *renderer, const struct frame_request *request) {
    const velum_scenario *scenario = renderer->scene->scenario;
    struct plugin *plugin = &renderer->scene->plugin;
    uint32_t s = (uint32_t)(renderer->submitted % renderer->slot_count);
    struct renderer_slot *slot = &renderer->slots[s];
    VkCommandBuffer commands = slot->commands;
    struct lighting lighting;
    struct cloud_cover cover;
    uint64_t completed = 0;

    place_views(renderer, request);
    velum_scenario_sun(scenario, request->time_s, lighting.sun);
    if (!prepare(renderer, request->time_s) ||
        !cover_around(renderer->scene, &renderer->cover_over_ground, &renderer->pose.camera,
                      (double)scenario->geoid_undulation_m, request->time_s, &cover) ||
        !wait_for_slot(renderer, slot, &completed)) {
        return VK_NULL_HANDLE;
    }
    daylight_compute(sun_sine(renderer, &renderer->pose, request->time_s), scenario->sun_illuminance_lx,
                     !scenario->atmosphere_none, &cover, &lighting.daylight);
    if (renderer->submitted == 0) {
        for (uint32_t i = 0; i < renderer->channel_count; i++) {
            struct renderer_channel *channel = &renderer->channels[i];
            const VkImage images[] = {channel->colour.handle,    channel->depth.handle,
                                      channel->luminance.handle, channel->transmittance.handle,
                                      channel->distance.handle,  channel->picture.handle,
                                      channel->variance.handle};
            for (int k = 0; k < 7; k++) {
                gpu_image_to_general(commands, images[k]);
            }
        }
    }
    renderer->incomplete = false;
    velum_result result = begin_frame(renderer, request, completed, slot, &lighting);
    if (result < 0) {
        plugin_report(plugin, "frame", result);
        plugin->engine->end_frame(renderer->engine);
        return VK_NULL_HANDLE;
    }
    renderer->incomplete = result == VELUM_INCOMPLETE;
    /* The shadow map to the ground pass, and the frame before out of the images' way. */
    gpu_barrier(commands, compute_stage | transfer_stage, VK_ACCESS_2_SHADER_WRITE_BIT, compute_stage, compute_access);
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        fill_arguments(renderer, &renderer->channels[i], s, request, &lighting);
        dispatch(composed(request) ? &renderer->ground : &renderer->ground_depth, commands, &renderer->channels[i], s);
    }
    gpu_barrier(commands, compute_stage, VK_ACCESS_2_SHADER_WRITE_BIT, compute_stage, compute_access);
    for (uint32_t i = 0; i < renderer->channel_count; i++) {
        result = record_view(renderer, &renderer->channels[i], commands);
        if (result < 0) {
            plugin_report(plugin, renderer->channels[i].info.name, result);
            plugin->engine->end_frame(renderer->engine);
            return VK_NULL_HANDLE;
        }
        renderer->incomplete = renderer->incomplete || result == VELUM_INCOMPLETE;
    }
    result = plugin->engine->end_frame(renderer->engine);
    if (result < 0) {
        plugin_report(plugin, "frame", result);
        return VK_NULL_HANDLE;
    }
    gpu_barrier(commands, compute_stage, VK_ACCESS_2_SHADER_WRITE_BIT, compute_stage, compute_access);
    for (uint32_t i = 0; composed(request) && i < renderer->channel_count; i++) {
        dispatch(&renderer->compose, commands, &renderer->channels[i], s);
    }
    gpu_barrier(commands, compute_stage, VK_ACCESS_2_SHADER_WRITE_BIT, compute_stage | transfer_stage,
                VK_ACCESS_2_SHADER_READ_BIT | VK_ACCESS_2_TRANSFER_READ_BIT);
    if (request->read_back) {
        copy_back(renderer, commands);
    }
    return commands;
}

bool renderer_submit(struct renderer *renderer, const VkSemaphore *wait, uint32_t wait_count, const VkSemaphore *signal,
                     uint32_t signal_count) {
    enum { MAX = 32 };
    struct renderer_slot *slot = &renderer->slots[renderer->submitted % renderer->slot_count];
    VkSemaphoreSubmitInfo waits[MAX], signals[MAX + 1];
    if (wait_count > MAX || signal_count > MAX) {
        report_error("too many windows");
        return false;
    }
    for (uint32_t i = 0; i < wait_count; i++) {
        waits[i] = (VkSemaphoreSubmitInfo){
            .sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO, .semaphore = wait[i], .stageMask = transfer_stage};
    }
    for (uint32_t i = 0; i < signal_count; i++) {
        signals[i] = (VkSemaphoreSubmitInfo){.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                             .semaphore = signal[i],
                                             .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    }
    signals[signal_count] = (VkSemaphoreSubmitInfo){.sType = VK_STRUCTURE_TYPE_SEMAPHORE_SUBMIT_INFO,
                                                    .semaphore = renderer->timeline,
                                                    .value = renderer->submitted + 1,
                                                    .stageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT};
    const VkCommandBufferSubmitInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_SUBMIT_INFO,
                                                .commandBuffer = slot->commands};
    const VkSubmitInfo2 submit = {.sType = VK_STRUCTURE_TYPE_SUBMIT_INFO_2,
                                  .waitSemaphoreInfoCount = wait_count,
                                  .pWaitSemaphoreInfos = waits,
                                  .commandBufferInfoCount = 1,
                                  .pCommandBufferInfos = &commands,
                                  .signalSemaphoreInfoCount = signal_count + 1,
                                  .pSignalSemaphoreInfos = signals};
    if (!device_ok(vkEndCommandBuffer(slot->commands), "vkEndCommandBuffer") ||
        !device_ok(vkQueueSubmit2(renderer->device->queue, 1, &submit, VK_NULL_HANDLE), "vkQueueSubmit2")) {
        return false;
    }
    slot->serial = ++renderer->submitted;
    return true;
}
