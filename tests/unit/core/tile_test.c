#include "synthetic.h"

#include "core/geodesy.h"
#include "core/tile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define SIDE VELUM_TILE_SIDE

static uint32_t key_at(double lat_deg, double lon_deg, uint32_t level) {
    double n[3];
    core_normal(lat_deg, lon_deg, n);
    velum_face_place p = velum_face_of((float)n[0], (float)n[1], (float)n[2]);
    return velum_tile_key(level, (uint32_t)p.face, (uint32_t)velum_tile_coordinate(p.u, level),
                          (uint32_t)velum_tile_coordinate(p.v, level));
}

/* All slots at a place, from the tile of that level, as the GPU looks them up. */
static void look_up_all(const core_state *state, const double n[3], uint32_t level,
                        velum_slot_fields out[VELUM_SLOT_COUNT]) {
    velum_face_place p = velum_face_of((float)n[0], (float)n[1], (float)n[2]);
    float x = velum_tile_coordinate(p.u, level);
    float y = velum_tile_coordinate(p.v, level);
    core_tile *tile = core_tile_create(state, velum_tile_key(level, (uint32_t)p.face, (uint32_t)x, (uint32_t)y));
    assert_non_null(tile);
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        out[slot] = core_tile_sample(tile, slot, x - floorf(x), y - floorf(y));
    }
    core_tile_unref(tile);
}

static velum_slot_fields look_up(const core_state *state, const double n[3], uint32_t level, uint32_t slot) {
    velum_slot_fields all[VELUM_SLOT_COUNT];
    look_up_all(state, n, level, all);
    return all[slot];
}

/* Synthetic weather with regions sharp and soft, whose effect crosses a cube edge, a cube corner and a pole. */
typedef struct fixture {
    synthetic_world world;
    core_state *base;
    core_state *state;
} fixture;

static int setup(void **state) {
    static fixture f;
    static velum_layer layer;
    velum_cell regions[4];
    const double places[4][2] = {{10.0, 45.0}, {35.26, 45.0}, {89.0, 10.0}, {-35.0, -135.2}};
    synthetic_world_init(&f.world, 800);
    f.base = state_of(&f.world.desc, NULL, 1);
    layer = layer_of(VELUM_GENUS_CB, 0.9f, 700.0f, 11000.0f);
    for (uint32_t i = 0; i < 4; i++) {
        regions[i] = cell_of(VELUM_CELL_RECTANGLE, 900000 + i, &layer, 1);
        regions[i].flags |= VELUM_CELL_MERGE_LAYERS;
        regions[i].lat_deg = places[i][0];
        regions[i].lon_deg = places[i][1];
        regions[i].half_east_m = 150000.0;
        regions[i].half_north_m = 90000.0;
        regions[i].rotation_deg = 25.0;
        regions[i].transition_m = i < 2 ? 60000.0 : 0.0;
    }
    velum_state_desc change = desc_of(regions, 4);
    change.base_state = 1;
    f.state = state_of(&change, f.base, 2);
    *state = &f;
    return 0;
}

static int teardown(void **state) {
    fixture *f = *state;
    core_state_unref(f->state);
    core_state_unref(f->base);
    synthetic_world_finish(&f->world);
    return 0;
}

static core_look look_at(const velum_slot_fields *f) {
    return (core_look){{[CORE_LOOK_COVERAGE] = f->coverage,
                        [CORE_LOOK_THICKNESS] = f->top_m - f->base_m,
                        [CORE_LOOK_EXTINCTION] = f->extinction_1_m,
                        [CORE_LOOK_KIND] = f->kind,
                        [CORE_LOOK_WIND] = velum_wind_m_s(*f)}};
}

/* That one holds the other, to what texels round off. */
static void expect_look_within(const core_look_range *looks, const core_look_range *held) {
    static const core_look off = {{[CORE_LOOK_COVERAGE] = 2e-5f,
                                   [CORE_LOOK_THICKNESS] = 0.5f,
                                   [CORE_LOOK_KIND] = 2e-5f,
                                   [CORE_LOOK_WIND] = 0.01f}};
    static const core_look off_share = {{[CORE_LOOK_EXTINCTION] = 3e-4f}};
    for (int i = 0; i < CORE_LOOK_VALUES; i++) {
        const float spare = off.value[i] + off_share.value[i] * held->most.value[i];
        assert_true(looks->least.value[i] <= held->least.value[i] + spare);
        assert_true(looks->most.value[i] >= held->most.value[i] - spare);
    }
}

static void texels_hold_the_column(void **state) {
    const fixture *f = *state;
    const uint32_t keys[] = {key_at(50.0, 8.0, 4), key_at(40.0, -90.0, 6), key_at(90.0, 0.0, 5), key_at(10.0, 45.2, 6)};
    uint32_t compared = 0;
    uint32_t covered = 0;
    for (size_t k = 0; k < 4; k++) {
        core_look_range seen[VELUM_SLOT_COUNT];
        uint32_t count[VELUM_SLOT_COUNT] = {0};
        core_tile *tile = core_tile_create(f->state, keys[k]);
        assert_non_null(tile);
        assert_int_equal(tile->key, keys[k]);
        for (uint32_t j = 0; j < SIDE; j++) {
            for (uint32_t i = 0; i < SIDE; i++) {
                core_column c;
                double n[3];
                core_tile_normal(keys[k], (i - 0.5) / 32.0, (j - 0.5) / 32.0, n);
                core_column_layers(f->state, n, core_tile_texel_m(velum_tile_key_level(keys[k])), &c);
                for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
                    const core_tile_slot *s = &tile->slot[slot];
                    const uint32_t at = (j * SIDE + i) * 4;
                    if (c.slot[slot].coverage > 1e-4f) {
                        assert_non_null(s->a);
                        assert_float_equal(s->a[at] / 65535.0f, c.slot[slot].coverage, 2e-5f);
                        assert_float_equal(velum_texel_height_m(s->a[at + 1] / 65535.0f), c.slot[slot].base_m, 0.5f);
                        assert_float_equal(velum_texel_height_m(s->a[at + 2] / 65535.0f), c.slot[slot].top_m, 0.5f);
                        assert_float_equal(velum_texel_extinction_1_m(s->a[at + 3] / 65535.0f) /
                                               c.slot[slot].extinction_1_m,
                                           1.0f, 3e-4f);
                        assert_float_equal(velum_texel_wind_m_s(s->b[at] / 65535.0f), c.slot[slot].wind_x_m_s, 0.01f);
                        assert_float_equal(velum_texel_wind_m_s(s->b[at + 2] / 65535.0f), c.slot[slot].wind_z_m_s,
                                           0.01f);
                        assert_float_equal(s->b[at + 3] / 65535.0f, c.slot[slot].kind, 2e-5f);
                        assert_true(s->min_base_m <= c.slot[slot].base_m + 0.5f);
                        assert_true(s->max_top_m >= c.slot[slot].top_m - 0.5f);
                        const core_look look = look_at(&c.slot[slot]);
                        const core_look_range here = {look, look};
                        expect_look_within(&s->looks, &here);
                        seen[slot] = count[slot] ? seen[slot] : here;
                        core_look_widen(&seen[slot], &here);
                        count[slot]++;
                        compared++;
                    } else if (s->a) {
                        assert_true(s->a[at] < 10);
                        assert_true(s->looks.least.value[CORE_LOOK_COVERAGE] <= 10.0f / 65535.0f);
                    }
                }
            }
        }
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            if (count[slot] == SIDE * SIDE) {
                expect_look_within(&seen[slot], &tile->slot[slot].looks);
                covered++;
            }
        }
        core_tile_unref(tile);
    }
    assert_true(compared > 5000 && covered > 0);
}

static void the_same_input_gives_the_same_bits(void **state) {
    const fixture *f = *state;
    for (uint32_t level = 3; level <= 12; level += 3) {
        core_tile *a = core_tile_create(f->state, key_at(10.0, 45.0, level));
        core_tile *b = core_tile_create(f->state, key_at(10.0, 45.0, level));
        assert_non_null(a);
        assert_non_null(b);
        assert_true(a->mask != 0 && a->mask == b->mask && a->bytes == b->bytes);
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            if (a->mask & (1u << slot)) {
                assert_memory_equal(a->slot[slot].a, b->slot[slot].a, CORE_TILE_PAGE_BYTES);
                assert_memory_equal(a->slot[slot].b, b->slot[slot].b, CORE_TILE_PAGE_BYTES);
            }
        }
        core_tile_unref(a);
        core_tile_unref(b);
    }
}

/* Two neighbours of a face share two columns (or rows) of texels: apron and first texel. */
static void neighbours_agree_bit_for_bit(void **state) {
    const fixture *f = *state;
    const double places[][2] = {{50.0, 8.0}, {10.0, 44.0}, {89.3, 12.0}, {-35.3, -134.0}, {40.0, -90.0}};
    uint32_t compared = 0;
    for (size_t k = 0; k < sizeof places / sizeof *places; k++) {
        for (uint32_t level = 5; level <= 12; level++) {
            uint32_t key = key_at(places[k][0], places[k][1], level);
            uint32_t x = velum_tile_key_x(key) & ~1u;
            uint32_t y = velum_tile_key_y(key);
            uint32_t face = velum_tile_key_face(key);
            core_tile *left = core_tile_create(f->state, velum_tile_key(level, face, x, y));
            core_tile *right = core_tile_create(f->state, velum_tile_key(level, face, x + 1, y));
            assert_non_null(left);
            assert_non_null(right);
            for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
                const core_tile_slot *l = &left->slot[slot];
                const core_tile_slot *r = &right->slot[slot];
                for (uint32_t j = 0; j < SIDE; j++) {
                    for (uint32_t i = 0; i < 2; i++) {
                        uint32_t at_l = (j * SIDE + 32 + i) * 4;
                        uint32_t at_r = (j * SIDE + i) * 4;
                        uint16_t c_l = l->a ? l->a[at_l] : 0;
                        uint16_t c_r = r->a ? r->a[at_r] : 0;
                        assert_int_equal(c_l, c_r);
                        if (c_l > 0) {
                            assert_memory_equal(l->a + at_l, r->a + at_r, 8);
                            assert_memory_equal(l->b + at_l, r->b + at_r, 8);
                            compared++;
                        }
                    }
                }
            }
            core_tile_unref(left);
            core_tile_unref(right);
        }
    }
    assert_true(compared > 2000);
}

/* Crossing an edge, a corner of the cube or a pole by 2 cm, fields change as little as elsewhere. */
static void faces_fit_together(void **state) {
    const fixture *f = *state;
    double worst = 0.0;
    double highest = 0.0;
    uint32_t compared = 0;
    for (uint32_t face = 0; face < 6; face++) {
        for (int k = -12; k <= 12; k++) {
            double along = k / 12.0 * 0.99999;
            for (uint32_t level = 6; level <= 11; level += 5) {
                double inner[3];
                double outer[3];
                core_face_normal(face, 1.0 - 1e-6, along, inner);
                core_face_normal(face, 1.0 + 1e-6, along, outer);
                velum_slot_fields inside[VELUM_SLOT_COUNT];
                velum_slot_fields outside[VELUM_SLOT_COUNT];
                look_up_all(f->state, inner, level, inside);
                look_up_all(f->state, outer, level, outside);
                for (uint32_t slot = 0; slot <= VELUM_SLOT_STORM; slot += VELUM_SLOT_STORM) {
                    velum_slot_fields a = inside[slot];
                    velum_slot_fields b = outside[slot];
                    worst = fmax(worst, fabs((double)a.coverage - (double)b.coverage));
                    if (a.coverage > 0.05f && b.coverage > 0.05f) {
                        highest = fmax(highest, fabs((double)a.base_m - (double)b.base_m));
                        assert_float_equal(a.wind_x_m_s, b.wind_x_m_s, 0.2f);
                        assert_float_equal(a.wind_z_m_s, b.wind_z_m_s, 0.2f);
                        compared++;
                    }
                }
            }
        }
    }
    print_message("over the cube's edges: coverage within %.4f, base within %.2f m\n", worst, highest);
    assert_true(compared > 100);
    assert_true(worst < 0.01);
    assert_true(highest < 5.0);
}

/* The half contour of a sharp region of 100 km half-width, read from tiles as the GPU reads them. */
static void a_sharp_edge_lies_where_geodesics_say(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_AS, 1.0f, 3000.0f, 4000.0f);
    velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, &layer, 1);
    const double lats[] = {0.0, 35.2, 50.0, 89.5};
    cell.lon_deg = 44.0;
    cell.half_east_m = cell.half_north_m = 100000.0;
    cell.rotation_deg = 13.0;
    for (uint32_t level = 12; level >= 10; level -= 2) {
        double worst = 0.0;
        for (size_t k = 0; k < 4; k++) {
            cell.lat_deg = lats[k];
            velum_state_desc desc = desc_of(&cell, 1);
            core_state *state = state_of(&desc, NULL, 1);
            for (int a = 0; a < 12; a++) {
                double angle = (a * 30.0 + 7.0) * CORE_DEG;
                double expected = 100000.0 / fmax(fabs(sin(angle)), fabs(cos(angle)));
                double low = expected - 1500.0;
                double high = expected + 1500.0;
                for (int i = 0; i < 24; i++) {
                    double middle = 0.5 * (low + high);
                    double lat;
                    double lon;
                    double n[3];
                    assert_true(core_geodesic_direct(cell.lat_deg, cell.lon_deg, a * 30.0 + 7.0 + cell.rotation_deg,
                                                     middle, &lat, &lon));
                    core_normal(lat, lon, n);
                    *(look_up(state, n, level, VELUM_SLOT_MIDDLE).coverage > 0.5f ? &low : &high) = middle;
                }
                worst = fmax(worst, fabs(0.5 * (low + high) - expected));
            }
            core_state_unref(state);
        }
        print_message("edge at 100 km in tiles of level %u (texel %.0f m): within %.2f m\n", level,
                      core_tile_texel_m(level), worst);
        assert_true(worst < (level == 12 ? 10.0 : 40.0));
    }
}

static void empty_texels_take_their_neighbours_heights(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_AS, 0.8f, 3000.0f, 4000.0f);
    velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, &layer, 1);
    cell.lat_deg = 20.0;
    cell.lon_deg = 20.0;
    cell.half_east_m = cell.half_north_m = 700.0;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    core_tile *tile = core_tile_create(state, key_at(20.0, 20.0, 12));
    assert_non_null(tile);
    assert_int_equal(tile->mask, 1u << VELUM_SLOT_MIDDLE);
    uint32_t empty = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        empty += tile->slot[VELUM_SLOT_MIDDLE].a[i * 4] == 0;
        assert_float_equal(velum_texel_height_m(tile->slot[VELUM_SLOT_MIDDLE].a[i * 4 + 1] / 65535.0f), 3000.0f, 0.5f);
        assert_float_equal(velum_texel_wind_m_s(tile->slot[VELUM_SLOT_MIDDLE].b[i * 4] / 65535.0f), 0.0f, 0.01f);
    }
    assert_true(empty > 300);
    core_tile_unref(tile);
    /* Far away there is no page at all. */
    tile = core_tile_create(state, key_at(20.0, 30.0, 12));
    assert_non_null(tile);
    assert_int_equal(tile->mask, 0);
    assert_null(tile->slot[VELUM_SLOT_MIDDLE].a);
    core_tile_unref(tile);
    core_state_unref(state);
}

/* What a coarser data tile says instead of the key's own differs little. */
static void the_detail_level_is_enough(void **state) {
    const fixture *f = *state;
    const double around[][2] = {{50.0, 8.0}, {10.0, 45.0}, {89.5, 0.0}, {-35.0, -135.0}, {35.26, 45.0}};
    uint64_t seed = 5;
    double worst = 0.0;
    double mean = 0.0;
    uint32_t compared = 0;
    uint32_t coarser = 0;
    for (int i = 0; i < 600; i++) {
        double lat = fmin(around[i % 5][0] + 4.0 * random_unit(&seed) - 2.0, 89.999);
        double lon = around[i % 5][1] + 8.0 * random_unit(&seed) - 4.0;
        uint32_t level = 7 + (uint32_t)i % 6u;
        double n[3];
        uint32_t key = key_at(lat, lon, level);
        uint32_t detail = core_tile_detail_level(f->state, key);
        assert_true(detail <= level && detail >= VELUM_TILE_DATA_LEVEL_MIN);
        core_normal(lat, lon, n);
        coarser += detail < level;
        velum_slot_fields fine[VELUM_SLOT_COUNT];
        velum_slot_fields data[VELUM_SLOT_COUNT];
        look_up_all(f->state, n, level, fine);
        look_up_all(f->state, n, detail, data);
        for (uint32_t slot = 0; slot < VELUM_SLOT_UNIFORM; slot++) {
            double off = fabs((double)fine[slot].coverage - (double)data[slot].coverage);
            worst = fmax(worst, off);
            mean += off;
            compared++;
        }
    }
    print_message("data tiles for finer keys (%u of 600): coverage within %.4f, mean %.5f\n", coarser, worst,
                  mean / compared);
    assert_true(coarser > 300);
    assert_true(worst < 0.05);
    assert_true(mean / compared < 0.001);
}

static void sharp_edges_are_refined_and_others_not(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_AS, 1.0f, 3000.0f, 4000.0f);
    velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, &layer, 1);
    double lat;
    double lon;
    cell.lat_deg = 50.0;
    cell.half_east_m = cell.half_north_m = 100000.0;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    assert_true(core_geodesic_direct(50.0, 0.0, 90.0, 100000.0, &lat, &lon));
    for (uint32_t level = 1; level <= 12; level++) {
        assert_int_equal(core_tile_detail_level(state, key_at(lat, lon, level)), level);
    }
    assert_int_equal(core_tile_detail_level(state, key_at(-20.0, 100.0, 12)), VELUM_TILE_DATA_LEVEL_MIN);
    /* The middle is 100 km from the edge: a few of its texels. */
    assert_true(core_tile_detail_level(state, key_at(50.0, 0.0, 12)) <= 4);
    core_state_unref(state);

    cell.transition_m = 40000.0;
    state = state_of(&desc, NULL, 1);
    assert_true(core_tile_detail_level(state, key_at(lat, lon, 12)) <= 6);
    core_state_unref(state);

    cell = cell_of(VELUM_CELL_STATION, 1, &layer, 1);
    cell.lat_deg = 50.0;
    state = state_of(&desc, NULL, 1);
    assert_int_equal(core_tile_detail_level(state, key_at(50.0, 0.0, 12)), 6); /* 60 km / 8: texels of 4.9 km */
    core_state_unref(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(texels_hold_the_column),
        cmocka_unit_test(the_same_input_gives_the_same_bits),
        cmocka_unit_test(neighbours_agree_bit_for_bit),
        cmocka_unit_test(faces_fit_together),
        cmocka_unit_test(a_sharp_edge_lies_where_geodesics_say),
        cmocka_unit_test(empty_texels_take_their_neighbours_heights),
        cmocka_unit_test(the_detail_level_is_enough),
        cmocka_unit_test(sharp_edges_are_refined_and_others_not),
    };
    return cmocka_run_group_tests(tests, setup, teardown);
}
