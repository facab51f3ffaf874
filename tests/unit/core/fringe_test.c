/* Scud and precipitation in tiles and queries: nothing outside its bounds, anywhere; the cloud proper as without. */
#include "synthetic.h"

#include <math.h>
#include <string.h>

#include "core/geodesy.h"
#include "core/tile_bounds.h"

typedef struct fixture {
    const core_noise *noise;
    core_tile_cache *cache;
    core_state *dry, *wet, *virga;
} fixture;

static velum_layer wet_layer(int32_t genus, float coverage, float base_m, float top_m, float rate_mm_h, float scud) {
    velum_layer layer = layer_of(genus, coverage, base_m, top_m);
    layer.precipitation_mm_h = rate_mm_h;
    layer.precipitation = rate_mm_h > 0.0f ? VELUM_PRECIPITATION_RAIN : VELUM_PRECIPITATION_NONE;
    layer.scud = scud;
    layer.wind_east_m_s = 15.0f;
    return layer;
}

static int set_up(void **state) {
    static fixture f;
    f.noise = core_noise_built();
    f.cache = core_tile_cache_create(0);
    f.dry = state_of_layer(wet_layer(VELUM_GENUS_NS, 0.9f, 1500.0f, 4500.0f, 0.0f, 0.0f), 1);
    f.wet = state_of_layer(wet_layer(VELUM_GENUS_NS, 0.9f, 1500.0f, 4500.0f, 8.0f, 0.7f), 2);
    f.virga = state_of_layer(wet_layer(VELUM_GENUS_AS, 1.0f, 3400.0f, 5000.0f, 0.1f, 0.0f), 3);
    *state = &f;
    return f.cache ? 0 : -1;
}

static int tear_down(void **state) {
    fixture *f = *state;
    core_state_unref(f->dry);
    core_state_unref(f->wet);
    core_state_unref(f->virga);
    core_tile_cache_destroy(f->cache);
    return 0;
}

static core_oracle oracle_of(const fixture *f, const core_state *a, const core_state *b, double time_s) {
    return oracle_over(f->noise, f->cache, a, b, time_s);
}

static float extinction_at(const core_oracle *oracle, double lat_deg, double lon_deg, double height_m) {
    const core_geodetic place = {lat_deg, lon_deg, height_m};
    double ecef_m[3];
    float extinction = -1.0f;
    assert_true(core_ecef_from_geodetic(&place, ecef_m));
    assert_int_equal(core_oracle_extinction(oracle, ecef_m, 0.0, &extinction, NULL), VELUM_OK);
    return extinction;
}

/* Mean over a line of 100 km. */
static double mean_at(const core_oracle *oracle, double height_m) {
    double sum = 0.0;
    for (int i = 0; i < 400; i++) {
        sum += (double)extinction_at(oracle, 47.0, 8.0 + 0.0033 * i, height_m);
    }
    return sum / 400.0;
}

static void the_cloud_proper_stays_as_it_is(void **state) {
    const fixture *f = *state;
    const core_oracle dry = oracle_of(f, f->dry, f->dry, 100.0);
    const core_oracle wet = oracle_of(f, f->wet, f->wet, 100.0);
    /* Over what joins the cloud to what hangs below it. */
    const double from_m = 1500.0 + (double)VELUM_FALL_JOIN_MOST_M + 1.0;
    for (int i = 0; i < 300; i++) {
        const double h = from_m + 10.0 * i;
        const float a = extinction_at(&dry, 47.0, 8.0 + 0.01 * i, h);
        const float b = extinction_at(&wet, 47.0, 8.0 + 0.01 * i, h);
        assert_memory_equal(&a, &b, sizeof a);
    }
    for (double h = 0.0; h < 1500.0; h += 50.0) {
        assert_true(extinction_at(&dry, 47.0, 8.0, h) == 0.0f);
    }
}

static void rain_comes_down_and_virga_does_not(void **state) {
    const fixture *f = *state;
    const core_oracle wet = oracle_of(f, f->wet, f->wet, 100.0);
    const core_oracle virga = oracle_of(f, f->virga, f->virga, 100.0);
    /* Most of the sheet's columns are thick; a tenth is open, its streaks average out. */
    const double full = (double)velum_fall_extinction_1_m(velum_fall_left(powf(8.0f, 0.25f), 1400.0f), VELUM_FALL_RAIN);
    const double ground = mean_at(&wet, 100.0);
    assert_true(ground > 0.55 * full && ground < full);
    double last = 1.0;
    for (double h = 3300.0; h > 600.0; h -= 300.0) {
        const double now = mean_at(&virga, h);
        assert_true(now < last || now == 0.0);
        last = now;
    }
    assert_true(mean_at(&virga, 3300.0) > 0.0);
    assert_true(mean_at(&virga, 1000.0) == 0.0);
}

static void a_state_that_dries_up_does_so_evenly(void **state) {
    const fixture *f = *state;
    core_oracle mixed = oracle_of(f, f->wet, f->dry, 100.0);
    double last = 1e9;
    for (int i = 0; i <= 10; i++) {
        mixed.blend = 0.1f * (float)i;
        const double now = mean_at(&mixed, 400.0);
        assert_true(i == 0 || now < last || now == 0.0);
        last = now;
    }
    assert_true(last == 0.0);
    mixed.blend = 0.0f;
    const core_oracle wet = oracle_of(f, f->wet, f->wet, 100.0);
    assert_true(fabs(mean_at(&mixed, 400.0) / mean_at(&wet, 400.0) - 1.0) < 1e-5);
}

static void lines_see_what_points_see(void **state) {
    const fixture *f = *state;
    const core_oracle wet = oracle_of(f, f->wet, f->wet, 100.0);
    const core_geodetic ends[2] = {{47.0, 8.0, 300.0}, {47.0, 8.03, 320.0}};
    double from[3], to[3];
    assert_true(core_ecef_from_geodetic(&ends[0], from) && core_ecef_from_geodetic(&ends[1], to));
    double sum = 0.0;
    double length_m = 0.0;
    const int steps = 4000;
    for (int axis = 0; axis < 3; axis++) {
        length_m += (to[axis] - from[axis]) * (to[axis] - from[axis]);
    }
    length_m = sqrt(length_m);
    for (int i = 0; i < steps; i++) {
        double at[3];
        float own = 0.0f;
        for (int axis = 0; axis < 3; axis++) {
            at[axis] = from[axis] + (to[axis] - from[axis]) * (i + 0.5) / steps;
        }
        assert_int_equal(core_oracle_extinction(&wet, at, 0.0, &own, NULL), VELUM_OK);
        sum += (double)own * length_m / steps;
    }
    core_oracle_line line;
    assert_int_equal(core_oracle_along(&wet, from, to, 0.0, 1e-4f, &line, NULL), VELUM_OK);
    assert_true(sum > 0.5 && fabs(line.optical_depth / sum - 1.0) < 2e-3);
    assert_true(line.has_contact);
    core_oracle_point point;
    assert_int_equal(core_oracle_at(&wet, from, 0.0, &point, NULL), VELUM_OK);
    assert_true(point.precipitation_mm_h == 8.0f && point.visibility_m < 10000.0f);
}

static uint32_t next(uint32_t *random) {
    *random = *random * 747796405u + 2891336453u;
    return *random;
}

static float unit(uint32_t *random) {
    return (float)(next(random) >> 8) * 0x1p-24f;
}

/* Any rank and noise that a column can have, anywhere in a tile that lies across the edge of a region. */
static void look(const core_tile *tile, uint32_t slot, uint32_t *random, float most[2]) {
    velum_page_bounds bounds;
    core_tile_fringe_bounds(tile, slot, &bounds);
    const float s = unit(random);
    const float t = unit(random);
    const velum_slot_fields f = core_tile_sample(tile, slot, s, t);
    const velum_fringe g = core_tile_fringe(tile, slot, s, t);
    if (f.coverage <= 0.0f) {
        return;
    }
    const velum_profile p = velum_profile_of((int)slot, f);
    const velum_span_m hem_m = velum_hem_span(f, g);
    const velum_span_m fall_m = velum_fall_span(f, g);
    for (int i = 0; i < 4; i++) {
        const float e = 1.2f * unit(random) - 0.1f;
        const float noise = unit(random);
        float h = velum_mix(hem_m.low, hem_m.high, unit(random));
        const float hem = velum_scud_1_m(p, f, g, e, h, noise) + velum_band_1_m(p, f, g, e, h);
        assert_true(hem == 0.0f || (h >= bounds.height[0] && h <= bounds.height[1]));
        assert_true(hem <= bounds.most[0] * 1.0005f);
        h = velum_mix(fall_m.low, fall_m.high, unit(random));
        const float fall = velum_fall_1_m(p, f, g, e, h, noise);
        assert_true(fall == 0.0f || (h >= bounds.height[2] && h <= bounds.height[3]));
        assert_true(fall <= bounds.most[1] * 1.0005f);
        most[0] = fmaxf(most[0], hem);
        most[1] = fmaxf(most[1], fall);
    }
}

/* Half of the layer's extinction where the cloud ends, nothing beyond the band; between them a third of that over all
 * of the band: the integral of (1 - x)^2. Under the base as over a column's own top. */
static void bands_thin_out_to_nothing(void **state) {
    (void)state;
    const velum_slot_fields f = {
        .coverage = 0.95f, .base_m = 2000.0f, .top_m = 4000.0f, .extinction_1_m = 0.03f, .kind = VELUM_KIND_NS};
    const velum_fringe g = {.transition_m = 500.0f};
    const velum_profile p = velum_profile_of(VELUM_SLOT_MIDDLE, f);
    const float e = 0.7f;
    const float top_m = f.base_m + (f.top_m - f.base_m) * fminf(powf(e / p.reach, 1.0f / p.power), 1.0f);
    assert_float_equal(velum_band_1_m(p, f, g, e, f.base_m), 0.015f, 1e-6f);
    assert_float_equal(velum_band_1_m(p, f, g, e, top_m), 0.015f, 1e-6f);
    assert_true(velum_band_1_m(p, f, g, e, f.base_m - 500.0f) == 0.0f);
    assert_true(velum_band_1_m(p, f, g, e, top_m + 500.5f) == 0.0f);
    assert_true(velum_band_1_m(p, f, g, e, 0.5f * (f.base_m + top_m)) == 0.0f);
    assert_true(velum_band_1_m(p, f, g, -0.01f, f.base_m) == 0.0f);
    assert_true(velum_band_1_m(p, f, (velum_fringe){0}, e, f.base_m) == 0.0f);
    double below = 0.0;
    double above = 0.0;
    for (int i = 0; i < 1000; i++) {
        const float m = 0.5f * ((float)i + 0.5f);
        below += 0.5 * (double)velum_band_1_m(p, f, g, e, f.base_m - m);
        above += 0.5 * (double)velum_band_1_m(p, f, g, e, top_m + m);
    }
    assert_float_equal(below, 0.015 * 500.0 / 3.0, 0.003);
    assert_float_equal(above, 0.015 * 500.0 / 3.0, 0.003);
}

static void nothing_is_outside_the_bounds(void **state) {
    (void)state;
    static const double places[][2] = {{30.0, 20.0}, {89.9, 12.0}, {-90.0, 0.0}, {10.0, 179.95}, {-35.2, -180.0}};
    static const int32_t genera[] = {VELUM_GENUS_ST, VELUM_GENUS_CU, VELUM_GENUS_CB, VELUM_GENUS_NS, VELUM_GENUS_CI};
    uint32_t random = 5;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        for (size_t k = 0; k < sizeof genera / sizeof genera[0]; k++) {
            velum_layer layers[2] = {wet_layer(genera[k], 0.6f, 2200.0f, 4000.0f, 0.3f, 0.1f),
                                     wet_layer(genera[k], 0.95f, 900.0f, 5000.0f, 30.0f, 0.9f)};
            layers[0].precipitation = VELUM_PRECIPITATION_SNOW;
            layers[i % 2].transition_m = 700.0f;
            velum_cell cells[2] = {cell_of(VELUM_CELL_GLOBAL, 1, &layers[0], 1),
                                   cell_of(VELUM_CELL_RECTANGLE, 2, &layers[1], 1)};
            cells[1].lat_deg = places[i][0];
            cells[1].lon_deg = places[i][1];
            cells[1].half_east_m = cells[1].half_north_m = 12000.0;
            cells[1].transition_m = 9000.0;
            const velum_state_desc desc = desc_of(cells, 2);
            core_state *made = state_of(&desc, NULL, 1);
            float low_m, high_m;
            assert_true(core_state_height_range(made, &low_m, &high_m));
            double normal[3];
            core_normal(places[i][0] > -89.0 ? places[i][0] - 0.08 : -89.92, places[i][1], normal);
            const velum_face_place p = velum_face_of((float)normal[0], (float)normal[1], (float)normal[2]);
            const uint32_t level = 8;
            core_tile *tile = core_tile_create(made, velum_tile_key(level, (uint32_t)p.face,
                                                                    (uint32_t)velum_tile_coordinate(p.u, level),
                                                                    (uint32_t)velum_tile_coordinate(p.v, level)));
            assert_non_null(tile);
            for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
                if (!(tile->mask & (1u << slot))) {
                    assert_null(tile->slot[slot].fringe);
                    continue;
                }
                assert_non_null(tile->slot[slot].fringe);
                assert_true(core_tile_slot_span(&tile->slot[slot]).low >= low_m - 2.0f);
                assert_true(core_tile_slot_span(&tile->slot[slot]).high <= high_m + 2.0f);
                float most[2] = {0.0f, 0.0f};
                for (int n = 0; n < 20000; n++) {
                    look(tile, slot, &random, most);
                }
                /* Bounds, and not boundless ones. */
                assert_true(most[0] > 0.5f * (tile->slot[slot].max_scud_1_m + tile->slot[slot].max_band_1_m));
                assert_true(most[1] > 0.05f * tile->slot[slot].max_fall_1_m);
            }
            core_tile_unref(tile);
            core_state_unref(made);
        }
    }
}

/* Where a storm gives way it rains from its heart alone: the fourth root of the rate goes with the square of what is
 * left of its towers. A sheet rains as hard as ever up to its edge. */
static void storms_rain_from_their_hearts(void **state) {
    (void)state;
    static const int32_t genera[] = {VELUM_GENUS_CB, VELUM_GENUS_NS};
    const float full = powf(30.0f, 0.25f);
    for (size_t k = 0; k < 2; k++) {
        const uint32_t slot = genera[k] == VELUM_GENUS_CB ? VELUM_SLOT_STORM : VELUM_SLOT_MIDDLE;
        velum_layer layer = wet_layer(genera[k], 0.8f, 900.0f, 9000.0f, 30.0f, 0.0f);
        velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, &layer, 1);
        cell.lat_deg = 30.0;
        cell.lon_deg = 20.0;
        cell.half_east_m = cell.half_north_m = 6000.0;
        cell.transition_m = 20000.0;
        const velum_state_desc desc = desc_of(&cell, 1);
        core_state *made = state_of(&desc, NULL, 1);
        double normal[3];
        core_normal(30.0, 20.0, normal);
        const velum_face_place p = velum_face_of((float)normal[0], (float)normal[1], (float)normal[2]);
        const uint32_t x = (uint32_t)velum_tile_coordinate(p.u, 8);
        const uint32_t y = (uint32_t)velum_tile_coordinate(p.v, 8);
        const float row = (floorf((velum_tile_coordinate(p.v, 8) - (float)y) * (float)VELUM_TILE_TEXELS) + 0.5f) /
                          (float)VELUM_TILE_TEXELS;
        int heart = 0, flank = 0, edge = 0;
        for (uint32_t step = 0; step < 3; step++) {
            core_tile *tile = core_tile_create(made, velum_tile_key(8, (uint32_t)p.face, x + step, y));
            assert_non_null(tile);
            for (uint32_t i = 0; i < VELUM_TILE_TEXELS && tile->mask & (1u << slot); i++) {
                const float at = ((float)i + 0.5f) / (float)VELUM_TILE_TEXELS;
                const float cover = core_tile_sample(tile, slot, at, row).coverage / 0.8f;
                const float fall = core_tile_fringe(tile, slot, at, row).fall / full;
                if (cover < 0.01f) {
                    continue;
                }
                const bool storm = slot == VELUM_SLOT_STORM;
                const float towers = core_tile_sample(tile, slot, at, row).kind;
                assert_float_equal(fall, storm ? towers * towers : 1.0f, 0.005f);
                const float left = storm ? towers : cover;
                heart += left > 0.999f;
                flank += left > 0.3f && left < 0.69f;
                edge += left < 0.2f;
            }
            core_tile_unref(tile);
        }
        assert_true(heart > 0 && flank > 0 && edge > 0);
        core_state_unref(made);
    }
}

static void layers_without_it_have_no_pages_of_it(void **state) {
    const fixture *f = *state;
    core_tile *dry = core_tile_create(f->dry, velum_tile_key(5, 0, 7, 9));
    core_tile *wet = core_tile_create(f->wet, velum_tile_key(5, 0, 7, 9));
    assert_true(dry && wet);
    assert_null(dry->slot[VELUM_SLOT_MIDDLE].fringe);
    assert_non_null(wet->slot[VELUM_SLOT_MIDDLE].fringe);
    assert_true(dry->bytes + CORE_TILE_PAGE_BYTES == wet->bytes);
    /* The cloud's own pages do not know. */
    assert_memory_equal(dry->slot[VELUM_SLOT_MIDDLE].a, wet->slot[VELUM_SLOT_MIDDLE].a, CORE_TILE_PAGE_BYTES);
    assert_memory_equal(dry->slot[VELUM_SLOT_MIDDLE].b, wet->slot[VELUM_SLOT_MIDDLE].b, CORE_TILE_PAGE_BYTES);
    core_tile_unref(dry);
    core_tile_unref(wet);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_cloud_proper_stays_as_it_is),
        cmocka_unit_test(rain_comes_down_and_virga_does_not),
        cmocka_unit_test(a_state_that_dries_up_does_so_evenly),
        cmocka_unit_test(lines_see_what_points_see),
        cmocka_unit_test(bands_thin_out_to_nothing),
        cmocka_unit_test(nothing_is_outside_the_bounds),
        cmocka_unit_test(storms_rain_from_their_hearts),
        cmocka_unit_test(layers_without_it_have_no_pages_of_it),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
