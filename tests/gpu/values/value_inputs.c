#include "value_inputs.h"

#include <math.h>
#include <string.h>

#include "core/geodesy.h"
#include "shared/air.h"
#include "shared/hash.h"
#include "shared/tile_address.h"

#define COUNT(array) (uint32_t)(sizeof(array) / sizeof((array)[0]))

float word_float(uint32_t word) {
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}

uint32_t float_word(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}

static float between(uint32_t i, uint32_t draw, float low, float high) {
    return low + (high - low) * velum_hash_unit(velum_hash_2(i, draw));
}

/* An edge for some, a draw for the others. */
static float edge_or(uint32_t i, uint32_t draw, const float *edges, uint32_t count, float low, float high) {
    uint32_t turn = velum_hash_3(i, draw, 77u);
    return turn % 4u == 0 ? edges[(turn >> 8u) % count] : between(i, draw, low, high);
}

static void put(uint32_t *in, uint32_t n, float value) {
    in[n] = float_word(value);
}

void fill_hash(uint32_t i, uint32_t *in) {
    static const uint32_t edges[] = {0, 1, 2, 0x7fffffff, 0x80000000, 0xfffffffe, 0xffffffff, 0xff};
    for (uint32_t n = 0; n < 4; n++) {
        in[n] = i < 4096 ? edges[(i >> 3u * n) % 8u] : velum_hash_2(i, n);
    }
}

void fill_tile(uint32_t i, uint32_t *in) {
    /* Poles, antimeridian from both sides, faces' centres, edges and corners, just beside them. */
    const float e = 0.70710678f;
    const float c = 0.57735027f;
    const float b = nextafterf(c, 1.0f);
    const float directions[][3] = {{1, 0, 0},
                                   {-1, 0, 0},
                                   {0, 1, 0},
                                   {0, -1, 0},
                                   {0, 0, 1},
                                   {0, 0, -1},
                                   {-1, -0.0f, 0},
                                   {-1, 1e-20f, 0},
                                   {-1, -1e-20f, 0},
                                   {1e-20f, 0, 1},
                                   {-1e-20f, 1e-20f, -1},
                                   {e, e, 0},
                                   {-e, e, 0},
                                   {e, 0, -e},
                                   {0, -e, -e},
                                   {c, c, c},
                                   {-c, -c, -c},
                                   {-c, c, -c},
                                   {b, c, c},
                                   {c, b, c},
                                   {c, c, b},
                                   {-c, -b, c},
                                   {c, -c, -b}};
    if (i < COUNT(directions)) {
        for (uint32_t n = 0; n < 3; n++) {
            put(in, n, directions[i][n]);
        }
    } else {
        double lat = asin(between(i, 0, -1.0f, 1.0f));
        double lon = between(i, 1, -3.14159265f, 3.14159265f);
        put(in, 0, (float)(cos(lat) * cos(lon)));
        put(in, 1, (float)(cos(lat) * sin(lon)));
        put(in, 2, (float)sin(lat));
    }
    static const float distances[] = {-5.0f, 0.0f, 0.5f, 1.0f, 9.7e3f, 1e30f, INFINITY, 4.0e7f, 4.0e7f / 4096.0f};
    float distance = i % 2 ? exp2f(between(i, 2, 0.0f, 27.0f)) : between(i, 3, 1.0f, 4.0e5f);
    if (i % 16 == 0) { /* a border, or a few ulp beside a border */
        distance = 4.0e7f / exp2f(floorf(between(i, 6, 0.0f, 14.0f)));
        distance = word_float(float_word(distance) + velum_hash_2(i, 4) % 9u - 4u);
    }
    put(in, 3, i < COUNT(distances) ? distances[i] : distance);
    put(in, 4, i % 3 ? 1.0f : between(i, 5, 0.25f, 4.0f));
    in[5] = velum_hash_2(i, 7) % (VELUM_TILE_LEVEL_MAX + 1u);
}

void fill_planet(uint32_t i, uint32_t *in) {
    static const float lats[] = {90.0f, -90.0f, 0.0f, 89.9999f, 45.0f, -0.0001f};
    static const float lons[] = {0.0f, 180.0f, -180.0f, 179.9999f, 90.0f, -90.0f};
    static const float heights[] = {0.0f, 2.0f, -400.0f, 20000.0f, 400000.0f};
    static const float overs[] = {0.0f, -1000.0f, 1.0f, 12000.0f, 27000.0f};
    core_geodetic place = {edge_or(i, 0, lats, COUNT(lats), -90.0f, 90.0f),
                           edge_or(i, 1, lons, COUNT(lons), -180.0f, 180.0f),
                           edge_or(i, 2, heights, COUNT(heights), 0.0f, 15000.0f)};
    double ecef[3];
    velum_eye_geometry eye = {0};
    if (core_ecef_from_geodetic(&place, ecef)) {
        core_eye_geometry(ecef, &eye);
    }
    memcpy(in, &eye, sizeof eye);
    float radius = i % 8 == 0 ? 0.0f : exp2f(between(i, 3, 0.0f, 18.3f));
    double ray[2][3];
    for (uint32_t n = 0; n < 2; n++) {
        double z = between(i, 4 + 2 * n, -1.0f, 1.0f);
        double turn = between(i, 5 + 2 * n, 0.0f, 6.2831853f);
        ray[n][0] = sqrt(1.0 - z * z) * cos(turn);
        ray[n][1] = sqrt(1.0 - z * z) * sin(turn);
        ray[n][2] = z;
    }
    if (i % 4 == 0) { /* level with the eye, or just under the horizon */
        double normal[3];
        double east[3];
        double north[3];
        core_normal(place.lat_deg, place.lon_deg, normal);
        core_east_north(normal, east, north);
        double dip = i % 8 == 0 ? 0.0 : acos(CORE_RADIUS_M / (CORE_RADIUS_M + fmax(place.height_m, 0.0))) + 1e-3;
        for (uint32_t n = 0; n < 3; n++) {
            ray[1][n] = cos(dip) * (0.6 * east[n] + 0.8 * north[n]) - sin(dip) * normal[n];
        }
    }
    for (uint32_t n = 0; n < 3; n++) {
        put(in, 8 + n, (float)(radius * ray[0][n]));
        put(in, 11 + n, (float)ray[1][n]);
    }
    put(in, 14, edge_or(i, 8, overs, COUNT(overs), 0.0f, 20000.0f));
}

void fill_phase(uint32_t i, uint32_t *in) {
    static const float cosines[] = {-1.0f, 0.0f, 1.0f, 0.9999999f, 0.9999f};
    static const float gs[] = {0.0f, 0.85f, -0.5f, 0.99f, -0.99f};
    static const float alphas[] = {0.0f, 1.0f, 27.0f, 100.0f};
    static const float diameters[] = {-1.0f, 0.0f, 5.0f, 20.0f, 50.0f, 1e30f};
    put(in, 0, edge_or(i, 0, cosines, COUNT(cosines), -1.0f, 1.0f));
    put(in, 1, edge_or(i, 1, gs, COUNT(gs), -0.9f, 0.97f));
    put(in, 2, edge_or(i, 2, alphas, COUNT(alphas), 0.0f, 50.0f));
    put(in, 3, edge_or(i, 3, diameters, COUNT(diameters), 5.0f, 50.0f));
}

void fill_air(uint32_t i, uint32_t *in) {
    static const float heights[] = {-1e9f, -500.0f, 0.0f, 1.0f, 25000.0f, VELUM_AIR_TOP_M, 1e9f};
    static const float tops[] = {0.0f, 100.0f, 120.0f, 3000.0f};
    static const float places[] = {0.0f, 0.5f, 1.0f};
    float height = edge_or(i, 0, heights, COUNT(heights), -400.0f, 60000.0f);
    float horizon = velum_horizon_mu(fminf(height, VELUM_AIR_TOP_M));
    put(in, 0, height);
    put(in, 1, i % 5 == 0 ? horizon : between(i, 1, horizon, 1.0f));
    put(in, 2, edge_or(i, 2, tops, COUNT(tops), 50.0f, 2000.0f));
    put(in, 3, edge_or(i, 3, places, COUNT(places), 0.0f, 1.0f));
    put(in, 4, edge_or(i, 4, places, COUNT(places), 0.0f, 1.0f));
}

void fill_sample(uint32_t i, uint32_t *in) {
    static const float units[] = {0.0f, 1.0f, 0.5f};
    static const float heights[] = {-1e30f, -1000.0f, 0.0f, 26000.0f, 1e30f};
    static const float extinctions[] = {-1.0f, 0.0f, 1e-7f, 1e-3f, 1.0f, 10.0f, 1e30f};
    static const float winds[] = {-1e30f, -128.0f, 0.0f, 128.0f, 1e30f};
    static const float coverages[] = {0.0f, 1.0f, 0.5f};
    put(in, 0, edge_or(i, 0, units, COUNT(units), 0.0f, 1.0f));
    put(in, 1, edge_or(i, 1, heights, COUNT(heights), -1000.0f, 26000.0f));
    put(in, 2, edge_or(i, 2, extinctions, COUNT(extinctions), 1e-6f, 0.2f));
    put(in, 3, edge_or(i, 3, winds, COUNT(winds), -128.0f, 128.0f));
    for (uint32_t n = 4; n < 9; n++) {
        put(in, n, edge_or(i, n, units, COUNT(units), 0.0f, 1.0f));
    }
    for (uint32_t n = 9; n < 25; n += 8) {
        put(in, n, edge_or(i, n, coverages, COUNT(coverages), 0.01f, 1.0f));
        put(in, n + 1, between(i, n + 1, 100.0f, 8000.0f));
        put(in, n + 2, between(i, n + 2, 8000.0f, 15000.0f));
        put(in, n + 3, edge_or(i, n + 3, extinctions, COUNT(extinctions), 1e-6f, 0.2f));
        for (uint32_t m = 4; m < 7; m++) {
            put(in, n + m, between(i, n + m, -128.0f, 128.0f));
        }
        put(in, n + 7, between(i, n + 7, 0.0f, 1.0f));
    }
    if (i % 64 == 63) {
        put(in, 9, NAN);
    }
    put(in, 25, edge_or(i, 25, units, COUNT(units), 0.0f, 1.0f));
    for (uint32_t n = 26; n < 29; n++) {
        put(in, n, edge_or(i, n, units, COUNT(units), 0.0f, 1.0f));
    }
    put(in, 29, 1.0f / between(i, 29, 300.0f, 45000.0f));
    put(in, 30, i % 2 ? 1.0f : 0.12f);
    put(in, 31, between(i, 31, -3e5f, 3e5f));
    for (uint32_t n = 32; n < 35; n++) {
        put(in, n, between(i, n, -3e5f, 3e5f));
    }
    for (uint32_t n = 35; n < 38; n++) {
        put(in, n, i % 3 == n % 3 ? 0.0f : between(i, n, -7e6f, 7e6f));
    }
}

void fill_density(uint32_t i, uint32_t *in) {
    static const float units[] = {0.0f, 1.0f, 0.5f, 0.25f};
    float base = between(i, 1, 0.0f, 8000.0f);
    float top = base + between(i, 2, 50.0f, 9000.0f);
    in[0] = velum_hash_2(i, 3) % 8u;
    put(in, 1, edge_or(i, 4, units, COUNT(units), 0.0f, 1.0f));
    put(in, 2, base);
    put(in, 3, top);
    put(in, 4, exp2f(between(i, 5, -17.0f, -3.0f)));
    put(in, 5, edge_or(i, 6, units, COUNT(units), 0.0f, 1.0f));
    float heights[] = {base, top, base - 1.0f, top + 1.0f, -1e30f, 1e30f, 0.5f * (base + top)};
    put(in, 6, edge_or(i, 7, heights, COUNT(heights), base, top));
    put(in, 7, edge_or(i, 8, units, COUNT(units), 0.0f, 1.0f));
    put(in, 8, edge_or(i, 9, units, COUNT(units), -1.0f, 1.0f));
    put(in, 9, edge_or(i, 10, units, COUNT(units), 0.0f, 1.0f));
    static const float winds[] = {0.0f, 128.0f, -128.0f};
    put(in, 10, edge_or(i, 11, winds, COUNT(winds), -40.0f, 40.0f));
    put(in, 11, edge_or(i, 12, winds, COUNT(winds), -40.0f, 40.0f));
    if (i % 64 == 63) { /* coverage or height that is no number: no cloud */
        put(in, i % 128 == 127 ? 1 : 6, NAN);
    }
}

void fill_cloud(uint32_t i, uint32_t *in) {
    static const float units[] = {0.0f, 1.0f, 0.5f};
    in[0] = velum_hash_2(i, 0) % 6u;
    put(in, 1, edge_or(i, 1, units, COUNT(units), 0.1f, 1.0f));
    put(in, 2, edge_or(i, 2, units, COUNT(units), 0.0f, 1.0f));
    put(in, 3, between(i, 3, 0.01f, 0.99f));
    for (uint32_t n = 4; n < 13; n++) { /* within the period, its ends, beyond it */
        put(in, n, i % 2 ? edge_or(i, n, units, COUNT(units), 0.0f, 1.0f) : between(i, n, -8.0f, 8.0f));
    }
}
