#include "column.h"

#include "geodesy.h"
#include "state_private.h"

#include <math.h>
#include <string.h>

/* Cells that act together at a place: their weighted sum, the sum of weights, and what they leave of what lies below.
 */
typedef struct share {
    float sum, keep;
} share;

enum { GROUP_VISIBILITY, GROUP_WIND, GROUP_TEMPERATURE, GROUP_THUNDERSTORM, GROUP_PRECIPITATION, GROUP_COUNT };

static const struct {
    uint32_t flags;
    uint32_t first, count;
} groups[GROUP_COUNT] = {
    [GROUP_VISIBILITY] = {VELUM_CELL_HAS_VISIBILITY, CORE_SURFACE_LOG_VISIBILITY, 3},
    [GROUP_WIND] = {VELUM_CELL_HAS_WIND, CORE_SURFACE_WIND_X, 4},
    [GROUP_TEMPERATURE] = {VELUM_CELL_HAS_TEMPERATURE, CORE_SURFACE_TEMPERATURE, 4},
    [GROUP_THUNDERSTORM] = {VELUM_CELL_HAS_LAYERS | VELUM_CELL_HAS_PRECIPITATION, CORE_SURFACE_THUNDERSTORM, 1},
    [GROUP_PRECIPITATION] = {VELUM_CELL_HAS_PRECIPITATION, CORE_SURFACE_PRECIPITATION, 6},
};

typedef struct layer_sum {
    share share;
    uint32_t mask;
    float slot[VELUM_SLOT_COUNT][CORE_FIELD_COUNT];
} layer_sum;

typedef struct mixture {
    layer_sum layers[2]; /* replacing, joining */
    share surface_share[GROUP_COUNT];
    float surface[CORE_SURFACE_COUNT];
} mixture;

static void mixture_begin(mixture *mix, bool with_surface) {
    for (uint32_t i = 0; i < 2; i++) {
        mix->layers[i].share = (share){0.0f, 1.0f};
        mix->layers[i].mask = 0;
    }
    if (with_surface) {
        for (uint32_t g = 0; g < GROUP_COUNT; g++) {
            mix->surface_share[g] = (share){0.0f, 1.0f};
        }
        memset(mix->surface, 0, sizeof mix->surface);
    }
}

static void share_add(share *s, float weight) {
    s->sum += weight;
    s->keep *= 1.0f - weight;
}

static void mixture_add(mixture *mix, const core_cell_fields *fields, const core_cell_slot *slots, float weight,
                        bool with_surface) {
    if (fields->flags & VELUM_CELL_HAS_LAYERS) {
        layer_sum *layers = &mix->layers[fields->flags & VELUM_CELL_MERGE_LAYERS ? 1 : 0];
        share_add(&layers->share, weight);
        for (uint32_t s = 0; s < fields->slot_count; s++) {
            float *to = layers->slot[slots[s].slot];
            const float *from = slots[s].field;
            uint32_t bit = 1u << slots[s].slot;
            if (layers->mask & bit) {
                for (uint32_t f = 0; f < CORE_FIELD_COUNT; f++) {
                    to[f] += weight * from[f];
                }
            } else {
                for (uint32_t f = 0; f < CORE_FIELD_COUNT; f++) {
                    to[f] = weight * from[f];
                }
                layers->mask |= bit;
            }
        }
    }
    for (uint32_t g = 0; with_surface && g < GROUP_COUNT; g++) {
        if (fields->flags & groups[g].flags) {
            share_add(&mix->surface_share[g], weight);
            for (uint32_t f = groups[g].first; f < groups[g].first + groups[g].count; f++) {
                mix->surface[f] += weight * fields->surface[f];
            }
        }
    }
}

static void replace_layers(core_blend *blend, const layer_sum *from, float weight) {
    float keep = 1.0f - weight;
    float scale = weight / from->share.sum;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        uint32_t bit = 1u << slot;
        float *to = blend->slot[slot];
        if (!((blend->mask | from->mask) & bit)) {
            continue;
        }
        if (!(blend->mask & bit) || keep <= 0.0f) {
            memset(to, 0, sizeof blend->slot[slot]);
        }
        for (uint32_t f = 0; f < CORE_FIELD_COUNT; f++) {
            to[f] = to[f] * keep + (from->mask & bit ? from->slot[slot][f] * scale : 0.0f);
        }
        blend->mask |= bit;
    }
    if (keep <= 0.0f) {
        blend->mask = from->mask;
    }
}

/* Layers that meet in a slot overlap at random; what they hold mixes by their coverage. */
static void join_layers(core_blend *blend, const layer_sum *from, float weight) {
    float scale = weight / from->share.sum;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        uint32_t bit = 1u << slot;
        float *to = blend->slot[slot];
        if (!(from->mask & bit)) {
            continue;
        }
        if (!(blend->mask & bit)) {
            memset(to, 0, sizeof blend->slot[slot]);
            blend->mask |= bit;
        }
        float c1 = to[CORE_FIELD_COVERAGE];
        float c2 = from->slot[slot][CORE_FIELD_COVERAGE] * scale;
        float sum = c1 + c2;
        if (!(sum > 0.0f)) {
            continue;
        }
        float rest = (sum - c1 * c2) / sum;
        for (uint32_t f = 0; f < CORE_FIELD_COUNT; f++) {
            to[f] = (to[f] + from->slot[slot][f] * scale) * rest;
        }
    }
}

/* `sums`: the weights are shares of one whole (nodes of a grid, of which `outer` counts); otherwise each acts by itself
 * and together they leave the product of what each leaves. */
static void mixture_apply(core_blend *blend, const mixture *mix, bool sums, float outer, bool with_surface) {
    for (uint32_t i = 0; i < 2; i++) {
        const layer_sum *layers = &mix->layers[i];
        if (layers->share.sum > 0.0f) {
            float weight = sums ? fminf(layers->share.sum, 1.0f) * outer : 1.0f - layers->share.keep;
            if (sums && layers->share.sum > 1.0f - 1e-5f) {
                weight = outer;
            }
            (i == 0 ? replace_layers : join_layers)(blend, layers, weight);
        }
    }
    for (uint32_t g = 0; with_surface && g < GROUP_COUNT; g++) {
        share s = mix->surface_share[g];
        if (s.sum > 0.0f) {
            float weight = sums ? fminf(s.sum, 1.0f) * outer : 1.0f - s.keep;
            for (uint32_t f = groups[g].first; f < groups[g].first + groups[g].count; f++) {
                blend->surface[f] = blend->surface[f] * (1.0f - weight) + mix->surface[f] * (weight / s.sum);
            }
        }
    }
}

static double smooth(double low, double high, double x) {
    double t = (x - low) / (high - low);
    t = t > 0.0 ? (t < 1.0 ? t : 1.0) : 0.0;
    return t * t * (3.0 - 2.0 * t);
}

/* What is left at the very edge of a sheet's thickness; and of what a storm's anvil has over its base. */
#define EDGE_THICKNESS_M 200.0f
#define EDGE_STORM_SHARE 0.9f
/* Below this fullness storms end (it is less, too, where one of 0.3 of coverage gives way to one of all): towers down
 * to EDGE_TOWER_FULL, anvils, which cover as much as ever, to EDGE_ANVIL_FULL. */
#define EDGE_STORM_FULL 0.7f
#define EDGE_TOWER_FULL 0.35f
#define EDGE_ANVIL_FULL 0.4f
/* Sheets thin out towards it by a power of fullness, between these two. */
#define EDGE_FULL 0.9f
#define EDGE_LEAST_FULL 0.1f
#define EDGE_THINS_POWER 4.0f

float core_blend_fullness(const float *field) {
    float c = field[CORE_FIELD_COVERAGE];
    return field[CORE_FIELD_FULL] > c * c ? c * c / field[CORE_FIELD_FULL] : 1.0f;
}

/* Others end as sheets do, or not at all. */
static float storm_fullness(uint32_t slot, const float *field) {
    return slot == VELUM_SLOT_STORM ? core_blend_fullness(field) : 1.0f;
}

/* Of a storm, how much of it has towers. */
static float tower_share(uint32_t slot, const float *field) {
    float full = storm_fullness(slot, field);
    return velum_clamp((full - EDGE_TOWER_FULL) / (EDGE_STORM_FULL - EDGE_TOWER_FULL), 0.0f, 1.0f);
}

float core_blend_coverage(uint32_t slot, const float *field) {
    float full = storm_fullness(slot, field);
    return field[CORE_FIELD_COVERAGE] * EDGE_STORM_FULL / velum_clamp(full, EDGE_ANVIL_FULL, EDGE_STORM_FULL);
}

float core_blend_top(uint32_t slot, const float *field) {
    float full = core_blend_fullness(field);
    if (slot >= VELUM_SLOT_UNIFORM || full > 1.0f - 1e-5f) {
        return field[CORE_FIELD_TOP];
    }
    float thickness = field[CORE_FIELD_TOP] - field[CORE_FIELD_BASE];
    if (slot == VELUM_SLOT_STORM) {
        float anvil = fminf(full / EDGE_ANVIL_FULL, 1.0f);
        return field[CORE_FIELD_BASE] + thickness * velum_mix(EDGE_STORM_SHARE, 1.0f, anvil);
    }
    float edge = fminf(thickness, EDGE_THICKNESS_M * field[CORE_FIELD_COVERAGE]);
    return field[CORE_FIELD_BASE] + edge + (thickness - edge) * full * full;
}

float core_blend_kind(uint32_t slot, const float *field) {
    return field[CORE_FIELD_KIND] * tower_share(slot, field);
}

float core_blend_scud(uint32_t slot, const float *field) {
    return field[CORE_FIELD_SCUD] * tower_share(slot, field);
}

/* The fourth root of the rate: it rains from the heart. */
float core_blend_fall(uint32_t slot, const float *field) {
    float towers = tower_share(slot, field);
    return field[CORE_FIELD_FALL] * towers * towers;
}

/* Of sheets and veils; heaps, cells, rolls and grains stay as dense as they are. */
static float sheet_share(uint32_t slot, float kind) {
    switch (slot) {
    case VELUM_SLOT_LOW:
    case VELUM_SLOT_LOW_2: return 1.0f - kind;
    case VELUM_SLOT_MIDDLE:
    case VELUM_SLOT_HIGH: return velum_clamp(2.0f - 2.0f * kind, 0.0f, 1.0f);
    default: return 0.0f;
    }
}

float core_blend_log_extinction(uint32_t slot, const float *field) {
    float full = fmaxf(core_blend_fullness(field), EDGE_LEAST_FULL);
    float c = field[CORE_FIELD_COVERAGE];
    float sheet = full < EDGE_FULL && c > 0.0f ? sheet_share(slot, field[CORE_FIELD_KIND] / c) : 0.0f;
    return field[CORE_FIELD_LOG_EXTINCTION] + c * sheet * EDGE_THINS_POWER * logf(fminf(full / EDGE_FULL, 1.0f));
}

/* A sharp edge is a ramp of 2 texels, centred on it; a transition lies outside the edge. */
static bool is_sharp(const core_cell *cell, double texel_m) {
    return 0.5 * cell->transition_m <= core_min(CORE_EDGE_TEXELS * texel_m, cell->breadth_m);
}

/* At a sharp edge nothing thins out: fullness goes over to 1 along the ramp. */
static void keep_full(core_blend *blend, const core_blend *before, float weight) {
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (blend->mask & (1u << slot)) {
            float *to = blend->slot[slot];
            float full = before->mask & (1u << slot) ? core_blend_fullness(before->slot[slot]) : 1.0f;
            to[CORE_FIELD_FULL] = to[CORE_FIELD_COVERAGE] * to[CORE_FIELD_COVERAGE] / velum_mix(full, 1.0f, weight);
        }
    }
}

static float region_weight(const core_cell *cell, const double normal[3], double lat_deg, double lon_deg,
                           double texel_m) {
    double ramp_m = core_min(CORE_EDGE_TEXELS * texel_m, cell->breadth_m);
    double middle_m = 0.5 * cell->transition_m;
    double half_m = core_max(core_max(middle_m, ramp_m), 1e-3);
    double distance_m = core_cell_region_distance_m(cell, normal, lat_deg, lon_deg, middle_m + half_m);
    if (middle_m > ramp_m) {
        return (float)(1.0 - smooth(middle_m - half_m, middle_m + half_m, distance_m));
    }
    return (float)core_min(core_max(0.5 - 0.5 * (distance_m - middle_m) / half_m, 0.0), 1.0);
}

static float station_weight(const core_cell *cell, const double normal[3]) {
    return (float)(1.0 - smooth(0.5 * cell->radius_m, cell->radius_m, core_cell_point_distance_m(cell, normal)));
}

static void add_globals(const core_state *state, const double normal[3], double lat_deg, bool with_surface,
                        core_blend *blend) {
    double east[3];
    double north[3];
    /* East and north have no meaning at a pole: the wind fades out over the last degree. */
    float fade = (float)smooth(0.0, CORE_POLE_FADE_DEG, 90.0 - fabs(lat_deg));
    core_east_north(normal, east, north);
    for (uint32_t i = 0; i < state->first_station; i++) {
        const core_cell *cell = state->cells[i];
        core_cell_slot slots[VELUM_SLOT_COUNT];
        core_cell_fields fields = cell->fields;
        mixture mix;
        memcpy(slots, cell->slots, sizeof slots);
        for (uint32_t s = 0; s <= cell->slot_count; s++) {
            float *wind =
                s < cell->slot_count ? &slots[s].field[CORE_FIELD_WIND_X] : &fields.surface[CORE_SURFACE_WIND_X];
            float u = wind[0] * fade;
            float v = wind[1] * fade;
            for (uint32_t axis = 0; axis < 3; axis++) {
                wind[axis] = u * (float)east[axis] + v * (float)north[axis];
            }
        }
        mixture_begin(&mix, with_surface);
        mixture_add(&mix, &fields, slots, 1.0f, with_surface);
        mixture_apply(blend, &mix, false, 1.0f, with_surface);
    }
}

static void add_grid(const core_state *state, double lat_deg, double lon_deg, double texel_m, bool with_surface,
                     core_blend *blend) {
    const core_grid *grid = state->grid;
    double border_m = core_grid_border_m(grid, lat_deg, lon_deg);
    float outer = (float)core_min(core_max(0.5 - 0.5 * border_m / (CORE_EDGE_TEXELS * texel_m), 0.0), 1.0);
    mixture mix;
    if (outer <= 0.0f) {
        return;
    }
    core_grid_place place = core_grid_at(grid, lat_deg, lon_deg);
    mixture_begin(&mix, with_surface);
    for (uint32_t i = 0; i < 4; i++) {
        if (place.weight[i] > 0.0f) {
            const core_cell_fields *node = &grid->nodes[place.node[i]];
            mixture_add(&mix, node, &grid->slots[node->first_slot], place.weight[i], with_surface);
        }
    }
    mixture_apply(blend, &mix, true, outer, with_surface);
}

static void add_stations(const core_state *state, const double normal[3], uint32_t bin, bool with_surface,
                         core_blend *blend) {
    const float n[3] = {(float)normal[0], (float)normal[1], (float)normal[2]};
    uint32_t at = state->stations.start[bin];
    uint32_t end = state->stations.start[bin + 1];
    while (at < end) {
        int32_t priority = state->station_points[at].priority;
        bool any = false;
        mixture mix;
        for (; at < end && state->station_points[at].priority == priority; at++) {
            const core_station_point *point = &state->station_points[at];
            float dx = point->normal[0] - n[0];
            float dy = point->normal[1] - n[1];
            float dz = point->normal[2] - n[2];
            if (dx * dx + dy * dy + dz * dz > point->chord2) {
                continue;
            }
            const core_cell *cell = state->cells[state->stations.items[at]];
            float weight = station_weight(cell, normal);
            if (weight > 0.0f) {
                if (!any) {
                    mixture_begin(&mix, with_surface);
                    any = true;
                }
                mixture_add(&mix, &cell->fields, cell->slots, weight, with_surface);
            }
        }
        if (any) {
            mixture_apply(blend, &mix, false, 1.0f, with_surface);
        }
    }
}

void core_blend_region(const core_cell *cell, const double normal[3], double lat_deg, double lon_deg, double texel_m,
                       bool with_surface, core_blend *blend) {
    float weight = region_weight(cell, normal, lat_deg, lon_deg, texel_m);
    if (weight > 0.0f) {
        mixture mix;
        core_blend before;
        bool sharp = weight < 1.0f && is_sharp(cell, texel_m);
        if (sharp) {
            before = *blend;
        }
        mixture_begin(&mix, with_surface);
        mixture_add(&mix, &cell->fields, cell->slots, weight, with_surface);
        mixture_apply(blend, &mix, false, 1.0f, with_surface);
        if (sharp) {
            keep_full(blend, &before, weight);
        }
    }
}

void core_blend_base_at(const core_state *state, const double normal[3], double lat_deg, double lon_deg, double texel_m,
                        bool with_surface, core_blend *out) {
    out->mask = 0;
    if (with_surface) {
        memset(out->surface, 0, sizeof out->surface);
        out->surface[CORE_SURFACE_LOG_VISIBILITY] = logf(CORE_VISIBILITY_DEFAULT_M);
    }
    add_globals(state, normal, lat_deg, with_surface, out);
    if (state->grid) {
        add_grid(state, lat_deg, lon_deg, texel_m, with_surface, out);
    }
    add_stations(state, normal, core_index_bin(lat_deg, lon_deg), with_surface, out);
}

void core_blend_at(const core_state *state, const double normal[3], double texel_m, bool with_surface,
                   core_blend *out) {
    double lat_deg = core_normal_lat_deg(normal);
    double lon_deg = core_normal_lon_deg(normal);
    uint32_t bin = core_index_bin(lat_deg, lon_deg);
    core_blend_base_at(state, normal, lat_deg, lon_deg, texel_m, with_surface, out);
    for (uint32_t at = state->regions.start[bin]; at < state->regions.start[bin + 1]; at++) {
        core_blend_region(state->cells[state->regions.items[at]], normal, lat_deg, lon_deg, texel_m, with_surface, out);
    }
}

static void set_tangent(const double normal[3], const float wind[3], float scale, float out[3]) {
    float up = 0.0f;
    for (uint32_t i = 0; i < 3; i++) {
        up += wind[i] * (float)normal[i];
    }
    for (uint32_t i = 0; i < 3; i++) {
        out[i] = (wind[i] - up * (float)normal[i]) * scale;
    }
}

static void set_layers(const core_state *state, const double normal[3], const core_blend *blend, core_column *out) {
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        const float *f = blend->slot[slot];
        if (!(blend->mask & (1u << slot)) || !(f[CORE_FIELD_COVERAGE] > 0.0f)) {
            continue;
        }
        float scale = 1.0f / f[CORE_FIELD_COVERAGE];
        float wind[3];
        set_tangent(normal, &f[CORE_FIELD_WIND_X], scale, wind);
        out->mask |= 1u << slot;
        out->slot[slot] = (velum_slot_fields){
            .coverage = fminf(core_blend_coverage(slot, f), 1.0f),
            .base_m = f[CORE_FIELD_BASE] * scale + state->undulation_m,
            .top_m = core_blend_top(slot, f) * scale + state->undulation_m,
            .extinction_1_m = expf(core_blend_log_extinction(slot, f) * scale),
            .wind_x_m_s = wind[0],
            .wind_y_m_s = wind[1],
            .wind_z_m_s = wind[2],
            .kind = core_blend_kind(slot, f) * scale,
        };
    }
}

static void set_surface(const core_state *state, const double normal[3], const float *s, core_surface *out) {
    float wind[3];
    float most = 0.0f;
    set_tangent(normal, &s[CORE_SURFACE_WIND_X], 1.0f, wind);
    *out = (core_surface){
        .visibility_m = expf(s[CORE_SURFACE_LOG_VISIBILITY]),
        .fog_top_m = s[CORE_SURFACE_FOG_TOP] + state->undulation_m,
        .elevation_m = s[CORE_SURFACE_ELEVATION] + state->undulation_m,
        .wind_x_m_s = wind[0],
        .wind_y_m_s = wind[1],
        .wind_z_m_s = wind[2],
        .gust_m_s = s[CORE_SURFACE_GUST],
        .thunderstorm = s[CORE_SURFACE_THUNDERSTORM],
    };
    if (s[CORE_SURFACE_TEMPERATURE_KNOWN] > 0.0f) {
        out->temperature_k = s[CORE_SURFACE_TEMPERATURE] / s[CORE_SURFACE_TEMPERATURE_KNOWN];
    }
    if (s[CORE_SURFACE_DEW_POINT_KNOWN] > 0.0f) {
        out->dew_point_k = s[CORE_SURFACE_DEW_POINT] / s[CORE_SURFACE_DEW_POINT_KNOWN];
    }
    for (int32_t kind = VELUM_PRECIPITATION_RAIN; kind <= VELUM_PRECIPITATION_SLEET; kind++) {
        float rate_mm_h = s[CORE_SURFACE_PRECIPITATION + kind];
        out->precipitation_mm_h += rate_mm_h;
        if (rate_mm_h > most) {
            most = rate_mm_h;
            out->precipitation = kind;
        }
    }
}

static void column(const core_state *state, const double normal[3], double texel_m, bool with_surface,
                   core_column *out) {
    core_blend blend;
    memset(out, 0, sizeof *out);
    core_blend_at(state, normal, texel_m, with_surface, &blend);
    set_layers(state, normal, &blend, out);
    if (with_surface) {
        set_surface(state, normal, blend.surface, &out->surface);
    }
}

void core_column_at(const core_state *state, const double normal[3], double texel_m, core_column *out) {
    column(state, normal, texel_m, true, out);
}

void core_column_layers(const core_state *state, const double normal[3], double texel_m, core_column *out) {
    column(state, normal, texel_m, false, out);
}
