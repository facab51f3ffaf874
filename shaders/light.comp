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

/* What falls is lit at so many places of the way through it: it lies in the sun here, in its cloud's shade there; but not
 * under an overcast. */
const int fall_looks = 6;

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
    int looks = 1;
    float from_m = found.x - found.y * offset;

    vec4 light = vec4(0.0); /* and how far beyond it comes from, m */
    float weight = 0.0;
    int steps = 0;
    for (int look = 0; look < looks; ++look) {
        float at = falls ? from_m + found.y * fract(offset + float(look) / float(fall_looks)) : found.x;
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
        cloud_fields(hit, true);
        looks = falls && velum_overcast(hit.fields.coverage) < 1.0 ? fall_looks : looks;
        hit.profile = velum_profile_of(hit.slot, hit.fields);
        cloud_look(hit, true, at, false);

        float place_m = 0.0;
        int own_steps = int(view.steps.y) * (is_fringe(hit) && !falls ? fringe_sun_steps : 1);
        vec3 source = cloud_source(hit, phases, own_steps, place_m);
        float share = falls ? max(hit.extinction_1_m, 1e-12) : 1.0;
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
