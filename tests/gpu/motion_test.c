/* Pictures in motion against the same ones at rest: what history hands on stands where it belongs, or is given up. */
#include <math.h>
#include <string.h>

#include "motion_rig.h"
#include "shared/lit.h"

/* An eye that rises out of a sheet of fog and looks level: nothing of the fog stays. */
static void what_is_left_behind_goes(void **state) {
    (void)state;
    static float moving[PIXELS * 3];
    static motion_rig r;
    const velum_layer fog = fixture_slab(16.0f);
    motion_rig_init(&r, &fog);
    const double top_m = (double)fog.top_m;
    double height_m = top_m - 60.0;
    for (uint32_t i = 0; i < 34; i++, height_m += 4.0) {
        motion_draw(&r, height_m, 0.1, motion_steady, i == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
    }
    memcpy(moving, r.through, sizeof moving);
    height_m -= 4.0;
    r.time_s -= FRAME_S;
    motion_settle(&r, height_m, 0.1);
    const double left = motion_apart(&r, moving);
    print_message("out of fog: %.4f of transmittance is not there yet\n", left);
    assert_true(left <= 0.02);
    motion_rig_finish(&r);
}

/* A host's jitter moves the rays, and not what history holds: were it not taken out, pictures would creep by it. */
static void jitter_carries_nothing_away(void **state) {
    (void)state;
    static const float aside[2] = {0.4f, -0.4f};
    static float still[PIXELS * 3];
    static motion_rig r;
    const velum_layer cumulus = fixture_cumulus();
    motion_rig_init(&r, &cumulus);
    for (uint32_t i = 0; i < AT_REST; i++) {
        motion_draw(&r, 300.0, 0.3, aside, i == 0 ? VELUM_VIEW_CUT : 0);
    }
    memcpy(still, r.through, sizeof still);
    for (uint32_t i = 0; i < 32; i++) {
        r.time_s += 1e-4;
        motion_draw(&r, 300.0, 0.3, aside, 0);
    }
    const double crept = motion_apart(&r, still);
    print_message("jitter: %.4f of transmittance apart\n", crept);
    assert_true(crept <= 0.02);
    motion_rig_finish(&r);
}

/* From under thick cloud, a board of the host's goes through the picture before it: nothing of the cloud lies over the
 * board and nothing of the board's clear air in the cloud, whether all else stands or the eye sinks. */
static void depth_parts_what_is_before_from_what_is_behind(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static motion_rig r;
    const velum_layer cloud = fixture_slab(16.0f);
    for (int sinks = 0; sinks < 2; sinks++) {
        motion_rig_init(&r, &cloud);
        r.depth_m = depth_m;
        double height_m = (double)cloud.base_m - 100.0;
        double over = 0.0, under = 0.0;
        for (int frame = 0; frame < 40; frame++) {
            const int edge = (frame < 20 ? 3 * frame : 3 * (40 - frame)) % W;
            for (int i = 0; i < PIXELS; i++) {
                depth_m[i] = i % W < edge ? 20.0f : 0.0f;
            }
            motion_draw(&r, height_m, 0.8, motion_steady, frame == 0 ? VELUM_VIEW_CUT : 0);
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
        motion_rig_finish(&r);
    }
}

/* Broken cloud goes by at 120 m/s behind a board of the host's over half the picture: what rays tell of the lag of
 * history (caught_up) makes no air lighter than none, and puts nothing over the board. */
static void lag_is_told_of_what_it_is_found_in(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static motion_rig r;
    enum { FRAMES = 40, CLIMB_M = 2 };
    const velum_layer cumulus = fixture_cumulus();
    motion_rig_init(&r, &cumulus);
    r.depth_m = depth_m;
    for (int i = 0; i < PIXELS; i++) {
        depth_m[i] = i % W < W / 2 ? 20.0f : 0.0f;
    }
    double most = 0.0, over = 0.0;
    for (int frame = 0; frame < FRAMES; frame++) {
        motion_draw(&r, (double)cumulus.base_m - 600.0 + CLIMB_M * frame, 0.6, motion_steady,
                    frame == 0 ? VELUM_VIEW_CUT : 0);
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
    motion_rig_finish(&r);
}

/* A wire of the host's, a pixel or two wide, before thick cloud, in pixels as fine as a simulator's: the eye sinks, and
 * nothing of the cloud is shown over it. */
static void wires_stay_before_cloud(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static motion_rig r;
    const velum_layer cloud = fixture_slab(16.0f);
    for (int width = 1; width <= 2; width++) {
        motion_rig_init(&r, &cloud);
        r.depth_m = depth_m;
        r.tan_x = 0.038f;
        for (int i = 0; i < PIXELS; i++) {
            depth_m[i] = i % W >= 20 && i % W < 20 + width ? 20.0f : 0.0f;
        }
        double over = 0.0, beside = 0.0;
        for (int frame = 0; frame < 40; frame++) {
            motion_draw(&r, (double)cloud.base_m - 100.0 - 0.001 * frame, 0.8, motion_steady,
                        frame == 0 ? VELUM_VIEW_CUT : 0);
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
        motion_rig_finish(&r);
    }
}

/* Of a flight under a closed deck, the last frame's light; the host draws something 20 km away in so many columns. */
static void fly_under_deck(int columns, float light[PIXELS * 3]) {
    static float depth_m[PIXELS];
    static motion_rig r;
    velum_layer deck = fixture_cumulus();
    deck.genus = VELUM_GENUS_SC;
    deck.coverage = 1.0f;
    motion_rig_init(&r, &deck);
    r.depth_m = depth_m;
    for (int i = 0; i < PIXELS; i++) {
        depth_m[i] = i % W < columns ? 20000.0f : 0.0f;
    }
    for (int frame = 0; frame < 24; frame++) {
        motion_draw(&r, (double)deck.base_m - 500.0 + 4.0 * frame, 0.8, motion_steady, frame == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
    }
    for (int i = 0; i < PIXELS; i++) {
        assert_true(r.through[3 * i] < 0.01f);
    }
    memcpy(light, r.light, PIXELS * 3 * sizeof *light);
    motion_rig_finish(&r);
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

typedef struct flown {
    float light[PIXELS * 3], through[PIXELS * 3]; /* of the last frame */
    double off, light_off;                        /* mean difference from rest: of transmittance; of light, relative */
    uint32_t rays;                                /* a frame */
} flown;

enum { FLIGHT_FRAMES = 40 };

/* Of the eye under a field of cumulus. */
static double begin_flight(motion_rig *r, uint32_t ray_rate, bool finer) {
    const velum_layer cumulus = fixture_cumulus();
    velum_plan plan = {.struct_size = sizeof plan};
    motion_rig_init(r, &cumulus);
    const double from_m = (double)cumulus.base_m - 400.0;
    motion_draw(r, from_m, 0.5, motion_steady, 0);
    assert_int_equal(r->f.engine_api->get_plan(r->f.eye, &plan, NULL), VELUM_OK);
    assert_int_equal(plan.finer_rays, 1);
    plan.ray_rate = ray_rate;
    plan.finer_rays = finer;
    assert_int_equal(r->f.engine_api->set_plan(r->f.eye, &plan), VELUM_OK);
    return from_m;
}

static void keep(const motion_rig *r, flown *out) {
    memcpy(out->light, r->light, sizeof out->light);
    memcpy(out->through, r->through, sizeof out->through);
}

/* Where a flight ends. */
static void rest(motion_rig *r, flown *out) {
    const double from_m = begin_flight(r, 1, false);
    r->time_s = FLIGHT_FRAMES * FRAME_S;
    for (uint32_t i = 0; i < 16; i++) {
        motion_draw(r, from_m + 2.0 * (FLIGHT_FRAMES - 1), 0.5, motion_steady, i == 0 ? VELUM_VIEW_CUT : 0);
    }
    keep(r, out);
    motion_rig_finish(r);
}

/* Rising at 120 m/s. */
static void fly(motion_rig *r, uint32_t ray_rate, bool finer, const flown *rested, flown *out) {
    const double from_m = begin_flight(r, ray_rate, finer);
    out->rays = 0;
    for (uint32_t i = 0; i < FLIGHT_FRAMES; i++) {
        r->time_s += FRAME_S;
        motion_draw(r, from_m + 2.0 * i, 0.5, motion_steady, i == 0 ? VELUM_VIEW_CUT : 0);
        out->rays += i == 0 ? 0 : motion_rays(r);
    }
    out->rays /= FLIGHT_FRAMES - 1;
    keep(r, out);
    out->off = motion_apart(r, rested->through);
    double all = 0.0, off = 0.0;
    for (int i = 0; i < PIXELS * 3; i++) {
        off += fabs((double)out->light[i] - (double)rested->light[i]);
        all += (double)rested->light[i];
    }
    out->light_off = off / all;
    motion_rig_finish(r);
}

/* Rays more where rays differ, and nowhere else; they bring pictures in motion nearer to rest, whatever the rate; which
 * blocks have them does not go by the order in which the device comes to them. */
static void blocks_of_moving_views_have_more_rays_where_rays_differ(void **state) {
    (void)state;
    static flown rested, coarse, finer, again;
    static motion_rig r;
    rest(&r, &rested);
    for (uint32_t rate = 4; rate <= 64; rate *= 4) {
        fly(&r, rate, false, &rested, &coarse);
        assert_int_equal(coarse.rays, PIXELS / rate);
        fly(&r, rate, true, &rested, &finer);
        print_message("1 ray for %u: %.4f from rest (light %.4f), with finer blocks %.4f (%.4f) in %.2f of the rays\n",
                      rate, coarse.off, coarse.light_off, finer.off, finer.light_off,
                      (double)finer.rays * rate / PIXELS);
        assert_in_range(finer.rays, PIXELS / rate * 21 / 20, PIXELS / rate * 5 / 3);
        /* Blocks of 64 are as large as the clouds of this picture. */
        const double share = rate < 64 ? 0.9 : 0.98;
        assert_true(finer.off < share * coarse.off && finer.light_off < share * coarse.light_off);
        fly(&r, rate, true, &rested, &again);
        assert_memory_equal(&again, &finer, sizeof finer);
    }
    fly(&r, 2, true, &rested, &finer);
    assert_int_equal(finer.rays, PIXELS / 2);
    assert_true(finer.off < 0.1);
    const velum_layer slab = fixture_slab(16.0f);
    motion_rig_init(&r, &slab);
    motion_stand(&r, (double)slab.base_m - 100.0, 2);
    assert_int_equal(motion_rays_standing(&r, (double)slab.base_m - 90.0, 1), BLOCKS);
    motion_rig_finish(&r);
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
    enum { BEGINS_M = -160, STEP_M = 4, FIRST_SEEN = 40, SEEN_EVERY = 8, SEEN = 3 };
    static float moving[SEEN][FINE_PIXELS * 3];
    static motion_rig r;
    for (int turn = 0; turn < 2; turn++) {
        velum_layer cumulus = fixture_cumulus();
        cumulus.coverage = 0.6f;
        motion_rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
        r.tan_x = 0.3f;
        r.depth_m = turn == 1 ? clear_depth_m : NULL;
        const double base_m = (double)cumulus.base_m;
        double most = 0.0, worst_off = 0.0;
        for (uint32_t seen = 0, frame = 0; seen < SEEN; seen++) {
            for (; frame <= FIRST_SEEN + seen * SEEN_EVERY; frame++) {
                r.time_s = frame * FRAME_S;
                motion_draw(&r, base_m + BEGINS_M + STEP_M * frame, 0.4, motion_steady,
                            frame == 0 ? VELUM_VIEW_CUT : 0);
            }
            memcpy(moving[seen], r.light, sizeof moving[seen]);
        }
        for (uint32_t seen = 0; seen < SEEN; seen++) {
            const uint32_t frame = FIRST_SEEN + seen * SEEN_EVERY;
            r.time_s = frame * FRAME_S;
            motion_settle(&r, base_m + BEGINS_M + STEP_M * frame, 0.4);
            most = fmax(most, grain(moving[seen], r.light));
            worst_off = fmax(worst_off, fabs(motion_light_of(moving[seen], &r) - 1.0));
        }
        print_message("into near cloud: grain of %.4f, mean off by %.4f at most\n", most, worst_off);
        assert_true(most <= 0.005);
        assert_true(worst_off <= 0.02);
        motion_rig_finish(&r);
    }
}

/* Clouds that pass at 120 m/s, in a view as fine as a window's: their edges are no softer than what history tells of
 * them. By steps of 110 m 0.093 of the mean light is off, 0.097 where rays do not tell how far history lags, and 0.099
 * where a pixel's new ray counts for no more than history besides; near.comp would add 0.011, did it take rays together
 * across edges. By shorter steps these lie nearer to each other. */
static void edges_that_pass_stay_sharp(void **state) {
    (void)state;
    static float moving[FINE_PIXELS * 3];
    static motion_rig r;
    enum { CLIMB_M = 2, FRAMES = 33 };
    const velum_layer cumulus = fixture_cumulus();
    motion_rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
    r.tan_x = 0.0577f;
    const double from_m = (double)cumulus.base_m + 1000.0;
    motion_draw(&r, from_m, 0.0, motion_steady, VELUM_VIEW_CUT);
    velum_plan plan = {.struct_size = sizeof plan};
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
    plan.step_m = 110.0f;
    assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
    for (uint32_t i = 0; i < FRAMES; i++) {
        motion_draw(&r, from_m + CLIMB_M * i, 0.0, motion_steady, i == 0 ? VELUM_VIEW_CUT : 0);
        r.time_s += FRAME_S;
    }
    memcpy(moving, r.light, sizeof moving);
    r.time_s -= FRAME_S;
    motion_settle(&r, from_m + CLIMB_M * (FRAMES - 1), 0.0);
    double off2 = 0.0, mean = 0.0;
    for (int i = 0; i < FINE_PIXELS * 3; i++) {
        const double off = (double)moving[i] - (double)r.light[i];
        off2 += off * off / (FINE_PIXELS * 3);
        mean += (double)r.light[i] / (FINE_PIXELS * 3);
    }
    print_message("edges that pass: %.4f of the mean light off\n", sqrt(off2) / mean);
    assert_true(sqrt(off2) <= 0.096 * mean);
    motion_rig_finish(&r);
}

/* Rising at 120 m/s under cumulus: how far the last frame's transmittance is from rest. */
static double rise_under_cumulus(const float *depth_m) {
    static float moving[FINE_PIXELS * 3];
    static motion_rig r;
    const velum_layer cumulus = fixture_cumulus();
    motion_rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
    r.depth_m = depth_m;
    double height_m = (double)cumulus.base_m - 700.0;
    for (uint32_t i = 0; i < AT_REST; i++) {
        r.time_s += FRAME_S;
        height_m += 120.0 * FRAME_S;
        motion_draw(&r, height_m, 0.5, motion_steady, i == 0 ? VELUM_VIEW_CUT : 0);
    }
    memcpy(moving, r.through, sizeof moving);
    motion_settle(&r, height_m, 0.5);
    const double off = motion_apart(&r, moving);
    motion_rig_finish(&r);
    return off;
}

/* Behind all clouds the host has drawn a surface, as terrain mostly is: where cloud closes before it, history is no
 * worse. */
static void surfaces_behind_clouds_cost_no_history(void **state) {
    (void)state;
    static float far_depth_m[FINE_PIXELS];
    for (int i = 0; i < FINE_PIXELS; i++) {
        far_depth_m[i] = 200000.0f;
    }
    const double before_sky = rise_under_cumulus(NULL), before_surface = rise_under_cumulus(far_depth_m);
    print_message("rising: %.4f from rest before sky, %.4f before a surface\n", before_sky, before_surface);
    assert_true(before_surface <= 1.1 * before_sky);
}

/* Where a device's texel buffers have no room for a ray for each pixel, there are as many as there is room for, and the
 * picture is much the same. */
static void rays_are_as_many_as_texels_hold(void **state) {
    (void)state;
    static float all[PIXELS * 3];
    static motion_rig r;
    const velum_layer cumulus = fixture_cumulus();
    const double under_m = (double)cumulus.base_m - 700.0;
    motion_rig_init(&r, &cumulus);
    motion_stand(&r, under_m, 1);
    velum_plan plan = {.struct_size = sizeof plan};
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
    plan.ray_rate = 1;
    plan.standing_ray_rate = 0;
    assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
    motion_stand(&r, under_m, AT_REST);
    assert_int_equal(motion_rays(&r), PIXELS);
    memcpy(all, r.light, sizeof all);
    const uint32_t most = fixture_limit_texels(r.f.engine, PIXELS / 2 * VELUM_LIT_ROOM);
    motion_stand(&r, under_m, AT_REST);
    fixture_limit_texels(r.f.engine, most);
    const double share = (double)motion_rays(&r) / PIXELS, light = motion_light_of(all, &r);
    print_message("with texels for half of the rays: %.3f of them, %.4f of the light\n", share, 1.0 / light);
    assert_true(share >= 0.25 && share < 0.5);
    assert_true(fabs(light - 1.0) <= 0.01);
    motion_rig_finish(&r);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(rays_are_as_many_as_texels_hold),
                                       cmocka_unit_test(what_is_left_behind_goes),
                                       cmocka_unit_test(jitter_carries_nothing_away),
                                       cmocka_unit_test(depth_parts_what_is_before_from_what_is_behind),
                                       cmocka_unit_test(lag_is_told_of_what_it_is_found_in),
                                       cmocka_unit_test(wires_stay_before_cloud),
                                       cmocka_unit_test(closed_cloud_hides_depth_behind_it),
                                       cmocka_unit_test(blocks_of_moving_views_have_more_rays_where_rays_differ),
                                       cmocka_unit_test(near_cloud_passes_without_grain),
                                       cmocka_unit_test(edges_that_pass_stay_sharp),
                                       cmocka_unit_test(surfaces_behind_clouds_cost_no_history)};
    return cmocka_run_group_tests_name("motion", tests, NULL, fixture_shared_finish);
}
