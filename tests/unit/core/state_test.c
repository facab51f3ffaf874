#include "synthetic.h"

#include "core/column.h"
#include "core/geodesy.h"
#include "core/tile.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static void refused(const velum_state_desc *desc, const core_state *base, velum_result result, const char *text) {
    core_state *state = (core_state *)&state;
    core_error error = {0};
    assert_int_equal(core_state_create(desc, base, 9, &state, &error), result);
    assert_null(state);
    assert_int_equal(error.result, result);
    if (!strstr(error.text, text)) {
        print_error("found \"%s\", expected \"%s\" in it\n", error.text, text);
    }
    assert_non_null(strstr(error.text, text));
}

static const velum_lat_lon triangle[] = {{0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}};
static const uint32_t one_ring[] = {3};

static velum_cell polygon(const velum_layer *layer) {
    velum_cell cell = cell_of(VELUM_CELL_POLYGON, 42, layer, 1);
    cell.points = triangle;
    cell.point_count = 3;
    cell.ring_sizes = one_ring;
    cell.ring_count = 1;
    return cell;
}

static void hostile_layers_are_refused_by_name(void **unused) {
    (void)unused;
    const struct {
        size_t offset;
        double value;
        bool is_int;
        const char *text;
    } cases[] = {
#define F(field, value) {offsetof(velum_layer, field), value, false, "layer 1, " #field}
#define I(field, value)                                                                                                \
    { offsetof(velum_layer, field), value, true, "layer 1, " #field }
        F(coverage, 7.0),
        F(coverage, -0.01),
        F(coverage, (double)NAN),
        F(coverage, (double)INFINITY),
        F(base_m, -501.0),
        F(base_m, (double)NAN),
        F(base_m, 5000.0),
        F(top_m, 25001.0),
        F(top_m, (double)INFINITY),
        F(top_m, 100.0),
        F(water_g_m3, -1.0),
        F(water_g_m3, 21.0),
        F(water_g_m3, (double)NAN),
        F(radius_um, 0.0),
        F(radius_um, 501.0),
        F(transition_m, -1.0),
        F(scud, 1.5),
        F(precipitation_mm_h, 501.0),
        F(precipitation_mm_h, (double)NAN),
        I(genus, 0),
        I(genus, 11),
        I(genus, -1),
        I(water, 2),
        I(precipitation, 6),
        I(precipitation, -1),
        I(flags, 0x10),
        I(flags, VELUM_LAYER_PHASE_HG),
        I(struct_size, 71),
        I(struct_size, 0),
#undef F
#undef I
    };
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        velum_layer layers[2] = {layer_of(VELUM_GENUS_SC, 0.5f, 500.0f, 900.0f),
                                 layer_of(VELUM_GENUS_SC, 0.5f, 500.0f, 900.0f)};
        velum_cell cell = cell_of(VELUM_CELL_GLOBAL, 4711, layers, 2);
        velum_state_desc desc = desc_of(&cell, 1);
        const char *text = cases[i].text;
        velum_result result = VELUM_ERROR_ARGUMENT;
        core_state_unref(state_of(&desc, NULL, 1));
        cell.layer_stride = sizeof *layers;
        char *field = (char *)&layers[1] + cases[i].offset;
        if (cases[i].is_int) {
            int32_t value = (int32_t)cases[i].value;
            memcpy(field, &value, sizeof value);
            result = strstr(text, "flags")         ? VELUM_ERROR_FLAGS
                     : strstr(text, "struct_size") ? VELUM_ERROR_STRUCT_SIZE
                                                   : VELUM_ERROR_ARGUMENT;
        } else {
            float value = (float)cases[i].value;
            memcpy(field, &value, sizeof value);
        }
        if (cases[i].value == 5000.0) {
            text = "top_m"; /* the base is above the top, which is named */
        }
        refused(&desc, NULL, result, "cell 4711");
        refused(&desc, NULL, result, text);
        refused(&desc, NULL, result, "expected");
    }
}

static void hostile_cells_are_refused_by_name(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_SC, 0.5f, 500.0f, 900.0f);
    const velum_cell station = cell_of(VELUM_CELL_STATION, 42, &layer, 1);
    velum_cell rectangle = cell_of(VELUM_CELL_RECTANGLE, 42, &layer, 1);
    rectangle.half_east_m = 1000.0;
    rectangle.half_north_m = 2000.0;
    velum_cell ground = station;
    ground.flags |=
        VELUM_CELL_HAS_VISIBILITY | VELUM_CELL_HAS_WIND | VELUM_CELL_HAS_PRECIPITATION | VELUM_CELL_HAS_TEMPERATURE;
    ground.visibility_m = 9999.0f;
    ground.temperature_k = 280.0f;
    const velum_cell shape = polygon(&layer);
    const velum_lat_lon bad_point[] = {{0.0, 0.0}, {0.0, 1.0}, {NAN, 0.0}};
    const velum_lat_lon far_point[] = {{0.0, 0.0}, {0.0, 361.0}, {1.0, 0.0}};
    const uint32_t short_ring[] = {2};
    const uint32_t long_ring[] = {4};
#define CASE(base, change, code, expected)                                                                             \
    do {                                                                                                               \
        velum_cell cell = base;                                                                                        \
        velum_state_desc desc = desc_of(&cell, 1);                                                                     \
        core_state_unref(state_of(&desc, NULL, 1));                                                                    \
        desc.cell_stride = sizeof cell;                                                                                \
        cell.change;                                                                                                   \
        refused(&desc, NULL, code, expected);                                                                          \
    } while (0)
    CASE(station, lat_deg = 91.0, VELUM_ERROR_ARGUMENT, "cell 42, lat_deg: found 91, expected -90..90");
    CASE(station, lat_deg = (double)NAN, VELUM_ERROR_ARGUMENT, "lat_deg");
    CASE(station, lon_deg = -181.0, VELUM_ERROR_ARGUMENT, "lon_deg");
    CASE(station, radius_m = 999.0, VELUM_ERROR_ARGUMENT, "radius_m");
    CASE(station, radius_m = 1e9, VELUM_ERROR_ARGUMENT, "radius_m");
    CASE(station, kind = 0, VELUM_ERROR_ARGUMENT, "kind");
    CASE(station, kind = 5, VELUM_ERROR_ARGUMENT, "kind");
    CASE(station, flags = 0x40, VELUM_ERROR_FLAGS, "flags");
    CASE(station, reserved = 1, VELUM_ERROR_FLAGS, "reserved");
    CASE(station, layer_count = 17, VELUM_ERROR_ARGUMENT, "layer_count");
    CASE(station, layers = NULL, VELUM_ERROR_ARGUMENT, "layers");
    CASE(station, layer_stride = 4, VELUM_ERROR_STRUCT_SIZE, "layer_stride");
    CASE(station, struct_size = 175, VELUM_ERROR_STRUCT_SIZE, "struct_size");
    CASE(station, thunderstorm = 2, VELUM_ERROR_ARGUMENT, "thunderstorm");
    CASE(ground, visibility_m = 0.5f, VELUM_ERROR_ARGUMENT, "visibility_m");
    CASE(ground, visibility_m = NAN, VELUM_ERROR_ARGUMENT, "visibility_m");
    CASE(ground, wind_east_m_s = 300.0f, VELUM_ERROR_ARGUMENT, "wind");
    CASE(ground, wind_north_m_s = NAN, VELUM_ERROR_ARGUMENT, "wind");
    CASE(ground, gust_m_s = -1.0f, VELUM_ERROR_ARGUMENT, "gust_m_s");
    CASE(ground, temperature_k = 0.0f, VELUM_ERROR_ARGUMENT, "temperature_k");
    CASE(ground, precipitation_mm_h = -1.0f, VELUM_ERROR_ARGUMENT, "precipitation_mm_h");
    CASE(ground, precipitation = 9, VELUM_ERROR_ARGUMENT, "precipitation");
    CASE(rectangle, half_east_m = 0.0, VELUM_ERROR_ARGUMENT, "half_east_m");
    CASE(rectangle, half_north_m = (double)INFINITY, VELUM_ERROR_ARGUMENT, "half_north_m");
    CASE(rectangle, corner_radius_m = 1001.0, VELUM_ERROR_ARGUMENT, "corner_radius_m");
    CASE(rectangle, rotation_deg = (double)NAN, VELUM_ERROR_ARGUMENT, "rotation_deg");
    CASE(rectangle, transition_m = -1.0, VELUM_ERROR_ARGUMENT, "transition_m");
    CASE(shape, points = bad_point, VELUM_ERROR_ARGUMENT, "points lat_deg");
    CASE(shape, points = far_point, VELUM_ERROR_ARGUMENT, "points lon_deg");
    CASE(shape, points = NULL, VELUM_ERROR_ARGUMENT, "points");
    CASE(shape, point_count = 2, VELUM_ERROR_ARGUMENT, "point_count");
    CASE(shape, point_count = UINT32_MAX, VELUM_ERROR_ARGUMENT, "point_count");
    CASE(shape, ring_count = 0, VELUM_ERROR_ARGUMENT, "ring_count");
    CASE(shape, ring_sizes = short_ring, VELUM_ERROR_ARGUMENT, "ring_sizes");
    CASE(shape, ring_sizes = long_ring, VELUM_ERROR_ARGUMENT, "ring_sizes");
    CASE(shape, ring_sizes = NULL, VELUM_ERROR_ARGUMENT, "ring_sizes");
#undef CASE
}

static void hostile_states_and_grids_are_refused(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_SC, 0.5f, 500.0f, 900.0f);
    velum_cell cells[2] = {cell_of(VELUM_CELL_GLOBAL, 1, &layer, 1), cell_of(VELUM_CELL_GLOBAL, 1, &layer, 1)};
    velum_state_desc desc = desc_of(cells, 2);
    refused(NULL, NULL, VELUM_ERROR_ARGUMENT, "null");
    refused(&desc, NULL, VELUM_ERROR_ARGUMENT, "cell 1, id: found twice");
    desc.cell_count = 1;
#define CASE(change, code, expected)                                                                                   \
    do {                                                                                                               \
        velum_state_desc bad = desc;                                                                                   \
        bad.change;                                                                                                    \
        refused(&bad, NULL, code, expected);                                                                           \
    } while (0)
    CASE(struct_size = 55, VELUM_ERROR_STRUCT_SIZE, "struct_size");
    CASE(flags = 1, VELUM_ERROR_FLAGS, "flags");
    CASE(base_state = 5, VELUM_ERROR_ARGUMENT, "base_state");
    CASE(cells = NULL, VELUM_ERROR_ARGUMENT, "cells");
    CASE(cell_count = UINT32_MAX, VELUM_ERROR_ARGUMENT, "cell_count");
    CASE(cell_stride = 8, VELUM_ERROR_STRUCT_SIZE, "cell_stride");
    CASE(geoid_undulation_m = 201.0f, VELUM_ERROR_ARGUMENT, "geoid_undulation_m");
    CASE(geoid_undulation_m = NAN, VELUM_ERROR_ARGUMENT, "geoid_undulation_m");
    CASE(removed_count = 1, VELUM_ERROR_ARGUMENT, "removed_ids");
#undef CASE
    velum_cell nodes[4];
    for (uint32_t i = 0; i < 4; i++) {
        nodes[i] = cell_of(0, 0, &layer, 1);
    }
    velum_grid grid = {.struct_size = sizeof grid,
                       .lat_first_deg = 10.0,
                       .lat_step_deg = 1.0,
                       .lon_step_deg = 1.0,
                       .columns = 2,
                       .rows = 2,
                       .cells = nodes};
#define CASE(change, code, expected)                                                                                   \
    do {                                                                                                               \
        velum_grid bad = grid;                                                                                         \
        velum_state_desc with = desc;                                                                                  \
        bad.change;                                                                                                    \
        with.grid = &bad;                                                                                              \
        refused(&with, NULL, code, expected);                                                                          \
    } while (0)
    CASE(struct_size = 60, VELUM_ERROR_STRUCT_SIZE, "grid, struct_size");
    CASE(flags = 2, VELUM_ERROR_FLAGS, "grid, flags");
    CASE(lat_first_deg = 90.5, VELUM_ERROR_ARGUMENT, "lat_first_deg");
    CASE(lat_step_deg = 0.0, VELUM_ERROR_ARGUMENT, "lat_step_deg");
    CASE(lat_step_deg = 100.0, VELUM_ERROR_ARGUMENT, "lat_step_deg");
    CASE(lat_step_deg = (double)NAN, VELUM_ERROR_ARGUMENT, "lat_step_deg");
    CASE(lon_step_deg = -1.0, VELUM_ERROR_ARGUMENT, "lon_step_deg");
    CASE(lon_step_deg = 200.0, VELUM_ERROR_ARGUMENT, "lon_step_deg");
    CASE(lon_first_deg = (double)INFINITY, VELUM_ERROR_ARGUMENT, "lon_first_deg");
    CASE(columns = 0, VELUM_ERROR_ARGUMENT, "columns");
    CASE(rows = 0x80000000u, VELUM_ERROR_ARGUMENT, "rows");
    CASE(cells = NULL, VELUM_ERROR_ARGUMENT, "cells");
    CASE(cell_stride = 12, VELUM_ERROR_STRUCT_SIZE, "cell_stride");
#undef CASE
    nodes[3].layer_count = 99;
    desc.grid = &grid;
    refused(&desc, NULL, VELUM_ERROR_ARGUMENT, "grid row 1, column 1, layer_count");
}

static float low_base_at(const core_state *state, double lat_deg, double lon_deg) {
    double n[3];
    core_column c;
    core_normal(lat_deg, lon_deg, n);
    core_column_at(state, n, 100.0, &c);
    return c.mask & 1u << VELUM_SLOT_LOW ? c.slot[VELUM_SLOT_LOW].base_m : -1.0f;
}

static void a_state_is_a_deep_copy(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_SC, 0.5f, 500.0f, 900.0f);
    velum_lat_lon points[] = {{0.0, 0.0}, {0.0, 1.0}, {1.0, 0.0}};
    uint32_t rings[] = {3};
    velum_cell cell = polygon(&layer);
    cell.points = points;
    cell.ring_sizes = rings;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    memset(points, 0xff, sizeof points);
    memset(&layer, 0xff, sizeof layer);
    memset(&cell, 0xff, sizeof cell);
    assert_float_equal(low_base_at(state, 0.2, 0.2), 500.0f, 0.01f);
    core_state_unref(state);
}

static void larger_structs_of_later_hosts_are_read(void **unused) {
    (void)unused;
    struct {
        velum_layer layer;
        char later[24];
    } layers[2];
    struct {
        velum_cell cell;
        char later[40];
    } cells[2];
    memset(layers, 0x7f, sizeof layers);
    memset(cells, 0x7f, sizeof cells);
    for (uint32_t i = 0; i < 2; i++) {
        layers[i].layer = layer_of(VELUM_GENUS_SC, 0.5f, 500.0f + 2000.0f * (float)i, 3000.0f);
        layers[i].layer.struct_size = sizeof layers[i];
        cells[i].cell = cell_of(VELUM_CELL_STATION, i + 1, &layers[0].layer, 2);
        cells[i].cell.struct_size = sizeof cells[i];
        cells[i].cell.lon_deg = 90.0 * i;
    }
    /* Stride 0: the size that the elements state. */
    velum_state_desc desc = desc_of(&cells[0].cell, 2);
    core_state *state = state_of(&desc, NULL, 1);
    assert_float_equal(low_base_at(state, 0.0, 0.0), 500.0f, 0.01f);
    assert_float_equal(low_base_at(state, 0.0, 90.0), 500.0f, 0.01f);
    assert_int_equal(core_state_slot_mask(state), 1u << VELUM_SLOT_LOW | 1u << VELUM_SLOT_LOW_2);
    core_state_unref(state);
}

static void changes_leave_the_base_as_it_was(void **unused) {
    (void)unused;
    velum_layer layers[3] = {layer_of(VELUM_GENUS_SC, 1.0f, 500.0f, 900.0f),
                             layer_of(VELUM_GENUS_SC, 1.0f, 600.0f, 900.0f),
                             layer_of(VELUM_GENUS_SC, 1.0f, 700.0f, 900.0f)};
    velum_cell cells[2] = {cell_of(VELUM_CELL_STATION, 10, &layers[0], 1),
                           cell_of(VELUM_CELL_STATION, 20, &layers[1], 1)};
    cells[1].lon_deg = 50.0;
    velum_state_desc desc = desc_of(cells, 2);
    desc.geoid_undulation_m = 40.0f;
    core_state *base = state_of(&desc, NULL, 1);

    velum_cell fresh[2] = {cell_of(VELUM_CELL_STATION, 20, &layers[2], 1),
                           cell_of(VELUM_CELL_STATION, 30, &layers[2], 1)};
    const uint64_t gone[] = {10};
    const uint64_t unknown[] = {11};
    const uint64_t twice[] = {10, 10};
    fresh[0].lon_deg = 50.0;
    fresh[1].lon_deg = 100.0;
    velum_state_desc change = desc_of(fresh, 2);
    change.base_state = 1;
    change.removed_ids = gone;
    change.removed_count = 1;
    core_state *state = state_of(&change, base, 2);
    assert_int_equal(core_state_cell_count(state), 2);
    assert_int_equal(core_state_id(state), 2);
    assert_float_equal(low_base_at(state, 0.0, 0.0), -1.0f, 0.0f);
    assert_float_equal(low_base_at(state, 0.0, 50.0), 740.0f, 0.01f);
    assert_float_equal(low_base_at(state, 0.0, 100.0), 740.0f, 0.01f);
    assert_float_equal(low_base_at(base, 0.0, 0.0), 540.0f, 0.01f);
    assert_float_equal(low_base_at(base, 0.0, 50.0), 640.0f, 0.01f);
    assert_float_equal(low_base_at(base, 0.0, 100.0), -1.0f, 0.0f);

    change.removed_ids = unknown;
    refused(&change, base, VELUM_ERROR_ARGUMENT, "removed_ids[0]: found 11");
    change.removed_ids = twice;
    change.removed_count = 2;
    refused(&change, base, VELUM_ERROR_ARGUMENT, "removed_ids[1]: found 10");
    change.base_state = 3;
    refused(&change, base, VELUM_ERROR_ARGUMENT, "base_state");

    /* What was shared lives on without its first owner. */
    core_state_unref(base);
    assert_float_equal(low_base_at(state, 0.0, 50.0), 740.0f, 0.01f);
    core_state_unref(state);
    core_state_unref(NULL);
}

static void a_state_knows_what_is_in_it(void **unused) {
    (void)unused;
    velum_layer layers[3] = {layer_of(VELUM_GENUS_SC, 1.0f, 500.0f, 900.0f),
                             layer_of(VELUM_GENUS_CB, 1.0f, 900.0f, 12000.0f),
                             layer_of(VELUM_GENUS_SC, 1.0f, 100.0f, 14000.0f)};
    layers[2].flags = VELUM_LAYER_UNIFORM | VELUM_LAYER_PHASE_HG;
    layers[2].hg_asymmetry = 0.85f;
    velum_cell cell = cell_of(VELUM_CELL_STATION, 10, layers, 3);
    velum_state_desc desc = desc_of(&cell, 1);
    float low;
    float high;
    core_state *state = state_of(&desc, NULL, 1);
    assert_true(core_state_height_range(state, &low, &high));
    assert_float_equal(low, 100.0f, 0.0f);
    assert_float_equal(high, 14000.0f, 0.0f);
    core_uniform_phase phase = core_state_uniform_phase(state, VELUM_SLOT_UNIFORM);
    assert_true(phase.has_hg);
    assert_float_equal(phase.hg_asymmetry, 0.85f, 0.0f);
    assert_float_equal(phase.albedo, 1.0f, 0.0f);
    assert_false(core_state_uniform_phase(state, VELUM_SLOT_UNIFORM_2).has_hg);
    core_state_unref(state);

    desc = desc_of(NULL, 0);
    state = state_of(&desc, NULL, 1);
    assert_false(core_state_height_range(state, &low, &high));
    assert_int_equal(core_state_slot_mask(state), 0);
    assert_int_equal(core_state_cell_count(state), 0);
    core_state_unref(state);
}

/* A number that is ordinary, at a limit, or absurd. */
static double odd_number(uint64_t *seed, double low, double high) {
    const double absurd[] = {(double)NAN, (double)INFINITY, -1e300, 1e-300, -0.0, 4294967296.0};
    double pick = random_unit(seed);
    if (pick < 0.004) {
        return absurd[(size_t)(6.0 * random_unit(seed))];
    }
    return pick < 0.1 ? low : pick < 0.2 ? high : low + (high - low) * random_unit(seed);
}

/* Whatever numbers come: a refusal that names a cell, or a state whose every column and tile is in order. */
static void random_states_are_refused_or_sound(void **unused) {
    (void)unused;
    enum { CELLS = 6, POINTS = 12 };
    uint64_t seed = 99;
    uint32_t accepted = 0;
    uint32_t rejected = 0;
    for (int round = 0; round < 1500; round++) {
        velum_layer layers[CELLS][2];
        velum_lat_lon points[CELLS][POINTS];
        uint32_t rings[2] = {4, POINTS - 4};
        velum_cell cells[CELLS];
        for (uint32_t c = 0; c < CELLS; c++) {
            for (uint32_t l = 0; l < 2; l++) {
                velum_layer *layer = &layers[c][l];
                *layer =
                    layer_of(1 + (int32_t)(10.0 * random_unit(&seed)), (float)odd_number(&seed, 0.0, 1.0),
                             (float)odd_number(&seed, -500.0, 10000.0), (float)odd_number(&seed, 10001.0, 25000.0));
                layer->water_g_m3 = (float)odd_number(&seed, 0.0, 20.0);
                layer->radius_um = (float)odd_number(&seed, 0.5, 500.0);
                layer->wind_east_m_s = (float)odd_number(&seed, -90.0, 90.0);
                layer->wind_north_m_s = (float)odd_number(&seed, -90.0, 90.0);
                layer->flags = random_unit(&seed) < 0.1 ? VELUM_LAYER_UNIFORM : 0;
            }
            for (uint32_t i = 0; i < POINTS; i++) {
                points[c][i].lat_deg = odd_number(&seed, -90.0, 90.0);
                points[c][i].lon_deg = odd_number(&seed, -180.0, random_unit(&seed) < 0.5 ? 180.0 : 360.0);
            }
            velum_cell *cell = &cells[c];
            *cell = cell_of(1 + (int32_t)(4.0 * random_unit(&seed)), c, layers[c], 2);
            cell->flags |= (uint32_t)(64.0 * random_unit(&seed)) & ~(uint32_t)VELUM_CELL_HAS_TEMPERATURE;
            cell->lat_deg = odd_number(&seed, -90.0, 90.0);
            cell->lon_deg = odd_number(&seed, -180.0, 360.0);
            cell->radius_m = odd_number(&seed, 1000.0, 500000.0);
            cell->half_east_m = odd_number(&seed, 1.0, 5e6);
            cell->half_north_m = odd_number(&seed, 1.0, 5e6);
            cell->corner_radius_m = odd_number(&seed, 0.0, 1.0);
            cell->rotation_deg = odd_number(&seed, -360.0, 360.0);
            cell->transition_m = odd_number(&seed, 0.0, 5e6);
            cell->visibility_m = (float)odd_number(&seed, 1.0, 1e6);
            cell->points = points[c];
            cell->point_count = POINTS;
            cell->ring_sizes = rings;
            cell->ring_count = 2;
        }
        velum_state_desc desc = desc_of(cells, CELLS);
        core_state *state = NULL;
        core_error error = {0};
        desc.geoid_undulation_m = (float)odd_number(&seed, -200.0, 200.0);
        if (core_state_create(&desc, NULL, 1, &state, &error) != VELUM_OK) {
            assert_non_null(strstr(error.text, "expected"));
            assert_null(state);
            rejected++;
            continue;
        }
        accepted++;
        for (int i = 0; i < 40; i++) {
            core_column c;
            double n[3];
            core_normal(odd_number(&seed, -90.0, 90.0) * 0.999, 360.0 * random_unit(&seed), n);
            if (!(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] > 0.99)) {
                continue;
            }
            core_column_at(state, n, 76.0 * pow(2.0, i % 13), &c);
            assert_true(isfinite(c.surface.visibility_m) && c.surface.visibility_m >= 0.99f);
            for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
                const velum_slot_fields *f = &c.slot[slot];
                if (c.mask & (1u << slot)) {
                    assert_true(f->coverage > 0.0f && f->coverage <= 1.0f);
                    assert_true(f->base_m >= -701.0f && f->top_m <= 25201.0f && f->base_m < f->top_m);
                    assert_true(f->extinction_1_m > 0.0f && f->extinction_1_m < 100.0f);
                    assert_true(fabsf(f->wind_x_m_s) <= 128.1f && f->kind >= 0.0f && f->kind <= 1.001f);
                }
            }
        }
        if (round % 8 == 0) {
            for (uint32_t level = 0; level <= VELUM_TILE_LEVEL_MAX; level += 3) {
                uint32_t key = velum_tile_key(level, (uint32_t)(6.0 * random_unit(&seed)),
                                              (uint32_t)(random_unit(&seed) * (1u << level)),
                                              (uint32_t)(random_unit(&seed) * (1u << level)));
                core_tile *tile = core_tile_create(state, key);
                assert_non_null(tile);
                assert_true(core_tile_detail_level(state, key) <= level);
                core_tile_unref(tile);
            }
        }
        core_state_unref(state);
    }
    assert_true(accepted > 300);
    assert_true(rejected > 100);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(hostile_layers_are_refused_by_name),
        cmocka_unit_test(hostile_cells_are_refused_by_name),
        cmocka_unit_test(hostile_states_and_grids_are_refused),
        cmocka_unit_test(a_state_is_a_deep_copy),
        cmocka_unit_test(larger_structs_of_later_hosts_are_read),
        cmocka_unit_test(changes_leave_the_base_as_it_was),
        cmocka_unit_test(a_state_knows_what_is_in_it),
        cmocka_unit_test(random_states_are_refused_or_sound),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
