#include "shadow_map.h"

#include "exr.h"
#include "files.h"
#include "json.h"
#include "renderer.h"
#include "report.h"

#include "shadow_read_spirv.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

enum { LEVELS_MAX = 4, FRAMES = 16 };

static const double wgs84_a_m = 6378137.0;
static const double wgs84_b_m = 6356752.314245179;

/* The texels of the plugin's map, as floats. */
struct reader {
    velum_vulkan_shadow shadow;
    VkDescriptorSetLayout set_layout;
    VkDescriptorPool pool;
    VkDescriptorSet set;
    struct gpu_pipeline pipeline;
    struct gpu_buffer texels;
};

static bool reader_init(struct reader *reader, struct renderer *renderer) {
    struct device *device = renderer->device;
    struct plugin *plugin = &renderer->scene->plugin;
    reader->shadow.struct_size = sizeof reader->shadow;
    velum_result result = plugin->vulkan->get_shadow_image(renderer->shadow, &reader->shadow);
    if (result < 0) {
        plugin_report(plugin, "shadow map", result);
        return false;
    }
    const VkDescriptorSetLayoutBinding bindings[] = {
        {0, VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1, VK_SHADER_STAGE_COMPUTE_BIT, NULL},
        {1, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, NULL}};
    const VkDescriptorSetLayoutCreateInfo layout = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = 2, .pBindings = bindings};
    const VkDescriptorPoolSize sizes[] = {{VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, 1},
                                          {VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1}};
    const VkDescriptorPoolCreateInfo pool = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO, .maxSets = 1, .poolSizeCount = 2, .pPoolSizes = sizes};
    VkDeviceSize count = (VkDeviceSize)reader->shadow.levels * reader->shadow.texels * reader->shadow.texels;
    if (!gpu_buffer_create(device, count * sizeof(float), VK_BUFFER_USAGE_STORAGE_BUFFER_BIT, true, &reader->texels) ||
        !device_ok(vkCreateDescriptorSetLayout(device->handle, &layout, NULL, &reader->set_layout),
                   "vkCreateDescriptorSetLayout") ||
        !device_ok(vkCreateDescriptorPool(device->handle, &pool, NULL, &reader->pool), "vkCreateDescriptorPool") ||
        !gpu_pipeline_create(device, shadow_read_spirv, sizeof shadow_read_spirv, NULL, reader->set_layout,
                             &reader->pipeline)) {
        return false;
    }
    const VkDescriptorSetAllocateInfo info = {.sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO,
                                              .descriptorPool = reader->pool,
                                              .descriptorSetCount = 1,
                                              .pSetLayouts = &reader->set_layout};
    if (!device_ok(vkAllocateDescriptorSets(device->handle, &info, &reader->set), "vkAllocateDescriptorSets")) {
        return false;
    }
    const VkDescriptorImageInfo image = {reader->shadow.sampler, reader->shadow.view, VK_IMAGE_LAYOUT_GENERAL};
    const VkDescriptorBufferInfo buffer = {reader->texels.handle, 0, VK_WHOLE_SIZE};
    const VkWriteDescriptorSet writes[] = {{.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = reader->set,
                                            .dstBinding = 0,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
                                            .pImageInfo = &image},
                                           {.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                            .dstSet = reader->set,
                                            .dstBinding = 1,
                                            .descriptorCount = 1,
                                            .descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
                                            .pBufferInfo = &buffer}};
    vkUpdateDescriptorSets(device->handle, 2, writes, 0, NULL);
    return true;
}

static void reader_finish(struct reader *reader, struct device *device) {
    if (device->handle) {
        gpu_pipeline_destroy(device, &reader->pipeline);
        gpu_buffer_destroy(device, &reader->texels);
        vkDestroyDescriptorPool(device->handle, reader->pool, NULL);
        vkDestroyDescriptorSetLayout(device->handle, reader->set_layout, NULL);
    }
}

static void reader_record(const struct reader *reader, VkCommandBuffer commands) {
    uint32_t groups = (reader->shadow.texels + 7) / 8;
    vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, reader->pipeline.handle);
    vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, reader->pipeline.layout, 0, 1, &reader->set, 0,
                            NULL);
    vkCmdDispatch(commands, groups, groups, reader->shadow.levels);
    gpu_barrier(commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_WRITE_BIT,
                VK_PIPELINE_STAGE_2_HOST_BIT, VK_ACCESS_2_HOST_READ_BIT);
}

static bool render(struct renderer *renderer, const struct reader *reader, double time_s) {
    struct frame_request request = {.time_s = time_s, .reset = true, .exposure = 1};
    for (int i = 0; i < FRAMES; i++) {
        VkCommandBuffer commands = renderer_record(renderer, &request);
        if (!commands) {
            return false;
        }
        reader_record(reader, commands);
        if (!renderer_submit(renderer, NULL, 0, NULL, 0) || !renderer_wait(renderer)) {
            return false;
        }
        request.reset = false;
    }
    if (renderer->incomplete) {
        report_warning("the map lacks detail: tiles were missing");
    }
    return true;
}

/* Where a line along the sun through a point of the map meets the ellipsoid, on the sun's side. */
static bool ground_below(const double point[3], const double sun[3], double out[3]) {
    double stretch = wgs84_a_m / wgs84_b_m;
    double p[3] = {point[0], point[1], point[2] * stretch}, d[3] = {sun[0], sun[1], sun[2] * stretch};
    double a = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    double b = p[0] * d[0] + p[1] * d[1] + p[2] * d[2];
    double c = p[0] * p[0] + p[1] * p[1] + p[2] * p[2] - wgs84_a_m * wgs84_a_m;
    double root = b * b - a * c;
    if (root < 0) {
        return false;
    }
    double t = (-b + sqrt(root)) / a;
    for (int i = 0; i < 3; i++) {
        out[i] = point[i] + t * sun[i];
    }
    return true;
}

static json_t *corner_object(struct scene *scene, const velum_shadow_geometry *geometry, uint32_t level, double u,
                             double v, double time_s) {
    const velum_shadow_block *block = &geometry->block;
    double extent = (double)block->level[level][0];
    double across = (u - (double)block->level[level][1]) * extent;
    double along = (v - (double)block->level[level][2]) * extent;
    double point[3], sun[3], ground[3];
    for (int i = 0; i < 3; i++) {
        point[i] = geometry->origin_ecef_m[i] + across * (double)block->axis_u[i] + along * (double)block->axis_v[i];
        sun[i] = (double)block->sun[i];
    }
    if (!ground_below(point, sun, ground)) {
        return json_null();
    }
    velum_point_query query = {.struct_size = sizeof query, .time_s = time_s};
    velum_point_answer answer = {.struct_size = sizeof answer};
    memcpy(query.position_ecef_m, ground, sizeof ground);
    if (scene->plugin.world->query_point(scene->world, &query, &answer) < 0) {
        return json_null();
    }
    const double place[2] = {answer.lat_deg, answer.lon_deg};
    return json_doubles(place, 2);
}

static json_t *geometry_object(struct scene *scene, const velum_shadow_geometry *geometry,
                               const char *const names[LEVELS_MAX], double time_s) {
    static const double corners[4][2] = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
    const velum_shadow_block *block = &geometry->block;
    json_t *object = json_object(), *levels = json_array();
    json_object_set_new(object, "time_s", json_number(time_s));
    json_object_set_new(object, "texels", json_integer(geometry->texels));
    json_object_set_new(object, "origin_ecef_m", json_doubles(geometry->origin_ecef_m, 3));
    json_object_set_new(object, "axis_u", json_floats(block->axis_u, 3));
    json_object_set_new(object, "axis_v", json_floats(block->axis_v, 3));
    json_object_set_new(object, "sun", json_floats(block->sun, 3));
    for (uint32_t k = 0; k < geometry->levels && k < LEVELS_MAX; k++) {
        json_t *level = json_object(), *places = json_array();
        json_object_set_new(level, "channel", json_string(names[k]));
        json_object_set_new(level, "extent_m", json_number((double)block->level[k][0]));
        json_object_set_new(level, "texel_m", json_number((double)block->level[k][0] / geometry->texels));
        json_object_set_new(level, "offset", json_floats(&block->level[k][1], 2));
        for (int i = 0; i < 4; i++) {
            json_array_append_new(places, corner_object(scene, geometry, k, corners[i][0], corners[i][1], time_s));
        }
        /* First and last texel of the first row, then of the last, where the sun's line meets the ground. */
        json_object_set_new(level, "corners_lat_lon_deg", places);
        json_array_append_new(levels, level);
    }
    json_object_set_new(object, "levels", levels);
    return object;
}

static bool write_map(const struct options *options, struct renderer *renderer, const struct reader *reader) {
    static const char *const names[LEVELS_MAX] = {"Y", "level1.Y", "level2.Y", "level3.Y"};
    struct plugin *plugin = &renderer->scene->plugin;
    struct exr_channel channels[LEVELS_MAX];
    uint32_t texels = reader->shadow.texels;
    uint32_t levels = reader->shadow.levels < LEVELS_MAX ? reader->shadow.levels : LEVELS_MAX;
    velum_shadow_geometry geometry = {.struct_size = sizeof geometry};
    velum_result result = plugin->engine->get_shadow_geometry(renderer->shadow, &geometry);
    if (result < 0) {
        plugin_report(plugin, "shadow map", result);
        return false;
    }
    for (uint32_t k = 0; k < levels; k++) {
        const float *texel = reader->texels.mapped;
        channels[k] = (struct exr_channel){names[k], texel + (size_t)k * texels * texels, 1};
    }
    if (!exr_write(options->out, texels, texels, channels, levels)) {
        return false;
    }
    if (!json_print(geometry_object(renderer->scene, &geometry, names, options->at_s), stdout, JSON_INDENT(1))) {
        report_error("cannot write to stdout");
        return false;
    }
    return true;
}

bool shadow_map(const struct options *options) {
    const struct device_info info = {.device = options->device, .validate = options->validate};
    /* The map comes with a frame: one small view makes that. */
    struct options small = *options;
    struct scene scene = {.scenario = NULL};
    struct device device = {.instance = VK_NULL_HANDLE};
    struct renderer renderer = {.device = NULL};
    struct reader reader = {.pool = VK_NULL_HANDLE};
    small.width = small.height = 16;
    const struct renderer_info setup = {.options = &small, .frames_in_flight = 1};
    struct files_folder made;
    bool done = files_prepare_parent(options->out, &made) && scene_init(&scene, options) &&
                device_init(&device, &scene.plugin, &info) && renderer_init(&renderer, &scene, &device, &setup) &&
                reader_init(&reader, &renderer) && render(&renderer, &reader, options->at_s) &&
                write_map(options, &renderer, &reader);
    reader_finish(&reader, &device);
    renderer_finish(&renderer);
    device_finish(&device);
    scene_finish(&scene);
    if (!done) {
        files_remove_empty(&made);
    }
    if (atomic_load(&device.messages) > 0) {
        report_error("%u validation messages", atomic_load(&device.messages));
        done = false;
    }
    return done;
}
