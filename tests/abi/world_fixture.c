#include "world_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

void world_fixture_snapshot(void *context, void *out256) {
    world_fixture *f = context;
    velum_world_info info = {.struct_size = sizeof info};
    if (f->host->world->get_info(f->world, &info) != VELUM_OK) {
        info.struct_size = 0;
    }
    memcpy(out256, &info, sizeof info);
    memcpy((char *)out256 + sizeof info, &f->out_state, sizeof f->out_state);
}

void world_fixture_init(world_fixture *f, test_host *host, int32_t kind) {
    *f = (world_fixture){.host = host, .out_state = 12345, .retire = true};
    f->world = test_host_create_world(host, 1);
    assert_non_null(f->world);
    f->state = test_host_commit_overcast(host, f->world, 0.5f);
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

void world_fixture_finish(world_fixture *f) {
    assert_int_equal(f->host->world->destroy(f->world), VELUM_OK);
}

misuse world_fixture_misuse(world_fixture *f, const char *name, misuse_call call) {
    return (misuse){.host = f->host, .call_name = name, .call = call, .context = f, .snapshot = world_fixture_snapshot};
}
