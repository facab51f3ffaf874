/* Whatever a tile's fields are at a place, they lie within the span of the part that the place is in; and where a part
 * has no span there is nothing. */
#include "synthetic.h"

#include <math.h>

#include "core/geodesy.h"
#include "core/tile_spans.h"

typedef struct span_m {
    float low, high;
    bool none;
} span_m;

static span_m span_of(uint32_t word) {
    return (span_m){velum_texel_height_m((float)(word & 0xffffu) / 65535.0f),
                    velum_texel_height_m((float)(word >> 16) / 65535.0f), word == VELUM_SPAN_NONE};
}

static bool holds(span_m span, float low_m, float high_m) {
    return !span.none && low_m >= span.low && high_m <= span.high;
}

/* How many places of each kind were looked at, how many parts have nothing, how many less than all that the tile has;
 * about how many places it is less. */
typedef struct seen {
    int cloud, hem, fall, empty, tight, narrow;
} seen;

static void look(const core_tile *tile, uint32_t slot, const uint32_t *cloud, const uint32_t *fringe, float s, float t,
                 seen *count) {
    const velum_slot_fields f = core_tile_sample(tile, slot, s, t);
    const core_tile_quad quad = core_tile_quad_at(s, t);
    const velum_span_m about = core_tile_quad_span(tile, slot, quad);
    const float near = fmaxf(0.99f * quad.edge - 1e-4f, 0.0f) / VELUM_TILE_TEXELS; /* rounded places stay in it */
    for (int k = 0; k < 4; k++) {
        const core_tile_quad beside = core_tile_quad_at(s + (k & 1 ? near : -near), t + (k & 2 ? near : -near));
        assert_int_equal(beside.texel, quad.texel);
    }
    const uint32_t part = (uint32_t)(t * VELUM_PARTS) * VELUM_PARTS + (uint32_t)(s * VELUM_PARTS);
    if (f.coverage <= 0.0f) {
        return;
    }
    assert_true(holds(span_of(cloud[part]), f.base_m, f.top_m));
    assert_true(about.low <= f.base_m && about.high >= f.top_m);
    const velum_span_m all = core_tile_slot_span(&tile->slot[slot]);
    count->narrow += about.high - about.low < 0.9f * (all.high - all.low);
    count->cloud++;
    const velum_fringe g = core_tile_fringe(tile, slot, s, t);
    if (g.scud > 0.0f || g.transition_m > 0.0f) {
        const velum_span_m hem = velum_hem_span(f, g);
        assert_true(holds(span_of(fringe[part]), hem.low, hem.high));
        assert_true(about.low <= hem.low && about.high >= hem.high);
        count->hem++;
    }
    if (g.fall > 0.0f) {
        const velum_span_m fall = velum_fall_span(f, g);
        assert_true(holds(span_of(fringe[VELUM_PARTS * VELUM_PARTS + part]), fall.low, fall.high));
        assert_true(about.low <= fall.low && about.high >= fall.high);
        count->fall++;
    }
}

static void look_at_tile(const core_tile *tile, uint64_t *random, seen *count) {
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (!(tile->mask & (1u << slot))) {
            continue;
        }
        uint32_t cloud[VELUM_SPAN_WORDS];
        uint32_t fringe[VELUM_SPAN_WORDS] = {0};
        core_tile_spans(tile, slot, cloud);
        if (tile->slot[slot].fringe) {
            core_tile_spans(tile, VELUM_SLOT_COUNT + slot, fringe);
        }
        for (uint32_t part = 0; part < VELUM_PARTS * VELUM_PARTS; part++) {
            const span_m span = span_of(cloud[part]);
            assert_int_equal(cloud[VELUM_PARTS * VELUM_PARTS + part], VELUM_SPAN_NONE); /* cloud alone does not fall */
            count->empty += span.none;
            count->tight +=
                !span.none && span.high - span.low < 0.9f * (tile->slot[slot].max_top_m - tile->slot[slot].min_base_m);
        }
        for (int i = 0; i < 4000; i++) {
            /* Edges of parts, too: filters reach over them. */
            const float s = i % 4 == 0 ? 0.25f * (float)(i / 4 % 4) : 0.99999f * (float)random_unit(random);
            const float t = i % 7 == 0 ? 0.25f * (float)(i / 7 % 4) : 0.99999f * (float)random_unit(random);
            look(tile, slot, cloud, fringe, s, t, count);
        }
    }
}

/* A wide low layer with rain and scud, over a part of it a high one, both ending within the tiles. */
static void spans_hold(void **state) {
    (void)state;
    velum_layer layers[2] = {layer_of(VELUM_GENUS_NS, 0.9f, 600.0f, 3000.0f),
                             layer_of(VELUM_GENUS_NS, 0.7f, 2500.0f, 6500.0f)};
    layers[0].precipitation = VELUM_PRECIPITATION_RAIN;
    layers[0].precipitation_mm_h = 4.0f;
    layers[0].scud = 0.6f;
    layers[1].transition_m = 150.0f;
    velum_cell cells[2] = {cell_of(VELUM_CELL_RECTANGLE, 1, &layers[0], 1),
                           cell_of(VELUM_CELL_RECTANGLE, 2, &layers[1], 1)};
    for (int i = 0; i < 2; i++) {
        cells[i].lat_deg = 30.0;
        cells[i].lon_deg = 20.0 + 0.2 * i;
        cells[i].half_east_m = cells[i].half_north_m = i == 0 ? 40000.0 : 15000.0;
        cells[i].transition_m = 5000.0;
    }
    const velum_state_desc desc = desc_of(cells, 2);
    core_state *made = state_of(&desc, NULL, 1);
    uint64_t random = 7;
    seen count = {0};
    for (uint32_t level = 5; level <= 10; level++) {
        for (int side = 0; side < 5; side++) {
            double normal[3];
            core_normal(30.0, 20.0 + 0.1 * side, normal);
            const velum_face_place p = velum_face_of((float)normal[0], (float)normal[1], (float)normal[2]);
            core_tile *tile = core_tile_create(made, velum_tile_key(level, (uint32_t)p.face,
                                                                    (uint32_t)velum_tile_coordinate(p.u, level),
                                                                    (uint32_t)velum_tile_coordinate(p.v, level)));
            assert_non_null(tile);
            look_at_tile(tile, &random, &count);
            core_tile_unref(tile);
        }
    }
    core_state_unref(made);
    assert_true(count.cloud > 10000 && count.hem > 1000 && count.fall > 1000);
    /* They tell something. */
    assert_true(count.empty > 20 && count.tight > 20 && count.narrow > 20);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(spans_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
