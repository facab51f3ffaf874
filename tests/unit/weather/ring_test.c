#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

#include <cmocka.h>

#include "ring.h"

static const double pi = 3.14159265358979323846;

static void what_only_touches_is_simple(void **state) {
    (void)state;
    /* a notch whose tip lies on the opposite edge, an edge run back along, a corner used twice */
    static const velum_lat_lon notch[] = {{0, 0}, {0, 2}, {1, 2}, {0, 1}, {1, 0}};
    static const velum_lat_lon spike[] = {{0, 0}, {0, 2}, {0, 3}, {0, 2}, {1, 2}, {1, 0}};
    static const velum_lat_lon corner[] = {{0, 0}, {1, 1}, {0, 2}, {2, 2}, {1, 1}, {2, 0}};
    static const velum_lat_lon rounded[] = {{0, 0}, {0, 2}, {1, 2}, {-4e-7, 1}, {1, 0}};
    velum_lat_lon at = {0};
    assert_int_equal(weather_ring_check(notch, 5, &at), VELUM_OK);
    assert_int_equal(weather_ring_check(spike, 6, &at), VELUM_OK);
    assert_int_equal(weather_ring_check(corner, 6, &at), VELUM_OK);
    assert_int_equal(weather_ring_check(rounded, 5, &at), VELUM_OK);
    assert_int_equal(weather_ring_check(notch, 0, &at), VELUM_OK);
}

/* A coast of many points is simple; let two of its points change places and that is found, wherever it is. */
static void one_crossing_among_many_edges_is_found(void **state) {
    (void)state;
    enum { COUNT = 20000 };
    velum_lat_lon *points = calloc(COUNT, sizeof *points), at = {0};
    assert_non_null(points);
    for (int turn = 0; turn < 3; turn++) {
        for (int i = 0; i < COUNT; i++) {
            double angle = 2 * pi * i / COUNT;
            double radius = 10 + sin(37 * angle) + 0.1 * sin(531 * angle) + (i % 2 ? 0.002 : 0);
            points[i] = (velum_lat_lon){.lat_deg = radius * sin(angle), .lon_deg = radius * cos(angle)};
        }
        assert_int_equal(weather_ring_check(points, COUNT, &at), VELUM_OK);
        int first = turn * 9997 + 1;
        velum_lat_lon moved = points[first];
        points[first] = points[first + 2];
        points[first + 2] = moved;
        assert_int_equal(weather_ring_check(points, COUNT, &at), VELUM_ERROR_ARGUMENT);
        assert_true(hypot(at.lat_deg - moved.lat_deg, at.lon_deg - moved.lon_deg) < 0.1);
    }
    free(points);
}

/* Long edges side by side, whose boxes all overlap: the search ends all the same. */
static void dense_rings_end(void **state) {
    (void)state;
    enum { COUNT = 200000 };
    velum_lat_lon *points = calloc(COUNT, sizeof *points), at = {0};
    assert_non_null(points);
    for (int i = 0; i < COUNT; i++) {
        points[i] = (velum_lat_lon){.lat_deg = (i % 2 ? 80 : -80) + i * 1e-5, .lon_deg = (i % 2 ? 90 : -90)};
    }
    (void)weather_ring_check(points, COUNT, &at);
    free(points);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_only_touches_is_simple),
        cmocka_unit_test(one_crossing_among_many_edges_is_found),
        cmocka_unit_test(dense_rings_end),
    };
    return cmocka_run_group_tests_name("ring", tests, NULL, NULL);
}
