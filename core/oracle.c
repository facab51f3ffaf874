#include "oracle.h"

#include <math.h>
#include <string.h>

#include "geodesy.h"
#include "oracle_cursor.h"
#include "shared/air.h"
#include "slots.h"

/* -ln 0.05: extinction times meteorological optical range (5 % contrast; WMO-No. 8, 9.1.1). */
#define MOR_FACTOR 2.995732f
#define FOG_VISIBILITY_M 20000.0f

/* Usual effective radii, where the cell's own is no longer known. */
#define LIQUID_RADIUS_M 10.0e-6f
#define ICE_RADIUS_M 40.0e-6f

static bool is_usable(const double ecef_m[3]) {
    double square = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        if (!isfinite(ecef_m[axis]) || fabs(ecef_m[axis]) > 1e15) {
            return false;
        }
        square += ecef_m[axis] * ecef_m[axis];
    }
    return square > 6.0e6 * 6.0e6;
}

static velum_result check_place(const double ecef_m[3], double footprint_m, core_error *error) {
    if (!is_usable(ecef_m)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT,
                         "position: found %g, %g, %g, expected finite ECEF metres, 6000 km from the centre or more",
                         ecef_m[0], ecef_m[1], ecef_m[2]);
    }
    if (!(footprint_m >= 0.0) || !isfinite(footprint_m)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "footprint_m: found %g, expected 0 or more", footprint_m);
    }
    return VELUM_OK;
}

static velum_result finish(oracle_cursor *cursor, core_error *error) {
    velum_result result = cursor->result;
    oracle_cursor_finish(cursor);
    return result == VELUM_OK ? result : core_fail(error, result, "no memory for tiles");
}

velum_result core_oracle_extinction(const core_oracle *oracle, const double ecef_m[3], double footprint_m,
                                    float *extinction_1_m, core_error *error) {
    *extinction_1_m = 0.0f;
    velum_result result = check_place(ecef_m, footprint_m, error);
    if (result != VELUM_OK) {
        return result;
    }
    oracle_cursor cursor;
    oracle_cursor_init(&cursor, oracle, footprint_m);
    oracle_place place = oracle_cursor_move(&cursor, ecef_m);
    *extinction_1_m = oracle_cursor_total(&cursor, &place);
    return finish(&cursor, error);
}

/* ---------------------------------------------------------------- all about a point */

static core_surface surface_at(const core_oracle *oracle, const double normal[3], double texel_m) {
    core_surface surface[2] = {{.visibility_m = CORE_VISIBILITY_DEFAULT_M},
                               {.visibility_m = CORE_VISIBILITY_DEFAULT_M}};
    for (int s = 0; s < 2; s++) {
        if (oracle->state[s]) {
            core_column column;
            core_column_at(oracle->state[s], normal, texel_m, &column);
            surface[s] = column.surface;
        }
    }
    const core_surface *a = &surface[0];
    const core_surface *b = &surface[1];
    const float t = velum_clamp(oracle->blend, 0.0f, 1.0f);
    core_surface mixed = t < 0.5f ? *a : *b;
    mixed.visibility_m = 1.0f / velum_mix(1.0f / fmaxf(a->visibility_m, 1.0f), 1.0f / fmaxf(b->visibility_m, 1.0f), t);
    mixed.fog_top_m = velum_mix(a->fog_top_m, b->fog_top_m, t);
    mixed.elevation_m = velum_mix(a->elevation_m, b->elevation_m, t);
    mixed.wind_x_m_s = velum_mix(a->wind_x_m_s, b->wind_x_m_s, t);
    mixed.wind_y_m_s = velum_mix(a->wind_y_m_s, b->wind_y_m_s, t);
    mixed.wind_z_m_s = velum_mix(a->wind_z_m_s, b->wind_z_m_s, t);
    mixed.precipitation_mm_h = velum_mix(a->precipitation_mm_h, b->precipitation_mm_h, t);
    if (a->precipitation_mm_h * (1.0f - t) >= b->precipitation_mm_h * t && a->precipitation_mm_h > 0.0f) {
        mixed.precipitation = a->precipitation;
    } else if (b->precipitation_mm_h > 0.0f) {
        mixed.precipitation = b->precipitation;
    }
    if (a->temperature_k > 0.0f && b->temperature_k > 0.0f) {
        mixed.temperature_k = velum_mix(a->temperature_k, b->temperature_k, t);
    }
    return mixed;
}

static float clear_air_1_m(float height_m) {
    return VELUM_RAYLEIGH_G * velum_rayleigh_density(height_m) +
           VELUM_AEROSOL_EXTINCTION * velum_aerosol_density(height_m);
}

/* The surface's visibility: with fog up to its top; as haze it thins out like the aerosol. */
static float air_extinction_1_m(const core_surface *surface, float height_m) {
    float added = fmaxf(MOR_FACTOR / surface->visibility_m - clear_air_1_m(surface->elevation_m), 0.0f);
    float share = surface->visibility_m < FOG_VISIBILITY_M
                      ? velum_fog_density(height_m, surface->fog_top_m)
                      : velum_aerosol_density(height_m) / velum_aerosol_density(surface->elevation_m);
    return clear_air_1_m(height_m) + added * fminf(share, 1.0f);
}

/* Between the surface and the layers, each known at its middle, wind is interpolated over height. */
typedef struct wind_knots {
    uint32_t count;
    float height_m[VELUM_SLOT_COUNT + 1];
    float wind_m_s[VELUM_SLOT_COUNT + 1][3];
} wind_knots;

static void add_wind(wind_knots *knots, float height_m, float x, float y, float z) {
    uint32_t i = knots->count++;
    for (; i > 0 && knots->height_m[i - 1] > height_m; i--) {
        knots->height_m[i] = knots->height_m[i - 1];
        memcpy(knots->wind_m_s[i], knots->wind_m_s[i - 1], sizeof knots->wind_m_s[i]);
    }
    knots->height_m[i] = height_m;
    knots->wind_m_s[i][0] = x;
    knots->wind_m_s[i][1] = y;
    knots->wind_m_s[i][2] = z;
}

static void wind_at(const wind_knots *knots, float height_m, float wind_m_s[3]) {
    uint32_t above = 0;
    while (above < knots->count && knots->height_m[above] <= height_m) {
        above++;
    }
    uint32_t low = above > 0 ? above - 1 : 0;
    uint32_t high = above < knots->count ? above : knots->count - 1;
    float span_m = knots->height_m[high] - knots->height_m[low];
    float t = span_m > 0.0f ? velum_clamp((height_m - knots->height_m[low]) / span_m, 0.0f, 1.0f) : 0.0f;
    for (int axis = 0; axis < 3; axis++) {
        wind_m_s[axis] = velum_mix(knots->wind_m_s[low][axis], knots->wind_m_s[high][axis], t);
    }
}

static float water_per_extinction(uint32_t slot) {
    return slot == VELUM_SLOT_HIGH ? CORE_ICE_DENSITY_KG_M3 * 1000.0f * ICE_RADIUS_M * (2.0f / 3.0f)
                                   : CORE_WATER_DENSITY_KG_M3 * 1000.0f * LIQUID_RADIUS_M * (2.0f / 3.0f);
}

static void gather_layers(oracle_cursor *cursor, const oracle_place *place, wind_knots *winds, core_oracle_point *out) {
    const float height_m = (float)place->height_m;
    float lowest_m = INFINITY;
    float most = 0.0f;
    float ceiling_m = -INFINITY;
    const uint32_t mask = oracle_cursor_mask(cursor);
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (!(mask & (1u << slot))) {
            continue;
        }
        velum_slot_fields f = oracle_cursor_fields(cursor, place, slot);
        if (f.coverage <= 0.0f) {
            continue;
        }
        const oracle_extinction of = oracle_cursor_slot(cursor, place, slot);
        const float extinction = of.cloud_1_m + of.fringe_1_m;
        out->slot_extinction_1_m[slot] = extinction;
        out->extinction_1_m += extinction;
        out->water_g_m3 += of.cloud_1_m * water_per_extinction(slot);
        out->coverage = fmaxf(out->coverage, f.coverage);
        ceiling_m = fmaxf(ceiling_m, f.top_m);
        if (slot < VELUM_SLOT_UNIFORM) {
            add_wind(winds, 0.5f * (f.base_m + f.top_m), f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
        }
        if (f.base_m < lowest_m) {
            lowest_m = f.base_m;
            out->base_m = f.base_m;
            out->top_m = f.top_m;
            if (most <= 0.0f) {
                out->genus = core_genus_of_slot(slot, f.kind);
            }
        }
        if (extinction > most) {
            most = extinction;
            out->genus = core_genus_of_slot(slot, f.kind);
        }
    }
    if (!(height_m <= ceiling_m)) {
        out->precipitation_mm_h = 0.0f;
        out->precipitation = VELUM_PRECIPITATION_NONE;
    }
}

velum_result core_oracle_at(const core_oracle *oracle, const double ecef_m[3], double footprint_m,
                            core_oracle_point *out, core_error *error) {
    memset(out, 0, sizeof *out);
    velum_result result = check_place(ecef_m, footprint_m, error);
    if (result != VELUM_OK) {
        return result;
    }
    if (!core_geodetic_from_ecef(ecef_m, &out->place)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "position: has no latitude and longitude");
    }
    oracle_cursor cursor;
    oracle_cursor_init(&cursor, oracle, footprint_m);
    oracle_place place = oracle_cursor_move(&cursor, ecef_m);
    core_surface surface = surface_at(oracle, place.normal, core_tile_texel_m(cursor.level));
    out->precipitation_mm_h = surface.precipitation_mm_h;
    out->precipitation = surface.precipitation_mm_h > 0.0f ? surface.precipitation : VELUM_PRECIPITATION_NONE;
    out->temperature_k = surface.temperature_k;
    wind_knots winds = {0};
    add_wind(&winds, surface.elevation_m + 10.0f, surface.wind_x_m_s, surface.wind_y_m_s, surface.wind_z_m_s);
    gather_layers(&cursor, &place, &winds, out);
    wind_at(&winds, (float)place.height_m, out->wind_ecef_m_s);
    out->visibility_m = MOR_FACTOR / (air_extinction_1_m(&surface, (float)place.height_m) + out->extinction_1_m);
    if (out->base_m != 0.0f || out->top_m != 0.0f) {
        const core_state *state = oracle->state[0] ? oracle->state[0] : oracle->state[1];
        float undulation_m = core_state_undulation_m(state);
        out->base_m -= undulation_m;
        out->top_m -= undulation_m;
    }
    return finish(&cursor, error);
}
