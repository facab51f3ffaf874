/* Scud, transition bands and precipitation at a point, and where they can be. */
#ifndef VELUM_FRINGE_GLSL
#define VELUM_FRINGE_GLSL

#include "weather.glsl"
#include "shared/fringe.h"

#ifdef VELUM_FRINGED

const uint all_hem = 255u << VELUM_PART_HEM;
const uint all_fall = 255u << VELUM_PART_FALL;

/* Heights and bound of a slot's cloud, hem or precipitation over all that the eye has: lowest, highest; greatest
 * extinction of the latter two. */
vec4 part_bounds(int part) {
    return part < VELUM_PART_HEM ? eye.slots[part].bounds : eye.fringes[part - VELUM_PART_HEM];
}

/* The same in a part of a tile that has some of it. */
vec2 part_heights_m(tile_place place, int part, uint page_part) {
    if (part < VELUM_PART_HEM) {
        return slot_heights_m(place, part, page_part);
    }
    int slot = part & (VELUM_SLOT_COUNT - 1);
    uint word = page_part + (part < VELUM_PART_FALL ? 0u : uint(VELUM_PARTS * VELUM_PARTS));
    uvec2 both = pages_spans(table[place.fringe + uint(slot)], word);
    vec2 span_m = spans_m(both);
    if (velum_mixes && (both.x == VELUM_SPAN_NONE) != (both.y == VELUM_SPAN_NONE)) {
        /* It hangs from a base between those of both. */
        vec2 cloud_m = slot_heights_m(place, slot, page_part);
        span_m.x = min(span_m.x, cloud_m.x - VELUM_SCUD_SHALLOW_M);
        span_m.y = max(span_m.y, cloud_m.y + VELUM_FALL_JOIN_MOST_M);
    }
    return span_m;
}

velum_fringe page_fringe(uint page, vec2 uv) {
    vec4 c = textureLod(tiles_a, page_place(page, uv), 0.0);
    c = page == VELUM_PAGE_NONE ? vec4(0.0) : c;
    return velum_fringe_of_texel(c.x, c.y, c.z, c.w);
}

/* Of a tile that has one for the slot. */
velum_fringe slot_fringe(tile_place place, int slot) {
    uint pages = table[place.fringe + uint(slot)];
    velum_fringe g = page_fringe(pages & 0xffffu, place.uv);
    if (velum_mixes && (pages >> 16u) != (pages & 0xffffu)) {
        uint clouds = table[place.entry + VELUM_TABLE_PAGES + uint(slot)];
        float share = velum_fields_share(page_fields(clouds & 0xffffu, place.uv),
                                         page_fields(clouds >> 16u, place.uv), eye.weather.y);
        g = velum_fringe_mix(g, page_fringe(pages >> 16u, place.uv), share);
    }
    return g;
}

/* Where the local fringe lies. */
vec2 part_span(int part, velum_slot_fields f, velum_fringe g) {
    velum_span_m s;
    if (part < VELUM_PART_FALL) {
        s = velum_hem_span(f, g);
    } else {
        s = velum_fall_span(f, g);
    }
    return vec2(s.low, s.high);
}

/* Where a part has its noise, and its height over the ellipsoid. What falls has that of the column that it left, at whose
 * foot it is looked for: such columns do not lean. */
vec4 noise_from(int part, velum_slot_fields f, velum_fringe g, vec3 r, vec3 normal, float h) {
    vec3 wind = vec3(f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
    vec3 foot = r - normal * h + wind * velum_fall_lag_s(g, f.base_m - h);
    return part < VELUM_PART_FALL ? vec4(r, h) : vec4(foot, 0.0);
}

/* Lumps of a part's noise, 0..1: those of scud are finer. */
float part_lumps(int part, velum_slot_fields f, vec3 from) {
    int slot = part & (VELUM_SLOT_COUNT - 1);
    float size = part >= VELUM_PART_HEM && part < VELUM_PART_FALL ? VELUM_SCUD_LUMPS : 1.0;
    return drifted_detail(slot, f, from, eye.slots[slot].lump_0 * size, eye.slots[slot].lump_1 * size, 1.0);
}

/* A band alone has no lumps. */
bool fringe_has_lumps(int part, velum_fringe g) {
    return part < VELUM_PART_FALL ? g.scud > 0.0 : g.fall > 0.0;
}

/* Extinction, 1/m, of scud and band or of what falls at a height of a column of excess e, by its noise. */
float fringe_extinction(int part, velum_slot_fields f, velum_profile profile, velum_fringe g, float e, float h,
                        float lumps, float fine) {
    if (part >= VELUM_PART_FALL) {
        return g.fall > 0.0 ? velum_fall_1_m(profile, f, g, e, h, velum_fall_streak(2.0 * lumps - 1.0, fine)) : 0.0;
    }
    float scud = g.scud > 0.0 ? velum_scud_1_m(profile, f, g, e, h, velum_scud_noise(lumps, fine)) : 0.0;
    return velum_band_1_m(profile, f, g, e, h) + scud;
}

/* How far about itself a shaft, or a hem, shines on itself: of the noise's period. Fitted to the reference: rain
 * from a storm, snow from altostratus. */
const float across_share = 0.9, storm_across_share = 0.52;
float part_across_m(int part) {
    int slot = part & (VELUM_SLOT_COUNT - 1);
    float share = part == VELUM_PART_FALL + VELUM_SLOT_STORM ? storm_across_share : across_share;
    return share / (part < VELUM_PART_FALL ? VELUM_SCUD_LUMPS * eye.slots[slot].lump_0.w : eye.slots[slot].shape_0.w);
}

/* Extinction, 1/m, of a part at a place within its span. */
float part_extinction(int part, velum_slot_fields f, velum_profile profile, velum_fringe g, vec3 r, vec3 normal,
                      float h, bool has_fine) {
    int slot = part & (VELUM_SLOT_COUNT - 1);
    vec4 from = noise_from(part, f, g, r, normal, h);
    float e = velum_excess(profile, f.coverage, column_rank(slot, f, from.xyz, normal, from.w));
    float lumps = 0.5;
    float fine = 0.5;
    if (fringe_has_lumps(part, g)) {
        lumps = part_lumps(part, f, from.xyz);
    }
    if (fringe_has_lumps(part, g) && has_fine) {
        fine = fine_noise(slot, f, from.xyz);
    }
    return fringe_extinction(part, f, profile, g, e, h, lumps, fine);
}

#endif

#endif
