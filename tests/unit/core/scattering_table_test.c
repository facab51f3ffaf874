/* The table of multiple scattering: what a layer radiates by it, against discrete ordinates; conservation; limits. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "core/scattering_table.h"

#define PI 3.14159265358979323846

static float texels[CORE_SCATTERING_TEXELS][4];

/* Of what the table is for. */
static float rest_g, scale;

static void fill(velum_phase_lobes phase, float albedo) {
    const float peak = velum_scattering_peak(phase);
    rest_g = velum_scattering_rest(velum_phase_lobes_moment(phase, 1), peak);
    scale = 1.0f - albedo * peak;
    assert_true(core_scattering_table(phase, albedo, texels));
}

/* As a device filters: linear between the nodes. z: slice, within a block. */
static void fetch(float above, float below, float z, float out[4]) {
    const float place[3] = {velum_scattering_depth_node(above), velum_scattering_depth_node(below), z};
    for (int c = 0; c < 4; c++) {
        out[c] = 0.0f;
    }
    for (int corner = 0; corner < 8; corner++) {
        int at[3];
        float weight = 1.0f;
        for (int k = 0; k < 3; k++) {
            const int last = k < 2 ? VELUM_SCATTERING_DEPTHS - 1 : VELUM_SCATTERING_SLICES - 1;
            const int low = (int)place[k];
            const float share = place[k] - (float)low;
            const bool far = (corner >> k & 1) != 0;
            at[k] = far && low < last ? low + 1 : low;
            weight *= far ? share : 1.0f - share;
        }
        const float *texel = texels[(at[2] * VELUM_SCATTERING_DEPTHS + at[1]) * VELUM_SCATTERING_DEPTHS + at[0]];
        for (int c = 0; c < 4; c++) {
            out[c] += weight * texel[c];
        }
    }
}

static double sun_source(double above, double below, double mu_sun, double mu, double cos_azimuth) {
    const float sun = velum_scattering_sun_node((float)mu_sun);
    const float low = fminf(floorf(sun), VELUM_SCATTERING_SUNS - 2);
    float c[2][4];
    for (int i = 0; i < 2; i++) {
        const float block = (low + (float)i) * VELUM_SCATTERING_MUS;
        fetch((float)above, (float)below, block + velum_scattering_mu_node((float)mu), c[i]);
    }
    for (int i = 0; i < 4; i++) {
        c[0][i] += (sun - low) * (c[1][i] - c[0][i]);
    }
    const double cos_sun = sqrt(fmax((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun), 0.0)) * cos_azimuth - mu * mu_sun;
    const float turning = velum_scattering_turning((float)above, (float)mu_sun, scale);
    return (double)(velum_scattering_value(c[0][0], c[0][1], c[0][2], c[0][3], (float)cos_azimuth) *
                    velum_scattering_shape((float)cos_sun, rest_g, turning) *
                    velum_scattering_thin((float)(above + below)));
}

/* From beyond the lit face, and from beyond the other. */
static void sky_sources(double above, double below, double mu, double out[2]) {
    float c[4];
    fetch((float)above, (float)below,
          VELUM_SCATTERING_MUS * VELUM_SCATTERING_SUNS + velum_scattering_mu_node((float)mu), c);
    out[0] = exp2((double)c[0]);
    out[1] = exp2((double)c[1]);
}

/* pi I / (mu_sun F0) of what leaves a layer: quadrature along the line of sight. */
static double radiance(velum_phase_lobes phase, double albedo, double depth, double mu_sun, double mu,
                       double cos_azimuth) {
    enum { STEPS = 1000 };
    const double cos_sun = -mu * mu_sun + sqrt((1.0 - mu * mu) * (1.0 - mu_sun * mu_sun)) * cos_azimuth;
    const double first = albedo * (double)velum_phase_lobes_at(phase, (float)cos_sun);
    const double opacity = 1.0 - exp(-depth / fabs(mu));
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double t = -log(1.0 - (i + 0.5) / STEPS * opacity) * fabs(mu);
        const double above = mu > 0.0 ? t : depth - t;
        sum += first * exp(-(double)scale * above / mu_sun) + sun_source(above, depth - above, mu_sun, mu, cos_azimuth);
    }
    return PI / mu_sun * sum * opacity / STEPS;
}

static int compare(const void *a, const void *b) {
    const double x = *(const double *)a, y = *(const double *)b;
    return x < y ? -1 : x > y;
}

/* tests/data/slab_radiance.csv: discrete ordinates, 128 streams. */
static void layers_radiate_as_discrete_ordinates_say(void **state) {
    (void)state;
    enum { ROWS_MAX = 256 };
    const char *root = getenv("VELUM_SOURCE");
    char path[1024], line[256];
    assert_non_null(root);
    snprintf(path, sizeof path, "%s/tests/data/slab_radiance.csv", root);
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    double errors[ROWS_MAX], g_before = -9.0;
    int count = 0;
    while (fgets(line, sizeof line, file)) {
        double albedo, g, depth, mu_sun, mu, phi_deg, expected;
        char side[8];
        if (sscanf(line, "%lf,%lf,%lf,%lf,%7[^,],%lf,%lf,%lf", &albedo, &g, &depth, &mu_sun, side, &mu, &phi_deg,
                   &expected) != 8) {
            continue;
        }
        const velum_phase_lobes phase = velum_phase_lobes_make((float)g, 0.0f, 0.0f, 0.0f);
        if (g != g_before) {
            fill(phase, (float)albedo);
            g_before = g;
        }
        assert_true(count < ROWS_MAX);
        const double found = radiance(phase, albedo, depth, mu_sun, side[0] == 'u' ? mu : -mu, cos(phi_deg * PI / 180));
        errors[count] = fabs(found / expected - 1.0);
        /* Toward the sun most light is of few orders. */
        assert_true(errors[count] < 0.06);
        count++;
    }
    fclose(file);
    assert_int_equal(count, 192);
    qsort(errors, (size_t)count, sizeof errors[0], compare);
    print_message("slab radiances by the table: median error %.2f %%, 90th percentile %.2f %%, largest %.2f %%\n",
                  100.0 * errors[count / 2], 100.0 * errors[count * 9 / 10], 100.0 * errors[count - 1]);
    assert_true(errors[count / 2] < 0.005);
    assert_true(errors[count * 9 / 10] < 0.02);
}

static const double depths[] = {0.03125, 0.25, 1.0, 8.0, 64.0, 256.0};
enum { DEPTHS = 6 };

/* Cloud that takes nothing, in a light that is the same from everywhere, cannot be told from nothing. */
static void white_cloud_vanishes_in_even_light(void **state) {
    (void)state;
    const velum_phase_lobes phases[] = {velum_phase_lobes_cloud(false), velum_phase_lobes_cloud(true),
                                        velum_phase_lobes_make(0.0f, 0.0f, 0.0f, 0.0f)};
    for (int p = 0; p < 3; p++) {
        fill(phases[p], 1.0f);
        for (int i = 0; i < DEPTHS; i++) {
            for (int k = 0; k < DEPTHS; k++) {
                for (int m = -15; m <= 15; m += 2) {
                    double sky[2];
                    sky_sources(depths[i], depths[k], m / 15.0, sky);
                    assert_float_equal(sky[0] + sky[1], 1.0, 2e-3);
                    assert_true(sky[0] >= 0.0 && sky[1] >= 0.0);
                    /* Upside down the two change places. */
                    double turned[2];
                    sky_sources(depths[k], depths[i], -m / 15.0, turned);
                    assert_float_equal(sky[0], turned[1], 1e-5);
                }
            }
        }
    }
}

/* Flux of what leaves a layer by either face over what the sun sends in, by all orders. */
static double flux_out(velum_phase_lobes phase, double depth, double mu_sun) {
    enum { MUS = 16, AZIMUTHS = 12 };
    double sum = exp(-depth / mu_sun);
    for (int i = 0; i < 2 * MUS; i++) {
        const double mu = (i % MUS + 0.5) / MUS * (i < MUS ? 1.0 : -1.0);
        for (int a = 0; a < AZIMUTHS; a++) {
            sum += 2.0 * fabs(mu) / MUS / AZIMUTHS *
                   radiance(phase, 1.0, depth, mu_sun, mu, cos(PI * (a + 0.5) / AZIMUTHS));
        }
    }
    return sum;
}

static void white_layers_keep_no_light(void **state) {
    (void)state;
    const velum_phase_lobes phase = velum_phase_lobes_make(0.6f, 0.0f, 0.0f, 0.0f);
    const double mu_suns[] = {0.2, 0.5, 1.0};
    fill(phase, 1.0f);
    for (int s = 0; s < 3; s++) {
        for (int k = 1; k < DEPTHS; k++) {
            double out = flux_out(phase, depths[k], mu_suns[s]);
            if (fabs(out - 1.0) > 0.03) {
                print_message("depth %g, mu_sun %g: %.4f\n", depths[k], mu_suns[s], out);
            }
            assert_float_equal(out, 1.0, 0.03);
        }
    }
}

static void thin_layers_scatter_once(void **state) {
    (void)state;
    const velum_phase_lobes phase = velum_phase_lobes_make(0.85f, 0.0f, 0.0f, 0.0f);
    fill(phase, 1.0f);
    /* What comes twice goes with the depth. */
    double before = sun_source(1e-3, 1e-3, 0.5, 0.5, 0.0);
    assert_true(before > 0.0 && before < 0.02 * (double)VELUM_INV_4PI);
    assert_float_equal(sun_source(1e-5, 1e-5, 0.5, 0.5, 0.0) / before, 0.01, 1e-4);
    assert_float_equal(sun_source(0.0, 0.0, 0.5, 0.5, 0.0), 0.0, 1e-30);
}

/* Light that has scattered twice, at `above` below the top of a conservative layer: Henyey and Greenstein's function
 * over the first order's radiance, which has a closed form (Chandrasekhar 1960, section 10), by the midpoint rule. */
static double second_order(double g, double above, double below, double mu_sun, double mu, double azimuth) {
    enum { RINGS = 1500, TURNS = 600 };
    const double toward[3] = {sqrt(1.0 - mu * mu) * cos(azimuth), sqrt(1.0 - mu * mu) * sin(azimuth), mu};
    double sum = 0.0;
    for (int i = 0; i < RINGS; i++) {
        const double m = 2.0 * (i + 0.5) / RINGS - 1.0, side = sqrt(1.0 - m * m);
        const double length =
            m < 0.0 ? mu_sun / (mu_sun + m) * (exp(-above / mu_sun) - exp(above / m))
                    : mu_sun / (mu_sun + m) * (exp(-above / mu_sun) - exp(-(above + below) / mu_sun - below / m));
        for (int k = 0; k < TURNS; k++) {
            const double a = 2.0 * PI * (k + 0.5) / TURNS;
            const double in = side * cos(a) * sqrt(1.0 - mu_sun * mu_sun) - m * mu_sun;
            const double out = side * cos(a) * toward[0] + side * sin(a) * toward[1] + m * toward[2];
            sum += (double)(velum_phase_hg((float)in, (float)g) * velum_phase_hg((float)out, (float)g)) * length;
        }
    }
    return sum * 4.0 * PI / RINGS / TURNS;
}

/* As near the sun as elsewhere: the forward peak of the second order, in layers so thin that there is hardly a third.
 */
static void the_second_order_has_its_peak(void **state) {
    (void)state;
    const double mu_sun = 0.64, depth = 1.0 / 32.0;
    fill(velum_phase_lobes_make(0.85f, 0.0f, 0.0f, 0.0f), 1.0f);
    for (int i = 0; i < 9; i++) {
        const double angle = asin(mu_sun) + (i / 3 - 1) * 5.0 * PI / 180.0, azimuth = (i % 3) * 8.0 * PI / 180.0;
        const double expected = second_order(0.85, depth, depth, mu_sun, -sin(angle), azimuth);
        const double found = sun_source(depth, depth, mu_sun, -sin(angle), cos(azimuth));
        assert_true(fabs(found / expected - 1.0) < 0.03);
    }
}

static void every_input_gives_a_number(void **state) {
    (void)state;
    const velum_phase_lobes phases[] = {
        velum_phase_lobes_make(0.999f, 0.0f, 0.0f, 0.0f), velum_phase_lobes_make(-0.999f, 0.0f, 0.0f, 0.0f),
        velum_phase_lobes_cloud(false), velum_phase_lobes_droplet(velum_phase_droplet_of(50.0f))};
    const float albedos[] = {0.0f, 0.5f, 1.0f};
    for (int p = 0; p < 4; p++) {
        for (int a = 0; a < 3; a++) {
            fill(phases[p], albedos[a]);
            for (int i = 0; i < CORE_SCATTERING_TEXELS; i++) {
                for (int c = 0; c < 4; c++) {
                    assert_true(fabsf(texels[i][c]) < 100.0f);
                }
            }
            assert_true(sun_source(1e9, 1e9, -1.0, 2.0, 3.0) >= 0.0);
        }
    }
    assert_true(velum_scattering_azimuth(1.0f, 1.0f, -1.0f) >= -1.0f);
}

/* A phase function's moments: 1, its mean cosine (Draine 2003, equation 4), and by quadrature. */
static void moments_are_means_of_legendre_polynomials(void **state) {
    (void)state;
    const velum_phase_lobes phases[] = {velum_phase_lobes_make(0.0f, 0.0f, 1.0f, 1.0f),
                                        velum_phase_lobes_make(-0.5f, 0.6f, 20.0f, 0.5f), velum_phase_lobes_cloud(true),
                                        velum_phase_lobes_make(0.3f, -0.6f, 5.0f, 0.7f)};
    for (int p = 0; p < 4; p++) {
        for (int l = 0; l <= VELUM_SCATTERING_MOMENTS; l++) {
            enum { STEPS = 40000 };
            double sum = 0.0;
            for (int i = 0; i < STEPS; i++) {
                double angle = PI * (i + 0.5) / STEPS, c = cos(angle), value = 1.0, before = 0.0;
                for (int n = 0; n < l; n++) {
                    double next = ((2 * n + 1) * c * value - n * before) / (n + 1);
                    before = value;
                    value = next;
                }
                sum += 2.0 * PI * sin(angle) * (double)velum_phase_lobes_at(phases[p], (float)c) * value * PI / STEPS;
            }
            assert_float_equal((double)velum_phase_lobes_moment(phases[p], l), sum, 2e-5);
        }
    }
}

static void cloud_has_the_peaks_that_are_written_down(void **state) {
    (void)state;
    static const float peaks[] = {VELUM_SCATTERING_WATER_PEAK, VELUM_SCATTERING_ICE_PEAK};
    static const float rests[] = {VELUM_SCATTERING_WATER_REST, VELUM_SCATTERING_ICE_REST};
    for (int ice = 0; ice < 2; ice++) {
        const velum_phase_lobes phase = velum_phase_lobes_cloud(ice == 1);
        const float peak = velum_scattering_peak(phase);
        assert_true(fabsf(peak / peaks[ice] - 1.0f) < 1e-6f);
        assert_true(fabsf(velum_scattering_rest(velum_phase_lobes_moment(phase, 1), peak) / rests[ice] - 1.0f) < 1e-6f);
    }
}

/* Integral over the sphere by the midpoint rule in ln(1 - c + 1e-8). */
static double whole(float g, float peak, float straight) {
    const int steps = 40000;
    const double low = log(1e-8), high = log(2.0 + 1e-8);
    double sum = 0.0;
    for (int i = 0; i < steps; i++) {
        double x = exp(low + (high - low) * (i + 0.5) / steps);
        sum += x * (double)velum_scattering_first((float)(1.0 + 1e-8 - x), g, peak, straight);
    }
    return 2.0 * PI * sum * (high - low) / steps;
}

static void light_that_went_straight_on_spreads(void **state) {
    (void)state;
    static const float gs[] = {-0.5f, 0.0f, 0.5f, 0.85f, 0.95f, 0.99f};
    static const float optical_depths[] = {0.0f, 0.3f, 2.0f, 30.0f};
    for (int i = 0; i < 6; i++) {
        const velum_phase_lobes lobes = velum_phase_lobes_make(gs[i], 0.0f, 0.0f, 0.0f);
        const float peak = velum_scattering_peak(lobes);
        /* Nothing is lost by it, and none has before the first drop. */
        for (int k = 0; k < 4; k++) {
            assert_true(fabs(whole(gs[i], peak, peak * optical_depths[k]) - 1.0) < 5e-3);
        }
        for (int c = -10; c <= 10; c++) {
            const float cosine = 0.1f * (float)c, hg = velum_phase_hg(cosine, gs[i]);
            assert_true(fabsf(velum_scattering_first(cosine, gs[i], peak, 0.0f) / hg - 1.0f) < 1e-5f);
        }
    }
    /* All peak: orders of a narrow beam, exp(-t) t^k / k! of g^(k + 1) each. */
    for (int k = 0; k < 4; k++) {
        const double t = (double)optical_depths[k];
        for (int c = 0; c < 8; c++) {
            const float cosine = 1.0f - 1e-4f * (float)(c * c);
            double share = exp(-t), expected = 0.0, power = 0.99;
            for (int n = 0; n < 120; n++) {
                expected += share * (double)velum_phase_hg(cosine, (float)power);
                share *= t / (n + 1);
                power *= 0.99;
            }
            /* Late orders stand together; 1 + g^2 - 2 g c has few digits left here. */
            const double most = t > 10.0 ? 0.1 : 4e-3;
            assert_true(fabs((double)velum_scattering_first(cosine, 0.99f, 1.0f, (float)t) / expected - 1.0) < most);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(layers_radiate_as_discrete_ordinates_say),
                                       cmocka_unit_test(white_cloud_vanishes_in_even_light),
                                       cmocka_unit_test(white_layers_keep_no_light),
                                       cmocka_unit_test(thin_layers_scatter_once),
                                       cmocka_unit_test(the_second_order_has_its_peak),
                                       cmocka_unit_test(every_input_gives_a_number),
                                       cmocka_unit_test(moments_are_means_of_legendre_polynomials),
                                       cmocka_unit_test(cloud_has_the_peaks_that_are_written_down),
                                       cmocka_unit_test(light_that_went_straight_on_spreads)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
