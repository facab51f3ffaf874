/* The tables of multiple scattering: of the uniform layers that the weather has. */
#include <stdlib.h>
#include <string.h>

#include "blocks.h"
#include "core/scattering_table.h"

enum { SIDE = VELUM_SCATTERING_DEPTHS };

bool scattering_init(engine *e) {
    const gpu_image_desc desc = {.format = VK_FORMAT_R16G16B16A16_SFLOAT,
                                 .type = VK_IMAGE_TYPE_3D,
                                 .view_type = VK_IMAGE_VIEW_TYPE_3D,
                                 .extent = {SIDE * VELUM_SCATTERING_TABLES, SIDE, VELUM_SCATTERING_SLICES},
                                 .layers = 1,
                                 .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT};
    return gpu_image_init(&e->g, &e->scattering, &desc);
}

/* IEEE 754 binary16, of what is neither huge nor subnormal: to the nearest, or 0. */
static uint16_t half_of(float x) {
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    const uint32_t sign = bits >> 16 & 0x8000u;
    const uint32_t rounded = (bits & 0x7fffffffu) + 0x1000u;
    return (uint16_t)(rounded < 0x38800000u ? sign : sign | (rounded - 0x38000000u) >> 13);
}

static bool copy_table(engine *e, VkCommandBuffer commands, uint32_t which, core_uniform_phase phase) {
    float(*texels)[4] = malloc(CORE_SCATTERING_TEXELS * sizeof *texels);
    VkDeviceSize offset = 0;
    uint16_t *staged = stage_take(&e->now->staged, CORE_SCATTERING_TEXELS * 4 * sizeof *staged, &offset);
    const velum_phase_lobes lobes = velum_phase_lobes_make(phase.hg_asymmetry, 0.0f, 0.0f, 0.0f);
    bool ok = texels && staged && core_scattering_table(lobes, phase.albedo, texels);
    for (size_t i = 0; ok && i < CORE_SCATTERING_TEXELS * 4; i++) {
        staged[i] = half_of(texels[i / 4][i % 4]);
    }
    if (ok) {
        const VkBufferImageCopy copy = {.bufferOffset = offset,
                                        .imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                        .imageOffset = {(int32_t)(which * SIDE), 0, 0},
                                        .imageExtent = {SIDE, SIDE, VELUM_SCATTERING_SLICES}};
        e->g.CmdCopyBufferToImage(commands, e->now->staged.buffer.buffer, e->scattering.image, VK_IMAGE_LAYOUT_GENERAL,
                                  1, &copy);
    }
    free(texels);
    return ok;
}

velum_result scattering_record(engine *e, VkCommandBuffer commands) {
    uint32_t slots = 0;
    for (int i = 0; i < 2; i++) {
        slots |= e->weather.state[i] ? core_state_slot_mask(e->weather.state[i]) : 0;
    }
    gpu_image_make_general(&e->g, commands, &e->scattering);
    for (uint32_t i = 0; i < VELUM_SCATTERING_TABLES; i++) {
        scattering_key *known = &e->scattering_key[i];
        const core_uniform_phase phase = blocks_uniform_phase(e, VELUM_SLOT_UNIFORM + i);
        if (!(slots & (1u << (VELUM_SLOT_UNIFORM + i))) ||
            (known->filled && known->albedo == phase.albedo && known->hg_asymmetry == phase.hg_asymmetry)) {
            continue;
        }
        gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                    VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
        known->filled = false;
        if (!copy_table(e, commands, i, phase)) {
            return log_fail(&e->sink, VELUM_ERROR_OUT_OF_MEMORY, "engine",
                            "record_shared: no memory for the tables of scattering");
        }
        *known = (scattering_key){.albedo = phase.albedo, .hg_asymmetry = phase.hg_asymmetry, .filled = true};
        gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    }
    return VELUM_OK;
}
