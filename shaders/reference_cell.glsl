/* The medium along a ray: stretches over which an upper bound of extinction is known, and extinction at a point. */
#ifndef VELUM_REFERENCE_CELL_GLSL
#define VELUM_REFERENCE_CELL_GLSL

#include "air.glsl"
#include "view.glsl"
#include "weather.glsl"
#include "shared/phase_sample.h"
#include "shared/reference.h"

layout(set = 1, binding = VELUM_BIND_REFERENCE_BOUNDS, std430) readonly buffer bounds_buffer {
    velum_page_bounds page_bounds[];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_NOISE, std430) readonly buffer noise_buffer {
    uint noise_most[];
};

/* Heights count as inside a layer from so far outside, so that a step of this length misses none. */
const float margin_m = 0.5;
const float least_step_m = 0.25;
const float far_m = 1.0e9;
const float worth_a_cell = 1.0; /* optical depth */

struct stretch {
    float left_m;  /* that the bound still holds for */
    float most_1_m; /* at least the extinction anywhere on it, in each channel */
    uint slots;    /* that can have cloud on it */
    float tile_m;  /* until the tile ends; 0: not known */
    tile_place tile;
};

/* Distance to heights between low and high from outside, never too long: height along a ray is convex, and on a sphere
 * of radius a it curves most. */
float reach_heights(float h, float rise, float low, float high) {
    const float a = VELUM_WGS84_A_M;
    float reach = far_m;
    if (h < low) {
        float x = 2.0 * (low - h) / a;
        float root = sqrt(rise * rise + x);
        reach = rise >= 0.0 ? a * x / (root + rise) : a * (root - rise);
    } else if (h > high) {
        reach = rise < 0.0 ? (h - high) / -rise : far_m;
    } else {
        reach = 0.0;
    }
    return reach;
}

/* Distance until heights low..high are left from inside, never too short by more than curvature makes up for. */
float leave_heights(float h, float rise, float low, float high) {
    return rise > 1e-6 ? (high - h) / rise : rise < -1e-6 ? (h - low) / -rise : far_m;
}

float edge_distance(float a, float rate_a, float major, float rate_major, float coordinate, uint level) {
    bool ahead = rate_a * major > a * rate_major;
    float edge = (floor(coordinate) + (ahead ? 1.0 : 0.0)) / float(1u << level) * 2.0 - 1.0;
    float k = tan(edge * (0.25 * PI));
    float speed = rate_a - k * rate_major;
    float t = (k * major - a) / (abs(speed) > 1e-9 ? speed : 1e-9);
    return t >= 0.0 ? t : (abs(k * major - a) < 2.0 ? 0.0 : far_m);
}

/* Distance to the border of the tile at r, whose edges are planes through the planet's centre once z is stretched as
 * normals stretch it, and to where the level changes. */
float tile_distance(vec3 r, vec3 d, vec3 normal, float height_m) {
    float stretch_z = (VELUM_WGS84_A_M + height_m) / (VELUM_WGS84_A_M * (1.0 - VELUM_WGS84_E2) + height_m);
    vec3 p = (eye.position.xyz + r) * vec3(1.0, 1.0, stretch_z);
    vec3 q = d * vec3(1.0, 1.0, stretch_z);
    velum_face_place face = velum_face_of(normal.x, normal.y, normal.z);
    float away = length(r);
    uint level = velum_tile_level(away, eye.weather.x);
    int axis = face.face >> 1;
    float side = (face.face & 1) == 0 ? 1.0 : -1.0;
    float major = side * (axis == 0 ? p.x : axis == 1 ? p.y : p.z);
    float rate_major = side * (axis == 0 ? q.x : axis == 1 ? q.y : q.z);
    float a = axis == 0 ? side * p.y : axis == 1 ? -side * p.x : p.y;
    float rate_a = axis == 0 ? side * q.y : axis == 1 ? -side * q.x : q.y;
    float b = axis == 2 ? -side * p.x : p.z;
    float rate_b = axis == 2 ? -side * q.x : q.z;
    float t = min(edge_distance(a, rate_a, major, rate_major, velum_tile_coordinate(face.u, level), level),
                  edge_distance(b, rate_b, major, rate_major, velum_tile_coordinate(face.v, level), level));
    float unit = 4.0 * eye.weather.x * VELUM_TILE_FACE_M;
    float low = level < VELUM_TILE_LEVEL_MAX ? unit / float(1u << level) : 0.0;
    float high = level > 0u ? 2.0 * unit / float(1u << level) : far_m;
    float along = dot(r, d);
    float in_root = along * along - away * away + low * low;
    float out_root = along * along - away * away + high * high;
    t = level > 0u ? min(t, sqrt(max(out_root, 0.0)) - along) : t;
    return along < 0.0 && in_root > 0.0 && low > 0.0 ? min(t, -along - sqrt(in_root)) : t;
}

/* Greatest value of a noise in the cell about q, which moves by v a metre; t: until the cell is left. */
float noise_cell(vec3 q, vec3 v, int cells, float to_centre, int first, inout float t) {
    vec3 place = q * float(cells) - to_centre;
    vec3 whole = floor(place);
    vec3 within = place - whole;
    vec3 way = mix(within, 1.0 - within, greaterThan(v, vec3(0.0)));
    vec3 steps = way / max(abs(v) * float(cells), vec3(1e-12));
    t = min(t, min(steps.x, min(steps.y, steps.z)));
    ivec3 i = ivec3(whole) & (cells - 1);
    uint at = uint(first + (i.z * cells + i.y) * cells + i.x);
    return float((noise_most[at >> 2u] >> (8u * (at & 3u))) & 255u) * (1.0 / 255.0);
}

/* What the pages of a slot allow, two weather states together. */
velum_page_bounds slot_bounds(uint pages) {
    uint a = pages & 0xffffu;
    uint b = pages >> 16u;
    velum_page_bounds x = page_bounds[a == VELUM_PAGE_NONE ? (b == VELUM_PAGE_NONE ? 0u : b) : a];
    if (velum_mixes && a != b) {
        velum_page_bounds y = page_bounds[b == VELUM_PAGE_NONE ? a : b];
        float of_a = a == VELUM_PAGE_NONE ? 0.0 : x.most.x * (1.0 - eye.weather.y);
        float of_b = b == VELUM_PAGE_NONE ? 0.0 : y.most.x * eye.weather.y;
        /* Mixed coverage is never above the sum, mixed fields lie between. */
        x.most = vec4(min(of_a + of_b, max(x.most.x, y.most.x)), max(x.most.y, y.most.y), max(x.most.z, y.most.z),
                      min(x.most.w, y.most.w));
        x.height = vec4(min(x.height.x, y.height.x), max(x.height.y, y.height.y), min(x.height.z, y.height.z),
                        max(x.height.w, y.height.w));
        x.shape = vec4(max(x.shape.x, y.shape.x), min(x.shape.y, y.shape.y), 0.0, 0.0);
    }
    return x;
}

/* Bound of one slot's extinction from r on, for heights around h; shortens `reach` to where it ends. */
float slot_most(int slot, tile_place tile, velum_page_bounds bounds, vec3 r, vec3 d, vec3 normal, float h, float rise,
                inout float reach) {
    float low = bounds.height.x - margin_m;
    float high = bounds.height.w + margin_m;
    if (h < low || h > high) {
        reach = min(reach, reach_heights(h, rise, low, high));
        return 0.0;
    }
    if (slot >= VELUM_SLOT_UNIFORM) {
        reach = min(reach, leave_heights(h, rise, low, high));
        return bounds.most.y * 1.0005;
    }
    velum_slot_fields f = slot_fields(tile, slot, true);
    vec3 wind = vec3(f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
    vec3 foot = r - normal * h;
    vec3 drift = (d - normal * rise) * (VELUM_WGS84_A_M / (VELUM_WGS84_A_M + h));
    float stretch_z = eye.slots[slot].bounds.z;
    vec4 phase = eye.slots[slot].shape_0;
    vec3 v = noise_place(drift, vec4(0.0, 0.0, 0.0, phase.w), stretch_z);
    vec3 q0 = noise_place(foot - wind * eye.weather.z, phase, stretch_z);
    vec3 q1 = velum_mixes ? noise_place(foot - wind * eye.weather.w, eye.slots[slot].shape_1, stretch_z) : q0;
    float t = far_m;
    float rank = noise_cell(q0, v, VELUM_NOISE_SHAPE_BLOCKS, 0.0625, VELUM_NOISE_BLOCKS_AT, t);
    if (velum_mixes) {
        rank = velum_rank_mix(rank, noise_cell(q1, v, VELUM_NOISE_SHAPE_BLOCKS, 0.0625, VELUM_NOISE_BLOCKS_AT, t),
                              eye.drift.x);
    }
    float c = bounds.most.x;
    float excess = (rank - 1.0 + c) / max(c, 1e-6);
    /* Smaller cells where a ray could collide in this one. */
    float dense = bounds.most.y * (1.0 + 0.6 * bounds.most.z);
    float most_m = min(reach, leave_heights(h, rise, low, high));
    if (excess > 0.0 && dense * min(t, most_m) > worth_a_cell) {
        t = far_m;
        rank = noise_cell(q0, v, VELUM_NOISE_SHAPE_CELLS, 0.5, 0, t);
        if (velum_mixes) {
            rank = velum_rank_mix(rank, noise_cell(q1, v, VELUM_NOISE_SHAPE_CELLS, 0.5, 0, t), eye.drift.x);
        }
        excess = (rank - 1.0 + c) / max(c, 1e-6);
    }
    reach = min(reach, t);
    if (excess <= 0.0) {
        return 0.0;
    }
    float lump = 0.8; /* carves nothing */
    for (int once = dense * min(reach, most_m) > worth_a_cell ? 0 : 1; once < 1; ++once) {
        vec3 own = r - wind * eye.weather.z;
        vec3 turn = noise_place(d, vec4(0.0, 0.0, 0.0, eye.slots[slot].lump_0.w), stretch_z);
        lump = noise_cell(noise_place(own, eye.slots[slot].lump_0, stretch_z), turn, VELUM_NOISE_DETAIL_CELLS, 0.5,
                          VELUM_NOISE_DETAIL_AT, reach);
        if (velum_mixes) {
            own = r - wind * eye.weather.w;
            lump = velum_detail_mix(lump, noise_cell(noise_place(own, eye.slots[slot].lump_1, stretch_z), turn,
                                                     VELUM_NOISE_DETAIL_CELLS, 0.5, VELUM_NOISE_DETAIL_AT, reach),
                                    eye.drift.x);
        }
    }
    excess -= bounds.shape.z * bounds.shape.w * max(1.6 - 2.0 * lump, 0.0);
    if (excess <= 0.0) {
        return 0.0;
    }
    /* The column of that rank ends where the threshold meets it. */
    float least_reach = max(bounds.most.w, 1e-3);
    float z_top = min(pow(excess / least_reach, 1.0 / max(bounds.shape.x, 0.1)), 1.0);
    high = min(high, mix(bounds.height.y, bounds.height.w, z_top) + margin_m);
    if (h > high) {
        reach = min(reach, reach_heights(h, rise, low, high));
        return 0.0;
    }
    float thickness = max(bounds.height.z - bounds.height.x, 1.0);
    float climb = abs(rise) > 1e-6 ? 0.12 * thickness / abs(rise) : far_m;
    reach = min(reach, min(climb, leave_heights(h, rise, low, high)));
    float up = h + max(rise, 0.0) * reach + reach * reach / (2.0 * VELUM_WGS84_A_M);
    float down = h + min(rise, 0.0) * reach;
    float z_high = clamp((up - bounds.height.x) / thickness, 0.0, 1.0);
    float z_low = clamp((down - bounds.height.y) / max(bounds.height.w - bounds.height.y, 1.0), 0.0, 1.0);
    float margin = excess - bounds.most.w * pow(z_low, bounds.shape.x);
    float water = 1.0 + max(bounds.most.z, 0.0) * (2.0 * z_high - 1.0) * 0.6;
    return bounds.most.y * water * velum_smoothstep(0.0, max(bounds.shape.y, 1e-3), margin) * 1.0005;
}

/* Of clean air and haze. */
float air_most(float h, float rise, inout float reach) {
    float most = 0.0;
    if (h > VELUM_AIR_TOP_M) {
        reach = min(reach, reach_heights(h, rise, -2000.0, VELUM_AIR_TOP_M));
        return most;
    }
    bool fog_on = eye.drift.y > 0.0;
    float fog_top = eye.drift.z + margin_m;
    float dh = fog_on && h < fog_top ? 60.0 : 1000.0 + max(h, 0.0);
    reach = min(reach, min(dh / max(abs(rise), 1e-6), sqrt(2.0 * VELUM_WGS84_A_M * dh)));
    reach = fog_on && h > fog_top ? min(reach, reach_heights(h, rise, -2000.0, fog_top)) : reach;
    float low = h + min(rise, 0.0) * reach;
    float high = h + max(rise, 0.0) * reach + reach * reach / (2.0 * VELUM_WGS84_A_M);
    float ozone = low < VELUM_OZONE_CENTRE_M && high > VELUM_OZONE_CENTRE_M
                      ? 1.0
                      : max(velum_ozone_density(low), velum_ozone_density(high));
    vec3 clean = rayleigh_1_m * velum_rayleigh_density(low) +
                 vec3(VELUM_AEROSOL_EXTINCTION * velum_aerosol_density(low)) + ozone_1_m * ozone;
    float fog = h > fog_top ? 0.0 : fog_extinction_1_m(low);
    return (max(clean.r, max(clean.g, clean.b)) + fog + haze_extinction_1_m(low)) * 1.001;
}

/* `before`: the one that ends at r, or any other with tile_m 0. */
stretch stretch_from(vec3 r, vec3 d, float left_m, stretch before, inout bool missing) {
    stretch s;
    s.tile_m = before.tile_m;
    s.most_1_m = 0.0;
    s.slots = 0u;
    s.tile = before.tile;
    float reach = left_m;
    velum_place place = place_of(r);
    vec3 normal = vec3(place.nx, place.ny, place.nz);
    float h = place.height_m;
    float rise = dot(normal, d);
    if (eye.ground.w != 0.0) {
        s.most_1_m = air_most(h, rise, reach);
    }
    float low = eye.span.x - margin_m;
    float high = eye.span.y + margin_m;
    bool inside = eye.table.z != 0u && h >= low && h <= high;
    if (eye.table.z != 0u && !inside) {
        reach = min(reach, reach_heights(h, rise, low, high));
    }
    for (int once = inside ? 0 : 1; once < 1; ++once) {
        s.tile = tile_move(before.tile, normal, length(r));
        missing = missing || s.tile.missing;
        for (int twice = s.tile_m > least_step_m ? 1 : 0; twice < 1; ++twice) {
            s.tile_m = tile_distance(r, d, normal, h);
        }
        reach = min(reach, s.tile_m);
        for (uint rest = s.tile.mask; rest != 0u; rest &= rest - 1u) {
            int slot = findLSB(rest);
            velum_page_bounds bounds = slot_bounds(table[s.tile.entry + VELUM_TABLE_PAGES + uint(slot)]);
            float most = slot_most(slot, s.tile, bounds, r, d, normal, h, rise, reach);
            s.most_1_m += most;
            s.slots |= most > 0.0 ? 1u << uint(slot) : 0u;
        }
    }
    s.tile_m = inside ? s.tile_m : 0.0;
    s.left_m = min(max(reach, least_step_m), left_m);
    return s;
}

/* Media that scatter: 0..7 slots, then these. */
const int medium_ground = 8;
const int medium_rayleigh = 9;
const int medium_aerosol = 10;
const int medium_haze = 11;
const int medium_fog = 12;

struct matter {
    float cloud;         /* scattering, 1/m */
    float cloud_loss;    /* absorption */
    int slot;            /* one of those with cloud, chosen by what each scatters */
    vec3 rayleigh;
    float aerosol, haze, fog;
    vec3 air_loss;
};

/* `choice`, 0..1, chooses the slot. */
matter matter_at(vec3 r, stretch s, float choice) {
    matter m;
    m.cloud = 0.0;
    m.cloud_loss = 0.0;
    m.slot = 0;
    m.rayleigh = vec3(0.0);
    m.aerosol = m.haze = m.fog = 0.0;
    m.air_loss = vec3(0.0);
    velum_place place = place_of(r);
    vec3 normal = vec3(place.nx, place.ny, place.nz);
    float h = place.height_m;
    for (int once = s.slots != 0u ? 0 : 1; once < 1; ++once) {
        /* The tile is that of the stretch; r may stand elsewhere in it. */
        tile_place tile = s.tile;
        uint level = velum_tile_key_level(table[tile.entry]);
        uint data_level = table[tile.entry + 1u];
        velum_face_place face = velum_face_of(normal.x, normal.y, normal.z);
        vec2 at = vec2(velum_tile_coordinate(face.u, level), velum_tile_coordinate(face.v, level));
        vec2 corner = vec2(velum_tile_key_x(table[tile.entry]), velum_tile_key_y(table[tile.entry]));
        at = clamp(at, corner, corner + 1.0) / float(1u << (level - data_level));
        vec2 within = at - floor(corner / float(1u << (level - data_level)));
        tile.uv = (within * float(VELUM_TILE_TEXELS) + float(VELUM_TILE_APRON)) / float(VELUM_TILE_SIDE);
        for (uint rest = s.slots; rest != 0u; rest &= rest - 1u) {
            int slot = findLSB(rest);
            velum_slot_fields f = slot_fields(tile, slot, true);
            bool even = slot >= VELUM_SLOT_UNIFORM && h >= f.base_m && h <= f.top_m && f.coverage >= 0.5;
            float extinction = even ? f.extinction_1_m : 0.0;
            for (int twice = slot < VELUM_SLOT_UNIFORM ? 0 : 1; twice < 1; ++twice) {
                float rank = column_rank(slot, f, r, normal, h);
                float lump = 0.0;
                float fine = 0.5;
                bool covered = velum_excess(velum_profile_of(slot, f), f.coverage, rank) > 0.0;
                for (int thrice = covered ? 0 : 1; thrice < 1; ++thrice) {
                    lump = lump_noise(slot, f, r);
                    fine = fine_noise(slot, f, r);
                }
                extinction = velum_slot_extinction(slot, f, h, rank, lump, fine);
            }
            float scattering = extinction * eye.slots[slot].optics.x;
            m.cloud += scattering;
            m.cloud_loss += extinction - scattering;
            float share = scattering / max(m.cloud, 1e-30);
            m.slot = choice < share ? slot : m.slot;
            choice = choice < share ? choice / max(share, 1e-30) : (choice - share) / max(1.0 - share, 1e-30);
        }
    }
    for (int once = eye.ground.w != 0.0 && h < VELUM_AIR_TOP_M ? 0 : 1; once < 1; ++once) {
        float aerosol = velum_aerosol_density(h);
        m.rayleigh = rayleigh_1_m * velum_rayleigh_density(h);
        m.aerosol = VELUM_AEROSOL_SCATTERING * aerosol;
        m.air_loss = ozone_1_m * velum_ozone_density(h) +
                     vec3((VELUM_AEROSOL_EXTINCTION - VELUM_AEROSOL_SCATTERING) * aerosol);
        m.haze = haze_extinction_1_m(h);
        m.fog = fog_extinction_1_m(h);
    }
    return m;
}

/* Phase functions as march.comp and air.glsl have them in first order. */
velum_phase_lobes medium_phase(int medium) {
    float g = medium == medium_aerosol ? VELUM_AEROSOL_G
              : medium == medium_haze  ? 0.7
              : medium == medium_fog   ? 0.75
              : medium < VELUM_SLOT_COUNT ? eye.slots[medium].optics.y : 0.0;
    velum_phase_lobes p = velum_phase_lobes_make(g, 0.0, 0.0, 0.0);
    velum_phase_lobes cloud = velum_phase_lobes_cloud(medium == VELUM_SLOT_HIGH);
    bool droplets = medium < VELUM_SLOT_UNIFORM;
    p.g_first = droplets ? cloud.g_first : p.g_first;
    p.g_second = droplets ? cloud.g_second : 0.0;
    p.alpha_second = droplets ? cloud.alpha_second : medium == medium_rayleigh ? 1.0 : 0.0;
    p.weight_second = droplets ? cloud.weight_second : medium == medium_rayleigh ? 1.0 : medium == medium_fog ? 0.3 : 0.0;
    return p;
}

#endif
