#include "synthetic.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

double random_unit(uint64_t *state) {
    uint64_t x = *state += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return (double)((x ^ (x >> 31)) >> 11) * 0x1p-53;
}

double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

core_state *state_of(const velum_state_desc *desc, const core_state *base, uint64_t id) {
    core_state *state = NULL;
    core_error error = {0};
    if (core_state_create(desc, base, id, &state, &error) != VELUM_OK) {
        print_error("%s\n", error.text);
    }
    assert_non_null(state);
    return state;
}

core_state *state_of_layer(velum_layer layer, uint64_t id) {
    const velum_cell cell = cell_of(VELUM_CELL_GLOBAL, 1, &layer, 1);
    const velum_state_desc desc = desc_of(&cell, 1);
    return state_of(&desc, NULL, id);
}

static core_tile *cached_tile(void *context, const core_state *state, uint32_t key) {
    return core_tile_cache_get(context, state, key);
}

core_oracle oracle_over(const core_noise *noise, core_tile_cache *cache, const core_state *a, const core_state *b,
                        double time_s) {
    return (core_oracle){.noise = noise,
                         .state = {a, b},
                         .drift = core_drift_at(time_s, 7),
                         .detail = 1.0f,
                         .tile = cached_tile,
                         .tile_context = cache};
}

#define COLUMNS 144u
#define ROWS 73u

static void make_nodes(synthetic_world *world) {
    for (uint32_t j = 0; j < ROWS; j++) {
        for (uint32_t i = 0; i < COLUMNS; i++) {
            uint32_t at = j * COLUMNS + i;
            double lat = (90.0 - 2.5 * j) * 0.0174532925;
            double lon = 2.5 * i * 0.0174532925;
            /* Smooth over the sphere, so one value at each pole. */
            double x = cos(lat) * cos(lon);
            double y = cos(lat) * sin(lon);
            float low = (float)fmax(0.0, 0.5 + 0.5 * sin(5.0 * x + 3.0 * y));
            float middle = (float)fmax(0.0, sin(4.0 * y - 2.0 * sin(lat)));
            float high = (float)fmax(0.0, sin(6.0 * x + sin(lat)));
            velum_layer *layers = &world->node_layers[at * 3];
            layers[0] = layer_of(VELUM_GENUS_SC, low, 800.0f, 1500.0f);
            layers[1] = layer_of(VELUM_GENUS_AS, middle, 3000.0f, 4500.0f);
            layers[2] = layer_of(VELUM_GENUS_CI, high, 9000.0f, 10000.0f);
            layers[0].wind_east_m_s = 10.0f;
            layers[2].water = VELUM_WATER_ICE;
            layers[2].radius_um = 40.0f;
            layers[2].water_g_m3 = 0.02f;
            world->nodes[at] = cell_of(0, at, layers, 3);
            world->nodes[at].flags |= VELUM_CELL_HAS_WIND | VELUM_CELL_HAS_VISIBILITY;
            world->nodes[at].visibility_m = 20000.0f;
            world->nodes[at].wind_east_m_s = 5.0f;
        }
    }
}

static void make_stations(synthetic_world *world, uint32_t count) {
    uint64_t seed = 2014;
    for (uint32_t i = 0; i < count; i++) {
        double u = random_unit(&seed);
        velum_layer *layers = &world->station_layers[i * 3];
        velum_cell *cell = &world->stations[i];
        float base = 300.0f + 1500.0f * (float)random_unit(&seed);
        uint32_t layer_count = (uint32_t)(4.0 * random_unit(&seed));
        layers[0] = layer_of(VELUM_GENUS_CU, 0.4f, base, base + 900.0f);
        layers[1] = layer_of(VELUM_GENUS_SC, 0.8f, base + 1000.0f, base + 1500.0f);
        layers[2] = layer_of(VELUM_GENUS_AC, 0.5f, base + 3000.0f, base + 3500.0f);
        *cell = cell_of(VELUM_CELL_STATION, 100000u + i, layers, layer_count);
        cell->flags |= VELUM_CELL_HAS_VISIBILITY | VELUM_CELL_HAS_WIND;
        cell->visibility_m = 9999.0f;
        /* Two in three crowd over two continents. */
        cell->lat_deg = u < 0.33   ? 30.0 + 20.0 * random_unit(&seed)
                        : u < 0.66 ? 38.0 + 20.0 * random_unit(&seed)
                                   : -60.0 + 130.0 * random_unit(&seed);
        cell->lon_deg = u < 0.33   ? -120.0 + 50.0 * random_unit(&seed)
                        : u < 0.66 ? -8.0 + 35.0 * random_unit(&seed)
                                   : -180.0 + 360.0 * random_unit(&seed);
    }
}

void synthetic_world_init(synthetic_world *world, uint32_t station_count) {
    world->nodes = calloc(COLUMNS * ROWS, sizeof *world->nodes);
    world->node_layers = calloc(COLUMNS * ROWS * 3, sizeof *world->node_layers);
    world->stations = calloc(station_count + 1u, sizeof *world->stations);
    world->station_layers = calloc(station_count * 3u + 1u, sizeof *world->station_layers);
    assert_non_null(world->nodes);
    assert_non_null(world->node_layers);
    assert_non_null(world->stations);
    assert_non_null(world->station_layers);
    make_nodes(world);
    make_stations(world, station_count);
    world->grid = (velum_grid){.struct_size = sizeof(velum_grid),
                               .lat_first_deg = 90.0,
                               .lon_first_deg = 0.0,
                               .lat_step_deg = -2.5,
                               .lon_step_deg = 2.5,
                               .columns = COLUMNS,
                               .rows = ROWS,
                               .cells = world->nodes};
    world->desc = desc_of(world->stations, station_count);
    world->desc.grid = &world->grid;
}

void synthetic_world_finish(synthetic_world *world) {
    free(world->nodes);
    free(world->node_layers);
    free(world->stations);
    free(world->station_layers);
}
