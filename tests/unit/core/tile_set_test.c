#include "synthetic.h"

#include "core/geodesy.h"
#include "core/tile_set.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static velum_layer layer;
static velum_cell cells[2];

static core_state *a_state(void) {
    layer = layer_of(VELUM_GENUS_CB, 0.9f, 500.0f, 12000.0f);
    cells[0] = cell_of(VELUM_CELL_GLOBAL, 1, &layer, 1);
    cells[1] = cell_of(VELUM_CELL_RECTANGLE, 2, &layer, 1);
    cells[1].lat_deg = 50.0;
    cells[1].lon_deg = 8.0;
    cells[1].half_east_m = cells[1].half_north_m = 40000.0;
    velum_state_desc desc = desc_of(cells, 2);
    return state_of(&desc, NULL, 1);
}

static bool has_key(const core_tile_set *set, uint32_t key) {
    uint32_t low = 0;
    uint32_t high = set->key_count;
    while (low < high) {
        uint32_t middle = (low + high) / 2;
        if (set->keys[middle] < key) {
            low = middle + 1;
        } else {
            high = middle;
        }
    }
    return low < set->key_count && set->keys[low] == key;
}

static const double places[][3] = {{50.0, 8.0, 300.0},      {90.0, 0.0, 1000.0},     {-90.0, 0.0, 15000.0},
                                   {0.0, 45.0, 20.0},       {35.2644, 45.0, 5000.0}, {-17.0, 180.0, 11000.0},
                                   {-35.2644, -135.0, 2.0}, {45.0, 90.0, 30000.0},   {12.0, -70.0, 400000.0}};
#define PLACES (sizeof places / sizeof *places)

/* Every point of cloud within the distance, looked up as the GPU does in float, finds its key; also after the eye has
 * moved by 5 % of the point's distance. */
static void whatever_is_asked_for_is_in_the_set(void **unused) {
    (void)unused;
    const float details[] = {1.0f, 0.5f, 2.0f};
    core_state *state = a_state();
    const core_state *const states[1] = {state};
    uint64_t seed = 3;
    uint32_t asked = 0;
    for (size_t k = 0; k < PLACES * 3; k++) {
        core_tile_eye eye = {.detail = details[k / PLACES]};
        core_geodetic at = {places[k % PLACES][0], places[k % PLACES][1], places[k % PLACES][2]};
        core_tile_set set = {0};
        double up[3];
        double east[3];
        double north[3];
        assert_true(core_ecef_from_geodetic(&at, eye.position_ecef_m));
        core_normal(at.lat_deg, at.lon_deg, up);
        core_east_north(up, east, north);
        assert_int_equal(core_tile_set_init(&set, &eye, states, 1, NULL), VELUM_OK);
        for (int i = 0; i < 20000; i++) {
            double azimuth = 2.0 * CORE_PI * random_unit(&seed);
            double distance = exp(log(10.0) + random_unit(&seed) * log(set.distance_m / 10.0));
            double tilt = asin(2.0 * random_unit(&seed) - 1.0) * (i % 2 ? 1.0 : 0.05);
            double moved[3];
            double to[3];
            core_geodetic there;
            double n[3];
            double d2 = 0.0;
            for (int c = 0; c < 3; c++) {
                double flat = cos(azimuth) * north[c] + sin(azimuth) * east[c];
                to[c] = eye.position_ecef_m[c] + distance * (cos(tilt) * flat + sin(tilt) * up[c]);
            }
            assert_true(core_geodetic_from_ecef(to, &there));
            if (there.height_m < 500.0 || there.height_m > 12000.0) {
                /* Under or over the cloud: take the place beneath it at a height within. */
                there.height_m = 500.0 + 11500.0 * random_unit(&seed);
                assert_true(core_ecef_from_geodetic(&there, to));
            }
            for (int c = 0; c < 3; c++) {
                d2 += (to[c] - eye.position_ecef_m[c]) * (to[c] - eye.position_ecef_m[c]);
            }
            if (sqrt(d2) * 1.06 > set.distance_m) {
                continue;
            }
            double step = i % 3 == 0 ? 0.0 : 0.049 * sqrt(d2);
            double turn = 2.0 * CORE_PI * random_unit(&seed);
            double now2 = 0.0;
            for (int c = 0; c < 3; c++) {
                moved[c] = eye.position_ecef_m[c] + step * (cos(turn) * north[c] + sin(turn) * east[c]);
                now2 += (to[c] - moved[c]) * (to[c] - moved[c]);
            }
            core_normal(there.lat_deg, there.lon_deg, n);
            uint32_t level = velum_tile_level((float)sqrt(now2), eye.detail);
            velum_face_place p = velum_face_of((float)n[0], (float)n[1], (float)n[2]);
            uint32_t key = velum_tile_key(level, (uint32_t)p.face, (uint32_t)velum_tile_coordinate(p.u, level),
                                          (uint32_t)velum_tile_coordinate(p.v, level));
            if (!has_key(&set, key)) {
                print_error("eye %zu, distance %.1f m, level %u: not in the set\n", k, sqrt(now2), level);
            }
            assert_true(has_key(&set, key));
            asked++;
        }
        assert_true(set.key_count < 12000);
        core_tile_set_finish(&set);
    }
    assert_true(asked > 150000);
    core_state_unref(state);
}

static void a_set_is_in_order_and_repeats(void **unused) {
    (void)unused;
    core_state *state = a_state();
    velum_state_desc change = desc_of(&cells[1], 1);
    cells[1].lat_deg = 50.2;
    change.base_state = 1;
    core_state *other = state_of(&change, state, 2);
    const core_state *const states[2] = {state, other};
    core_tile_eye eye = {.detail = 1.0f};
    core_geodetic at = {50.0, 8.1, 500.0};
    core_tile_set a = {0};
    core_tile_set b = {0};
    core_tile_set one = {0};
    assert_true(core_ecef_from_geodetic(&at, eye.position_ecef_m));
    assert_int_equal(core_tile_set_init(&a, &eye, states, 2, NULL), VELUM_OK);
    assert_int_equal(core_tile_set_init(&b, &eye, states, 2, NULL), VELUM_OK);
    assert_int_equal(core_tile_set_init(&one, &eye, states, 1, NULL), VELUM_OK);
    assert_true(a.key_count > 500 && a.key_count == b.key_count && a.data_count == b.data_count);
    assert_memory_equal(a.keys, b.keys, a.key_count * sizeof *a.keys);
    assert_memory_equal(a.data, b.data, a.key_count * sizeof *a.data);
    assert_memory_equal(a.data_keys, b.data_keys, a.data_count * sizeof *a.data_keys);
    assert_int_equal(a.key_count, one.key_count); /* the same heights: the same keys */
    for (uint32_t i = 0; i < a.key_count; i++) {
        uint32_t data_key = a.data_keys[a.data[i]];
        uint32_t detail = core_tile_detail_level(state, a.keys[i]);
        uint32_t detail_b = core_tile_detail_level(other, a.keys[i]);
        assert_true(i == 0 || a.keys[i] > a.keys[i - 1]);
        assert_true(a.data[i] < a.data_count);
        /* The finer of the two states' needs, and the same as asked for one key. */
        assert_int_equal(velum_tile_key_level(data_key), detail > detail_b ? detail : detail_b);
        assert_int_equal(core_tile_ancestor(a.keys[i], velum_tile_key_level(data_key)), data_key);
    }
    for (uint32_t i = 1; i < a.data_count; i++) {
        assert_true(a.data_nearest_m[i] >= a.data_nearest_m[i - 1]);
    }
    core_tile_set_finish(&a);
    core_tile_set_finish(&b);
    core_tile_set_finish(&one);
    core_tile_set_finish(NULL);
    core_state_unref(other);
    core_state_unref(state);
}

static uint32_t some_page(void *context, uint32_t state, uint32_t data_key, uint32_t slot) {
    (void)context;
    return slot == VELUM_SLOT_STORM ? (data_key * 7u + state) % 5000u : VELUM_PAGE_NONE;
}

static void the_table_finds_every_key_and_no_other(void **unused) {
    (void)unused;
    core_state *state = a_state();
    const core_state *const states[2] = {state, state};
    core_tile_eye eye = {.detail = 1.0f};
    core_geodetic at = {50.0, 8.1, 500.0};
    core_tile_set set = {0};
    assert_true(core_ecef_from_geodetic(&at, eye.position_ecef_m));
    assert_int_equal(core_tile_set_init(&set, &eye, states, 2, NULL), VELUM_OK);
    uint32_t entries = core_tile_table_entries(set.key_count);
    assert_true(entries >= 2 * set.key_count && (entries & (entries - 1)) == 0);
    uint32_t *words = malloc((size_t)entries * VELUM_TABLE_WORDS * sizeof *words);
    assert_non_null(words);
    core_tile_table_build(&set, 2, some_page, NULL, words, entries);
    uint32_t used = 0;
    for (uint32_t i = 0; i < entries; i++) {
        used += words[(size_t)i * VELUM_TABLE_WORDS] != VELUM_TILE_KEY_NONE;
    }
    assert_int_equal(used, set.key_count);
    for (uint32_t i = 0; i < set.key_count; i++) {
        uint32_t data_key = set.data_keys[set.data[i]];
        const uint32_t *entry = core_tile_table_find(words, entries, set.keys[i]);
        assert_non_null(entry);
        assert_int_equal(entry[1], velum_tile_key_level(data_key));
        assert_int_equal(entry[2], 1u << VELUM_SLOT_STORM);
        assert_int_equal(entry[VELUM_TABLE_PAGES + VELUM_SLOT_STORM] & 0xffffu, data_key * 7u % 5000u);
        assert_int_equal(entry[VELUM_TABLE_PAGES + VELUM_SLOT_STORM] >> 16, (data_key * 7u + 1u) % 5000u);
        assert_int_equal(entry[VELUM_TABLE_PAGES + VELUM_SLOT_LOW], 0xffffffffu);
    }
    for (uint32_t x = 0; x < 4096; x++) {
        uint32_t key = velum_tile_key(12, 5, x, 77);
        assert_true((core_tile_table_find(words, entries, key) != NULL) == has_key(&set, key));
    }
    free(words);
    core_tile_set_finish(&set);
    core_state_unref(state);
}

static void hostile_eyes_are_refused(void **unused) {
    (void)unused;
    core_state *state = a_state();
    const core_state *const states[1] = {state};
    const core_tile_eye good = {.position_ecef_m = {6378137.0, 0.0, 0.0}, .detail = 1.0f};
    core_tile_set set = {0};
    core_error error = {0};
#define CASE(change, expected)                                                                                         \
    do {                                                                                                               \
        core_tile_eye eye = good;                                                                                      \
        eye.change;                                                                                                    \
        assert_int_equal(core_tile_set_init(&set, &eye, states, 1, &error), VELUM_ERROR_ARGUMENT);                     \
        assert_non_null(strstr(error.text, expected));                                                                 \
        assert_null(set.keys);                                                                                         \
    } while (0)
    CASE(position_ecef_m[1] = (double)NAN, "position_ecef_m[1]");
    CASE(position_ecef_m[2] = (double)INFINITY, "position_ecef_m[2]");
    CASE(detail = 0.0f, "detail");
    CASE(detail = NAN, "detail");
    CASE(detail = 100.0f, "detail");
    CASE(distance_m = -1.0, "distance_m");
    CASE(distance_m = (double)NAN, "distance_m");
#undef CASE
    /* The centre of the earth and deep space are places, if odd ones. */
    core_tile_eye eye = good;
    eye.position_ecef_m[0] = 0.0;
    assert_true(core_tile_set_init(&set, &eye, states, 1, &error) >= 0);
    core_tile_set_finish(&set);
    eye.position_ecef_m[0] = 9e8;
    assert_true(core_tile_set_init(&set, &eye, states, 1, &error) >= 0);
    core_tile_set_finish(&set);
    /* No weather: nothing is wanted. */
    const core_state *const none[2] = {NULL, NULL};
    assert_int_equal(core_tile_set_init(&set, &good, none, 2, &error), VELUM_OK);
    assert_int_equal(set.key_count, 0);
    core_tile_set_finish(&set);
    core_state_unref(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(whatever_is_asked_for_is_in_the_set),
        cmocka_unit_test(a_set_is_in_order_and_repeats),
        cmocka_unit_test(the_table_finds_every_key_and_no_other),
        cmocka_unit_test(hostile_eyes_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
