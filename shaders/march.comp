#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* One ray for each block of pixels: light of cloud and of the air before it, transmittance of cloud, mean distance. */
#include "air.glsl"
#include "view.glsl"
#include "weather.glsl"
#include "scattering.glsl"
#include "shared/slab.h"
#include "study.glsl"
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
const float dim = 0.3;
/* A ray gives up where so little comes through; the rest is taken as none. */
const float opaque = 0.0015;

/* Software devices run both sides of every branch, but leave a loop when all their lanes have. So all that is dear
 * stands in loops that run once or not at all, and no lane waits for another's cloud: one loop seeks and lights. */

/* What holds along a ray: its angle to the sun never changes. */
struct ray_phases {
    float water, ice; /* first order */
    float widened;    /* orders that keep near the forward peak */
    float diffuse;    /* what has turned, times 4 pi */
    float cos_sun;
};

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

/* What the search found. */
struct cloud_hit {
    int slot;
    velum_slot_fields fields;
    velum_profile profile;
    float excess;
    float margin; /* velum_margin */
    float extinction_1_m;
    vec3 r;
    vec3 normal;
    float height_m;
    float at_h_m, rise;       /* of the sample: height; metres that the ray gains a metre */
    float before_m, after_m; /* of the step, about the sample */
};

/* Optical depth of a slot's cloud from r towards the sun: few steps, each longer than the one before; the fields are
 * those of r. */
float sun_depth(cloud_hit hit, float mu_sun, int steps, float start) {
    velum_slot_fields f = hit.fields;
    float thickness = max(f.top_m - f.base_m, 1.0);
    float ahead = min((f.top_m - hit.height_m) / max(mu_sun, 0.06), 2.5 * thickness + 1500.0);
    /* The first is short enough for the next lump's shadow, however deep the cloud. */
    const float first_m = 90.0;
    float count = float(max(steps, 2));
    float ratio = max(pow(max(ahead, 1.0) / (1.3 * first_m), 1.0 / (count - 1.0)), 1.4);
    float dt = max(ahead, 0.0) * (ratio - 1.0) / (pow(ratio, count) - 1.0);
    float depth = 0.0;
    float done = 0.0;
    for (int i = 0; i < steps; ++i) {
        float t = done + dt * (i == 0 ? start : 0.5);
        float h = hit.height_m + t * mu_sun;
        vec3 p = hit.r + eye.sun.xyz * t;
        float z = clamp((h - f.base_m) / thickness, 0.0, 1.0);
        float e = velum_excess(hit.profile, f.coverage, column_rank(hit.slot, f, p, hit.normal, h));
        float lump = 0.0;
        for (int once = STUDIED(study_sun_lumps(), true) ? 0 : 1; once < 1; ++once) {
            lump = lump_noise(hit.slot, f, p);
        }
        float body = velum_body(hit.profile, e, z, h - f.base_m, lump, STUDIED(study_sun_fine(hit.slot, f, p), 0.5));
        depth += e > 0.0 && z > 0.0 && z < 1.0 ? body * dt : 0.0;
        done += dt;
        dt *= ratio;
    }
    return depth * f.extinction_1_m;
}

velum_slab_span slab_span(cloud_hit hit) {
    return velum_slab_within(hit.at_h_m, hit.rise, hit.fields.base_m, hit.fields.top_m, hit.before_m, hit.after_m);
}

/* What the eye gets of a uniform layer from a step, over what the step takes. */
velum_slab_light slab_light(cloud_hit hit, velum_slab_span span, float mu_sun) {
    velum_slot_fields f = hit.fields;
    bool at_point = STUDIED(study_at_point(), false);
    float first = clamp(velum_height_along(hit.at_h_m, hit.rise, span.from_m), f.base_m, f.top_m);
    float last = clamp(velum_height_along(hit.at_h_m, hit.rise, span.to_m), f.base_m, f.top_m);
    first = at_point ? hit.height_m : first;
    last = at_point ? hit.height_m : last;
    float to_sun = eye.slots[hit.slot].optics.z * f.extinction_1_m / max(mu_sun, 1e-3);
    return velum_slab_light_of(at_point ? 0.0 : f.extinction_1_m * span.inside_m, to_sun * (f.top_m - first),
                               to_sun * (f.top_m - last));
}

/* Light scattered towards the eye by cloud, per unit of scattering: luminance per 1/m. `place_m`: how far beyond the
 * sample it comes from, if that is known better. */
vec3 cloud_source(cloud_hit hit, ray_phases phases, int steps, float start, inout float place_m) {
    velum_slot_fields f = hit.fields;
    bool uniform_layer = hit.slot >= VELUM_SLOT_UNIFORM;
    float mu_sun = dot(hit.normal, eye.sun.xyz);
    float thickness = max(f.top_m - f.base_m, 1.0);
    vec3 sun = eye.sun_lx.rgb * sun_through_air(hit.height_m, mu_sun);
    float depth = STUDIED(study_sun_depth(hit.r, sun_depth(hit, mu_sun, steps, start)),
                          sun_depth(hit, mu_sun, steps, start));

    /* How high this column's cloud stands, and how much of it lies above and below. */
    float reach = pow(clamp(hit.excess / max(hit.profile.reach, 0.05), 0.0, 1.0), 1.0 / max(hit.profile.power, 0.1));
    float column = f.extinction_1_m * hit.profile.density_scale * thickness * max(reach, 0.1);
    float z = clamp((hit.height_m - f.base_m) / thickness, 0.0, 1.0);
    float above = clamp((reach - z) / max(reach, 0.05), 0.0, 1.0);
    /* Light that has turned comes by the nearest way out, and that is often the flank: about a tenth of the noise's
     * period from hem to heart. */
    float flank = f.extinction_1_m * hit.profile.density_scale * hit.margin * 0.09 / eye.slots[hit.slot].shape_0.w;
    /* Orders of scattering: the first by its own phase, those that keep near the forward peak by a widened one, the
     * rest as diffuse light that falls off as 1 / depth (two streams). */
    float first = (hit.slot == VELUM_SLOT_HIGH ? phases.ice : phases.water) * exp(-depth);
    float widened = phases.widened * exp(-0.30 * depth) * (1.0 - exp(-0.25 * (column + depth)));
    float thick = 1.0 - exp(-0.10 * (column + depth));
    float diffuse = phases.diffuse * thick / (1.0 + 0.07 * min(depth, 50.0 + 3.0 * flank));
    float orders = first + 0.55 * widened + 1.9 * VELUM_INV_4PI * diffuse;
    /* Sky above and ground below, each dimmed by the cloud that lies between. */
    vec3 from_above = ambient_at(hit.height_m, false) / (1.0 + 0.10 * min(column * above, flank));
    vec3 from_below = ambient_at(hit.height_m, true) / (1.0 + 0.10 * min(column * z, flank));
    vec3 source = sun * orders + (from_above + from_below) * 0.5;

    /* A uniform layer is what the table is made for. */
    float g = eye.slots[hit.slot].optics.y;
    float albedo = eye.slots[hit.slot].optics.x;
    for (int once = uniform_layer ? 0 : 1; once < 1; ++once) {
        velum_slab_span span = slab_span(hit);
        velum_slab_light light = slab_light(hit, span, mu_sun);
        int which = hit.slot - VELUM_SLOT_UNIFORM;
        float depth = f.extinction_1_m * span.inside_m;
        vec3 above = ambient_at(hit.height_m, false);
        vec3 below = ambient_at(hit.height_m, true);
        source = sun * albedo * velum_phase_hg(phases.cos_sun, g) * light.direct;
        /* Two points of Gauss and Legendre over the light that the step takes. */
        for (int i = 0; i < 2; ++i) {
            float share = velum_slab_share(depth, i == 0 ? 0.21132487 : 0.78867513);
            float h = velum_height_along(hit.at_h_m, hit.rise, mix(span.from_m, span.to_m, share));
            h = STUDIED(study_at_point() ? hit.height_m : h, h);
            float over = f.extinction_1_m * max(f.top_m - h, 0.0);
            float under = f.extinction_1_m * max(h - f.base_m, 0.0);
            vec2 sky = scattered_sky(which, over, under, -hit.rise);
            source += 0.5 * (sun * scattered_sun(which, over, under, mu_sun, -hit.rise, phases.cos_sun) +
                             above * sky.x + below * sky.y);
        }
        float seen_m = mix(span.from_m, span.to_m, light.place);
        place_m = STUDIED(study_at_point() ? place_m : seen_m, seen_m);
    }
#ifdef VELUM_STUDY
    for (int once = study_octaves() ? 0 : 1; once < 1; ++once) {
        bool ice = hit.slot == VELUM_SLOT_HIGH;
        study_light theirs;
        theirs.sun = sun;
        theirs.above = uniform_layer ? vec3(0.0) : ambient_at(hit.height_m, false);
        theirs.below = uniform_layer ? vec3(0.0) : ambient_at(hit.height_m, true);
        theirs.cos_sun = phases.cos_sun;
        theirs.g = uniform_layer ? g : ice ? study_g_ice : study_g_water;
        theirs.first = uniform_layer ? velum_phase_hg(phases.cos_sun, g) : ice ? phases.ice : phases.water;
        theirs.depth = uniform_layer ? f.extinction_1_m * max(f.top_m - hit.height_m, 0.0) / max(mu_sun, 1e-3) : depth;
        theirs.depth_above = min(column * above, flank);
        theirs.depth_below = min(column * z, flank);
        source = study_octave_source(theirs) * (uniform_layer ? albedo : 1.0);
    }
#endif
    return source;
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

    ray_phases phases;
    phases.cos_sun = dot(ray.direction, eye.sun.xyz);
    phases.water = velum_phase_cloud(phases.cos_sun, false);
    phases.ice = velum_phase_cloud(phases.cos_sun, true);
    phases.widened = velum_phase_hg(phases.cos_sun, 0.55);
    phases.diffuse = 0.62 + 0.38 * velum_phase_hg(phases.cos_sun, 0.25) / VELUM_INV_4PI;

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
    float settled = position; /* light and transmittance hold up to here */

    while (alive) {
        cloud_hit hit;
        hit.extinction_1_m = 0.0;
        bool is_short = STUDIED(study_all_alike() || position < short_until, position < short_until);
        /* Longer as they run out, so that a ray comes to its end. */
        float spent = 1.0 - float(left) / float(view.steps.x);
        float long_dt = max(dt_min, position * growth) * (1.0 + 4.0 * spent * spent * spent);
        float dt = min(is_short ? long_dt * short_share : STUDIED(long_dt * view.study_limits.x, long_dt), end - position);
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
        for (uint rest = eye.table.z; rest != 0u; rest &= rest - 1u) {
            int candidate = findLSB(rest);
            vec4 bounds = eye.slots[candidate].bounds;
            uint bit = 1u << uint(candidate);
            bool outside = high < bounds.x || low > bounds.y;
            bool here = (tile.mask & bit) != 0u;
            float away = outside ? reach_bounds(h, rise, bounds.x, bounds.y) - 1.0 : 1.0e9;
            clear_tile = clear_tile || (!outside && !here);
            advance = min(advance, away);
            bool fresh = !outside && here && (done & bit) == 0u;
            meets |= fresh ? bit : 0u;
        }
        /* Of two uniform layers in one step the nearer comes first; they come last. */
        int slot = meets != 0u ? findLSB(meets) : 0;
        slot = meets == sheets && rise < 0.0 ? VELUM_SLOT_UNIFORM_2 : slot;
        bool looking = meets != 0u;
        done |= looking ? 1u << uint(slot) : 0u;
        meets &= ~(1u << uint(slot));

        velum_slot_fields f = slot_fields(tile, slot, looking);
        bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
        float thickness = max(f.top_m - f.base_m, 1.0);
        float z = (h - f.base_m) / thickness;
        bool within = looking && z > 0.0 && z < 1.0 && f.coverage > 0.0;
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
        /* Sharp faces: the share of the step that lies within them. */
        hit.fields = f;
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
        float climb = min(0.7 * reach_bounds(h, rise, f.base_m, f.top_m), min(0.1 * at + 500.0, texel_m));
        float own = f.coverage <= 0.0 ? reach_m.y : (within ? gap : climb);
        advance = looking ? min(advance, uniform_layer || extinction > 0.0 ? 0.0 : own) : advance;

        hit.slot = slot;
        hit.profile = profile;
        hit.excess = e;
        hit.margin = max(margin, 0.0);
        hit.r = r;
        hit.normal = normal;
        hit.height_m = uniform_layer ? clamp(h, f.base_m, f.top_m) : h;
        float start_m = position;

        bool found = extinction > 2.0e-6 * f.extinction_1_m;
        --left;
        if (found && !is_short && !uniform_layer) {
            short_until = position + dt;
            position = max(at - dt, settled);
            found = false;
            advance = 1.0e9;
            done = 0u;
        } else if (meets == 0u) {
            short_until = found ? max(short_until, position + 0.6 * long_dt) : short_until;
            settled = STUDIED(found || study_crossed(is_short), found) ? position + dt : settled;
            /* Beside a cloud, shorter ones: a long step would pass over its edge. */
            float share = within && !found && !is_short ? clamp(1.5 * gap / dt, 0.3, 1.0) : 1.0;
            float stride = covered ? clamp(clear, dt * share, STUDIED(max(dt, long_dt), long_dt)) : dt * share;
            position += STUDIED(found || study_flag(VELUM_STUDY_STEP_THROUGH), found) ? dt : max(stride, advance);
            advance = 1.0e9;
            done = 0u;
        }
        hit.extinction_1_m = found ? extinction : 0.0;
        alive = position < end && left > 0;

        /* Behind most of the cloud's opacity the light found last will do. */
        bool wanted = hit.extinction_1_m > 0.0 && (STUDIED(study_flag(VELUM_STUDY_LIGHT_ALL) || through > dim, through > dim) || !lit || hit.slot >= VELUM_SLOT_UNIFORM);
        int light_steps = wanted ? STUDIED(study_sun_steps(int(view.steps.y)), int(view.steps.y)) : 0;
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
