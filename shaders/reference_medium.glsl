/* What scatters at a point of a ray, and where the rest of the ray is clear of it. Every slot and the air are processes
 * of their own, each with its bound: what is tried for one is looked at for that one alone. */
#ifndef VELUM_REFERENCE_MEDIUM_GLSL
#define VELUM_REFERENCE_MEDIUM_GLSL

#include "reference_bounds.glsl"

/* Media that scatter: 0..7 slots, then these. */
const int medium_ground = 8;
const int medium_rayleigh = 9;
const int medium_aerosol = 10;
const int medium_haze = 11;
const int medium_fog = 12;

#define VELUM_EACH_SLOT(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7)
/* What is tracked: the cloud of each slot, all hems, all that falls. */
const int process_hem = VELUM_SLOT_COUNT;
const int process_fall = VELUM_SLOT_COUNT + 1;
const int process_count = FRINGED(VELUM_SLOT_COUNT + 2, VELUM_SLOT_COUNT);
#ifdef VELUM_FRINGED
#define VELUM_EACH_PROCESS(DO) VELUM_EACH_SLOT(DO) DO(process_hem) DO(process_fall)
#else
#define VELUM_EACH_PROCESS(DO) VELUM_EACH_SLOT(DO)
#endif

bool slot_is_there(const int slot) {
    return (velum_slots & (1u << uint(slot))) != 0u;
}

uint fringes_of(const int process) {
    return FRINGED(eye.table.w & (process == process_hem ? all_hem : all_fall), 0u);
}

bool process_is_there(const int process) {
    return process < VELUM_SLOT_COUNT ? slot_is_there(process) : fringes_of(process) != 0u;
}

/* Metres from here along the ray in which a process has nothing; 0: it may. */
float clear_m[process_count];
/* The tile under the last point that was looked at. */
tile_place tile_under;
/* Bounds of the processes, 1/m: over all tiles of the eye; over that one, which hold for held_m along the ray. */
float all_most_1_m[process_count];
float own_most_1_m[process_count];
float held_m;

/* Bounds of a slot over all tiles of the eye. */
vec2 slot_heights(int slot) {
    return eye.slots[slot].bounds.xy + vec2(-margin_m, margin_m);
}

vec2 process_heights(const int process) {
    vec2 heights = vec2(far_m, -far_m);
    if (process < VELUM_SLOT_COUNT) {
        heights = slot_heights(process);
    }
#ifdef VELUM_FRINGED
    else {
        for (uint rest = fringes_of(process); rest != 0u; rest &= rest - 1u) {
            vec2 own = part_bounds(findLSB(rest)).xy;
            heights = vec2(min(heights.x, own.x - margin_m), max(heights.y, own.y + margin_m));
        }
    }
#endif
    return heights;
}

float process_most(const int process) {
    float most = 0.0;
    if (process < VELUM_SLOT_COUNT) {
        most = eye.slots[process].bounds.w;
    }
#ifdef VELUM_FRINGED
    else {
        for (uint rest = fringes_of(process); rest != 0u; rest &= rest - 1u) {
            most += part_bounds(findLSB(rest)).z * 1.0005;
        }
    }
#endif
    return most;
}

/* At the beginning of a ray. */
void clear_from(float h, float rise) {
    held_m = 0.0;
#define VELUM_CLEAR(n)                                                                                                 \
    if (process_is_there(n)) {                                                                                         \
        vec2 heights = process_heights(n);                                                                             \
        clear_m[n] = reach_heights(h, rise, heights.x, heights.y);                                                     \
    }
    VELUM_EACH_PROCESS(VELUM_CLEAR)
}

/* Moves along the ray to where some slot's bound, drawn down by `depth`, is used up: true, with that slot; or to `end`. */
bool cloud_advance(float depth, float end_m, float choice, out float step_m, out float bound_1_m, out int slot) {
    float gone_m = 0.0;
    float most = 0.0;
    float near_m = end_m;
    bool held = false;
    bool meets = false;
    for (int i = 0; i < 2 * process_count + 1; ++i) {
        most = 0.0;
        held = gone_m < held_m;
        near_m = held ? min(end_m, held_m) : end_m;
#define VELUM_BOUND(n)                                                                                                 \
    if (process_is_there(n)) {                                                                                         \
        bool on = clear_m[n] <= gone_m;                                                                                \
        most += on ? (held ? own_most_1_m[n] : all_most_1_m[n]) : 0.0;                                                 \
        near_m = on ? near_m : min(near_m, clear_m[n]);                                                                \
    }
        VELUM_EACH_PROCESS(VELUM_BOUND)
        float free_m = depth / max(most, 1e-30);
        meets = free_m < near_m - gone_m;
        depth -= (near_m - gone_m) * most;
        gone_m = meets ? gone_m + free_m : near_m;
        if (meets || gone_m >= end_m) {
            break;
        }
    }
    step_m = gone_m;
    slot = 0;
    bound_1_m = 1.0;
    float pick = choice * most;
#define VELUM_CHOOSE(n)                                                                                                \
    if (process_is_there(n)) {                                                                                         \
        float own = clear_m[n] <= gone_m ? (held ? own_most_1_m[n] : all_most_1_m[n]) : 0.0;                           \
        bool chosen = own > 0.0 && pick >= 0.0;                                                                        \
        slot = chosen ? n : slot;                                                                                      \
        bound_1_m = chosen ? own : bound_1_m;                                                                          \
        pick -= own;                                                                                                   \
        clear_m[n] = max(clear_m[n] - gone_m, 0.0);                                                                    \
    }
    VELUM_EACH_PROCESS(VELUM_CHOOSE)
    held_m = max(held_m - gone_m, 0.0);
    return meets;
}

/* Extinction of a slot with such fields; `clear`: how far there is none. */
float slot_extinction(const int slot, slot_tile s, velum_slot_fields f, velum_profile profile, float rank, float slope,
                      vec3 r, float h, float rise, float run, out float clear) {
    float extinction = 0.0;
    clear = 0.0;
    if (slot >= VELUM_SLOT_UNIFORM) {
        extinction = h >= f.base_m && h <= f.top_m && f.coverage >= 0.5 ? f.extinction_1_m : 0.0;
    } else {
        float z = (h - f.base_m) / max(f.top_m - f.base_m, 1.0);
        float e = velum_excess(profile, f.coverage, rank);
        bool covered = z > 0.0 && z < 1.0 && f.coverage > 0.0;
        float margin = e - velum_threshold(profile, z);
        float lump = 0.0;
        for (int once = covered && margin > 0.0 ? 0 : 1; once < 1; ++once) {
            lump = lump_noise(slot, f, r);
            margin = velum_margin(profile, e, z, lump, 1.0);
        }
        for (int once = covered && margin > 0.0 ? 0 : 1; once < 1; ++once) {
            float fine = fine_noise(slot, f, r);
            extinction = f.extinction_1_m * velum_body(profile, e, z, h - f.base_m, lump, fine);
        }
        /* As far as the ray's slope, the layer's and the planet's curve allow. */
        float beyond_m = max(f.base_m - h, h - f.top_m);
        float nearing = abs(rise) + s.steep;
        clear = s.slowness > 0.0 && beyond_m > 0.0
                    ? 2.0 * beyond_m / (nearing + sqrt(nearing * nearing + 2.0 * beyond_m / least_radius_m))
                    : 0.0;
        clear = covered && margin < 0.0 ? margin_clear(slot, s, f, profile, margin, z, slope, rise, run) : clear;
    }
    return extinction;
}

slot_tile slot_tiles[VELUM_SLOT_COUNT];

#ifdef VELUM_FRINGED
/* Of all hems in the tile, or of all that falls: heights; that of two states together is not known. */
vec2 fringe_heights[2];

void fringe_learn(const int process) {
    const vec2 all_heights = process_heights(process);
    vec2 heights = vec2(far_m, -far_m);
    float most = 0.0;
    for (uint rest = tile_under.parts & fringes_of(process); rest != 0u; rest &= rest - 1u) {
        uint slot = uint(findLSB(rest)) & uint(VELUM_SLOT_COUNT - 1);
        uint pages = table[tile_under.fringe + slot];
        uint clouds = table[tile_under.entry + VELUM_TABLE_PAGES + slot];
        bool one = !velum_mixes || ((pages >> 16u) == (pages & 0xffffu) && (clouds >> 16u) == (clouds & 0xffffu));
        velum_page_bounds x = page_bounds[one ? pages & 0xffffu : 0u];
        vec2 span = process == process_hem ? x.height.xy : x.height.zw;
        span = one ? span + vec2(-margin_m, margin_m) : all_heights;
        heights = vec2(min(heights.x, span.x), max(heights.y, span.y));
        most += !one ? far_m : (process == process_hem ? x.most.x : x.most.y) * 1.0005;
    }
    fringe_heights[process - process_hem] = heights;
    own_most_1_m[process] = min(most, all_most_1_m[process]);
}
#endif

/* What the tile under a lane says of each slot. */
void tile_learn() {
#define VELUM_LEARN(n)                                                                                                 \
    if (slot_is_there(n)) {                                                                                            \
        bool kept = (tile_under.mask & (1u << uint(n))) != 0u;                                                         \
        slot_tiles[n] = slot_tile_at(n, kept ? table[tile_under.entry + VELUM_TABLE_PAGES + uint(n)] : slot_nowhere);     \
        own_most_1_m[n] = min(slot_tiles[n].most_1_m, all_most_1_m[n]);                                                \
    }
    VELUM_EACH_SLOT(VELUM_LEARN)
#ifdef VELUM_FRINGED
    if (process_is_there(process_hem)) {
        fringe_learn(process_hem);
    }
    if (process_is_there(process_fall)) {
        fringe_learn(process_fall);
    }
#endif
}

/* Before the first tile. */
void tile_forget() {
    tile_under = tile_nowhere();
    for (int slot = 0; slot < VELUM_SLOT_COUNT; ++slot) {
        slot_tiles[slot] = slot_tile_none();
    }
}

/* Before the first ray. */
void bounds_begin() {
    tile_forget();
    for (int process = 0; process < process_count; ++process) {
        clear_m[process] = far_m;
        all_most_1_m[process] = process_is_there(process) ? process_most(process) : 0.0;
        own_most_1_m[process] = 0.0;
    }
    held_m = 0.0;
}

/* Extinction of a slot at a point, and how far the ray beyond it is clear. */
float cloud_at(const int slot, velum_place place, vec3 r, vec3 d) {
    vec3 normal = vec3(place.nx, place.ny, place.nz);
    float h = place.height_m;
    float rise = dot(normal, d);
    vec2 heights = slot_heights(slot);
    slot_tile s = slot_tiles[slot];
    bool inside = h >= heights.x && h <= heights.y;
    bool within = inside && s.cover > 0.0 && h >= s.low - margin_m && h <= s.high + margin_m;
    float beside = s.cover > 0.0 ? reach_heights(h, rise, s.low - margin_m, s.high + margin_m) : far_m;
    ivec2 part = part_at(tile_under.uv);
    float cover = part_cover(s, part);
    beside = within && cover <= 0.0 ? part_side_m(tile_under) : beside;
    within = within && cover > 0.0;
    float extinction = 0.0;
    for (int once = within ? 0 : 1; once < 1; ++once) {
        velum_slot_fields f = s.fields;
        velum_profile profile = s.profile;
        bool even = (s.even & (1u << uint(part.y * VELUM_PARTS + part.x))) != 0u;
        for (int uneven = even ? 1 : 0; uneven < 1; ++uneven) {
            f = slot_fields_of(s.pages, tile_under.uv);
            if (slot < VELUM_SLOT_UNIFORM) {
                profile = velum_profile_of(slot, f);
            }
        }
        float rank = 0.0;
        float slope = 0.0;
        /* Of noise, over a metre along the ray. */
        float stretch = eye.slots[slot].bounds.z;
        float run = sqrt(max(1.0 - rise * rise, 0.0)) * velum_noise_run(stretch) +
                    abs(rise) * velum_lean_slope(slot, f) * stretch;
        beside = 0.0;
        if (slot < VELUM_SLOT_UNIFORM) {
            rank = column_rank(slot, f, r, normal, h);
            beside = shape_clear(slot, s, tile_under, cover, f, f.coverage * profile.coverage_scale, rank, r, normal, h,
                                 rise, run, slope);
        }
        for (int twice = beside <= 0.0 ? 0 : 1; twice < 1; ++twice) {
            extinction = slot_extinction(slot, s, f, profile, rank, slope, r, h, rise, run, beside);
        }
    }
    clear_m[slot] = inside ? min(beside, held_m) : reach_heights(h, rise, heights.x, heights.y);
    return extinction;
}

#ifdef VELUM_FRINGED
/* Extinction of all hems, or of all that falls, and a slot that it belongs to, by chance. */
float fringe_at(const int process, velum_place place, vec3 r, vec3 d, float choice, out int slot) {
    vec3 normal = vec3(place.nx, place.ny, place.nz);
    float h = place.height_m;
    float rise = dot(normal, d);
    vec2 heights = process_heights(process);
    vec2 own_heights = fringe_heights[process - process_hem];
    bool inside = h >= heights.x && h <= heights.y;
    bool within = inside && h >= own_heights.x && h <= own_heights.y;
    uint parts = tile_under.parts & fringes_of(process);
    float extinction = 0.0;
    slot = 0;
    for (uint rest = within ? parts : 0u; rest != 0u; rest &= rest - 1u) {
        int part = findLSB(rest);
        int own_slot = part & (VELUM_SLOT_COUNT - 1);
        velum_slot_fields f = slot_fields(tile_under, own_slot, true);
        velum_fringe g = slot_fringe(tile_under, own_slot);
        vec2 span = part_span(part, f, g);
        for (int once = f.coverage > 0.0 && h > span.x && h < span.y ? 0 : 1; once < 1; ++once) {
            float own = part_extinction(part, f, velum_profile_of(own_slot, f), g, r, normal, h, true);
            extinction += own;
            float share = own / max(extinction, 1e-30);
            bool chosen = choice < share;
            slot = chosen ? own_slot : slot;
            choice = chosen ? choice / share : (choice - share) / max(1.0 - share, 1e-30);
        }
    }
    float beside = parts == 0u ? far_m : reach_heights(h, rise, own_heights.x, own_heights.y);
    clear_m[process] = inside ? min(beside, held_m) : reach_heights(h, rise, heights.x, heights.y);
    return extinction;
}
#endif

/* Of the process that was chosen, which becomes the slot that it belongs to. */
float clouds_at(inout int slot, vec3 r, vec3 d, float choice, inout bool missing) {
    velum_place place = place_of(r);
    uint last = tile_under.key;
    tile_under = tile_move(tile_under, vec3(place.nx, place.ny, place.nz), length(r));
    missing = missing || tile_under.missing;
    for (int once = tile_under.key != last ? 0 : 1; once < 1; ++once) {
        tile_learn();
    }
    held_m = tile_distance(tile_under, r, d, vec3(place.nx, place.ny, place.nz));
    float extinction = 0.0;
    const int process = slot;
#define VELUM_LOOK(n)                                                                                                  \
    if (slot_is_there(n)) {                                                                                            \
        for (int own = slot == n ? 0 : 1; own < 1; ++own) {                                                            \
            extinction = cloud_at(n, place, r, d);                                                                     \
        }                                                                                                              \
    }
    VELUM_EACH_SLOT(VELUM_LOOK)
#ifdef VELUM_FRINGED
#define VELUM_LOOK_BELOW(n)                                                                                            \
    if (process_is_there(n)) {                                                                                         \
        for (int own = process == n ? 0 : 1; own < 1; ++own) {                                                         \
            extinction = fringe_at(n, place, r, d, choice, slot);                                                      \
        }                                                                                                              \
    }
    VELUM_LOOK_BELOW(process_hem)
    VELUM_LOOK_BELOW(process_fall)
#endif
    return extinction;
}

struct air_matter {
    vec3 rayleigh;
    float aerosol, haze, fog;
    vec3 loss;
};

air_matter air_at(float h) {
    air_matter m;
    float aerosol = h < VELUM_AIR_TOP_M ? velum_aerosol_density(h) : 0.0;
    m.rayleigh = rayleigh_1_m * (h < VELUM_AIR_TOP_M ? velum_rayleigh_density(h) : 0.0);
    m.aerosol = VELUM_AEROSOL_SCATTERING * aerosol;
    m.loss = ozone_1_m * (h < VELUM_AIR_TOP_M ? velum_ozone_density(h) : 0.0) +
             vec3((VELUM_AEROSOL_EXTINCTION - VELUM_AEROSOL_SCATTERING) * aerosol);
    m.haze = h < VELUM_AIR_TOP_M ? haze_extinction_1_m(h) : 0.0;
    m.fog = fog_extinction_1_m(h);
    return m;
}

/* Phase functions as cloud_light.glsl and air_light.glsl have them in first order. */
velum_phase_lobes medium_phase(int medium) {
    float g = medium == medium_aerosol ? VELUM_AEROSOL_G
              : medium == medium_haze  ? haze_g
              : medium == VELUM_SLOT_UNIFORM   ? eye.slots[VELUM_SLOT_UNIFORM].optics.y
              : medium == VELUM_SLOT_UNIFORM_2 ? eye.slots[VELUM_SLOT_UNIFORM_2].optics.y
                                               : 0.0;
    velum_phase_lobes p = velum_phase_lobes_make(g, 0.0, 0.0, 0.0);
    velum_phase_lobes cloud = velum_phase_lobes_cloud(medium == VELUM_SLOT_HIGH);
    bool droplets = medium < VELUM_SLOT_UNIFORM;
    p.g_first = droplets ? cloud.g_first : p.g_first;
    p.g_second = droplets ? cloud.g_second : 0.0;
    p.alpha_second = droplets ? cloud.alpha_second : medium == medium_rayleigh ? 1.0 : 0.0;
    p.weight_second = droplets ? cloud.weight_second : medium == medium_rayleigh ? 1.0 : 0.0;
    if (medium == medium_fog) {
        p = velum_phase_lobes_fog();
    }
    return p;
}

#endif
