/* Shadow maps over frames: fixed to the world, renewed a little in each frame, following the sun. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fixture.h"

static void shadow_map_is_fixed_to_the_world(void **state) {
    (void)state;
    enum { TEXELS = 64 };
    static float one[TEXELS * TEXELS], two[TEXELS * TEXELS];
    fixture f;
    fixture_init(&f, false);
    velum_layer cumulus = fixture_cumulus();
    fixture_commit(&f, &cumulus, 1);
    velum_shadow *shadow = NULL;
    const velum_shadow_desc desc = {.struct_size = sizeof desc, .levels = 1, .texels = TEXELS, .extent_m = 8192.0f};
    assert_int_equal(f.engine_api->create_shadow(f.engine, &desc, &shadow), VELUM_OK);
    double east[3], north[3], up[3], sun[3];
    fixture_axes(50.0, 8.5, east, north, up);
    for (int i = 0; i < 3; i++) {
        sun[i] = 0.8 * up[i] + 0.6 * north[i];
    }
    velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_EARTH);
    velum_shadow_frame where = {.struct_size = sizeof where};
    velum_shadow_geometry geometry[2] = {{.struct_size = sizeof geometry[0]}, {.struct_size = sizeof geometry[0]}};
    fixture_position(50.0, 8.5, 0.0, where.centre_ecef_m);
    assert_int_equal(f.standalone_api->render_shadow(f.engine, &frame, shadow, &where, one, TEXELS * TEXELS), VELUM_OK);
    assert_int_equal(f.engine_api->get_shadow_geometry(shadow, &geometry[0]), VELUM_OK);
    /* Four texels along u: the same values, four columns on. */
    for (int i = 0; i < 3; i++) {
        where.centre_ecef_m[i] += 4.0 * 128.0 * (double)geometry[0].block.axis_u[i];
    }
    assert_int_equal(f.standalone_api->render_shadow(f.engine, &frame, shadow, &where, two, TEXELS * TEXELS), VELUM_OK);
    assert_int_equal(f.engine_api->get_shadow_geometry(shadow, &geometry[1]), VELUM_OK);
    double worst = 0.0;
    double least = 1.0;
    for (int y = 0; y < TEXELS; y++) {
        for (int x = 0; x + 4 < TEXELS; x++) {
            worst = fmax(worst, fabs((double)one[y * TEXELS + x + 4] - (double)two[y * TEXELS + x]));
            least = fmin(least, (double)two[y * TEXELS + x]);
        }
    }
    assert_true(least < 0.5);
    assert_true(worst < 0.02);
    /* A hundredth of a texel, or a climb: nothing is drawn. */
    assert_int_equal(f.standalone_api->render_shadow(f.engine, &frame, shadow, &where, one, TEXELS * TEXELS),
                     VELUM_UNCHANGED);
    for (int i = 0; i < 3; i++) {
        where.centre_ecef_m[i] += 1.28 * (double)geometry[0].block.axis_v[i];
    }
    assert_int_equal(f.standalone_api->render_shadow(f.engine, &frame, shadow, &where, one, TEXELS * TEXELS),
                     VELUM_UNCHANGED);
    assert_int_equal(f.engine_api->destroy_shadow(shadow), VELUM_OK);
    fixture_finish(&f);
}

enum { LEVELS = 2, SIDE = 128, ALL = LEVELS * SIDE * SIDE, POINTS = 48 };
#define EXTENT_M 1024.0
#define WIND_M_S 60.0f

/* A place with a shadow map, and a sun that goes round its vertical, where `frame` is. */
typedef struct sundial {
    fixture f;
    velum_frame_info frame;
    velum_shadow_frame where;
    double east[3], north[3], up[3];
    double azimuth_rad;
} sundial;

static void sundial_sun(sundial *d) {
    for (int i = 0; i < 3; i++) {
        d->frame.sun_direction_ecef[i] =
            0.7 * d->up[i] + sqrt(0.51) * (cos(d->azimuth_rad) * d->east[i] + sin(d->azimuth_rad) * d->north[i]);
    }
}

static void sundial_init(sundial *d) {
    *d = (sundial){.where = {.struct_size = sizeof d->where}};
    fixture_init(&d->f, false);
    velum_layer cumulus = fixture_cumulus();
    cumulus.wind_east_m_s = WIND_M_S;
    fixture_commit(&d->f, &cumulus, 1);
    fixture_axes(50.0, 8.5, d->east, d->north, d->up);
    fixture_position(50.0, 8.5, 0.0, d->where.centre_ecef_m);
    d->frame = fixture_frame(d->up, 0.0, VELUM_ATMOSPHERE_EARTH);
    sundial_sun(d);
}

static velum_shadow *sundial_map(const sundial *d) {
    velum_shadow *map = NULL;
    const velum_shadow_desc desc = {
        .struct_size = sizeof desc, .levels = LEVELS, .texels = SIDE, .extent_m = (float)EXTENT_M};
    assert_int_equal(d->f.engine_api->create_shadow(d->f.engine, &desc, &map), VELUM_OK);
    return map;
}

static velum_result sundial_draw(const sundial *d, velum_shadow *map, float *texels, velum_shadow_geometry *geometry) {
    velum_result result = d->f.standalone_api->render_shadow(d->f.engine, &d->frame, map, &d->where, texels, ALL);
    *geometry = (velum_shadow_geometry){.struct_size = sizeof *geometry};
    assert_int_equal(d->f.engine_api->get_shadow_geometry(map, geometry), VELUM_OK);
    return result;
}

/* As velum_shadow.glsl finds it in one level. */
static double shadow_at(const float *texels, const velum_shadow_geometry *g, uint32_t level, const double at_m[3]) {
    double place[2] = {0.0, 0.0};
    for (int i = 0; i < 3; i++) {
        place[0] += (at_m[i] - g->origin_ecef_m[i]) * (double)g->block.axis_u[i];
        place[1] += (at_m[i] - g->origin_ecef_m[i]) * (double)g->block.axis_v[i];
    }
    uint32_t first[2];
    double part[2];
    for (int i = 0; i < 2; i++) {
        double x = (place[i] / (double)g->block.level[level][0] + (double)g->block.level[level][1 + i]) * SIDE - 0.5;
        assert_true(x > 0.0 && x < SIDE - 1);
        first[i] = (uint32_t)x;
        part[i] = x - floor(x);
    }
    const float *t = texels + ((size_t)level * SIDE + first[1]) * SIDE + first[0];
    return (1.0 - part[1]) * ((1.0 - part[0]) * (double)t[0] + part[0] * (double)t[1]) +
           part[1] * ((1.0 - part[0]) * (double)t[SIDE] + part[0] * (double)t[SIDE + 1]);
}

/* Mean difference of what two maps say of places on the ground, over most of a level. */
static double difference(const sundial *d, uint32_t level, const float *a, const velum_shadow_geometry *of_a,
                         const float *b, const velum_shadow_geometry *of_b) {
    const double reach_m = 0.25 * EXTENT_M * (level ? 4.0 : 1.0);
    double sum = 0.0;
    for (int k = 0; k < POINTS * POINTS; k++) {
        const double x = reach_m * (2.0 * (k % POINTS) / (POINTS - 1) - 1.0);
        const double y = reach_m * (2.0 * (k / POINTS) / (POINTS - 1) - 1.0);
        double at_m[3];
        for (int i = 0; i < 3; i++) {
            at_m[i] = d->where.centre_ecef_m[i] + x * d->east[i] + y * d->north[i];
        }
        sum += fabs(shadow_at(a, of_a, level, at_m) - shadow_at(b, of_b, level, at_m));
    }
    return sum / (POINTS * POINTS);
}

static double sun_astray(const sundial *d, const velum_shadow_geometry *g) {
    double sum = 0.0;
    for (int i = 0; i < 3; i++) {
        double lag = d->frame.sun_direction_ecef[i] - (double)g->block.sun[i];
        sum += lag * lag;
    }
    return sqrt(sum);
}

/* The sun turns by 0.3 degrees over 100 frames: the map turns with it, is where a new one would be, and costs the bands
 * of its levels and the strips that come into sight. */
static void maps_follow_the_sun(void **state) {
    (void)state;
    enum { FRAMES = 100 };
    const double turned_rad = 0.0056;
    float *texels = calloc(4, ALL * sizeof *texels);
    assert_non_null(texels);
    float *followed = texels, *begun = texels + ALL, *anew = texels + 2 * ALL, *earlier = texels + 3 * ALL;
    sundial d;
    velum_shadow_geometry of_followed, of_begun, of_anew, of_earlier;
    sundial_init(&d);
    velum_shadow *map = sundial_map(&d);
    assert_int_equal(sundial_draw(&d, map, begun, &of_begun), VELUM_OK);
    assert_int_equal(fixture_shadow_texels(map), ALL);
    uint64_t newest = ALL, most = 0;
    uint32_t turns = 0;
    double step[2] = {0.0, 0.0}; /* greatest change from frame to frame; when the map turns */
    memcpy(followed, begun, ALL * sizeof *followed);
    of_followed = of_begun;
    for (int i = 1; i <= FRAMES; i++) {
        memcpy(earlier, followed, ALL * sizeof *earlier);
        of_earlier = of_followed;
        d.azimuth_rad = turned_rad / sqrt(0.51) * i / FRAMES;
        d.frame.time_s = i / 60.0;
        sundial_sun(&d);
        assert_int_equal(sundial_draw(&d, map, followed, &of_followed), VELUM_OK);
        assert_true(sun_astray(&d, &of_followed) < 0.00176);
        const bool has_turned = of_followed.block.sun[0] != of_earlier.block.sun[0];
        turns += has_turned;
        const double changed = difference(&d, 0, followed, &of_followed, earlier, &of_earlier);
        step[has_turned] = fmax(step[has_turned], changed);
        const uint64_t drawn = fixture_shadow_texels(map) - newest;
        newest += drawn;
        most = drawn > most ? drawn : most;
    }
    assert_int_equal(turns, 3);
    /* No more is seen of a turn than of the wind. */
    assert_true(step[0] > 0.0 && step[1] < step[0]);
    /* Half a second renews the finer level, two the coarser; then strips of a sixteenth come into sight. */
    assert_true(most <= 3 * ALL / 16);
    const double renewed = SIDE * SIDE * FRAMES / 60.0 * (1.0 / 0.5 + 1.0 / 2.0);
    assert_true((double)(newest - ALL) > 0.8 * renewed && (double)(newest - ALL) < 1.5 * renewed);
    velum_shadow *new_map = sundial_map(&d);
    double stayed[LEVELS];
    assert_int_equal(sundial_draw(&d, new_map, anew, &of_anew), VELUM_OK);
    for (uint32_t level = 0; level < LEVELS; level++) {
        const double astray = difference(&d, level, followed, &of_followed, anew, &of_anew);
        stayed[level] = difference(&d, level, begun, &of_begun, anew, &of_anew);
        assert_true(stayed[level] > 0.05);
        assert_true(astray < 0.5 * stayed[level]);
    }
    /* At rest it is renewed, then left: as a new one for the sun that it stands at, but for where their texels lie: no
     * farther off than a texel's shift would be, by what the wind's way made of the first map. */
    const double blown_m = (double)WIND_M_S * FRAMES / 60.0;
    velum_result result = VELUM_OK;
    for (int i = 0; i < 18 && result == VELUM_OK; i++) {
        result = sundial_draw(&d, map, followed, &of_followed);
    }
    assert_int_equal(result, VELUM_UNCHANGED);
    for (int i = 0; i < 3; i++) {
        d.frame.sun_direction_ecef[i] = (double)of_followed.block.sun[i];
    }
    velum_shadow *there = sundial_map(&d);
    assert_int_equal(sundial_draw(&d, there, anew, &of_anew), VELUM_OK);
    for (uint32_t level = 0; level < LEVELS; level++) {
        const double astray = difference(&d, level, followed, &of_followed, anew, &of_anew);
        const double texel_m = EXTENT_M / SIDE * (level ? 4.0 : 1.0);
        assert_true(astray < texel_m / blown_m * stayed[level]);
    }
    assert_int_equal(d.f.engine_api->destroy_shadow(map), VELUM_OK);
    assert_int_equal(d.f.engine_api->destroy_shadow(new_map), VELUM_OK);
    assert_int_equal(d.f.engine_api->destroy_shadow(there), VELUM_OK);
    free(texels);
    fixture_finish(&d.f);
}

/* Steps of any length: every row has its turn, also where a band would pass the last one. */
static void no_row_is_left_out(void **state) {
    (void)state;
    enum { WIDE = 256, WIDE_ALL = WIDE * WIDE };
    float *texels = calloc(2, WIDE_ALL * sizeof *texels);
    assert_non_null(texels);
    float *played = texels, *anew = texels + WIDE_ALL;
    sundial d;
    sundial_init(&d);
    const velum_shadow_desc desc = {.struct_size = sizeof desc, .levels = 1, .texels = WIDE, .extent_m = 8192.0f};
    velum_shadow *map = NULL, *new_map = NULL;
    assert_int_equal(d.f.engine_api->create_shadow(d.f.engine, &desc, &map), VELUM_OK);
    velum_result result = VELUM_OK;
    /* An odd number of half bands, then whole ones; then rest. */
    for (int i = 0; i < 48 && result == VELUM_OK; i++) {
        d.frame.time_s += i < 2 ? 1.0 / 60.0 : i < 30 ? 1.0 / 25.0 : 0.0;
        result = d.f.standalone_api->render_shadow(d.f.engine, &d.frame, map, &d.where, played, WIDE_ALL);
    }
    assert_int_equal(result, VELUM_UNCHANGED);
    assert_int_equal(d.f.engine_api->create_shadow(d.f.engine, &desc, &new_map), VELUM_OK);
    assert_int_equal(d.f.standalone_api->render_shadow(d.f.engine, &d.frame, new_map, &d.where, anew, WIDE_ALL),
                     VELUM_OK);
    assert_memory_equal(played, anew, WIDE_ALL * sizeof *played);
    assert_int_equal(d.f.engine_api->destroy_shadow(map), VELUM_OK);
    assert_int_equal(d.f.engine_api->destroy_shadow(new_map), VELUM_OK);
    free(texels);
    fixture_finish(&d.f);
}

/* By a degree: that is another sun, and all is drawn for it. */
static void another_sun_is_drawn_at_once(void **state) {
    (void)state;
    float *texels = calloc(1, ALL * sizeof *texels);
    assert_non_null(texels);
    sundial d;
    velum_shadow_geometry geometry;
    sundial_init(&d);
    velum_shadow *map = sundial_map(&d);
    assert_int_equal(sundial_draw(&d, map, texels, &geometry), VELUM_OK);
    d.azimuth_rad = 0.02;
    sundial_sun(&d);
    assert_int_equal(sundial_draw(&d, map, texels, &geometry), VELUM_OK);
    assert_int_equal(fixture_shadow_texels(map), 2 * ALL);
    assert_true(sun_astray(&d, &geometry) < 1e-6);
    assert_int_equal(d.f.engine_api->destroy_shadow(map), VELUM_OK);
    free(texels);
    fixture_finish(&d.f);
}

/* Root of the mean square of what a new map says of places on the ground, less what the world says of their lines to
 * the sun. */
static double map_error(fixture *f) {
    enum { TEXELS = 128, PLACES = 24 };
    static float texels[TEXELS * TEXELS];
    double east[3], north[3], up[3], sun[3];
    fixture_axes(50.0, 8.5, east, north, up);
    for (int i = 0; i < 3; i++) {
        sun[i] = 0.5 * up[i] + sqrt(0.75) * north[i];
    }
    const velum_frame_info frame = fixture_frame(sun, 0.0, VELUM_ATMOSPHERE_EARTH);
    velum_shadow_frame where = {.struct_size = sizeof where};
    velum_shadow_geometry g = {.struct_size = sizeof g};
    velum_shadow *map = NULL;
    const velum_shadow_desc desc = {.struct_size = sizeof desc, .levels = 1, .texels = TEXELS, .extent_m = 32768.0f};
    fixture_position(50.0, 8.5, 0.0, where.centre_ecef_m);
    assert_int_equal(f->engine_api->create_shadow(f->engine, &desc, &map), VELUM_OK);
    assert_int_equal(f->standalone_api->render_shadow(f->engine, &frame, map, &where, texels, TEXELS * TEXELS),
                     VELUM_OK);
    assert_int_equal(f->engine_api->get_shadow_geometry(map, &g), VELUM_OK);
    assert_int_equal(f->engine_api->destroy_shadow(map), VELUM_OK);
    double sum = 0.0;
    for (int k = 0; k < PLACES * PLACES; k++) {
        /* The middles of texels: between them a map tells the mean of four. */
        const double u = ((k % PLACES * 4 + 16) + 0.5) / TEXELS - (double)g.block.level[0][1];
        const double v = ((k / PLACES * 4 + 16) + 0.5) / TEXELS - (double)g.block.level[0][2];
        velum_line_query line = {.struct_size = sizeof line, .footprint_m = 20.0};
        velum_line_answer answer = {.struct_size = sizeof answer};
        double along = 0.0, from2 = 0.0, plane[3];
        for (int i = 0; i < 3; i++) {
            plane[i] = g.origin_ecef_m[i] +
                       (double)g.block.level[0][0] * (u * (double)g.block.axis_u[i] + v * (double)g.block.axis_v[i]);
            along += plane[i] * sun[i];
            from2 += plane[i] * plane[i];
        }
        /* Over a sphere of the place's radius: the ellipsoid is within metres of it here. */
        double radius2 = 0.0;
        for (int i = 0; i < 3; i++) {
            radius2 += where.centre_ecef_m[i] * where.centre_ecef_m[i];
        }
        const double ground_m = -along + sqrt(along * along - from2 + radius2);
        for (int i = 0; i < 3; i++) {
            line.from_ecef_m[i] = plane[i] + ground_m * sun[i];
            line.to_ecef_m[i] = plane[i] + (ground_m + 4.0e4) * sun[i];
        }
        assert_int_equal(f->world_api->query_line(f->world, &line, &answer), VELUM_OK);
        const int x = k % PLACES * 4 + 16, y = k / PLACES * 4 + 16;
        const double off = (double)texels[y * TEXELS + x] - exp(-answer.optical_depth);
        sum += off * off;
    }
    return sqrt(sum / (PLACES * PLACES));
}

/* Layers that lie higher in one place than in another are stepped through by their own thickness: a map of them is held
 * to what one of weather that is the same everywhere is held to. */
static void layers_at_uneven_heights_shade_as_even_ones(void **state) {
    (void)state;
    const velum_layer layers[] = {fixture_layer(VELUM_GENUS_CU, 0.4f, 900.0f, 1500.0f),
                                  fixture_layer(VELUM_GENUS_CU, 0.5f, 5200.0f, 5600.0f),
                                  fixture_layer(VELUM_GENUS_CB, 0.5f, 600.0f, 12000.0f)};
    double error[2];
    for (uint32_t uneven = 0; uneven < 2; uneven++) {
        velum_cell cells[3] = {fixture_cell(&layers[0], 1), fixture_cell(&layers[1], 1), fixture_cell(&layers[2], 1)};
        for (uint32_t i = 1; i < 3; i++) {
            cells[i].id = 1 + i;
            cells[i].kind = VELUM_CELL_RECTANGLE;
            cells[i].lat_deg = i == 1 ? 50.1 : 48.5;
            cells[i].lon_deg = 8.5;
            cells[i].half_east_m = cells[i].half_north_m = i == 1 ? 9000.0 : 20000.0;
            cells[i].transition_m = 6000.0;
        }
        const velum_state_desc desc = {.struct_size = sizeof desc, .cells = cells, .cell_count = uneven ? 3 : 1};
        fixture f;
        uint64_t id;
        fixture_init(&f, false);
        assert_int_equal(f.world_api->commit(f.world, &desc, &id), VELUM_OK);
        error[uneven] = map_error(&f);
        fixture_finish(&f);
    }
    printf("error of maps: even %.4f, uneven %.4f\n", error[0], error[1]);
    /* 24 steps through a layer: 0.024 and 0.055; 16: 0.072 and 0.111; 64: 0.005 and 0.018. */
    assert_true(error[0] > 0.0 && error[0] < 0.08);
    assert_true(error[1] > 0.0 && error[1] < 0.08);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(shadow_map_is_fixed_to_the_world),
                                       cmocka_unit_test(maps_follow_the_sun), cmocka_unit_test(no_row_is_left_out),
                                       cmocka_unit_test(another_sun_is_drawn_at_once),
                                       cmocka_unit_test(layers_at_uneven_heights_shade_as_even_ones)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
