/* A view in a frame: the march at the view's rate, then every pixel. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "blocks.h"
#include "history.h"
#include "light_volume.h"

/* So far from its eye a view has air of its own before it. */
#define ASIDE_M 50.0

/* Van der Corput's sequence in base 2 (1935). */
static float radical_inverse(uint32_t i) {
    double x = 0.0;
    for (double digit = 0.5; i > 0; i >>= 1, digit *= 0.5) {
        x += (i & 1u) ? digit : 0.0;
    }
    return (float)x;
}

static camera camera_of(const eye *y, const velum_view_frame *f, const velum_vulkan_images *images) {
    const engine *e = y->e;
    camera c = {.tan = {f->tan_left, f->tan_right, f->tan_bottom, f->tan_top},
                .jitter = {f->jitter_x, f->jitter_y},
                .flags = f->flags & VELUM_VIEW_ORTHOGRAPHIC,
                .width = f->width,
                .height = f->height,
                .scale = f->luminance_scale,
                .time_s = e->frame.time_s,
                .blend = e->weather.blend,
                .is_aside = (f->flags & VELUM_VIEW_ORTHOGRAPHIC) ||
                            apart2(f->position_ecef_m, y->position_ecef_m) > ASIDE_M * ASIDE_M,
                .has_depth = images->depth != NULL};
    memcpy(c.position, f->position_ecef_m, sizeof c.position);
    memcpy(c.right, f->right_ecef, sizeof c.right);
    memcpy(c.up, f->up_ecef, sizeof c.up);
    memcpy(c.forward, f->forward_ecef, sizeof c.forward);
    memcpy(c.sun, e->frame.sun_direction_ecef, sizeof c.sun);
    for (int i = 0; i < 2; i++) {
        c.state[i] = e->weather.state[i] ? core_state_id(e->weather.state[i]) : 0;
    }
    return c;
}

static void fill_axes(const camera *c, const double origin[3], float right[4], float up[4], float forward[4],
                      float offset[4]) {
    for (int i = 0; i < 3; i++) {
        right[i] = (float)c->right[i];
        up[i] = (float)c->up[i];
        forward[i] = (float)c->forward[i];
        offset[i] = (float)(c->position[i] - origin[i]);
    }
    right[3] = c->tan[0];
    up[3] = c->tan[1];
    forward[3] = c->tan[2];
    offset[3] = c->tan[3];
}

/* Pixels of a ray's block. Two lie side by side, their turns alternating from row to row: a checkerboard. */
typedef struct block_size {
    uint32_t w, h;
} block_size;

static block_size block_of(uint32_t ray_rate) {
    block_size side = {1, 1};
    for (; ray_rate > 1; ray_rate /= 2) {
        *(side.w > side.h ? &side.h : &side.w) *= 2;
    }
    return side;
}

/* Pictures of some 22 million pixels and more have fewer rays than their plan says: texel buffers hold no more. */
static uint32_t rate_that_fits(const view *v, uint32_t ray_rate) {
    for (;; ray_rate *= 2) {
        const block_size side = block_of(ray_rate);
        if (view_images_hold(v, (v->width + side.w - 1) / side.w, (v->height + side.h - 1) / side.h)) {
            return ray_rate;
        }
    }
}

/* Order of the pixels of a block: a dispersed-dot threshold matrix (Bayer 1973), by which any first n are spread. A
 * block twice as wide as high is two such, in turn. */
static void place_of_turn(block_size side, uint32_t turn, uint32_t *x, uint32_t *y) {
    *x = *y = 0;
    for (uint32_t step = side.h / 2; step > 0; step /= 2, turn /= 4) {
        *x += (turn % 4 == 1 || turn % 4 == 2 ? step : 0) * (side.w / side.h);
        *y += turn % 4 == 1 || turn % 4 == 3 ? step : 0;
    }
    *x += side.w > side.h ? turn % 2 : 0;
}

_Static_assert(VELUM_STUDY_STEP_THROUGH == VELUM_PLAN_STEP_THROUGH &&
                   VELUM_STUDY_BASE_SEARCH == VELUM_PLAN_BASE_SEARCH && VELUM_STUDY_LIGHT_ALL == VELUM_PLAN_LIGHT_ALL &&
                   VELUM_STUDY_BEFORE == VELUM_INTEGRATOR_BEFORE && VELUM_STUDY_AFTER == VELUM_INTEGRATOR_AFTER &&
                   VELUM_STUDY_TRAPEZOID == VELUM_INTEGRATOR_TRAPEZOID &&
                   VELUM_STUDY_OCTAVES == VELUM_SCATTERING_OCTAVES && VELUM_STUDY_VOLUME == VELUM_SCATTERING_VOLUME &&
                   VELUM_STUDY_SUN_COARSE == VELUM_SUN_DEPTH_COARSE && VELUM_STUDY_SUN_FINE == VELUM_SUN_DEPTH_FINE &&
                   VELUM_STUDY_SUN_MAP == VELUM_SUN_DEPTH_MAP,
               "shaders and ABI name the same methods");

static void fill_study(const velum_plan *plan, velum_view_block *out) {
    const uint32_t study[4] = {plan->flags, plan->integrator, plan->scattering, plan->sun_depth};
    memcpy(out->study, study, sizeof study);
    out->study_limits[0] = plan->long_step == 0.0f ? 1.0f : plan->long_step == 1.0f ? 0.0f : 0.18f * plan->long_step;
    out->study_limits[1] = plan->thin_density;
    out->study_limits[2] = plan->exit_transmittance > 0.0f ? plan->exit_transmittance : 0.0015f;
}

static void fill_view(const view *v, const velum_view_frame *f, const velum_vulkan_images *images, const camera *now,
                      const history_turn *history, const velum_plan *plan, velum_view_block *out) {
    const bool anew = history->anew;
    const eye *y = v->eye;
    const engine *e = y->e;
    memset(out, 0, sizeof *out);
    const camera *before = anew ? now : &v->past.before;
    fill_axes(now, y->position_ecef_m, out->right, out->up, out->forward, out->offset);
    fill_axes(before, y->position_ecef_m, out->before_right, out->before_up, out->before_forward, out->before_offset);
    const float dt = anew ? 0.0f : (float)(now->time_s - v->past.time_s);
    for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
        for (int i = 0; i < 3; i++) {
            out->drifts[k][i] = y->wind.m_s[k][i] * dt;
        }
    }
    out->scale[0] = now->scale;
    memcpy(&out->scale[1], now->jitter, sizeof now->jitter);
    memcpy(out->before_jitter, before->jitter, sizeof before->jitter);
    _Static_assert(GOVERNOR_FINER_MOST == 64 * VELUM_FINER_NINTHS / 9, "lists have room for so many");
    out->before_jitter[2] = plan->finer_blocks != 0 ? (float)plan->finer_blocks : VELUM_FINER_BLOCKS;
    out->scale[3] = history->samples;
    out->before_jitter[3] = history->shown_samples;
    out->depth[0] = (float)f->depth_convention;
    out->depth[1] = f->depth_near_m;
    out->depth[2] = f->depth_far_m;
    out->depth[3] = images->format == VK_FORMAT_R32G32B32A32_SFLOAT ? 3e38f : 65000.0f;
    const block_size side = block_of(plan->ray_rate);
    const uint32_t turns = side.w * side.h;
    const uint32_t counter = anew ? 0 : v->past.counter;
    const uint32_t size[4] = {f->width, f->height, f->x, f->y};
    const uint32_t march_size[4] = {(f->width + side.w - 1) / side.w, (f->height + side.h - 1) / side.h, side.w,
                                    counter};
    uint32_t flags = (anew ? VELUM_VIEW_BLOCK_CUT : 0u) | (history->forgets ? VELUM_VIEW_BLOCK_SETTLE : 0u) |
                     (f->flags & VELUM_VIEW_ORTHOGRAPHIC ? VELUM_VIEW_BLOCK_ORTHOGRAPHIC : 0u) |
                     (f->flags & VELUM_VIEW_GROUND ? VELUM_VIEW_BLOCK_GROUND : 0u) |
                     (f->flags & VELUM_VIEW_SUN_DISC ? VELUM_VIEW_BLOCK_SUN_DISC : 0u) |
                     (history->has_finer ? VELUM_VIEW_BLOCK_FINER : 0u) |
                     (now->has_depth ? VELUM_VIEW_BLOCK_DEPTH : 0u);
    uint32_t x, row;
    place_of_turn(side, counter % turns, &x, &row);
    const uint32_t frame[4] = {row * side.w + x, flags, f->array_layer, (uint32_t)e->w->seed};
    memcpy(out->size, size, sizeof size);
    memcpy(out->march_size, march_size, sizeof march_size);
    memcpy(out->frame, frame, sizeof frame);
    const uint32_t turn[4] = {x, row, turns == 2, history->calm_turns};
    memcpy(out->turn, turn, sizeof turn);
    out->room[0] = (float)v->march_light.extent.width;
    out->room[1] = (float)v->march_light.extent.height;
    out->room[2] = (float)v->width;
    out->room[3] = (float)v->height;
    out->march[0] = plan->step_m;
    out->march[1] = plan->step_growth;
    out->march[2] = plan->distance_m;
    /* In the middle of the step at first, then through all of it. */
    out->march[3] = fmodf(0.5f + radical_inverse(history->round), 1.0f);
    const uint32_t steps[4] = {plan->march_steps, plan->light_steps, plan->octaves, side.h};
    memcpy(out->steps, steps, sizeof steps);
    fill_study(plan, out);
}

static bool write_view_set(engine *e, const view *v, const velum_vulkan_images *images, history_way way,
                           uint32_t counter, VkDescriptorSet *out) {
    const pipelines *p = &e->passes;
    if (!frame_set(e, p->set_view, out)) {
        return false;
    }
    const uint32_t old = v->newest;
    const uint32_t new = way == HISTORY_KEEPS ? old : old ^ 1u;
    const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
    VkImageView no_distance = images->layers ? e->nothing_layered.view : e->nothing.view;
    const VkDescriptorImageInfo info[VELUM_BIND_VIEW_COUNT] = {
        [VELUM_BIND_MARCH_LIGHT] = {VK_NULL_HANDLE, v->march_light.view, general},
        [VELUM_BIND_MARCH_DISTANCE] = {VK_NULL_HANDLE, v->march_distance.view, general},
        [VELUM_BIND_MARCH_LIGHT_IN] = {p->linear, v->march_light.view, general},
        [VELUM_BIND_MARCH_DISTANCE_IN] = {p->nearest, v->march_distance.view, general},
        [VELUM_BIND_HISTORY_IN] = {p->linear, v->history[old].view, general},
        [VELUM_BIND_HISTORY_DATA_IN] = {p->linear, v->history_data[old].view, general},
        [VELUM_BIND_HISTORY_OUT] = {VK_NULL_HANDLE, v->history[new].view, general},
        [VELUM_BIND_HISTORY_DATA_OUT] = {VK_NULL_HANDLE, v->history_data[new].view, general},
        [VELUM_BIND_OUT_LUMINANCE] = {VK_NULL_HANDLE, images->luminance, general},
        [VELUM_BIND_OUT_TRANSMITTANCE] = {VK_NULL_HANDLE, images->transmittance, general},
        [VELUM_BIND_OUT_DISTANCE] = {VK_NULL_HANDLE, images->distance ? images->distance : no_distance, general},
        [VELUM_BIND_DEPTH] = {p->nearest, images->depth ? images->depth : e->air.view,
                              images->depth ? images->depth_layout : general}};
    const VkDeviceSize list_at = view_images_list_at(v);
    const VkDescriptorBufferInfo buffers[VELUM_BIND_VIEW_COUNT] = {
        [VELUM_BIND_VIEW] = {e->uniforms.buffer, 0, sizeof(velum_view_block)},
        [VELUM_BIND_COUNTERS] = {e->counters.buffer, (VkDeviceSize)counter * COUNTER_STRIDE, 16},
        [VELUM_BIND_LIT] = {v->lit.buffer, 0, list_at},
        [VELUM_BIND_LIT_LIST] = {v->lit.buffer, list_at, VK_WHOLE_SIZE},
        [VELUM_BIND_RAYS] = {v->rays.buffer, 0, VK_WHOLE_SIZE},
        [VELUM_BIND_LIGHT_VOLUME] = {v->light_volume.buffer.size > 0 ? v->light_volume.buffer.buffer : v->rays.buffer,
                                     0, VK_WHOLE_SIZE}};
    const VkBufferView volume_texels = v->light_volume.buffer.texels;
    const VkBufferView texels[VELUM_BIND_VIEW_COUNT] = {[VELUM_BIND_LIT_TEXELS] = v->lit.texels,
                                                        [VELUM_BIND_RAYS_TEXELS] = v->rays.texels,
                                                        [VELUM_BIND_LIGHT_VOLUME_TEXELS] =
                                                            volume_texels ? volume_texels : v->lit.texels};
    static const VkDescriptorType types[VELUM_BIND_VIEW_COUNT] = {
        [VELUM_BIND_VIEW] = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC,
        [VELUM_BIND_MARCH_LIGHT] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_MARCH_DISTANCE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_MARCH_LIGHT_IN] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [VELUM_BIND_MARCH_DISTANCE_IN] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [VELUM_BIND_HISTORY_IN] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [VELUM_BIND_HISTORY_DATA_IN] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [VELUM_BIND_HISTORY_OUT] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_HISTORY_DATA_OUT] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_OUT_LUMINANCE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_OUT_TRANSMITTANCE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_OUT_DISTANCE] = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE,
        [VELUM_BIND_DEPTH] = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER,
        [VELUM_BIND_COUNTERS] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        [VELUM_BIND_LIT] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        [VELUM_BIND_LIT_LIST] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        [VELUM_BIND_RAYS] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        [VELUM_BIND_LIGHT_VOLUME] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER,
        [VELUM_BIND_LIT_TEXELS] = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
        [VELUM_BIND_RAYS_TEXELS] = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER,
        [VELUM_BIND_LIGHT_VOLUME_TEXELS] = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER};
    VkWriteDescriptorSet writes[VELUM_BIND_VIEW_COUNT];
    for (uint32_t i = 0; i < VELUM_BIND_VIEW_COUNT; i++) {
        bool is_buffer = buffers[i].buffer != VK_NULL_HANDLE;
        writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                           .dstSet = *out,
                                           .dstBinding = i,
                                           .descriptorCount = 1,
                                           .descriptorType = types[i],
                                           .pImageInfo = is_buffer ? NULL : &info[i],
                                           .pTexelBufferView = &texels[i],
                                           .pBufferInfo = is_buffer ? &buffers[i] : NULL};
    }
    e->g.UpdateDescriptorSets(e->g.device, VELUM_BIND_VIEW_COUNT, writes, 0, NULL);
    return true;
}

/* What the passes are bound to. */
typedef struct view_sets {
    VkDescriptorSet view;
    uint32_t offsets[3]; /* eye, shadow, view */
} view_sets;

static bool bind_view(view *v, VkCommandBuffer commands, const velum_vulkan_images *images,
                      const velum_view_block *block, history_way way, uint32_t counter) {
    eye *y = v->eye;
    engine *e = y->e;
    velum_eye_block eye_block = y->block;
    velum_shadow_block shadow_block = {0};
    const shadow *s = e->bound_shadow;
    if (s && s->drawn) {
        blocks_shift_shadow(&s->geometry, y->position_ecef_m, &shadow_block);
    }
    view_sets sets;
    if (!frame_uniform(e, &eye_block, sizeof eye_block, &sets.offsets[0]) ||
        !frame_uniform(e, &shadow_block, sizeof shadow_block, &sets.offsets[1]) ||
        !frame_uniform(e, block, sizeof *block, &sets.offsets[2])) {
        e->g.result = VK_ERROR_OUT_OF_HOST_MEMORY;
        return false;
    }
    if (!write_view_set(e, v, images, way, counter, &sets.view)) {
        return false;
    }
    VkDescriptorSet both[2] = {y->set, sets.view};
    e->g.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.layout_view, 0, 2, both, 3,
                               sets.offsets);
    return true;
}

/* For what is in sight of an eye. */
typedef struct view_passes {
    pass march, light; /* light PASS_COUNT: none; studies light as they go */
    pass gather;
    pass near;    /* PASS_COUNT: the view does not move */
    pass resolve; /* without ground */
    pass list;    /* of rays; PASS_COUNT: each block has one */
    pass fill;    /* of a volume of light; PASS_COUNT: there is none */
} view_passes;

/* So high the rows of an eye's sky lie too far apart to tell what the air before a surface takes: by 0.4 %, more
 * beyond. Views with the host's depth then reckon it for every pixel. */
#define SKY_TELLS_M 60000.0f

static view_passes passes_of(const eye *y, const camera *now, const history_turn *history, bool layered) {
    const bool has_own_air = now->is_aside || (history->has_depth && y->block.up[3] > SKY_TELLS_M);
    const bool moves = history->way == HISTORY_MOVES;
    const pass resolve = (pass)(PASS_RESOLVE + (history->has_depth ? PASS_DEPTH : 0) + (has_own_air ? PASS_ASIDE : 0) +
                                (layered ? PASS_LAYERED : 0) + (moves ? PASS_MOVES : 0) +
                                (moves && history->calm_turns != 0 ? PASS_STANDS : 0) +
                                (history->way == HISTORY_KEEPS ? PASS_KEEPS : 0));
    const bool closes = (y->tiles.closing & y->plan.active_layers) != 0;
    const pass near_of_depth = history->has_depth ? PASS_NEAR_DEPTH : PASS_NEAR;
    const pass near = moves ? near_of_depth : PASS_COUNT;
    const int kind = (blocks_mix(y->e) ? PASS_MIXED : 0) + (y->block.table[3] ? PASS_FRINGED : 0);
    if (plan_is_study(&y->plan)) {
        return (view_passes){.march = (pass)(PASS_MARCH_STUDY + kind),
                             .light = PASS_COUNT,
                             .gather = PASS_COUNT,
                             .near = near,
                             .resolve = resolve,
                             .list = PASS_COUNT,
                             .fill = light_volume_wanted(&y->plan) ? (pass)(PASS_VOLUME_FILL + (kind & PASS_MIXED))
                                                                   : PASS_COUNT};
    }
    /* Rain mostly falls from closed sheets: with fringes there are no others. */
    const int closed = closes || kind & PASS_FRINGED ? PASS_CLOSED : 0;
    const pass march = y->tiles.uneven ? PASS_MARCH_UNEVEN : PASS_MARCH;
    return (view_passes){.march = (pass)(march + kind + closed),
                         .light = (pass)(PASS_LIGHT + kind + closed),
                         .gather = history->way == HISTORY_KEEPS ? PASS_GATHER_KEEPS : PASS_GATHER,
                         .near = near,
                         .resolve = resolve,
                         .list = history->calm_turns != 0 ? PASS_DUE
                                 : history->has_finer     ? PASS_FINER
                                                          : PASS_COUNT,
                         .fill = PASS_COUNT};
}

static bool make_passes(engine *e, const view_passes *passes, const velum_view_frame *f) {
    pass needed[11] = {passes->march, passes->resolve};
    uint32_t count = 2;
    if (passes->light != PASS_COUNT) {
        needed[count++] = passes->light;
        needed[count++] = passes->gather;
    }
    if (passes->near != PASS_COUNT) {
        needed[count++] = passes->near;
    }
    if (passes->list != PASS_COUNT) {
        needed[count++] = passes->list;
    }
    if (passes->fill != PASS_COUNT) {
        needed[count++] = passes->fill;
        needed[count++] = PASS_VOLUME_SUN;
        needed[count++] = PASS_VOLUME_SPREAD;
    }
    if (f->flags & VELUM_VIEW_GROUND) {
        needed[count++] = (pass)(passes->resolve + PASS_GROUND);
    }
    return pipelines_need(&e->passes, &e->g, needed, count);
}

/* Over a list of the view's. */
static void record_list(view *v, VkCommandBuffer commands, pass which, VkDeviceSize at) {
    engine *e = v->eye->e;
    e->g.CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.pipeline[which]);
    e->g.CmdDispatchIndirect(commands, v->lit.buffer, at);
}

/* Each ray of the frame. */
static void record_rays(view *v, VkCommandBuffer commands, const velum_view_block *block, pass which, pass list) {
    if (list != PASS_COUNT) {
        record_list(v, commands, which, VELUM_LIT_DISPATCH_BYTES);
    } else {
        record_dispatch(v->eye->e, commands, which, block->march_size[0], block->march_size[1]);
    }
}

/* Rays, listed first where not each block has one; the light of the places that they have found; both together; in
 * motion rays to near cloud with those beside them. */
static void record_march(view *v, VkCommandBuffer commands, const velum_view_block *block, const view_passes *which) {
    engine *e = v->eye->e;
    gpu *g = &e->g;
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    const VkPipelineStageFlags2 reads = compute | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
    const VkAccessFlags2 write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    const VkAccessFlags2 access = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT | write |
                                  VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT;
    if (which->list != PASS_COUNT) {
        record_dispatch(e, commands, which->list, block->march_size[0], block->march_size[1]);
        gpu_barrier(g, commands, compute, write, reads, access);
    }
    record_rays(v, commands, block, which->march, which->list);
    if (which->light != PASS_COUNT) {
        gpu_barrier(g, commands, compute, write, reads, access);
        record_list(v, commands, which->light, 0);
        gpu_barrier(g, commands, compute, write, reads, access);
        record_rays(v, commands, block, which->gather, which->list);
    }
    if (which->near != PASS_COUNT) {
        gpu_barrier(g, commands, compute, write, reads, access);
        record_dispatch(e, commands, which->near, block->march_size[0], block->march_size[1]);
    }
}

/* First rows of pixels, in whole work groups, in which no ray meets the ellipsoid. Scaled to a sphere, those that do
 * fill a cone about the nadir: how far inside it lies a ray of a row, times its length, is a line less a hyperbola. */
static uint32_t rows_above_ground(const velum_view_frame *f) {
    if (f->flags & VELUM_VIEW_ORTHOGRAPHIC) {
        return 0;
    }
    const double margin = 2e-4; /* rad, for the shader's floats */
    const double scale[3] = {1.0, 1.0, (double)VELUM_SCALE_Z};
    double from[3], right[3], up[3], forward[3];
    for (int i = 0; i < 3; i++) {
        from[i] = f->position_ecef_m[i] * scale[i];
        right[i] = f->right_ecef[i] * scale[i];
        up[i] = f->up_ecef[i] * scale[i];
        forward[i] = f->forward_ecef[i] * scale[i];
    }
    const double from_m = sqrt(dot3(from, from)), share = (double)VELUM_WGS84_A_M / from_m;
    const double edge = sqrt(fmax(1.0 - share * share, 0.0)) - margin;
    const double slope = -dot3(right, from) / from_m, right2 = dot3(right, right);
    const uint32_t beyond = 2; /* lines between rows: jitter moves rays by a pixel */
    uint32_t line = 0;
    for (; line < f->height + beyond; line++) {
        const double y = (double)f->tan_top + (double)line / f->height * (double)(f->tan_bottom - f->tan_top);
        double d[3];
        for (int i = 0; i < 3; i++) {
            d[i] = forward[i] + y * up[i];
        }
        const double middle = dot3(d, right) / right2;
        const double flat = edge * edge * right2 - slope * slope;
        const double deep2 = fmax(dot3(d, d) / right2 - middle * middle, 0.0);
        const double best = edge > 0.0 && flat > 0.0 ? slope * sqrt(deep2 / flat) - middle : slope * INFINITY;
        const double x = fmin(fmax(best, (double)f->tan_left), (double)f->tan_right);
        for (int i = 0; i < 3; i++) {
            d[i] += x * right[i];
        }
        if (-dot3(d, from) / from_m >= edge * sqrt(dot3(d, d))) {
            break;
        }
    }
    const uint32_t rows = line > beyond ? line - beyond : 0;
    return rows < f->height ? rows / VELUM_GROUP * VELUM_GROUP : f->height;
}

/* Pixels; those of rows without ground by a pass that knows none. */
static void record_resolve(view *v, VkCommandBuffer commands, const velum_view_frame *f, pass without_ground) {
    engine *e = v->eye->e;
    const uint32_t above = f->flags & VELUM_VIEW_GROUND ? rows_above_ground(f) : f->height;
    if (above > 0) {
        record_dispatch(e, commands, without_ground, f->width, above);
    }
    if (above > 0 && above < f->height) {
        /* No pixel of either is the other's, but images are known as one. */
        gpu_barrier(&e->g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                    VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                    VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                        VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT);
    }
    if (above < f->height) {
        record_dispatch(e, commands, (pass)(without_ground + PASS_GROUND), f->width, f->height - above);
    }
}

static void record_passes(view *v, VkCommandBuffer commands, const velum_view_block *block, const velum_view_frame *f,
                          const velum_plan *plan, bool tiles_begin, const view_passes *passes, uint32_t counter,
                          uint32_t query) {
    engine *e = v->eye->e;
    gpu *g = &e->g;
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    const VkAccessFlags2 read = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT;
    const VkAccessFlags2 write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    const VkDeviceSize at = (VkDeviceSize)counter * COUNTER_STRIDE;
    /* The frame before read what is written now. */
    gpu_barrier(g, commands, compute | VK_PIPELINE_STAGE_2_COPY_BIT | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT, write,
                compute | VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, read | write | VK_ACCESS_2_TRANSFER_WRITE_BIT);
    g->CmdFillBuffer(commands, e->counters.buffer, at, 16, 0);
    const uint32_t nothing_listed[VELUM_LIT_HEAD_BYTES / 4] = {VELUM_LIT_COLUMNS, 0, 1, 0, VELUM_LIT_COLUMNS, 0, 1, 0};
    g->CmdUpdateBuffer(commands, v->lit.buffer, 0, sizeof nothing_listed, nothing_listed);
    if (tiles_begin) {
        /* As restless as can be, and no frame. */
        g->CmdFillBuffer(commands, v->rays.buffer, 0, VK_WHOLE_SIZE, UINT32_MAX);
    }
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, compute,
                read | write);
    frame_timestamp(e, commands, query);
    if (passes->fill != PASS_COUNT) {
        light_volume_record(v, commands, plan, passes->fill);
    }
    record_march(v, commands, block, passes);
    gpu_barrier(g, commands, compute, write, compute | VK_PIPELINE_STAGE_2_COPY_BIT,
                read | write | VK_ACCESS_2_TRANSFER_READ_BIT);
    frame_timestamp(e, commands, query < FRAME_QUERIES ? query + 1 : FRAME_QUERIES);
    record_resolve(v, commands, f, passes->resolve);
    frame_timestamp(e, commands, query < FRAME_QUERIES ? query + 2 : FRAME_QUERIES);
    VkBufferCopy copy = {at, at, 16};
    g->CmdCopyBuffer(commands, e->counters.buffer, e->now->counters.buffer, 1, &copy);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_COPY_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT,
                VK_ACCESS_2_HOST_READ_BIT);
}

velum_result record_view(view *v, VkCommandBuffer commands, const velum_view_frame *frame,
                         const velum_vulkan_images *images) {
    eye *y = v->eye;
    engine *e = y->e;
    checker check = {&e->sink, v->name, "record_view", VELUM_OK};
    velum_view_frame f;
    velum_vulkan_images im;
    if (e->state != ENGINE_SHARED || y->frame != e->frames || v->frame == e->frames) {
        check_fail(&check, VELUM_ERROR_STATE, "%s",
                   e->state != ENGINE_SHARED ? "record_shared comes first"
                   : y->frame != e->frames   ? "record_shared did not name its eye"
                                             : "called twice in a frame");
        return check.result;
    }
    if (!check_pointer(&check, "commands", commands) ||
        !check_in(&check, "frame", &f, sizeof f, frame, V1_VIEW_FRAME) ||
        !check_in(&check, "images", &im, sizeof im, images, V1_VULKAN_IMAGES) || !view_check_frame(&check, v, &f) ||
        !view_check_images(&check, &f, &im)) {
        return check.result;
    }
    frame_slot *slot = e->now;
    if (slot->record_count == FRAME_RECORDS) {
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "more than %u views in a frame", FRAME_RECORDS);
        return check.result;
    }
    if (y->quality == VELUM_QUALITY_REFERENCE) {
        camera here = camera_of(y, &f, &im);
        velum_view_block own;
        fill_view(v, &f, &im, &here, &(history_turn){.anew = true}, &y->plan, &own);
        return record_reference(v, commands, &f, &im, &own, (f.flags & VELUM_VIEW_CUT) != 0 || y->reset);
    }
    camera now = camera_of(y, &f, &im);
    velum_plan plan = y->plan;
    plan.ray_rate = rate_that_fits(v, plan.ray_rate);
    const history_turn history = history_take(v, (f.flags & VELUM_VIEW_CUT) != 0, &now, &plan);
    const block_size side = block_of(plan.ray_rate);
    const view_passes passes = passes_of(y, &now, &history, im.layers != 0);
    if (!make_passes(e, &passes, &f) ||
        !view_images_grow(v, (v->width + side.w - 1) / side.w, (v->height + side.h - 1) / side.h) ||
        !light_volume_grow(v, &plan)) {
        return gpu_result(&e->g);
    }
    velum_view_block block;
    fill_view(v, &f, &im, &now, &history, &plan, &block);
    uint32_t counter = slot->record_count;
    if (!bind_view(v, commands, &im, &block, history.way, counter)) {
        return gpu_result(&e->g);
    }
    gpu_image *own[] = {&v->march_light, &v->march_distance,  &v->history[0],
                        &v->history[1],  &v->history_data[0], &v->history_data[1]};
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++) {
        gpu_image_make_general(&e->g, commands, own[i]);
    }
    uint32_t query = frame_queries(e, 3);
    /* Blocks that no frame has had teach nothing of their cost. */
    governor_setting setting = governor_now(&y->governor);
    setting.finer = history.has_finer ? setting.finer : 0;
    record_passes(v, commands, &block, &f, &plan, history.tiles_begin, &passes, counter, query);
    slot->record[slot->record_count++] = (frame_record){.v = v,
                                                        .query = query,
                                                        .is_governed = y->is_governed,
                                                        .setting = setting,
                                                        .stats = {.incomplete = y->incomplete,
                                                                  .frame = e->newest_serial,
                                                                  .revision = e->weather.revision,
                                                                  .weather_bytes = engine_weather_bytes(e),
                                                                  .view_bytes = v->bytes}};
    v->newest ^= history.way == HISTORY_KEEPS ? 0u : 1u;
    v->past = history.next;
    v->frame = e->frames;
    v->last_serial = e->newest_serial;
    return y->incomplete ? VELUM_INCOMPLETE : y->degraded ? VELUM_DEGRADED : VELUM_OK;
}
