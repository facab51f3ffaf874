#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
/* Light of the places that the march has listed. */
#include "air_light.glsl"
#include "weather.glsl"
#include "cloud_light.glsl"
#include "due.glsl"
layout(local_size_x = VELUM_GROUP * VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_COUNTERS, std430) buffer counter_buffer {
    uint counters[4];
};

/* A stretch of what falls is lit at several places: it lies in the sun here, in its cloud's shade there. At one more for
 * so much more opacity, and at so many at most. */
const float fall_look_share = 1.0 / 12.0;
const int fall_looks_most = 3;

void main() {
    uint index = listed_index();
    if (index >= lit_count) {
        return;
    }
    uint place = lit_list[index];
    vec4 found = unpack_place(lit[place]);
    ivec2 pixel = pixel_of_place(place);
    view_ray ray = ray_of_pixel(pixel);
    float offset = step_offset(pixel);
    ray_phases phases = ray_phases_of(ray.direction);
    int part = int(found.w);
    bool falls = FRINGED(part >= VELUM_PART_FALL, false);
    int looks = falls ? clamp(int(ceil(found.z / fall_look_share)), 1, fall_looks_most) : 1;
    float piece_m = found.y / float(looks);
    float first_m = found.x - found.y * offset + piece_m * fract(float(looks) * offset);

    vec4 light = vec4(0.0); /* and how far beyond it comes from, m */
    float weight = 0.0;
    float through = 1.0;
    int steps = 0;
    for (int look = 0; look < looks; ++look) {
        float at = falls ? first_m + piece_m * float(look) : found.x;
        cloud_hit hit;
        hit.part = part;
        hit.slot = FRINGED(part & (VELUM_SLOT_COUNT - 1), part);
        hit.r = ray.origin + ray.direction * at;
        velum_place here = place_of(hit.r);
        hit.normal = vec3(here.nx, here.ny, here.nz);
        hit.at_h_m = here.height_m;
        hit.rise = dot(hit.normal, ray.direction);
        hit.before_m = found.y * offset;
        hit.after_m = found.y - hit.before_m;
        hit.tile = tile_find(hit.normal, at);
        bool there = FRINGED(!falls || (hit.tile.parts & (1u << uint(part))) != 0u, true);
        cloud_fields(hit, there);
        hit.profile = velum_profile_of(hit.slot, hit.fields);
        cloud_look(hit, there, at, false);

        float place_m = 0.0;
        int own_steps = int(view.steps.y) * (is_fringe(hit) && !falls ? fringe_sun_steps : 1);
        vec3 source = cloud_source(hit, phases, own_steps, place_m);
        float depth = hit.extinction_1_m * piece_m;
        float step_t = exp(-depth);
        float share = falls ? max(through * velum_opacity(depth, step_t), 1e-12) : 1.0;
        through *= step_t;
        light += share * vec4(source / VELUM_LUMINANCE_UNIT, place_m);
        weight += share;
        steps += own_steps;
    }
    light *= found.z / weight;
    lit[place] = pack_halves(clamp(light, -most_half, most_half));

    uint samples = subgroupAdd(uint(steps));
    if (subgroupElect()) {
        atomicAdd(counters[2], samples);
    }
}
