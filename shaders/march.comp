#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* One ray for each block of pixels: light of cloud and of the air before it, transmittance of cloud, mean distance. */
#include "air.glsl"
#include "view.glsl"
#include "weather.glsl"
#include "shared/phase.h"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT, rgba16f) uniform writeonly image2D light_out;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE, r32f) uniform writeonly image2D distance_out;
layout(set = 1, binding = VELUM_BIND_COUNTERS, std430) buffer counter_buffer {
    uint counters[4];
};

/* A ray gives up where so little comes through; the rest is taken as none. */
const float opaque = 0.0015;

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

/* Optical depth of a slot's cloud from r towards the sun: few steps, each longer than the one before; the fields are
 * those of r. */
float sun_depth(int slot, velum_slot_fields f, velum_profile profile, vec3 r, float height_m, vec3 normal,
                float mu_sun, int steps, float start) {
    float thickness = f.top_m - f.base_m;
    float ahead = (f.top_m - height_m) / max(mu_sun, 0.06);
    ahead = min(ahead, thickness * 3.0 + 1500.0);
    float depth = 0.0;
    float done = 0.0;
    float first = 60.0;
    float share = 1.0;
    /* geometric from `first`: sum = first (q^n - 1) / (q - 1) = ahead */
    float q = ahead > first * float(steps) ? pow(ahead / first, 1.0 / float(steps)) : 1.0;
    float total = q > 1.0 ? (pow(q, float(steps)) - 1.0) / (q - 1.0) : float(steps);
    float dt = ahead / total;
    for (int i = 0; i < steps; ++i) {
        float t = done + dt * (i == 0 ? start : 0.5);
        float h = height_m + t * mu_sun;
        vec3 p = r + eye.sun.xyz * t;
        float z = (h - f.base_m) / thickness;
        if (z > 0.0 && z < 1.0) {
            float e = velum_excess(profile, f.coverage, column_rank(slot, f, p, normal, h));
            if (e > 0.0) {
                float lump = i < 3 ? lump_noise(slot, f, p) : 0.0;
                depth += f.extinction_1_m * velum_body(profile, e, z, h - f.base_m, lump, 0.5) * dt;
            }
        }
        done += dt;
        dt *= q;
    }
    return depth;
}

/* Light scattered towards the eye by cloud at r, per unit of scattering: luminance per 1/m. */
vec3 cloud_source(int slot, velum_slot_fields f, velum_profile profile, float excess, vec3 r, float height_m,
                  vec3 normal, ray_phases phases, float start) {
    float mu_sun = dot(normal, eye.sun.xyz);
    float thickness = max(f.top_m - f.base_m, 1.0);
    vec3 sun = eye.sun_lx.rgb * sun_through_air(height_m, mu_sun);
    if (slot >= VELUM_SLOT_UNIFORM) {
        float g = eye.slots[slot].optics.y;
        float depth = f.extinction_1_m * max(f.top_m - height_m, 0.0) / max(mu_sun, 1e-3);
        float diffuse = 1.0 / (1.0 + 0.75 * (1.0 - g) * depth);
        float share = 1.0 - exp(-0.1 * f.extinction_1_m * thickness);
        return sun * (velum_phase_hg(phases.cos_sun, g) * exp(-depth) +
                      share * 2.2 * VELUM_INV_4PI * max(diffuse - exp(-depth), 0.0));
    }
    float depth = sun_depth(slot, f, profile, r, height_m, normal, mu_sun, int(view.steps.y), start);
    /* How high this column's cloud stands, and how much of it lies above and below. */
    float reach = pow(clamp(excess / max(profile.reach, 0.05), 0.0, 1.0), 1.0 / profile.power);
    float column = f.extinction_1_m * profile.density_scale * thickness * max(reach, 0.1);
    float z = (height_m - f.base_m) / thickness;
    float above = clamp((reach - z) / max(reach, 0.05), 0.0, 1.0);
    /* Orders of scattering: the first by its own phase, those that keep near the forward peak by a widened one, the
     * rest as diffuse light that falls off as 1 / depth (two streams). */
    float first = (slot == VELUM_SLOT_HIGH ? phases.ice : phases.water) * exp(-depth);
    float widened = phases.widened * exp(-0.30 * depth) * (1.0 - exp(-0.25 * (column + depth)));
    float thick = 1.0 - exp(-0.10 * (column + depth));
    float diffuse = phases.diffuse * thick / (1.0 + 0.07 * depth);
    float orders = first + 0.55 * widened + 1.9 * VELUM_INV_4PI * diffuse;
    /* Sky above and ground below, each dimmed by the cloud that lies between. */
    vec3 from_above = ambient_at(height_m, false) / (1.0 + 0.10 * column * above);
    vec3 from_below = ambient_at(height_m, true) / (1.0 + 0.10 * column * clamp(z, 0.0, 1.0));
    return sun * orders + (from_above + from_below) * 0.5;
}

void main() {
    ivec2 block = ivec2(gl_GlobalInvocationID.xy);
    if (block.x >= int(view.march_size.x) || block.y >= int(view.march_size.y)) {
        return;
    }
    int side = int(view.march_size.z);
    ivec2 inside = ivec2(int(view.frame.x) % side, int(view.frame.x) / side);
    ivec2 pixel = min(block * side + inside, ivec2(view.size.xy) - 1);
    view_ray ray = view_ray_at(vec2(pixel) + 0.5);

    float end = view.march.z;
    float hit = host_distance(pixel, ray);
    if (hit < 0.0) {
        hit = ground_distance(ray.origin, ray.direction);
    }
    if (hit >= 0.0) {
        end = min(end, hit);
    }
    velum_span shell = velum_sphere_span(eye_geometry(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                         ray.direction.y, ray.direction.z, eye.span.y * VELUM_SCALE_Z + 1.0);
    float t = max(shell.enter_m, 0.0);
    end = shell.enter_m > shell.leave_m ? -1.0 : min(end, shell.leave_m);
    velum_span hollow = velum_sphere_span(eye_geometry(), ray.origin.x, ray.origin.y, ray.origin.z, ray.direction.x,
                                          ray.direction.y, ray.direction.z, max(eye.span.x - 1.0, -1000.0));
    if (hollow.enter_m <= hollow.leave_m && hollow.enter_m <= 0.0 && hollow.leave_m > 0.0) {
        t = max(t, hollow.leave_m);
    }

    vec3 light = vec3(0.0);
    float through = 1.0;
    float weighted = 0.0;
    float weight = 0.0;
    uint samples = 0u;
    uint light_samples = 0u;
    bool missing = false;
    bool clear = (eye.table.z == 0u);

    float offset = fract(view.march.w + float((pixel.x & 3) * 4 + (pixel.y & 3)) * 0.3125);
    ray_phases phases;
    phases.cos_sun = dot(ray.direction, eye.sun.xyz);
    phases.water = velum_phase_cloud(phases.cos_sun, false);
    phases.ice = velum_phase_cloud(phases.cos_sun, true);
    phases.widened = velum_phase_hg(phases.cos_sun, 0.55);
    phases.diffuse = 0.62 + 0.38 * velum_phase_hg(phases.cos_sun, 0.25) / VELUM_INV_4PI;
    int limit = int(view.steps.x);
    float dt_min = view.march.x;
    float growth = view.march.y;
    /* Steps tile the ray from its start; each is sampled at the same share of its length. */
    float position = t;
    for (int i = 0; i < limit && position < end && !clear; ++i) {
        float dt = max(dt_min, position * growth);
        float at = position + dt * offset;
        vec3 r = ray.origin + ray.direction * at;
        velum_place place = place_of(r);
        vec3 normal = vec3(place.nx, place.ny, place.nz);
        float rise = dot(normal, ray.direction);
        float h = place.height_m;
        tile_place tile = tile_find(normal, at);
        missing = missing || tile.missing;

        float total = 0.0;
        vec3 source = vec3(0.0);
        float advance = 1.0e9; /* from here on, how far nothing can begin */
        float h_end = h + rise * dt * (1.0 - offset);
        float h_begin = h - rise * dt * offset;
        for (int slot = 0; slot < VELUM_SLOT_COUNT; ++slot) {
            if ((eye.table.z & (1u << uint(slot))) == 0u) {
                continue;
            }
            vec4 bounds = eye.slots[slot].bounds;
            if (max(h_begin, h_end) < bounds.x || min(h_begin, h_end) > bounds.y) {
                advance = min(advance, reach_bounds(h, rise, bounds.x, bounds.y) - 1.0);
                continue;
            }
            if ((tile.mask & (1u << uint(slot))) == 0u) {
                /* The next tile begins no nearer than it pleases: tiles are an eighth of the distance or more. */
                advance = min(advance, 0.05 * at);
                continue;
            }
            velum_slot_fields f = slot_fields(tile, slot);
            if (f.coverage <= 0.0) {
                advance = min(advance, 0.05 * at);
                continue;
            }
            if (slot >= VELUM_SLOT_UNIFORM) {
                /* Sharp faces: the share of the step that lies within them. */
                float low = min(h_begin, h_end);
                float high = max(h_begin, h_end);
                float overlap = high - low > 0.01 ? clamp((min(high, f.top_m) - max(low, f.base_m)) / (high - low), 0.0, 1.0)
                                                  : (h >= f.base_m && h <= f.top_m ? 1.0 : 0.0);
                float extinction = f.coverage >= 0.5 ? f.extinction_1_m * overlap : 0.0;
                if (extinction > 0.0) {
                    velum_profile none;
                    total += extinction;
                    source += extinction * eye.slots[slot].optics.x *
                              cloud_source(slot, f, none, 1.0, r, clamp(h, f.base_m, f.top_m), normal, phases, 0.5);
                }
                advance = 0.0;
                continue;
            }
            float z = (h - f.base_m) / max(f.top_m - f.base_m, 1.0);
            if (z <= 0.0 || z >= 1.0) {
                advance = min(advance, min(0.7 * reach_bounds(h, rise, f.base_m, f.top_m), 0.1 * at + 500.0));
                continue;
            }
            velum_profile profile = velum_profile_of(slot, f);
            float rank = column_rank(slot, f, r, normal, h);
            ++samples;
            float e = velum_excess(profile, f.coverage, rank);
            if (e <= 0.0) {
                /* The rank rises by at most about 1 over an eighth of the period. */
                float gap = -e * f.coverage;
                advance = min(advance, 0.4 * gap / (8.0 * eye.slots[slot].shape_0.w));
                continue;
            }
            advance = 0.0;
            float lump = lump_noise(slot, f, r);
            float fine = 0.5;
            if (velum_shows_fine(at, eye.slots[slot].fine_0.w)) {
                fine = fine_noise(slot, f, r);
            }
            float extinction = f.extinction_1_m * velum_body(profile, e, z, h - f.base_m, lump, fine);
            if (extinction > 1.0e-7) {
                total += extinction;
                light_samples += view.steps.y;
                source += extinction *
                          cloud_source(slot, f, profile, e, r, h, normal, phases, 0.25 + 0.5 * offset);
            }
        }
        if (total > 0.0) {
            float length_m = min(dt, end - position);
            float step_t = exp(-total * length_m);
            vec3 gained = source / total * (1.0 - step_t);
            light += through * gained;
            float alpha = through * (1.0 - step_t);
            weighted += alpha * min(at, end);
            weight += alpha;
            through *= step_t;
            if (through < opaque) {
                through = 0.0;
                break;
            }
            position += dt;
        } else {
            position = max(position + dt, at + advance);
        }
    }

    float distance_m = weight > 1.0e-4 ? weighted / weight : 0.0;
    if (weight > 0.0 && eye.ground.w != 0.0) {
        /* Air before the cloud: it dims, and shines in the share that the cloud covers. */
        air_light air = air_march(ray.origin, ray.direction, max(distance_m, 1.0), 8, true);
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
