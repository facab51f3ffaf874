#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* One ray for each block of pixels: light of cloud and of the air before it, transmittance of cloud, mean distance. */
#include "air.glsl"
#include "view.glsl"
#include "weather.glsl"
#include "study.glsl"
#include "cloud_light.glsl"
#include "fringe.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT, rgba16f) uniform writeonly image2D light_out;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE, r32f) uniform writeonly image2D distance_out;
layout(set = 1, binding = VELUM_BIND_COUNTERS, std430) buffer counter_buffer {
    uint counters[4];
};

/* Both uniform layers, no other. */
const uint sheets = (1u << VELUM_SLOT_UNIFORM) | (1u << VELUM_SLOT_UNIFORM_2);

/* Of a long step. */
const float short_share = 0.18;
/* A long step rises or falls by no more than this share of a layer's thickness: from high above, clouds are wider than
 * they are deep. */
const float layer_share = 0.15;
const float dim = 0.3;
/* A ray gives up where so little comes through; the rest is taken as none. */
const float opaque = 0.0015;

/* Software devices run both sides of every branch, but leave a loop when all their lanes have. So all that is dear
 * stands in loops that run once or not at all, and no lane waits for another's cloud: one loop seeks and lights. */

/* Distance along a ray that rises by `rise` a metre until it can meet heights between low and high (curvature makes
 * every ray rise faster as it goes), or far beyond all. */
float reach_bounds(float h, float rise, float low, float high) {
    const float r = VELUM_WGS84_A_M;
    if (h < low) {
        return r * (sqrt(rise * rise + 2.0 * (low - h) / r) - rise);
    }
    if (h > high) {
        float inside = rise * rise - 2.0 * (h - high) / r;
        return rise < 0.0 && inside > 0.0 ? r * (-rise - sqrt(inside)) : 1.0e9;
    }
    return 0.0;
}

void main() {
    /* Eight neighbours in a row of invocations stand 4 x 2 in the picture: they go the same way more often. */
    uint lane = gl_LocalInvocationIndex & 7u;
    uint part = gl_LocalInvocationIndex >> 3u;
    ivec2 block = dealt_group() * VELUM_GROUP +
                  ivec2((part & 1u) * 4u + (lane & 3u), (part >> 1u) * 2u + (lane >> 2u));
    if (block.x >= int(view.march_size.x) || block.y >= int(view.march_size.y)) {
        return;
    }
    ivec2 side = ray_block_size();
    ivec2 pixel = min(block * side + ray_turn(block.y), ivec2(view.size.xy) - 1);
    view_ray ray = view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);

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

    ray_phases phases = ray_phases_of(dot(ray.direction, eye.sun.xyz));

    vec3 light = vec3(0.0);
    float through = 1.0;
    float weighted = 0.0;
    float weight = 0.0;
    uint samples = 0u;
    uint light_samples = 0u;
    bool missing = false;
    tile_place tile = tile_nowhere();

    /* Steps tile the ray; each is sampled at the same share of its length, another for each pixel and each round of
     * frames, in quarters: after four rounds all pixels, of whatever channel, have had the same. */
    float offset = fract(view.march.w + float((pixel.x + 2 * pixel.y) & 3) * 0.25);
    float dt_min = view.march.x;
    float growth = view.march.y;
    int left = int(view.steps.x);
    uint done = 0u;        /* slots already looked at in this step */
    float advance = 1.0e9; /* from the sample on, how far nothing can begin */
    bool alive = position < end && eye.table.z != 0u;
    /* Long steps look for cloud. What one finds is gone back to, and crossed in short ones: the face of a cumulus lies
     * within a few mean free paths. */
    vec3 source = vec3(0.0);
    bool lit = false;
    float short_until = 0.0;
    float longest = 1.0e9; /* long step, by the layers last met */
    float allowed = 1.0e9; /* by those that this step meets */
    float settled = position; /* light and transmittance hold up to here */
#ifdef VELUM_FRINGED
    float room = 0.0; /* from the last sample on, how far there is nothing but what falls */
    const float fall_stride = 2.0; /* of a long step there: that is smooth */
#endif

    while (alive) {
        cloud_hit hit;
        hit.extinction_1_m = 0.0;
        bool is_short = STUDIED(study_all_alike() || position < short_until, position < short_until);
        /* Longer as they run out, so that a ray comes to its end. */
        float spent = 1.0 - float(left) / float(view.steps.x);
        float hurry = 1.0 + 4.0 * spent * spent * spent;
        float long_dt = max(dt_min, min(position * growth, longest)) * hurry;
        float dt = is_short ? long_dt * short_share : STUDIED(long_dt * view.study_limits.x, long_dt);
#ifdef VELUM_FRINGED
        bool strides = !is_short && room > 2.2 * fall_stride * long_dt;
        dt = strides ? clamp(longest * hurry, dt, fall_stride * dt) : dt;
#endif
        dt = min(dt, end - position);
        float at = position + dt * offset;
        vec3 r = ray.origin + ray.direction * at;
        velum_place place = place_of(r);
        vec3 normal = vec3(place.nx, place.ny, place.nz);
        float h = place.height_m;
        float rise = dot(normal, ray.direction);
        float h0 = h - rise * dt * offset;
        float h1 = h + rise * dt * (1.0 - offset);
        float low = min(h0, h1);
        float high = max(h0, h1) + dt * dt * (0.5 / VELUM_WGS84_A_M);
        tile = tile_move(tile, normal, at);
        missing = missing || tile.missing;

        /* Which slots the step can meet; the lowest that has not been looked at is looked at now. */
        uint meets = 0u;
        bool clear_tile = false;
#ifdef VELUM_FRINGED
        room = 1.0e9;
#endif
        for (uint rest = FRINGED(eye.table.z | eye.table.w, eye.table.z); rest != 0u; rest &= rest - 1u) {
            int candidate = findLSB(rest);
            vec4 bounds = FRINGED(part_bounds(candidate), eye.slots[candidate].bounds);
            uint bit = 1u << uint(candidate);
            bool outside = high < bounds.x || low > bounds.y;
            bool here = (FRINGED(tile.mask | tile.parts, tile.mask) & bit) != 0u;
            float away = outside ? reach_bounds(h, rise, bounds.x, bounds.y) - 1.0 : 1.0e9;
            clear_tile = clear_tile || (!outside && !here);
            advance = min(advance, away);
#ifdef VELUM_FRINGED
            room = candidate < VELUM_PART_FALL ? min(room, outside ? away : 0.0) : room;
#endif
            bool fresh = !outside && here && (done & bit) == 0u;
            meets |= fresh ? bit : 0u;
        }
        /* Of two uniform layers in one step the nearer comes first; they come last. */
        int part = meets != 0u ? findLSB(meets) : 0;
#ifdef VELUM_FRINGED
        /* What is gone back to before what is not: nothing is lit twice. */
        uint sharp = meets & ~(sheets | all_fall);
        part = sharp != 0u ? findLSB(sharp) : part;
#endif
        part = meets == sheets && rise < 0.0 ? VELUM_SLOT_UNIFORM_2 : part;
        bool looking = meets != 0u;
        done |= looking ? 1u << uint(part) : 0u;
        meets &= ~(1u << uint(part));
        int slot = FRINGED(part & (VELUM_SLOT_COUNT - 1), part);
        bool fringed = FRINGED(part >= VELUM_PART_SCUD, false);
        bool falls = FRINGED(part >= VELUM_PART_FALL, false);

        velum_slot_fields f = slot_fields(tile, slot, looking);
        bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
        float thickness = max(f.top_m - f.base_m, 1.0);
        float z = (h - f.base_m) / thickness;
        bool within = looking && z > 0.0 && z < 1.0 && f.coverage > 0.0 && !fringed;
        velum_profile profile = velum_profile_of(slot, f);
        float e = velum_excess(profile, f.coverage, column_rank(slot, f, r, normal, h));
        /* A loop that runs once or not at all: what no lane of a software device needs, none pays for. */
        float lump = STUDIED(study_base(is_short) ? 1.0 : 0.0, 0.0);
        float fine = STUDIED(study_base(is_short) ? 1.0 : 0.5, 0.5);
        bool covered = within && e > 0.0;
        for (int once = STUDIED(covered && !study_base(is_short), covered) ? 0 : 1; once < 1; ++once) {
            lump = lump_noise(slot, f, r);
        }
        for (int once = STUDIED(covered && !study_base(is_short), covered) &&
                                velum_shows_fine(at, eye.slots[slot].fine_0.w)
                            ? 0
                            : 1;
             once < 1; ++once) {
            fine = fine_noise(slot, f, r);
        }
        float margin = velum_margin(profile, e, clamp(z, 0.0, 1.0), lump, fine);
        float body = velum_body(profile, e, clamp(z, 0.0, 1.0), h - f.base_m, lump, fine);
        float extinction = within && e > 0.0 ? f.extinction_1_m * body : 0.0;
#ifdef VELUM_STUDY
        extinction = study_thinned(extinction, f.extinction_1_m);
#endif
        samples += within ? 1u : 0u;
        vec2 span = vec2(f.base_m, f.top_m);
#ifdef VELUM_FRINGED
        for (int once = fringed && f.coverage > 0.0 ? 0 : 1; once < 1; ++once) {
            velum_fringe g = slot_fringe(tile, slot);
            span = part_span(part, f, g);
            for (int inside = h > span.x && h < span.y ? 0 : 1; inside < 1; ++inside) {
                extinction = part_extinction(part, f, profile, g, r, normal, h,
                                             velum_shows_fine(at, eye.slots[slot].fine_0.w));
                samples += 1u;
            }
            margin = 0.0;
            thickness = max(span.y - span.x, 1.0);
        }
#endif
        /* Sharp faces: the share of the step that lies within them. */
        hit.fields = f;
        hit.tile = tile;
        hit.at_h_m = h;
        hit.rise = rise;
        hit.before_m = dt * offset;
        hit.after_m = dt - hit.before_m;
        extinction = uniform_layer ? 0.0 : extinction;
        for (int once = uniform_layer && looking && f.coverage >= 0.5 ? 0 : 1; once < 1; ++once) {
            extinction = f.extinction_1_m * slab_span(hit).inside_m / dt;
        }

        /* The rank rises by at most about 1 over an eighth of the period; lumps and detail come and go faster. */
        float period_m = 1.0 / eye.slots[slot].shape_0.w;
        /* All for fields that do not change much: a page tells nothing beyond its next texel. */
        float texel_m = tile.side_m / float(VELUM_TILE_TEXELS);
        vec2 reach_m = vec2(1.0e9);
        for (int once = clear_tile || f.coverage <= 0.0 ? 0 : 1; once < 1; ++once) {
            reach_m = tile_reach_m(tile, normal, ray.direction);
        }
        advance = clear_tile ? min(advance, reach_m.x) : advance;
        float gap = min(max(-e, 0.0) * f.coverage * 0.05 * period_m, texel_m);
        float clear = covered ? min(max(-margin, 0.0) * 0.016 * period_m, texel_m) : 0.0;
        float climb = min(0.7 * reach_bounds(h, rise, span.x, span.y), min(0.1 * at + 500.0, texel_m));
        float own = f.coverage <= 0.0 ? reach_m.y : (within ? gap : climb);
        advance = looking ? min(advance, uniform_layer || extinction > 0.0 ? 0.0 : own) : advance;

        hit.slot = slot;
        hit.profile = profile;
        hit.excess = e;
        hit.margin = max(margin, 0.0);
        hit.across = FRINGED(fringed ? extinction * part_across_m(part) : 0.0, 0.0);
        hit.r = r;
        hit.normal = normal;
        hit.height_m = uniform_layer ? clamp(h, f.base_m, f.top_m) : h;
        float start_m = position;

        bool found = extinction > 2.0e-6 * f.extinction_1_m;
        --left;
        float layer_m = max(layer_share * thickness / max(abs(rise), 1.0e-3), dt_min);
        layer_m = f.coverage > 0.0 && !uniform_layer ? layer_m : 1.0e9;
        allowed = looking ? min(allowed, layer_m) : allowed;
        bool passes = looking && !is_short && dt > 1.5 * layer_m * hurry && low < span.y && high > span.x;
        if (passes) {
            found = false;
            longest = allowed;
            allowed = 1.0e9;
            advance = 1.0e9;
            done = 0u;
        } else if (found && !is_short && !uniform_layer && !falls) {
            short_until = position + dt;
            position = max(at - dt, settled);
            found = false;
            advance = 1.0e9;
            done = 0u;
        } else if (meets == 0u) {
            short_until = found && !falls ? max(short_until, position + 0.6 * long_dt) : short_until;
            settled = STUDIED(found || study_crossed(is_short), found) ? position + dt : settled;
            /* Beside a cloud, shorter ones: a long step would pass over its edge. */
            float share = within && !found && !is_short ? clamp(1.5 * gap / dt, 0.3, 1.0) : 1.0;
            float stride = covered ? clamp(clear, dt * share, STUDIED(max(dt, long_dt), long_dt)) : dt * share;
            longest = allowed < 1.0e8 ? allowed : 2.0 * longest;
            allowed = 1.0e9;
            position += STUDIED(found || study_flag(VELUM_STUDY_STEP_THROUGH), found) ? dt : max(stride, advance);
            advance = 1.0e9;
            done = 0u;
        }
        hit.extinction_1_m = found ? extinction : 0.0;
        alive = position < end && left > 0;

        /* Behind most of the cloud's opacity the light found last will do. */
        bool shows = STUDIED(study_flag(VELUM_STUDY_LIGHT_ALL) || through > dim, through > dim);
        bool wanted = hit.extinction_1_m > 0.0 && (shows || !lit || hit.slot >= VELUM_SLOT_UNIFORM);
        int light_steps = wanted ? STUDIED(study_sun_steps(int(view.steps.y)), int(view.steps.y)) : 0;
#ifdef VELUM_FRINGED
        /* The cloud over a shaft is far and uneven: few steps would draw its shadows as steps. */
        light_steps *= fringed ? 2 : 1;
#endif
        light_samples += uint(light_steps);
        float place_m = 0.0;
        for (int once = wanted ? 0 : 1; once < 1; ++once) {
            source = cloud_source(hit, phases, light_steps, 0.25 + 0.5 * offset, place_m);
        }
        lit = lit || wanted;
        float depth = hit.extinction_1_m * max(min(dt, end - start_m), 0.0);
        float step_t = exp(-depth);
        float alpha = through * velum_opacity(depth, step_t);
        light += STUDIED(study_share(through, depth), alpha) * source;
        weighted += alpha * min(at + place_m, end);
        weight += alpha;
        through *= step_t;
        if (through < STUDIED(view.study_limits.z, opaque)) {
            through = 0.0;
            alive = false;
        }
    }

    float distance_m = weight > 1.0e-4 ? weighted / weight : 0.0;
    /* Air before the cloud: it dims, and shines in the share that the cloud covers. */
    air_light air = air_march(ray.origin, ray.direction, max(distance_m, 1.0), weight > 0.0 ? 6 : 0, true);
    if (weight > 0.0 && eye.ground.w != 0.0) {
        light = light * air.transmittance + air.luminance * (1.0 - through);
    }
    imageStore(light_out, block, vec4(min(light / VELUM_LUMINANCE_UNIT, vec3(60000.0)), through));
    imageStore(distance_out, block, vec4(distance_m));

    uint rays = subgroupAdd(1u);
    samples = subgroupAdd(samples);
    light_samples = subgroupAdd(light_samples);
    uint misses = subgroupAdd(missing ? 1u : 0u);
    if (subgroupElect()) {
        atomicAdd(counters[0], rays);
        atomicAdd(counters[1], samples);
        atomicAdd(counters[2], light_samples);
        atomicAdd(counters[3], misses);
    }
}
