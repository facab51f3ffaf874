#include "reference_slab.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define LAT_DEG 50.0
#define LON_DEG 8.5
/* Tiles hold heights in such steps: the slab's faces stand on them. */
#define HEIGHT_STEP_M (27000.0 / 65535.0)
#define BASE_M (-1000.0 + 4854 * HEIGHT_STEP_M)

static double on_step(double thickness_m) {
    return round(thickness_m / HEIGHT_STEP_M) * HEIGHT_STEP_M;
}

static void mix(const double up[3], double mu, const double side[3], double across, double out[3]) {
    for (int i = 0; i < 3; i++) {
        out[i] = mu * up[i] + across * side[i];
    }
}

void slab_rig_init(slab_rig *rig) {
    slab_rig_init_preset(rig, VELUM_QUALITY_REFERENCE);
}

void slab_rig_init_preset(slab_rig *rig, int32_t quality) {
    memset(rig, 0, sizeof *rig);
    fixture_borrow(&rig->f);
    const velum_eye_desc desc = {.struct_size = sizeof desc, .quality = quality};
    assert_int_equal(rig->f.engine_api->create_eye(rig->f.engine, &desc, &rig->eye), VELUM_OK);
    rig->view = fixture_view(&rig->f, rig->eye, SLAB_SIDE, SLAB_SIDE);
}

void slab_rig_finish(slab_rig *rig) {
    assert_int_equal(rig->f.engine_api->destroy_view(rig->view), VELUM_OK);
    assert_int_equal(rig->f.engine_api->destroy_eye(rig->eye), VELUM_OK);
    fixture_give_back(&rig->f);
}

void slab_rig_layer(slab_rig *rig, const slab_case *c, double thickness_m) {
    velum_layer slab = fixture_slab(1.0f);
    slab.flags |= VELUM_LAYER_PHASE_HG | VELUM_LAYER_ALBEDO;
    slab.hg_asymmetry = (float)c->g;
    slab.albedo = (float)c->albedo;
    slab.base_m = (float)BASE_M;
    slab.top_m = (float)(BASE_M + on_step(thickness_m));
    slab.extinction_1_m = (float)(c->tau / on_step(thickness_m));
    fixture_commit(&rig->f, &slab, 1);
}

void slab_rig_order(slab_rig *rig, uint32_t order) {
    const velum_plan plan = {.struct_size = sizeof plan,
                             .active_layers = (1u << 8) - 1u,
                             .march_steps = 1,
                             .light_steps = 1,
                             .ray_rate = 1,
                             .octaves = order,
                             .step_m = 1.0f,
                             .distance_m = 1e6f};
    assert_int_equal(rig->f.engine_api->set_plan(rig->eye, order ? &plan : NULL), VELUM_OK);
}

void slab_rig_render(slab_rig *rig, const velum_frame_info *frame, const double position_ecef_m[3],
                     const velum_view_frame *camera, bool reset, uint32_t paths) {
    velum_view_frame view = *camera;
    view.path_limit = paths;
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = rig->eye, .flags = reset ? VELUM_EYE_RESET : 0};
    memcpy(eye.position_ecef_m, position_ecef_m, sizeof eye.position_ecef_m);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = rig->view,
                                 .frame = &view,
                                 .luminance_rgb = rig->light,
                                 .transmittance_rgb = rig->through,
                                 .variance = rig->variance,
                                 .width = SLAB_SIDE,
                                 .height = SLAB_SIDE};
    rig->stats = (velum_view_stats){.struct_size = sizeof rig->stats};
    for (uint32_t i = 0; i < 1000000 && (i == 0 || rig->stats.paths_per_pixel < paths); i++) {
        assert_int_equal(rig->f.standalone_api->render(rig->f.engine, frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        assert_int_equal(rig->f.engine_api->get_stats(rig->view, &rig->stats), VELUM_OK);
        eye.flags = 0;
    }
    assert_int_equal(rig->stats.paths_per_pixel, paths);
    for (int i = 0; i < SLAB_PIXELS * 3; i++) {
        assert_true(rig->light[i] >= 0.0f && rig->light[i] <= 1e30f);
        assert_true(rig->through[i] >= 0.0f && rig->through[i] <= 1.0f);
    }
}

/* Before the face that the radiance leaves, looking against it. */
static velum_view_frame aim(const slab_case *c, double thickness_m, double sun[3], double position[3]) {
    double east[3], north[3], up[3], ahead[3], side[3];
    fixture_axes(LAT_DEG, LON_DEG, east, north, up);
    mix(up, c->mu0, east, sqrt(fmax(1.0 - c->mu0 * c->mu0, 0.0)), sun);
    /* Looks against the radiance, whose azimuth counts from that of the sun's beam, which is -east. */
    double phi = c->phi_deg * 3.14159265358979 / 180.0;
    for (int i = 0; i < 3; i++) {
        side[i] = cos(phi) * east[i] + sin(phi) * north[i];
    }
    mix(up, c->up ? -c->mu : c->mu, side, sqrt(fmax(1.0 - c->mu * c->mu, 0.0)), ahead);
    const double *first = fabs(ahead[0] * north[0] + ahead[1] * north[1] + ahead[2] * north[2]) < 0.9 ? north : east;
    double along = ahead[0] * first[0] + ahead[1] * first[1] + ahead[2] * first[2];
    double right[3];
    double length = 0.0;
    for (int i = 0; i < 3; i++) {
        right[i] = first[i] - along * ahead[i];
        length += right[i] * right[i];
    }
    for (int i = 0; i < 3; i++) {
        right[i] /= sqrt(length);
    }
    fixture_position(LAT_DEG, LON_DEG, c->up ? BASE_M + thickness_m + 5.0 : BASE_M - 5.0, position);
    return fixture_camera(position, ahead, right, 0.0005f, 0.0005f);
}

double slab_rig_measure(slab_rig *rig, const slab_case *c, double thickness_m, uint32_t paths, double *error,
                        double *through) {
    double sun[3], position[3];
    const velum_view_frame camera = aim(c, thickness_m, sun, position);
    velum_frame_info frame = fixture_frame(sun, rig->time_s, VELUM_ATMOSPHERE_NONE);
    rig->time_s += 1.0;
    frame.sun_angular_radius_rad = 1e-5f;
    slab_rig_render(rig, &frame, position, &camera, true, paths);
    double sum = 0.0;
    double squares = 0.0;
    *through = 0.0;
    for (int i = 0; i < SLAB_PIXELS; i++) {
        sum += (double)rig->light[3 * i + 1];
        squares += (double)rig->variance[i];
        *through += (double)rig->through[3 * i + 1] / SLAB_PIXELS;
    }
    double scale = 3.14159265358979 / c->mu0 / SLAB_PIXELS;
    *error = sqrt(squares) * scale;
    return sum * scale;
}

double slab_rig_settle(slab_rig *rig, const slab_case *c, double thickness_m, uint32_t frames) {
    double sun[3];
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = rig->eye, .flags = VELUM_EYE_RESET};
    const velum_view_frame camera = aim(c, thickness_m, sun, eye.position_ecef_m);
    velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_NONE);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = rig->view,
                                 .frame = &camera,
                                 .luminance_rgb = rig->light,
                                 .width = SLAB_SIDE,
                                 .height = SLAB_SIDE};
    for (uint32_t i = 0; i < frames; i++) {
        assert_int_equal(rig->f.standalone_api->render(rig->f.engine, &frame, &eye, 1, 0, &pixels, 1, 0), VELUM_OK);
        eye.flags = 0;
    }
    double sum = 0.0;
    for (int i = 0; i < SLAB_PIXELS; i++) {
        sum += (double)rig->light[3 * i + 1];
    }
    return sum * 3.14159265358979 / c->mu0 / SLAB_PIXELS;
}

FILE *slab_table(const char *name) {
    char path[1024];
    const char *root = getenv("VELUM_SOURCE");
    assert_non_null(root);
    snprintf(path, sizeof path, "%s/tests/data/%s", root, name);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    return file;
}

bool slab_case_parse(const char *line, slab_case *out) {
    char side[8];
    slab_case c = {0};
    if (sscanf(line, "%lf,%lf,%lf,%lf,%7[a-z],%lf,%lf,%lf", &c.albedo, &c.g, &c.tau, &c.mu0, side, &c.mu, &c.phi_deg,
               &c.expected) != 8) {
        return false;
    }
    c.up = strcmp(side, "up") == 0;
    *out = c;
    return true;
}
