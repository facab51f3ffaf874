/* Phase functions against closed forms, quadrature and the published fit's reference values. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shared/phase.h"
#include "tests/files.h"

#define PI 3.14159265358979323846

typedef double (*phase_fn)(double cosine, const void *context);

/* Integral over the sphere of phase times c^power, by the midpoint rule in ln(1 - c + 1e-9): the forward peak is as
 * finely divided as the rest. */
static double moment(phase_fn phase, const void *context, int power) {
    const int steps = 200000;
    const double low = log(1e-9);
    const double high = log(2.0 + 1e-9);
    double sum = 0.0;
    for (int i = 0; i < steps; i++) {
        double x = exp(low + (high - low) * (i + 0.5) / steps);
        double c = 1.0 + 1e-9 - x;
        sum += phase(c, context) * (power ? c : 1.0) * x;
    }
    return 2.0 * PI * sum * (high - low) / steps;
}

static double hg_at(double c, const void *context) {
    return (double)velum_phase_hg((float)c, *(const float *)context);
}
static double draine_at(double c, const void *context) {
    const float *p = context;
    return (double)velum_phase_draine((float)c, p[0], p[1]);
}
static double droplet_at(double c, const void *context) {
    return (double)velum_phase_droplet_at(*(const velum_phase_droplet *)context, (float)c);
}
static double ice_at(double c, const void *context) {
    (void)context;
    return (double)velum_phase_ice((float)c);
}

static void henyey_greenstein_is_normalised_with_mean_cosine_g(void **state) {
    (void)state;
    static const float gs[] = {-0.9f, -0.3f, 0.0f, 0.5f, 0.85f, 0.95f};
    for (int i = 0; i < 6; i++) {
        assert_true(fabs(moment(hg_at, &gs[i], 0) - 1.0) < 1e-3);
        assert_true(fabs(moment(hg_at, &gs[i], 1) - (double)gs[i]) < 1e-3);
    }
    /* Closed values: 1 / 4 pi at g = 0; forward (1 + g) / (1 - g)^2 / 4 pi. */
    assert_true(fabs((double)velum_phase_hg(0.3f, 0.0f) * 4.0 * PI - 1.0) < 1e-6);
    assert_true(fabs((double)velum_phase_hg(1.0f, 0.9f) * 4.0 * PI / (1.9 / 0.01) - 1.0) < 1e-4);
    assert_true(fabs((double)velum_phase_hg(-1.0f, 0.9f) * 4.0 * PI / (0.1 / (1.9 * 1.9)) - 1.0) < 1e-4);
}

static void draine_contains_the_special_cases(void **state) {
    (void)state;
    const float wide[2] = {0.59379058f, 27.1136937f};
    assert_true(fabs(moment(draine_at, wide, 0) - 1.0) < 1e-3);
    assert_true(fabs(moment(draine_at, wide, 1) - (double)velum_phase_draine_mean_cosine(wide[0], wide[1])) < 1e-3);
    for (int i = 0; i <= 20; i++) {
        float c = -1.0f + 0.1f * (float)i;
        /* alpha 0: Henyey-Greenstein; g 0, alpha 1: Rayleigh, 3 / 16 pi (1 + c^2). */
        assert_true(fabsf(velum_phase_draine(c, 0.7f, 0.0f) / velum_phase_hg(c, 0.7f) - 1.0f) < 1e-6f);
        double rayleigh = 3.0 / (16.0 * PI) * (1.0 + (double)(c * c));
        assert_true(fabs((double)velum_phase_draine(c, 0.0f, 1.0f) / rayleigh - 1.0) < 1e-6);
    }
}

static void droplets_match_the_reference(void **state) {
    (void)state;
    static const double angles_deg[] = {0, 1, 5, 10, 22, 45, 90, 120, 138, 150, 180};
    char path[1024];
    FILE *file = fopen(source_path(path, "tests/data/hg_draine_reference.csv"), "r");
    assert_non_null(file);
    char line[1024];
    int rows = 0;
    while (fgets(line, sizeof line, file)) {
        if (line[0] < '0' || line[0] > '9') {
            continue;
        }
        double value[19];
        int count = 0;
        for (char *field = strtok(line, ","); field && count < 19; field = strtok(NULL, ",")) {
            value[count++] = strtod(field, NULL);
        }
        assert_int_equal(count, 19);
        velum_phase_droplet p = velum_phase_droplet_of((float)value[0]);
        assert_true(fabs((double)p.g_hg - value[1]) < 2e-7 + 1e-6);
        assert_true(fabs((double)p.g_draine - value[2]) < 1e-6);
        assert_true(fabs((double)p.alpha / value[3] - 1.0) < 1e-5);
        assert_true(fabs((double)p.weight_draine - value[4]) < 1e-6);
        assert_true(fabs(moment(droplet_at, &p, 0) - 1.0) < 2e-3);
        assert_true(fabs(moment(droplet_at, &p, 1) - value[6]) < 2e-3);
        double mean = (1.0 - (double)p.weight_draine) * (double)p.g_hg +
                      (double)(p.weight_draine * velum_phase_draine_mean_cosine(p.g_draine, p.alpha));
        assert_true(fabs(mean - value[7]) < 2e-6);
        for (int i = 0; i < 11; i++) {
            double found = (double)velum_phase_droplet_at(p, (float)cos(angles_deg[i] * PI / 180.0));
            /* 1 - g has 1e-5 of relative rounding in a float, its square stands in the peak. */
            assert_true(fabs(found / value[8 + i] - 1.0) < (i < 2 ? 4e-3 : 2e-4));
        }
        rows++;
    }
    fclose(file);
    assert_int_equal(rows, 8);
}

static void clouds_take_the_fit_at_20_um_and_ice(void **state) {
    (void)state;
    velum_phase_droplet p = velum_phase_droplet_of(20.0f);
    for (int i = 0; i <= 200; i++) {
        float c = -1.0f + 0.01f * (float)i;
        assert_true(fabsf(velum_phase_cloud(c, false) / velum_phase_droplet_at(p, c) - 1.0f) < 1e-3f);
        assert_true(velum_phase_cloud(c, true) == velum_phase_ice(c));
        assert_true(velum_phase_ice(c) > 0.0f);
    }
    assert_true(fabs(moment(ice_at, NULL, 0) - 1.0) < 1e-3);
    assert_true(fabs(moment(ice_at, NULL, 1) - 0.75) < 1e-3);
}

static void diameters_outside_the_fit_take_its_ends(void **state) {
    (void)state;
    velum_phase_droplet small = velum_phase_droplet_of(0.0f);
    velum_phase_droplet large = velum_phase_droplet_of(1e9f);
    assert_true(small.g_hg == velum_phase_droplet_of(5.0f).g_hg && small.g_hg < 1.0f);
    assert_true(large.g_hg == velum_phase_droplet_of(50.0f).g_hg && large.g_hg < 1.0f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(henyey_greenstein_is_normalised_with_mean_cosine_g),
        cmocka_unit_test(draine_contains_the_special_cases),
        cmocka_unit_test(droplets_match_the_reference),
        cmocka_unit_test(clouds_take_the_fit_at_20_um_and_ice),
        cmocka_unit_test(diameters_outside_the_fit_take_its_ends),
    };
    return cmocka_run_group_tests_name("phase", tests, NULL, NULL);
}
