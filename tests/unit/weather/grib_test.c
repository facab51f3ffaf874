#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <velum_weather/weather.h>

#include "tests/files.h"

typedef struct sample {
    char *bytes;
    size_t size;
} sample;

static sample load(const char *name) {
    char path[128], full[1024];
    sample loaded = {0};
    snprintf(path, sizeof(path), "tests/data/fuzz/grib/%s.grib2", name);
    loaded.bytes = read_all(source_path(full, path), &loaded.size);
    assert_non_null(loaded.bytes);
    assert_true(loaded.size > 100);
    return loaded;
}

static velum_result read(velum_weather_set *set, const char *bytes, size_t size, velum_weather_error *error) {
    memset(error, 0, sizeof(*error));
    return velum_weather_read_grib_memory(set, "f.grib2", bytes, size, NULL, error);
}

/* Fails with the text; the set must stay empty. */
static void refused(const char *bytes, size_t size, velum_result expected, const char *text) {
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_error error;
    const velum_result result = read(set, bytes, size, &error);
    if (result != expected || !strstr(error.text, text)) {
        print_error("found %d '%s', expected %d '%s'\n", result, error.text, expected, text);
    }
    assert_int_equal(result, expected);
    assert_non_null(strstr(error.text, text));
    velum_state_desc state;
    velum_weather_set_state(set, &state);
    assert_null(state.grid);
    velum_weather_set_destroy(set);
}

static void check_layer(const velum_layer *layer) {
    assert_int_equal(layer->struct_size, sizeof(*layer));
    assert_true(layer->genus >= VELUM_GENUS_CI && layer->genus <= VELUM_GENUS_CB);
    assert_true(layer->coverage > 0.0f && layer->coverage <= 1.0f);
    assert_true(layer->base_m >= -500.0f && layer->top_m <= 25000.0f);
    assert_true(layer->top_m - layer->base_m >= 99.0f);
    assert_true(layer->water_g_m3 > 0.0f && layer->water_g_m3 <= 3.0f);
    assert_true(layer->radius_um >= 0.5f && layer->radius_um <= 500.0f);
    assert_true(fabsf(layer->wind_east_m_s) < 150.0f && fabsf(layer->wind_north_m_s) < 150.0f);
    assert_true(layer->precipitation_mm_h >= 0.0f && layer->precipitation_mm_h <= 500.0f);
}

static void all_packings_give_the_same_weather(void **state) {
    (void)state;
    static const char *const names[] = {"simple", "jpeg", "png", "ccsds", "ieee"};
    velum_weather_set *sets[5];
    velum_state_desc states[5];
    for (int i = 0; i < 5; ++i) {
        const sample file = load(names[i]);
        velum_weather_error error;
        sets[i] = velum_weather_set_create();
        const velum_result result = read(sets[i], file.bytes, file.size, &error);
        if (result) {
            print_error("%s\n", error.text);
        }
        assert_int_equal(result, VELUM_OK);
        velum_weather_set_state(sets[i], &states[i]);
        free(file.bytes);
    }
    uint32_t layers = 0;
    const velum_grid *grid = states[0].grid;
    assert_int_equal(grid->columns, 12);
    assert_int_equal(grid->rows, 8);
    assert_true(grid->lat_first_deg == 65.0 && grid->lat_step_deg == -2.5 && grid->lon_step_deg == 2.5);
    for (int i = 1; i < 5; ++i) {
        for (uint32_t node = 0; node < 96; ++node) {
            const velum_cell *a = &grid->cells[node], *b = &states[i].grid->cells[node];
            assert_int_equal(a->layer_count, b->layer_count);
            for (uint32_t j = 0; j < a->layer_count; ++j, ++layers) {
                check_layer(&b->layers[j]);
                assert_true(fabsf(a->layers[j].base_m - b->layers[j].base_m) < 5.0f);
                assert_true(fabsf(a->layers[j].coverage - b->layers[j].coverage) < 0.001f);
            }
        }
    }
    assert_true(layers > 4 * 200);
    for (int i = 0; i < 5; ++i) {
        velum_weather_set_destroy(sets[i]);
    }
}

/* Forecasts that came over telecommunication lines carry a heading before the first message. */
static void a_heading_is_skipped(void **state) {
    (void)state;
    const sample file = load("simple");
    char *bytes = malloc(file.size + 21);
    memcpy(bytes, "LBXX01 KWBC 101200\r\r\n", 21);
    memcpy(bytes + 21, file.bytes, file.size);
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_error error;
    assert_int_equal(read(set, bytes, file.size + 21, &error), VELUM_OK);
    velum_weather_set_destroy(set);
    free(bytes);
    free(file.bytes);
}

static void foreign_files_are_refused(void **state) {
    (void)state;
    sample file = load("simple");
    refused("", 0, VELUM_ERROR_UNSUPPORTED, "f.grib2: message 1: at byte 0");
    refused("{\"velum\": 1}", 12, VELUM_ERROR_UNSUPPORTED, "expected \"GRIB\"");
    file.bytes[7] = 1;
    refused(file.bytes, file.size, VELUM_ERROR_UNSUPPORTED, "found GRIB edition 1, expected 2");
    free(file.bytes);
}

static void a_cut_anywhere_is_one_error(void **state) {
    (void)state;
    const sample file = load("simple");
    uint32_t whole = 0;
    for (size_t size = 1; size < file.size; size += size < 600 ? 1 : 97) {
        char *cut = malloc(size); /* its own block, so that a sanitizer sees a read beyond */
        memcpy(cut, file.bytes, size);
        velum_weather_set *set = velum_weather_set_create();
        velum_weather_error error;
        const velum_result result = read(set, cut, size, &error);
        whole += result == VELUM_OK;
        /* A cut between two messages leaves a shorter file that is whole. */
        assert_true(result == VELUM_OK || error.message > 0 || strstr(error.text, "no cloud fields"));
        velum_weather_set_destroy(set);
        free(cut);
    }
    assert_true(whole < 4);
    refused(file.bytes, file.size - 10, VELUM_ERROR_ARGUMENT, "message 36: truncated");
    free(file.bytes);
}

static void flipped_bytes_never_break_the_reader(void **state) {
    (void)state;
    static const char *const names[] = {"simple", "png", "ccsds", "jpeg", "gfs_low_cloud"};
    uint32_t refusals = 0, seed = 1;
    for (int i = 0; i < 5; ++i) {
        const sample file = load(names[i]);
        for (int turn = 0; turn < 60; ++turn) {
            char *bytes = malloc(file.size);
            memcpy(bytes, file.bytes, file.size);
            for (int flip = 0; flip < 3; ++flip) {
                seed = seed * 1664525u + 1013904223u;
                bytes[seed % file.size] ^= (char)(1u << (seed >> 28 & 7));
            }
            velum_weather_set *set = velum_weather_set_create();
            velum_weather_error error;
            const velum_result result = read(set, bytes, file.size, &error);
            assert_true((result != VELUM_OK) == (error.text[0] != '\0'));
            refusals += result != VELUM_OK;
            velum_weather_set_destroy(set);
            free(bytes);
        }
        free(file.bytes);
    }
    assert_true(refusals > 30);
}

/* Of a JPEG 2000 code stream, whose head says so in the 43rd byte (ISO/IEC 15444-1, A.5.1). */
static void signed_pictures_are_refused(void **state) {
    (void)state;
    sample file = load("jpeg");
    char *stream = memmem(file.bytes, file.size, "\xff\x4f\xff\x51", 4);
    assert_non_null(stream);
    stream[42] = (char)(stream[42] | 0x80);
    refused(file.bytes, file.size, VELUM_ERROR_ARGUMENT, "the picture's size or depth");
    free(file.bytes);
}

static char *find_section(sample file, uint32_t message, int number) {
    size_t at = 0;
    for (uint32_t i = 1; at + 16 < file.size; ++i) {
        const unsigned char *bytes = (const unsigned char *)file.bytes + at;
        const size_t length = (size_t)bytes[12] << 24 | (size_t)bytes[13] << 16 | (size_t)bytes[14] << 8 | bytes[15];
        for (size_t section = 16; i == message && bytes[section] != '7';) {
            if (bytes[section + 4] == number) {
                return file.bytes + at + section;
            }
            section += (size_t)bytes[section + 2] << 8 | bytes[section + 3];
        }
        at += length;
    }
    fail();
    abort();
}

static void put_u32(char *bytes, uint32_t value) {
    for (int i = 0; i < 4; ++i) {
        bytes[i] = (char)(value >> (24 - 8 * i));
    }
}

static void absurd_grids_and_values_are_refused_by_name(void **state) {
    (void)state;
    sample file = load("simple");
    char *grid = find_section(file, 1, 3);
    char kept[72];
    memcpy(kept, grid, 72);
    grid[13] = 30;
    refused(file.bytes, file.size, VELUM_ERROR_UNSUPPORTED, "definition template: found 30");
    memcpy(grid, kept, 72);
    memset(grid + 46, 0x7f, 4);
    refused(file.bytes, file.size, VELUM_ERROR_ARGUMENT, "latitude");
    memcpy(grid, kept, 72);
    memset(grid + 30, 0x7f, 4);
    refused(file.bytes, file.size, VELUM_ERROR_ARGUMENT, "columns");
    memcpy(grid, kept, 72);
    grid[71] = (char)0x80;
    refused(file.bytes, file.size, VELUM_ERROR_UNSUPPORTED, "scanning mode");
    memcpy(grid, kept, 72);
    /* Another grid in a later message. */
    grid = find_section(file, 5, 3);
    grid[52] ^= 1;
    refused(file.bytes, file.size, VELUM_ERROR_UNSUPPORTED, "message 5: grid: found 12 x 8");
    grid[52] ^= 1;

    /* A reference value of NaN, and one that makes the field absurd. */
    char *packing = find_section(file, 1, 5);
    memcpy(kept, packing, 21);
    put_u32(packing + 11, 0x7fc00000u);
    refused(file.bytes, file.size, VELUM_ERROR_ARGUMENT, "message 1: packing: found reference");
    put_u32(packing + 11, 0x49000000u);
    refused(file.bytes, file.size, VELUM_ERROR_ARGUMENT, "message 1: geopotential height (gpm): found");
    memcpy(packing, kept, 21);
    packing[10] = 77;
    refused(file.bytes, file.size, VELUM_ERROR_UNSUPPORTED, "found template 5.77");
    free(file.bytes);

    file = load("ieee");
    char *data = find_section(file, 2, 7);
    put_u32(data + 5, 0x7fc00000u);
    refused(file.bytes, file.size, VELUM_ERROR_ARGUMENT, "message 2: ");
    free(file.bytes);
}

static void a_file_without_cloud_is_refused_whole(void **state) {
    (void)state;
    const sample file = load("simple");
    const unsigned char *bytes = (const unsigned char *)file.bytes;
    const size_t first = (size_t)bytes[14] << 8 | bytes[15];
    refused(file.bytes, first, VELUM_ERROR_UNSUPPORTED, "no cloud fields in 1 messages");
    free(file.bytes);
}

static void a_second_file_replaces_the_grid_and_an_error_does_not(void **state) {
    (void)state;
    const sample small = load("simple"), large = load("gfs_low_cloud");
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_error error;
    velum_state_desc desc;
    assert_int_equal(read(set, small.bytes, small.size, &error), VELUM_OK);
    assert_int_equal(read(set, large.bytes, large.size, &error), VELUM_OK);
    velum_weather_set_state(set, &desc);
    assert_int_equal(desc.grid->columns, 144);
    assert_true(read(set, small.bytes, small.size - 1, &error) < 0);
    velum_weather_set_state(set, &desc);
    assert_int_equal(desc.grid->columns, 144);
    assert_int_equal(desc.cell_count, 0);
    velum_weather_set_destroy(set);
    free(small.bytes);
    free(large.bytes);
}

static void the_real_forecast(void **state) {
    (void)state;
    char path[1024];
    if (!shared_path(path, "data/gfs.t12z.pgrbf120.2p5deg.grib2")) {
        print_message("%s is not there (set VELUM_SHARED)\n", path);
        skip();
    }
    velum_weather_set *set = velum_weather_set_create();
    velum_weather_report *report = calloc(1, sizeof(*report));
    velum_weather_error error = {0};
    struct timespec from, to;
    clock_gettime(CLOCK_MONOTONIC, &from);
    assert_int_equal(velum_weather_read_grib(set, path, report, &error), VELUM_OK);
    clock_gettime(CLOCK_MONOTONIC, &to);
    print_message("read in %.3f s\n", (double)(to.tv_sec - from.tv_sec) + 1e-9 * (double)(to.tv_nsec - from.tv_nsec));
    assert_int_equal(report->grid_nodes, 144 * 73);
    assert_int_equal(report->grib_messages_seen, 343);
    assert_true(report->grib_messages_used > 140);

    velum_state_desc desc;
    velum_weather_set_state(set, &desc);
    const velum_grid *grid = desc.grid;
    assert_true(grid->lat_first_deg == 90.0 && grid->lat_step_deg == -2.5 && grid->lon_step_deg == 2.5);
    double cover = 0.0, weight = 0.0, layers = 0.0, low_base_m = 0.0, low = 0.0;
    for (uint32_t i = 0; i < grid->columns * grid->rows; ++i) {
        const velum_cell *cell = &grid->cells[i];
        const double share = cos(cell->lat_deg * 3.14159265358979 / 180.0) + 1e-9;
        double clear = 1.0;
        assert_true(cell->temperature_k > 200.0f && cell->temperature_k < 330.0f);
        assert_true(cell->elevation_m > -200.0f && cell->elevation_m < 6000.0f);
        for (uint32_t j = 0; j < cell->layer_count; ++j) {
            const velum_layer *layer = &cell->layers[j];
            check_layer(layer);
            assert_true(layer->base_m >= cell->elevation_m);
            clear *= 1.0 - (double)layer->coverage;
            if (layer->genus == VELUM_GENUS_SC || layer->genus == VELUM_GENUS_ST) {
                low_base_m += (double)(layer->base_m - cell->elevation_m);
                low += 1.0;
            }
            layers += 1.0;
        }
        cover += share * (1.0 - clear);
        weight += share;
    }
    /* Global mean cover of observations is 0.6 to 0.7 (Stubenrauch et al. 2013). */
    print_message("mean cover %.3f, %.0f layers\n", cover / weight, layers);
    assert_true(cover / weight > 0.45 && cover / weight < 0.8);
    assert_true(low_base_m / low > 150.0 && low_base_m / low < 1500.0);
    /* Tibet at 32.5 N, 85 E is high, the polar night at 90 N is cold, Borneo is warm. */
    assert_true(grid->cells[23 * 144 + 34].elevation_m > 4500.0f);
    assert_true(grid->cells[0].temperature_k < 255.0f);
    assert_true(grid->cells[36 * 144 + 46].temperature_k > 290.0f);
    free(report);
    velum_weather_set_destroy(set);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(all_packings_give_the_same_weather),
        cmocka_unit_test(a_heading_is_skipped),
        cmocka_unit_test(foreign_files_are_refused),
        cmocka_unit_test(a_cut_anywhere_is_one_error),
        cmocka_unit_test(flipped_bytes_never_break_the_reader),
        cmocka_unit_test(signed_pictures_are_refused),
        cmocka_unit_test(absurd_grids_and_values_are_refused_by_name),
        cmocka_unit_test(a_file_without_cloud_is_refused_whole),
        cmocka_unit_test(a_second_file_replaces_the_grid_and_an_error_does_not),
        cmocka_unit_test(the_real_forecast),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
