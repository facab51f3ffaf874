/* commit of "velum.world/1": every field of every struct out of its range is refused by name, and nothing is taken
 * over. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "world_fixture.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static const double NONE = (double)INFINITY;

static test_host host;

static velum_result call_commit(void *context) {
    world_fixture *f = context;
    velum_result result = host.world->commit(f->world, &f->desc, &f->out_state);
    if (result >= 0 && f->retire) {
        velum_result retired = host.world->retire(f->world, f->out_state);
        f->out_state = 12345;
        return retired < 0 ? retired : result;
    }
    return result;
}

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
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    misuse m = world_fixture_misuse(&f, "commit layer", call_commit);
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
    world_fixture_finish(&f);
}

static void surfaces_are_checked(void **state) {
    (void)state;
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    misuse m = world_fixture_misuse(&f, "commit cell", call_commit);
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
    world_fixture_finish(&f);
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
    world_fixture f;

    world_fixture_init(&f, &host, VELUM_CELL_STATION);
    misuse m = world_fixture_misuse(&f, "commit station", call_commit);
    misuse_expect_ok(&m, "the station as it is");
    misuse_rules(&m, &f.cell, place, COUNT(place), true);
    const double radii[] = {-1.0, 1.0, 999.0, 500001.0, (double)NAN, NONE, -NONE};
    for (size_t i = 0; i < COUNT(radii); i++) {
        f.cell.radius_m = radii[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "radius_m");
    }
    tried += m.tried;
    wrong += m.wrong;
    world_fixture_finish(&f);

    world_fixture_init(&f, &host, VELUM_CELL_RECTANGLE);
    m = world_fixture_misuse(&f, "commit rectangle", call_commit);
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
    world_fixture_finish(&f);

    world_fixture_init(&f, &host, VELUM_CELL_POLYGON);
    m = world_fixture_misuse(&f, "commit polygon", call_commit);
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
    world_fixture_finish(&f);
    assert_true(tried > 80);
    assert_int_equal(wrong, 0);
}

static void grids_are_checked(void **state) {
    (void)state;
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    f.desc.grid = &f.grid;
    misuse m = world_fixture_misuse(&f, "commit grid", call_commit);
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
    world_fixture_finish(&f);
}

static velum_result call_commit_null(void *context) {
    world_fixture *f = context;
    return host.world->commit(f->world, NULL, &f->out_state);
}

static velum_result call_commit_null_out(void *context) {
    world_fixture *f = context;
    return host.world->commit(f->world, &f->desc, NULL);
}

static void states_are_checked(void **state) {
    (void)state;
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    misuse m = world_fixture_misuse(&f, "commit state", call_commit);
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

    misuse null_state = world_fixture_misuse(&f, "commit null", call_commit_null);
    misuse_expect(&null_state, VELUM_ERROR_ARGUMENT, "state");
    misuse null_out = world_fixture_misuse(&f, "commit to null", call_commit_null_out);
    misuse_expect(&null_out, VELUM_ERROR_ARGUMENT, "out");
    assert_int_equal(m.wrong + null_state.wrong + null_out.wrong, 0);
    world_fixture_finish(&f);
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(layers_are_checked), cmocka_unit_test(surfaces_are_checked),
        cmocka_unit_test(shapes_are_checked), cmocka_unit_test(grids_are_checked),
        cmocka_unit_test(states_are_checked),
    };
    int failed = cmocka_run_group_tests_name("abi commit misuse", tests, NULL, NULL);
    test_host_close(&host);
    return failed;
}
