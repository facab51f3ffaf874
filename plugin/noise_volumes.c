/* The noise volumes and the white texel: on the device once, with the first frame. */
#include "core/noise.h"
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

enum { SHAPE_TEXELS = CORE_NOISE_SHAPE_BYTES, DETAIL_TEXELS = CORE_NOISE_DETAIL_BYTES };

static void copy_image(engine *e, VkCommandBuffer commands, gpu_image *image, VkDeviceSize offset) {
    gpu_image_make_general(&e->g, commands, image);
    VkBufferImageCopy copy = {
        .bufferOffset = offset, .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1}, .imageExtent = image->extent};
    e->g.CmdCopyBufferToImage(commands, e->noise_upload.buffer, image->image, VK_IMAGE_LAYOUT_GENERAL, 1, &copy);
}

/* Values 0..255 become the same share of 65535. */
static void widen(const uint8_t *texels, uint32_t count, uint16_t *out) {
    for (uint32_t i = 0; i < count; i++) {
        out[i] = (uint16_t)(texels[i] * 257u);
    }
}

/* A buffer of its own, for this frame alone: the stage of a frame would be larger than any later one asks for. */
velum_result noise_volumes_record(engine *e, VkCommandBuffer commands) {
    const core_noise *noise = core_noise_built();
    const VkDeviceSize bytes = (SHAPE_TEXELS + DETAIL_TEXELS + 2) * sizeof(uint16_t);
    if (!e->noise_upload.buffer &&
        !gpu_buffer_init(&e->g, &e->noise_upload, bytes, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, GPU_MEMORY_UPLOAD)) {
        return log_fail(&e->sink, VELUM_ERROR_OUT_OF_MEMORY, "engine",
                        "record_shared: no memory for the noise volumes");
    }
    uint16_t *staged = e->noise_upload.mapped;
    widen(noise->shape, SHAPE_TEXELS, staged);
    widen(noise->detail, DETAIL_TEXELS, staged + SHAPE_TEXELS);
    staged[SHAPE_TEXELS + DETAIL_TEXELS] = 0x3c00; /* 1 as a half float */
    copy_image(e, commands, &e->shape, 0);
    copy_image(e, commands, &e->detail, SHAPE_TEXELS * sizeof *staged);
    copy_image(e, commands, &e->white, (SHAPE_TEXELS + DETAIL_TEXELS) * sizeof *staged);
    e->noise_serial = e->newest_serial;
    e->filled = true;
    return VELUM_OK;
}

void noise_volumes_bury(engine *e) {
    if (e->filled && e->noise_serial <= e->completed_serial) {
        gpu_buffer_finish(&e->g, &e->noise_upload);
    }
}
