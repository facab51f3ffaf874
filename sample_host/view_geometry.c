#include "view_geometry.h"

#include <math.h>
#include <string.h>

static const double pi = 3.14159265358979323846;
static const double wgs84_a_m = 6378137.0;
static const double wgs84_b_m = 6356752.314245179;

void view_geometry_frame(const struct eye_pose *pose, const velum_scenario_channel *channel, uint32_t width,
                         uint32_t height, velum_view_frame *out) {
    *out = (velum_view_frame){.struct_size = sizeof *out, .depth_convention = VELUM_DEPTH_DISTANCE};
    memcpy(out->position_ecef_m, pose->position_m, sizeof out->position_ecef_m);
    velum_scenario_channel_axes(channel, pose->right, pose->up, pose->forward, out->right_ecef, out->up_ecef,
                                out->forward_ecef);
    double across = tan(0.5 * channel->hfov_deg * pi / 180);
    double along = across * height / width;
    out->tan_left = (float)-across;
    out->tan_right = (float)across;
    out->tan_bottom = (float)-along;
    out->tan_top = (float)along;
}

/* A pixel is smallest at the edge that is furthest from the axis: d(angle) = d(tan) / (1 + tan^2). */
double view_geometry_pixel_rad(const velum_view_frame *view, uint32_t width, uint32_t height) {
    double x = fmax(fabs((double)view->tan_left), fabs((double)view->tan_right));
    double y = fmax(fabs((double)view->tan_bottom), fabs((double)view->tan_top));
    double across = ((double)view->tan_right - (double)view->tan_left) / width / (1 + x * x);
    double along = ((double)view->tan_top - (double)view->tan_bottom) / height / (1 + y * y);
    return fmin(fmax(fmin(across, along), 1e-6), 1);
}

static void set_vector(float out[4], const double from[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = (float)from[i];
    }
}

static void set_pattern(const double eye_m[3], double size_m, float cell[4], float part[4]) {
    for (int i = 0; i < 3; i++) {
        double whole = floor(eye_m[i] / size_m);
        cell[i] = (float)whole;
        part[i] = (float)(eye_m[i] / size_m - whole);
    }
}

void view_geometry_ground(const velum_view_frame *view, uint32_t width, uint32_t height, double ground_m,
                          struct host_view_arguments *out) {
    const double *eye = view->position_ecef_m;
    set_vector(out->right, view->right_ecef);
    set_vector(out->up, view->up_ecef);
    set_vector(out->forward, view->forward_ecef);
    out->right[3] = view->tan_left;
    out->up[3] = view->tan_right;
    out->forward[3] = view->tan_bottom;
    out->gradient[3] = view->tan_top;

    double a = wgs84_a_m + ground_m, b = wgs84_b_m + ground_m;
    double stretch = (a / b) * (a / b);
    const double stretched[3] = {eye[0], eye[1], eye[2] * stretch};
    double square = eye[0] * stretched[0] + eye[1] * stretched[1] + eye[2] * stretched[2];
    double radius = sqrt(square);
    for (int i = 0; i < 3; i++) {
        out->gradient[i] = (float)(stretched[i] / a);
    }
    out->surface[0] = (float)stretch;
    out->surface[1] = (float)(1 / a);
    /* An eye under the ground stands a metre above it. */
    out->surface[2] = (float)(fmax(radius - a, 1) * (radius + a) / a);
    out->surface[3] = (float)view_geometry_pixel_rad(view, width, height);

    set_pattern(eye, (double)HOST_PATTERN_REGION_M, out->region_cell, out->region_part);
    set_pattern(eye, (double)HOST_PATTERN_WOOD_M, out->wood_cell, out->wood_part);
    set_pattern(eye, (double)HOST_PATTERN_FIELD_M, out->field_cell, out->field_part);
    set_pattern(eye, (double)HOST_PATTERN_TUFT_M, out->tuft_cell, out->tuft_part);
    out->field_cell[3] = (float)width;
    out->tuft_cell[3] = (float)height;
}
