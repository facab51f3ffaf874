#include "cell.h"

#include "geodesy.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "shared/fringe.h"
#include "state.h"

_Static_assert(sizeof(velum_cell) >= CORE_CELL_V1_SIZE, "frozen size");
_Static_assert(sizeof(velum_layer) >= CORE_LAYER_V1_SIZE, "frozen size");

#define LAYER_FLAGS (VELUM_LAYER_UNIFORM | VELUM_LAYER_EXTINCTION | VELUM_LAYER_PHASE_HG | VELUM_LAYER_ALBEDO)
#define CELL_FLAGS                                                                                                     \
    (VELUM_CELL_MERGE_LAYERS | VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_VISIBILITY | VELUM_CELL_HAS_WIND |               \
     VELUM_CELL_HAS_PRECIPITATION | VELUM_CELL_HAS_TEMPERATURE)

#define MAX_WIND_M_S VELUM_TEXEL_WIND_RANGE_M_S
#define MAX_EXTENT_M 5.0e6
#define FOG_DEPTH_M 300.0f

typedef struct checker {
    const char *where;
    int layer; /* -1: the cell's own */
    core_error *error;
    velum_result result;
} checker;

static void fail(checker *check, velum_result result, const char *field, const char *found, const char *expected) {
    if (check->result != VELUM_OK) {
        return;
    }
    check->result = result;
    if (check->layer >= 0) {
        core_fail(check->error, result, "%s, layer %d, %s: found %s, expected %s", check->where, check->layer, field,
                  found, expected);
    } else {
        core_fail(check->error, result, "%s, %s: found %s, expected %s", check->where, field, found, expected);
    }
}

static void check_range(checker *check, const char *field, double value, double low, double high) {
    if (!(value >= low && value <= high)) {
        char found[32];
        char expected[64];
        snprintf(found, sizeof found, "%.9g", value);
        snprintf(expected, sizeof expected, "%.9g..%.9g", low, high);
        fail(check, VELUM_ERROR_ARGUMENT, field, found, expected);
    }
}

static void check_flags(checker *check, const char *field, uint32_t value, uint32_t known) {
    if (value & ~known) {
        char found[32];
        char expected[64];
        snprintf(found, sizeof found, "0x%" PRIx32, value);
        snprintf(expected, sizeof expected, "bits of 0x%" PRIx32 " only", known);
        fail(check, VELUM_ERROR_FLAGS, field, found, expected);
    }
}

static void check_wind(checker *check, const char *field, double east, double north) {
    double speed = sqrt(east * east + north * north);
    if (!(speed <= (double)MAX_WIND_M_S)) {
        char found[32];
        snprintf(found, sizeof found, "%.9g m/s", speed);
        fail(check, VELUM_ERROR_ARGUMENT, field, found, "a speed of at most 128 m/s");
    }
}

static void check_layer(checker *check, const velum_layer *layer) {
    check_flags(check, "flags", layer->flags, LAYER_FLAGS);
    if (layer->flags & (VELUM_LAYER_PHASE_HG | VELUM_LAYER_ALBEDO) && !(layer->flags & VELUM_LAYER_UNIFORM)) {
        fail(check, VELUM_ERROR_FLAGS, "flags", "PHASE_HG or ALBEDO without UNIFORM", "both for UNIFORM layers only");
    }
    check_range(check, "genus", layer->genus, VELUM_GENUS_CI, VELUM_GENUS_CB);
    check_range(check, "water", layer->water, VELUM_WATER_LIQUID, VELUM_WATER_ICE);
    check_range(check, "coverage", (double)layer->coverage, 0.0, 1.0);
    check_range(check, "base_m", (double)layer->base_m, -500.0, 25000.0);
    check_range(check, "top_m", (double)layer->top_m, -500.0, 25000.0);
    if (check->result == VELUM_OK && !(layer->top_m > layer->base_m)) {
        char found[32];
        char expected[64];
        snprintf(found, sizeof found, "%.9g", (double)layer->top_m);
        snprintf(expected, sizeof expected, "above base_m %.9g", (double)layer->base_m);
        fail(check, VELUM_ERROR_ARGUMENT, "top_m", found, expected);
    }
    if (layer->flags & VELUM_LAYER_EXTINCTION) {
        check_range(check, "extinction_1_m", (double)layer->extinction_1_m, 0.0, 10.0);
    } else {
        check_range(check, "water_g_m3", (double)layer->water_g_m3, 0.0, 20.0);
        check_range(check, "radius_um", (double)layer->radius_um, 0.5, 500.0);
    }
    if (layer->flags & VELUM_LAYER_ALBEDO) {
        check_range(check, "albedo", (double)layer->albedo, 0.0, 1.0);
    }
    if (layer->flags & VELUM_LAYER_PHASE_HG) {
        check_range(check, "hg_asymmetry", (double)layer->hg_asymmetry, (double)-0.999f, (double)0.999f);
    }
    check_wind(check, "wind", (double)layer->wind_east_m_s, (double)layer->wind_north_m_s);
    check_range(check, "transition_m", (double)layer->transition_m, 0.0, 25000.0);
    check_range(check, "scud", (double)layer->scud, 0.0, 1.0);
    check_range(check, "precipitation_mm_h", (double)layer->precipitation_mm_h, 0.0, 500.0);
    check_range(check, "precipitation", layer->precipitation, VELUM_PRECIPITATION_NONE, VELUM_PRECIPITATION_SLEET);
}

static void check_polygon(checker *check, const velum_cell *cell) {
    uint64_t sum = 0;
    char found[32];
    check_range(check, "point_count", cell->point_count, 3, CORE_POLYGON_MAX_POINTS);
    check_range(check, "ring_count", cell->ring_count, 1, CORE_POLYGON_MAX_POINTS / 3);
    if (check->result == VELUM_OK && (!cell->points || !cell->ring_sizes)) {
        fail(check, VELUM_ERROR_ARGUMENT, cell->points ? "ring_sizes" : "points", "null", "an array");
    }
    for (uint32_t r = 0; check->result == VELUM_OK && r < cell->ring_count; r++) {
        check_range(check, "ring_sizes", cell->ring_sizes[r], 3, CORE_POLYGON_MAX_POINTS);
        sum += cell->ring_sizes[r];
    }
    if (check->result == VELUM_OK && sum != cell->point_count) {
        snprintf(found, sizeof found, "a sum of %" PRIu64, sum);
        fail(check, VELUM_ERROR_ARGUMENT, "ring_sizes", found, "point_count in sum");
    }
    for (uint32_t i = 0; check->result == VELUM_OK && i < cell->point_count; i++) {
        check_range(check, "points lat_deg", cell->points[i].lat_deg, -90.0, 90.0);
        check_range(check, "points lon_deg", cell->points[i].lon_deg, -180.0, 360.0);
    }
}

static void check_shape(checker *check, const velum_cell *cell) {
    check_range(check, "kind", cell->kind, VELUM_CELL_GLOBAL, VELUM_CELL_RECTANGLE);
    if (cell->kind == VELUM_CELL_STATION || cell->kind == VELUM_CELL_RECTANGLE) {
        check_range(check, "lat_deg", cell->lat_deg, -90.0, 90.0);
        check_range(check, "lon_deg", cell->lon_deg, -180.0, 360.0);
    }
    if (cell->kind == VELUM_CELL_STATION && cell->radius_m != 0.0) {
        check_range(check, "radius_m", cell->radius_m, 1000.0, 500000.0);
    }
    if (cell->kind == VELUM_CELL_RECTANGLE) {
        check_range(check, "half_east_m", cell->half_east_m, 1.0, MAX_EXTENT_M);
        check_range(check, "half_north_m", cell->half_north_m, 1.0, MAX_EXTENT_M);
        check_range(check, "corner_radius_m", cell->corner_radius_m, 0.0, fmin(cell->half_east_m, cell->half_north_m));
        check_range(check, "rotation_deg", cell->rotation_deg, -36000.0, 36000.0);
    }
    if (cell->kind == VELUM_CELL_POLYGON || cell->kind == VELUM_CELL_RECTANGLE) {
        check_range(check, "transition_m", cell->transition_m, 0.0, MAX_EXTENT_M);
    }
    if (cell->kind == VELUM_CELL_POLYGON) {
        check_polygon(check, cell);
    }
}

static void check_surface(checker *check, const velum_cell *cell) {
    check_flags(check, "flags", cell->flags, CELL_FLAGS);
    if (cell->reserved != 0) {
        fail(check, VELUM_ERROR_FLAGS, "reserved", "a value", "0");
    }
    if (cell->flags & VELUM_CELL_HAS_VISIBILITY) {
        check_range(check, "visibility_m", (double)cell->visibility_m, 1.0, 1e6);
        check_range(check, "fog_top_m", (double)cell->fog_top_m, -500.0, 25000.0);
        check_range(check, "elevation_m", (double)cell->elevation_m, -500.0, 9000.0);
    }
    if (cell->flags & VELUM_CELL_HAS_WIND) {
        check_wind(check, "wind", (double)cell->wind_east_m_s, (double)cell->wind_north_m_s);
        check_range(check, "gust_m_s", (double)cell->gust_m_s, 0.0, (double)MAX_WIND_M_S);
    }
    if (cell->flags & VELUM_CELL_HAS_TEMPERATURE) {
        check_range(check, "temperature_k", (double)cell->temperature_k, 100.0, 400.0);
        if (cell->dew_point_k != 0.0f) {
            check_range(check, "dew_point_k", (double)cell->dew_point_k, 100.0, 400.0);
        }
    }
    if (cell->flags & VELUM_CELL_HAS_PRECIPITATION) {
        check_range(check, "precipitation_mm_h", (double)cell->precipitation_mm_h, 0.0, 500.0);
        check_range(check, "precipitation", cell->precipitation, VELUM_PRECIPITATION_NONE, VELUM_PRECIPITATION_SLEET);
    }
    check_range(check, "thunderstorm", cell->thunderstorm, 0, 1);
}

/* East and north of a cell's own place; at a pole those of its own longitude. */
static void frame_at(double lat_deg, double lon_deg, double east[3], double north[3]) {
    double c = cos(lon_deg * CORE_DEG);
    double s = sin(lon_deg * CORE_DEG);
    double sin_lat = sin(lat_deg * CORE_DEG);
    east[0] = -s;
    east[1] = c;
    east[2] = 0.0;
    north[0] = -sin_lat * c;
    north[1] = -sin_lat * s;
    north[2] = cos(lat_deg * CORE_DEG);
}

/* A polygon's own place: the mean of its vertices on the sphere. */
static void middle_of(const velum_cell *cell, double normal[3]) {
    double sum[3] = {0.0, 0.0, 0.0};
    for (uint32_t i = 0; i < cell->point_count; i++) {
        core_normal(cell->points[i].lat_deg, cell->points[i].lon_deg, normal);
        for (int k = 0; k < 3; k++) {
            sum[k] += normal[k] / cell->point_count;
        }
    }
    double length = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    if (length < 1e-6) {
        core_normal(cell->points[0].lat_deg, cell->points[0].lon_deg, normal);
        return;
    }
    for (int k = 0; k < 3; k++) {
        normal[k] = sum[k] / length;
    }
}

typedef struct frame {
    bool global;
    double east[3], north[3];
} frame;

static void set_wind(float out[3], const frame *at, float east_m_s, float north_m_s) {
    if (at->global) {
        out[0] = east_m_s;
        out[1] = north_m_s;
        out[2] = 0.0f;
        return;
    }
    for (int i = 0; i < 3; i++) {
        out[i] = (float)(at->east[i] * (double)east_m_s + at->north[i] * (double)north_m_s);
    }
}

static void make_surface(core_cell_reading *reading, const frame *at) {
    const velum_cell *cell = &reading->cell;
    core_cell_fields *fields = &reading->fields;
    float *surface = fields->surface;
    fields->flags = cell->flags;
    if (cell->flags & VELUM_CELL_HAS_VISIBILITY) {
        surface[CORE_SURFACE_LOG_VISIBILITY] = logf(cell->visibility_m);
        surface[CORE_SURFACE_FOG_TOP] = cell->fog_top_m != 0.0f ? cell->fog_top_m : cell->elevation_m + FOG_DEPTH_M;
        surface[CORE_SURFACE_ELEVATION] = cell->elevation_m;
    }
    if (cell->flags & VELUM_CELL_HAS_WIND) {
        set_wind(&surface[CORE_SURFACE_WIND_X], at, cell->wind_east_m_s, cell->wind_north_m_s);
        surface[CORE_SURFACE_GUST] = cell->gust_m_s;
    }
    if (cell->flags & VELUM_CELL_HAS_TEMPERATURE) {
        surface[CORE_SURFACE_TEMPERATURE] = cell->temperature_k;
        surface[CORE_SURFACE_TEMPERATURE_KNOWN] = 1.0f;
        surface[CORE_SURFACE_DEW_POINT] = cell->dew_point_k;
        surface[CORE_SURFACE_DEW_POINT_KNOWN] = cell->dew_point_k > 0.0f ? 1.0f : 0.0f;
    }
    surface[CORE_SURFACE_THUNDERSTORM] = (float)cell->thunderstorm;
    float rate_mm_h = 0.0f;
    int32_t kind = VELUM_PRECIPITATION_NONE;
    if (cell->flags & VELUM_CELL_HAS_PRECIPITATION) {
        rate_mm_h = cell->precipitation_mm_h;
        kind = cell->precipitation;
    } else if (cell->flags & VELUM_CELL_HAS_LAYERS) {
        /* What falls, falls from the layers. */
        for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
            const core_slot_layer *layer = &reading->layers.slot[slot];
            if (reading->layers.mask & (1u << slot) && layer->precipitation_mm_h > rate_mm_h) {
                rate_mm_h = layer->precipitation_mm_h;
                kind = layer->precipitation;
            }
        }
        if (rate_mm_h > 0.0f || !(cell->flags & VELUM_CELL_MERGE_LAYERS)) {
            fields->flags |= VELUM_CELL_HAS_PRECIPITATION;
        }
    }
    if (rate_mm_h > 0.0f) {
        surface[CORE_SURFACE_PRECIPITATION + (kind != VELUM_PRECIPITATION_NONE ? kind : VELUM_PRECIPITATION_RAIN)] =
            rate_mm_h;
    }
}

/* Showers fall from towers. */
static float fall_kind_of(const core_slot_layer *layer, uint32_t slot) {
    switch (layer->precipitation) {
    case VELUM_PRECIPITATION_SNOW: return VELUM_FALL_SNOW;
    case VELUM_PRECIPITATION_SLEET: return VELUM_FALL_SLEET;
    case VELUM_PRECIPITATION_DRIZZLE: return VELUM_FALL_DRIZZLE;
    case VELUM_PRECIPITATION_HAIL: return VELUM_FALL_SHOWER;
    default: return slot == VELUM_SLOT_CUMULUS || slot == VELUM_SLOT_STORM ? VELUM_FALL_SHOWER : VELUM_FALL_RAIN;
    }
}

/* Heights of the layer with what it has beyond its cloud proper, MSL. */
static velum_span_m set_fringe(const core_slot_layer *layer, uint32_t slot, float field[CORE_FIELD_COUNT]) {
    velum_span_m span = {layer->base_m, layer->top_m};
    if (slot >= VELUM_SLOT_UNIFORM) {
        return span;
    }
    float c = layer->coverage;
    float fall = sqrtf(sqrtf(layer->precipitation_mm_h));
    field[CORE_FIELD_SCUD] = c * layer->scud;
    field[CORE_FIELD_TRANSITION] = c * layer->transition_m;
    field[CORE_FIELD_FALL] = c * fall;
    field[CORE_FIELD_FALL_KIND] = c * fall * fall_kind_of(layer, slot);
    const float scud_m = layer->scud > 0.0f ? VELUM_SCUD_SHALLOW_M + VELUM_SCUD_DEEP_M * layer->scud : 0.0f;
    span.low -= fmaxf(fmaxf(scud_m, layer->transition_m), VELUM_FALL_REACH_M * fall);
    span.low = fmaxf(span.low, fminf(VELUM_FALL_FLOOR_M, layer->base_m));
    span.high += layer->transition_m;
    return span;
}

static void make_slots(core_cell_reading *reading, const frame *at) {
    reading->min_base_m = 1e9f;
    reading->max_top_m = -1e9f;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        const core_slot_layer *layer = &reading->layers.slot[slot];
        if (!(reading->layers.mask & (1u << slot))) {
            continue;
        }
        core_cell_slot *out = &reading->slots[reading->slot_count++];
        float c = layer->coverage;
        float wind[3];
        set_wind(wind, at, layer->wind_east_m_s, layer->wind_north_m_s);
        out->slot = slot;
        out->field[CORE_FIELD_COVERAGE] = c;
        out->field[CORE_FIELD_BASE] = c * layer->base_m;
        out->field[CORE_FIELD_TOP] = c * layer->top_m;
        out->field[CORE_FIELD_LOG_EXTINCTION] = c * logf(fmaxf(layer->extinction_1_m, 1e-7f));
        for (int i = 0; i < 3; i++) {
            out->field[CORE_FIELD_WIND_X + i] = c * wind[i];
        }
        out->field[CORE_FIELD_KIND] = c * layer->kind;
        out->field[CORE_FIELD_FULL] = c * c;
        const velum_span_m span = set_fringe(layer, slot, out->field);
        reading->min_base_m = fminf(reading->min_base_m, span.low);
        reading->max_top_m = fmaxf(reading->max_top_m, span.high);
    }
    reading->fields.slot_count = (uint8_t)reading->slot_count;
    reading->fields.slot_mask = (uint8_t)reading->layers.mask;
}

velum_result core_cell_read(core_cell_reading *reading, const velum_cell *cell, bool grid_node, double lat_deg,
                            double lon_deg, const char *where, core_error *error) {
    checker check = {.where = where, .layer = -1, .error = error, .result = VELUM_OK};
    velum_layer layers[CORE_CELL_MAX_LAYERS];
    memset(reading, 0, sizeof *reading);
    if (!core_copy_struct(&reading->cell, sizeof reading->cell, cell, CORE_CELL_V1_SIZE)) {
        fail(&check, VELUM_ERROR_STRUCT_SIZE, "struct_size", "less", "the size of velum_cell");
        return check.result;
    }
    const velum_cell *own = &reading->cell;
    check_surface(&check, own);
    if (!grid_node) {
        check_shape(&check, own);
        lat_deg = own->lat_deg;
        lon_deg = own->lon_deg;
    }
    check_range(&check, "layer_count", own->layer_count, 0, CORE_CELL_MAX_LAYERS);
    if (own->layer_count > 0 && !own->layers) {
        fail(&check, VELUM_ERROR_ARGUMENT, "layers", "null", "an array");
    }
    if (check.result != VELUM_OK) {
        return check.result;
    }
    uint32_t stride = own->layer_count == 0 ? 0 : own->layer_stride ? own->layer_stride : own->layers->struct_size;
    if (own->layer_count > 0 && stride < CORE_LAYER_V1_SIZE) {
        fail(&check, VELUM_ERROR_STRUCT_SIZE, "layer_stride", "less", "at least the size of velum_layer");
        return check.result;
    }
    for (uint32_t i = 0; i < own->layer_count && check.result == VELUM_OK; i++) {
        check.layer = (int)i;
        if (!core_copy_struct(&layers[i], sizeof layers[i], (const char *)own->layers + (size_t)i * stride,
                              CORE_LAYER_V1_SIZE)) {
            fail(&check, VELUM_ERROR_STRUCT_SIZE, "struct_size", "less", "the size of velum_layer");
            break;
        }
        check_layer(&check, &layers[i]);
    }
    if (check.result != VELUM_OK) {
        return check.result;
    }
    if (own->flags & VELUM_CELL_HAS_LAYERS) {
        core_slots_assign(layers, own->layer_count, &reading->layers);
    }
    frame at = {.global = !grid_node && own->kind == VELUM_CELL_GLOBAL};
    if (!grid_node && own->kind == VELUM_CELL_POLYGON) {
        double middle[3];
        middle_of(own, middle);
        lat_deg = core_normal_lat_deg(middle);
        lon_deg = core_normal_lon_deg(middle);
    }
    if (!at.global) {
        frame_at(lat_deg, lon_deg, at.east, at.north);
    }
    make_slots(reading, &at);
    make_surface(reading, &at);
    return VELUM_OK;
}

static void set_cap(core_cell *cell, const velum_cell *from) {
    memcpy(cell->cap_normal, cell->normal, sizeof cell->cap_normal);
    if (cell->kind == VELUM_CELL_STATION) {
        cell->reach_m = cell->radius_m * 1.01;
    } else if (cell->kind == VELUM_CELL_RECTANGLE) {
        cell->reach_m = (hypot(cell->half_east_m, cell->half_north_m) + cell->transition_m + cell->breadth_m) * 1.01;
    } else if (cell->kind == VELUM_CELL_POLYGON) {
        double farthest_m = 0.0;
        middle_of(from, cell->cap_normal);
        for (uint32_t i = 0; i < from->point_count; i++) {
            double normal[3];
            double chord2 = 0.0;
            core_normal(from->points[i].lat_deg, from->points[i].lon_deg, normal);
            for (int k = 0; k < 3; k++) {
                chord2 += (normal[k] - cell->cap_normal[k]) * (normal[k] - cell->cap_normal[k]);
            }
            farthest_m = fmax(farthest_m, 2.0 * CORE_RADIUS_M * asin(fmin(0.5 * sqrt(chord2), 1.0)));
        }
        farthest_m += 0.5 * core_polygon_longest_edge_m(cell->polygon);
        cell->reach_m = (farthest_m + cell->transition_m + cell->breadth_m) * 1.02;
        /* A boundary that spans this much may have the rest of the planet inside. */
        if (farthest_m > 8e6) {
            cell->reach_m = 1e9;
        }
    } else {
        cell->reach_m = 1e9;
    }
    if (cell->reach_m > 1.2e7) {
        cell->reach_m = 1e9;
    }
}

velum_result core_cell_create(const velum_cell *from, core_cell **out, core_error *error) {
    core_cell_reading reading;
    char where[64];
    core_cell *cell = NULL;
    *out = NULL;
    memset(&reading, 0, sizeof reading);
    if (!core_copy_struct(&reading.cell, sizeof reading.cell, from, CORE_CELL_V1_SIZE)) {
        return core_fail(error, VELUM_ERROR_STRUCT_SIZE, "cell, struct_size: found %u, expected at least %u",
                         from->struct_size, CORE_CELL_V1_SIZE);
    }
    snprintf(where, sizeof where, "cell %" PRIu64, reading.cell.id);
    velum_result result = core_cell_read(&reading, from, false, 0.0, 0.0, where, error);
    if (result != VELUM_OK) {
        return result;
    }
    cell = calloc(1, sizeof *cell);
    if (!cell) {
        goto error;
    }
    const velum_cell *own = &reading.cell;
    atomic_init(&cell->references, 1);
    cell->id = own->id;
    cell->kind = own->kind;
    cell->priority = own->priority;
    if (own->kind == VELUM_CELL_STATION || own->kind == VELUM_CELL_RECTANGLE) {
        cell->lat_deg = own->lat_deg;
        cell->lon_deg = own->lon_deg;
    }
    core_normal(cell->lat_deg, cell->lon_deg, cell->normal);
    frame_at(cell->lat_deg, cell->lon_deg, cell->east, cell->north);
    core_position(cell->normal, 0.0, cell->position_m);
    if (own->kind == VELUM_CELL_STATION) {
        cell->radius_m = own->radius_m > 0.0 ? own->radius_m : CORE_STATION_RADIUS_M;
    } else if (own->kind == VELUM_CELL_RECTANGLE) {
        cell->half_east_m = own->half_east_m;
        cell->half_north_m = own->half_north_m;
        cell->corner_m = own->corner_radius_m;
        cell->sin_rotation = sin(fmod(own->rotation_deg, 360.0) * CORE_DEG);
        cell->cos_rotation = cos(fmod(own->rotation_deg, 360.0) * CORE_DEG);
        cell->transition_m = own->transition_m;
        cell->breadth_m = fmin(cell->half_east_m, cell->half_north_m);
    } else if (own->kind == VELUM_CELL_POLYGON) {
        cell->polygon = core_polygon_create(own->points, own->ring_sizes, own->ring_count);
        if (!cell->polygon) {
            goto error;
        }
        cell->transition_m = own->transition_m;
        cell->breadth_m = core_polygon_breadth_m(cell->polygon);
    }
    set_cap(cell, own);
    cell->fields = reading.fields;
    cell->uniform[0] = reading.layers.slot[VELUM_SLOT_UNIFORM];
    cell->uniform[1] = reading.layers.slot[VELUM_SLOT_UNIFORM_2];
    cell->min_base_m = reading.min_base_m;
    cell->max_top_m = reading.max_top_m;
    cell->merged = reading.layers.merged;
    cell->slot_count = reading.slot_count;
    memcpy(cell->slots, reading.slots, sizeof cell->slots);
    *out = cell;
    return VELUM_OK;
error:
    core_cell_unref(cell);
    return core_fail(error, VELUM_ERROR_OUT_OF_MEMORY, "%s: out of memory", where);
}

core_cell *core_cell_ref(core_cell *cell) {
    atomic_fetch_add_explicit(&cell->references, 1, memory_order_relaxed);
    return cell;
}

void core_cell_unref(core_cell *cell) {
    if (cell && atomic_fetch_sub_explicit(&cell->references, 1, memory_order_acq_rel) == 1) {
        core_polygon_destroy(cell->polygon);
        free(cell);
    }
}

size_t core_cell_bytes(const core_cell *cell) {
    return sizeof *cell + (cell->polygon ? core_polygon_bytes(cell->polygon) : 0);
}

static int rank(const core_cell *cell) {
    return cell->kind == VELUM_CELL_GLOBAL ? 0 : cell->kind == VELUM_CELL_STATION ? 1 : 2;
}

int core_cell_compare(const core_cell *a, const core_cell *b) {
    if (rank(a) != rank(b)) {
        return rank(a) < rank(b) ? -1 : 1;
    }
    if (a->priority != b->priority) {
        return a->priority < b->priority ? -1 : 1;
    }
    return (a->id > b->id) - (a->id < b->id);
}

double core_cell_point_distance_m(const core_cell *cell, const double normal[3]) {
    double square = 0.0;
    for (int i = 0; i < 3; i++) {
        double d = normal[i] - cell->normal[i];
        square += d * d;
    }
    /* asin x = x + x^3 / 6 + 3 x^5 / 40 + 15 x^7 / 336..., within 1e-12 here. */
    if (square < 1e-3) {
        double x2 = 0.25 * square;
        return CORE_RADIUS_M * sqrt(square) * (1.0 + x2 * (1.0 / 6.0 + x2 * (3.0 / 40.0 + x2 * (15.0 / 336.0))));
    }
    return 2.0 * CORE_RADIUS_M * asin(core_min(0.5 * sqrt(square), 1.0));
}

/* Beyond this the closed form below is off by decimetres and GeographicLib takes over near the edge. */
#define CLOSED_FORM_M 150000.0

/* East and north of a place from the centre by azimuth and length of the geodesic. */
static void exact_offset(const core_cell *cell, const double normal[3], double *east_m, double *north_m) {
    double distance_m;
    double azimuth_deg;
    core_geodesic_inverse(cell->lat_deg, cell->lon_deg, core_normal_lat_deg(normal), core_normal_lon_deg(normal),
                          &distance_m, &azimuth_deg);
    *east_m = distance_m * sin(azimuth_deg * CORE_DEG);
    *north_m = distance_m * cos(azimuth_deg * CORE_DEG);
}

/* The same by the normal section's azimuth and the arc on the sphere of Euler's radius at the middle latitude: within
 * 0.1 m up to 150 km. */
static void closed_offset(const core_cell *cell, const double normal[3], double *east_m, double *north_m) {
    double position[3];
    double e = 0.0;
    double n = 0.0;
    double chord2 = 0.0;
    core_position(normal, 0.0, position);
    for (int i = 0; i < 3; i++) {
        double d = position[i] - cell->position_m[i];
        e += d * cell->east[i];
        n += d * cell->north[i];
        chord2 += d * d;
    }
    double along2 = e * e + n * n;
    if (!(along2 > 1e-12)) {
        *east_m = *north_m = 0.0;
        return;
    }
    double sin_middle = 0.5 * (normal[2] + cell->normal[2]);
    double w = 1.0 - CORE_WGS84_E2 * sin_middle * sin_middle;
    double prime = CORE_WGS84_A_M / sqrt(w);
    double meridian = CORE_WGS84_A_M * (1.0 - CORE_WGS84_E2) / (w * sqrt(w));
    double radius = 1.0 / ((n * n / along2) / meridian + (e * e / along2) / prime);
    double arc = 2.0 * radius * asin(core_min(0.5 * sqrt(chord2) / radius, 1.0));
    double scale = arc / sqrt(along2);
    *east_m = e * scale;
    *north_m = n * scale;
}

static double rectangle_distance(const core_cell *cell, double east_m, double north_m) {
    /* Rotation is clockwise: the rectangle's own axes are turned by it from east and north. */
    double x = fabs(east_m * cell->cos_rotation - north_m * cell->sin_rotation);
    double y = fabs(east_m * cell->sin_rotation + north_m * cell->cos_rotation);
    double qx = x - (cell->half_east_m - cell->corner_m);
    double qy = y - (cell->half_north_m - cell->corner_m);
    double ox = core_max(qx, 0.0);
    double oy = core_max(qy, 0.0);
    return sqrt(ox * ox + oy * oy) + core_min(core_max(qx, qy), 0.0) - cell->corner_m;
}

double core_cell_region_distance_m(const core_cell *cell, const double normal[3], double lat_deg, double lon_deg,
                                   double reach_m) {
    if (cell->polygon) {
        return core_polygon_distance_m(cell->polygon, lat_deg, lon_deg, reach_m);
    }
    double east_m;
    double north_m;
    double centre_m = core_cell_point_distance_m(cell, normal);
    double corner_m = hypot(cell->half_east_m, cell->half_north_m);
    if (centre_m * 0.99 - corner_m > reach_m) {
        return centre_m * 0.99 - corner_m;
    }
    closed_offset(cell, normal, &east_m, &north_m);
    double distance_m = rectangle_distance(cell, east_m, north_m);
    if (centre_m > CLOSED_FORM_M && fabs(distance_m) < reach_m + 1e-3 * centre_m) {
        exact_offset(cell, normal, &east_m, &north_m);
        distance_m = rectangle_distance(cell, east_m, north_m);
    }
    return distance_m;
}
