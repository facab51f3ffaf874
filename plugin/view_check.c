/* What a host gives of a view in a frame. */
#include <math.h>

#include "blocks.h"

#define EYE_REACH_M 10000.0

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

bool view_check_frame(checker *check, const view *v, velum_view_frame *f) {
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

bool view_check_images(checker *check, const velum_view_frame *f, const velum_vulkan_images *images) {
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
