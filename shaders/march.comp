#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* One ray for each block of pixels, or four (finer.comp): transmittance of cloud, its mean distance, and the places of it
 * that get light (lit.glsl). For studies (study.glsl) every place is lit as it is found. */
#include "air_light.glsl"
#include "due.glsl"
#include "weather.glsl"
#include "study.glsl"
#include "uneven.glsl"
#include "cloud_light.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT, rgba16f) uniform writeonly image2D light_out;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE, r32f) uniform writeonly image2D distance_out;
layout(set = 1, binding = VELUM_BIND_COUNTERS, std430) buffer counter_buffer {
    uint counters[4];
};

/* Both uniform layers, no other. */
const uint sheets = (1u << VELUM_SLOT_UNIFORM) | (1u << VELUM_SLOT_UNIFORM_2);

/* Of a long step; and of the mean free path in dense cloud, over what still comes through: a tongue that takes half of a
 * ray's light is met by half of a pixel's rays, as sparks. No shorter than pixels show, and than so many metres. */
const float short_share = 0.18;
const float short_path = 1.2, short_through = 0.2, short_least_m = 1.0;
/* A long step rises or falls by no more than this share of a layer's thickness: from high above, clouds are wider than
 * they are deep. */
const float layer_share = 0.15;
/* However steep the ray, no shorter than this share of it, or than the shortest. */
const float thin_share = 0.3;
/* Of a layer's thickness, along a ray that comes in through its base; but no shorter than this share of the shortest. */
const float foot_share = 0.01, foot_least = 0.25;
/* Along a ray over tops, m a metre over them. */
const float top_way = 0.25;
/* Clouds of rare cover are small: long steps go by its root, down to this share. */
const float rare_least = 0.3;
/* The first steps are shorter, and each is longer than the last by this share of the way: around the eye, cloud is as
 * large in the picture as it is near. */
const float at_eye_m = 12.0, wider = 0.5;
#ifdef VELUM_STUDY
const float dim = 0.3;
#endif
/* Opacity with which a place stands for its layer or its cloud alone, once the ray has left that: one place for the rim of
 * a cloud and what lies far behind it would show the light of either, by chance. A cloud of less counts, but has no light
 * of its own: the cloud behind takes over its place. One ray of a hundred would show a rim in the sun for all of a niche, as
 * a spark. Drizzle and cloud that lie in each other share places, or all would be on their first few metres. */
const float alone_least = 0.01;
/* Clouds are two where so much of the way to the second lies between them, and so many metres: a tongue in the sun and the
 * wall in its shade have two lights, near as they are. Not of fibres: they have many gaps, and one light; nor of uniform
 * layers. */
const float apart_share = 0.003, apart_least_m = 1.0;
/* Where a step begins cloud is thinner than where it is sampled. */
const float entry_share = 0.7;
/* A ray gives up where so little comes through; the rest is taken as none. */
const float opaque = 0.0015;

/* Software devices run both sides of every branch, and the body of a loop at least once: only later turns of a loop are
 * left out, when all lanes have left it. */

/* The newest profile: fields change little along a ray, often not at all. */
struct profile_memo {
    velum_profile profile;
    vec4 of; /* kind, coverage, thickness, extinction */
    float anvil_m;
    int slot;
};

profile_memo profile_none() {
    profile_memo memo;
    memo.slot = -1;
    memo.of = vec4(-1.0);
    memo.anvil_m = 0.0;
    return memo;
}

void profile_recall(inout profile_memo memo, int slot, velum_slot_fields f) {
    vec4 of = vec4(f.kind, f.coverage, f.top_m - f.base_m, f.extinction_1_m);
    float anvil_m = slot == VELUM_SLOT_STORM ? velum_anvil_m(f) : 0.0;
    bool near = all(lessThanEqual(abs(of - memo.of), vec4(1.0e-3, 1.0e-3, 1.0e-3 * memo.of.zw))) &&
                abs(anvil_m - memo.anvil_m) < 2.0;
    if (slot != memo.slot || !near) {
        memo.profile = velum_profile_of(slot, f);
        memo.of = of;
        memo.anvil_m = anvil_m;
        memo.slot = slot;
    }
}

/* Excess below which a column has no cloud at any height that the ray comes to before it meets one: where `here` is
 * wanted, and it rises by at most 1 in `rank_m`. */
float least_excess(cloud_hit hit, float here, float rank_m, float most_m) {
    float way_m = min(max(here - hit.excess, 0.0) * rank_m, most_m);
    float then = hit.height_fraction + hit.rise * way_m / max(hit.span_m.y - hit.span_m.x, 1.0);
    return min(here, velum_threshold_between(hit.profile, min(hit.height_fraction, then), max(hit.height_fraction, then)));
}

#ifndef VELUM_STUDY
/* A height below all others. */
const float none_m = -1.0e9;

/* Of what comes through so far, what this part of a ray's opacity takes where so many are before it and so many left with it.
 * Parts are alike, but of veils each is larger than the one before: thin as they are, a low sun may light their faces alone,
 * which one place in many would stand for, as sparks. */
float part_share(uint before, uint left, bool grows) {
    float nth = float(before + 1u);
    float all = grows ? float(left) * (nth + 0.5 * float(left - 1u)) / nth : float(left);
    return 1.0 / all;
}
#endif

/* Of what is left to look at in a step. Of two uniform layers in one step the nearer comes first; they come last. */
int next_part(uint meets, float rise) {
    int part = findLSB(meets);
#ifdef VELUM_FRINGED
    /* What is gone back to before what is not: nothing is lit twice. */
    uint sharp = meets & ~(sheets | all_fall);
    part = sharp != 0u ? findLSB(sharp) : part;
#endif
    return meets == sheets && rise < 0.0 ? VELUM_SLOT_UNIFORM_2 : part;
}

void main() {
    due_ray of;
    if (!due_ray_here(of)) {
        return;
    }
    ivec2 block = of.block;
    ivec2 pixel = finer_pixel(block, of.which);
    view_ray ray = ray_of_pixel(pixel);

    float end = view.march.z;
    float solid = host_distance(pixel, ray);
    if (solid < 0.0) {
        solid = ground_distance(ray.origin, ray.direction);
    }
    if (solid >= 0.0) {
        end = min(end, solid);
    }
    velum_span shell = velum_sphere_span(eye_geometry(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                         ray.direction.y, ray.direction.z, eye.span.y * VELUM_SCALE_Z + 1.0);
    float position = max(shell.enter_m, 0.0);
    end = shell.enter_m > shell.leave_m ? -1.0 : min(end, shell.leave_m);
    velum_span hollow = velum_sphere_span(eye_geometry(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                          ray.direction.y, ray.direction.z, max(eye.span.x - 1.0, -1000.0));
    if (hollow.enter_m <= hollow.leave_m && hollow.enter_m <= 0.0 && hollow.leave_m > 0.0) {
        position = max(position, hollow.leave_m);
    }

    float through = 1.0;
    float weighted = 0.0;
    float weight = 0.0;
    uint samples = 0u;
    bool missing = false;
    tile_place tile = tile_nowhere();

    /* Steps tile the ray; each is sampled at the same share of its length. */
    float offset = step_offset(pixel);
    float dt_min = view.march.x;
    float growth = view.march.y;
    int left = int(view.steps.x);
    uint done = 0u;        /* slots already looked at in this step */
    /* From the step's beginning on, how far nothing can begin; less for ranks, whose bounds are none. */
    float advance = 1.0e9;
    float clear_to = 1.0e9; /* the same of layers that the step does not meet */
    bool alive = position < end && eye.table.z != 0u;
#ifdef VELUM_STUDY
    ray_phases phases = ray_phases_of(ray.direction);
    vec3 light = vec3(0.0);
    vec3 source = vec3(0.0);
    uint light_samples = 0u;
    bool is_lit = false;
#else
    uint first_place = of.place;
    uint places = 0u;
    vec4 place = vec4(0.0); /* the newest: see lit.glsl */
    float drawn_from = 0.0; /* its opacity, but for what has no light of its own */
    float first_pick = pick_offset(offset);
    float pick = first_pick;
    uint newly = 0u, lately = 0u; /* parts that count in this step, and did in the one before */
    float until = 2.0;            /* as little comes through where the newest place's part ends */
    float left_m = 0.0;           /* where the ray has last left cloud */
    uint kept = 1u;               /* places for what may lie behind the first cloud, until there is such, or cannot be */
    float others_top_m = none_m;  /* of all that is no veil */
    for (uint rest = eye.table.z & ~(1u << VELUM_SLOT_HIGH); rest != 0u; rest &= rest - 1u) {
        others_top_m = max(others_top_m, eye.slots[findLSB(rest)].bounds.y);
    }
#endif
    /* Long steps look for cloud. What one finds is gone back to, and crossed in short ones: the face of a cumulus lies
     * within a few mean free paths. */
    float short_until = 0.0;
    float longest = 1.0e9; /* long step, by the layers last met */
    float allowed = 1.0e9; /* by those that this step meets */
    float stride = 1.0e9;  /* and what they let it advance by: beside a cloud, less than its length... */
    bool counted = false;  /* ... but all of it where one of them has counted for all of it */
    float settled = position; /* light and transmittance hold up to here */
    float dense_1_m = 0.0;    /* extinction, where it is whole, of the densest layer that the step before was within... */
    float denser_1_m = 0.0;   /* ... and of what this step has been looked at so far */

    profile_memo memo = profile_none();
#ifdef VELUM_FRINGED
    float room = 0.0; /* from the step's beginning on, how far there is nothing but what falls */
    const float fall_stride = 2.0; /* of a long step there: that is smooth */
#endif

    while (alive) {
        cloud_hit hit;
        bool is_short = STUDIED(study_all_alike() || position < short_until, position < short_until);
        /* Longer as they run out, so that a ray comes to its end: where it does not, there is a hole in what stands far off. */
        float spent = 1.0 - float(left) / float(view.steps.x);
        float spent5 = spent * spent * spent * spent * spent;
        float hurry = 1.0 + 4.0 * spent5 + 12.0 * spent5 * spent5 * spent * spent;
        float first_dt = STUDIED(study_all_alike() ? dt_min : min(dt_min, at_eye_m + wider * position),
                                 min(dt_min, at_eye_m + wider * position));
        float long_dt = min(max(first_dt, position * growth), longest) * hurry;
        float path_m = short_path / max(dense_1_m * max(through, short_through), 1.0e-6);
        float finest_m = max(position * growth * short_share, short_least_m);
        float short_dt = min(long_dt * short_share, max(path_m, finest_m) * hurry);
        short_dt = STUDIED(study_all_alike() ? long_dt * short_share : short_dt, short_dt);
        float dt = is_short ? short_dt : STUDIED(long_dt * view.study_limits.x, long_dt);
#ifdef VELUM_FRINGED
        bool strides = !is_short && room > 1.1 * fall_stride * long_dt;
        dt = strides ? clamp(longest * hurry, dt, fall_stride * dt) : dt;
#endif
        dt = min(dt, end - position);
        float at = position + dt * offset;
        vec3 r = ray.origin + ray.direction * at;
        velum_place here = place_of(r);
        vec3 normal = vec3(here.nx, here.ny, here.nz);
        float h = here.height_m;
        float rise = dot(normal, ray.direction);
        float h0 = h - rise * dt * offset;
        float h1 = h + rise * dt * (1.0 - offset);
        float low = min(h0, h1);
        float high = max(h0, h1) + dt * dt * (0.5 / VELUM_WGS84_A_M);
        tile = velum_uneven ? tile_move(tile, normal, at) : tile_move_even(tile, normal, at);
        missing = missing || tile.missing;

        /* Which slots the step can meet: by their heights over all that the eye has, in this part of the tile, and here.
         * The first that it does meet is looked at now. */
        uint meets = 0u;
        /* Where all tiles have the same, it tells nothing. */
        vec3 reach_m = velum_uneven ? tile_reach_m(tile, normal, ray.direction) : vec3(0.0);
        float texel_m = tile.side_m / float(VELUM_TILE_TEXELS);
        float clear_m = 1.0e9;
        vec2 gap_m = no_gap_m;
#ifdef VELUM_FRINGED
        vec2 sharp_gap_m = no_gap_m;
#endif
        for (uint rest = FRINGED(eye.table.z | eye.table.w, eye.table.z); rest != 0u; rest &= rest - 1u) {
            int candidate = findLSB(rest);
            vec4 bounds = FRINGED(part_bounds(candidate), eye.slots[candidate].bounds);
            uint bit = 1u << uint(candidate);
            bool outside = high < bounds.x || low > bounds.y;
            bool present = (FRINGED(tile.mask | tile.parts, tile.mask) & bit) != 0u;
            gap_m = gap_beside(gap_m, low, high, bounds.xy);
#ifdef VELUM_FRINGED
            sharp_gap_m = candidate < VELUM_PART_FALL ? gap_beside(sharp_gap_m, low, high, bounds.xy) : sharp_gap_m;
#endif
            clear_m = outside || present ? clear_m : reach_m.x;
            meets |= !outside && present ? bit : 0u;
        }
        uint part_word = part_word_of(tile);
        for (uint rest = velum_uneven ? FRINGED(meets, meets & ~done) : 0u; rest != 0u; rest &= rest - 1u) {
            int candidate = findLSB(rest);
            vec2 span_m = FRINGED(part_heights_m(tile, candidate, part_word), slot_heights_m(tile, candidate, part_word));
            bool outside = high < span_m.x || low > span_m.y;
            gap_m = gap_beside(gap_m, low, high, span_m);
#ifdef VELUM_FRINGED
            sharp_gap_m = candidate < VELUM_PART_FALL ? gap_beside(sharp_gap_m, low, high, span_m) : sharp_gap_m;
#endif
            clear_m = outside ? min(clear_m, reach_m.y) : clear_m;
            meets &= outside ? ~(1u << uint(candidate)) : ~0u;
        }
#ifdef VELUM_FRINGED
        bool sharp_met = (meets & ~all_fall) != 0u;
        room = sharp_met ? 0.0 : min(clear_m, gap_way_m(sharp_gap_m, h, rise) - 1.0) + dt * offset;
#endif
        clear_m = min(clear_m, gap_way_m(gap_m, h, rise) - 1.0);
        meets &= ~done;
        bool looking = false;
        hit.tile = tile;
        gap_m = no_gap_m;
        /* Asked before each turn: software devices let lanes that are done run through the others' turns, and what a turn
         * leaves is theirs too where it is asked for after it. */
        for (bool more = true; more; more = velum_uneven && meets != 0u && !looking) {
            bool some = meets != 0u;
            hit.part = some ? next_part(meets, rise) : 0;
            uint bit = some ? 1u << uint(hit.part) : 0u;
            hit.slot = FRINGED(hit.part & (VELUM_SLOT_COUNT - 1), hit.part);
            meets &= ~bit;
            done |= bit;
            cloud_fields(hit, some);
            bool there = hit.fields.coverage > 0.0;
            looking = there && low < hit.span_m.y && high > hit.span_m.x;
            clear_m = there || !some ? clear_m : min(clear_m, reach_m.z);
            gap_m = there ? gap_beside(gap_m, low, high, hit.span_m) : gap_m;
        }
        hit.fields.coverage = looking ? hit.fields.coverage : 0.0;
        /* Fields are known here alone: elsewhere layers lie higher or lower, at the edges of regions by steep walls. */
        float own_m = min(0.7 * gap_way_m(gap_m, h, rise), top_way * (h - gap_m.x));
        own_m = gap_m == no_gap_m ? 1.0e9 : min(own_m, min(0.1 * at + 500.0, texel_m));
        clear_to = min(clear_to, min(clear_m, own_m) + dt * offset);
        advance = min(advance, clear_to);

        int part = hit.part;
        int slot = hit.slot;
        bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
        hit.r = r;
        hit.normal = normal;
        hit.at_h_m = h;
        hit.rise = rise;
        hit.before_m = dt * offset;
        hit.after_m = dt - hit.before_m;
        if (velum_uneven) {
            profile_recall(memo, slot, hit.fields);
        }
        hit.profile = velum_uneven ? memo.profile : even_profile(slot);
        cloud_look(hit, looking, at, STUDIED(study_base(is_short), false));
        velum_slot_fields f = hit.fields;
        float extinction = hit.extinction_1_m;
        /* A band is crossed in a long step only where nothing else is left that the step may be gone back for. */
        bool glides = FRINGED(hit.smooth_part && (part >= VELUM_PART_FALL || meets == 0u), false);
        bool within = hit.within;
        bool covered = hit.covered;
        denser_1_m = within ? max(denser_1_m, f.extinction_1_m * hit.profile.density_scale) : denser_1_m;
        samples += hit.sampled ? 1u : 0u;

        /* All for fields that do not change much: a page tells nothing beyond its next texel. */
        vec2 ways_m = clear_ways_m(slot, f, hit.profile, rise);
        float threshold = within ? velum_threshold(hit.profile, hit.height_fraction) : 0.0;
        float gap = min(max(least_excess(hit, threshold, ways_m.x, texel_m) - hit.excess, 0.0) * ways_m.x, texel_m);
        float clear = covered ? max(min(max(-hit.margin, 0.0) * ways_m.y, texel_m), gap) : 0.0;
        bool hangs = FRINGED(hit.sampled && part >= VELUM_PART_HEM && part < VELUM_PART_FALL, false);
        /* Where bounds are known, steps begin there, and are sampled by their offset; ranks are not known as well. */
        float own = within || hangs ? gap : 0.0;
        advance = looking ? min(advance, uniform_layer || extinction > 0.0 ? 0.0 : own) : advance;

        float start_m = position;

        bool found = extinction > 2.0e-6 * f.extinction_1_m;
        float deep_m = max(hit.span_m.y - hit.span_m.x, 1.0);
        float layer_m = max(layer_share * deep_m / max(abs(rise), 1.0e-3), min(dt_min, thin_share * deep_m));
        /* Over a base rims are thin: a step that comes from far below ends there, and those from there on grow by and by, with
         * no leap from one height to the next, or channels would step otherwise along the same ray. */
        float over_base_m = h0 - hit.span_m.x;
        float foot_m = max(-over_base_m, over_base_m + foot_share * (hit.span_m.y - hit.span_m.x));
        float in_m = rise > 0.0 && h1 > hit.span_m.x && !hit.smooth_part ? max(foot_m / rise, foot_least * dt_min) : 1.0e9;
        layer_m = min(layer_m, in_m);
        float rare = max(sqrt(min(max(f.coverage, 0.0) / rare_cover, 1.0)), rare_least);
        layer_m = STUDIED(layer_m, rare < 1.0 ? min(layer_m, rare * dt_min + at * growth) : layer_m);
        layer_m = uniform_layer ? 1.0e9 : layer_m;
        allowed = looking ? min(allowed, layer_m) : allowed;
        /* A long step would pass over a cloud's edge. */
        float least_m = within && !found && !is_short ? clamp(1.5 * gap, 0.3 * dt, dt) : dt;
        float own_stride = covered ? clamp(clear, least_m, STUDIED(max(dt, long_dt), long_dt)) : least_m;
        stride = looking ? min(stride, within ? own_stride : dt) : stride;
        /* What has counted for the step is not counted again. */
        bool passes = looking && !counted && !is_short && dt > 1.5 * layer_m * hurry;
        bool goes_back = !passes && found && !is_short && !uniform_layer && !glides;
        bool ends = passes || goes_back || meets == 0u; /* the step: else its next layer is looked at */
        /* Layers that the step is not within cost little, and forecasts have many. */
        left -= ends || hit.sampled ? 1 : 0;
        if (passes) {
            found = false;
            longest = allowed;
            allowed = 1.0e9;
        } else if (goes_back) {
            short_until = position + dt;
            position = max(at - dt, settled);
            found = false;
        } else if (ends) {
            short_until = found && !glides ? max(short_until, position + 0.6 * long_dt) : short_until;
            bool whole = found || counted;
            settled = STUDIED(whole || study_crossed(is_short), whole) ? position + dt : settled;
            longest = allowed < 1.0e8 ? allowed : 2.0 * longest;
            allowed = 1.0e9;
            stride = stride < 1.0e8 ? min(stride, max(dt, clear_to)) : dt;
            float moved_m = STUDIED(whole || study_flag(VELUM_STUDY_STEP_THROUGH), whole) ? dt : max(stride, advance);
            position += moved_m;
#ifdef VELUM_FRINGED
            room -= moved_m;
#endif
        }
        counted = !ends && (counted || found);
        dense_1_m = ends && denser_1_m > 0.0 ? denser_1_m : dense_1_m;
        denser_1_m = ends ? 0.0 : denser_1_m;
        stride = ends ? 1.0e9 : stride;
        advance = ends ? 1.0e9 : advance;
        clear_to = ends ? 1.0e9 : clear_to;
        done = ends ? 0u : done;
        extinction = found ? extinction : 0.0;
        alive = position < end && left > 0;

        float depth = extinction * max(min(dt, end - start_m), 0.0);
        float step_t = exp(-depth);
        float alpha = through * velum_opacity(depth, step_t);
        /* Light of a step comes from its first mean free paths, on the mean: its sample lies deeper by this share of it. */
        float met = entry_share * depth;
        float dense = max(met, 0.1);
        float deeper_by = met < 0.1 ? met / 12.0 : 0.5 - 1.0 / dense + 1.0 / (exp(dense) - 1.0);
        float lit_at = uniform_layer || STUDIED(study_at_point(), false) ? at : max(at - dt * deeper_by, 0.0);
#ifdef VELUM_STUDY
        /* Behind most of the cloud's opacity the light found last will do. */
        bool shows = study_flag(VELUM_STUDY_LIGHT_ALL) || through > dim;
        bool wanted = extinction > 0.0 && (shows || !is_lit || uniform_layer);
        int light_steps = wanted ? study_sun_steps(int(view.steps.y)) : 0;
        light_steps *= is_fringe(hit) ? fringe_sun_steps : 1;
        light_samples += uint(light_steps);
        float place_m = 0.0;
        cloud_hit lit = hit;
        if (wanted && lit_at < at) {
            lit.r += ray.direction * (lit_at - at);
            lit.at_h_m += rise * (lit_at - at);
            cloud_look(lit, looking, lit_at, false);
        }
        if (wanted) {
            source = cloud_source(lit, phases, light_steps, place_m);
        }
        is_lit = is_lit || wanted;
        light += study_share(through, depth) * source;
        weighted += alpha * min(lit_at + place_m, end);
#else
        /* A ray's opacity falls to a few places, each drawn from its part of it by its share. */
        bool deeper = through < until;
        bool alone = place.z > alone_least;
        bool veil = slot == VELUM_SLOT_HIGH;
        bool even = uniform_layer || veil;
        bool beyond = !even && !is_fringe(hit) && start_m > (1.0 + apart_share) * left_m + apart_least_m;
        bool apart = alone && beyond;
        bool left_behind = alone && ((lately | newly) & (1u << uint(place.w))) == 0u;
        bool other = apart || (float(part) != place.w && (uniform_layer || left_behind));
        bool fits = places < of.places && (deeper || other);
        bool opens = alpha > 0.0 && (places == 0u || fits);
        if (opens && places > 0u) {
            lit[first_place + places - 1u] = pack_place(place);
        }
        bool is_last = veil && (others_top_m == none_m || (rise > 0.0 && h > others_top_m));
        kept = opens && ((other && !deeper) || is_last) ? 0u : kept;
        uint parts = max(of.places - min(kept + places, of.places), 1u);
        until = opens ? through - through * part_share(places, parts, veil) : until;
        places += opens ? 1u : 0u;
        left_m = alpha > 0.0 && !uniform_layer ? start_m + dt : left_m;
        place.z = (opens ? 0.0 : place.z) + alpha;
        drawn_from = (opens || (beyond && !alone) ? 0.0 : drawn_from) + alpha;
        float share = alpha / max(drawn_from, 1.0e-20);
        bool takes = alpha > 0.0 && (opens || pick < share);
        pick = alpha <= 0.0 ? pick : takes ? pick / share : (pick - share) / (1.0 - share);
        /* Light fades along a ray: what one part is shown too bright by, the next is too dark by. */
        float new_pick = (places & 1u) != 0u ? first_pick : 1.0 - first_pick;
        pick = opens ? new_pick : pick;
        newly |= alpha > 0.0 ? 1u << uint(part) : 0u;
        lately = ends ? newly : lately;
        newly = ends ? 0u : newly;
        /* Steps through a uniform layer are one, whose light is known over any; those through a shaft are lit as one. */
        bool on = FRINGED(part >= VELUM_PART_FALL && start_m < place.x + place.y * (1.0 - offset) + dt, false);
        bool joins = alpha > 0.0 && (uniform_layer || on) && !opens && float(part) == place.w;
        float joined_m = start_m + dt - (place.x - offset * place.y);
        float joined_at = start_m + dt - joined_m * (1.0 - offset);
        weighted += joins && uniform_layer ? place.z * joined_at - (place.z - alpha) * place.x : alpha * lit_at;
        place.xyw = joins ? vec3(joined_at, joined_m, place.w) : takes ? vec3(lit_at, dt, float(part)) : place.xyw;
#endif
        weight += alpha;
        through *= step_t;
        if (through < STUDIED(view.study_limits.z, opaque)) {
            through = 0.0;
            alive = false;
        }
    }

    float distance_m = weight > 1.0e-4 ? weighted / weight : 0.0;
#ifdef VELUM_STUDY
    light = air_before_cloud(ray.origin, ray.direction, light, through, distance_m, weight > 0.0);
    imageStore(light_out, block, vec4(min(light / VELUM_LUMINANCE_UNIT, vec3(most_half)), through));
#else
    if (places > 0u) {
        lit[first_place + places - 1u] = pack_place(place);
    }
    if (of.which != 0u) {
        lit[first_place - 1u] = pack_place(vec4(distance_m, through, weight, float(places)));
    } else {
        imageStore(light_out, block, vec4(float(places), weight, 0.0, through));
    }
    uint before = subgroupExclusiveAdd(places);
    uint all = subgroupAdd(places);
    uint list_first = 0u;
    if (subgroupElect()) {
        list_first = atomicAdd(lit_count, all);
        atomicMax(lit_rows, listed_rows(list_first + all));
    }
    list_first = subgroupMax(list_first) + before;
    for (uint i = 0u; i < places; ++i) {
        lit_list[list_first + i] = first_place + i;
    }
#endif
    if (of.which == 0u) {
        imageStore(distance_out, block, vec4(distance_m));
    }

    uint ray_count = subgroupAdd(1u);
    samples = subgroupAdd(samples);
    uint misses = subgroupAdd(missing ? 1u : 0u);
#ifdef VELUM_STUDY
    light_samples = subgroupAdd(light_samples);
#endif
    if (subgroupElect()) {
        atomicAdd(counters[0], ray_count);
        atomicAdd(counters[1], samples);
#ifdef VELUM_STUDY
        atomicAdd(counters[2], light_samples);
#endif
        atomicAdd(counters[3], misses);
    }
}
