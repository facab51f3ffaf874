/* Bounds of a tile hold wherever one looks in it, for the best columns that the noise can give. */
#include "synthetic.h"

#include "core/geodesy.h"
#include "core/tile_bounds.h"
#include "shared/sample.h"

#include <math.h>

static uint32_t next(uint32_t *state) {
    *state = *state * 747796405u + 2891336453u;
    return *state;
}

static float unit(uint32_t *state) {
    return (float)(next(state) >> 8) * 0x1p-24f;
}

/* Any rank, lump and fine noise that a column can have. */
static void look(const core_tile *tile, uint32_t slot, const velum_page_bounds *bounds, uint32_t *random, float *most) {
    float u = unit(random);
    float v = unit(random);
    velum_slot_fields f = core_tile_sample(tile, slot, u, v);
    if (f.coverage <= 0.0f) {
        return;
    }
    float z = unit(random);
    float height_m = f.base_m + z * (f.top_m - f.base_m);
    float rank = 1.0f - unit(random) * unit(random);
    float lump = 2.0f * unit(random) - 1.0f;
    float extinction = velum_slot_extinction((int)slot, f, height_m, rank, lump, unit(random));
    if (!(extinction > 0.0f)) {
        return;
    }
    assert_true(height_m >= bounds->height[0] - 0.01f && height_m <= bounds->height[3] + 0.01f);
    if (slot < VELUM_SLOT_UNIFORM) {
        /* As reference_bounds.glsl: columns reach so high only where their rank is greater. */
        float climb = fmaxf(bounds->height[3] - bounds->height[1], 1.0f);
        float high = fminf(fmaxf((height_m - bounds->height[1]) / climb, 0.0f), 1.0f);
        float cover = bounds->most[0];
        assert_true(rank > 1.0f - cover + cover * bounds->most[2] * powf(high, bounds->most[3]) - 1e-4f);
        float own = f.coverage * velum_profile_of((int)slot, f).coverage_scale;
        int x = (int)(u * VELUM_PARTS);
        int y = (int)(v * VELUM_PARTS);
        assert_true(own <= cover * (float)(bounds->parts[y] >> 8 * x & 255u) / 255.0f + 1e-5f);
    }
    assert_true(extinction <= bounds->most[1] * 1.0005f);
    *most = fmaxf(*most, extinction);
}

/* How columns lean changes along the layer by no more than the bound says. */
static void lean(const core_tile *tile, uint32_t slot, const velum_page_bounds *bounds, uint32_t *random) {
    const double side_m = VELUM_TILE_FACE_M / (double)(1u << velum_tile_key_level(tile->key));
    const float u = 0.98f * unit(random);
    const float v = unit(random);
    velum_slot_fields a = core_tile_sample(tile, slot, u, v);
    velum_slot_fields b = core_tile_sample(tile, slot, u + 0.002f, v);
    if (a.coverage > 0.0f && b.coverage > 0.0f) {
        const float height_m = a.base_m + unit(random) * (a.top_m - a.base_m);
        velum_noise_point p = velum_lean((int)slot, a, height_m, 0.0f, 0.6f, 0.8f);
        velum_noise_point q = velum_lean((int)slot, b, height_m, 0.0f, 0.6f, 0.8f);
        const float moved_m = sqrtf((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
        const float stretch = velum_noise_of((int)slot).stretch;
        assert_true(moved_m * stretch <= bounds->shape[3] * 0.002f * (float)side_m + 0.5f);
    }
}

/* Fields of two places side by side; how far apart they are. */
static float neighbours(const core_tile *tile, uint32_t slot, uint32_t *random, velum_slot_fields *a,
                        velum_slot_fields *b) {
    const float step = 0.002f;
    const float u = (1.0f - step) * unit(random);
    const float v = unit(random);
    *a = core_tile_sample(tile, slot, u, v);
    *b = core_tile_sample(tile, slot, u + step, v);
    return step * VELUM_TILE_FACE_M / (float)(1u << velum_tile_key_level(tile->key));
}

/* Base and top together, too. */
static void steep(const core_tile *tile, uint32_t slot, const velum_page_bounds *bounds, uint32_t *random) {
    velum_slot_fields a, b;
    const float step_m = neighbours(tile, slot, random, &a, &b);
    const float change_m = fabsf(a.base_m - b.base_m) + fabsf(a.top_m - b.top_m);
    assert_true(change_m <= bounds->shape[2] * step_m + 0.01f);
}

/* Margins of covered columns change along the layer by no more than reference_bounds.glsl takes from the bounds. */
static void fade(const core_tile *tile, uint32_t slot, const velum_page_bounds *bounds, uint32_t *random) {
    velum_slot_fields a, b;
    const float step_m = neighbours(tile, slot, random, &a, &b);
    if (slot >= VELUM_SLOT_UNIFORM || a.coverage <= 0.0f || b.coverage <= 0.0f) {
        return;
    }
    const velum_profile p = velum_profile_of((int)slot, a);
    const velum_profile q = velum_profile_of((int)slot, b);
    const float rank = 1.0f - unit(random) * unit(random) * unit(random);
    const float e = velum_excess(p, a.coverage, rank);
    const float there = velum_excess(q, b.coverage, rank);
    const float z = unit(random), lump = 2.0f * unit(random) - 1.0f, fine = unit(random);
    if (e <= 0.0f || there <= 0.0f) {
        return;
    }
    const float cover = fminf(a.coverage * p.coverage_scale, b.coverage * q.coverage_scale);
    float fade_1_m = VELUM_FADE_OTHERS * bounds->shape[1];
    if (slot == VELUM_SLOT_STORM || slot == VELUM_SLOT_CUMULUS) {
        const float bend = bounds->shape[2] / fmaxf(bounds->height[2] - bounds->height[1], 1.0f);
        const float beside = slot == VELUM_SLOT_STORM ? VELUM_BESIDE_1_M * VELUM_ANVIL_LAG_S * bounds->shape[0] : 0.0f;
        fade_1_m += bounds->most[0] * (beside + VELUM_FADE_BEND * bend);
    }
    const float storm_edge = slot == VELUM_SLOT_STORM ? VELUM_STORM_EDGE : 0.0f;
    const float change = fabsf(velum_margin(p, e, z, lump, fine) - velum_margin(q, there, z, lump, fine));
    assert_true(change <= (1.0f / cover + storm_edge) * fade_1_m * step_m + 1e-3f);
}

static void bounds_hold(void **state) {
    (void)state;
    static const int32_t genera[] = {VELUM_GENUS_ST, VELUM_GENUS_SC, VELUM_GENUS_CU, VELUM_GENUS_CB, VELUM_GENUS_AS,
                                     VELUM_GENUS_NS, VELUM_GENUS_AC, VELUM_GENUS_CS, VELUM_GENUS_CI, VELUM_GENUS_CC};
    /* A global layer; in it a region of another; a region alone; both again with sharp edges. */
    static const struct {
        int first, count;
        double transition_m;
    } scenes[] = {{0, 1, 0.0}, {0, 2, 30000.0}, {1, 1, 30000.0}, {0, 2, 0.0}, {1, 1, 0.0}};
    uint32_t random = 1;
    uint32_t slots_seen = 0;
    for (size_t g = 0; g < sizeof genera / sizeof genera[0]; g++) {
        for (size_t scene = 0; scene < sizeof scenes / sizeof scenes[0]; scene++) {
            velum_layer layers[2] = {layer_of(genera[g], 0.2f + 0.07f * (float)g, 900.0f, 2600.0f),
                                     layer_of(genera[g], 0.95f, 1100.0f, 4000.0f)};
            layers[0].wind_east_m_s = 25.0f;
            layers[1].wind_east_m_s = -20.0f;
            velum_cell cells[2] = {cell_of(VELUM_CELL_GLOBAL, 1, &layers[0], 1),
                                   cell_of(VELUM_CELL_RECTANGLE, 2, &layers[1], 1)};
            cells[1].lat_deg = 30.0;
            cells[1].lon_deg = 20.0;
            cells[1].half_east_m = cells[1].half_north_m = 20000.0;
            cells[1].transition_m = scenes[scene].transition_m;
            velum_state_desc desc = desc_of(cells + scenes[scene].first, (uint32_t)scenes[scene].count);
            core_state *made = state_of(&desc, NULL, 1);
            double normal[3];
            core_normal(30.0, 20.2, normal);
            velum_face_place p = velum_face_of((float)normal[0], (float)normal[1], (float)normal[2]);
            core_tile *tile =
                core_tile_create(made, velum_tile_key(8, (uint32_t)p.face, (uint32_t)velum_tile_coordinate(p.u, 8),
                                                      (uint32_t)velum_tile_coordinate(p.v, 8)));
            assert_non_null(tile);
            for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
                velum_page_bounds bounds;
                float most = 0.0f;
                core_tile_bounds(tile, slot, &bounds);
                if (!(tile->mask & (1u << slot))) {
                    assert_true(bounds.most[1] == 0.0f);
                    continue;
                }
                for (int i = 0; i < 20000; i++) {
                    look(tile, slot, &bounds, &random, &most);
                    lean(tile, slot, &bounds, &random);
                    fade(tile, slot, &bounds, &random);
                    steep(tile, slot, &bounds, &random);
                }
                /* A bound, and not a boundless one. */
                assert_true(most > 0.25f * bounds.most[1]);
                slots_seen |= 1u << slot;
            }
            core_tile_unref(tile);
            core_state_unref(made);
        }
    }
    assert_int_equal(slots_seen & ~2u, 0x3du);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(bounds_hold)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
