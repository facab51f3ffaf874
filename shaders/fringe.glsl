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

float scud_lumps(int slot, velum_slot_fields f, vec3 r) {
    return drifted_detail(slot, f, r, eye.slots[slot].lump_0 * VELUM_SCUD_LUMPS,
                          eye.slots[slot].lump_1 * VELUM_SCUD_LUMPS, 1.0);
}

float hem_extinction(int slot, velum_slot_fields f, velum_profile profile, velum_fringe g, vec3 r, vec3 normal,
                     float h, bool fine) {
    float e = velum_excess(profile, f.coverage, column_rank(slot, f, r, normal, h));
    float extinction = velum_band_1_m(profile, f, g, e, h);
    if (g.scud > 0.0) {
        float noise = velum_scud_noise(scud_lumps(slot, f, r), fine ? fine_noise(slot, f, r) : 0.5);
        extinction += velum_scud_1_m(profile, f, g, e, h, noise);
    }
    return extinction;
}

float fall_extinction(int slot, velum_slot_fields f, velum_profile profile, velum_fringe g, vec3 r, vec3 normal,
                      float h, bool fine) {
    vec3 wind = vec3(f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
    vec3 foot = r - normal * h + wind * velum_fall_lag_s(g, f.base_m - h);
    float e = velum_excess(profile, f.coverage, column_rank(slot, f, foot, normal, 0.0));
    float streak = velum_fall_streak(lump_noise(slot, f, foot), fine ? fine_noise(slot, f, foot) : 0.5);
    return velum_fall_1_m(profile, f, g, e, h, streak);
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
                      float h, bool fine) {
    float extinction = 0.0;
    int slot = part & 7;
    if (part < VELUM_PART_FALL) {
        extinction = hem_extinction(slot, f, profile, g, r, normal, h, fine);
    }
    if (part >= VELUM_PART_FALL && g.fall > 0.0) {
        extinction = fall_extinction(slot, f, profile, g, r, normal, h, fine);
    }
    return extinction;
}

#endif

#endif
