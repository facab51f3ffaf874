#include "synthetic.h"

#include "core/column.h"
#include "core/geodesy.h"
#include "core/slots.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static core_column column_at(const core_state *state, double lat_deg, double lon_deg, double texel_m) {
    core_column column;
    double normal[3];
    core_normal(lat_deg, lon_deg, normal);
    core_column_at(state, normal, texel_m, &column);
    return column;
}

static float coverage_at(const core_state *state, uint32_t slot, double lat_deg, double lon_deg, double texel_m) {
    return column_at(state, lat_deg, lon_deg, texel_m).slot[slot].coverage;
}

static void a_global_cell_is_everywhere(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_ST, 0.75f, 200.0f, 500.0f);
    layer.wind_east_m_s = 10.0f;
    velum_cell cell = cell_of(VELUM_CELL_GLOBAL, 1, &layer, 1);
    cell.flags |= VELUM_CELL_HAS_VISIBILITY;
    cell.visibility_m = 3000.0f;
    velum_state_desc desc = desc_of(&cell, 1);
    desc.geoid_undulation_m = 47.0f;
    core_state *state = state_of(&desc, NULL, 1);
    for (double lat = -90.0; lat <= 90.0; lat += 7.5) {
        for (double lon = -180.0; lon <= 180.0; lon += 30.0) {
            double n[3];
            core_column c = column_at(state, lat, lon, 100.0);
            const velum_slot_fields *f = &c.slot[VELUM_SLOT_LOW];
            core_normal(lat, lon, n);
            assert_int_equal(c.mask, 1u << VELUM_SLOT_LOW);
            assert_float_equal(f->coverage, 0.75f, 1e-6f);
            assert_float_equal(f->base_m, 247.0f, 1e-3f); /* HAE = MSL + undulation */
            assert_float_equal(f->top_m, 547.0f, 1e-3f);
            assert_float_equal(f->extinction_1_m, 0.045f, 1e-6f); /* 3 WC / (2 rho r) */
            assert_float_equal(f->wind_x_m_s * (float)n[0] + f->wind_y_m_s * (float)n[1] + f->wind_z_m_s * (float)n[2],
                               0.0f, 1e-4f);
            float speed =
                sqrtf(f->wind_x_m_s * f->wind_x_m_s + f->wind_y_m_s * f->wind_y_m_s + f->wind_z_m_s * f->wind_z_m_s);
            assert_float_equal(speed, fabs(lat) == 90.0 ? 0.0f : 10.0f, 1e-4f);
            assert_float_equal(c.surface.visibility_m, 3000.0f, 1.0f);
        }
    }
    core_state_unref(state);
}

static void a_grid_is_bilinear_and_closed(void **unused) {
    (void)unused;
    enum { COLUMNS = 36, ROWS = 19 };
    static velum_layer layers[COLUMNS * ROWS];
    static velum_cell cells[COLUMNS * ROWS];
    for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
        float c = (float)(i % COLUMNS) / COLUMNS; /* differs along the pole rows too */
        layers[i] = layer_of(VELUM_GENUS_SC, c, 1000.0f, 2000.0f + 10.0f * (float)(i / COLUMNS));
        cells[i] = cell_of(0, 0, &layers[i], 1);
    }
    velum_grid grid = {.struct_size = sizeof grid,
                       .lat_first_deg = 90.0,
                       .lon_first_deg = 0.0,
                       .lat_step_deg = -10.0,
                       .lon_step_deg = 10.0,
                       .columns = COLUMNS,
                       .rows = ROWS,
                       .cells = cells};
    velum_state_desc desc = desc_of(NULL, 0);
    desc.grid = &grid;
    core_state *state = state_of(&desc, NULL, 1);
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 40.0, 120.0, 100.0), 12.0f / 36.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 40.0, 125.0, 100.0), 12.5f / 36.0f, 1e-6f);
    /* Closed between the last column and the first. */
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 40.0, -5.0, 100.0), 17.5f / 36.0f, 1e-6f);
    /* The antimeridian is a place like others. */
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 0.0, 180.0, 100.0),
                       coverage_at(state, VELUM_SLOT_LOW, 0.0, -180.0, 100.0), 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 0.0, 179.9999, 100.0),
                       coverage_at(state, VELUM_SLOT_LOW, 0.0, -179.9999, 100.0), 2e-6f);
    /* Base is not pulled by layers of other coverage, top is between its neighbours. */
    core_column c = column_at(state, 45.0, 125.0, 100.0);
    assert_float_equal(c.slot[VELUM_SLOT_LOW].base_m, 1000.0f, 1e-2f);
    assert_true(c.slot[VELUM_SLOT_LOW].top_m > 2040.0f && c.slot[VELUM_SLOT_LOW].top_m < 2050.0f);
    for (int pole = -1; pole <= 1; pole += 2) {
        float mean = coverage_at(state, VELUM_SLOT_LOW, 90.0 * pole, 0.0, 100.0);
        assert_float_equal(mean, 17.5f / 36.0f, 1e-5f);
        for (double lon = -180.0; lon < 180.0; lon += 15.0) {
            assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 89.99999 * pole, lon, 100.0), mean, 1e-5f);
        }
    }
    core_state_unref(state);
}

static void a_regional_grid_ends_at_its_border(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_SC, 1.0f, 1000.0f, 2000.0f);
    velum_cell cells[6];
    for (uint32_t i = 0; i < 6; i++) {
        cells[i] = cell_of(0, i, &layer, 1);
    }
    velum_grid grid = {.struct_size = sizeof grid,
                       .lat_first_deg = 40.0,
                       .lon_first_deg = 175.0,
                       .lat_step_deg = 10.0,
                       .lon_step_deg = 5.0,
                       .columns = 3,
                       .rows = 2,
                       .cells = cells};
    velum_state_desc desc = desc_of(NULL, 0);
    desc.grid = &grid;
    core_state *state = state_of(&desc, NULL, 1);
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 45.0, 180.0, 100.0), 1.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 45.0, -175.01, 100.0), 1.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_LOW, 45.0, -175.0, 100.0), 0.5f, 1e-3f);
    assert_int_equal(column_at(state, 45.0, -174.9, 100.0).mask, 0);
    assert_int_equal(column_at(state, 45.0, 174.9, 100.0).mask, 0);
    assert_int_equal(column_at(state, 39.9, 180.0, 100.0).mask, 0);
    assert_int_equal(column_at(state, 50.1, 180.0, 100.0).mask, 0);
    core_state_unref(state);
}

static void a_station_fades_into_the_background(void **unused) {
    (void)unused;
    const double lats[] = {0.0, 52.0, -89.9, 90.0};
    for (size_t k = 0; k < 4; k++) {
        velum_layer sheet = layer_of(VELUM_GENUS_SC, 1.0f, 900.0f, 1500.0f);
        velum_layer cumulus = layer_of(VELUM_GENUS_CU, 0.5f, 700.0f, 1900.0f);
        velum_cell cells[2] = {cell_of(VELUM_CELL_GLOBAL, 1, &sheet, 1), cell_of(VELUM_CELL_STATION, 2, &cumulus, 1)};
        cells[1].lat_deg = lats[k];
        cells[1].lon_deg = 179.95;
        velum_state_desc desc = desc_of(cells, 2);
        core_state *state = state_of(&desc, NULL, 1);
        float last = 1.0f;
        for (double d = 0.0; d <= 70000.0; d += 1000.0) {
            double lat;
            double lon;
            assert_true(core_geodesic_direct(lats[k], 179.95, 90.0, d, &lat, &lon));
            core_column c = column_at(state, lat, lon, 100.0);
            float w = c.slot[VELUM_SLOT_CUMULUS].coverage / 0.5f;
            if (d < 29000.0) {
                assert_float_equal(w, 1.0f, 1e-6f);
            } else if (d > 61000.0) {
                assert_float_equal(w, 0.0f, 1e-6f);
            }
            assert_true(w <= last && last - w < 0.06f);
            assert_float_equal(c.slot[VELUM_SLOT_LOW].coverage, 1.0f - w, 1e-5f);
            if (w < 0.999f) {
                assert_float_equal(c.slot[VELUM_SLOT_LOW].base_m, 900.0f, 0.05f); /* not pulled down where it thins */
            }
            last = w;
        }
        core_state_unref(state);
    }
}

static void stations_mix_continuously(void **unused) {
    (void)unused;
    velum_layer layers[3] = {layer_of(VELUM_GENUS_SC, 1.0f, 500.0f, 1000.0f),
                             layer_of(VELUM_GENUS_SC, 0.4f, 1500.0f, 2000.0f),
                             layer_of(VELUM_GENUS_SC, 0.7f, 900.0f, 1800.0f)};
    velum_cell cells[3];
    for (uint32_t i = 0; i < 3; i++) {
        cells[i] = cell_of(VELUM_CELL_STATION, i + 1, &layers[i], 1);
        cells[i].lat_deg = 10.0 + 0.2 * (i == 2);
        cells[i].lon_deg = 20.0 + 0.5 * i;
    }
    velum_state_desc desc = desc_of(cells, 3);
    core_state *state = state_of(&desc, NULL, 1);
    velum_slot_fields last = {0};
    for (int i = 0; i <= 4000; i++) {
        core_column c = column_at(state, 10.0, 19.0 + i * 0.001, 100.0); /* steps of 110 m */
        velum_slot_fields f = c.slot[VELUM_SLOT_LOW];
        assert_true(f.coverage >= 0.0f && f.coverage <= 1.0f);
        if (i > 0) {
            assert_float_equal(f.coverage, last.coverage, 0.01f);
            if (f.coverage > 0.01f && last.coverage > 0.01f) {
                assert_float_equal(f.base_m, last.base_m, 12.0f);
                assert_true(f.base_m > 499.9f && f.base_m < 1500.1f);
            }
        }
        last = f;
    }
    core_state_unref(state);
}

/* Where along a geodesic from (lat, lon) coverage falls through a half. */
static double contour_m(const core_state *state, double lat_deg, double lon_deg, double azimuth_deg, double from_m,
                        double to_m, double texel_m) {
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (from_m + to_m);
        double lat;
        double lon;
        assert_true(core_geodesic_direct(lat_deg, lon_deg, azimuth_deg, middle, &lat, &lon));
        if (coverage_at(state, VELUM_SLOT_MIDDLE, lat, lon, texel_m) > 0.5f) {
            from_m = middle;
        } else {
            to_m = middle;
        }
    }
    return 0.5 * (from_m + to_m);
}

static void a_rectangle_ends_where_geodesics_say(void **unused) {
    (void)unused;
    const double sizes[] = {10000.0, 100000.0, 300000.0, 800000.0};
    const double lats[] = {0.0, 50.0, -33.0, 80.0, 90.0, -89.5};
    velum_layer layer = layer_of(VELUM_GENUS_AS, 1.0f, 3000.0f, 4000.0f);
    for (size_t s = 0; s < 4; s++) {
        double worst = 0.0;
        for (size_t k = 0; k < 6; k++) {
            velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, &layer, 1);
            cell.lat_deg = lats[k];
            cell.lon_deg = k % 2 ? 179.8 : 25.0;
            cell.half_east_m = sizes[s];
            cell.half_north_m = 0.7 * sizes[s];
            cell.rotation_deg = 20.0 * (double)k;
            velum_state_desc desc = desc_of(&cell, 1);
            core_state *state = state_of(&desc, NULL, 1);
            for (int a = 0; a < 36; a++) {
                double angle = a * 10.0 * CORE_DEG; /* from the rectangle's own north */
                double expected = fmin(cell.half_east_m / fmax(fabs(sin(angle)), 1e-9),
                                       cell.half_north_m / fmax(fabs(cos(angle)), 1e-9));
                double found = contour_m(state, cell.lat_deg, cell.lon_deg, a * 10.0 + cell.rotation_deg,
                                         0.9 * expected, 1.1 * expected, 76.0);
                worst = fmax(worst, fabs(found - expected));
            }
            core_state_unref(state);
        }
        print_message("edge of a rectangle of half-width %3.0f km: within %.4f m\n", sizes[s] / 1000.0, worst);
        assert_true(worst < (sizes[s] <= 100000.0 ? 1.0 : 10.0));
    }
}

static void corners_are_round_and_transitions_outside(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_AS, 1.0f, 3000.0f, 4000.0f);
    velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, &layer, 1);
    cell.lat_deg = 47.0;
    cell.lon_deg = 11.0;
    cell.half_east_m = cell.half_north_m = cell.corner_radius_m = 20000.0; /* a circle */
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    for (double azimuth = 0.0; azimuth < 360.0; azimuth += 9.0) {
        double found = contour_m(state, 47.0, 11.0, azimuth, 15000.0, 25000.0, 76.0);
        assert_true(fabs(found - 20000.0) < 1.0);
    }
    core_state_unref(state);

    cell.transition_m = 5000.0;
    state = state_of(&desc, NULL, 1);
    for (double d = 0.0; d < 30000.0; d += 250.0) {
        double lat;
        double lon;
        assert_true(core_geodesic_direct(47.0, 11.0, 33.0, d, &lat, &lon));
        float c = coverage_at(state, VELUM_SLOT_MIDDLE, lat, lon, 76.0);
        if (d <= 20000.0) {
            assert_true(c > 0.9999f);
        } else if (d >= 25000.0) {
            assert_true(c < 0.0001f);
        } else {
            assert_true(c > 0.0f && c < 1.0f);
        }
    }
    core_state_unref(state);
}

static void polygon_edges_are_straight_in_latitude_and_longitude(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_AS, 1.0f, 3000.0f, 4000.0f);
    /* A triangle with a hole, first point repeated as RFC 7946 does. */
    const velum_lat_lon points[] = {{40.0, 0.0}, {40.0, 6.0}, {46.0, 3.0}, {40.0, 0.0},
                                    {41.0, 2.5}, {42.0, 2.5}, {42.0, 3.5}, {41.0, 3.5}};
    const uint32_t rings[] = {4, 4};
    velum_cell cell = cell_of(VELUM_CELL_POLYGON, 1, &layer, 1);
    cell.points = points;
    cell.point_count = 8;
    cell.ring_sizes = rings;
    cell.ring_count = 2;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 40.5, 1.5, 76.0), 1.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 41.5, 3.0, 76.0), 0.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 39.9, 3.0, 76.0), 0.0f, 1e-6f);
    for (double t = 0.05; t < 0.95; t += 0.05) {
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 40.0, 6.0 * t, 76.0), 0.5f, 1e-3f);
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 40.0 + 6.0 * t, 3.0 * t, 76.0), 0.5f, 1e-3f);
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 41.0 + t, 2.5, 76.0), 0.5f, 1e-3f);
        /* 30 m to either side: 30 / (2 x 76) off a half. */
        double lat;
        double lon;
        assert_true(core_geodesic_direct(40.0, 6.0 * t, 0.0, 30.0, &lat, &lon));
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, lat, lon, 76.0), 0.5f + 30.0f / 152.0f, 2e-3f);
    }
    core_state_unref(state);
}

static void a_region_over_the_antimeridian_has_no_line(void **unused) {
    (void)unused;
    velum_layer layer = layer_of(VELUM_GENUS_AS, 1.0f, 3000.0f, 4000.0f);
    layer.wind_east_m_s = 30.0f;
    /* Split as RFC 7946 says; the eastern part reaches farther north. */
    const velum_lat_lon points[] = {{-20.0, 175.0},  {-20.0, 180.0},  {-10.0, 180.0}, {-10.0, 175.0},
                                    {-20.0, -180.0}, {-20.0, -175.0}, {-5.0, -175.0}, {-5.0, -180.0}};
    const uint32_t rings[] = {4, 4};
    velum_cell cell = cell_of(VELUM_CELL_POLYGON, 1, &layer, 1);
    cell.points = points;
    cell.point_count = 8;
    cell.ring_sizes = rings;
    cell.ring_count = 2;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    for (double lat = -19.0; lat < -11.0; lat += 0.37) {
        for (double lon = 179.99; lon <= 180.01; lon += 0.0005) {
            assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, lat, lon, 500.0), 1.0f, 1e-5f);
        }
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, lat, 180.0, 500.0), 1.0f, 1e-5f);
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, lat, -180.0, 500.0), 1.0f, 1e-5f);
    }
    /* East is east there: towards -y. */
    assert_float_equal(column_at(state, -15.0, 180.0, 500.0).slot[VELUM_SLOT_MIDDLE].wind_y_m_s, -30.0f, 0.1f);
    /* Where only one part reaches, the antimeridian is its edge. */
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, -7.0, 180.0, 500.0), 0.5f, 1e-3f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, -7.0, 179.9, 500.0), 0.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, -7.0, -179.9, 500.0), 1.0f, 1e-6f);
    core_state_unref(state);

    /* Longitudes beyond 180 say the same. */
    const velum_lat_lon whole[] = {{-20.0, 175.0}, {-20.0, 185.0}, {-10.0, 185.0}, {-10.0, 175.0}};
    const uint32_t one[] = {4};
    cell.points = whole;
    cell.point_count = 4;
    cell.ring_sizes = one;
    cell.ring_count = 1;
    state = state_of(&desc, NULL, 1);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, -15.0, 180.0, 500.0), 1.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, -15.0, -175.5, 500.0), 1.0f, 1e-6f);
    assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, -15.0, -174.5, 500.0), 0.0f, 1e-6f);
    core_state_unref(state);

    /* A cap over the pole. */
    const velum_lat_lon cap[] = {{80.0, -180.0}, {80.0, 180.0}, {90.0, 180.0}, {90.0, -180.0}};
    cell.points = cap;
    state = state_of(&desc, NULL, 1);
    for (double lon = -180.0; lon <= 180.0; lon += 10.0) {
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 90.0, lon, 500.0), 1.0f, 1e-6f);
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 89.999, lon, 500.0), 1.0f, 1e-6f);
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 80.0, lon, 500.0), 0.5f, 1e-3f);
        assert_float_equal(coverage_at(state, VELUM_SLOT_MIDDLE, 79.9, lon, 500.0), 0.0f, 1e-6f);
    }
    core_state_unref(state);
}

static void regions_lie_over_stations_by_priority(void **unused) {
    (void)unused;
    velum_layer layers[4] = {
        layer_of(VELUM_GENUS_SC, 0.2f, 500.0f, 900.0f), layer_of(VELUM_GENUS_SC, 0.4f, 600.0f, 900.0f),
        layer_of(VELUM_GENUS_SC, 0.6f, 700.0f, 900.0f), layer_of(VELUM_GENUS_AS, 0.5f, 3000.0f, 4000.0f)};
    velum_cell cells[4];
    for (uint32_t i = 0; i < 4; i++) {
        cells[i] = cell_of(i == 0 ? VELUM_CELL_STATION : VELUM_CELL_RECTANGLE, 10 - i, &layers[i], 1);
        cells[i].half_east_m = cells[i].half_north_m = 20000.0;
    }
    cells[1].priority = 5;
    cells[2].priority = -3;
    velum_state_desc desc = desc_of(cells, 3);
    core_state *state = state_of(&desc, NULL, 1);
    core_column c = column_at(state, 0.0, 0.0, 100.0);
    assert_float_equal(c.slot[VELUM_SLOT_LOW].coverage, 0.4f, 1e-6f); /* priority 5, not the order given */
    core_state_unref(state);

    /* Joining: other slots stay; in one slot coverage overlaps at random. */
    cells[3].flags |= VELUM_CELL_MERGE_LAYERS;
    cells[3].priority = 9;
    cells[1].flags |= VELUM_CELL_MERGE_LAYERS;
    desc.cell_count = 4;
    state = state_of(&desc, NULL, 1);
    c = column_at(state, 0.0, 0.0, 100.0);
    assert_int_equal(c.mask, 1u << VELUM_SLOT_LOW | 1u << VELUM_SLOT_MIDDLE);
    assert_float_equal(c.slot[VELUM_SLOT_LOW].coverage, 1.0f - 0.4f * 0.6f, 1e-5f);
    assert_float_equal(c.slot[VELUM_SLOT_LOW].base_m, (0.4f * 600.0f + 0.6f * 700.0f), 0.1f);
    assert_float_equal(c.slot[VELUM_SLOT_MIDDLE].coverage, 0.5f, 1e-6f);
    core_state_unref(state);

    /* A clear sky replaces; a cell without layers leaves them. */
    cells[3] = cell_of(VELUM_CELL_RECTANGLE, 77, NULL, 0);
    cells[3].half_east_m = cells[3].half_north_m = 20000.0;
    cells[3].priority = 99;
    state = state_of(&desc, NULL, 1);
    assert_int_equal(column_at(state, 0.0, 0.0, 100.0).mask, 0);
    core_state_unref(state);
    cells[3].flags = VELUM_CELL_HAS_VISIBILITY;
    cells[3].visibility_m = 50.0f;
    state = state_of(&desc, NULL, 1);
    c = column_at(state, 0.0, 0.0, 100.0);
    assert_int_equal(c.mask, 1u << VELUM_SLOT_LOW);
    assert_float_equal(c.surface.visibility_m, 50.0f, 0.01f);
    assert_float_equal(column_at(state, 1.0, 1.0, 100.0).surface.visibility_m, CORE_VISIBILITY_DEFAULT_M, 1.0f);
    core_state_unref(state);
}

static void wind_is_a_vector(void **unused) {
    (void)unused;
    /* A station beside the pole blows along its own east; across the pole the vector goes on straight. */
    velum_layer layer = layer_of(VELUM_GENUS_SC, 1.0f, 500.0f, 900.0f);
    layer.wind_north_m_s = 20.0f;
    velum_cell cell = cell_of(VELUM_CELL_STATION, 1, &layer, 1);
    cell.lat_deg = 89.95;
    cell.lon_deg = 0.0;
    cell.flags |= VELUM_CELL_HAS_WIND | VELUM_CELL_HAS_TEMPERATURE | VELUM_CELL_HAS_PRECIPITATION;
    cell.wind_east_m_s = 7.0f;
    cell.temperature_k = 250.0f;
    cell.precipitation_mm_h = 2.0f;
    cell.precipitation = VELUM_PRECIPITATION_SNOW;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    for (double lat = 89.8; lat <= 90.2; lat += 0.02) {
        core_column c = column_at(state, lat <= 90.0 ? lat : 180.0 - lat, lat <= 90.0 ? 0.0 : 180.0, 100.0);
        assert_float_equal(c.slot[VELUM_SLOT_LOW].wind_x_m_s, -20.0f, 0.01f);
        assert_float_equal(c.surface.wind_y_m_s, 7.0f, 0.01f);
        assert_float_equal(c.surface.temperature_k, 250.0f, 0.01f);
        assert_float_equal(c.surface.precipitation_mm_h, 2.0f, 0.01f);
        assert_int_equal(c.surface.precipitation, VELUM_PRECIPITATION_SNOW);
    }
    core_state_unref(state);
}

static velum_slot_fields middle_at(const core_state *state, double east_m) {
    double lat;
    double lon;
    assert_true(core_geodesic_direct(47.0, 11.0, 90.0, east_m, &lat, &lon));
    return column_at(state, lat, lon, 76.0).slot[VELUM_SLOT_MIDDLE];
}

static void a_sheet_thins_out_where_it_ends(void **unused) {
    (void)unused;
    velum_layer sheet = layer_of(VELUM_GENUS_NS, 0.9f, 1000.0f, 4000.0f);
    velum_layer tower = layer_of(VELUM_GENUS_CB, 0.9f, 1000.0f, 9000.0f);
    const velum_layer both[2] = {sheet, tower};
    velum_cell cell = cell_of(VELUM_CELL_RECTANGLE, 1, both, 2);
    cell.lat_deg = 47.0;
    cell.lon_deg = 11.0;
    cell.half_east_m = cell.half_north_m = 20000.0;
    cell.transition_m = 12000.0;
    velum_state_desc desc = desc_of(&cell, 1);
    core_state *state = state_of(&desc, NULL, 1);
    float last_m = 3001.0f;
    const float dense_1_m = middle_at(state, 0.0).extinction_1_m;
    float last_1_m = dense_1_m;
    for (double d = 0.0; d < 31900.0; d += 100.0) {
        velum_slot_fields f = middle_at(state, d);
        /* A veil towards its edge, without a jump: by the fourth power of what is left of it. */
        const float left = fminf(fmaxf(f.coverage / 0.9f, 0.1f) / 0.9f, 1.0f);
        assert_float_equal(f.extinction_1_m / dense_1_m, left * left * left * left, 1e-3f);
        assert_true(f.extinction_1_m <= last_1_m * 1.001f);
        last_1_m = f.extinction_1_m;
        float thickness_m = f.top_m - f.base_m;
        assert_float_equal(f.base_m, 1000.0f, 0.5f);
        assert_float_equal(thickness_m, d < 19900.0 ? 3000.0f : thickness_m, 0.5f);
        assert_true(thickness_m <= last_m + 0.5f && last_m - thickness_m < 120.0f && thickness_m > 199.0f);
        /* Half gone, it is no deeper than its cells (a kilometre or two) are wide. */
        assert_true(f.coverage > 0.45f || thickness_m < 1000.0f);
        last_m = thickness_m;
    }
    assert_true(last_m < 210.0f);
    double lat;
    double lon;
    const float storm_1_m = column_at(state, 47.0, 11.0, 76.0).slot[VELUM_SLOT_STORM].extinction_1_m;
    assert_true(core_geodesic_direct(47.0, 11.0, 90.0, 26000.0, &lat, &lon));
    core_column c = column_at(state, lat, lon, 76.0);
    /* Half full, of 0.7 down to which storms are whole: as much of the sky is covered as there, by an anvil as high as
     * ever, with fewer towers under it: none are left at 0.35. */
    assert_float_equal(c.slot[VELUM_SLOT_STORM].coverage, 0.7f * 0.9f, 1e-3f);
    assert_float_equal(c.slot[VELUM_SLOT_STORM].top_m, 9000.0f, 0.5f);
    assert_float_equal(c.slot[VELUM_SLOT_STORM].kind, (0.5f - 0.35f) / 0.35f * VELUM_KIND_CB, 1e-3f);
    assert_float_equal(c.slot[VELUM_SLOT_STORM].extinction_1_m, storm_1_m, 1e-4f * storm_1_m);
    core_state_unref(state);

    /* Storms that give way to one of the same height do not sink between. */
    const velum_layer few = layer_of(VELUM_GENUS_CB, 0.3f, 1000.0f, 9000.0f);
    velum_cell storms[2] = {cell_of(VELUM_CELL_GLOBAL, 2, &few, 1), cell};
    storms[1].layers = &tower;
    storms[1].layer_count = 1;
    velum_state_desc storms_desc = desc_of(storms, 2);
    state = state_of(&storms_desc, NULL, 1);
    for (double d = 0.0; d < 40000.0; d += 500.0) {
        assert_true(core_geodesic_direct(47.0, 11.0, 90.0, d, &lat, &lon));
        assert_float_equal(column_at(state, lat, lon, 76.0).slot[VELUM_SLOT_STORM].top_m, 9000.0f, 1.0f);
    }
    core_state_unref(state);

    /* Cut sharply it keeps its depth to the edge. */
    cell.transition_m = 0.0;
    state = state_of(&desc, NULL, 1);
    for (double d = 19800.0; d < 20070.0; d += 10.0) {
        assert_float_equal(middle_at(state, d).top_m, 4000.0f, 0.5f);
        assert_float_equal(middle_at(state, d).extinction_1_m, dense_1_m, 1e-4f * dense_1_m);
    }
    core_state_unref(state);

    /* Where a region gives the sky that is there already, no seam shows. */
    velum_cell cells[2] = {cell_of(VELUM_CELL_GLOBAL, 2, &sheet, 1), cell};
    cells[1].transition_m = 12000.0;
    cells[1].layer_count = 1;
    desc = desc_of(cells, 2);
    state = state_of(&desc, NULL, 1);
    for (double d = 0.0; d < 40000.0; d += 500.0) {
        assert_float_equal(middle_at(state, d).top_m, 4000.0f, 0.5f);
    }
    core_state_unref(state);

    /* Round a hole the sheet thins out towards it. */
    cells[1].layer_count = 0;
    state = state_of(&desc, NULL, 1);
    assert_float_equal(middle_at(state, 35000.0).top_m, 4000.0f, 0.5f);
    velum_slot_fields rim = middle_at(state, 24000.0);
    assert_true(rim.coverage > 0.05f && rim.coverage < 0.45f && rim.top_m - rim.base_m < 1000.0f);
    core_state_unref(state);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_global_cell_is_everywhere),
        cmocka_unit_test(a_grid_is_bilinear_and_closed),
        cmocka_unit_test(a_regional_grid_ends_at_its_border),
        cmocka_unit_test(a_station_fades_into_the_background),
        cmocka_unit_test(stations_mix_continuously),
        cmocka_unit_test(a_rectangle_ends_where_geodesics_say),
        cmocka_unit_test(corners_are_round_and_transitions_outside),
        cmocka_unit_test(polygon_edges_are_straight_in_latitude_and_longitude),
        cmocka_unit_test(a_region_over_the_antimeridian_has_no_line),
        cmocka_unit_test(regions_lie_over_stations_by_priority),
        cmocka_unit_test(wind_is_a_vector),
        cmocka_unit_test(a_sheet_thins_out_where_it_ends),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
