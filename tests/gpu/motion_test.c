/* Pictures in motion against the same ones at rest: what history hands on stands where it belongs, or is given up. */
#include <math.h>
#include <string.h>

#include "fixture.h"

enum { W = 64, H = 48, PIXELS = W * H, AT_REST = 64 };
#define LAT_DEG 50.0
#define LON_DEG 8.5
#define FRAME_S (1.0 / 60.0)

typedef struct rig {
    fixture f;
    velum_view *view;
    double east[3], north[3], up[3];
    double time_s;
    float light[PIXELS * 3], through[PIXELS * 3];
    const float *depth_m; /* of the host; null: none */
} rig;

static void rig_init(rig *r, const velum_layer *layer) {
    memset(r, 0, sizeof *r);
    fixture_init(&r->f, false);
    fixture_commit(&r->f, layer, 1);
    r->view = fixture_view(&r->f, r->f.eye, W, H);
    fixture_axes(LAT_DEG, LON_DEG, r->east, r->north, r->up);
}

static void rig_finish(rig *r) {
    assert_int_equal(r->f.engine_api->destroy_view(r->view), VELUM_OK);
    fixture_finish(&r->f);
}

static void draw(rig *r, double height_m, double climb_rad, const float jitter[2], uint32_t flags) {
    double position[3], forward[3], sun[3];
    for (int i = 0; i < 3; i++) {
        forward[i] = cos(climb_rad) * r->east[i] + sin(climb_rad) * r->up[i];
        sun[i] = 0.6 * r->up[i] - 0.8 * r->east[i];
    }
    fixture_position(LAT_DEG, LON_DEG, height_m, position);
    velum_view_frame camera = fixture_camera(position, forward, r->north, 0.4f, 0.3f);
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
                                 .width = W,
                                 .height = H};
    assert_true(r->f.standalone_api->render(r->f.engine, &frame, &eye, 1, 0, &pixels, 1, 0) >= 0);
}

/* Mean difference of transmittance. */
static double apart(const rig *r, const float *other) {
    double sum = 0.0;
    for (int i = 0; i < PIXELS; i++) {
        sum += fabs((double)r->through[3 * i] - (double)other[3 * i]) / PIXELS;
    }
    return sum;
}

/* An eye that rises out of a sheet of fog and looks level: nothing of the fog stays. */
static void what_is_left_behind_goes(void **state) {
    (void)state;
    static const float steady[2] = {0.0f, 0.0f};
    static float moving[PIXELS * 3];
    static rig r;
    const velum_layer fog = fixture_slab(16.0f);
    rig_init(&r, &fog);
    const double top_m = (double)fog.top_m;
    double height_m = top_m - 60.0;
    for (uint32_t i = 0; i < 34; i++, height_m += 4.0) {
        draw(&r, height_m, 0.1, steady, i == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
    }
    memcpy(moving, r.through, sizeof moving);
    height_m -= 4.0;
    r.time_s -= FRAME_S;
    for (uint32_t i = 0; i < AT_REST; i++) {
        draw(&r, height_m, 0.1, steady, i == 0 ? VELUM_VIEW_CUT : 0);
    }
    const double left = apart(&r, moving);
    print_message("out of fog: %.4f of transmittance is not there yet\n", left);
    assert_true(left <= 0.02);
    rig_finish(&r);
}

/* A host's jitter moves the rays, and not what history holds: were it not taken out, pictures would creep by it. */
static void jitter_carries_nothing_away(void **state) {
    (void)state;
    static const float aside[2] = {0.4f, -0.4f};
    static float still[PIXELS * 3];
    static rig r;
    const velum_layer cumulus = fixture_cumulus();
    rig_init(&r, &cumulus);
    for (uint32_t i = 0; i < AT_REST; i++) {
        draw(&r, 300.0, 0.3, aside, i == 0 ? VELUM_VIEW_CUT : 0);
    }
    memcpy(still, r.through, sizeof still);
    for (uint32_t i = 0; i < 32; i++) {
        r.time_s += 1e-4;
        draw(&r, 300.0, 0.3, aside, 0);
    }
    const double crept = apart(&r, still);
    print_message("jitter: %.4f of transmittance apart\n", crept);
    assert_true(crept <= 0.02);
    rig_finish(&r);
}

/* From under thick cloud, a board of the host's goes through the picture before it: nothing of the cloud lies over the
 * board and nothing of the board's clear air in the cloud, whether all else stands or the eye sinks. */
static void depth_parts_what_is_before_from_what_is_behind(void **state) {
    (void)state;
    static const float steady[2] = {0.0f, 0.0f};
    static float depth_m[PIXELS];
    static rig r;
    const velum_layer cloud = fixture_slab(16.0f);
    for (int sinks = 0; sinks < 2; sinks++) {
        rig_init(&r, &cloud);
        r.depth_m = depth_m;
        double height_m = (double)cloud.base_m - 100.0;
        double over = 0.0, under = 0.0;
        for (int frame = 0; frame < 40; frame++) {
            const int edge = (frame < 20 ? 3 * frame : 3 * (40 - frame)) % W;
            for (int i = 0; i < PIXELS; i++) {
                depth_m[i] = i % W < edge ? 20.0f : 0.0f;
            }
            draw(&r, height_m, 0.8, steady, frame == 0 ? VELUM_VIEW_CUT : 0);
            r.time_s += sinks ? FRAME_S : 0.0;
            height_m -= sinks ? 1.0 : 0.0;
            for (int i = 0; i < PIXELS; i++) {
                const double through = (double)r.through[3 * i];
                over = i % W < edge ? fmax(over, 1.0 - through) : over;
                under = i % W < edge ? under : fmax(under, through);
            }
        }
        print_message("board, %s: %.4f of cloud over it, %.4f of its air beside it\n", sinks ? "sinking" : "standing",
                      over, under);
        assert_true(over <= 1e-3);
        assert_true(under <= 0.01);
        rig_finish(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_left_behind_goes),
                                       cmocka_unit_test(jitter_carries_nothing_away),
                                       cmocka_unit_test(depth_parts_what_is_before_from_what_is_behind)};
    return cmocka_run_group_tests_name("motion", tests, NULL, NULL);
}
