/* The shared headers as C against closed forms, in double. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/geodesy.h"
#include "shared/air.h"
#include "shared/hash.h"
#include "shared/phase.h"
#include "shared/sample.h"
#include "shared/tile_address.h"

static double draw(uint32_t i, uint32_t n) {
    return (double)velum_hash_unit(velum_hash_2(i, n));
}

static void near(double got, double expected, double tolerance) {
    if (!(fabs(got - expected) <= tolerance)) {
        fail_msg("%.9g instead of %.9g +- %.2g", got, expected, tolerance);
    }
}

static int by_value(const void *a, const void *b) {
    uint32_t x = *(const uint32_t *)a;
    uint32_t y = *(const uint32_t *)b;
    return (x > y) - (x < y);
}

static void hash_is_a_permutation_and_even(void **state) {
    (void)state;
    /* Every step of PCG-RXS-M-XS can be undone, so no two words share a hash; of random ones 32 pairs would. */
    enum { WORDS = 1 << 19 };
    uint32_t *hashes = calloc(WORDS, sizeof *hashes);
    assert_non_null(hashes);
    uint32_t bins[256] = {0};
    for (uint32_t i = 0; i < WORDS; i++) {
        hashes[i] = velum_hash(i * 8191u);
        bins[(uint32_t)(velum_hash_unit(hashes[i]) * 256.0f)]++;
    }
    qsort(hashes, WORDS, sizeof *hashes, by_value);
    uint32_t twice = 0;
    for (uint32_t i = 1; i < WORDS; i++) {
        twice += hashes[i] == hashes[i - 1];
    }
    free(hashes);
    assert_int_equal(twice, 0);
    double chi2 = 0.0;
    for (uint32_t i = 0; i < 256; i++) {
        chi2 += (bins[i] - WORDS / 256.0) * (bins[i] - WORDS / 256.0) / (WORDS / 256.0);
    }
    assert_true(chi2 < 255.0 + 5.0 * sqrt(2.0 * 255.0)); /* five standard deviations of chi squared */
    assert_true(velum_hash_unit(0xffffffffu) < 1.0f);
    assert_true(velum_hash_unit(0) == 0.0f);
    assert_int_not_equal(velum_hash_2(1, 2), velum_hash_2(2, 1));
}

static void keys_hold_their_parts(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 100000; i++) {
        uint32_t level = velum_hash_2(i, 0) % (VELUM_TILE_LEVEL_MAX + 1);
        uint32_t face = velum_hash_2(i, 1) % 6;
        uint32_t x = velum_hash_2(i, 2) & ((1u << level) - 1);
        uint32_t y = velum_hash_2(i, 3) & ((1u << level) - 1);
        uint32_t key = velum_tile_key(level, face, x, y);
        assert_int_not_equal(key, VELUM_TILE_KEY_NONE);
        assert_int_equal(velum_tile_key_level(key), level);
        assert_int_equal(velum_tile_key_face(key), face);
        assert_int_equal(velum_tile_key_x(key), x);
        assert_int_equal(velum_tile_key_y(key), y);
    }
}

static void faces_are_tangent_warped(void **state) {
    (void)state;
    /* u = 4/pi atan(a / major) on the face of the greatest component; 1 on its edges. */
    static const double axes[6][3][3] = {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},  {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}},
                                         {{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}}, {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                         {{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {{0, 0, -1}, {0, 1, 0}, {1, 0, 0}}};
    for (uint32_t i = 0; i < 60000; i++) {
        uint32_t face = i % 6;
        double u = i < 600 ? (double)(i / 6 % 3) - 1.0 : 2.0 * draw(i, 0) - 1.0;
        double v = i < 600 ? (double)(i / 18 % 3) - 1.0 : 2.0 * draw(i, 1) - 1.0;
        double tu = tan(u * CORE_PI / 4.0);
        double tv = tan(v * CORE_PI / 4.0);
        double norm = 1.0 / sqrt(1.0 + tu * tu + tv * tv);
        double d[3];
        for (uint32_t n = 0; n < 3; n++) {
            d[n] = norm * (axes[face][0][n] + tu * axes[face][1][n] + tv * axes[face][2][n]);
        }
        velum_face_place place = velum_face_of((float)d[0], (float)d[1], (float)d[2]);
        bool edge = fabs(u) > 1.0 - 1e-6 || fabs(v) > 1.0 - 1e-6;
        if (!edge) {
            assert_int_equal(place.face, face);
            near(place.u, u, 4e-7);
            near(place.v, v, 4e-7);
        } else { /* one of the faces that meet there, at its border */
            near(fmax(fabs((double)place.u), fabs((double)place.v)), 1.0, 4e-7);
        }
        for (uint32_t level = 0; level <= VELUM_TILE_LEVEL_MAX; level++) {
            float x = velum_tile_coordinate(place.u, level);
            assert_true(x >= 0.0f && x < (float)(1u << level));
        }
    }
}

static void levels_have_tiles_between_an_eighth_and_a_quarter_of_the_distance(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 100000; i++) {
        double distance = exp2(1.0 + 24.0 * draw(i, 0));
        uint32_t level = velum_tile_level((float)distance, 1.0f);
        double side = (double)VELUM_TILE_FACE_M / exp2(level);
        assert_true(level <= VELUM_TILE_LEVEL_MAX);
        assert_true(side >= distance / 8.0 * (1.0 - 1e-5));
        assert_true(level == VELUM_TILE_LEVEL_MAX || side <= distance / 4.0 * (1.0 + 1e-5));
    }
    assert_int_equal(velum_tile_level(0.0f, 1.0f), VELUM_TILE_LEVEL_MAX);
    assert_int_equal(velum_tile_level(-1.0f, 1.0f), VELUM_TILE_LEVEL_MAX);
    assert_int_equal(velum_tile_level(1e5f, 2.0f), velum_tile_level(1e5f, 1.0f) + 1);
}

static bool eye_at(double lat_deg, double lon_deg, double height_m, double ecef[3], velum_eye_geometry *eye) {
    core_geodetic place = {lat_deg, lon_deg, height_m};
    return core_ecef_from_geodetic(&place, ecef) && core_eye_geometry(ecef, eye);
}

static void heights_are_those_of_the_ellipsoid(void **state) {
    (void)state;
    static const double edges[][2] = {{90, 0}, {-90, 45}, {0, 180}, {0, -180}, {89.9999, 180}, {0, 0}, {45, -180}};
    double worst[3] = {0};
    for (uint32_t i = 0; i < 20000; i++) {
        double lat = i < 700 ? edges[i % 7][0] : 180.0 * draw(i, 0) - 90.0;
        double lon = i < 700 ? edges[i % 7][1] : 360.0 * draw(i, 1) - 180.0;
        double ecef[3];
        velum_eye_geometry eye;
        assert_true(eye_at(lat, lon, 12000.0 * draw(i, 2), ecef, &eye));
        /* A point up to 400 km away, between the ground and 20 km. */
        double normal[3];
        core_normal(lat + 3.6 * (draw(i, 3) - 0.5), lon + 3.6 * (draw(i, 4) - 0.5), normal);
        double point[3];
        core_position(normal, 20000.0 * draw(i, 5), point);
        float r[3];
        double at[3];
        double distance = 0.0;
        for (uint32_t n = 0; n < 3; n++) {
            r[n] = i % 10 == 0 ? 0.0f : (float)(point[n] - ecef[n]);
            at[n] = ecef[n] + (double)r[n];
            distance += (double)r[n] * (double)r[n];
        }
        distance = sqrt(distance);
        core_geodetic exact;
        assert_true(core_geodetic_from_ecef(at, &exact));
        velum_place place = velum_place_at(eye, r[0], r[1], r[2]);
        double error = fabs((double)place.height_m - exact.height_m);
        uint32_t band = distance < 1e4 ? 0 : distance < 1e5 ? 1 : 2;
        worst[band] = fmax(worst[band], error);
        core_normal(exact.lat_deg, exact.lon_deg, normal);
        near(place.nx, normal[0], 4e-7);
        near(place.ny, normal[1], 4e-7);
        near(place.nz, normal[2], 4e-7);
    }
    print_message("height errs by %.4f m within 10 km, %.4f m within 100 km, %.4f m within 400 km\n", worst[0],
                  worst[1], worst[2]);
    assert_true(worst[0] < 0.005 && worst[1] < 0.02 && worst[2] < 0.05);
}

static void spans_are_the_roots(void **state) {
    (void)state;
    uint32_t hits = 0;
    double worst = 0.0;
    for (uint32_t i = 0; i < 50000; i++) {
        double ecef[3];
        velum_eye_geometry eye;
        assert_true(eye_at(180.0 * draw(i, 0) - 90.0, 360.0 * draw(i, 1) - 180.0, 15000.0 * draw(i, 2), ecef, &eye));
        double z = 2.0 * draw(i, 3) - 1.0;
        double turn = 2.0 * CORE_PI * draw(i, 4);
        float d[3] = {(float)(sqrt(1 - z * z) * cos(turn)), (float)(sqrt(1 - z * z) * sin(turn)), (float)z};
        float over = i % 3 ? (float)(20000.0 * draw(i, 5)) : 0.0f;
        velum_span span = velum_sphere_span(eye, 0.0f, 0.0f, 0.0f, d[0], d[1], d[2], over);
        const double k = CORE_WGS84_A_M / CORE_WGS84_B_M;
        double s[3] = {ecef[0], ecef[1], ecef[2] * k};
        double e[3] = {d[0], d[1], d[2] * k};
        double a = e[0] * e[0] + e[1] * e[1] + e[2] * e[2];
        double b = s[0] * e[0] + s[1] * e[1] + s[2] * e[2];
        double radius = CORE_WGS84_A_M + (double)over;
        double c = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - radius * radius;
        double discriminant = b * b - a * c;
        if (fabs(discriminant) < 2e-6 * radius * radius) {
            continue; /* touches, or just fails to */
        }
        assert_int_equal(span.enter_m <= span.leave_m, discriminant > 0.0);
        if (discriminant > 0.0) {
            double root = sqrt(discriminant);
            double q = b >= 0.0 ? -(b + root) : root - b;
            double low = fmin(q / a, c / q);
            double high = fmax(q / a, c / q);
            double tolerance = 2.0 + 4.0 * radius / root;
            near(span.enter_m, low, tolerance);
            near(span.leave_m, high, tolerance);
            worst = fmax(worst, fmax(fabs(span.enter_m - low), fabs(span.leave_m - high)) / tolerance);
            hits++;
        }
    }
    print_message("%u rays meet the sphere; roots within %.2f of the tolerance\n", hits, worst);
    assert_true(hits > 20000);
}

/* Integral over the sphere and mean cosine of a phase function, Simpson's rule over c = 1 - 2 s^6. */
static void moments(float (*phase)(float c, const void *with), const void *with, double *whole, double *cosine) {
    const int n = 20000;
    *whole = *cosine = 0.0;
    for (int i = 0; i <= n; i++) {
        double s = (double)i / n;
        double c = 1.0 - 2.0 * pow(s, 6);
        double weight = (i == 0 || i == n ? 1.0 : i % 2 ? 4.0 : 2.0) / (3.0 * n) * 12.0 * pow(s, 5) * 2.0 * CORE_PI;
        double p = (double)phase((float)c, with);
        *whole += weight * p;
        *cosine += weight * p * c;
    }
}
static float hg(float c, const void *with) {
    return velum_phase_hg(c, *(const float *)with);
}
static float draine(float c, const void *with) {
    return velum_phase_draine(c, ((const float *)with)[0], ((const float *)with)[1]);
}
static float droplet(float c, const void *with) {
    return velum_phase_droplet_at(velum_phase_droplet_of(*(const float *)with), c);
}
static float cloud(float c, const void *with) {
    return velum_phase_cloud(c, *(const bool *)with);
}

static void phase_functions_hold_all_light(void **state) {
    (void)state;
    double whole;
    double cosine;
    static const float gs[] = {-0.5f, 0.0f, 0.3f, 0.85f, 0.95f};
    for (uint32_t i = 0; i < 5; i++) {
        moments(hg, &gs[i], &whole, &cosine);
        near(whole, 1.0, 2e-4);
        near(cosine, gs[i], 2e-4);
        for (uint32_t j = 0; j < 3; j++) {
            const float with[2] = {gs[i], (float[]){0.0f, 1.0f, 27.0f}[j]};
            moments(draine, with, &whole, &cosine);
            near(whole, 1.0, 2e-4);
            near(cosine, velum_phase_draine_mean_cosine(with[0], with[1]), 2e-4);
        }
    }
    near(velum_phase_hg(0.3f, 0.0f), 1.0 / (4.0 * CORE_PI), 1e-8);
    /* Draine with g = 0, alpha = 1 is Rayleigh's 3/(16 pi) (1 + c^2). */
    near(velum_phase_draine(0.5f, 0.0f, 1.0f), 3.0 / (16.0 * CORE_PI) * 1.25, 1e-8);
    static const float diameters[] = {5.0f, 10.0f, 20.0f, 50.0f};
    for (uint32_t i = 0; i < 4; i++) {
        velum_phase_droplet p = velum_phase_droplet_of(diameters[i]);
        moments(droplet, &diameters[i], &whole, &cosine);
        near(whole, 1.0, 2e-3); /* the forward peak is narrow for floats */
        double expected = (1.0 - (double)p.weight_draine) * (double)p.g_hg +
                          (double)p.weight_draine * (double)velum_phase_draine_mean_cosine(p.g_draine, p.alpha);
        near(cosine, expected, 2e-3);
        assert_true(cosine > 0.75 && cosine < 0.9); /* Mie: 0.8 to 0.87 for droplets */
    }
    static const bool ices[] = {false, true};
    moments(cloud, &ices[0], &whole, &cosine);
    near(whole, 1.0, 2e-3);
    moments(cloud, &ices[1], &whole, &cosine);
    near(whole, 1.0, 2e-4);
    near(cosine, 0.75, 2e-4);
    /* The constants are the fit at 20 um. */
    velum_phase_droplet p = velum_phase_droplet_of(20.0f);
    near(p.g_hg, VELUM_DROPLET_20_G_HG, 2e-7);
    near(p.g_draine, VELUM_DROPLET_20_G_DRAINE, 2e-7);
    near(p.alpha, VELUM_DROPLET_20_ALPHA, 1e-5);
    near(p.weight_draine, VELUM_DROPLET_20_WEIGHT, 2e-7);
}

static void air_thins_with_height(void **state) {
    (void)state;
    near(velum_rayleigh_density(0.0f), 1.0, 1e-7);
    near(velum_rayleigh_density(8000.0f), exp(-1.0), 1e-7);
    near(velum_aerosol_density(1200.0f), exp(-1.0), 1e-7);
    near(velum_rayleigh_density(-1e30f), exp(500.0 / 8000.0), 1e-6);
    near(velum_ozone_density(25000.0f), 1.0, 1e-7);
    near(velum_ozone_density(17500.0f), 0.5, 1e-6);
    assert_true(velum_ozone_density(9999.0f) == 0.0f && velum_ozone_density(40001.0f) == 0.0f);
    for (uint32_t i = 0; i < 20000; i++) {
        /* The fog's column is the integral of its density. */
        double top = 50.0 + 950.0 * draw(i, 0);
        double low = -100.0 + 1200.0 * draw(i, 1);
        double high = low + 200.0 * draw(i, 2);
        double sum = 0.0;
        for (int n = 0; n < 64; n++) {
            double h = low + (high - low) * (n + 0.5) / 64.0;
            sum += (double)velum_fog_density((float)h, (float)top) * (high - low) / 64.0;
        }
        near(velum_fog_column_m((float)high, (float)top) - velum_fog_column_m((float)low, (float)top), sum, 0.03);
    }
    near(velum_fog_density(300.0f, 300.0f), 0.0, 0.0);
    near(velum_fog_density(180.0f, 300.0f), 1.0, 0.0);
}

static void the_air_table_is_found_again(void **state) {
    (void)state;
    double worst = 0.0;
    for (uint32_t i = 0; i < 50000; i++) {
        float u = (float)draw(i, 0);
        float v = (float)(0.97 * draw(i, 1));
        velum_air_ray ray = velum_air_ray_of(u, v);
        assert_true(ray.height_m >= 0.0f && ray.height_m <= VELUM_AIR_TOP_M * 1.00001f);
        velum_air_uv uv = velum_air_uv_of(ray.height_m, ray.mu);
        near(uv.v, v, 1e-5);
        worst = fmax(worst, fabs((double)uv.u - (double)u));
    }
    print_message("u is found within %.2g\n", worst);
    assert_true(worst < 2e-5); /* a texel is 4e-3 */
    for (uint32_t i = 0; i < 1000; i++) {
        double h = i == 0 ? 0.0 : exp(15.0 * draw(i, 2));
        double r = (double)VELUM_WGS84_A_M + (double)(float)h;
        double exact = -sqrt((double)(float)h * (2.0 * (double)VELUM_WGS84_A_M + (double)(float)h)) / r;
        near(velum_horizon_mu((float)h), exact, 2e-7);
    }
    near(velum_air_uv_of(0.0f, 1.0f).u, 0.0, 1e-6);
    near(velum_air_uv_of(0.0f, 0.0f).u, 1.0, 1e-5);
}

static void texels_hold_what_the_weather_says(void **state) {
    (void)state;
    for (uint32_t i = 0; i < 50000; i++) {
        double height = -1000.0 + 27000.0 * draw(i, 0);
        double extinction = pow(10.0, -7.0 + 8.0 * draw(i, 1));
        double wind = 256.0 * draw(i, 2) - 128.0;
        double stored = round(65535.0 * (double)velum_texel_from_height((float)height)) / 65535.0;
        near(velum_texel_height_m((float)stored), height, 0.5 * 27000.0 / 65535.0 + 0.005);
        stored = round(65535.0 * (double)velum_texel_from_extinction((float)extinction)) / 65535.0;
        near(velum_texel_extinction_1_m((float)stored), extinction, 2e-4 * extinction);
        stored = round(65535.0 * (double)velum_texel_from_wind((float)wind)) / 65535.0;
        near(velum_texel_wind_m_s((float)stored), wind, 0.5 * 256.0 / 65535.0 + 2e-5);
    }
    assert_true(velum_texel_from_extinction(0.0f) >= 0.0f && velum_texel_from_extinction(INFINITY) == 1.0f);
}

static void mixed_ranks_are_ranks(void **state) {
    (void)state;
    /* Over the unit square, the share of points whose mixed rank is below q is q, whatever the weight. */
    enum { SIDE = 500 };
    static const float weights[] = {0.0f, 1e-5f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f, 2.0f};
    for (uint32_t w = 0; w < 8; w++) {
        uint32_t below[10] = {0};
        double squares = 0.0;
        for (uint32_t i = 0; i < SIDE; i++) {
            for (uint32_t j = 0; j < SIDE; j++) {
                float r0 = ((float)i + 0.5f) / SIDE;
                float r1 = ((float)j + 0.5f) / SIDE;
                float rank = velum_rank_mix(r0, r1, weights[w]);
                assert_true(rank >= 0.0f && rank <= 1.0f);
                for (uint32_t q = 1; q < 10; q++) {
                    below[q] += rank < 0.1f * (float)q;
                }
                double d = (double)velum_detail_mix(0.3f + 0.4f * r0, 0.3f + 0.4f * r1, weights[w]) - 0.5;
                squares += d * d;
            }
        }
        for (uint32_t q = 1; q < 10; q++) {
            near((double)below[q] / (SIDE * SIDE), 0.1 * q, 3.0 / SIDE);
        }
        near(squares / (SIDE * SIDE), 0.16 / 12.0, 0.16 / 12.0 * 0.01); /* variance of 0.4 times a uniform number */
    }
}

static void states_blend(void **state) {
    (void)state;
    const velum_slot_fields a = {0.8f, 1000.0f, 2000.0f, 0.01f, 10.0f, 0.0f, -4.0f, 0.0f};
    const velum_slot_fields b = {0.8f, 3000.0f, 5000.0f, 0.09f, 0.0f, 8.0f, 4.0f, 1.0f};
    const velum_slot_fields none = {0.0f, 9000.0f, 9500.0f, 1e-7f, 0.0f, 0.0f, 0.0f, 0.5f};
    velum_slot_fields f = velum_fields_mix(a, b, 0.5f);
    near(f.coverage, 0.8, 1e-6);
    near(f.base_m, 2000.0, 1e-2);
    near(f.extinction_1_m, 0.03, 1e-6); /* the geometric mean */
    near(f.wind_x_m_s, 5.0, 1e-5);
    f = velum_fields_mix(a, none, 0.75f); /* fades where it is */
    near(f.coverage, 0.2, 1e-6);
    near(f.base_m, 1000.0, 1e-3);
    near(f.top_m, 2000.0, 1e-3);
    near(f.extinction_1_m, 0.01, 1e-7);
    f = velum_fields_mix(a, b, 0.0f);
    near(f.top_m, 2000.0, 0.0);
    f = velum_fields_mix(a, b, 1.0f);
    near(f.top_m, 5000.0, 0.0);
    /* A coverage that is no number blends to no cloud. */
    velum_slot_fields odd = a;
    odd.coverage = NAN;
    f = velum_fields_mix(odd, b, 0.5f);
    assert_true(velum_slot_extinction(VELUM_SLOT_LOW, f, 1500.0f, 1.0f, 1.0f, 1.0f) == 0.0f);
}

static void noise_is_turned_not_bent(void **state) {
    (void)state;
    const double rows[3][3] = {{VELUM_NOISE_AX, VELUM_NOISE_AY, VELUM_NOISE_AZ},
                               {VELUM_NOISE_BX, VELUM_NOISE_BY, VELUM_NOISE_BZ},
                               {VELUM_NOISE_CX, VELUM_NOISE_CY, VELUM_NOISE_CZ}};
    for (uint32_t i = 0; i < 3; i++) {
        for (uint32_t j = 0; j < 3; j++) {
            double dot = rows[i][0] * rows[j][0] + rows[i][1] * rows[j][1] + rows[i][2] * rows[j][2];
            near(dot, i == j ? 1.0 : 0.0, 2e-7);
        }
    }
    velum_noise_point p = velum_noise_place(0.25f, 0.5f, 0.75f, 1e-3f, 1.0f, 0.0f, 0.0f, 0.0f, 0.0f);
    near(p.x, 0.25, 0.0);
    p = velum_noise_place(0.0f, 0.0f, 0.0f, 1e-3f, 1.0f, 0.0f, 600.0f, 0.0f, 800.0f);
    near(sqrt((double)p.x * (double)p.x + (double)p.y * (double)p.y + (double)p.z * (double)p.z), 1.0, 1e-6);
    /* Stretched: drawn out but for what lies across. */
    p = velum_noise_place(0.0f, 0.0f, 0.0f, 1e-3f, 0.2f, 0.0f, 600.0f, 0.0f, 800.0f);
    near(sqrt((double)p.x * (double)p.x + (double)p.y * (double)p.y + (double)p.z * (double)p.z), 0.2, 1e-6);
    velum_noise_point q = velum_noise_place(0.0f, 0.0f, 0.0f, 1e-3f, 0.2f, 1000.0f, 600.0f, 0.0f, 800.0f);
    near(hypot(hypot((double)(q.x - p.x), (double)(q.y - p.y)), (double)(q.z - p.z)), 0.8, 1e-6);
}

static double latitude_rad(const double p[3]) {
    return atan2(p[2], hypot(p[0], p[1]));
}

/* Metres across fibres are those of geocentric latitude, wherever the eye is, at the poles too; along a parallel they
 * do not change. */
static void fibres_follow_parallels(void **state) {
    (void)state;
    static const double eye_lats[] = {-90.0, -89.9, -35.0, 0.0, 50.0, 89.99, 90.0};
    static const double far_m[] = {1.0, 300.0, 2e4, 1e6, 6e6};
    static const double up_m[] = {0.0, 12e3, 3.6e7};
    for (size_t l = 0; l < sizeof eye_lats / sizeof eye_lats[0]; l++) {
        for (size_t i = 0; i < 5 * 3 * 8; i++) {
            const double lat = eye_lats[l] * CORE_PI / 180.0;
            const double lon = 2.5;
            const double radius = (double)VELUM_WGS84_A_M + up_m[i / 5 % 3];
            const double eye[3] = {radius * cos(lat) * cos(lon), radius * cos(lat) * sin(lon), radius * sin(lat)};
            const double turn = 2.0 * CORE_PI * (double)(i / 15) / 8.0;
            const double reach = far_m[i % 5] / (double)VELUM_WGS84_A_M;
            const double north[3] = {-sin(lat) * cos(lon), -sin(lat) * sin(lon), cos(lat)};
            const double east[3] = {-sin(lon), cos(lon), 0.0};
            double point[3];
            for (int axis = 0; axis < 3; axis++) {
                const double level = north[axis] * cos(turn) + east[axis] * sin(turn);
                point[axis] = (double)VELUM_WGS84_A_M * (eye[axis] / radius * cos(reach) + level * sin(reach));
            }
            const double wanted = (double)VELUM_WGS84_A_M * (latitude_rad(point) - latitude_rad(eye));
            const float got = velum_north_m((float)eye[0], (float)eye[1], (float)eye[2], (float)(point[0] - eye[0]),
                                            (float)(point[1] - eye[1]), (float)(point[2] - eye[2]));
            near((double)got, wanted,
                 3.0 + 5e-7 * (up_m[i / 5 % 3] + 4.0 * far_m[i % 5])); /* floats of that size: 1.2e-7 */
        }
    }
}

/* Waves repeat, have the mean 0 and are no steeper than is said. */
static void waves_bend_fibres(void **state) {
    (void)state;
    const float waves_slope = sqrtf(3.0f) * VELUM_WAVE_SLOPE * 1.001f;
    near((double)velum_wave(0.25f), 1.0, 0.0);
    near((double)velum_wave(-0.25f), -1.0, 0.0);
    near((double)velum_wave(7.125f), (double)velum_wave(0.125f), 0.0);
    double mean = 0.0;
    for (uint32_t i = 0; i < 4096; i++) {
        const double z = 2.0 * draw(i, 0) - 1.0;
        const double turn = 2.0 * CORE_PI * draw(i, 1);
        const double up[3] = {sqrt(1.0 - z * z) * cos(turn), sqrt(1.0 - z * z) * sin(turn), z};
        float p[2][3];
        for (int axis = 0; axis < 3; axis++) {
            p[0][axis] = (float)((double)VELUM_WGS84_A_M * up[axis]);
            p[1][axis] = p[0][axis] + (float)(200.0 * draw(i, 2 + (uint32_t)axis) - 100.0);
        }
        const float here = velum_waves_m(p[0][0], p[0][1], p[0][2]);
        const float there = velum_waves_m(p[1][0], p[1][1], p[1][2]);
        const float apart = hypotf(hypotf(p[1][0] - p[0][0], p[1][1] - p[0][1]), p[1][2] - p[0][2]);
        assert_true(fabsf(there - here) <= apart * waves_slope + 3.0f);
        near((double)velum_waves_m(1.002f * p[0][0], 1.002f * p[0][1], 1.002f * p[0][2]), (double)here, 3.0);
        mean += (double)here / 4096.0;
    }
    near(mean, 0.0, 30.0);
    assert_true(1.0034f + waves_slope < VELUM_FIBRE_SLOPE);
}

static void cloud_is_between_base_and_top(void **state) {
    (void)state;
    uint32_t cloudy[VELUM_SLOT_COUNT] = {0};
    for (uint32_t i = 0; i < 80000; i++) {
        int slot = (int)(i % VELUM_SLOT_COUNT);
        velum_slot_fields f = {.coverage = (float)draw(i, 0),
                               .base_m = 1000.0f,
                               .top_m = 2500.0f,
                               .extinction_1_m = 0.05f,
                               .kind = (float)draw(i, 1)};
        float rank = (float)draw(i, 2);
        float lump = 2.0f * (float)draw(i, 3) - 1.0f;
        float fine = (float)draw(i, 4);
        float height = 500.0f + 2500.0f * (float)draw(i, 5);
        float extinction = velum_slot_extinction(slot, f, height, rank, lump, fine);
        assert_true(extinction >= 0.0f && isfinite(extinction));
        if (height < f.base_m || height > f.top_m) {
            assert_true(extinction == 0.0f);
        }
        if (slot >= VELUM_SLOT_UNIFORM) {
            bool inside = height >= f.base_m && height <= f.top_m && f.coverage >= 0.5f;
            assert_true(extinction == (inside ? 0.05f : 0.0f));
        } else {
            /* Cloud only where the excess rank is positive; more where the rank is higher or less is carved off. */
            velum_profile profile = velum_profile_of(slot, f);
            if (velum_excess(profile, f.coverage, rank) <= 0.0f) {
                assert_true(extinction == 0.0f);
            }
            float more = fminf(rank + 0.1f, 1.0f);
            assert_true(velum_slot_extinction(slot, f, height, more, lump, fine) >= extinction);
            assert_true(velum_slot_extinction(slot, f, height, rank, lump + 0.1f, fine) >= extinction);
            assert_true(velum_slot_extinction(slot, f, height, rank, lump, fine + 0.1f) >= extinction);
        }
        cloudy[slot] += extinction > 0.0f;
    }
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        assert_true(cloudy[slot] > 100);
    }
    velum_profile p = velum_profile_make(0.5f, 2.0f, 0.2f, 0.1f, 0.1f, 0.0f, 0.0f, 0.5f, 25.0f);
    /* e is uniform over the covered columns: 0 at rank 1 - c, 1 at rank 1. */
    near(velum_excess(p, 0.25f, 0.75f), 0.0, 1e-6);
    near(velum_excess(p, 0.25f, 1.0f), 1.0, 1e-6);
    near(velum_excess(p, 0.25f, 0.875f), 0.5, 1e-6);
    assert_true(velum_excess(p, 0.0f, 1.0f) < 0.0f);
    near(velum_threshold(p, 0.5f), 0.5 * 0.25, 1e-6);
    near(velum_threshold(p, 1.0f), 0.5, 1e-6);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hash_is_a_permutation_and_even),
        cmocka_unit_test(keys_hold_their_parts),
        cmocka_unit_test(faces_are_tangent_warped),
        cmocka_unit_test(levels_have_tiles_between_an_eighth_and_a_quarter_of_the_distance),
        cmocka_unit_test(heights_are_those_of_the_ellipsoid),
        cmocka_unit_test(spans_are_the_roots),
        cmocka_unit_test(phase_functions_hold_all_light),
        cmocka_unit_test(air_thins_with_height),
        cmocka_unit_test(the_air_table_is_found_again),
        cmocka_unit_test(texels_hold_what_the_weather_says),
        cmocka_unit_test(mixed_ranks_are_ranks),
        cmocka_unit_test(states_blend),
        cmocka_unit_test(noise_is_turned_not_bent),
        cmocka_unit_test(fibres_follow_parallels),
        cmocka_unit_test(waves_bend_fibres),
        cmocka_unit_test(cloud_is_between_base_and_top),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
