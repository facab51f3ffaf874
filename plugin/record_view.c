/* A view in a frame: the march at the view's rate, then every pixel. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "blocks.h"

/* Samples that a pixel's history counts for at most while the picture moves. */
#define MOVING_SAMPLES 3.0f
/* The same while it rests: always, and in a frame that is made otherwise than the one before, so that no jump shows
 * and the new way takes over. */
#define RESTING_SAMPLES 1024.0f
#define OTHER_PLAN_SAMPLES 8.0f
/* Beyond these an eye has not flown but been put elsewhere; in orbit it makes 8 km/s. */
#define JUMP_S 5.0
#define JUMP_M 1000.0
#define JUMP_M_S 12000.0
/* Simulations slower than the display repeat each pose for a few frames: fewer than these. */
#define REPEATS_MOST 16
#define EYE_REACH_M 10000.0
/* Of the plan's rays in every pixel before a view that stands has fewer; pixels a frame that cloud may drift there. */
#define STANDING_ROUNDS 3
#define STANDING_PIXELS 0.5
/* The longest such frame, and by how much the sun may turn in it, rad. */
#define STANDING_FRAME_S 0.1
#define STANDING_SUN 1e-4
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

static double apart2(const double a[3], const double b[3]) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        sum += (a[i] - b[i]) * (a[i] - b[i]);
    }
    return sum;
}

static bool check_axes(checker *check, const velum_view_frame *f) {
    if (!check_unit(check, "frame.right_ecef", f->right_ecef) || !check_unit(check, "frame.up_ecef", f->up_ecef) ||
        !check_unit(check, "frame.forward_ecef", f->forward_ecef)) {
        return false;
    }
    const double *r = f->right_ecef, *u = f->up_ecef, *w = f->forward_ecef;
    double handed =
        w[0] * (r[1] * u[2] - r[2] * u[1]) + w[1] * (r[2] * u[0] - r[0] * u[2]) + w[2] * (r[0] * u[1] - r[1] * u[0]);
    if (!(fabs(dot3(r, u)) <= 1e-3 && fabs(dot3(r, w)) <= 1e-3 && fabs(dot3(u, w)) <= 1e-3)) {
        return check_fail(check, VELUM_ERROR_ARGUMENT, "frame.right_ecef, up_ecef, forward_ecef: not orthogonal");
    }
    return handed < 0.0 || check_fail(check, VELUM_ERROR_ARGUMENT,
                                      "frame.right_ecef, up_ecef, forward_ecef: expected right x up = -forward");
}

static bool check_frustum(checker *check, const velum_view_frame *f) {
    const double limit = f->flags & VELUM_VIEW_ORTHOGRAPHIC ? 1e7 : 1e4;
    if (!check_range(check, "frame.tan_left", (double)f->tan_left, -limit, limit) ||
        !check_range(check, "frame.tan_right", (double)f->tan_right, -limit, limit) ||
        !check_range(check, "frame.tan_bottom", (double)f->tan_bottom, -limit, limit) ||
        !check_range(check, "frame.tan_top", (double)f->tan_top, -limit, limit) ||
        !check_range(check, "frame.jitter_x", (double)f->jitter_x, -1.0, 1.0) ||
        !check_range(check, "frame.jitter_y", (double)f->jitter_y, -1.0, 1.0)) {
        return false;
    }
    if (f->tan_left >= f->tan_right || f->tan_bottom >= f->tan_top) {
        return check_fail(check, VELUM_ERROR_ARGUMENT,
                          "frame.tan_left..tan_right, tan_bottom..tan_top: found %g..%g, %g..%g, expected to ascend",
                          (double)f->tan_left, (double)f->tan_right, (double)f->tan_bottom, (double)f->tan_top);
    }
    return true;
}

static bool check_view_frame(checker *check, const view *v, velum_view_frame *f) {
    const uint32_t known = VELUM_VIEW_CUT | VELUM_VIEW_ORTHOGRAPHIC | VELUM_VIEW_GROUND | VELUM_VIEW_SUN_DISC;
    if (!check_flags(check, "frame.flags", f->flags, known) ||
        !check_position(check, "frame.position_ecef_m", f->position_ecef_m) || !check_axes(check, f) ||
        !check_frustum(check, f) ||
        !check_range(check, "frame.depth_convention", f->depth_convention, VELUM_DEPTH_REVERSED_INFINITE,
                     VELUM_DEPTH_DISTANCE) ||
        !check_range(check, "frame.luminance_scale", (double)f->luminance_scale, 0.0, 1e9)) {
        return false;
    }
    f->luminance_scale = f->luminance_scale > 0.0f ? f->luminance_scale : 1.0f;
    f->width = f->width ? f->width : v->width;
    f->height = f->height ? f->height : v->height;
    if (!check_count(check, "frame.width", f->width, 1, v->width) ||
        !check_count(check, "frame.height", f->height, 1, v->height)) {
        return false;
    }
    const double away2 = apart2(f->position_ecef_m, v->eye->position_ecef_m);
    return away2 <= EYE_REACH_M * EYE_REACH_M ||
           check_fail(check, VELUM_ERROR_ARGUMENT, "frame.position_ecef_m: %.0f m from its eye, expected at most %.0f",
                      sqrt(away2), EYE_REACH_M);
}

static bool check_images(checker *check, const velum_view_frame *f, const velum_vulkan_images *images) {
    if (!check_flags(check, "images.flags", images->flags, 0) ||
        !check_zero(check, "images.reserved", images->reserved) ||
        !check_pointer(check, "images.luminance", images->luminance) ||
        !check_pointer(check, "images.transmittance", images->transmittance) ||
        !check_count(check, "frame.x + width", (uint64_t)f->x + f->width, 1, images->width) ||
        !check_count(check, "frame.y + height", (uint64_t)f->y + f->height, 1, images->height) ||
        !check_count(check, "frame.array_layer", f->array_layer, 0, images->layers ? images->layers - 1 : 0)) {
        return false;
    }
    if (images->format != VK_FORMAT_R16G16B16A16_SFLOAT && images->format != VK_FORMAT_R32G32B32A32_SFLOAT) {
        return check_fail(check, VELUM_ERROR_ARGUMENT,
                          "images.format: found %d, expected R16G16B16A16_SFLOAT or R32G32B32A32_SFLOAT",
                          (int)images->format);
    }
    if (!images->depth) {
        return true;
    }
    if (images->depth_layout != VK_IMAGE_LAYOUT_GENERAL &&
        images->depth_layout != VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL) {
        return check_fail(check, VELUM_ERROR_ARGUMENT,
                          "images.depth_layout: found %d, expected GENERAL or SHADER_READ_ONLY_OPTIMAL",
                          (int)images->depth_layout);
    }
    if (f->depth_convention == VELUM_DEPTH_DISTANCE) {
        return true;
    }
    if (!check_range(check, "frame.depth_near_m", (double)f->depth_near_m, 1e-6, 1e7)) {
        return false;
    }
    return f->depth_convention == VELUM_DEPTH_REVERSED_INFINITE ||
           (f->depth_far_m > f->depth_near_m && f->depth_far_m <= 1e12f) ||
           check_fail(check, VELUM_ERROR_ARGUMENT, "frame.depth_far_m: found %g, expected above depth_near_m %g",
                      (double)f->depth_far_m, (double)f->depth_near_m);
}

static camera camera_of(const engine *e, const velum_view_frame *f) {
    camera c = {.tan = {f->tan_left, f->tan_right, f->tan_bottom, f->tan_top},
                .jitter = {f->jitter_x, f->jitter_y},
                .flags = f->flags & VELUM_VIEW_ORTHOGRAPHIC,
                .width = f->width,
                .height = f->height,
                .scale = f->luminance_scale,
                .time_s = e->frame.time_s,
                .blend = e->weather.blend};
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

/* Whether a state has taken the place of another that it was not derived from and that no timeline leads to it. */
static bool weather_jumped(const engine *e, const camera *before, const camera *now) {
    for (int i = 0; i < 2; i++) {
        bool known = false;
        for (int k = 0; k < 2; k++) {
            known = known || now->state[i] == before->state[k] ||
                    (e->weather.base[i] && e->weather.base[i] == before->state[k]);
        }
        /* A transition begins with its second state at next to nothing, and ends with its first at next to nothing. */
        float weight = i == 0 ? 1.0f - now->blend : now->blend;
        if (!known && weight > 0.1f) {
            return true;
        }
    }
    return false;
}

static bool eye_jumped(const camera *before, const camera *now) {
    const double away2 = apart2(now->position, before->position);
    double dt = fabs(now->time_s - before->time_s);
    double reach_m = JUMP_M + JUMP_M_S * dt;
    return !(dt <= JUMP_S && away2 <= reach_m * reach_m);
}

static bool starts_anew(const engine *e, const view *v, const velum_view_frame *f, const camera *now) {
    const camera *before = &v->before;
    return !v->has_camera || (f->flags & VELUM_VIEW_CUT) || v->eye->reset || now->width != before->width ||
           now->height != before->height || now->flags != before->flags || eye_jumped(before, now) ||
           weather_jumped(e, before, now);
}

static bool same_pose(const camera *a, const camera *b) {
    return memcmp(a->position, b->position, sizeof a->position) == 0 &&
           memcmp(a->right, b->right, sizeof a->right) == 0 && memcmp(a->up, b->up, sizeof a->up) == 0 &&
           memcmp(a->forward, b->forward, sizeof a->forward) == 0 && memcmp(a->tan, b->tan, sizeof a->tan) == 0;
}

static bool stands_still(const camera *a, const camera *b) {
    return same_pose(a, b) && memcmp(a->sun, b->sun, sizeof a->sun) == 0 && a->time_s == b->time_s &&
           memcmp(a->state, b->state, sizeof a->state) == 0 && a->blend == b->blend;
}

static bool is_aside(const eye *y, const camera *now) {
    return (now->flags & VELUM_VIEW_ORTHOGRAPHIC) || apart2(now->position, y->position_ecef_m) > ASIDE_M * ASIDE_M;
}

/* Whether a view goes on as it was, but for cloud that drifts slowly over it: see velum_plan.standing_ray_rate. */
static bool stands(const view *v, const camera *now) {
    const eye *y = v->eye;
    const camera *before = &v->before;
    const double dt = fabs(now->time_s - before->time_s);
    const double wide = fmax(fabs((double)now->tan[0]), fabs((double)now->tan[1]));
    const double high = fmax(fabs((double)now->tan[2]), fabs((double)now->tan[3]));
    const double pixels =
        fmax(now->width / (double)(now->tan[1] - now->tan[0]), now->height / (double)(now->tan[3] - now->tan[2])) *
        (1.0 + wide * wide + high * high);
    return same_pose(now, before) && memcmp(now->state, before->state, sizeof now->state) == 0 &&
           now->state[0] == now->state[1] && !y->incomplete && !is_aside(y, now) && y->block.table[3] == 0 &&
           dt <= STANDING_FRAME_S && apart2(now->sun, before->sun) <= STANDING_SUN * STANDING_SUN &&
           (double)y->wind.turns_rad_s * dt * pixels < STANDING_PIXELS;
}

/* What this frame makes of a view's history. */
typedef struct history_turn {
    bool anew, settles;
    bool other_plan;                                     /* than that of the frame before */
    uint32_t counter, still, rest, rounds, begun, stood; /* as those of the view */
    bool has_moved;
} history_turn;

/* Whether rays and steps are the same. */
static bool same_picture(const velum_plan *a, const velum_plan *b) {
    return a->flags == b->flags && a->march_steps == b->march_steps && a->light_steps == b->light_steps &&
           a->ray_rate == b->ray_rate && a->octaves == b->octaves && a->step_m == b->step_m &&
           a->step_growth == b->step_growth && a->integrator == b->integrator && a->scattering == b->scattering &&
           a->sun_depth == b->sun_depth && a->long_step == b->long_step && a->thin_density == b->thin_density &&
           a->exit_transmittance == b->exit_transmittance;
}

/* `plan` becomes the view's own. */
static history_turn turn_of(const engine *e, const view *v, const velum_view_frame *f, const camera *now,
                            velum_plan *plan) {
    if (starts_anew(e, v, f, now)) {
        return (history_turn){.anew = true, .rest = 1};
    }
    bool is_still = stands_still(now, &v->before);
    history_turn t = {.counter = v->counter,
                      .rounds = v->rounds,
                      .begun = v->begun,
                      .still = is_still ? v->still + 1 : 0,
                      .rest = v->rest,
                      .stood = stands(v, now) ? v->stood + 1 : 0,
                      .has_moved = v->has_moved || !is_still};
    if (!is_still && v->still < REPEATS_MOST && v->still >= t.rest) {
        t.rest = v->still + 1;
    } else if (t.still >= REPEATS_MOST) {
        t.rest = 1;
    }
    const bool has_rays = t.stood >= STANDING_ROUNDS * plan->ray_rate;
    if (t.still < t.rest && has_rays && plan->standing_ray_rate > plan->ray_rate) {
        plan->ray_rate = plan->standing_ray_rate;
    }
    t.other_plan = !same_picture(&v->plan, plan);
    /* A progressive mean that moved pictures have gone into would keep them. */
    t.settles = t.has_moved && t.still >= v->rest;
    if (t.settles) {
        t.rounds = 0;
        t.begun = t.counter;
        t.has_moved = false;
    } else if (plan->ray_rate != v->plan.ray_rate) {
        t.rounds += (t.counter - t.begun + v->plan.ray_rate - 1) / v->plan.ray_rate;
        t.begun = t.counter;
    }
    return t;
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
                   VELUM_STUDY_OCTAVES == VELUM_SCATTERING_OCTAVES &&
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
    const camera *before = anew ? now : &v->before;
    fill_axes(now, y->position_ecef_m, out->right, out->up, out->forward, out->offset);
    fill_axes(before, y->position_ecef_m, out->before_right, out->before_up, out->before_forward, out->before_offset);
    float dt = (float)(now->time_s - before->time_s);
    for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
        for (int i = 0; i < 3; i++) {
            out->drifts[k][i] = y->wind.m_s[k][i] * dt;
        }
    }
    out->scale[0] = now->scale;
    memcpy(&out->scale[1], now->jitter, sizeof now->jitter);
    memcpy(out->before_jitter, before->jitter, sizeof before->jitter);
    out->before_jitter[2] = history->other_plan ? OTHER_PLAN_SAMPLES : RESTING_SAMPLES;
    out->scale[3] = anew || history->still > 0 ? 0.0f : MOVING_SAMPLES;
    out->depth[0] = (float)f->depth_convention;
    out->depth[1] = f->depth_near_m;
    out->depth[2] = f->depth_far_m;
    out->depth[3] = images->format == VK_FORMAT_R32G32B32A32_SFLOAT ? 3e38f : 65000.0f;
    const block_size side = block_of(plan->ray_rate);
    const uint32_t turns = side.w * side.h;
    const uint32_t counter = history->counter;
    const uint32_t round = history->rounds + (counter - history->begun) / turns;
    const uint32_t size[4] = {f->width, f->height, f->x, f->y};
    const uint32_t march_size[4] = {(f->width + side.w - 1) / side.w, (f->height + side.h - 1) / side.h, side.w,
                                    counter};
    uint32_t flags = (anew ? VELUM_VIEW_BLOCK_CUT : 0u) | (history->settles ? VELUM_VIEW_BLOCK_SETTLE : 0u) |
                     (f->flags & VELUM_VIEW_ORTHOGRAPHIC ? VELUM_VIEW_BLOCK_ORTHOGRAPHIC : 0u) |
                     (f->flags & VELUM_VIEW_GROUND ? VELUM_VIEW_BLOCK_GROUND : 0u) |
                     (f->flags & VELUM_VIEW_SUN_DISC ? VELUM_VIEW_BLOCK_SUN_DISC : 0u) |
                     (images->depth ? VELUM_VIEW_BLOCK_DEPTH : 0u) | (is_aside(y, now) ? VELUM_VIEW_BLOCK_ASIDE : 0u);
    uint32_t x, row;
    place_of_turn(side, counter % turns, &x, &row);
    const uint32_t frame[4] = {row * side.w + x, flags, f->array_layer, (uint32_t)e->w->seed};
    memcpy(out->size, size, sizeof size);
    memcpy(out->march_size, march_size, sizeof march_size);
    memcpy(out->frame, frame, sizeof frame);
    const uint32_t turn[4] = {x, row, turns == 2, 0};
    memcpy(out->turn, turn, sizeof turn);
    out->room[0] = (float)v->march_light.extent.width;
    out->room[1] = (float)v->march_light.extent.height;
    out->room[2] = (float)v->width;
    out->room[3] = (float)v->height;
    out->march[0] = plan->step_m;
    out->march[1] = plan->step_growth;
    out->march[2] = plan->distance_m;
    /* In the middle of the step at first, then through all of it. */
    out->march[3] = fmodf(0.5f + radical_inverse(round), 1.0f);
    const uint32_t steps[4] = {plan->march_steps, plan->light_steps, plan->octaves, side.h};
    memcpy(out->steps, steps, sizeof steps);
    fill_study(plan, out);
}

static bool write_view_set(engine *e, const view *v, const velum_vulkan_images *images, uint32_t counter,
                           VkDescriptorSet *out) {
    const pipelines *p = &e->passes;
    if (!frame_set(e, p->set_view, out)) {
        return false;
    }
    const uint32_t old = v->newest;
    const VkImageLayout general = VK_IMAGE_LAYOUT_GENERAL;
    VkImageView no_distance = images->layers ? e->nothing_layered.view : e->nothing.view;
    const VkDescriptorImageInfo info[VELUM_BIND_VIEW_COUNT] = {
        [VELUM_BIND_MARCH_LIGHT] = {VK_NULL_HANDLE, v->march_light.view, general},
        [VELUM_BIND_MARCH_DISTANCE] = {VK_NULL_HANDLE, v->march_distance.view, general},
        [VELUM_BIND_MARCH_LIGHT_IN] = {p->linear, v->march_light.view, general},
        [VELUM_BIND_MARCH_DISTANCE_IN] = {p->nearest, v->march_distance.view, general},
        [VELUM_BIND_HISTORY_IN] = {p->linear, v->history[old].view, general},
        [VELUM_BIND_HISTORY_DATA_IN] = {p->linear, v->history_data[old].view, general},
        [VELUM_BIND_HISTORY_OUT] = {VK_NULL_HANDLE, v->history[old ^ 1u].view, general},
        [VELUM_BIND_HISTORY_DATA_OUT] = {VK_NULL_HANDLE, v->history_data[old ^ 1u].view, general},
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
        [VELUM_BIND_LIT_LIST] = {v->lit.buffer, list_at, VK_WHOLE_SIZE}};
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
        [VELUM_BIND_LIT_LIST] = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER};
    VkWriteDescriptorSet writes[VELUM_BIND_VIEW_COUNT];
    for (uint32_t i = 0; i < VELUM_BIND_VIEW_COUNT; i++) {
        bool is_buffer = buffers[i].buffer != VK_NULL_HANDLE;
        writes[i] = (VkWriteDescriptorSet){.sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET,
                                           .dstSet = *out,
                                           .dstBinding = i,
                                           .descriptorCount = 1,
                                           .descriptorType = types[i],
                                           .pImageInfo = is_buffer ? NULL : &info[i],
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
                      const velum_view_block *block, uint32_t counter) {
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
    if (!write_view_set(e, v, images, counter, &sets.view)) {
        return false;
    }
    VkDescriptorSet both[2] = {y->set, sets.view};
    e->g.CmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.layout_view, 0, 2, both, 3,
                               sets.offsets);
    return true;
}

/* For what is in sight of an eye. */
typedef struct march_passes {
    pass march, light; /* light PASS_COUNT: none; studies light as they go */
} march_passes;

static march_passes march_of(const eye *y) {
    const bool closes = (y->tiles.closing & y->plan.active_layers) != 0;
    const int kind = (blocks_mix(y->e) ? PASS_MIXED : 0) + (y->block.table[3] ? PASS_FRINGED : 0);
    if (plan_is_study(&y->plan)) {
        return (march_passes){(pass)(PASS_MARCH_STUDY + kind), PASS_COUNT};
    }
    /* Rain mostly falls from closed sheets: with fringes there are no others. */
    const int closed = closes || kind & PASS_FRINGED ? PASS_CLOSED : 0;
    return (march_passes){(pass)(PASS_MARCH + kind + closed), (pass)(PASS_LIGHT + kind + closed)};
}

/* Rays; the light of the places that they have found; both together. */
static void record_march(view *v, VkCommandBuffer commands, const velum_view_block *block) {
    engine *e = v->eye->e;
    gpu *g = &e->g;
    const VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
    const VkAccessFlags2 access = VK_ACCESS_2_SHADER_SAMPLED_READ_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT |
                                  VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    const VkAccessFlags2 write = VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT;
    const march_passes which = march_of(v->eye);
    record_dispatch(e, commands, which.march, block->march_size[0], block->march_size[1]);
    if (which.light == PASS_COUNT) {
        return;
    }
    gpu_barrier(g, commands, compute, write, compute | VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT,
                access | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
    g->CmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, e->passes.pipeline[which.light]);
    g->CmdDispatchIndirect(commands, v->lit.buffer, 0);
    gpu_barrier(g, commands, compute, write, compute, access);
    record_dispatch(e, commands, PASS_GATHER, block->march_size[0], block->march_size[1]);
}

static void record_passes(view *v, VkCommandBuffer commands, const velum_view_block *block, bool layered,
                          uint32_t counter, uint32_t query) {
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
    const uint32_t no_places[VELUM_LIT_HEAD_BYTES / 4] = {VELUM_LIT_COLUMNS, 0, 1, 0};
    g->CmdUpdateBuffer(commands, v->lit.buffer, 0, sizeof no_places, no_places);
    gpu_barrier(g, commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT, VK_ACCESS_2_TRANSFER_WRITE_BIT, compute,
                read | write);
    frame_timestamp(e, commands, query);
    const uint32_t flags = block->frame[1];
    const pass resolve = (pass)(PASS_RESOLVE + (flags & VELUM_VIEW_BLOCK_GROUND ? PASS_GROUND : 0) +
                                (flags & (VELUM_VIEW_BLOCK_DEPTH | VELUM_VIEW_BLOCK_ASIDE) ? PASS_DEPTH : 0) +
                                (layered ? PASS_LAYERED : 0) + (block->scale[3] != 0.0f ? PASS_MOVES : 0));
    record_march(v, commands, block);
    gpu_barrier(g, commands, compute, write, compute | VK_PIPELINE_STAGE_2_COPY_BIT,
                read | write | VK_ACCESS_2_TRANSFER_READ_BIT);
    frame_timestamp(e, commands, query < FRAME_QUERIES ? query + 1 : FRAME_QUERIES);
    record_dispatch(e, commands, resolve, block->size[0], block->size[1]);
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
        !check_in(&check, "images", &im, sizeof im, images, V1_VULKAN_IMAGES) || !check_view_frame(&check, v, &f) ||
        !check_images(&check, &f, &im)) {
        return check.result;
    }
    frame_slot *slot = e->now;
    if (slot->record_count == FRAME_RECORDS) {
        check_fail(&check, VELUM_ERROR_OUT_OF_MEMORY, "more than %u views in a frame", FRAME_RECORDS);
        return check.result;
    }
    if (y->quality == VELUM_QUALITY_REFERENCE) {
        camera here = camera_of(e, &f);
        velum_view_block own;
        fill_view(v, &f, &im, &here, &(history_turn){.anew = true}, &y->plan, &own);
        return record_reference(v, commands, &f, &im, &own, (f.flags & VELUM_VIEW_CUT) != 0 || y->reset);
    }
    camera now = camera_of(e, &f);
    velum_plan plan = y->plan;
    history_turn history = turn_of(e, v, &f, &now, &plan);
    const block_size side = block_of(plan.ray_rate);
    if (!view_images_grow(v, (v->width + side.w - 1) / side.w, (v->height + side.h - 1) / side.h)) {
        return gpu_result(&e->g);
    }
    velum_view_block block;
    fill_view(v, &f, &im, &now, &history, &plan, &block);
    uint32_t counter = slot->record_count;
    if (!bind_view(v, commands, &im, &block, counter)) {
        return gpu_result(&e->g);
    }
    gpu_image *own[] = {&v->march_light, &v->march_distance,  &v->history[0],
                        &v->history[1],  &v->history_data[0], &v->history_data[1]};
    for (size_t i = 0; i < sizeof own / sizeof own[0]; i++) {
        gpu_image_make_general(&e->g, commands, own[i]);
    }
    uint32_t query = frame_queries(e, 3);
    record_passes(v, commands, &block, im.layers != 0, counter, query);
    slot->record[slot->record_count++] = (frame_record){.v = v,
                                                        .query = query,
                                                        .is_governed = y->is_governed,
                                                        .setting = governor_now(&y->governor),
                                                        .stats = {.incomplete = y->incomplete,
                                                                  .frame = e->newest_serial,
                                                                  .revision = e->weather.revision,
                                                                  .weather_bytes = engine_weather_bytes(e),
                                                                  .view_bytes = v->bytes}};
    v->newest ^= 1u;
    v->counter = history.counter + 1;
    v->rounds = history.rounds;
    v->begun = history.begun;
    v->still = history.still;
    v->rest = history.rest;
    v->has_moved = history.has_moved;
    v->stood = history.stood;
    v->before = now;
    v->has_camera = true;
    v->plan = plan;
    v->frame = e->frames;
    v->last_serial = e->newest_serial;
    return y->incomplete ? VELUM_INCOMPLETE : y->degraded ? VELUM_DEGRADED : VELUM_OK;
}
