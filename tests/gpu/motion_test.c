/* Pictures in motion against the same ones at rest: what history hands on stands where it belongs, or is given up. */
#include <math.h>
#include <string.h>

#include "fixture.h"

enum { W = 64, H = 48, PIXELS = W * H, AT_REST = 64 };
/* Of a view whose pixels are as fine as a window's. */
enum { FINE_W = 192, FINE_H = 144, FINE_PIXELS = FINE_W * FINE_H };
#define LAT_DEG 50.0
#define LON_DEG 8.5
#define FRAME_S (1.0 / 60.0)
static const float steady[2] = {0.0f, 0.0f}; /* no jitter */

typedef struct rig {
    fixture f;
    velum_view *view;
    uint32_t width, height;
    double east[3], north[3], up[3];
    double time_s;
    float light[FINE_PIXELS * 3], through[FINE_PIXELS * 3];
    const float *depth_m; /* of the host; null: none */
    float tan_x;
} rig;

static void rig_init_sized(rig *r, const velum_layer *layer, uint32_t width, uint32_t height) {
    memset(r, 0, sizeof *r);
    fixture_init(&r->f, false);
    fixture_commit(&r->f, layer, 1);
    r->view = fixture_view(&r->f, r->f.eye, width, height);
    r->width = width;
    r->height = height;
    r->tan_x = 0.4f;
    fixture_axes(LAT_DEG, LON_DEG, r->east, r->north, r->up);
}

static void rig_init(rig *r, const velum_layer *layer) {
    rig_init_sized(r, layer, W, H);
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

/* From a cut on, until nothing more changes. */
static void settle(rig *r, double height_m, double climb_rad) {
    for (uint32_t i = 0; i < AT_REST; i++) {
        draw(r, height_m, climb_rad, steady, i == 0 ? VELUM_VIEW_CUT : 0);
    }
}

/* Light of another picture of as many pixels, of what there is. */
static double light_of(const float *other, const rig *r) {
    double sum = 0.0, here = 0.0;
    for (uint32_t i = 0; i < r->width * r->height * 3; i++) {
        sum += (double)other[i];
        here += (double)r->light[i];
    }
    return sum / here;
}

/* Mean difference of transmittance. */
static double apart(const rig *r, const float *other) {
    const uint32_t pixels = r->width * r->height;
    double sum = 0.0;
    for (uint32_t i = 0; i < pixels; i++) {
        sum += fabs((double)r->through[3 * i] - (double)other[3 * i]) / pixels;
    }
    return sum;
}

/* An eye that rises out of a sheet of fog and looks level: nothing of the fog stays. */
static void what_is_left_behind_goes(void **state) {
    (void)state;
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
    settle(&r, height_m, 0.1);
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

/* Broken cloud goes by at 120 m/s behind a board of the host's over half the picture: what rays tell of the lag of
 * history (caught_up) makes no air lighter than none, and puts nothing over the board. */
static void lag_is_told_of_what_it_is_found_in(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static rig r;
    enum { FRAMES = 40, CLIMB_M = 2 };
    const velum_layer cumulus = fixture_cumulus();
    rig_init(&r, &cumulus);
    r.depth_m = depth_m;
    for (int i = 0; i < PIXELS; i++) {
        depth_m[i] = i % W < W / 2 ? 20.0f : 0.0f;
    }
    double most = 0.0, over = 0.0;
    for (int frame = 0; frame < FRAMES; frame++) {
        draw(&r, (double)cumulus.base_m - 600.0 + CLIMB_M * frame, 0.6, steady, frame == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
        for (int i = 0; i < PIXELS; i++) {
            const double through = (double)r.through[3 * i];
            most = fmax(most, through);
            over = i % W < W / 2 ? fmax(over, 1.0 - through) : over;
        }
    }
    print_message("board before broken cloud: %.4f of it over the board, transmittance of %.5f at most\n", over, most);
    assert_true(most <= 1.0 + 1e-4);
    assert_true(over <= 5e-3);
    rig_finish(&r);
}

/* A wire of the host's, a pixel or two wide, before thick cloud, in pixels as fine as a simulator's: the eye sinks, and
 * nothing of the cloud is shown over it. */
static void wires_stay_before_cloud(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static rig r;
    const velum_layer cloud = fixture_slab(16.0f);
    for (int width = 1; width <= 2; width++) {
        rig_init(&r, &cloud);
        r.depth_m = depth_m;
        r.tan_x = 0.038f;
        for (int i = 0; i < PIXELS; i++) {
            depth_m[i] = i % W >= 20 && i % W < 20 + width ? 20.0f : 0.0f;
        }
        double over = 0.0, beside = 0.0;
        for (int frame = 0; frame < 40; frame++) {
            draw(&r, (double)cloud.base_m - 100.0 - 0.001 * frame, 0.8, steady, frame == 0 ? VELUM_VIEW_CUT : 0);
            r.time_s += FRAME_S;
            for (int i = 0; i < PIXELS && frame > 30; i++) {
                const double through = (double)r.through[3 * i];
                over = depth_m[i] > 0.0f ? fmax(over, 1.0 - through) : over;
                beside = depth_m[i] > 0.0f ? beside : fmax(beside, through);
            }
        }
        print_message("wire of %d pixels: %.4f of cloud over it, %.4f of its air beside it\n", width, over, beside);
        assert_true(over <= 0.01);
        assert_true(beside <= 0.01);
        rig_finish(&r);
    }
}

/* Of a flight under a closed deck, the last frame's light; the host draws something 20 km away in so many columns. */
static void fly_under_deck(int columns, float light[PIXELS * 3]) {
    static float depth_m[PIXELS];
    static rig r;
    velum_layer deck = fixture_cumulus();
    deck.genus = VELUM_GENUS_SC;
    deck.coverage = 1.0f;
    rig_init(&r, &deck);
    r.depth_m = depth_m;
    for (int i = 0; i < PIXELS; i++) {
        depth_m[i] = i % W < columns ? 20000.0f : 0.0f;
    }
    for (int frame = 0; frame < 24; frame++) {
        draw(&r, (double)deck.base_m - 500.0 + 4.0 * frame, 0.8, steady, frame == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
    }
    for (int i = 0; i < PIXELS; i++) {
        assert_true(r.through[3 * i] < 0.01f);
    }
    memcpy(light, r.light, PIXELS * 3 * sizeof *light);
    rig_finish(&r);
}

/* What the host draws far behind closed cloud leaves no line in it, however the eye moves. */
static void closed_cloud_hides_depth_behind_it(void **state) {
    (void)state;
    static float with[PIXELS * 3], without[PIXELS * 3];
    fly_under_deck(W / 2 - 2, with);
    fly_under_deck(0, without);
    double most = 0.0;
    for (int i = 0; i < PIXELS * 3; i++) {
        most = fmax(most, fabs((double)with[i] / (double)without[i] - 1.0));
    }
    print_message("far depth behind a deck: light differs by %.5f at most\n", most);
    assert_true(most <= 1e-3);
}

static uint32_t rays_of(const rig *r) {
    velum_view_stats stats = {.struct_size = sizeof stats};
    assert_int_equal(r->f.engine_api->get_stats(r->view, &stats), VELUM_OK);
    return (uint32_t)stats.rays;
}

static void stand(rig *r, double height_m, uint32_t frames) {
    for (uint32_t i = 0; i < frames; i++) {
        r->time_s += FRAME_S;
        draw(r, height_m, 0.5, steady, 0);
    }
}

static uint32_t rays_standing(rig *r, double height_m, uint32_t frames) {
    uint32_t sum = 0;
    for (uint32_t i = 0; i < frames; i++) {
        stand(r, height_m, 1);
        sum += rays_of(r);
    }
    return sum;
}

/* Blocks; rays of a frame at most, while something moves. */
enum { BLOCKS = PIXELS / 16, MOST = BLOCKS + BLOCKS * 2 / 9 * 3 };

/* While time goes on: once every pixel has had its rays, fewer will do where they find nothing new, until the eye
 * moves, time stops, or the host imposes otherwise; never within a layer, where cloud goes by fast. */
static void views_that_stand_have_fewer_rays(void **state) {
    (void)state;
    static rig r;
    velum_layer cumulus = fixture_cumulus();
    cumulus.wind_east_m_s = 5.0f;
    rig_init(&r, &cumulus);
    const double under_m = (double)cumulus.base_m - 700.0;
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    assert_in_range(rays_standing(&r, under_m, 40), 40 * BLOCKS, 40 * MOST);
    stand(&r, under_m, 100);
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, &reasons), VELUM_OK);
    assert_int_equal(plan.ray_rate, 16);
    assert_true(plan.standing_ray_rate > 16);
    assert_non_null(strstr(reasons, "where views stand and rays find nothing new"));
    const uint32_t turns = plan.standing_ray_rate / 16;
    uint32_t rays = rays_standing(&r, under_m, turns);
    print_message("standing: %.3f of the rays\n", (double)rays / (turns * BLOCKS));
    assert_in_range(rays, BLOCKS, turns * BLOCKS * 9 / 10);
    assert_in_range(rays_standing(&r, under_m + 1.0, 1), BLOCKS, MOST);
    stand(&r, under_m + 1.0, 140);
    assert_in_range(rays_standing(&r, under_m + 1.0, turns), BLOCKS, turns * BLOCKS * 9 / 10);
    draw(&r, under_m + 1.0, 0.5, steady, 0);
    draw(&r, under_m + 1.0, 0.5, steady, 0);
    assert_int_equal(rays_of(&r), BLOCKS);
    /* Each third frame shows what the one before it did, as where a display is faster than the simulation. */
    rays = 0;
    for (uint32_t i = 0; i < 120; i++) {
        i % 3 == 2 ? draw(&r, under_m, 0.5, steady, 0) : stand(&r, under_m, 1);
        rays += i >= 120 - turns ? rays_of(&r) : 0;
    }
    assert_in_range(rays, BLOCKS, turns * BLOCKS * 9 / 10);
    stand(&r, 0.5 * (double)(cumulus.base_m + cumulus.top_m), 80);
    assert_in_range(rays_of(&r), BLOCKS, MOST);
    /* Seconds a frame. */
    for (uint32_t i = 0; i < 60; i++) {
        r.time_s += 2.0;
        draw(&r, under_m, 0.5, steady, 0);
    }
    assert_in_range(rays_of(&r), BLOCKS, MOST);
    plan.standing_ray_rate = 0;
    plan.finer_rays = 0;
    assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
    assert_int_equal(rays_standing(&r, under_m, 80), 80 * BLOCKS);
    rig_finish(&r);
}

typedef struct flown {
    float light[PIXELS * 3], through[PIXELS * 3]; /* of the last frame */
    double off, light_off;                        /* mean difference from rest: of transmittance; of light, relative */
    uint32_t rays;                                /* a frame */
} flown;

/* Under a field of cumulus, rising at 120 m/s. */
static void fly(rig *r, uint32_t ray_rate, bool finer, flown *out) {
    enum { FRAMES = 40 };
    const velum_layer cumulus = fixture_cumulus();
    velum_plan plan = {.struct_size = sizeof plan};
    rig_init(r, &cumulus);
    const double from_m = (double)cumulus.base_m - 400.0;
    draw(r, from_m, 0.5, steady, 0);
    assert_int_equal(r->f.engine_api->get_plan(r->f.eye, &plan, NULL), VELUM_OK);
    assert_int_equal(plan.finer_rays, 1);
    plan.ray_rate = ray_rate;
    plan.finer_rays = finer;
    assert_int_equal(r->f.engine_api->set_plan(r->f.eye, &plan), VELUM_OK);
    out->rays = 0;
    for (uint32_t i = 0; i < FRAMES; i++) {
        r->time_s += FRAME_S;
        draw(r, from_m + 2.0 * i, 0.5, steady, i == 0 ? VELUM_VIEW_CUT : 0);
        out->rays += i == 0 ? 0 : rays_of(r);
    }
    out->rays /= FRAMES - 1;
    memcpy(out->light, r->light, sizeof out->light);
    memcpy(out->through, r->through, sizeof out->through);
    plan.ray_rate = 1;
    assert_int_equal(r->f.engine_api->set_plan(r->f.eye, &plan), VELUM_OK);
    for (uint32_t i = 0; i < 16; i++) {
        draw(r, from_m + 2.0 * (FRAMES - 1), 0.5, steady, i == 0 ? VELUM_VIEW_CUT : 0);
    }
    out->off = apart(r, out->through);
    double all = 0.0, off = 0.0;
    for (int i = 0; i < PIXELS * 3; i++) {
        off += fabs((double)out->light[i] - (double)r->light[i]);
        all += (double)r->light[i];
    }
    out->light_off = off / all;
    rig_finish(r);
}

/* Rays more where rays differ, and nowhere else; they bring pictures in motion nearer to rest, whatever the rate; which
 * blocks have them does not go by the order in which the device comes to them. */
static void blocks_of_moving_views_have_more_rays_where_rays_differ(void **state) {
    (void)state;
    static flown coarse, finer, again;
    static rig r;
    for (uint32_t rate = 4; rate <= 64; rate *= 4) {
        fly(&r, rate, false, &coarse);
        assert_int_equal(coarse.rays, PIXELS / rate);
        fly(&r, rate, true, &finer);
        print_message("1 ray for %u: %.4f from rest (light %.4f), with finer blocks %.4f (%.4f) in %.2f of the rays\n",
                      rate, coarse.off, coarse.light_off, finer.off, finer.light_off,
                      (double)finer.rays * rate / PIXELS);
        assert_in_range(finer.rays, PIXELS / rate * 21 / 20, PIXELS / rate * 5 / 3);
        /* Blocks of 64 are as large as the clouds of this picture. */
        const double share = rate < 64 ? 0.9 : 0.98;
        assert_true(finer.off < share * coarse.off && finer.light_off < share * coarse.light_off);
        fly(&r, rate, true, &again);
        assert_memory_equal(&again, &finer, sizeof finer);
    }
    fly(&r, 2, true, &finer);
    assert_int_equal(finer.rays, PIXELS / 2);
    assert_true(finer.off < 0.1);
    const velum_layer slab = fixture_slab(16.0f);
    rig_init(&r, &slab);
    stand(&r, (double)slab.base_m - 100.0, 2);
    assert_int_equal(rays_standing(&r, (double)slab.base_m - 90.0, 1), BLOCKS);
    rig_finish(&r);
}

/* Blocks and tiles that the picture's edges cut have their turns like others: what stands is what settles. */
static void views_of_any_size_stand(void **state) {
    (void)state;
    enum { WIDTH = 37, HEIGHT = 21, ALL = ((WIDTH + 3) / 4) * ((HEIGHT + 3) / 4), TURNS = 8 };
    static rig r;
    static float stood[PIXELS * 3];
    /* Lumps: of so few pixels most of a cumulus is rim, which is never calm. */
    velum_layer lumps = fixture_cumulus();
    lumps.genus = VELUM_GENUS_SC;
    lumps.wind_east_m_s = 1.5f;
    rig_init_sized(&r, &lumps, WIDTH, HEIGHT);
    const double under_m = (double)lumps.base_m - 700.0;
    stand(&r, under_m, 16 * (3 + TURNS));
    assert_in_range(rays_standing(&r, under_m, TURNS), ALL, TURNS * ALL * 9 / 10);
    memcpy(stood, r.through, sizeof stood);
    for (int i = 0; i < AT_REST; i++) {
        draw(&r, under_m, 0.5, steady, 0);
    }
    double all = 0.0, edge = 0.0, cloud = 0.0;
    uint32_t edges = 0;
    for (uint32_t i = 0; i < WIDTH * HEIGHT; i++) {
        const double apart = fabs((double)stood[3 * i] - (double)r.through[3 * i]);
        all += apart / (WIDTH * HEIGHT);
        cloud += (1.0 - (double)r.through[3 * i]) / (WIDTH * HEIGHT);
        if (i % WIDTH == WIDTH - 1 || i / WIDTH == HEIGHT - 1) {
            edge += apart;
            edges++;
        }
    }
    edge /= edges;
    print_message("37 x 21: %.3f of it cloud; standing within %.4f of rest, %.4f at its last row and column\n", cloud,
                  all, edge);
    assert_true(cloud > 0.1);
    assert_true(all <= 0.02 && edge <= 0.015);
    rig_finish(&r);
}

/* Under a slab nothing changes: each pixel has one ray in a round of all tiles. A board of the host's comes before it
 * and goes: there are rays in that frame wherever it stood, and nothing of either is left on the other. */
static void calm_tiles_have_rays_where_the_host_draws_anew(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static rig r;
    const velum_layer cloud = fixture_slab(16.0f);
    rig_init(&r, &cloud);
    r.depth_m = depth_m;
    const double height_m = (double)cloud.base_m - 100.0;
    velum_plan plan = {.struct_size = sizeof plan};
    stand(&r, height_m, 200);
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
    const uint32_t turns = plan.standing_ray_rate / 16;
    assert_int_equal(rays_standing(&r, height_m, turns * 16), 16 * BLOCKS);
    for (int turn = 0; turn < 4; turn++) {
        const bool board = turn % 2 == 0;
        for (int i = 0; i < PIXELS; i++) {
            depth_m[i] = board && i % W < W / 2 ? 20.0f : 0.0f;
        }
        assert_in_range(rays_standing(&r, height_m, 1), BLOCKS / 2, BLOCKS * 3 / 4);
        for (int i = 0; i < PIXELS; i++) {
            const double through = (double)r.through[3 * i];
            assert_true(board && i % W < W / 2 ? through >= 0.999 : through <= 0.01);
        }
        stand(&r, height_m, 60);
    }
    rig_finish(&r);
}

/* Under drifting cloud light is handed on from frame to frame a hundred times; nothing may be lost on the way, by
 * numbers of 16 bits or by filters. */
static void handing_on_takes_no_light(void **state) {
    (void)state;
    static float moving[PIXELS * 3];
    static rig r;
    velum_layer cumulus = fixture_cumulus();
    cumulus.wind_east_m_s = 5.0f;
    rig_init(&r, &cumulus);
    const double under_m = (double)cumulus.base_m - 700.0;
    stand(&r, under_m, 200);
    memcpy(moving, r.light, sizeof moving);
    settle(&r, under_m, 0.5);
    const double handed_on = light_of(moving, &r);
    print_message("handed on: %.4f of the light at rest\n", handed_on);
    assert_true(fabs(handed_on - 1.0) <= 0.01);
    rig_finish(&r);
}

/* Of transmittance in a fine view: how far pixels lie from the mean of those beside them. */
static double roughness(const rig *r) {
    double sum = 0.0;
    for (int y = 1; y < FINE_H - 1; y++) {
        for (int x = 1; x < FINE_W - 1; x++) {
            const float *at = &r->through[3 * (y * FINE_W + x)];
            const double beside =
                ((double)at[-3] + (double)at[3] + (double)at[-3 * FINE_W] + (double)at[3 * FINE_W]) / 4.0;
            sum += fabs((double)at[0] - beside);
        }
    }
    return sum;
}

/* Once its pixels have had rays from all places, a view under drifting cloud shows edges nearly as sharp as they are at
 * rest, whether its history is kept in place or, where the host gives depth, written anew; so in a frame with another
 * plan; and from the frame on in which time stops, after which it comes to what it is at rest. */
static void standing_under_drifting_cloud_is_sharp(void **state) {
    (void)state;
    static const float clear_depth_m[FINE_PIXELS];
    static float stopped[FINE_PIXELS * 3], rested[FINE_PIXELS * 3];
    static rig r;
    for (int turn = 0; turn < 2; turn++) {
        velum_layer cumulus = fixture_cumulus();
        cumulus.wind_east_m_s = 5.0f;
        rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
        r.tan_x = 0.15f;
        r.depth_m = turn == 1 ? clear_depth_m : NULL;
        const double under_m = (double)cumulus.base_m - 700.0;
        stand(&r, under_m, 300);
        const double drifting = roughness(&r);
        velum_plan plan = {.struct_size = sizeof plan};
        assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
        plan.march_steps += 8;
        assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
        stand(&r, under_m, 1);
        const double planned = roughness(&r);
        stand(&r, under_m, 100);
        double least = INFINITY, leap = 0.0;
        for (uint32_t i = 0; i < AT_REST + 16; i++) {
            memcpy(stopped, r.through, sizeof stopped);
            draw(&r, under_m, 0.5, steady, 0);
            least = fmin(least, roughness(&r));
            leap = fmax(leap, apart(&r, stopped));
        }
        memcpy(stopped, r.through, sizeof stopped);
        settle(&r, under_m, 0.5);
        const double resting = roughness(&r);
        memcpy(rested, r.through, sizeof rested);
        for (uint32_t i = 0; i < 4 * AT_REST; i++) {
            draw(&r, under_m, 0.5, steady, 0);
        }
        const double off = apart(&r, stopped), rested_off = apart(&r, rested);
        print_message("under drifting cloud: %.3f as rough as at rest, %.3f in a frame with another plan, %.3f or more "
                      "once time stops, changed by no more than %.5f in a frame, then off by %.5f (%.5f from a cut)\n",
                      drifting / resting, planned / resting, least / resting, leap, off, rested_off);
        assert_true(drifting > 0.7 * resting && drifting < resting);
        assert_true(planned > 0.95 * drifting && planned < 1.05 * drifting);
        assert_true(least > 0.95 * drifting);
        assert_true(leap <= 0.0005);
        assert_true(off <= 0.0015 && off <= rested_off + 0.0003);
        rig_finish(&r);
    }
}

static double green(const float *rgb, int x, int y) {
    return (double)rgb[3 * (y * FINE_W + x) + 1];
}

/* How far the light of pixels is off against that of those beside them, of what is there at rest: root of the mean
 * square. */
static double grain(const float *moving, const float *rest) {
    double sum = 0.0;
    for (int y = 1; y < FINE_H - 1; y++) {
        for (int x = 1; x < FINE_W - 1; x++) {
            double beside = 0.0;
            for (int k = -1; k <= 1; k += 2) {
                beside +=
                    green(moving, x + k, y) / green(rest, x + k, y) + green(moving, x, y + k) / green(rest, x, y + k);
            }
            const double off = green(moving, x, y) / green(rest, x, y) - 0.25 * beside;
            sum += off * off;
        }
    }
    return sqrt(sum / ((FINE_W - 2) * (FINE_H - 2)));
}

/* Cloud that an eye flies into at 240 m/s passes before its pixels have rays of their own: it shows no grain all the
 * same, and is as bright as it is, whether the host gives depth or not. */
static void near_cloud_passes_without_grain(void **state) {
    (void)state;
    static const float clear_depth_m[FINE_PIXELS];
    static float moving[FINE_PIXELS * 3];
    static rig r;
    enum { BEGINS_M = -160, STEP_M = 4, FIRST_SEEN = 40, SEEN_EVERY = 8, FRAMES = 57 };
    for (int turn = 0; turn < 2; turn++) {
        velum_layer cumulus = fixture_cumulus();
        cumulus.coverage = 0.6f;
        rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
        r.tan_x = 0.3f;
        r.depth_m = turn == 1 ? clear_depth_m : NULL;
        const double base_m = (double)cumulus.base_m;
        double most = 0.0, worst_off = 0.0;
        for (uint32_t seen = FIRST_SEEN; seen < FRAMES; seen += SEEN_EVERY) {
            for (uint32_t i = 0; i <= seen; i++) {
                draw(&r, base_m + BEGINS_M + STEP_M * i, 0.4, steady, i == 0 ? VELUM_VIEW_CUT : 0);
                r.time_s += FRAME_S;
            }
            memcpy(moving, r.light, sizeof moving);
            r.time_s -= FRAME_S;
            settle(&r, base_m + BEGINS_M + STEP_M * seen, 0.4);
            most = fmax(most, grain(moving, r.light));
            worst_off = fmax(worst_off, fabs(light_of(moving, &r) - 1.0));
        }
        print_message("into near cloud: grain of %.4f, mean off by %.4f at most\n", most, worst_off);
        assert_true(most <= 0.005);
        assert_true(worst_off <= 0.02);
        rig_finish(&r);
    }
}

/* Clouds that pass at 120 m/s, in a view as fine as a window's: their edges are no softer than what history tells of
 * them. By steps of 110 m 0.093 of the mean light is off, 0.097 where rays do not tell how far history lags, and 0.099
 * where a pixel's new ray counts for no more than history besides; near.comp would add 0.011, did it take rays together
 * across edges. By shorter steps these lie nearer to each other. */
static void edges_that_pass_stay_sharp(void **state) {
    (void)state;
    static float moving[FINE_PIXELS * 3];
    static rig r;
    enum { CLIMB_M = 2, FRAMES = 33 };
    const velum_layer cumulus = fixture_cumulus();
    rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
    r.tan_x = 0.0577f;
    const double from_m = (double)cumulus.base_m + 1000.0;
    draw(&r, from_m, 0.0, steady, VELUM_VIEW_CUT);
    velum_plan plan = {.struct_size = sizeof plan};
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
    plan.step_m = 110.0f;
    assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
    for (uint32_t i = 0; i < FRAMES; i++) {
        draw(&r, from_m + CLIMB_M * i, 0.0, steady, i == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
    }
    memcpy(moving, r.light, sizeof moving);
    r.time_s -= FRAME_S;
    settle(&r, from_m + CLIMB_M * (FRAMES - 1), 0.0);
    double off2 = 0.0, mean = 0.0;
    for (int i = 0; i < FINE_PIXELS * 3; i++) {
        const double off = (double)moving[i] - (double)r.light[i];
        off2 += off * off / (FINE_PIXELS * 3);
        mean += (double)r.light[i] / (FINE_PIXELS * 3);
    }
    print_message("edges that pass: %.4f of the mean light off\n", sqrt(off2) / mean);
    assert_true(sqrt(off2) <= 0.096 * mean);
    rig_finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_is_left_behind_goes),
                                       cmocka_unit_test(jitter_carries_nothing_away),
                                       cmocka_unit_test(depth_parts_what_is_before_from_what_is_behind),
                                       cmocka_unit_test(lag_is_told_of_what_it_is_found_in),
                                       cmocka_unit_test(wires_stay_before_cloud),
                                       cmocka_unit_test(closed_cloud_hides_depth_behind_it),
                                       cmocka_unit_test(views_that_stand_have_fewer_rays),
                                       cmocka_unit_test(blocks_of_moving_views_have_more_rays_where_rays_differ),
                                       cmocka_unit_test(views_of_any_size_stand),
                                       cmocka_unit_test(calm_tiles_have_rays_where_the_host_draws_anew),
                                       cmocka_unit_test(handing_on_takes_no_light),
                                       cmocka_unit_test(standing_under_drifting_cloud_is_sharp),
                                       cmocka_unit_test(near_cloud_passes_without_grain),
                                       cmocka_unit_test(edges_that_pass_stay_sharp)};
    return cmocka_run_group_tests_name("motion", tests, NULL, NULL);
}
