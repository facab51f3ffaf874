#include "synthetic.h"

#include "core/geodesy.h"
#include "core/tile.h"
#include "tests/files.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Rows of numbers of a CSV in tests/data; lines of '#' and the heading are skipped, "nan" is NaN. */
static size_t read_csv(const char *name, double *values, size_t columns, size_t max_rows) {
    char name_in_source[128];
    char path[1024];
    char line[1024];
    size_t rows = 0;
    snprintf(name_in_source, sizeof name_in_source, "tests/data/%s", name);
    FILE *file = fopen(source_path(path, name_in_source), "r");
    assert_non_null(file);
    while (rows < max_rows && fgets(line, sizeof line, file)) {
        char *at = line;
        size_t column = 0;
        if (line[0] == '#' || strstr(line, "lat")) {
            continue;
        }
        for (; column < columns; column++) {
            char *end;
            values[rows * columns + column] = strtod(at, &end);
            if (end == at) {
                break;
            }
            at = *end == ',' ? end + 1 : end;
        }
        assert_int_equal(column, columns);
        rows++;
    }
    fclose(file);
    return rows;
}

static void ecef_and_geodetic_agree_with_the_reference(void **unused) {
    (void)unused;
    double rows[64][9];
    size_t count = read_csv("wgs84_ecef.csv", &rows[0][0], 9, 64);
    double worst = 0.0;
    assert_true(count >= 15);
    for (size_t i = 0; i < count; i++) {
        core_geodetic place = {rows[i][0], rows[i][1], rows[i][2]};
        core_geodetic back;
        double ecef[3];
        double closed[3];
        double normal[3];
        assert_true(core_ecef_from_geodetic(&place, ecef));
        core_normal(place.lat_deg, place.lon_deg, normal);
        core_position(normal, place.height_m, closed);
        for (int k = 0; k < 3; k++) {
            worst = fmax(worst, fabs(ecef[k] - rows[i][3 + k]));
            worst = fmax(worst, fabs(closed[k] - rows[i][3 + k]));
        }
        assert_true(core_geodetic_from_ecef(ecef, &back));
        assert_true(fabs(back.lat_deg - place.lat_deg) < 1e-11);
        assert_true(fabs(back.height_m - place.height_m) < 1e-7);
    }
    print_message("%zu places to ECEF: within %.1e m\n", count, worst);
    assert_true(worst < 5e-8); /* 35,786 km up a double has 7e-9 m */
}

static void geodesics_agree_with_the_reference(void **unused) {
    (void)unused;
    double rows[32][10];
    size_t count = read_csv("geodtest_extract.csv", &rows[0][0], 10, 32);
    assert_true(count >= 10);
    for (size_t i = 0; i < count; i++) {
        double distance;
        double azimuth;
        double lat;
        double lon;
        assert_true(core_geodesic_inverse(rows[i][0], rows[i][1], rows[i][3], rows[i][4], &distance, &azimuth));
        assert_true(fabs(distance - rows[i][6]) < 2e-7);
        if (isnan(rows[i][2])) {
            continue;
        }
        assert_true(core_geodesic_direct(rows[i][0], rows[i][1], rows[i][2], rows[i][6], &lat, &lon));
        assert_true(core_geodesic_inverse(lat, lon, rows[i][3], rows[i][4], &distance, &azimuth));
        assert_true(distance < 2e-6);
    }
}

static void what_is_not_finite_is_refused(void **unused) {
    (void)unused;
    const double bad[3] = {NAN, 0.0, 0.0};
    const double centre[3] = {0.0, 0.0, 0.0};
    core_geodetic place = {91.0, 0.0, 0.0};
    double ecef[3];
    double x;
    double y;
    velum_eye_geometry eye;
    assert_false(core_geodetic_from_ecef(bad, &place));
    assert_false(core_eye_geometry(bad, &eye));
    assert_false(core_eye_geometry(centre, &eye));
    place.lat_deg = NAN;
    assert_false(core_ecef_from_geodetic(&place, ecef));
    place.lat_deg = 10.0;
    place.height_m = INFINITY;
    assert_false(core_ecef_from_geodetic(&place, ecef));
    assert_false(core_geodesic_inverse(0.0, 0.0, NAN, 0.0, &x, &y));
    assert_false(core_geodesic_direct(0.0, 0.0, INFINITY, 1.0, &x, &y));
}

/* Within 0.4 mm at 20 km, at every latitude. */
static void the_scaled_sphere_gives_heights(void **unused) {
    (void)unused;
    const double heights[] = {-500.0, 0.0, 1000.0, 10000.0, 20000.0};
    for (size_t h = 0; h < sizeof heights / sizeof *heights; h++) {
        double worst = 0.0;
        for (int k = -900; k <= 900; k++) {
            core_geodetic place = {0.1 * k, 37.0, heights[h]};
            double ecef[3];
            assert_true(core_ecef_from_geodetic(&place, ecef));
            worst = fmax(worst, fabs(core_height_scaled(ecef) - heights[h]));
        }
        print_message("height by the scaled sphere at %6.0f m, all latitudes: within %.3f mm\n", heights[h],
                      1e3 * worst);
        assert_true(worst < 4.2e-4);
    }
}

/* velum_place_at over rays of 500 km, from eyes everywhere, against GeographicLib. */
static void floats_know_height_and_normal(void **unused) {
    (void)unused;
    const double lats[] = {-90.0, -89.999, -60.0, -33.3, 0.0, 12.0, 45.0, 71.0, 89.99, 90.0};
    const double lons[] = {-180.0, -90.0, 0.0, 8.55, 135.0, 179.9999};
    const double heights[] = {2.0, 300.0, 3000.0, 11000.0, 20000.0};
    double at_eye = 0.0;
    double at_50_km = 0.0;
    double at_500_km = 0.0;
    double turned = 0.0;
    for (size_t i = 0; i < 10 * 6 * 5; i++) {
        core_geodetic place = {lats[i % 10], lons[i / 10 % 6], heights[i / 60]};
        core_geodetic found;
        velum_eye_geometry eye;
        double from[3];
        double up[3];
        double east[3];
        double north[3];
        assert_true(core_ecef_from_geodetic(&place, from));
        assert_true(core_eye_geometry(from, &eye));
        at_eye = fmax(at_eye, fabs((double)velum_place_at(eye, 0.0f, 0.0f, 0.0f).height_m - place.height_m));
        core_normal(place.lat_deg, place.lon_deg, up);
        core_east_north(up, east, north);
        for (int ray = 0; ray < 96; ray++) {
            double azimuth = 2.0 * CORE_PI * (ray % 16) / 16.0;
            double distance = ray / 16 < 3 ? 50000.0 * (ray / 16 + 1) / 3.0 : 500000.0 * (ray / 16 - 2) / 3.0;
            /* Down and up again: to the heights of weather over the curved ground. */
            double rise = (ray % 3) * 5000.0 - distance * distance / (2.0 * CORE_RADIUS_M);
            float r[3];
            double to[3];
            double normal[3];
            double cross = 0.0;
            for (int k = 0; k < 3; k++) {
                r[k] = (float)(distance * (cos(azimuth) * north[k] + sin(azimuth) * east[k]) + rise * up[k]);
                to[k] = from[k] + (double)r[k];
            }
            velum_place there = velum_place_at(eye, r[0], r[1], r[2]);
            assert_true(core_geodetic_from_ecef(to, &found));
            core_normal(found.lat_deg, found.lon_deg, normal);
            double error = fabs((double)there.height_m - found.height_m);
            *(distance > 50001.0 ? &at_500_km : &at_50_km) = fmax(distance > 50001.0 ? at_500_km : at_50_km, error);
            cross = hypot(hypot((double)there.ny * normal[2] - (double)there.nz * normal[1],
                                (double)there.nz * normal[0] - (double)there.nx * normal[2]),
                          (double)there.nx * normal[1] - (double)there.ny * normal[0]);
            turned = fmax(turned, cross);
        }
    }
    print_message("velum_place_at: eye %.4f m, to 50 km %.4f m, to 500 km %.4f m; normal %.1e rad\n", at_eye, at_50_km,
                  at_500_km, turned);
    assert_true(at_eye < 0.05);
    assert_true(at_50_km < 0.2);
    assert_true(at_500_km < 10.0);
    assert_true(turned < 1e-6);
}

static void faces_and_normals_are_inverse(void **unused) {
    (void)unused;
    uint64_t seed = 1;
    double worst = 0.0;
    for (int i = 0; i < 60000; i++) {
        uint32_t face = (uint32_t)i % 6u;
        double u = 1.998 * random_unit(&seed) - 0.999;
        double v = 1.998 * random_unit(&seed) - 0.999;
        double n[3];
        core_face_normal(face, u, v, n);
        assert_true(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0) < 1e-14);
        velum_face_place place = velum_face_of((float)n[0], (float)n[1], (float)n[2]);
        assert_int_equal(place.face, face);
        worst = fmax(worst, fmax(fabs((double)place.u - u), fabs((double)place.v - v)));
    }
    print_message("face coordinates there and back: within %.1e (%.2f m)\n", worst, worst * 5e6);
    assert_true(worst < 4e-7);
}

static void keys_and_levels(void **unused) {
    (void)unused;
    uint64_t seed = 2;
    for (int i = 0; i < 2000; i++) {
        uint32_t level = (uint32_t)(13.0 * random_unit(&seed));
        uint32_t face = (uint32_t)(6.0 * random_unit(&seed));
        uint32_t x = (uint32_t)(random_unit(&seed) * (1u << level));
        uint32_t y = (uint32_t)(random_unit(&seed) * (1u << level));
        uint32_t key = velum_tile_key(level, face, x, y);
        double n[3];
        assert_true(key != VELUM_TILE_KEY_NONE);
        assert_int_equal(velum_tile_key_level(key), level);
        assert_int_equal(velum_tile_key_face(key), face);
        assert_int_equal(velum_tile_key_x(key), x);
        assert_int_equal(velum_tile_key_y(key), y);
        core_tile_normal(key, 0.5, 0.5, n);
        velum_face_place place = velum_face_of((float)n[0], (float)n[1], (float)n[2]);
        assert_int_equal(place.face, face);
        assert_int_equal((uint32_t)velum_tile_coordinate(place.u, level), x);
        assert_int_equal((uint32_t)velum_tile_coordinate(place.v, level), y);
        if (level > 0) {
            assert_int_equal(core_tile_ancestor(key, level - 1), velum_tile_key(level - 1, face, x / 2, y / 2));
        }
        assert_int_equal(core_tile_ancestor(key, 12), key);
    }
    uint32_t last = VELUM_TILE_LEVEL_MAX;
    for (double d = 1.0; d < 3e7; d *= 1.01) {
        uint32_t level = velum_tile_level((float)d, 1.0f);
        double side = core_tile_texel_m(level) * VELUM_TILE_TEXELS;
        assert_true(level <= last);
        last = level;
        if (level < VELUM_TILE_LEVEL_MAX && d < 3.9e7) {
            assert_true(side >= 0.1249 * d && side <= 0.2501 * d);
        } else {
            assert_true(side >= 0.1249 * d);
        }
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(ecef_and_geodetic_agree_with_the_reference),
        cmocka_unit_test(geodesics_agree_with_the_reference),
        cmocka_unit_test(what_is_not_finite_is_refused),
        cmocka_unit_test(the_scaled_sphere_gives_heights),
        cmocka_unit_test(floats_know_height_and_normal),
        cmocka_unit_test(faces_and_normals_are_inverse),
        cmocka_unit_test(keys_and_levels),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
