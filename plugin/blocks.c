#include "blocks.h"

#include <math.h>
#include <string.h>

#include "core/column.h"
#include "core/noise_place.h"
#include "shades.h"
#include "shared/air.h"
#include "shared/fringe.h"
#include "shared/sample.h"

/* Below this the visibility is fog's, with a top; above it haze's. */
#define FOG_VISIBILITY_M 20000.0f
/* -ln 0.05: extinction times meteorological optical range (5 % contrast; WMO-No. 8, 9.1.1). */
#define MOR_FACTOR 2.995732f

static void fill_drift(const core_drift *d, velum_eye_block *out) {
    out->weather[2] = d->tau_s[0];
    out->weather[3] = d->tau_s[1];
    out->drift[0] = d->weight[1];
}

static void fill_surface(const engine *e, const double normal[3], velum_eye_block *out) {
    core_surface surface[2] = {{.visibility_m = CORE_VISIBILITY_DEFAULT_M},
                               {.visibility_m = CORE_VISIBILITY_DEFAULT_M}};
    float t = e->weather.blend;
    const float weight[2] = {1.0f - t, t};
    float albedo = (out->ground[0] + out->ground[1] + out->ground[2]) / 3.0f;
    float mu_sun = (float)dot3(normal, e->frame.sun_direction_ecef);
    for (uint32_t s = 0; s < 2; s++) {
        core_column column = {0};
        if (e->weather.state[s]) {
            core_column_at(e->weather.state[s], normal, 1000.0, &column);
            surface[s] = column.surface;
        }
        shades_add(&column, mu_sun, albedo, weight[s], out->shades);
    }
    float elevation_m = velum_mix(surface[0].elevation_m, surface[1].elevation_m, t);
    out->span[2] = elevation_m;
    if (e->frame.atmosphere == VELUM_ATMOSPHERE_NONE) {
        return;
    }
    float mor = velum_mix(1.0f / fmaxf(surface[0].visibility_m, 1.0f), 1.0f / fmaxf(surface[1].visibility_m, 1.0f), t);
    float clean = VELUM_RAYLEIGH_G * velum_rayleigh_density(elevation_m) +
                  VELUM_AEROSOL_EXTINCTION * velum_aerosol_density(elevation_m);
    float added = fmaxf(MOR_FACTOR * mor - clean, 0.0f);
    bool fog = mor > 1.0f / FOG_VISIBILITY_M;
    out->drift[1] = fog ? added : 0.0f;
    out->drift[2] = velum_mix(surface[0].fog_top_m, surface[1].fog_top_m, t);
    out->drift[3] = fog ? 0.0f : added;
}

static void fill_part(uint32_t part, velum_span_m span, float most_1_m, velum_eye_block *out) {
    float *bounds = out->fringes[part - VELUM_PART_HEM];
    if (out->table[3] & (1u << part)) {
        bounds[0] = span.low;
        bounds[1] = span.high;
        bounds[2] = most_1_m;
        out->span[0] = fminf(out->span[0], span.low);
        out->span[1] = fmaxf(out->span[1], span.high);
    }
}

static void fill_bounds(const tiles *t, uint32_t mask, velum_eye_block *out) {
    out->span[0] = 0.0f;
    out->span[1] = 0.0f;
    bool first = true;
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        float *bounds = out->slots[slot].bounds;
        bounds[2] = velum_noise_of((int)slot).stretch;
        if (mask & (1u << slot)) {
            bounds[0] = t->base_m[slot];
            bounds[1] = t->top_m[slot];
            out->span[0] = first ? bounds[0] : fminf(out->span[0], bounds[0]);
            out->span[1] = first ? bounds[1] : fmaxf(out->span[1], bounds[1]);
            first = false;
        }
        fill_part(VELUM_PART_HEM + slot, t->hem_m[slot], t->most_scud_1_m[slot] + t->most_band_1_m[slot], out);
        fill_part(VELUM_PART_FALL + slot, t->fall_m[slot], t->most_fall_1_m[slot], out);
    }
}

core_uniform_phase blocks_uniform_phase(const engine *e, uint32_t slot) {
    core_uniform_phase phase = {.albedo = 1.0f};
    if (e->weather.state[0]) {
        phase = core_state_uniform_phase(e->weather.state[0], slot);
    }
    phase.hg_asymmetry = phase.has_hg ? phase.hg_asymmetry : 0.85f;
    return phase;
}

static void fill_optics(const engine *e, velum_eye_block *out) {
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        float *optics = out->slots[slot].optics;
        optics[0] = 1.0f;
        optics[3] = velum_noise_of((int)slot).fine_stretch;
        if (slot >= VELUM_SLOT_UNIFORM) {
            core_uniform_phase phase = blocks_uniform_phase(e, slot);
            optics[0] = phase.albedo;
            optics[1] = phase.hg_asymmetry;
            const velum_phase_lobes lobes = velum_phase_lobes_make(phase.hg_asymmetry, 0.0f, 0.0f, 0.0f);
            optics[2] = 1.0f - phase.albedo * velum_scattering_peak(lobes);
        }
    }
}

static velum_slot_fields fields_of_look(const core_look *look) {
    return (velum_slot_fields){.coverage = look->value[CORE_LOOK_COVERAGE],
                               .top_m = look->value[CORE_LOOK_THICKNESS],
                               .extinction_1_m = look->value[CORE_LOOK_EXTINCTION],
                               .wind_x_m_s = look->value[CORE_LOOK_WIND],
                               .kind = look->value[CORE_LOOK_KIND]};
}

static void fill_profile(const tiles *t, uint32_t slot, float blend, velum_slot_block *out) {
    const velum_profile profile = velum_profile_of(
        (int)slot, velum_fields_mix(fields_of_look(&t->look[0][slot]), fields_of_look(&t->look[1][slot]), blend));
    float values[4][4] = {0};
    _Static_assert(sizeof profile <= sizeof values, "four vectors of it");
    memcpy(values, &profile, sizeof profile);
    memcpy(out->profile_0, values[0], sizeof out->profile_0);
    memcpy(out->profile_1, values[1], sizeof out->profile_1);
    memcpy(out->profile_2, values[2], sizeof out->profile_2);
    memcpy(out->profile_3, values[3], sizeof out->profile_3);
}

static void fill_phases(const core_drift *drift, uint32_t slot, const double position[3], velum_slot_block *out) {
    core_slot_phases p;
    core_slot_phases_at(slot, position, drift, &p);
    memcpy(out->shape_0, p.shape[0], sizeof out->shape_0);
    memcpy(out->shape_1, p.shape[1], sizeof out->shape_1);
    memcpy(out->lump_0, p.lump[0], sizeof out->lump_0);
    memcpy(out->lump_1, p.lump[1], sizeof out->lump_1);
    memcpy(out->fine_0, p.fine[0], sizeof out->fine_0);
    memcpy(out->fine_1, p.fine[1], sizeof out->fine_1);
}

bool blocks_mix(const engine *e) {
    return e->weather.state[0] != e->weather.state[1] || (e->drift.weight[0] > 0.0f && e->drift.weight[1] > 0.0f);
}

bool blocks_fill_eye(const engine *e, const tiles *t, const double position_ecef_m[3], const velum_plan *plan,
                     velum_eye_block *out) {
    memset(out, 0, sizeof *out);
    velum_eye_geometry g;
    core_geodetic place;
    if (!core_eye_geometry(position_ecef_m, &g) || !core_geodetic_from_ecef(position_ecef_m, &place)) {
        return false;
    }
    double normal[3];
    core_normal(place.lat_deg, place.lon_deg, normal);
    const float scaled[4] = {g.scaled_x, g.scaled_y, g.scaled_z, g.scaled_m};
    const float position[4] = {g.x_m, g.y_m, g.z_m, g.power_m2};
    const float up[4] = {(float)normal[0], (float)normal[1], (float)normal[2], (float)place.height_m};
    memcpy(out->scaled, scaled, sizeof scaled);
    memcpy(out->position, position, sizeof position);
    memcpy(out->up, up, sizeof up);

    uint32_t mask = t->mask & (plan ? plan->active_layers : UINT32_MAX);
    out->table[0] = t->first_chunk * (TABLE_CHUNK_BYTES / 4);
    out->table[1] = t->entries - 1;
    out->table[2] = mask;
    out->table[3] = t->fringes & (mask << VELUM_PART_HEM | mask << VELUM_PART_FALL);
    out->weather[0] = WORLD_TILE_DETAIL;
    out->weather[1] = e->weather.blend;

    const velum_frame_info *f = &e->frame;
    for (int i = 0; i < 3; i++) {
        out->sun[i] = (float)f->sun_direction_ecef[i];
        out->sun_lx[i] = f->sun_illuminance_lx[i];
        out->ground[i] = f->ground_albedo[i];
    }
    out->sun[3] = cosf(f->sun_angular_radius_rad);
    out->sun_lx[3] = f->sun_angular_radius_rad;
    out->ground[3] = f->atmosphere == VELUM_ATMOSPHERE_EARTH ? 1.0f : 0.0f;
    out->span[3] = plan ? plan->distance_m : t->has_set ? (float)t->set.distance_m : 0.0f;
    fill_drift(&e->drift, out);
    fill_surface(e, normal, out);
    fill_bounds(t, mask, out);
    fill_optics(e, out);
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        fill_phases(&e->drift, slot, position_ecef_m, &out->slots[slot]);
        if (!t->uneven && mask >> slot & 1u) {
            fill_profile(t, slot, e->weather.blend, &out->slots[slot]);
        }
    }
    return true;
}

/* Beyond a layer its wind counts the less, the farther off: over such a height. */
#define WIND_FADES_M 200.0f

static float height_from(const velum_slot_fields *f, float height_m) {
    return fmaxf(fmaxf(f->base_m - height_m, height_m - f->top_m), 0.0f);
}

static void wind_at(const core_column *column, float height_m, float wind_m_s[3]) {
    float sum[4] = {0};
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        const velum_slot_fields *f = &column->slot[slot];
        if (column->mask & (1u << slot)) {
            const float weight = f->coverage / (1.0f + powf(height_from(f, height_m) / WIND_FADES_M, 4.0f));
            const float of_slot[4] = {f->wind_x_m_s, f->wind_y_m_s, f->wind_z_m_s, 1.0f};
            for (int i = 0; i < 4; i++) {
                sum[i] += weight * of_slot[i];
            }
        }
    }
    for (int i = 0; i < 3; i++) {
        wind_m_s[i] = sum[3] > 0.0f ? sum[i] / sum[3] : 0.0f;
    }
}

void blocks_wind(const engine *e, const tiles *t, const double position_ecef_m[3], cloud_wind *out) {
    core_geodetic place;
    core_column column;
    memset(out, 0, sizeof *out);
    if (!e->weather.state[0] || !core_geodetic_from_ecef(position_ecef_m, &place)) {
        return;
    }
    double normal[3];
    core_normal(place.lat_deg, place.lon_deg, normal);
    core_column_layers(e->weather.state[0], normal, 1000.0, &column);
    for (int k = 0; k < VELUM_SHADE_LEVELS; k++) {
        wind_at(&column, velum_shade_height_m(k), out->m_s[k]);
    }
    bool is_bound = !(t->mask & ~column.mask);
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        const velum_slot_fields *f = &column.slot[slot];
        if (column.mask & (1u << slot)) {
            const float away_m = height_from(f, (float)place.height_m);
            float *most_rad_s = f->base_m > (float)place.height_m ? &out->above_rad_s : &out->below_rad_s;
            *most_rad_s = fmaxf(*most_rad_s, velum_wind_m_s(*f) / away_m);
            is_bound = is_bound && away_m > 0.0f;
        }
    }
    if (!is_bound) {
        out->above_rad_s = out->below_rad_s = INFINITY;
    }
}

void blocks_shift_shadow(const velum_shadow_geometry *geometry, const double origin_ecef_m[3],
                         velum_shadow_block *out) {
    *out = geometry->block;
    double moved[3];
    for (int i = 0; i < 3; i++) {
        moved[i] = origin_ecef_m[i] - geometry->origin_ecef_m[i];
    }
    double u = 0.0;
    double v = 0.0;
    for (int i = 0; i < 3; i++) {
        u += moved[i] * (double)geometry->block.axis_u[i];
        v += moved[i] * (double)geometry->block.axis_v[i];
    }
    for (uint32_t k = 0; k < geometry->levels; k++) {
        double extent_m = (double)geometry->block.level[k][0];
        out->level[k][1] = (float)((double)geometry->block.level[k][1] + u / extent_m);
        out->level[k][2] = (float)((double)geometry->block.level[k][2] + v / extent_m);
    }
}
