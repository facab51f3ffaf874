/* "velum.world/1" in the hands of a careless host: the right error, a line in the log before it, nothing changed. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "misuse.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
static const double NONE = (double)INFINITY;

static test_host host;

/* A world with one state, and all that a call may be given. */
typedef struct fixture {
    velum_world *world;
    uint64_t state;
    velum_layer layer;
    velum_lat_lon points[8];
    uint32_t ring_sizes[2];
    velum_cell cell;
    velum_cell nodes[4];
    velum_grid grid;
    velum_state_desc desc;
    velum_timeline_key keys[2];
    uint32_t key_count, key_stride;
    velum_prepare_eye eye;
    velum_prepare_info prepare;
    velum_point_query point;
    velum_point_answer point_answer;
    velum_line_query line;
    velum_line_answer line_answer;
    uint64_t out_state;
    bool retire; /* what a legal commit made, at once */
} fixture;

static void snapshot(void *context, void *out) {
    fixture *f = context;
    velum_world_info info = {.struct_size = sizeof info};
    if (host.world->get_info(f->world, &info) != VELUM_OK) {
        info.struct_size = 0;
    }
    memcpy(out, &info, sizeof info);
    memcpy((char *)out + sizeof info, &f->out_state, sizeof f->out_state);
}

static void fixture_init(fixture *f, int32_t kind) {
    *f = (fixture){.out_state = 12345, .retire = true};
    f->world = test_host_create_world(&host, 1);
    assert_non_null(f->world);
    f->state = test_host_commit_overcast(&host, f->world, 0.5f);
    assert_true(f->state > 0);
    f->layer = (velum_layer){.struct_size = sizeof f->layer,
                             .genus = VELUM_GENUS_CU,
                             .coverage = 0.4f,
                             .base_m = 1000.0f,
                             .top_m = 2000.0f,
                             .water_g_m3 = 0.3f,
                             .radius_um = 10.0f,
                             .precipitation = VELUM_PRECIPITATION_RAIN};
    static const velum_lat_lon points[8] = {{10, 10}, {10, 20}, {20, 20}, {20, 10},
                                            {13, 13}, {13, 17}, {17, 17}, {17, 13}};
    memcpy(f->points, points, sizeof points);
    f->ring_sizes[0] = f->ring_sizes[1] = 4;
    f->cell = (velum_cell){.struct_size = sizeof f->cell,
                           .flags = VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY | VELUM_CELL_HAS_WIND |
                                    VELUM_CELL_HAS_PRECIPITATION | VELUM_CELL_HAS_TEMPERATURE,
                           .id = 9,
                           .kind = kind,
                           .lat_deg = 50.0,
                           .lon_deg = 8.0,
                           .half_east_m = 20000.0,
                           .half_north_m = 10000.0,
                           .layers = &f->layer,
                           .layer_count = 1,
                           .visibility_m = 9999.0f,
                           .temperature_k = 288.0f,
                           .dew_point_k = 280.0f};
    if (kind == VELUM_CELL_POLYGON) {
        f->cell.points = f->points;
        f->cell.point_count = 8;
        f->cell.ring_count = 2;
        f->cell.ring_sizes = f->ring_sizes;
    }
    f->desc = (velum_state_desc){.struct_size = sizeof f->desc, .cells = &f->cell, .cell_count = 1};
    for (size_t i = 0; i < 4; i++) {
        f->nodes[i] = (velum_cell){
            .struct_size = sizeof f->nodes[i], .flags = VELUM_CELL_HAS_LAYERS, .layers = &f->layer, .layer_count = 1};
    }
    f->grid = (velum_grid){.struct_size = sizeof f->grid,
                           .lat_first_deg = 40.0,
                           .lat_step_deg = 2.5,
                           .lon_step_deg = 2.5,
                           .columns = 2,
                           .rows = 2,
                           .cells = f->nodes};
    for (size_t i = 0; i < 2; i++) {
        f->keys[i] = (velum_timeline_key){.struct_size = sizeof f->keys[i],
                                          .time_s = 100.0 * (double)i,
                                          .transition_s = 10.0 * (double)i,
                                          .state = f->state};
    }
    f->key_count = 2;
    f->eye = (velum_prepare_eye){.struct_size = sizeof f->eye};
    test_ecef(50.0, 8.0, 300.0, f->eye.position_ecef_m);
    f->prepare =
        (velum_prepare_info){.struct_size = sizeof f->prepare, .eyes = &f->eye, .eye_count = 1, .max_tiles = 1};
    f->point = (velum_point_query){.struct_size = sizeof f->point};
    test_ecef(50.0, 8.0, 1200.0, f->point.position_ecef_m);
    f->point_answer.struct_size = sizeof f->point_answer;
    f->line = (velum_line_query){.struct_size = sizeof f->line};
    test_ecef(50.0, 8.0, 0.0, f->line.from_ecef_m);
    test_ecef(50.0, 8.1, 3000.0, f->line.to_ecef_m);
    f->line_answer.struct_size = sizeof f->line_answer;
}

static void fixture_finish(fixture *f) {
    assert_int_equal(host.world->destroy(f->world), VELUM_OK);
}

static velum_result call_commit(void *context) {
    fixture *f = context;
    velum_result result = host.world->commit(f->world, &f->desc, &f->out_state);
    if (result >= 0 && f->retire) {
        velum_result retired = host.world->retire(f->world, f->out_state);
        f->out_state = 12345;
        return retired < 0 ? retired : result;
    }
    return result;
}

static velum_result call_timeline(void *context) {
    fixture *f = context;
    return host.world->set_timeline(f->world, f->keys, f->key_count, f->key_stride);
}

static velum_result call_prepare(void *context) {
    fixture *f = context;
    return host.world->prepare(f->world, &f->prepare);
}

static velum_result call_point(void *context) {
    fixture *f = context;
    return host.world->query_point(f->world, &f->point, &f->point_answer);
}

static velum_result call_line(void *context) {
    fixture *f = context;
    return host.world->query_line(f->world, &f->line, &f->line_answer);
}

static misuse misuse_of(fixture *f, const char *name, misuse_call call) {
    return (misuse){.host = &host, .call_name = name, .call = call, .context = f, .snapshot = snapshot};
}

/* ------------------------------------------------------------------ commit */

static const field_rule layer_rules[] = {
    RULE(velum_layer, genus, FIELD_I32, VELUM_GENUS_CI, VELUM_GENUS_CB),
    RULE(velum_layer, water, FIELD_I32, VELUM_WATER_LIQUID, VELUM_WATER_ICE),
    RULE(velum_layer, coverage, FIELD_F32, 0, 1),
    RULE(velum_layer, water_g_m3, FIELD_F32, 0, 20),
    RULE(velum_layer, radius_um, FIELD_F32, 0.5, 500),
    RULE_AS(velum_layer, wind_east_m_s, "wind", FIELD_F32, -INFINITY, INFINITY),
    RULE_AS(velum_layer, wind_north_m_s, "wind", FIELD_F32, -INFINITY, INFINITY),
    RULE(velum_layer, transition_m, FIELD_F32, 0, INFINITY),
    RULE(velum_layer, scud, FIELD_F32, 0, 1),
    RULE(velum_layer, precipitation_mm_h, FIELD_F32, 0, 500),
    RULE(velum_layer, precipitation, FIELD_I32, VELUM_PRECIPITATION_NONE, VELUM_PRECIPITATION_SLEET),
};

static void layers_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    misuse m = misuse_of(&f, "commit layer", call_commit);
    misuse_expect_ok(&m, "the layer as it is");
    misuse_struct(&m, &f.layer, sizeof f.layer, true, 0xfu);
    misuse_rules(&m, &f.layer, layer_rules, COUNT(layer_rules), true);

    /* Heights: each in its own range, the base below the top. */
    static const field_rule base[] = {RULE(velum_layer, base_m, FIELD_F32, -500, INFINITY)};
    static const field_rule top[] = {RULE(velum_layer, top_m, FIELD_F32, -INFINITY, 25000)};
    misuse_rules(&m, &f.layer, base, 1, true);
    misuse_rules(&m, &f.layer, top, 1, true);
    f.layer.top_m = f.layer.base_m;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "top_m");
    f.layer.top_m = f.layer.base_m - 1.0f;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "top_m");
    f.layer.top_m = 2000.0f;

    f.layer.flags = VELUM_LAYER_UNIFORM | VELUM_LAYER_EXTINCTION | VELUM_LAYER_ALBEDO | VELUM_LAYER_PHASE_HG;
    f.layer.coverage = 1.0f;
    static const field_rule uniform[] = {
        RULE(velum_layer, extinction_1_m, FIELD_F32, 0, 10),
        RULE(velum_layer, albedo, FIELD_F32, 0, 1),
        RULE(velum_layer, hg_asymmetry, FIELD_F32, (double)-0.999f, (double)0.999f),
    };
    misuse_rules(&m, &f.layer, uniform, COUNT(uniform), true);
    for (uint32_t flag = VELUM_LAYER_PHASE_HG; flag <= VELUM_LAYER_ALBEDO; flag *= 2) {
        f.layer.flags = flag; /* of uniform layers only */
        misuse_expect(&m, VELUM_ERROR_FLAGS, "flags");
    }
    assert_true(m.tried > 100);
    assert_int_equal(m.wrong, 0);
    fixture_finish(&f);
}

static void surfaces_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    misuse m = misuse_of(&f, "commit cell", call_commit);
    misuse_struct(&m, &f.cell, sizeof f.cell, true, 0x3fu);
    static const field_rule rules[] = {
        RULE(velum_cell, kind, FIELD_I32, VELUM_CELL_GLOBAL, VELUM_CELL_GLOBAL),
        RULE(velum_cell, visibility_m, FIELD_F32, 1, 1e6),
        RULE(velum_cell, fog_top_m, FIELD_F32, -INFINITY, INFINITY),
        RULE(velum_cell, elevation_m, FIELD_F32, -INFINITY, INFINITY),
        RULE_AS(velum_cell, wind_east_m_s, "wind", FIELD_F32, -INFINITY, INFINITY),
        RULE_AS(velum_cell, wind_north_m_s, "wind", FIELD_F32, -INFINITY, INFINITY),
        RULE(velum_cell, gust_m_s, FIELD_F32, 0, INFINITY),
        RULE(velum_cell, temperature_k, FIELD_F32, -INFINITY, INFINITY),
        RULE(velum_cell, dew_point_k, FIELD_F32, -INFINITY, INFINITY),
        RULE(velum_cell, precipitation_mm_h, FIELD_F32, 0, INFINITY),
        RULE(velum_cell, precipitation, FIELD_I32, VELUM_PRECIPITATION_NONE, VELUM_PRECIPITATION_SLEET),
        RULE(velum_cell, thunderstorm, FIELD_U32, 0, 1),
        RULE_RESERVED(velum_cell, reserved, FIELD_U32),
    };
    misuse_rules(&m, &f.cell, rules + 1, COUNT(rules) - 1, true);
    static const int32_t kinds[] = {INT32_MIN, -1, 0, 5, INT32_MAX};
    for (size_t i = 0; i < COUNT(kinds); i++) {
        f.cell.kind = kinds[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "kind");
    }
    f.cell.kind = VELUM_CELL_GLOBAL;

    f.cell.layer_count = 17;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "layer_count");
    f.cell.layer_count = UINT32_MAX;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "layer_count");
    f.cell.layer_count = 1;
    f.cell.layers = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "layers");
    f.cell.layers = &f.layer;
    f.cell.layer_stride = 8;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "layer");
    f.cell.layer_stride = 0;
    misuse_expect_ok(&m, "the cell as it was");
    assert_true(m.tried > 50);
    assert_int_equal(m.wrong, 0);
    fixture_finish(&f);
}

static void shapes_are_checked(void **state) {
    (void)state;
    uint32_t wrong = 0, tried = 0;
    static const field_rule place[] = {
        RULE(velum_cell, lat_deg, FIELD_F64, -90, 90),
        RULE(velum_cell, lon_deg, FIELD_F64, -180, 360),
    };
    static const field_rule rectangle[] = {
        RULE(velum_cell, half_east_m, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_cell, half_north_m, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_cell, corner_radius_m, FIELD_F64, 0, 10000),
        RULE(velum_cell, rotation_deg, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_cell, transition_m, FIELD_F64, 0, INFINITY),
    };
    fixture f;

    fixture_init(&f, VELUM_CELL_STATION);
    misuse m = misuse_of(&f, "commit station", call_commit);
    misuse_expect_ok(&m, "the station as it is");
    misuse_rules(&m, &f.cell, place, COUNT(place), true);
    const double radii[] = {-1.0, 1.0, 999.0, 500001.0, (double)NAN, NONE, -NONE};
    for (size_t i = 0; i < COUNT(radii); i++) {
        f.cell.radius_m = radii[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "radius_m");
    }
    tried += m.tried;
    wrong += m.wrong;
    fixture_finish(&f);

    fixture_init(&f, VELUM_CELL_RECTANGLE);
    m = misuse_of(&f, "commit rectangle", call_commit);
    misuse_expect_ok(&m, "the rectangle as it is");
    misuse_rules(&m, &f.cell, place, COUNT(place), true);
    misuse_rules(&m, &f.cell, rectangle, COUNT(rectangle), true);
    for (size_t i = 0; i < 2; i++) {
        double *half = i ? &f.cell.half_north_m : &f.cell.half_east_m;
        double kept = *half;
        *half = 0.0;
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, i ? "half_north_m" : "half_east_m");
        *half = -kept;
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, i ? "half_north_m" : "half_east_m");
        *half = kept;
    }
    tried += m.tried;
    wrong += m.wrong;
    fixture_finish(&f);

    fixture_init(&f, VELUM_CELL_POLYGON);
    m = misuse_of(&f, "commit polygon", call_commit);
    misuse_expect_ok(&m, "the polygon as it is");
    static const field_rule vertex[] = {
        RULE(velum_lat_lon, lat_deg, FIELD_F64, -90, 90),
        RULE(velum_lat_lon, lon_deg, FIELD_F64, -180, 360),
    };
    misuse_rules(&m, &f.points[5], vertex, COUNT(vertex), false);
    f.cell.points = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "points");
    f.cell.points = f.points;
    f.cell.ring_sizes = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "ring_sizes");
    f.cell.ring_sizes = f.ring_sizes;
    static const uint32_t sizes[][2] = {{4, 5}, {4, 3}, {2, 6}, {8, 0}, {UINT32_MAX, 9}, {0x80000004u, 0x80000004u}};
    for (size_t i = 0; i < COUNT(sizes); i++) {
        memcpy(f.ring_sizes, sizes[i], sizeof sizes[i]);
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "ring_sizes");
    }
    f.ring_sizes[0] = f.ring_sizes[1] = 4;
    f.cell.ring_count = 0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "ring_count");
    f.cell.ring_count = 2;
    f.cell.point_count = 2;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "");
    f.cell.point_count = 8;
    f.cell.transition_m = (double)NAN;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "transition_m");
    f.cell.transition_m = -1.0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "transition_m");
    f.cell.transition_m = 0.0;
    misuse_expect_ok(&m, "the polygon as it was");
    tried += m.tried;
    wrong += m.wrong;
    fixture_finish(&f);
    assert_true(tried > 80);
    assert_int_equal(wrong, 0);
}

static void grids_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    f.desc.grid = &f.grid;
    misuse m = misuse_of(&f, "commit grid", call_commit);
    misuse_expect_ok(&m, "the grid as it is");
    misuse_struct(&m, &f.grid, sizeof f.grid, true, 0);
    static const field_rule rules[] = {
        RULE(velum_grid, lat_first_deg, FIELD_F64, -90, 87.5),
        RULE(velum_grid, lon_first_deg, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_grid, lat_step_deg, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_grid, lon_step_deg, FIELD_F64, -INFINITY, INFINITY),
        RULE_RESERVED(velum_grid, reserved, FIELD_U32),
    };
    velum_grid kept = f.grid;
    misuse_rules(&m, &f.grid, rules + 1, COUNT(rules) - 1, false);
    const double lats[] = {-91.0, 91.0, 89.0, (double)NAN};
    for (size_t i = 0; i < COUNT(lats); i++) {
        f.grid.lat_first_deg = lats[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "lat_");
    }
    f.grid = kept;
    f.grid.lat_step_deg = 0.0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "lat_step_deg");
    f.grid = kept;
    f.grid.lon_step_deg = 0.0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "lon_step_deg");
    f.grid.lon_step_deg = -2.5;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "lon_step_deg");
    f.grid = kept;
    f.grid.cells = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "cells");
    f.grid = kept;
    f.grid.cell_stride = 16;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.grid = kept;
    f.grid.columns = 0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "columns");
    f.grid = kept;
    f.grid.rows = 0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "rows");
    f.grid = kept;
    f.grid.columns = f.grid.rows = UINT32_MAX;
    f.grid.lat_step_deg = f.grid.lon_step_deg = 1e-12;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "");
    f.grid = kept;
    f.nodes[3].visibility_m = -1.0f;
    f.nodes[3].flags |= VELUM_CELL_HAS_VISIBILITY;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "visibility_m");
    f.nodes[3].flags = 1u << 30;
    misuse_expect(&m, VELUM_ERROR_FLAGS, "flags");
    f.nodes[3] = f.nodes[2];
    f.nodes[3].struct_size = 20;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.nodes[3] = f.nodes[2];
    misuse_expect_ok(&m, "the grid as it was");
    assert_true(m.tried > 50);
    assert_int_equal(m.wrong, 0);
    fixture_finish(&f);
}

static velum_result call_commit_null(void *context) {
    fixture *f = context;
    return host.world->commit(f->world, NULL, &f->out_state);
}

static velum_result call_commit_null_out(void *context) {
    fixture *f = context;
    return host.world->commit(f->world, &f->desc, NULL);
}

static void states_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    misuse m = misuse_of(&f, "commit state", call_commit);
    misuse_struct(&m, &f.desc, sizeof f.desc, true, 0);
    static const field_rule rules[] = {RULE(velum_state_desc, geoid_undulation_m, FIELD_F32, -200, 200)};
    misuse_rules(&m, &f.desc, rules, COUNT(rules), true);
    velum_state_desc kept = f.desc;
    f.desc.cells = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "cells");
    f.desc = kept;
    f.desc.cell_stride = 8;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.desc = kept;
    f.desc.base_state = 999;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "base_state");
    f.desc = kept;
    uint64_t removed[1] = {9};
    f.desc.removed_ids = removed;
    f.desc.removed_count = 1;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "removed"); /* of a change only */
    f.desc.base_state = f.state;
    f.desc.removed_ids = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "removed_ids");
    f.desc = kept;

    /* Two cells of one id. */
    velum_cell twice[2] = {f.cell, f.cell};
    f.desc.cells = twice;
    f.desc.cell_count = 2;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "id");
    /* The second of two is wrong: nothing of the first is taken over. */
    twice[1].id = 10;
    misuse_expect_ok(&m, "two cells");
    twice[1].thunderstorm = 2;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "thunderstorm");
    f.desc = kept;

    misuse null_state = misuse_of(&f, "commit null", call_commit_null);
    misuse_expect(&null_state, VELUM_ERROR_ARGUMENT, "state");
    misuse null_out = misuse_of(&f, "commit to null", call_commit_null_out);
    misuse_expect(&null_out, VELUM_ERROR_ARGUMENT, "out");
    assert_int_equal(m.wrong + null_state.wrong + null_out.wrong, 0);
    fixture_finish(&f);
}

/* ------------------------------------------------------------------ timeline, retire */

static void timelines_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    misuse m = misuse_of(&f, "set_timeline", call_timeline);
    misuse_expect_ok(&m, "two keys");
    misuse_struct(&m, &f.keys[0], sizeof f.keys[0], false, 0);
    static const field_rule second[] = {
        RULE(velum_timeline_key, time_s, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_timeline_key, transition_s, FIELD_F64, 0, 100),
        RULE_RESERVED(velum_timeline_key, reserved, FIELD_U32),
    };
    misuse_rules(&m, &f.keys[1], second, COUNT(second), true);
    f.keys[1].time_s = 0.0;
    f.keys[1].transition_s = 0.0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "time_s");
    f.keys[1].time_s = -1.0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "time_s");
    f.keys[1].time_s = 100.0;
    f.keys[1].state = 0;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "state");
    f.keys[1].state = 77;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "state");
    f.keys[1].state = f.state;
    f.key_stride = 8;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.key_stride = 0;
    misuse_expect_ok(&m, "two keys");
    assert_int_equal(m.wrong, 0);

    test_log_clear(&host.log);
    assert_int_equal(host.world->set_timeline(f.world, NULL, 1, 0), VELUM_ERROR_ARGUMENT);
    assert_true(host.log.failures > 0);

    /* A state that the timeline names stays; an unknown one cannot go. */
    uint8_t before[256] = {0}, after[256] = {0};
    snapshot(&f, before);
    test_log_clear(&host.log);
    assert_int_equal(host.world->retire(f.world, f.state), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 1);
    assert_int_equal(host.world->retire(f.world, 0), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->retire(f.world, 4711), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 3);
    snapshot(&f, after);
    assert_memory_equal(before, after, sizeof before);
    assert_int_equal(host.world->set_timeline(f.world, NULL, 0, 0), VELUM_OK);
    assert_int_equal(host.world->retire(f.world, f.state), VELUM_OK);
    assert_int_equal(host.world->retire(f.world, f.state), VELUM_ERROR_ARGUMENT);
    fixture_finish(&f);
}

/* ------------------------------------------------------------------ prepare, queries */

static void preparations_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    misuse m = misuse_of(&f, "prepare", call_prepare);
    misuse_struct(&m, &f.prepare, sizeof f.prepare, true, 0);
    misuse_struct(&m, &f.eye, sizeof f.eye, true, 0);
    static const field_rule eye[] = {
        RULE_AS(velum_prepare_eye, position_ecef_m[0], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_prepare_eye, position_ecef_m[2], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_prepare_eye, time_s, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_prepare_eye, pixel_rad, FIELD_F64, 0, INFINITY),
        RULE(velum_prepare_eye, distance_m, FIELD_F64, 0, INFINITY),
    };
    static const field_rule info[] = {RULE_RESERVED(velum_prepare_info, reserved, FIELD_U32)};
    misuse_rules(&m, &f.eye, eye, COUNT(eye), false);
    misuse_rules(&m, &f.prepare, info, COUNT(info), false);
    memset(f.eye.position_ecef_m, 0, sizeof f.eye.position_ecef_m);
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "position_ecef_m");
    test_ecef(50.0, 8.0, 300.0, f.eye.position_ecef_m);
    f.prepare.eyes = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "eyes");
    f.prepare.eyes = &f.eye;
    f.prepare.eye_stride = 4;
    misuse_expect(&m, VELUM_ERROR_STRUCT_SIZE, "");
    f.prepare.eye_stride = 0;
    /* The second eye is wrong: nothing is rasterised for the first either. */
    velum_prepare_eye two[2] = {f.eye, f.eye};
    two[1].time_s = (double)NAN;
    f.prepare.eyes = two;
    f.prepare.eye_count = 2;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "time_s");
    f.prepare.eye_count = 1;
    misuse_expect_ok(&m, "one eye, one tile");
    assert_int_equal(m.wrong, 0);
    test_log_clear(&host.log);
    assert_int_equal(host.world->prepare(f.world, NULL), VELUM_ERROR_ARGUMENT);
    assert_true(host.log.failures > 0);
    fixture_finish(&f);
}

static void queries_are_checked(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    misuse m = misuse_of(&f, "query_point", call_point);
    misuse_expect_ok(&m, "the point as it is");
    velum_point_answer answer = f.point_answer;
    misuse_struct(&m, &f.point, sizeof f.point, true, 0);
    static const field_rule point[] = {
        RULE_AS(velum_point_query, position_ecef_m[0], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_point_query, position_ecef_m[1], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_point_query, position_ecef_m[2], "position_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_point_query, time_s, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_point_query, footprint_m, FIELD_F64, 0, INFINITY),
    };
    misuse_rules(&m, &f.point, point, COUNT(point), false);
    misuse_struct(&m, &f.point_answer, sizeof f.point_answer, false, 0);
    assert_memory_equal(&answer, &f.point_answer, sizeof answer); /* no refused call wrote to it */

    misuse l = misuse_of(&f, "query_line", call_line);
    misuse_expect_ok(&l, "the line as it is");
    velum_line_answer along = f.line_answer;
    misuse_struct(&l, &f.line, sizeof f.line, true, 0);
    static const field_rule line[] = {
        RULE_AS(velum_line_query, from_ecef_m[0], "from_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_line_query, from_ecef_m[2], "from_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_line_query, to_ecef_m[0], "to_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE_AS(velum_line_query, to_ecef_m[1], "to_ecef_m", FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_line_query, time_s, FIELD_F64, -INFINITY, INFINITY),
        RULE(velum_line_query, footprint_m, FIELD_F64, 0, INFINITY),
        RULE(velum_line_query, contact_extinction_1_m, FIELD_F32, 0, INFINITY),
    };
    misuse_rules(&l, &f.line, line, COUNT(line), false);
    f.line.reserved = 1.0f;
    misuse_expect(&l, VELUM_ERROR_FLAGS, "reserved");
    f.line.reserved = 0.0f;
    misuse_struct(&l, &f.line_answer, sizeof f.line_answer, false, 0);
    assert_memory_equal(&along, &f.line_answer, sizeof along);
    assert_int_equal(m.wrong + l.wrong, 0);

    test_log_clear(&host.log);
    assert_int_equal(host.world->query_point(f.world, NULL, &f.point_answer), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->query_point(f.world, &f.point, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->query_line(f.world, NULL, &f.line_answer), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->query_line(f.world, &f.line, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->get_info(f.world, NULL), VELUM_ERROR_ARGUMENT);
    velum_world_info info = {.struct_size = 4};
    assert_int_equal(host.world->get_info(f.world, &info), VELUM_ERROR_STRUCT_SIZE);
    assert_int_equal(host.log.failures, 6);
    fixture_finish(&f);
}

/* ------------------------------------------------------------------ objects */

static void worlds_are_made_of_sound_descriptions(void **state) {
    (void)state;
    velum_world *world = (velum_world *)&host;
    velum_world_desc desc = {.struct_size = sizeof desc, .seed = 1, .log = test_log_write, .log_context = &host.log};
    assert_int_equal(host.world->create(NULL, &world), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->create(&desc, NULL), VELUM_ERROR_ARGUMENT);
    for (uint32_t size = 0; size < sizeof desc; size++) {
        desc.struct_size = size;
        assert_int_equal(host.world->create(&desc, &world), VELUM_ERROR_STRUCT_SIZE);
    }
    desc.struct_size = sizeof desc;
    desc.flags = 1;
    test_log_clear(&host.log);
    assert_int_equal(host.world->create(&desc, &world), VELUM_ERROR_FLAGS);
    assert_int_equal(host.log.failures, 1);
    assert_ptr_equal(world, &host);
    assert_int_equal(host.world->destroy(NULL), VELUM_OK);
}

/* Every function of the table, with everything that is not a world. */
static void what_is_no_world_is_found_out(void **state) {
    (void)state;
    velum_world *dead = test_host_create_world(&host, 5);
    assert_int_equal(host.world->destroy(dead), VELUM_OK);
    static uint64_t foreign[64];
    velum_world *const none[] = {NULL,
                                 dead,
                                 (velum_world *)(uintptr_t)1,
                                 (velum_world *)UINTPTR_MAX,
                                 (velum_world *)(uintptr_t)0x7fff00000000,
                                 (velum_world *)foreign};
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    for (size_t i = 0; i < COUNT(none); i++) {
        velum_world *world = none[i];
        velum_world_info info = {.struct_size = sizeof info};
        assert_int_equal(host.world->commit(world, &f.desc, &f.out_state), VELUM_ERROR_HANDLE);
        assert_int_equal(f.out_state, 12345);
        assert_int_equal(host.world->retire(world, 1), VELUM_ERROR_HANDLE);
        assert_int_equal(host.world->set_timeline(world, f.keys, 2, 0), VELUM_ERROR_HANDLE);
        assert_int_equal(host.world->prepare(world, &f.prepare), VELUM_ERROR_HANDLE);
        assert_int_equal(host.world->query_point(world, &f.point, &f.point_answer), VELUM_ERROR_HANDLE);
        assert_int_equal(host.world->query_line(world, &f.line, &f.line_answer), VELUM_ERROR_HANDLE);
        assert_int_equal(host.world->get_info(world, &info), VELUM_ERROR_HANDLE);
        if (world) {
            assert_int_equal(host.world->destroy(world), VELUM_ERROR_HANDLE);
        }
    }
    fixture_finish(&f);
}

/* A world takes no notice of what is done to another, and of the order in which they go. */
static void worlds_are_independent(void **state) {
    (void)state;
    velum_world *worlds[8];
    velum_point_query query = {.struct_size = sizeof query};
    test_ecef(50.0, 8.0, 1200.0, query.position_ecef_m);
    for (size_t i = 0; i < COUNT(worlds); i++) {
        worlds[i] = test_host_create_world(&host, i);
        assert_non_null(worlds[i]);
        assert_int_equal(test_host_commit_overcast(&host, worlds[i], 0.1f * (float)(i + 1)), 1);
    }
    assert_int_equal(host.world->destroy(worlds[3]), VELUM_OK);
    for (size_t i = 0; i < COUNT(worlds); i++) {
        velum_point_answer answer = {.struct_size = sizeof answer};
        velum_result result = host.world->query_point(worlds[i], &query, &answer);
        if (i == 3) {
            assert_int_equal(result, VELUM_ERROR_HANDLE);
            continue;
        }
        assert_true(result >= 0);
        assert_true(fabsf(answer.coverage - 0.1f * (float)(i + 1)) < 0.02f);
        velum_world_info info = {.struct_size = sizeof info};
        assert_int_equal(host.world->get_info(worlds[i], &info), VELUM_OK);
        assert_int_equal(info.state_count, 1);
        assert_int_equal(info.cells, 1);
    }
    for (size_t i = COUNT(worlds); i-- > 0;) {
        assert_int_equal(host.world->destroy(worlds[i]), i == 3 ? VELUM_ERROR_HANDLE : VELUM_OK);
    }
}

/* A newer host's longer struct, with something in the part that is not known here. */
static void a_longer_struct_is_read_as_far_as_it_is_known(void **state) {
    (void)state;
    fixture f;
    fixture_init(&f, VELUM_CELL_GLOBAL);
    struct {
        velum_layer layer;
        uint32_t more[4];
    } layer = {.layer = f.layer, .more = {1, 2, 3, 4}};
    struct {
        velum_cell cell;
        uint64_t more[2];
    } cells[2] = {{f.cell, {5, 6}}, {f.cell, {7, 8}}};
    layer.layer.struct_size = sizeof layer;
    for (size_t i = 0; i < 2; i++) {
        cells[i].cell.struct_size = sizeof cells[i];
        cells[i].cell.id = i + 1;
        cells[i].cell.layers = &layer.layer;
    }
    f.desc.cells = &cells[0].cell;
    f.desc.cell_count = 2;
    f.desc.cell_stride = 0; /* of the first element's own size */
    test_log_clear(&host.log);
    f.out_state = 0;
    assert_true(host.world->commit(f.world, &f.desc, &f.out_state) >= 0);
    f.desc.cell_stride = sizeof cells[0];
    assert_true(host.world->commit(f.world, &f.desc, &f.out_state) >= 0);
    velum_world_info info = {.struct_size = sizeof info};
    assert_int_equal(host.world->get_info(f.world, &info), VELUM_OK);
    assert_int_equal(info.state_count, 3);
    assert_int_equal(info.cells, 5);
    fixture_finish(&f);
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_are_made_of_sound_descriptions),
        cmocka_unit_test(layers_are_checked),
        cmocka_unit_test(surfaces_are_checked),
        cmocka_unit_test(shapes_are_checked),
        cmocka_unit_test(grids_are_checked),
        cmocka_unit_test(states_are_checked),
        cmocka_unit_test(timelines_are_checked),
        cmocka_unit_test(preparations_are_checked),
        cmocka_unit_test(queries_are_checked),
        cmocka_unit_test(what_is_no_world_is_found_out),
        cmocka_unit_test(worlds_are_independent),
        cmocka_unit_test(a_longer_struct_is_read_as_far_as_it_is_known),
    };
    int failed = cmocka_run_group_tests_name("abi world misuse", tests, NULL, NULL);
    test_host_close(&host);
    return failed;
}
