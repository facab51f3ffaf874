/* The noise volumes and the white texel: on the device once, with the first frame. */
#include <string.h>

#include "engine.h"

static bool init_volume(engine *e, gpu_image *image, uint32_t side) {
    const gpu_image_desc desc = {.format = VK_FORMAT_R8_UNORM,
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

static bool copy_whole(engine *e, VkCommandBuffer commands, gpu_image *image, const void *texels, VkDeviceSize bytes) {
    VkDeviceSize offset = 0;
    void *staged = stage_take(&e->now->staged, bytes, &offset);
    if (!staged) {
        return false;
    }
    memcpy(staged, texels, bytes);
    gpu_image_make_general(&e->g, commands, image);
    VkBufferImageCopy copy = {
        .bufferOffset = offset, .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = image->extent};
    e->g.CmdCopyBufferToImage(commands, e->now->staged.buffer.buffer, image->image, VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
    return true;
}

velum_result noise_volumes_record(engine *e, VkCommandBuffer commands) {
    static const uint16_t one_half_float = 0x3c00;
    const core_noise *noise = world_noise(e->w);
    if (!noise || !copy_whole(e, commands, &e->shape, noise->shape, sizeof noise->shape) ||
        !copy_whole(e, commands, &e->detail, noise->detail, sizeof noise->detail) ||
        !copy_whole(e, commands, &e->white, &one_half_float, sizeof one_half_float)) {
        return log_fail(&e->sink, VELUM_ERROR_OUT_OF_MEMORY, "engine",
                        "record_shared: no memory for the noise volumes");
    }
    e->filled = true;
    return VELUM_OK;
}
