/* The long proof of the reference: every row of the slab tables, reciprocity, what curvature costs, the white furnace.
 *     velum-reference-proof [--shared DIR] [--paths N] [--furnace SUNS]
 * DIR holds accuracy/slab_radiance.csv. Exit status 0 only if all of it holds. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/gpu/reference_slab.h"

#define PI 3.14159265358979

static const char *shared = NULL;
static uint32_t path_count = 256;
static int suns = 2000;
static slab_rig rig;

static void meets_all_rows(void **state) {
    (void)state;
    char path[1024], line[256];
    snprintf(path, sizeof path, "%s/accuracy/slab_radiance.csv", shared ? shared : "");
    FILE *file = shared ? fopen(path, "r") : NULL;
    if (!file) {
        print_message("skipped: no %s; --shared DIR names the folder that has it\n", shared ? path : "tables");
        skip();
    }
    slab_rig_init(&rig);
    double chi2 = 0.0;
    double worst = 0.0;
    double worst_fine = 0.0;
    double weights = 0.0;
    double bias = 0.0;
    int rows = 0;
    int fine = 0;
    printf("albedo     g    tau  mu0 side  mu  phi      table      found  sigma(%%)  off(%%)  off/sigma\n");
    while (fgets(line, sizeof line, file)) {
        slab_case c;
        /* Straight up and straight down have no azimuth: one row is enough. */
        if (!slab_case_parse(line, &c) || ((c.mu > 0.999 || c.mu0 > 0.999) && c.phi_deg > 0.0)) {
            continue;
        }
        double error, through;
        slab_rig_layer(&rig, &c, 240.0);
        double found = slab_rig_measure(&rig, &c, 240.0, path_count, &error, &through);
        double off = found - c.expected;
        double relative = error / c.expected;
        printf("%6.3f %5.2f %6.1f %4.1f %4s %3.1f %4.0f %10.6f %10.6f %9.3f %7.3f %10.2f\n", c.albedo, c.g, c.tau,
               c.mu0, c.up ? "up" : "down", c.mu, c.phi_deg, c.expected, found, 100.0 * relative,
               100.0 * off / c.expected, off / error);
        fflush(stdout);
        rows++;
        chi2 += off * off / error / error;
        worst = fmax(worst, fabs(off / error));
        weights += 1.0 / relative / relative;
        bias += off / c.expected / relative / relative;
        if (relative <= 0.0015) {
            fine++;
            worst_fine = fmax(worst_fine, fabs(off) / c.expected);
        }
    }
    fclose(file);
    slab_rig_finish(&rig);
    /* Chi-squared of many degrees of freedom is nearly normal in its square root (Fisher 1922). */
    double normal = sqrt(2.0 * chi2) - sqrt(2.0 * rows - 1.0);
    printf("%d rows: chi-squared %.1f (%.2f sigma), largest deviation %.2f sigma; mean deviation %.4f %% +- %.4f %%\n",
           rows, chi2, normal, worst, 100.0 * bias / weights, 100.0 / sqrt(weights));
    printf("%d rows with noise of 0.15 %% or less: largest deviation %.3f %%\n", fine, 100.0 * worst_fine);
    assert_true(rows > 0);
    assert_true(worst <= 4.0);
    assert_true(normal <= 3.0);
    assert_true(worst_fine <= 0.005);
}

/* What one radiance is when view and sun change places. */
static void is_reciprocal(void **state) {
    (void)state;
    slab_rig_init(&rig);
    for (int k = 0; k < 3; k++) {
        slab_case c = {
            .albedo = k == 2 ? 0.9 : 1.0, .g = k == 0 ? 0.0 : 0.85, .tau = 4.0, .mu0 = 0.4, .up = true, .mu = 0.9};
        double error[2], through;
        double found[2];
        slab_rig_layer(&rig, &c, 240.0);
        for (int swap = 0; swap < 2; swap++) {
            found[swap] = slab_rig_measure(&rig, &c, 240.0, path_count, &error[swap], &through);
            c.mu0 = 0.9;
            c.mu = 0.4;
        }
        double sigma = sqrt(error[0] * error[0] + error[1] * error[1]);
        printf("reciprocity, g %.2f: %.5f and %.5f, %.2f sigma\n", c.g, found[0], found[1],
               (found[0] - found[1]) / sigma);
        assert_true(fabs(found[0] - found[1]) <= 4.0 * sigma);
    }
    slab_rig_finish(&rig);
}

/* The same slab, ever thicker over the same planet. */
static void curvature(void **state) {
    (void)state;
    slab_rig_init(&rig);
    const slab_case c = {
        .albedo = 1.0, .g = 0.0, .tau = 4.0, .mu0 = 0.5, .up = true, .mu = 1.0, .expected = 7.059764e-01};
    const double thickness_m[] = {60.0, 240.0, 1000.0, 8000.0};
    for (int k = 0; k < 4; k++) {
        double error, through;
        slab_rig_layer(&rig, &c, thickness_m[k]);
        double found = slab_rig_measure(&rig, &c, thickness_m[k], path_count, &error, &through);
        printf("slab of %5.0f m: %.5f +- %.5f, plane-parallel %.5f: %+.2f %%\n", thickness_m[k], found, error,
               c.expected, 100.0 * (found / c.expected - 1.0));
    }
    slab_rig_finish(&rig);
}

/* Light from all of the sky, a white cloud over white ground: everything is as bright as the sky. */
static void furnace(const char *name, uint32_t paths) {
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
        slab_rig_render(&rig, &frame, position, &camera, true, paths);
        for (int i = 0; i < SLAB_PIXELS; i++) {
            sum += (double)rig.light[3 * i + 1] / SLAB_PIXELS;
            squares += (double)rig.variance[i] / SLAB_PIXELS / SLAB_PIXELS;
        }
    }
    double found = 2.0 * PI * sum / suns;
    double error = 2.0 * PI * sqrt(squares) / suns;
    printf("white furnace, %s: %.5f +- %.5f\n", name, found, error);
    assert_true(fabs(found - 1.0) <= fmax(4.0 * error, 0.001));
}

static void furnaces(void **state) {
    (void)state;
    slab_rig_init(&rig);
    const slab_case c = {.albedo = 1.0, .g = 0.85, .tau = 2.0};
    slab_rig_layer(&rig, &c, 240.0);
    furnace("slab", 8);
    const velum_layer cloud = fixture_cumulus();
    fixture_commit(&rig.f, &cloud, 1);
    suns = suns / 8 + 1;
    furnace("cumulus", 2);
    slab_rig_finish(&rig);
}

int main(int argc, char **argv) {
    for (int i = 1; i + 1 < argc; i += 2) {
        if (strcmp(argv[i], "--shared") == 0) {
            shared = argv[i + 1];
        } else if (strcmp(argv[i], "--paths") == 0) {
            path_count = (uint32_t)strtoul(argv[i + 1], NULL, 10);
        } else if (strcmp(argv[i], "--furnace") == 0) {
            suns = atoi(argv[i + 1]);
        } else {
            fprintf(stderr, "%s: unknown option\n", argv[i]);
            return 2;
        }
    }
    if (path_count < 2 || suns < 1) {
        fprintf(stderr, "--paths: 2 at least; --furnace: 1 at least\n");
        return 2;
    }
    const struct CMUnitTest tests[] = {cmocka_unit_test(meets_all_rows), cmocka_unit_test(is_reciprocal),
                                       cmocka_unit_test(curvature), cmocka_unit_test(furnaces)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
