/* "velum.world/1" in the hands of a careless host: the right error, a line in the log before it, nothing changed. */
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

static test_host host;

static velum_result call_timeline(void *context) {
    world_fixture *f = context;
    return host.world->set_timeline(f->world, f->keys, f->key_count, f->key_stride);
}

static velum_result call_prepare(void *context) {
    world_fixture *f = context;
    return host.world->prepare(f->world, &f->prepare);
}

static velum_result call_point(void *context) {
    world_fixture *f = context;
    return host.world->query_point(f->world, &f->point, &f->point_answer);
}

static velum_result call_line(void *context) {
    world_fixture *f = context;
    return host.world->query_line(f->world, &f->line, &f->line_answer);
}

/* ------------------------------------------------------------------ timeline, retire */

static void timelines_are_checked(void **state) {
    (void)state;
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    misuse m = world_fixture_misuse(&f, "set_timeline", call_timeline);
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
    world_fixture_snapshot(&f, before);
    test_log_clear(&host.log);
    assert_int_equal(host.world->retire(f.world, f.state), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 1);
    assert_int_equal(host.world->retire(f.world, 0), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.world->retire(f.world, 4711), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 3);
    world_fixture_snapshot(&f, after);
    assert_memory_equal(before, after, sizeof before);
    assert_int_equal(host.world->set_timeline(f.world, NULL, 0, 0), VELUM_OK);
    assert_int_equal(host.world->retire(f.world, f.state), VELUM_OK);
    assert_int_equal(host.world->retire(f.world, f.state), VELUM_ERROR_ARGUMENT);
    world_fixture_finish(&f);
}

/* ------------------------------------------------------------------ prepare, queries */

static void preparations_are_checked(void **state) {
    (void)state;
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    misuse m = world_fixture_misuse(&f, "prepare", call_prepare);
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
    world_fixture_finish(&f);
}

static void queries_are_checked(void **state) {
    (void)state;
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
    misuse m = world_fixture_misuse(&f, "query_point", call_point);
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

    misuse l = world_fixture_misuse(&f, "query_line", call_line);
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
    world_fixture_finish(&f);
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
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
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
    world_fixture_finish(&f);
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
    world_fixture f;
    world_fixture_init(&f, &host, VELUM_CELL_GLOBAL);
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
    world_fixture_finish(&f);
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(worlds_are_made_of_sound_descriptions),
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
