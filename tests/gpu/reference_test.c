/* The reference against the radiative-transfer tables, and what must hold of any unbiased picture. The long proof is
 * tests/accuracy/reference_proof.c. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "reference_slab.h"

#define PI 3.14159265358979

static void meets_the_tables(void **state) {
    (void)state;
    static slab_rig rig;
    char line[256];
    FILE *file = slab_table("slab_rows.csv");
    slab_rig_init(&rig);
    double chi2 = 0.0;
    int rows = 0;
    while (fgets(line, sizeof line, file)) {
        slab_case c;
        if (!slab_case_parse(line, &c)) {
            continue;
        }
        double error, through;
        slab_rig_layer(&rig, &c, 240.0);
        double found = slab_rig_measure(&rig, &c, 240.0, 128, &error, &through);
        double sigmas = (found - c.expected) / error;
        if (fabs(sigmas) > 4.0) {
            print_message("%s found %.5f +- %.5f: %.1f sigma\n", line, found, error, sigmas);
        }
        assert_true(error > 0.0 && error < 0.15 * c.expected);
        assert_true(fabs(sigmas) <= 4.0);
        assert_float_equal(through, exp(-c.tau / c.mu), 4.0 * sqrt(0.25 / (128.0 * SLAB_PIXELS)));
        chi2 += sigmas * sigmas;
        rows++;
    }
    fclose(file);
    assert_int_equal(rows, 8);
    assert_true(chi2 < 26.1); /* 0.1 % of chances with 8 */
    slab_rig_finish(&rig);
}

/* First order has a closed form. */
static void first_order_is_exact(void **state) {
    (void)state;
    static slab_rig rig;
    slab_rig_init(&rig);
    slab_rig_order(&rig, 1);
    for (int side = 0; side < 2; side++) {
        const slab_case c = {.albedo = 0.7, .g = 0.6, .tau = 1.5, .mu0 = 0.8, .up = side == 0, .mu = 0.6};
        double turn = (c.up ? -1.0 : 1.0) * c.mu * c.mu0 + sqrt((1.0 - c.mu * c.mu) * (1.0 - c.mu0 * c.mu0));
        double phase = (1.0 - c.g * c.g) / (4.0 * PI * pow(1.0 + c.g * c.g - 2.0 * c.g * turn, 1.5));
        double factor = c.up ? (1.0 - exp(-c.tau * (1.0 / c.mu + 1.0 / c.mu0))) / (c.mu0 + c.mu)
                             : (exp(-c.tau / c.mu0) - exp(-c.tau / c.mu)) / (c.mu0 - c.mu);
        double error, through;
        slab_rig_layer(&rig, &c, 240.0);
        double found = slab_rig_measure(&rig, &c, 240.0, 128, &error, &through);
        assert_true(error < 0.01 * found);
        assert_float_equal(found, PI * c.albedo * phase * factor, 4.0 * error);
    }
    slab_rig_finish(&rig);
}

static void nothing_and_everything(void **state) {
    (void)state;
    static slab_rig rig;
    double error, through;
    slab_rig_init(&rig);
    slab_case c = {.albedo = 1.0, .g = 0.0, .tau = 1e-2, .mu0 = 0.5, .up = true, .mu = 1.0};
    slab_rig_layer(&rig, &c, 240.0);
    double found = slab_rig_measure(&rig, &c, 240.0, 16, &error, &through);
    assert_float_equal(through, exp(-c.tau), 0.01);
    /* First order, and some more. */
    assert_float_equal(found, 0.5 / 3.0 * (1.0 - exp(-3.0 * c.tau)), 4.0 * error + 3e-4);
    c.tau = 1e-6;
    slab_rig_layer(&rig, &c, 240.0);
    found = slab_rig_measure(&rig, &c, 240.0, 16, &error, &through);
    assert_true(found < 1e-3 && through > 0.999);
    /* A wall: half of 1 is far from what a half-space of isotropic scatterers gives back (Chandrasekhar 1950: H(1)
     * H(0.5) / (4 (1 + 0.5)) = 2.9078 * 2.0128 / 6 = 0.9755). */
    c.tau = 400.0;
    slab_rig_layer(&rig, &c, 240.0);
    found = slab_rig_measure(&rig, &c, 240.0, 8, &error, &through);
    assert_true(through < 1e-3);
    assert_true(error < 0.03);
    assert_float_equal(found, 0.9755, 4.0 * error + 0.01);
    slab_rig_finish(&rig);
}

/* Light from all of the sky, a white cloud over white ground: everything is as bright as the sky. The sky is many suns.
 */
static void furnace(slab_rig *rig, int suns, uint32_t paths, double bound) {
    double east[3], north[3], up[3], position[3], down[3];
    fixture_axes(50.0, 8.5, east, north, up);
    fixture_position(50.0, 8.5, 2600.0, position);
    for (int i = 0; i < 3; i++) {
        down[i] = -up[i];
    }
    velum_view_frame camera = fixture_camera(position, down, north, 0.3f, 0.3f);
    camera.flags = VELUM_VIEW_GROUND;
    double sum = 0.0;
    double squares = 0.0;
    for (int k = 0; k < suns; k++) {
        double mu = (k + 0.5) / suns;
        double angle = 2.0 * PI * fmod(k * 0.6180339887498949, 1.0);
        double sun[3];
        for (int i = 0; i < 3; i++) {
            sun[i] = mu * up[i] + sqrt(1.0 - mu * mu) * (cos(angle) * east[i] + sin(angle) * north[i]);
        }
        velum_frame_info frame = fixture_frame(sun, (double)k * 1e-3, VELUM_ATMOSPHERE_NONE);
        for (int i = 0; i < 3; i++) {
            frame.ground_albedo[i] = 1.0f;
        }
        slab_rig_render(rig, &frame, position, &camera, true, paths);
        double mean = 0.0;
        for (int i = 0; i < SLAB_PIXELS; i++) {
            mean += (double)rig->light[3 * i + 1] / SLAB_PIXELS;
            squares += (double)rig->variance[i] / SLAB_PIXELS / SLAB_PIXELS;
        }
        sum += mean;
    }
    double found = 2.0 * PI * sum / suns;
    double error = 2.0 * PI * sqrt(squares) / suns;
    print_message("furnace: %.5f +- %.5f\n", found, error);
    assert_true(error < bound);
    assert_float_equal(found, 1.0, 4.0 * error + 0.003);
}

static void white_furnace(void **state) {
    (void)state;
    static slab_rig rig;
    slab_rig_init(&rig);
    const slab_case c = {.albedo = 1.0, .g = 0.85, .tau = 2.0};
    slab_rig_layer(&rig, &c, 240.0);
    furnace(&rig, 96, 4, 0.02);
    slab_rig_finish(&rig);
}

static void render_until(slab_rig *rig, const velum_view_frame *camera, const double position[3], bool reset,
                         uint32_t paths, float *copy) {
    double east[3], north[3], up[3];
    fixture_axes(50.0, 8.5, east, north, up);
    velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_EARTH);
    slab_rig_render(rig, &frame, position, camera, reset, paths);
    memcpy(copy, rig->light, sizeof rig->light);
}

/* Cumulus, and ahead a region of denser ones with scud and rain: tiles have bounds of their own. Of little water:
 * paths need be no longer than what interrupts them. */
static void commit_showers(fixture *f) {
    velum_layer fair = fixture_cumulus();
    fair.water_g_m3 = 0.1f;
    velum_layer wet = fair;
    wet.water_g_m3 = 2.0f * fair.water_g_m3;
    wet.scud = 0.8f;
    wet.precipitation_mm_h = 20.0f;
    wet.precipitation = VELUM_PRECIPITATION_RAIN;
    velum_cell cells[2] = {fixture_cell(&fair, 1), fixture_cell(&wet, 1)};
    cells[1].id = 2;
    cells[1].kind = VELUM_CELL_RECTANGLE;
    cells[1].lat_deg = 50.0;
    cells[1].lon_deg = 8.6;
    cells[1].half_east_m = cells[1].half_north_m = 4000.0;
    const velum_state_desc state = {.struct_size = sizeof state, .cells = cells, .cell_count = 2};
    assert_int_equal(f->world_api->commit(f->world, &state, &f->state), VELUM_OK);
}

enum { PATHS = 2 };

/* Cloud of noise, rain, air and ground; again, in two stages, and beside another view: the same bits. */
static void pictures_repeat(void **state) {
    (void)state;
    static slab_rig rig;
    static float first[SLAB_PIXELS * 3], again[SLAB_PIXELS * 3], staged[SLAB_PIXELS * 3], beside[SLAB_PIXELS * 3];
    double east[3], north[3], up[3], position[3];
    slab_rig_init(&rig);
    commit_showers(&rig.f);
    fixture_axes(50.0, 8.5, east, north, up);
    fixture_position(50.0, 8.5, 3000.0, position);
    double ahead[3];
    for (int i = 0; i < 3; i++) {
        ahead[i] = 0.8 * east[i] - 0.6 * up[i];
    }
    velum_view_frame camera = fixture_camera(position, ahead, north, 0.3f, 0.3f);
    camera.flags = VELUM_VIEW_GROUND;
    render_until(&rig, &camera, position, true, PATHS, first);
    render_until(&rig, &camera, position, true, PATHS, again);
    assert_memory_equal(first, again, sizeof first);
    render_until(&rig, &camera, position, true, 1, staged);
    assert_memory_not_equal(first, staged, sizeof first);
    render_until(&rig, &camera, position, false, PATHS, staged);
    assert_memory_equal(first, staged, sizeof first);

    velum_view *other = fixture_view(&rig.f, rig.eye, SLAB_SIDE, SLAB_SIDE);
    velum_view_frame both[2] = {camera, camera};
    both[0].tan_left = 0.1f;
    both[0].path_limit = both[1].path_limit = PATHS;
    velum_frame_info frame = fixture_frame(up, 0.0, VELUM_ATMOSPHERE_EARTH);
    velum_eye_frame eye = {.struct_size = sizeof eye, .eye = rig.eye, .flags = VELUM_EYE_RESET};
    memcpy(eye.position_ecef_m, position, sizeof position);
    velum_pixels pixels[2];
    for (int i = 0; i < 2; i++) {
        pixels[i] = (velum_pixels){.struct_size = sizeof pixels[i],
                                   .view = i == 0 ? other : rig.view,
                                   .frame = &both[i],
                                   .luminance_rgb = i == 0 ? again : beside,
                                   .width = SLAB_SIDE,
                                   .height = SLAB_SIDE};
    }
    velum_view_stats stats = {.struct_size = sizeof stats};
    for (int i = 0; i < 100000 && (i == 0 || stats.paths_per_pixel < PATHS); i++) {
        assert_int_equal(rig.f.standalone_api->render(rig.f.engine, &frame, &eye, 1, 0, pixels, 2, 0), VELUM_OK);
        assert_int_equal(rig.f.engine_api->get_stats(rig.view, &stats), VELUM_OK);
        eye.flags = 0;
    }
    assert_memory_equal(first, beside, sizeof first);
    assert_int_equal(rig.f.engine_api->destroy_view(other), VELUM_OK);
    slab_rig_finish(&rig);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(meets_the_tables), cmocka_unit_test(first_order_is_exact),
                                       cmocka_unit_test(nothing_and_everything), cmocka_unit_test(white_furnace),
                                       cmocka_unit_test(pictures_repeat)};
    return cmocka_run_group_tests(tests, NULL, fixture_shared_finish);
}
