#include "light_volume.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "blocks.h"
#include "shared/light_volume.h"

#define CELL_M 100.0f /* of plans that name none */

_Static_assert(sizeof(velum_light_volume_block) == VELUM_LIGHT_VOLUME_HEAD * 4 * sizeof(float), "before the cells");

static float cell_of(const velum_plan *plan) {
    return plan->volume_cell_m > 0.0f ? plan->volume_cell_m : CELL_M;
}

/* Cells a side: a power of two, by which the grid repeats itself. */
static uint32_t side_of(const velum_plan *plan) {
    uint32_t side = VELUM_LIGHT_VOLUME_CELLS_LEAST;
    while (side < VELUM_LIGHT_VOLUME_CELLS_MOST && (float)side * cell_of(plan) < VELUM_LIGHT_VOLUME_SIDE_M) {
        side *= 2;
    }
    return side;
}

static VkDeviceSize bytes_of(const velum_plan *plan) {
    const VkDeviceSize side = side_of(plan);
    return sizeof(velum_light_volume_block) +
           side * side * VELUM_LIGHT_VOLUME_ROWS_MOST * VELUM_LIGHT_VOLUME_VECTORS * 4 * sizeof(float);
}

bool light_volume_wanted(const velum_plan *plan) {
    return plan->scattering == VELUM_SCATTERING_VOLUME;
}

bool light_volume_grow(view *v, const velum_plan *plan) {
    engine *e = v->eye->e;
    if (!light_volume_wanted(plan) || bytes_of(plan) <= v->light_volume.buffer.size) {
        return true;
    }
    view *grave = calloc(1, sizeof *grave);
    light_volume grown = {0};
    if (!grave ||
        !gpu_buffer_init(&e->g, &grown.buffer, bytes_of(plan),
                         VK_BUFFER_USAGE_STORAGE_BUFFER_BIT | VK_BUFFER_USAGE_UNIFORM_TEXEL_BUFFER_BIT |
                             VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                         GPU_MEMORY_DEVICE) ||
        !gpu_buffer_view(&e->g, &grown.buffer, VK_FORMAT_R32G32B32A32_SFLOAT, VK_WHOLE_SIZE)) {
        gpu_buffer_finish(&e->g, &grown.buffer);
        free(grave);
        return false;
    }
    *grave = (view){.light_volume = v->light_volume, .last_serial = v->last_serial, .next = e->dead_views};
    v->bytes += grown.buffer.allocation.size - v->light_volume.buffer.allocation.size;
    e->dead_views = grave;
    v->light_volume = grown;
    return true;
}

void light_volume_finish(gpu *g, view *v) {
    v->bytes -= v->light_volume.buffer.allocation.size;
    gpu_buffer_finish(g, &v->light_volume.buffer);
}

/* Slots of cloud that is deep and uneven: of others our own light knows all there is to know. */
static uint32_t slots_of(const eye *y) {
    const uint32_t held = 1u << VELUM_SLOT_LOW | 1u << VELUM_SLOT_LOW_2 | 1u << VELUM_SLOT_CUMULUS |
                          1u << VELUM_SLOT_STORM | 1u << VELUM_SLOT_MIDDLE;
    return y->tiles.mask & y->plan.active_layers & held;
}

static void fill_block(const view *v, const velum_plan *plan, velum_light_volume_block *out) {
    const eye *y = v->eye;
    memset(out, 0, sizeof *out);
    const double up[3] = {(double)y->block.up[0], (double)y->block.up[1], (double)y->block.up[2]};
    double east[3], north[3];
    axes_across(up, east, north);
    for (int i = 0; i < 3; i++) {
        out->east[i] = (float)east[i];
        out->north[i] = (float)north[i];
    }
    const uint32_t slots = slots_of(y);
    float low = 0.0f, high = 1.0f;
    for (uint32_t slot = 0, count = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (slots & (1u << slot)) {
            low = count > 0 ? fminf(low, y->tiles.base_m[slot]) : y->tiles.base_m[slot];
            high = count > 0 ? fmaxf(high, y->tiles.top_m[slot]) : y->tiles.top_m[slot];
            count++;
        }
    }
    const float least_m =
        fmaxf((high - low) / VELUM_LIGHT_VOLUME_ROWS_MOST, VELUM_LIGHT_VOLUME_FLATNESS * cell_of(plan));
    const uint32_t rows = (uint32_t)fmaxf(ceilf((high - low) / least_m - 1e-3f), 1.0f);
    const uint32_t grid[4] = {side_of(plan), rows, 0, slots};
    out->east[3] = cell_of(plan);
    out->north[3] = fmaxf(high - low, 1.0f) / (float)rows;
    out->span[0] = low;
    out->span[1] = high;
    memcpy(out->grid, grid, sizeof grid);
}

static void fill_key(const view *v, const velum_plan *plan, light_volume_key *out) {
    const eye *y = v->eye;
    memset(out, 0, sizeof *out);
    out->eye = y->block;
    memcpy(out->position, y->position_ecef_m, sizeof out->position);
    for (int i = 0; i < 2; i++) {
        out->state[i] = y->e->weather.state[i] ? core_state_id(y->e->weather.state[i]) : 0;
    }
    out->tables = y->tiles.built;
    out->skies = y->sky_count;
    out->cell_m = cell_of(plan);
}

static void record_block(view *v, VkCommandBuffer commands, const velum_light_volume_block *block) {
    gpu *g = &v->eye->e->g;
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    const VkPipelineStageFlags2 copy = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
    const VkAccessFlags2 both = VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT |
                                VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    gpu_barrier(g, commands, compute | copy, both | VK_ACCESS_2_TRANSFER_WRITE_BIT, copy,
                VK_ACCESS_2_TRANSFER_WRITE_BIT);
    g->CmdUpdateBuffer(commands, v->light_volume.buffer.buffer, 0, sizeof *block, block);
    gpu_barrier(g, commands, compute | copy, both | VK_ACCESS_2_TRANSFER_WRITE_BIT, compute, both);
}

void light_volume_record(view *v, VkCommandBuffer commands, const velum_plan *plan, pass fill) {
    engine *e = v->eye->e;
    light_volume_key key;
    fill_key(v, plan, &key);
    if (v->light_volume.is_made && memcmp(&key, &v->light_volume.key, sizeof key) == 0) {
        return;
    }
    velum_light_volume_block block;
    fill_block(v, plan, &block);
    const uint32_t columns = block.grid[0], lines = block.grid[0] * block.grid[1];
    if (block.grid[3] != 0) {
        record_block(v, commands, &block);
        record_dispatch(e, commands, fill, columns, lines);
        gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                    VK_ACCESS_2_SHADER_STORAGE_READ_BIT | VK_ACCESS_2_SHADER_SAMPLED_READ_BIT);
        record_dispatch(e, commands, PASS_VOLUME_SUN, columns, lines);
        for (uint32_t i = 0; i < VELUM_LIGHT_VOLUME_PASSES; i++) {
            block.grid[2] = i;
            block.span[2] = i < VELUM_LIGHT_VOLUME_SETTLED ? VELUM_LIGHT_VOLUME_STRIDE
                                                           : 1.0f / (float)(i - VELUM_LIGHT_VOLUME_SETTLED + 1);
            record_block(v, commands, &block);
            record_dispatch(e, commands, PASS_VOLUME_SPREAD, columns, lines);
        }
    }
    block.grid[2] = VELUM_LIGHT_VOLUME_PASSES;
    record_block(v, commands, &block);
    v->light_volume.key = key;
    v->light_volume.is_made = true;
}
