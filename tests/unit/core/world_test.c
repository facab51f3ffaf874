/* A world as large as the real one. Timings are printed, never judged. */
#include "synthetic.h"

#include "core/geodesy.h"
#include "core/tile_cache.h"
#include "core/tile_set.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define STATIONS 4538u

typedef struct page_context {
    core_tile_cache *cache;
    const core_state *state;
} page_context;

static uint32_t page_of(void *context, uint32_t state, uint32_t data_key, uint32_t slot) {
    page_context *c = context;
    (void)state;
    core_tile *tile = core_tile_cache_find(c->cache, core_state_id(c->state), data_key);
    uint32_t page = tile && tile->mask & (1u << slot) ? slot : VELUM_PAGE_NONE;
    core_tile_unref(tile);
    return page;
}

static void a_new_place(const core_state *state, const char *name, double lat_deg, double lon_deg, double height_m) {
    core_tile_eye eye = {.detail = 1.0f};
    core_geodetic place = {lat_deg, lon_deg, height_m};
    core_tile_set set = {0};
    core_tile_cache *cache = core_tile_cache_create(0);
    assert_non_null(cache);
    assert_true(core_ecef_from_geodetic(&place, eye.position_ecef_m));

    double t0 = seconds_now();
    assert_int_equal(core_tile_set_init(&set, &eye, &state, 1, NULL), VELUM_OK);
    double t1 = seconds_now();
    uint32_t pages = 0;
    for (uint32_t i = 0; i < set.data_count; i++) {
        core_tile *tile = core_tile_cache_get(cache, state, set.data_keys[i]);
        assert_non_null(tile);
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            pages += tile->mask >> slot & 1u;
        }
        core_tile_unref(tile);
    }
    double t2 = seconds_now();
    uint32_t entries = core_tile_table_entries(set.key_count);
    uint32_t *words = malloc((size_t)entries * VELUM_TABLE_WORDS * sizeof *words);
    assert_non_null(words);
    core_tile_table_build(&set, 1, page_of, &(page_context){cache, state}, words, entries);
    double t3 = seconds_now();
    print_message(
        "%s: %u keys, %u tiles, %u pages (%.1f MB); set %.2f ms, tiles %.2f ms (%.3f ms each), table %.2f ms\n", name,
        set.key_count, set.data_count, pages, pages * 2.0 * CORE_TILE_PAGE_BYTES / 1048576.0, 1e3 * (t1 - t0),
        1e3 * (t2 - t1), 1e3 * (t2 - t1) / fmax(set.data_count, 1.0), 1e3 * (t3 - t2));
    assert_true(set.key_count > 100);
    assert_true(set.data_count > 0 && set.data_count <= set.key_count);
    assert_int_equal(core_tile_cache_get_info(cache).rasterised, set.data_count);
    for (uint32_t i = 0; i < set.key_count; i++) {
        const uint32_t *entry = core_tile_table_find(words, entries, set.keys[i]);
        assert_non_null(entry);
        assert_int_equal(core_tile_ancestor(set.keys[i], entry[1]), set.data_keys[set.data[i]]);
    }
    free(words);
    core_tile_set_finish(&set);
    core_tile_cache_destroy(cache);
}

static void a_real_sized_world_is_made_and_tiled(void **unused) {
    (void)unused;
    synthetic_world world;
    synthetic_world_init(&world, STATIONS);
    double t0 = seconds_now();
    core_state *state = state_of(&world.desc, NULL, 1);
    double t1 = seconds_now();
    print_message("state of %u cells: %.2f ms, %.1f MB\n", core_state_cell_count(state), 1e3 * (t1 - t0),
                  (double)core_state_bytes(state) / 1048576.0);
    assert_int_equal(core_state_cell_count(state), 10512 + STATIONS);

    /* A change of one cell. */
    velum_layer layer = layer_of(VELUM_GENUS_CB, 0.9f, 500.0f, 11000.0f);
    velum_cell region = cell_of(VELUM_CELL_RECTANGLE, 7, &layer, 1);
    region.lat_deg = 50.0;
    region.lon_deg = 8.5;
    region.half_east_m = 30000.0;
    region.half_north_m = 20000.0;
    region.rotation_deg = 30.0;
    velum_state_desc change = desc_of(&region, 1);
    change.base_state = 1;
    t0 = seconds_now();
    core_state *changed = state_of(&change, state, 2);
    t1 = seconds_now();
    print_message("change of one region: %.2f ms\n", 1e3 * (t1 - t0));
    assert_int_equal(core_state_cell_count(changed), 10512 + STATIONS + 1);

    a_new_place(state, "over Europe, 300 m", 50.0, 8.5, 300.0);
    a_new_place(changed, "beside a sharp region, 300 m", 50.0, 8.5, 300.0);
    a_new_place(state, "over America, 11 km", 40.0, -95.0, 11000.0);
    a_new_place(state, "at the north pole, 1 km", 90.0, 0.0, 1000.0);
    a_new_place(state, "on the antimeridian, 10 km", -17.0, 180.0, 10000.0);
    core_state_unref(changed);
    core_state_unref(state);
    synthetic_world_finish(&world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_real_sized_world_is_made_and_tiled)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
