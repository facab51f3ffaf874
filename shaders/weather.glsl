/* Cloud at a point: tiles, noise, the shared density function. */
#ifndef VELUM_WEATHER_GLSL
#define VELUM_WEATHER_GLSL

#include "engine.glsl"

float velum_shape_at(float x, float y, float z) {
    return textureLod(shape_noise, vec3(x, y, z), 0.0).r;
}
float velum_detail_at(float x, float y, float z) {
    return textureLod(detail_noise, vec3(x, y, z), 0.0).r;
}

#include "shared/sample.h"

/* Two weather states, or two lives of the noise, are mixed. The plain pipeline does not pay for it. */
layout(constant_id = 0) const bool velum_mixes = true;
/* Layers with scud, a transition band or precipitation have passes of their own: nor for these. */
#ifdef VELUM_FRINGED
#define FRINGED(there, plain) (there)
#else
#define FRINGED(there, plain) (plain)
#endif

struct tile_place {
    uint key;   /* asked for; VELUM_TILE_KEY_NONE: nothing yet */
    uint entry; /* first word of the table's entry; VELUM_TILE_KEY_NONE: nothing there */
    uint mask;  /* slots with cloud */
#ifdef VELUM_FRINGED
    uint fringe; /* first word of the fringes' pages */
    uint parts;  /* VELUM_PART_* that can be there */
#endif
    float scale; /* of coordinates at the level asked for, to the page's */
    float side_m; /* of the tile whose page it is, nominal: an ancestor where the weather is smooth */
    float own_m;  /* of the tile asked for */
    int face;
    vec2 own;  /* place in the tile asked for, 0..1 */
    vec2 uv;     /* in a page */
    bool missing;
};

tile_place tile_nowhere() {
#ifdef VELUM_FRINGED
    return tile_place(VELUM_TILE_KEY_NONE, VELUM_TILE_KEY_NONE, 0u, 0u, 0u, 1.0, VELUM_TILE_FACE_M, VELUM_TILE_FACE_M, 0, vec2(0.0), vec2(0.0), false);
#else
    return tile_place(VELUM_TILE_KEY_NONE, VELUM_TILE_KEY_NONE, 0u, 1.0, VELUM_TILE_FACE_M, VELUM_TILE_FACE_M, 0, vec2(0.0), vec2(0.0), false);
#endif
}

/* The entry that stands for a place at a level, or for the finest coarser one that there is. */
tile_place tile_look_up(velum_face_place face, int wanted, uint key) {
    tile_place place = tile_nowhere();
    place.key = key;
    for (int level = wanted; level >= 0; --level) {
        uint found_key = level == wanted ? key
                                         : velum_tile_key(uint(level), uint(face.face),
                                                          uint(velum_tile_coordinate(face.u, uint(level))),
                                                          uint(velum_tile_coordinate(face.v, uint(level))));
        uint index = velum_table_hash(found_key, eye.table.y);
        for (int probe = 0; probe < 64; ++probe) {
            uint word = eye.table.x + index * VELUM_TABLE_WORDS;
            uint found = table[word];
            if (found == found_key) {
                place.entry = word;
                place.mask = table[word + 2u] & eye.table.z;
#ifdef VELUM_FRINGED
                uint fringed = table[word + 2u] >> uint(VELUM_SLOT_COUNT);
                place.fringe = eye.table.x + table[word + 3u];
                place.parts = (fringed << VELUM_PART_HEM | fringed << VELUM_PART_FALL) & eye.table.w;
#endif
                uint data_level = table[word + 1u];
                place.scale = 1.0 / float(1u << (uint(wanted) - data_level));
                place.side_m = VELUM_TILE_FACE_M / float(1u << data_level);
                return place;
            }
            if (found == VELUM_TILE_KEY_NONE) {
                break;
            }
            index = (index + 1u) & eye.table.y;
        }
        place.missing = true;
    }
    return place;
}

/* Of coordinates at the level of a page. */
vec2 uv_in_page(vec2 at) {
    return (fract(at) * float(VELUM_TILE_TEXELS) + float(VELUM_TILE_APRON)) / float(VELUM_TILE_SIDE);
}

/* The tile under a place so far from the eye. `last` is that of another place: neighbours often share one, and then
 * the table is not asked. */
tile_place tile_move(tile_place last, vec3 normal, float distance_m) {
    velum_face_place face = velum_face_of(normal.x, normal.y, normal.z);
    uint level = velum_tile_level(distance_m, eye.weather.x);
    float x = velum_tile_coordinate(face.u, level);
    float y = velum_tile_coordinate(face.v, level);
    uint key = velum_tile_key(level, uint(face.face), uint(x), uint(y));
    tile_place place = last;
    if (key != last.key) {
        place = tile_look_up(face, int(level), key);
    }
    place.face = face.face;
    place.own = fract(vec2(x, y));
    place.own_m = VELUM_TILE_FACE_M / float(1u << level);
    place.uv = uv_in_page(vec2(x, y) * place.scale);
    return place;
}

/* In the axes of a face: outward, u, v. See velum_face_of. */
vec3 face_turned(int face, vec3 v) {
    vec3 side = face == 0 ? v : (face == 1 ? vec3(-v.x, -v.y, v.z) : (face == 2 ? v.yxz * vec3(1.0, -1.0, 1.0)
                                                                                 : v.yxz * vec3(-1.0, 1.0, 1.0)));
    return face < 4 ? side : (face == 4 ? vec3(v.z, v.y, -v.x) : vec3(-v.z, v.y, v.x));
}

float leave(vec2 within, vec2 rate) {
    vec2 left = mix(within, 1.0 - within, greaterThan(rate, vec2(0.0))) / max(abs(rate), vec2(1e-12));
    return min(left.x, left.y) * 0.98;
}

/* Metres on a tile's face that a metre along a direction is. */
vec2 face_rate(tile_place place, vec3 normal, vec3 direction) {
    vec3 n = face_turned(place.face, normal);
    vec3 d = face_turned(place.face, direction);
    vec2 t = n.yz / n.x;
    vec2 turn = (d.yz - t * d.x) / (n.x * (1.0 + t * t) * VELUM_WGS84_B_M);
    return turn * (0.5 * 1.2732395 * VELUM_TILE_FACE_M);
}

/* In parts of a page's side, 0..VELUM_PARTS. */
vec2 parts_of(vec2 uv) {
    vec2 within = (uv * float(VELUM_TILE_SIDE) - float(VELUM_TILE_APRON)) / float(VELUM_TILE_TEXELS);
    return within * float(VELUM_PARTS);
}
/* Which part of the page a place is in. */
ivec2 part_at(vec2 uv) {
    return clamp(ivec2(parts_of(uv)), ivec2(0), ivec2(VELUM_PARTS - 1));
}

/* How far along a ray the tile that was asked for reaches (x): beyond it, another page may hold. In that tile, the part
 * of the page (y), and the square between its four texels (z). */
vec3 tile_reach_m(tile_place place, vec3 normal, vec3 direction) {
    vec2 rate = face_rate(place, normal, direction);
    float tile_m = leave(place.own, rate / place.own_m);
    float part_m = leave(fract(parts_of(place.uv)), rate * (float(VELUM_PARTS) / place.side_m));
    vec2 texel = place.uv * float(VELUM_TILE_SIDE) - 0.5;
    float texels_m = leave(fract(texel), rate * (float(VELUM_TILE_TEXELS) / place.side_m));
    return vec3(tile_m, min(tile_m, part_m), min(tile_m, texels_m));
}

tile_place tile_find(vec3 normal, float distance_m) {
    return tile_move(tile_nowhere(), normal, distance_m);
}

/* Where a place in a page lies in the image of all; of no page, in the first. */
vec3 page_place(uint page, vec2 uv) {
    uint safe = page == VELUM_PAGE_NONE ? 0u : page;
    vec2 corner = vec2(safe % VELUM_PAGE_COLUMNS, safe / VELUM_PAGE_COLUMNS % VELUM_PAGE_ROWS);
    return vec3((corner + uv) / vec2(VELUM_PAGE_COLUMNS, VELUM_PAGE_ROWS), float(safe / VELUM_PAGES_A_LAYER));
}

velum_slot_fields page_fields(uint page, vec2 uv) {
    vec3 place = page_place(page, uv);
    vec4 a = textureLod(tiles_a, place, 0.0);
    vec4 b = textureLod(tiles_b, place, 0.0);
    velum_slot_fields f = velum_fields_of_texels(a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w);
    f.coverage = page == VELUM_PAGE_NONE ? 0.0 : f.coverage;
    return f;
}

velum_slot_fields slot_fields_of(uint pages, vec2 uv) {
    velum_slot_fields f = page_fields(pages & 0xffffu, uv);
    if (velum_mixes) {
        velum_slot_fields g = page_fields(pages >> 16u, uv);
        if ((pages >> 16u) != (pages & 0xffffu)) {
            f = velum_fields_mix(f, g, eye.weather.y);
        }
    }
    return f;
}

/* Of the pages of both states, the span of a part, by its word. */
uvec2 pages_spans(uint pages, uint word) {
    uint a = pages & 0xffffu;
    uint b = pages >> 16u;
    uvec2 both = uvec2(a == VELUM_PAGE_NONE ? VELUM_SPAN_NONE : spans[a * VELUM_SPAN_WORDS + word]);
    if (velum_mixes && b != a) {
        both.y = b == VELUM_PAGE_NONE ? VELUM_SPAN_NONE : spans[b * VELUM_SPAN_WORDS + word];
    }
    return both;
}

/* Heights between which there is anything; lowest above highest: nothing. */
vec2 spans_m(uvec2 both) {
    uvec2 low = both & 0xffffu;
    uvec2 high = both >> 16u;
    vec2 stored = vec2(min(low.x, low.y), max(high.x, high.y)) * (1.0 / 65535.0);
    return vec2(velum_texel_height_m(stored.x), velum_texel_height_m(stored.y));
}

/* Of a slot in a part of a tile. */
vec2 slot_heights_m(tile_place place, int slot, uint part) {
    return spans_m(pages_spans(table[place.entry + VELUM_TABLE_PAGES + uint(slot)], part));
}

/* `wanted` false: no such place in the table; coverage 0. */
velum_slot_fields slot_fields(tile_place place, int slot, bool wanted) {
    uint word = wanted ? place.entry + VELUM_TABLE_PAGES + uint(slot) : 0u;
    return slot_fields_of(wanted ? table[word] : (VELUM_PAGE_NONE << 16u) | VELUM_PAGE_NONE, place.uv);
}

float page_coverage(uint page, vec2 uv) {
    return page == VELUM_PAGE_NONE ? 0.0 : textureLod(tiles_a, page_place(page, uv), 0.0).x;
}

/* Of a slot elsewhere in a tile's page, or at its border where that lies beyond. */
float slot_coverage(tile_place place, int slot, vec2 uv) {
    const float border = 0.5 / float(VELUM_TILE_SIDE);
    vec2 within = clamp(uv, border, 1.0 - border);
    uint pages = table[place.entry + VELUM_TABLE_PAGES + uint(slot)];
    float coverage = page_coverage(pages & 0xffffu, within);
    if (velum_mixes) {
        coverage = mix(coverage, page_coverage(pages >> 16u, within), eye.weather.y);
    }
    return coverage;
}

/* Of all that the eye has of a slot, where that is the same (velum_slot_block). */
velum_profile even_profile(int slot) {
    vec4 a = eye.slots[slot].profile_0;
    vec4 b = eye.slots[slot].profile_1;
    vec4 c = eye.slots[slot].profile_2;
    vec4 d = eye.slots[slot].profile_3;
    return velum_profile(a.x, a.y, a.z, a.w, b.x, b.y, b.z, b.w, c.x, c.y, c.z, c.w, d.x, d.y);
}

/* Trails of cirrus follow fibres, however bent: what a column leans by is stretched alone. */
vec3 noise_place(int slot, vec3 r, vec3 lean, vec4 phase, float stretch) {
    float across_m = 0.0;
    if (stretch < 1.0 && slot == VELUM_SLOT_HIGH) {
        across_m = velum_north_m(eye.position.x, eye.position.y, eye.position.z, r.x, r.y, r.z) +
                   velum_waves_m(eye.position.x + r.x, eye.position.y + r.y, eye.position.z + r.z);
    }
    velum_noise_point p = velum_noise_place(phase.x, phase.y, phase.z, phase.w, stretch, across_m, r.x + lean.x, r.y + lean.y,
                                            r.z + lean.z);
    return vec3(p.x, p.y, p.z);
}

/* Where else than over its foot the column through r, at height over the ellipsoid, along normal, has its noise; and its
 * rank. */
vec3 column_lean(int slot, velum_slot_fields f, vec3 normal, float height_m) {
    velum_noise_point lean = velum_lean(slot, f, height_m, normal.x, normal.y, normal.z);
    return vec3(lean.x, lean.y, lean.z);
}

float column_rank(int slot, velum_slot_fields f, vec3 r, vec3 normal, float height_m) {
    vec3 wind = vec3(f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
    vec3 foot = r - normal * height_m;
    vec3 lean = column_lean(slot, f, normal, height_m);
    float stretch = eye.slots[slot].bounds.z;
    vec3 p = noise_place(slot, foot - wind * eye.weather.z, lean, eye.slots[slot].shape_0, stretch);
    float rank = velum_shape_at(p.x, p.y, p.z);
    if (velum_mixes) {
        p = noise_place(slot, foot - wind * eye.weather.w, lean, eye.slots[slot].shape_1, stretch);
        rank = velum_rank_mix(rank, velum_shape_at(p.x, p.y, p.z), eye.drift.x);
    }
    return rank;
}

/* Detail noise, 0..1, at r with the phases of one of its two scales. */
float drifted_detail(int slot, velum_slot_fields f, vec3 r, vec4 phase_0, vec4 phase_1, float stretch) {
    vec3 wind = vec3(f.wind_x_m_s, f.wind_y_m_s, f.wind_z_m_s);
    vec3 p = noise_place(slot, r - wind * eye.weather.z, vec3(0.0), phase_0, stretch);
    float n = velum_detail_at(p.x, p.y, p.z);
    if (velum_mixes) {
        p = noise_place(slot, r - wind * eye.weather.w, vec3(0.0), phase_1, stretch);
        n = velum_detail_mix(n, velum_detail_at(p.x, p.y, p.z), eye.drift.x);
    }
    return n;
}

float slot_lumps(int slot, velum_slot_fields f, vec3 r) {
    return drifted_detail(slot, f, r, eye.slots[slot].lump_0, eye.slots[slot].lump_1, 1.0);
}
float lump_noise(int slot, velum_slot_fields f, vec3 r) {
    return 2.0 * slot_lumps(slot, f, r) - 1.0;
}

bool shows_fine(int slot, float distance_m) {
    return velum_shows_fine(distance_m, eye.slots[slot].fine_0.w, eye.slots[slot].optics.w);
}

float fine_noise(int slot, velum_slot_fields f, vec3 r) {
    return drifted_detail(slot, f, r, eye.slots[slot].fine_0, eye.slots[slot].fine_1, eye.slots[slot].optics.w);
}

/* How far on a column of a higher rank may stand, in periods by rank, and cloud that lumps and detail leave, by e. Not
 * bounds (ranks rise faster over a few texels): with longer ways rays pass over towers (test `gpu query`), and storms
 * are striped. */
const float rank_way = 0.036, storm_way = 0.02, margin_way = 0.01;
/* Cover below this is rare; share of rank_way under the rarest, which only peaks of the noise are. */
const float rare_cover = 0.3, rarest_cover = 0.1, rarest_way = 0.5;

/* Along a ray that rises so much a metre, m: over excess that a column lacks, and over a margin below 0. */
vec2 clear_ways_m(int slot, velum_slot_fields f, velum_profile profile, float rise) {
    float lean = 1.0 + abs(rise) * velum_lean_slope(slot, f) * eye.slots[slot].bounds.z;
    float period_m = 1.0 / (eye.slots[slot].shape_0.w * lean);
    float way = slot == VELUM_SLOT_STORM ? storm_way : rank_way;
    way *= mix(rarest_way, 1.0, clamp((f.coverage - rarest_cover) / (rare_cover - rarest_cover), 0.0, 1.0));
    float rank_m = f.coverage * profile.coverage_scale * way * period_m;
    return vec2(rank_m, min(margin_way * period_m, rank_m));
}

#endif
