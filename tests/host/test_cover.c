/* Cloud around the eye, as the host asks for it: by a lattice of places, heights and times. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cover.h"

#include <math.h>
#include <stdlib.h>

/* A plugin whose weather is a formula, and which counts what it is asked. */
static double (*coverage_of)(const double position_m[3], double time_s);
static int questions, lines;
static velum_result answered, line_answered;

static velum_result query_point(velum_world *world, const velum_point_query *query, velum_point_answer *out) {
    (void)world;
    questions++;
    out->coverage = (float)coverage_of(query->position_ecef_m, query->time_s);
    return answered;
}

static velum_result query_line(velum_world *world, const velum_line_query *query, velum_line_answer *out) {
    (void)world;
    lines++;
    out->optical_depth = 3 + 7 * coverage_of(query->from_ecef_m, query->time_s);
    return line_answered;
}

static const velum_world_api world_table = {.query_point = query_point, .query_line = query_line};

struct fixture {
    struct scene scene;
    struct cover_answers answers;
};

static int set_up(void **state) {
    struct fixture *f = calloc(1, sizeof *f);
    *state = f;
    if (f) {
        f->scene.plugin.world = &world_table;
        questions = lines = 0;
        answered = line_answered = VELUM_OK;
    }
    return f ? 0 : -1;
}

static int tear_down(void **state) {
    free(*state);
    return 0;
}

static struct cloud_cover around(struct fixture *f, double lat_deg, double lon_deg, double height_m, double time_s) {
    const velum_scenario_camera place = {.lat_deg = lat_deg, .lon_deg = lon_deg};
    struct cloud_cover cover = {-1, -1};
    assert_true(cover_around(&f->scene, &f->answers, &place, height_m, time_s, &cover));
    return cover;
}

static double even(const double position_m[3], double time_s) {
    (void)position_m;
    (void)time_s;
    return 0.625;
}

/* Weights are shares: where all are alike that is the mean, at poles and at the antimeridian too. */
static void even_cover_is_its_own_mean(void **state) {
    static const double places[][2] = {{0, 0}, {50, 8}, {-33, 180}, {12, -180}, {90, 0}, {-90, 45}, {89.99, -170}};
    coverage_of = even;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        const struct cloud_cover cover = around(*state, places[i][0], places[i][1], 777, 333);
        assert_true(fabs(cover.coverage - 0.625) < 1e-9);
        assert_true(fabs(cover.optical_depth - 7.375) < 1e-9);
    }
}

static double by_time(const double position_m[3], double time_s) {
    (void)position_m;
    return 0.5 + 0.001 * time_s;
}

/* Between heights and times of the lattice it is linear: what changes steadily is exact, before time 0 too. */
static void what_changes_steadily_is_exact(void **state) {
    coverage_of = by_time;
    for (double time_s = -45; time_s < 130; time_s += 3.7) {
        const struct cloud_cover cover = around(*state, 50, 8, 900 + time_s, time_s);
        assert_true(fabs(cover.coverage - (0.5 + 0.001 * time_s)) < 1e-6);
    }
}

static double by_height(const double position_m[3], double time_s) {
    double at_sea_m[3];
    (void)time_s;
    scene_point(0, 0, 0, at_sea_m);
    return 0.1 + 1e-4 * (position_m[0] - at_sea_m[0]);
}

/* At the equator, where metres along ECEF's first axis are metres of height but for the fall of the lattice's places
 * round the planet, which a place's own mean knows. */
static void height_is_that_of_the_eye(void **state) {
    coverage_of = by_height;
    const double low = around(*state, 0, 0, 250, 0).coverage;
    for (double height_m = 300; height_m < 3000; height_m += 123) {
        const struct cloud_cover cover = around(*state, 0, 0, height_m, 0);
        assert_true(fabs(cover.coverage - low - 1e-4 * (height_m - 250)) < 1e-5);
        assert_true(fabs(cover.optical_depth - 3 - 7 * cover.coverage) < 1e-5);
    }
}

/* Over all cloud there is no line to ask for. */
static void over_all_cloud_no_line_is_asked(void **state) {
    coverage_of = even;
    const struct cloud_cover cover = around(*state, 10, 20, 30000, 0);
    assert_true(cover.optical_depth == 0 && questions > 0 && lines == 0);
}

static double by_longitude(const double position_m[3], double time_s) {
    (void)time_s;
    return 0.5 + 4 * (atan2(position_m[1], position_m[0]) - 0.3);
}

/* Places lie about the eye, as far to either side of it at any latitude: the mean of what rises to the east is near
 * what it is at the eye, and follows it. */
static void places_lie_about_the_eye(void **state) {
    coverage_of = by_longitude;
    for (double lat_deg = -60; lat_deg <= 60; lat_deg += 30) {
        for (double east = -0.02; east <= 0.02; east += 0.004) {
            const double coverage = around(*state, lat_deg, (0.3 + east) * 57.29577951308232, 500, 0).coverage;
            assert_true(fabs(coverage - 0.5 - 4 * east) < 2e-4);
        }
    }
}

static double by_place(const double position_m[3], double time_s) {
    (void)time_s;
    return 0.5 + 0.5 * sin(position_m[0] / 700) * sin(position_m[1] / 900) * sin(position_m[2] / 800);
}

/* Clouds that pass one by one do not flicker in the light of everything: 8 m a frame at 250 m/s. */
static void a_flight_sees_no_jumps(void **state) {
    double last = -1, most = 0;
    coverage_of = by_place;
    for (int frame = 0; frame < 600; frame++) {
        const double coverage = around(*state, 50 + frame * 7.2e-5, 8, 500 + frame, frame / 30.0).coverage;
        most = frame > 0 ? fmax(most, fabs(coverage - last)) : 0;
        last = coverage;
    }
    assert_true(last > 0 && most > 0 && most < 1e-4);
}

/* A place is asked once; what the next tick wants is asked before it comes, a few places a frame. */
static void questions_are_few_and_spread(void **state) {
    int most = 0, all;
    coverage_of = by_place;
    around(*state, 50, 8, 600, 1);
    all = questions;
    assert_in_range((uintmax_t)all, 1, COVER_ANSWERS);
    around(*state, 50, 8, 600, 1);
    assert_in_range((uintmax_t)(questions - all), 0, 2); /* of the next tick */
    for (int frame = 1; frame < 30 * 100; frame++) {
        const int before = questions;
        around(*state, 50, 8, 600, 1 + frame / 30.0);
        most = questions - before > most ? questions - before : most;
    }
    assert_in_range((uintmax_t)most, 1, 4);
    /* Five ticks more, each of as many places as one of the two that the first frame asked for. */
    assert_in_range((uintmax_t)(questions - all), (uintmax_t)(2 * all), (uintmax_t)(3 * all));
}

/* What the plugin refuses is told, not kept: it is asked again. */
static void a_refusal_is_told(void **state) {
    struct fixture *f = *state;
    const velum_scenario_camera place = {.lat_deg = 50, .lon_deg = 8};
    struct cloud_cover cover;
    coverage_of = even;
    /* On a tick of the lattice nothing is asked early: what is refused is what is needed. */
    for (int k = 0; k < 2; k++) {
        answered = k == 0 ? VELUM_ERROR_STATE : VELUM_OK;
        line_answered = k == 1 ? VELUM_ERROR_STATE : VELUM_OK;
        assert_false(cover_around(&f->scene, &f->answers, &place, 500, 0, &cover));
    }
    line_answered = VELUM_OK;
    const struct cloud_cover found = around(f, 50, 8, 500, 0);
    assert_true(fabs(found.coverage - 0.625) < 1e-9 && fabs(found.optical_depth - 7.375) < 1e-9);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(even_cover_is_its_own_mean, set_up, tear_down),
        cmocka_unit_test_setup_teardown(what_changes_steadily_is_exact, set_up, tear_down),
        cmocka_unit_test_setup_teardown(height_is_that_of_the_eye, set_up, tear_down),
        cmocka_unit_test_setup_teardown(over_all_cloud_no_line_is_asked, set_up, tear_down),
        cmocka_unit_test_setup_teardown(places_lie_about_the_eye, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_flight_sees_no_jumps, set_up, tear_down),
        cmocka_unit_test_setup_teardown(questions_are_few_and_spread, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_refusal_is_told, set_up, tear_down),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
