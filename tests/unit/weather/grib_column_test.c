#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <string.h>

#include "weather/grib_column.h"

static void near_to(double found, double expected, double tolerance) {
    if (!(fabs(found - expected) <= tolerance)) {
        print_error("found %g, expected %g +- %g\n", found, expected, tolerance);
    }
    assert_true(fabs(found - expected) <= tolerance);
}

static const velum_layer *of_genus(const velum_layer *layers, uint32_t count, int32_t genus) {
    for (uint32_t i = 0; i < count; ++i) {
        if (layers[i].genus == genus) {
            return &layers[i];
        }
    }
    return NULL;
}

static grib_surface dry_surface(void) {
    return (grib_surface){.cape_j_kg = 0.0f};
}

/* ICAO Doc 7488: pressures and temperatures at geometric heights. */
static void the_standard_atmosphere_is_the_icao_one(void **state) {
    (void)state;
    static const double table[][3] = {{89874.6, 1000, 281.651},
                                      {54048.3, 5000, 255.676},
                                      {26499.9, 10000, 223.252},
                                      {12111.8, 15000, 216.650},
                                      {5529.3, 20000, 216.650}};
    grib_profile profile;
    grib_standard_profile(&profile);
    for (int i = 0; i < 5; ++i) {
        near_to((double)grib_profile_height_m(&profile, (float)table[i][0]), table[i][1], 25.0);
        near_to((double)grib_profile_temperature_k(&profile, (float)table[i][0]), table[i][2], 1.0);
    }
    near_to((double)grib_geometric_height_m(10000.0f), 10015.8, 0.1);
}

/* In an isothermal atmosphere height is H ln(p0/p): linear in log p, so exact between levels and beyond them. */
static void heights_are_exact_in_an_isothermal_atmosphere(void **state) {
    (void)state;
    const float scale_m = 8000.0f;
    grib_profile profile = {.count = 3};
    static const float levels[] = {90000.0f, 50000.0f, 20000.0f};
    for (int i = 0; i < 3; ++i) {
        profile.pressure_pa[i] = levels[i];
        profile.log_pressure[i] = logf(levels[i]);
        profile.height_m[i] = scale_m * logf(100000.0f / levels[i]);
        profile.temperature_k[i] = 273.0f;
    }
    for (float pressure_pa = 10000.0f; pressure_pa < 105000.0f; pressure_pa += 1234.0f) {
        near_to((double)grib_profile_height_m(&profile, pressure_pa), 8000.0 * log(100000.0 / (double)pressure_pa),
                0.05);
    }
}

static void water_paths_are_integrals_over_pressure(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    for (uint32_t i = 0; i < profile.count; ++i) {
        profile.water_kg_kg[i] = 1e-4f;
    }
    near_to((double)grib_profile_water_path_g_m2(&profile, 80000.0f, 70000.0f), 1e-4 * 10000.0 / 9.80665 * 1000.0,
            0.02);
    near_to((double)grib_profile_water_path_g_m2(&profile, 80000.0f, 80000.0f), 0.0, 0.0);
    /* Parts add up to the whole. */
    const float whole = grib_profile_water_path_g_m2(&profile, 97000.0f, 23000.0f);
    const float parts = grib_profile_water_path_g_m2(&profile, 97000.0f, 61000.0f) +
                        grib_profile_water_path_g_m2(&profile, 61000.0f, 23000.0f);
    near_to((double)whole, (double)parts, 0.1);
    /* Linear in pressure between levels: a wedge holds half. */
    for (uint32_t i = 0; i < profile.count; ++i) {
        profile.water_kg_kg[i] = profile.pressure_pa[i] == 70000.0f ? 2e-4f : 0.0f;
    }
    near_to((double)grib_profile_water_path_g_m2(&profile, 85000.0f, 70000.0f), 0.5 * 2e-4 * 15000.0 / 9.80665 * 1000.0,
            0.05);
}

static void water_of_the_file_is_kept_in_the_layer(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    for (uint32_t i = 0; i < profile.count; ++i) {
        profile.water_kg_kg[i] = 1e-4f;
    }
    const grib_deck decks[GRIB_DECKS] = {[GRIB_DECK_LOW] = {0.5f, 90000.0f, 85000.0f}};
    const grib_surface surface = dry_surface();
    velum_layer layers[GRIB_DECKS];
    assert_int_equal(grib_column_layers(&profile, decks, &surface, layers), 1);
    const double path = (double)(layers[0].water_g_m3 * layers[0].coverage * (layers[0].top_m - layers[0].base_m));
    near_to(path, 1e-4 * 5000.0 / 9.80665 * 1000.0, 0.5);
    assert_int_equal(layers[0].water, VELUM_WATER_LIQUID);
}

static void cold_layers_are_ice(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    const grib_deck decks[GRIB_DECKS] = {
        [GRIB_DECK_LOW] = {0.6f, 90000.0f, 85000.0f}, [GRIB_DECK_HIGH] = {0.4f, 35000.0f, 25000.0f}};
    const grib_surface surface = dry_surface();
    velum_layer layers[GRIB_DECKS];
    assert_int_equal(grib_column_layers(&profile, decks, &surface, layers), 2);
    assert_int_equal(layers[0].water, VELUM_WATER_LIQUID);
    assert_int_equal(layers[1].water, VELUM_WATER_ICE);
    assert_int_equal(layers[1].genus, VELUM_GENUS_CI);
    near_to((double)layers[1].base_m, 8117.0, 60.0);
    near_to((double)layers[1].top_m, (double)layers[1].base_m + 800.0 / 0.6, 0.5);
    assert_true(layers[1].radius_um > layers[0].radius_um);
    assert_true(layers[1].water_g_m3 > 0.0f && layers[1].water_g_m3 < 0.05f);
}

/* What leaves much of the sky clear is shallow, keeps its base and its water path; what covers all is as deep as the
 * file says, and towers always are. */
static void broken_layers_are_shallow(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    for (uint32_t i = 0; i < profile.count; ++i) {
        profile.water_kg_kg[i] = 6e-5f;
    }
    const grib_surface surface = dry_surface();
    static const float covers[] = {0.02f, 0.1f, 0.3f, 0.5f, 0.7f, 0.85f, 1.0f};
    float last_m = 0.0f;
    for (int i = 0; i < 7; ++i) {
        const grib_deck decks[GRIB_DECKS] = {[GRIB_DECK_MIDDLE] = {covers[i], 65000.0f, 42000.0f}};
        velum_layer layers[GRIB_DECKS];
        assert_int_equal(grib_column_layers(&profile, decks, &surface, layers), 1);
        const float thickness_m = layers[0].top_m - layers[0].base_m;
        near_to((double)layers[0].base_m, 3591.0, 30.0);
        assert_true(thickness_m > last_m);
        assert_true(covers[i] > 0.5f || thickness_m <= 801.0f);
        last_m = thickness_m;
        if (covers[i] >= 0.5f) {
            const double path = (double)(layers[0].water_g_m3 * layers[0].coverage * thickness_m);
            near_to(path, 6e-5 * 23000.0 / 9.80665 * 1000.0, 0.5);
        }
    }
    near_to((double)last_m, 3249.0, 40.0);

    /* Cu without showers grows with its cover; with them, and Cb, it is as deep as the file says. */
    grib_deck tower[GRIB_DECKS] = {[GRIB_DECK_CONVECTIVE] = {0.1f, 90000.0f, 60000.0f}};
    grib_surface showers = {.cape_j_kg = 400.0f};
    velum_layer layers[GRIB_DECKS];
    assert_int_equal(grib_column_layers(&profile, tower, &showers, layers), 1);
    assert_int_equal(layers[0].genus, VELUM_GENUS_CU);
    near_to((double)(layers[0].top_m - layers[0].base_m), 900.0, 0.5);
    showers.convective_mm_h = showers.precipitation_mm_h = 0.4f;
    grib_column_layers(&profile, tower, &showers, layers);
    assert_int_equal(layers[0].genus, VELUM_GENUS_CU);
    near_to((double)(layers[0].top_m - layers[0].base_m), 3220.0, 40.0);
    tower[GRIB_DECK_CONVECTIVE].top_pa = 20000.0f;
    grib_column_layers(&profile, tower, &showers, layers);
    assert_int_equal(layers[0].genus, VELUM_GENUS_CB);
    assert_true(layers[0].top_m - layers[0].base_m > 10000.0f);
}

static void genera_follow_the_rules(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    velum_layer layers[GRIB_DECKS];
    grib_surface surface = dry_surface();

    grib_deck stratus[GRIB_DECKS] = {[GRIB_DECK_LOW] = {1.0f, 98500.0f, 95500.0f}};
    assert_int_equal(grib_column_layers(&profile, stratus, &surface, layers), 1);
    assert_int_equal(layers[0].genus, VELUM_GENUS_ST);

    grib_deck fair[GRIB_DECKS] = {[GRIB_DECK_LOW] = {0.3f, 90000.0f, 80000.0f}};
    surface.cape_j_kg = 400.0f;
    grib_column_layers(&profile, fair, &surface, layers);
    assert_int_equal(layers[0].genus, VELUM_GENUS_CU);
    surface.cape_j_kg = 0.0f;
    grib_column_layers(&profile, fair, &surface, layers);
    assert_int_equal(layers[0].genus, VELUM_GENUS_SC);

    surface.precipitation_mm_h = 2.0f;
    surface.precipitation = VELUM_PRECIPITATION_RAIN;
    grib_deck front[GRIB_DECKS] = {[GRIB_DECK_LOW] = {1.0f, 95000.0f, 75000.0f},
                                   [GRIB_DECK_MIDDLE] = {0.9f, 65000.0f, 45000.0f},
                                   [GRIB_DECK_HIGH] = {0.9f, 40000.0f, 25000.0f}};
    assert_int_equal(grib_column_layers(&profile, front, &surface, layers), 3);
    assert_int_equal(layers[0].genus, VELUM_GENUS_NS);
    near_to((double)layers[0].precipitation_mm_h, 2.0, 1e-5);
    assert_int_equal(layers[0].precipitation, VELUM_PRECIPITATION_RAIN);
    assert_int_equal(layers[1].genus, VELUM_GENUS_AS);
    assert_int_equal(layers[2].genus, VELUM_GENUS_CS);

    surface.convective_mm_h = 2.0f;
    surface.cape_j_kg = 1500.0f;
    grib_deck storm[GRIB_DECKS] = {[GRIB_DECK_CONVECTIVE] = {0.4f, 90000.0f, 20000.0f}};
    assert_int_equal(grib_column_layers(&profile, storm, &surface, layers), 1);
    assert_int_equal(layers[0].genus, VELUM_GENUS_CB);
    near_to((double)layers[0].precipitation_mm_h, 5.0, 1e-4);
    storm[GRIB_DECK_CONVECTIVE].top_pa = 75000.0f;
    grib_column_layers(&profile, storm, &surface, layers);
    assert_int_equal(layers[0].genus, VELUM_GENUS_CU);
}

/* Low and convective cloud in one interval: at random overlap they cover what the greater covers. */
static void overlapping_decks_keep_the_cover(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    const grib_surface surface = {.cape_j_kg = 1000.0f, .convective_mm_h = 1.0f, .precipitation_mm_h = 1.0f};
    velum_layer layers[GRIB_DECKS];
    for (float low = 0.1f; low <= 1.0f; low += 0.15f) {
        for (float tower = 0.1f; tower < 0.95f; tower += 0.2f) {
            const grib_deck decks[GRIB_DECKS] = {
                [GRIB_DECK_LOW] = {low, 92000.0f, 80000.0f}, [GRIB_DECK_CONVECTIVE] = {tower, 90000.0f, 20000.0f}};
            const uint32_t count = grib_column_layers(&profile, decks, &surface, layers);
            float clear = 1.0f;
            for (uint32_t i = 0; i < count; ++i) {
                clear *= 1.0f - layers[i].coverage;
            }
            assert_non_null(of_genus(layers, count, VELUM_GENUS_CB));
            near_to(1.0 - (double)clear, (double)fmaxf(low, tower), 0.011);
        }
    }
}

static void bounds_hold_for_any_deck(void **state) {
    (void)state;
    grib_profile profile;
    grib_standard_profile(&profile);
    static const float pressures[] = {0.0f, 1000.0f, 1500.0f, 22000.0f, 50000.0f, 50001.0f, 101000.0f, 115000.0f};
    uint32_t seen = 0;
    for (int base = 0; base < 8; ++base) {
        for (int top = 0; top < 8; ++top) {
            for (int deck = 0; deck < GRIB_DECKS; ++deck) {
                grib_deck decks[GRIB_DECKS] = {{0}};
                grib_surface surface = {.elevation_m = base % 2 ? 5600.0f : -70.0f,
                                        .cape_j_kg = NAN,
                                        .precipitation_mm_h = 400.0f,
                                        .convective_mm_h = 300.0f};
                velum_layer layers[GRIB_DECKS];
                decks[deck] = (grib_deck){0.02f, pressures[base], pressures[top]};
                const uint32_t count = grib_column_layers(&profile, decks, &surface, layers);
                for (uint32_t i = 0; i < count; ++i, ++seen) {
                    assert_true(layers[i].base_m >= surface.elevation_m && layers[i].top_m <= 25000.0f);
                    assert_true(layers[i].top_m - layers[i].base_m >= 99.9f);
                    assert_true(layers[i].water_g_m3 > 0.0f && layers[i].water_g_m3 < 5.0f);
                    assert_true(layers[i].radius_um >= 0.5f && layers[i].radius_um <= 500.0f);
                    assert_true(layers[i].precipitation_mm_h <= 500.0f);
                }
            }
        }
    }
    assert_true(seen == 4 * 7 * 7);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_standard_atmosphere_is_the_icao_one),
        cmocka_unit_test(heights_are_exact_in_an_isothermal_atmosphere),
        cmocka_unit_test(water_paths_are_integrals_over_pressure),
        cmocka_unit_test(water_of_the_file_is_kept_in_the_layer),
        cmocka_unit_test(cold_layers_are_ice),
        cmocka_unit_test(broken_layers_are_shallow),
        cmocka_unit_test(genera_follow_the_rules),
        cmocka_unit_test(overlapping_decks_keep_the_cover),
        cmocka_unit_test(bounds_hold_for_any_deck),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
