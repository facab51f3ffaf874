/* Where a ray need not look: heights, tiles, stretches of the shape noise, bounds of air. */
#ifndef VELUM_REFERENCE_BOUNDS_GLSL
#define VELUM_REFERENCE_BOUNDS_GLSL

#include "air.glsl"
#include "view.glsl"
#include "weather.glsl"
#include "fringe.glsl"
#include "shared/phase_sample.h"
#include "shared/reference.h"

layout(set = 1, binding = VELUM_BIND_REFERENCE_BOUNDS, std430) readonly buffer bounds_buffer {
    velum_page_bounds page_bounds[];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_NOISE, std430) readonly buffer noise_buffer {
    uint noise_slope[];
};

/* What there is at all: the shader has nothing of the rest. */
layout(constant_id = 2) const uint velum_slots = 255u;
layout(constant_id = 3) const bool velum_has_air = true;

/* Heights count as inside a layer from so far outside, so that a step of this length misses none. */
const float margin_m = 0.5;
const float least_step_m = 0.5;
const float far_m = 1.0e9;

/* Where the ellipsoid curves most, along the meridian at the equator. */
const float least_radius_m = VELUM_WGS84_B_M * VELUM_WGS84_B_M / VELUM_WGS84_A_M;

/* Distance to heights between low and high from outside, never too long: height along a ray is convex, and curves most
 * there. */
float reach_heights(float h, float rise, float low, float high) {
    const float a = least_radius_m;
    float x = 2.0 * max(low - h, 0.0) / a;
    float root = sqrt(rise * rise + x);
    float up = rise >= 0.0 ? a * x / max(root + rise, 1e-12) : a * (root - rise);
    float down = rise < 0.0 ? (h - high) / -rise : far_m;
    return h < low ? up : h > high ? down : 0.0;
}

const uint slot_nowhere = (VELUM_PAGE_NONE << 16u) | VELUM_PAGE_NONE;

/* What the tile under a lane says of a slot. */
struct slot_tile {
    uint pages;
    float cover;        /* effective coverage at most; 0: no such cloud */
    float most_1_m;     /* extinction at most; far_m: not known */
    uint even;          /* parts where fields and profile are those below */
    float reach, power; /* of the threshold over height: at least */
    float low, high;    /* lowest base, highest top */
    float base;         /* highest base */
    uvec4 parts;        /* of cover */
    velum_slot_fields fields;
    velum_profile profile;
    float slowness;   /* metres over metres of noise, at least; 0: nothing is known */
    /* Change over a metre at most: of effective coverage; of base and top together; of that, over thickness. */
    float fade, steep, bend;
};

slot_tile slot_tile_none() {
    slot_tile s;
    s.pages = slot_nowhere;
    s.cover = s.most_1_m = s.reach = s.low = s.high = s.base = s.slowness = s.fade = s.steep = s.bend = 0.0;
    s.power = 1.0;
    s.even = 0u;
    s.parts = uvec4(0u);
    s.fields = velum_slot_fields(0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    s.profile = velum_profile_make(0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    return s;
}

/* Two weather states together. */
slot_tile slot_tile_at(const int slot, uint pages) {
    uint a = pages & 0xffffu;
    uint b = velum_mixes && eye.weather.y > 0.0 ? pages >> 16u : a;
    a = velum_mixes && eye.weather.y >= 1.0 ? b : a;
    slot_tile s = slot_tile_none();
    s.pages = pages;
    if (a == VELUM_PAGE_NONE && b == VELUM_PAGE_NONE) {
        return s;
    }
    velum_page_bounds x = page_bounds[a == VELUM_PAGE_NONE ? b : a];
    float tau = max(abs(eye.weather.z), velum_mixes ? abs(eye.weather.w) : 0.0);
    s.slowness = 1.0 / (1.0 + x.shape.x * tau + x.shape.w);
    s.most_1_m = x.most.y * 1.0005;
    s.even = x.even.x;
    s.fade = VELUM_FADE_OTHERS * x.shape.y;
    s.steep = x.shape.z;
    s.bend = s.steep / max(x.height.z - x.height.y, 1.0);
    /* What storms and cumulus cover depends on their height, too, and a storm's on its anvil. */
    float beside = slot == VELUM_SLOT_STORM ? VELUM_BESIDE_1_M * VELUM_ANVIL_LAG_S * x.shape.x : 0.0;
    bool deepens = slot == VELUM_SLOT_STORM || slot == VELUM_SLOT_CUMULUS;
    s.fade += deepens ? x.most.x * (beside + VELUM_FADE_BEND * s.bend) : 0.0;
    if (velum_mixes && a != b) {
        velum_page_bounds y = page_bounds[b == VELUM_PAGE_NONE ? a : b];
        x.most = vec4(max(x.most.x, y.most.x), max(x.most.y, y.most.y), min(x.most.z, y.most.z),
                      max(x.most.w, y.most.w));
        x.height = vec4(min(x.height.x, y.height.x), max(x.height.y, y.height.y), min(x.height.z, y.height.z),
                        max(x.height.w, y.height.w));
        /* Winds are mixed by coverages: they may change from one texel to the next. */
        s.slowness = 0.0;
        s.most_1_m = far_m;
        x.parts = uvec4(0xffffffffu);
        s.even = 0u;
    }
    s.cover = x.most.x;
    s.parts = x.parts;
    s.reach = x.most.z;
    s.power = max(x.most.w, 0.1);
    s.low = x.height.x;
    s.base = x.height.y;
    s.high = x.height.w;
    for (int once = s.even != 0u ? 0 : 1; once < 1; ++once) {
        uvec2 texel = uvec2(x.even.y % uint(VELUM_TILE_SIDE), x.even.y / uint(VELUM_TILE_SIDE));
        s.fields = page_fields(a == VELUM_PAGE_NONE ? b : a, (vec2(texel) + 0.5) / float(VELUM_TILE_SIDE));
        if (slot < VELUM_SLOT_UNIFORM) {
            s.profile = velum_profile_of(slot, s.fields);
        }
    }
    return s;
}

/* Inverse of velum_rank_mix: what a mixed rank was before it was made uniform again. */
float rank_unmix(float rank, float weight) {
    float w = clamp(weight, 0.0, 1.0);
    float a = min(w, 1.0 - w);
    float b = 1.0 - a;
    float edge = 0.5 * a / b;
    float x = rank < edge         ? sqrt(2.0 * a * b * max(rank, 0.0))
              : rank <= 1.0 - edge ? b * rank + 0.5 * a
                                   : 1.0 - sqrt(2.0 * a * b * max(1.0 - rank, 0.0));
    return a > 1.0e-4 ? x : rank;
}

float noise_slope_at(vec3 q) {
    ivec3 i = ivec3(floor(q * float(VELUM_SLOPE_SIDE) - 0.5)) & (VELUM_SLOPE_SIDE - 1);
    uint at = uint((i.z * VELUM_SLOPE_SIDE + i.y) * VELUM_SLOPE_SIDE + i.x);
    return float((noise_slope[at >> 2u] >> (8u * (at & 3u))) & 255u) * VELUM_SLOPE_UNIT;
}

/* Tiles narrow to 0.7 of their side away from their face's axes. */
float part_side_m(tile_place tile) {
    return tile.side_m * (0.7 / float(VELUM_PARTS));
}

/* Bound of coverage about a part, within a part's side. */
float part_cover(slot_tile s, ivec2 i) {
    uint row = i.y == 0 ? s.parts.x : i.y == 1 ? s.parts.y : i.y == 2 ? s.parts.z : s.parts.w;
    return s.cover * float((row >> (8u * uint(i.x))) & 255u) * (1.0 / 255.0);
}

/* Noise periods around q in which no rank is as high. */
float noise_away(vec3 q, float rank) {
    const int side = VELUM_AWAY_SIDE;
    ivec3 i = ivec3(floor(q * float(side) - 0.5 * float(side) / float(VELUM_SLOPE_SIDE))) & (side - 1);
    uint at = uint(VELUM_SLOPE_BYTES) + uint(((velum_away_level(rank) * side + i.z) * side + i.y) * side + i.x);
    return float((noise_slope[at >> 2u] >> (8u * (at & 3u))) & 255u) * (VELUM_AWAY_UNIT / float(VELUM_AWAY_SIDE));
}

/* Distance along a ray over which the shape noise, of that rank here, lets no cloud of the slot be, as far as the tile
 * goes. `slope`: change of rank over a period of it, at most. */
float shape_clear(int slot, slot_tile s, tile_place tile, float cover, velum_slot_fields f, float own_cover, float rank,
                  vec3 r, vec3 normal, float h, float rise, float run, out float slope) {
    vec3 wind = vec3(f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
    vec3 foot = r - normal * h;
    vec3 lean = column_lean(slot, f, normal, h);
    float stretch = eye.slots[slot].bounds.z;
    /* Columns reach so high only where their rank is greater: as good on the way down as long as it is short. */
    float thickness = max(s.high - s.base, 1.0);
    float z = clamp((h - s.base) / thickness - (rise < 0.0 ? 0.1 : 0.0), 0.0, 1.0);
    float valid = rise < 0.0 && z > 0.0 ? 0.1 * thickness / -rise : far_m;
    float cover_valid = cover < s.cover ? part_side_m(tile) : far_m;
    float foot_rank = 1.0 - cover;
    float threshold = foot_rank + cover * s.reach * pow(z, s.power);
    vec3 q0 = noise_place(slot, foot - wind * eye.weather.z, lean, eye.slots[slot].shape_0, stretch);
    vec3 q1 = q0;
    slope = noise_slope_at(q0);
    float short_of = threshold - rank;
    if (velum_mixes) {
        q1 = noise_place(slot, foot - wind * eye.weather.w, lean, eye.slots[slot].shape_1, stretch);
        threshold = rank_unmix(min(threshold, 1.0), eye.drift.x);
        foot_rank = rank_unmix(min(foot_rank, 1.0), eye.drift.x);
        short_of = threshold - rank_unmix(rank, eye.drift.x);
        slope = mix(slope, noise_slope_at(q1), clamp(eye.drift.x, 0.0, 1.0));
    }
    float away = max(min((short_of - VELUM_SLOPE_SLACK) / max(slope, 1e-3), VELUM_SLOPE_RADIUS), 0.0);
    float far = 0.0; /* whatever the height */
    if (away > 0.0) {
        away = max(away, noise_away(q0, threshold));
        far = noise_away(q0, foot_rank);
        if (velum_mixes) {
            /* A mixed rank is no higher than the higher of the two. */
            away = max(min((short_of - VELUM_SLOPE_SLACK) / max(slope, 1e-3), VELUM_SLOPE_RADIUS),
                       min(away, noise_away(q1, threshold)));
            far = min(far, noise_away(q1, foot_rank));
        }
    }
    float period_m = s.slowness / (eye.slots[slot].shape_0.w * max(run, 1e-4));
    /* As coverage is here, and as fast as it can grow. */
    float own = (velum_mixes ? rank_unmix(clamp(1.0 - own_cover, 0.0, 1.0), eye.drift.x) - rank_unmix(rank, eye.drift.x)
                             : 1.0 - own_cover - rank) - VELUM_SLOPE_SLACK;
    own = s.slowness > 0.0 ? own / (s.fade * max(run, 1e-4) + max(slope, 1e-3) / period_m) : 0.0;
    float own_m = min(max(own, 0.0), VELUM_SLOPE_RADIUS * period_m);
    float clear = max(min(away * period_m, valid), far * period_m);
    return max(min(clear, cover_valid), own_m);
}

/* Distance over which a margin stays below 0, whatever fine noise carves. */
float margin_clear(int slot, slot_tile s, velum_slot_fields f, velum_profile p, float margin, float z, float slope,
                   float rise, float run) {
    float thickness = max(f.top_m - f.base_m, 1.0);
    float climb = abs(rise) / thickness;
    float carve = 1.6 * p.amplitude;
    float up = VELUM_ANVIL_SLOPE * velum_stem_at(p, 1.0) + VELUM_ICE_SLOPE * VELUM_ANVIL_SMOOTH * p.damp * carve;
    float low = 5.0 * carve * (1.0 - p.foot) + min(p.stem, VELUM_STEM);
    float down = p.reach * p.power * pow(max(z, 1e-3), p.power - 1.0) + low;
    /* Where layers may be thin in the tile, they are not about here, half as thick no sooner than after half_m. */
    float half_m = 0.5 * thickness / max(s.steep, 1e-9);
    float bend = min(s.bend, 1.0 / half_m);
    float along_z = climb * (rise > 0.0 ? up : down) + bend * (up + p.reach * p.power + low);
    float cover = max(f.coverage * p.coverage_scale, 1e-4);
    float sharp = velum_mixes ? 1.0 / max(eye.drift.x, 1.0 - eye.drift.x) : 1.0;
    float along_e = slope * sharp * eye.slots[slot].shape_0.w * run / (max(s.slowness, 1e-3) * cover) + s.fade / cover;
    along_e += slot == VELUM_SLOT_STORM ? VELUM_STORM_EDGE * s.fade : 0.0;
    float along_lump = 2.0 * p.amplitude * view.march.z * eye.slots[slot].lump_0.w / max(s.slowness, 1e-3);
    along_lump *= velum_mixes ? 1.42 : 1.0;
    float clear = -(margin + VELUM_SLOPE_SLACK / cover + 0.012 * p.amplitude) / (1.2 * (along_z + along_e + along_lump));
    float reach = VELUM_SLOPE_RADIUS * s.slowness / (eye.slots[slot].shape_0.w * max(run, 1e-4));
    reach = bend < s.bend ? min(reach, half_m) : reach;
    return s.slowness > 0.0 ? min(max(clear, 0.0), reach) : 0.0;
}

/* How far along a ray the bounds of the tile at r hold: to its border, and to where another level is asked for. Pages
 * reach half a texel over their tiles' borders, so that a short step over one does no harm. */
float tile_distance(tile_place place, vec3 r, vec3 d, vec3 normal) {
    float away = length(r);
    uint wanted = velum_tile_key_level(place.key);
    float unit = 4.0 * eye.weather.x * VELUM_TILE_FACE_M / float(1u << wanted);
    float low = wanted < uint(VELUM_TILE_LEVEL_MAX) ? unit : -far_m;
    float high = wanted > 0u ? 2.0 * unit : far_m;
    return max(min(tile_reach_m(place, normal, d).x, min(away - low, high - away)), least_step_m);
}

/* Bound of air along a ray, and how far it holds. */
float air_most(float h, float rise, out float reach) {
    if (h > VELUM_AIR_TOP_M) {
        reach = max(reach_heights(h, rise, -2000.0, VELUM_AIR_TOP_M), least_step_m);
        return 0.0;
    }
    bool fog_on = eye.drift.y > 0.0;
    float fog_top = eye.drift.z + margin_m;
    float dh = fog_on && h < fog_top ? 60.0 : 1000.0 + max(h, 0.0);
    reach = min(dh / max(abs(rise), 1e-6), sqrt(2.0 * least_radius_m * dh));
    reach = fog_on && h > fog_top ? min(reach, reach_heights(h, rise, -2000.0, fog_top)) : reach;
    reach = max(reach, least_step_m);
    float low = h + min(rise, 0.0) * reach;
    float high = h + max(rise, 0.0) * reach + reach * reach / (2.0 * least_radius_m);
    float ozone = low < VELUM_OZONE_CENTRE_M && high > VELUM_OZONE_CENTRE_M
                      ? 1.0
                      : max(velum_ozone_density(low), velum_ozone_density(high));
    vec3 clean = rayleigh_1_m * velum_rayleigh_density(low) +
                 vec3(VELUM_AEROSOL_EXTINCTION * velum_aerosol_density(low)) + ozone_1_m * ozone;
    float fog = h > fog_top ? 0.0 : fog_extinction_1_m(low);
    return (max(clean.r, max(clean.g, clean.b)) + fog + haze_extinction_1_m(low)) * 1.001;
}

#endif
