#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <string.h>

#include "weather/set.h"

static void cells_lie_in_a_row_with_ids_of_their_own(void **state) {
    (void)state;
    velum_weather_set *set = velum_weather_set_create();
    for (int i = 0; i < 1000; ++i) {
        assert_non_null(weather_set_add_cell(set));
    }
    velum_state_desc desc;
    velum_weather_set_state(set, &desc);
    assert_int_equal(desc.struct_size, sizeof(desc));
    assert_int_equal(desc.cell_count, 1000);
    assert_int_equal(desc.cell_stride, sizeof(velum_cell));
    assert_null(desc.grid);
    for (uint32_t i = 0; i < 1000; ++i) {
        assert_int_equal(desc.cells[i].struct_size, sizeof(velum_cell));
        assert_true(desc.cells[i].id > (i ? desc.cells[i - 1].id : 0));
    }
    velum_weather_set_destroy(set);
}

static void memory_is_zeroed_and_sizes_do_not_overflow(void **state) {
    (void)state;
    velum_weather_set *set = velum_weather_set_create();
    for (size_t size = 1; size < 2000000; size = size * 3 + 1) {
        unsigned char *bytes = weather_set_alloc(set, size, 1);
        assert_non_null(bytes);
        for (size_t i = 0; i < size; ++i) {
            assert_int_equal(bytes[i], 0);
        }
        memset(bytes, 0xa5, size);
    }
    assert_null(weather_set_alloc(set, SIZE_MAX, 2));
    assert_null(weather_set_alloc(set, SIZE_MAX / 2, 3));
    assert_null(weather_set_alloc(set, 1, SIZE_MAX / 2));
    assert_non_null(weather_set_alloc(set, 0, 8));
    velum_weather_set_destroy(set);
}

static void rollback_restores_cells_grid_and_memory(void **state) {
    (void)state;
    velum_weather_set *set = velum_weather_set_create();
    velum_cell *first = weather_set_add_cell(set);
    velum_layer *layers = weather_set_layers(set, first, 2);
    layers[1].coverage = 0.5f;
    velum_cell *nodes = weather_set_alloc(set, 4, sizeof(*nodes));
    assert_int_equal(weather_set_take_grid(set, &(velum_grid){.columns = 2, .rows = 2, .cells = nodes}), VELUM_OK);

    const weather_set_mark_point mark = weather_set_mark(set);
    for (int i = 0; i < 500; ++i) {
        velum_cell *cell = weather_set_add_cell(set);
        assert_non_null(weather_set_layers(set, cell, 16));
        memset(weather_set_alloc(set, 5000, 1), 0xff, 5000);
    }
    velum_cell *others = weather_set_alloc(set, 9, sizeof(*others));
    assert_int_equal(weather_set_take_grid(set, &(velum_grid){.columns = 3, .rows = 3, .cells = others}), VELUM_OK);
    weather_set_rollback(set, &mark);

    velum_state_desc desc;
    velum_weather_set_state(set, &desc);
    assert_int_equal(desc.cell_count, 1);
    assert_int_equal(desc.cells[0].layer_count, 2);
    assert_true(desc.cells[0].layers[1].coverage == 0.5f);
    assert_int_equal(desc.grid->columns, 2);
    assert_ptr_equal(desc.grid->cells, nodes);
    const unsigned char *again = weather_set_alloc(set, 6000, 1);
    for (int i = 0; i < 6000; ++i) {
        assert_int_equal(again[i], 0);
    }
    velum_weather_set_destroy(set);
}

static void null_and_empty_sets_are_harmless(void **state) {
    (void)state;
    velum_state_desc desc;
    velum_weather_set_destroy(NULL);
    velum_weather_set_state(NULL, &desc);
    assert_int_equal(desc.cell_count, 0);
    velum_weather_set *set = velum_weather_set_create();
    assert_int_equal(weather_set_take_grid(set, NULL), VELUM_ERROR_ARGUMENT);
    assert_null(weather_set_cell(set, 0));
    velum_weather_set_destroy(set);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cells_lie_in_a_row_with_ids_of_their_own),
        cmocka_unit_test(memory_is_zeroed_and_sizes_do_not_overflow),
        cmocka_unit_test(rollback_restores_cells_grid_and_memory),
        cmocka_unit_test(null_and_empty_sets_are_harmless),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
