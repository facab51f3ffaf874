/* The tables of multiple scattering: of the uniform layers that the weather has, of cloud that closes, of fog. */
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

static bool copy_table(engine *e, VkCommandBuffer commands, uint32_t which, const scattering_key *key) {
    float(*texels)[4] = malloc(CORE_SCATTERING_TEXELS * sizeof *texels);
    VkDeviceSize offset = 0;
    uint16_t *staged = stage_take(&e->now->staged, CORE_SCATTERING_TEXELS * 4 * sizeof *staged, &offset);
    bool ok = texels && staged && core_scattering_table(key->phase, key->albedo, texels);
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

/* What table `which` has to be for, of weather in these slots. False: nothing reads it. */
static bool wanted(const engine *e, uint32_t which, uint32_t slots, scattering_key *out) {
    const uint32_t ice = 1u << VELUM_SLOT_HIGH;
    const uint32_t water = 1u << VELUM_SLOT_LOW | 1u << VELUM_SLOT_LOW_2 | 1u << VELUM_SLOT_MIDDLE;
    uint32_t readers = which == VELUM_SCATTERING_ICE ? ice : water;
    out->filled = true;
    out->albedo = 1.0f;
    if (which == VELUM_SCATTERING_FOG) {
        out->phase = velum_phase_lobes_fog();
        return e->frame.atmosphere != VELUM_ATMOSPHERE_NONE; /* a frame must not wait for it where fog begins */
    }
    out->phase = velum_phase_lobes_cloud(which == VELUM_SCATTERING_ICE);
    if (which < VELUM_SCATTERING_WATER) {
        const uint32_t slot = VELUM_SLOT_UNIFORM + which;
        const core_uniform_phase phase = blocks_uniform_phase(e, slot);
        readers = 1u << slot;
        out->albedo = phase.albedo;
        out->phase = velum_phase_lobes_make(phase.hg_asymmetry, 0.0f, 0.0f, 0.0f);
    }
    return (slots & readers) != 0;
}

static bool alike(const scattering_key *a, const scattering_key *b) {
    return a->filled && b->filled && a->albedo == b->albedo && a->phase.g_first == b->phase.g_first &&
           a->phase.g_second == b->phase.g_second && a->phase.alpha_second == b->phase.alpha_second &&
           a->phase.weight_second == b->phase.weight_second;
}

velum_result scattering_record(engine *e, VkCommandBuffer commands) {
    uint32_t slots = 0;
    for (int i = 0; i < 2; i++) {
        slots |= e->weather.state[i] ? core_state_slot_mask(e->weather.state[i]) : 0;
    }
    gpu_image_make_general(&e->g, commands, &e->scattering);
    for (uint32_t i = 0; i < VELUM_SCATTERING_TABLES; i++) {
        scattering_key *known = &e->scattering_key[i];
        scattering_key key;
        if (!wanted(e, i, slots, &key) || alike(known, &key)) {
            continue;
        }
        gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT,
                    VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT);
        known->filled = false;
        if (!copy_table(e, commands, i, &key)) {
            return log_fail(&e->sink, VELUM_ERROR_OUT_OF_MEMORY, "engine",
                            "record_shared: no memory for the tables of scattering");
        }
        *known = key;
        gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT,
                    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
    }
    return VELUM_OK;
}
