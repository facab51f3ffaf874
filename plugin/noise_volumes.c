/* The noise volumes and the white texel: on the device once, with the first frame. */
#include <string.h>

#include "engine.h"

/* 16 bits: devices may filter 8-bit textures in 8 bits, and the picture would part from the CPU's answers. */
static bool init_volume(engine *e, gpu_image *image, uint32_t side) {
    const gpu_image_desc desc = {.format = VK_FORMAT_R16_UNORM,
                                 .type = VK_IMAGE_TYPE_3D,
                                 .view_type = VK_IMAGE_VIEW_TYPE_3D,
                                 .extent = {side, side, side},
                                 .layers = 1,
                                 .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    return gpu_image_init(&e->g, image, &desc);
}

bool noise_volumes_init(engine *e) {
    const gpu_image_desc white = {.format = VK_FORMAT_R16_SFLOAT,
                                  .type = VK_IMAGE_TYPE_2D,
                                  .view_type = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                  .extent = {1, 1, 1},
                                  .layers = 1,
                                  .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    return init_volume(e, &e->shape, CORE_NOISE_SHAPE_SIDE) && init_volume(e, &e->detail, CORE_NOISE_DETAIL_SIDE) &&
           gpu_image_init(&e->g, &e->white, &white);
}

static void copy_staged(engine *e, VkCommandBuffer commands, gpu_image *image, VkDeviceSize offset) {
    gpu_image_make_general(&e->g, commands, image);
    VkBufferImageCopy copy = {
        .bufferOffset = offset, .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = image->extent};
    e->g.CmdCopyBufferToImage(commands, e->now->staged.buffer.buffer, image->image, VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
}

/* Values 0..255 become the same share of 65535. */
static bool copy_volume(engine *e, VkCommandBuffer commands, gpu_image *image, const uint8_t *texels, size_t count) {
    VkDeviceSize offset = 0;
    uint16_t *staged = stage_take(&e->now->staged, count * sizeof *staged, &offset);
    if (!staged) {
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        staged[i] = (uint16_t)(texels[i] * 257u);
    }
    copy_staged(e, commands, image, offset);
    return true;
}

static bool copy_white(engine *e, VkCommandBuffer commands) {
    VkDeviceSize offset = 0;
    uint16_t *staged = stage_take(&e->now->staged, sizeof *staged, &offset);
    if (!staged) {
        return false;
    }
    *staged = 0x3c00; /* 1 as a half float */
    copy_staged(e, commands, &e->white, offset);
    return true;
}

velum_result noise_volumes_record(engine *e, VkCommandBuffer commands) {
    const core_noise *noise = world_noise(e->w);
    if (!noise || !copy_volume(e, commands, &e->shape, noise->shape, sizeof noise->shape) ||
        !copy_volume(e, commands, &e->detail, noise->detail, sizeof noise->detail) || !copy_white(e, commands)) {
        return log_fail(&e->sink, VELUM_ERROR_OUT_OF_MEMORY, "engine",
                        "record_shared: no memory for the noise volumes");
    }
    e->filled = true;
    return VELUM_OK;
}
