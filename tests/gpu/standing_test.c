/* Views that stand: rays only where there is something new, and pictures as sharp and as bright as they come to be. */
#include <math.h>
#include <string.h>

#include "motion_rig.h"

/* While time goes on: once every pixel has had its rays, fewer will do where they find nothing new, until the eye
 * moves, time stops, or the host imposes otherwise; never within a layer, where cloud goes by fast. */
static void views_that_stand_have_fewer_rays(void **state) {
    (void)state;
    static motion_rig r;
    velum_layer cumulus = fixture_cumulus();
    cumulus.wind_east_m_s = 5.0f;
    motion_rig_init(&r, &cumulus);
    const double under_m = (double)cumulus.base_m - 700.0;
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    assert_in_range(motion_rays_standing(&r, under_m, 40), 40 * BLOCKS, 40 * MOST);
    motion_stand(&r, under_m, 100);
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, &reasons), VELUM_OK);
    assert_int_equal(plan.ray_rate, 16);
    assert_true(plan.standing_ray_rate > 16);
    assert_non_null(strstr(reasons, "where views stand and rays find nothing new"));
    const uint32_t turns = plan.standing_ray_rate / 16;
    uint32_t rays = motion_rays_standing(&r, under_m, turns);
    print_message("standing: %.3f of the rays\n", (double)rays / (turns * BLOCKS));
    assert_in_range(rays, BLOCKS, turns * BLOCKS * 9 / 10);
    assert_in_range(motion_rays_standing(&r, under_m + 1.0, 1), BLOCKS, MOST);
    motion_stand(&r, under_m + 1.0, 140);
    assert_in_range(motion_rays_standing(&r, under_m + 1.0, turns), BLOCKS, turns * BLOCKS * 9 / 10);
    motion_draw(&r, under_m + 1.0, 0.5, motion_steady, 0);
    motion_draw(&r, under_m + 1.0, 0.5, motion_steady, 0);
    assert_int_equal(motion_rays(&r), BLOCKS);
    /* Each third frame shows what the one before it did, as where a display is faster than the simulation. */
    rays = 0;
    for (uint32_t i = 0; i < 120; i++) {
        i % 3 == 2 ? motion_draw(&r, under_m, 0.5, motion_steady, 0) : motion_stand(&r, under_m, 1);
        rays += i >= 120 - turns ? motion_rays(&r) : 0;
    }
    assert_in_range(rays, BLOCKS, turns * BLOCKS * 9 / 10);
    motion_stand(&r, 0.5 * (double)(cumulus.base_m + cumulus.top_m), 80);
    assert_in_range(motion_rays(&r), BLOCKS, MOST);
    /* Seconds a frame. */
    for (uint32_t i = 0; i < 60; i++) {
        r.time_s += 2.0;
        motion_draw(&r, under_m, 0.5, motion_steady, 0);
    }
    assert_in_range(motion_rays(&r), BLOCKS, MOST);
    plan.standing_ray_rate = 0;
    plan.finer_rays = 0;
    assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
    assert_int_equal(motion_rays_standing(&r, under_m, 80), 80 * BLOCKS);
    motion_rig_finish(&r);
}

/* Blocks and tiles that the picture's edges cut have their turns like others: what stands is what settles. */
static void views_of_any_size_stand(void **state) {
    (void)state;
    enum { WIDTH = 37, HEIGHT = 21, ALL = ((WIDTH + 3) / 4) * ((HEIGHT + 3) / 4), TURNS = 8 };
    static motion_rig r;
    static float stood[PIXELS * 3];
    /* Lumps: of so few pixels most of a cumulus is rim, which is never calm. */
    velum_layer lumps = fixture_cumulus();
    lumps.genus = VELUM_GENUS_SC;
    lumps.wind_east_m_s = 1.5f;
    motion_rig_init_sized(&r, &lumps, WIDTH, HEIGHT);
    const double under_m = (double)lumps.base_m - 700.0;
    motion_stand(&r, under_m, 16 * (3 + TURNS));
    assert_in_range(motion_rays_standing(&r, under_m, TURNS), ALL, TURNS * ALL * 9 / 10);
    memcpy(stood, r.through, sizeof stood);
    for (int i = 0; i < AT_REST; i++) {
        motion_draw(&r, under_m, 0.5, motion_steady, 0);
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
    motion_rig_finish(&r);
}

/* Under a slab nothing changes: each pixel has one ray in a round of all tiles. A board of the host's comes before it
 * and goes: there are rays in that frame wherever it stood, and nothing of either is left on the other. */
static void calm_tiles_have_rays_where_the_host_draws_anew(void **state) {
    (void)state;
    static float depth_m[PIXELS];
    static motion_rig r;
    const velum_layer cloud = fixture_slab(16.0f);
    motion_rig_init(&r, &cloud);
    r.depth_m = depth_m;
    const double height_m = (double)cloud.base_m - 100.0;
    velum_plan plan = {.struct_size = sizeof plan};
    motion_stand(&r, height_m, 200);
    assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
    const uint32_t turns = plan.standing_ray_rate / 16;
    assert_int_equal(motion_rays_standing(&r, height_m, turns * 16), 16 * BLOCKS);
    for (int turn = 0; turn < 4; turn++) {
        const bool board = turn % 2 == 0;
        for (int i = 0; i < PIXELS; i++) {
            depth_m[i] = board && i % W < W / 2 ? 20.0f : 0.0f;
        }
        assert_in_range(motion_rays_standing(&r, height_m, 1), BLOCKS / 2, BLOCKS * 3 / 4);
        for (int i = 0; i < PIXELS; i++) {
            const double through = (double)r.through[3 * i];
            assert_true(board && i % W < W / 2 ? through >= 0.999 : through <= 0.01);
        }
        motion_stand(&r, height_m, 60);
    }
    motion_rig_finish(&r);
}

/* Under drifting cloud light is handed on from frame to frame a hundred times; nothing may be lost on the way, by
 * numbers of 16 bits or by filters. */
static void handing_on_takes_no_light(void **state) {
    (void)state;
    static float moving[PIXELS * 3];
    static motion_rig r;
    velum_layer cumulus = fixture_cumulus();
    cumulus.wind_east_m_s = 5.0f;
    motion_rig_init(&r, &cumulus);
    const double under_m = (double)cumulus.base_m - 700.0;
    motion_stand(&r, under_m, 200);
    memcpy(moving, r.light, sizeof moving);
    motion_settle(&r, under_m, 0.5);
    const double handed_on = motion_light_of(moving, &r);
    print_message("handed on: %.4f of the light at rest\n", handed_on);
    assert_true(fabs(handed_on - 1.0) <= 0.01);
    motion_rig_finish(&r);
}

/* Of transmittance in a fine view: how far pixels lie from the mean of those beside them. */
static double roughness(const motion_rig *r) {
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
    static motion_rig r;
    for (int turn = 0; turn < 2; turn++) {
        velum_layer cumulus = fixture_cumulus();
        cumulus.wind_east_m_s = 5.0f;
        motion_rig_init_sized(&r, &cumulus, FINE_W, FINE_H);
        r.tan_x = 0.15f;
        r.depth_m = turn == 1 ? clear_depth_m : NULL;
        const double under_m = (double)cumulus.base_m - 700.0;
        motion_stand(&r, under_m, 300);
        const double drifting = roughness(&r);
        velum_plan plan = {.struct_size = sizeof plan};
        assert_int_equal(r.f.engine_api->get_plan(r.f.eye, &plan, NULL), VELUM_OK);
        plan.march_steps += 8;
        assert_int_equal(r.f.engine_api->set_plan(r.f.eye, &plan), VELUM_OK);
        motion_stand(&r, under_m, 1);
        const double planned = roughness(&r);
        motion_stand(&r, under_m, 100);
        double least = INFINITY, most = 0.0, leap = 0.0;
        for (uint32_t i = 0; i < AT_REST + 16; i++) {
            memcpy(stopped, r.through, sizeof stopped);
            motion_draw(&r, under_m, 0.5, motion_steady, 0);
            const double rough = roughness(&r);
            least = fmin(least, rough);
            most = fmax(most, rough);
            leap = fmax(leap, motion_apart(&r, stopped));
        }
        memcpy(stopped, r.through, sizeof stopped);
        motion_settle(&r, under_m, 0.5);
        const double resting = roughness(&r);
        memcpy(rested, r.through, sizeof rested);
        for (uint32_t i = 0; i < 4 * AT_REST; i++) {
            motion_draw(&r, under_m, 0.5, motion_steady, 0);
        }
        const double off = motion_apart(&r, stopped), rested_off = motion_apart(&r, rested);
        print_message("under drifting cloud: %.3f as rough as at rest, %.3f in a frame with another plan, %.3f to %.3f "
                      "once time stops, changed by no more than %.5f in a frame, then off by %.5f (%.5f from a cut)\n",
                      drifting / resting, planned / resting, least / resting, most / resting, leap, off, rested_off);
        assert_true(drifting > 0.7 * resting && drifting < resting);
        assert_true(planned > 0.95 * drifting && planned < 1.05 * drifting);
        assert_true(least > 0.95 * drifting && most < 1.05 * resting);
        assert_true(leap <= 0.0005);
        assert_true(off <= 0.0012 && off <= rested_off + 0.0003);
        motion_rig_finish(&r);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(views_that_stand_have_fewer_rays), cmocka_unit_test(views_of_any_size_stand),
        cmocka_unit_test(calm_tiles_have_rays_where_the_host_draws_anew), cmocka_unit_test(handing_on_takes_no_light),
        cmocka_unit_test(standing_under_drifting_cloud_is_sharp)};
    return cmocka_run_group_tests_name("standing", tests, NULL, fixture_shared_finish);
}
