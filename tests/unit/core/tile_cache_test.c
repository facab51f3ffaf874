#include "synthetic.h"

#include "core/tile_cache.h"

static velum_layer layer;
static velum_cell cell;

static core_state *a_state(uint64_t id) {
    layer = layer_of(VELUM_GENUS_SC, 0.9f, 500.0f, 1200.0f);
    cell = cell_of(VELUM_CELL_GLOBAL, 1, &layer, 1);
    velum_state_desc desc = desc_of(&cell, 1);
    return state_of(&desc, NULL, id);
}

static void a_tile_is_rasterised_once(void **unused) {
    (void)unused;
    core_state *state = a_state(1);
    core_state *other = a_state(2);
    core_tile_cache *cache = core_tile_cache_create(0);
    uint32_t key = velum_tile_key(5, 2, 3, 4);
    assert_non_null(cache);
    assert_null(core_tile_cache_find(cache, 1, key));
    core_tile *a = core_tile_cache_get(cache, state, key);
    core_tile *b = core_tile_cache_get(cache, state, key);
    core_tile *c = core_tile_cache_get(cache, other, key);
    assert_non_null(a);
    assert_ptr_equal(a, b);
    assert_ptr_not_equal(a, c);
    assert_int_equal(core_tile_cache_get_info(cache).rasterised, 2);
    assert_int_equal(core_tile_cache_get_info(cache).resident, 2);
    assert_int_equal(core_tile_cache_get_info(cache).bytes, a->bytes + c->bytes);
    core_tile_cache_forget(cache, 1);
    assert_null(core_tile_cache_find(cache, 1, key));
    assert_int_equal(core_tile_cache_get_info(cache).resident, 1);
    assert_int_equal(a->key, key); /* held, so alive */
    core_tile_cache_destroy(cache);
    assert_int_equal(c->state, 2);
    core_tile_unref(a);
    core_tile_unref(b);
    core_tile_unref(c);
    core_tile_cache_destroy(NULL);
    core_state_unref(state);
    core_state_unref(other);
}

static void the_least_recently_used_goes_first(void **unused) {
    (void)unused;
    core_state *state = a_state(1);
    core_tile *one = core_tile_create(state, velum_tile_key(6, 0, 0, 0));
    assert_non_null(one);
    core_tile_cache *cache = core_tile_cache_create(one->bytes * 4);
    assert_non_null(cache);
    for (uint32_t x = 0; x < 40; x++) {
        core_tile_unref(core_tile_cache_get(cache, state, velum_tile_key(6, 0, x, 0)));
        core_tile_unref(core_tile_cache_find(cache, 1, velum_tile_key(6, 0, 0, 0))); /* always in use */
        assert_true(core_tile_cache_get_info(cache).bytes <= one->bytes * 4);
    }
    assert_int_equal(core_tile_cache_get_info(cache).rasterised, 40);
    assert_int_equal(core_tile_cache_get_info(cache).resident, 4);
    core_tile *first = core_tile_cache_find(cache, 1, velum_tile_key(6, 0, 0, 0));
    core_tile *last = core_tile_cache_find(cache, 1, velum_tile_key(6, 0, 39, 0));
    assert_non_null(first);
    assert_non_null(last);
    assert_null(core_tile_cache_find(cache, 1, velum_tile_key(6, 0, 20, 0)));
    core_tile_unref(first);
    core_tile_unref(last);
    core_tile_unref(one);
    core_tile_cache_destroy(cache);
    core_state_unref(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_tile_is_rasterised_once),
        cmocka_unit_test(the_least_recently_used_goes_first),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
