/* Images and buffers of a view: its rays, its history. */
#include <stdlib.h>

#include "light_volume.h"

_Static_assert(9 * VELUM_FINER_PLACES + VELUM_FINER_NINTHS * 3 * (VELUM_FINER_PLACES + 1) <= 9 * VELUM_LIT_ROOM,
               "finer rays have room for their places and heads");
_Static_assert(9 * VELUM_FINER_PLACES + VELUM_FINER_NINTHS * (3 * VELUM_FINER_PLACES + 1) <= 9 * VELUM_LIT_ROOM &&
                   9 > 4 * VELUM_FINER_NINTHS && VELUM_LIT_PLACES <= VELUM_LIT_ROOM,
               "the list has room for all places and, in its last quarter of a block each, finer blocks");

static VkDeviceSize list_at(uint32_t rays_w, uint32_t rays_h) {
    const VkDeviceSize step = 256; /* storage buffers' offsets are multiples of at most this (Vulkan 1.3, limits) */
    const VkDeviceSize bytes = VELUM_LIT_HEAD_BYTES + (VkDeviceSize)rays_w * rays_h * VELUM_LIT_ROOM * VELUM_LIT_BYTES;
    return (bytes + step - 1) / step * step;
}

VkDeviceSize view_images_list_at(const view *v) {
    return list_at(v->march_light.extent.width, v->march_light.extent.height);
}

bool view_images_hold(const view *v, uint32_t rays_w, uint32_t rays_h) {
    const gpu *g = &v->eye->e->g;
    return list_at(rays_w, rays_h) / VELUM_LIT_BYTES <= g->properties.limits.maxTexelBufferElements;
}

static VkDeviceSize rays_bytes(const view *v) {
    return v->march_light.allocation.size + v->march_distance.allocation.size + v->lit.allocation.size +
           v->rays.allocation.size;
}

static void finish_rays(gpu *g, view *v) {
    v->bytes -= rays_bytes(v);
    gpu_image_finish(g, &v->march_light);
    gpu_image_finish(g, &v->march_distance);
    gpu_buffer_finish(g, &v->lit);
    gpu_buffer_finish(g, &v->rays);
}

static bool init_rays(gpu *g, view *v, uint32_t w, uint32_t h) {
    const VkBufferUsageFlags usage = VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                                     VK_BUFFER_USAGE_INDIRECT_BUFFER_BIT | VK_BUFFER_USAGE_TRANSFER_DST_BIT;
    const VkDeviceSize blocks = (VkDeviceSize)w * h;
    const VkDeviceSize rays = blocks + blocks * VELUM_FINER_NINTHS / 9 * 3;
    const VkDeviceSize bytes = list_at(w, h) + (blocks * VELUM_LIT_ROOM + rays) * sizeof(uint32_t);
    const VkDeviceSize tiles_w = (w + VELUM_TILE_RAYS_W - 1) / VELUM_TILE_RAYS_W;
    const VkDeviceSize ray_count = blocks + tiles_w * ((h + VELUM_TILE_RAYS_H - 1) / VELUM_TILE_RAYS_H);
    bool ok = gpu_image_init_storage(g, &v->march_light, VK_FORMAT_R16G16B16A16_SFLOAT, w, h) &&
              gpu_image_init_storage(g, &v->march_distance, VK_FORMAT_R32_SFLOAT, w, h) &&
              gpu_buffer_init(g, &v->lit, bytes, usage, GPU_MEMORY_DEVICE) &&
              gpu_buffer_view(g, &v->lit, VK_FORMAT_R16G16B16A16_SFLOAT, list_at(w, h)) &&
              gpu_buffer_init(g, &v->rays, ray_count * 2 * sizeof(uint32_t), usage, GPU_MEMORY_DEVICE) &&
              gpu_buffer_view(g, &v->rays, VK_FORMAT_R32G32_UINT, VK_WHOLE_SIZE);
    v->bytes += rays_bytes(v);
    return ok;
}

_Static_assert(VIEW_SIDE_MOST / PATH_BLOCK * (VIEW_SIDE_MOST / PATH_BLOCK) * VELUM_LIT_ROOM + 64 <= GPU_TEXELS_LEAST,
               "rays that every view begins with");

bool view_images_init(view *v) {
    gpu *g = &v->eye->e->g;
    if (v->eye->quality == VELUM_QUALITY_REFERENCE) {
        return reference_init(v);
    }
    /* Rays of one in 16 pixels; a plan that asks for more makes these grow. */
    bool ok = init_rays(g, v, (v->width + PATH_BLOCK - 1) / PATH_BLOCK, (v->height + PATH_BLOCK - 1) / PATH_BLOCK);
    for (uint32_t i = 0; ok && i < 2; i++) {
        ok = gpu_image_init_storage(g, &v->history[i], VK_FORMAT_R16G16B16A16_SFLOAT, v->width, v->height) &&
             gpu_image_init_storage(g, &v->history_data[i], VK_FORMAT_R16G16_SFLOAT, v->width, v->height);
        v->bytes += v->history[i].allocation.size + v->history_data[i].allocation.size;
    }
    return ok;
}

void view_images_finish(gpu *g, view *v) {
    reference_finish(g, v);
    finish_rays(g, v);
    light_volume_finish(g, v);
    for (uint32_t i = 0; i < 2; i++) {
        gpu_image_finish(g, &v->history[i]);
        gpu_image_finish(g, &v->history_data[i]);
    }
}

bool view_images_grow(view *v, uint32_t rays_w, uint32_t rays_h) {
    engine *e = v->eye->e;
    if (rays_w <= v->march_light.extent.width && rays_h <= v->march_light.extent.height) {
        return true;
    }
    view *grave = calloc(1, sizeof *grave);
    view grown = {0};
    if (!grave || !init_rays(&e->g, &grown, rays_w, rays_h)) {
        finish_rays(&e->g, &grown);
        free(grave);
        return false;
    }
    *grave = (view){.march_light = v->march_light,
                    .march_distance = v->march_distance,
                    .lit = v->lit,
                    .rays = v->rays,
                    .last_serial = v->last_serial,
                    .next = e->dead_views};
    v->bytes += grown.bytes - rays_bytes(v);
    e->dead_views = grave;
    v->march_light = grown.march_light;
    v->march_distance = grown.march_distance;
    v->lit = grown.lit;
    v->rays = grown.rays;
    return true;
}
