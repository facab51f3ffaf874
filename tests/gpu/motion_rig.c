#include "motion_rig.h"

#include <math.h>
#include <string.h>

#define LAT_DEG 50.0
#define LON_DEG 8.5
const float motion_steady[2] = {0.0f, 0.0f};

void motion_rig_init_sized(motion_rig *r, const velum_layer *layer, uint32_t width, uint32_t height) {
    memset(r, 0, sizeof *r);
    fixture_borrow(&r->f);
    fixture_commit(&r->f, layer, 1);
    r->view = fixture_view(&r->f, r->f.eye, width, height);
    r->width = width;
    r->height = height;
    r->tan_x = 0.4f;
    fixture_axes(LAT_DEG, LON_DEG, r->east, r->north, r->up);
}

void motion_rig_init(motion_rig *r, const velum_layer *layer) {
    motion_rig_init_sized(r, layer, W, H);
}

void motion_rig_finish(motion_rig *r) {
    assert_int_equal(r->f.engine_api->destroy_view(r->view), VELUM_OK);
    fixture_give_back(&r->f);
}

void motion_draw(motion_rig *r, double height_m, double climb_rad, const float jitter[2], uint32_t flags) {
    double position[3], forward[3], sun[3];
    for (int i = 0; i < 3; i++) {
        forward[i] = cos(climb_rad) * r->east[i] + sin(climb_rad) * r->up[i];
        sun[i] = 0.6 * r->up[i] - 0.8 * r->east[i];
    }
    fixture_position(LAT_DEG, LON_DEG, height_m, position);
    velum_view_frame camera = fixture_camera(position, forward, r->north, r->tan_x, 0.75f * r->tan_x);
    camera.flags |= flags;
    camera.jitter_x = jitter[0];
    camera.jitter_y = jitter[1];
    camera.depth_convention = VELUM_DEPTH_DISTANCE;
    const velum_frame_info frame = fixture_frame(sun, r->time_s, VELUM_ATMOSPHERE_NONE);
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = r->f.eye};
    memcpy(eye.position_ecef_m, position, sizeof position);
    const velum_pixels pixels = {.struct_size = sizeof pixels,
                                 .view = r->view,
                                 .frame = &camera,
                                 .luminance_rgb = r->light,
                                 .transmittance_rgb = r->through,
                                 .depth = r->depth_m,
                                 .width = r->width,
                                 .height = r->height};
    assert_true(r->f.standalone_api->render(r->f.engine, &frame, &eye, 1, 0, &pixels, 1, 0) >= 0);
}

void motion_settle(motion_rig *r, double height_m, double climb_rad) {
    for (uint32_t i = 0; i < AT_REST; i++) {
        motion_draw(r, height_m, climb_rad, motion_steady, i == 0 ? VELUM_VIEW_CUT : 0);
    }
}

double motion_light_of(const float *other, const motion_rig *r) {
    double sum = 0.0, here = 0.0;
    for (uint32_t i = 0; i < r->width * r->height * 3; i++) {
        sum += (double)other[i];
        here += (double)r->light[i];
    }
    return sum / here;
}

double motion_apart(const motion_rig *r, const float *other) {
    const uint32_t pixels = r->width * r->height;
    double sum = 0.0;
    for (uint32_t i = 0; i < pixels; i++) {
        sum += fabs((double)r->through[3 * i] - (double)other[3 * i]) / pixels;
    }
    return sum;
}

uint32_t motion_rays(const motion_rig *r) {
    velum_view_stats stats = {.struct_size = sizeof stats};
    assert_int_equal(r->f.engine_api->get_stats(r->view, &stats), VELUM_OK);
    return (uint32_t)stats.rays;
}

void motion_stand(motion_rig *r, double height_m, uint32_t frames) {
    for (uint32_t i = 0; i < frames; i++) {
        r->time_s += FRAME_S;
        motion_draw(r, height_m, 0.5, motion_steady, 0);
    }
}

uint32_t motion_rays_standing(motion_rig *r, double height_m, uint32_t frames) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < frames; i++) {
        motion_stand(r, height_m, 1);
        sum += motion_rays(r);
    }
    return sum;
}
