#version 460
#extension GL_GOOGLE_include_directive : require
/* Each ray: the light of its places, behind the air before them. Where history is kept, it gets it here. */
#include "air_light.glsl"
#include "due.glsl"
#include "history.glsl"
#include "near.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT, rgba16f) uniform writeonly image2D light_out;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE, r32f) uniform writeonly image2D distance_out;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT_IN) uniform sampler2D march_light;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE_IN) uniform sampler2D march_distance;

layout(constant_id = 8) const bool keeps = false;

/* No host's surface is in sight where history is kept. */
void keep(ivec2 block, view_ray ray, vec4 light, float distance_m) {
    ivec2 pixel = block * ray_block_size() + ray_turn(block.y);
    if (pixel.x >= int(view.size.x) || pixel.y >= int(view.size.y)) {
        return;
    }
    bool ended;
    cloud_pixel old = standing_at(pixel, ended);
    cloud_pixel fresh = cloud_pixel(light, distance_m, 1.0, vec4(0.0));
    cloud_pixel cloud = with_ray(old, min(old.samples, view.scale.w), fresh, 0.0);
    cloud.samples = stepped(old, cloud.samples);
    history_store(pixel, cloud, false, false, 0u);
    if (calm_turns() == 0u) {
        return;
    }
    sky_light sky = sky_light_at(sky_texel(ray.direction, ground_distance(ray.origin, ray.direction) >= 0.0));
    vec4 change = cloud.change * vec4(vec3(VELUM_LUMINANCE_UNIT), 1.0);
    change.rgb += change.a * sky.luminance;
    history_unrest(block, change, cloud.light.rgb * VELUM_LUMINANCE_UNIT + cloud.light.a * sky.luminance);
}

void main() {
    due_ray of;
    if (!due_ray_here(of)) {
        return;
    }
    /* As march.comp leaves it for a block's own ray: number of places, their share of the picture, -, transmittance. */
    bool more = of.which != 0u;
    vec4 found = texelFetch(march_light, of.block, 0);
    float distance_m = texelFetch(march_distance, of.block, 0).r;
    uint first = of.place;
    if (more) {
        vec4 head = unpack_place(lit[first - 1u]);
        found = vec4(head.w, head.z, 0.0, head.y);
        distance_m = head.x;
    }
    vec4 sum = vec4(0.0);
    for (uint i = 0u; i < uint(found.x); ++i) {
        sum += unpack_halves(lit[first + i]);
    }
    sum.rgb *= VELUM_LUMINANCE_UNIT;
    bool any = found.y > 0.0;
    /* 0: next to nothing, of which the march tells no distance. */
    distance_m = any && distance_m > 0.0 ? max(distance_m + sum.a / found.y, 0.0) : distance_m;
    view_ray ray = ray_of_pixel(finer_pixel(of.block, of.which));
    vec3 light = air_before_cloud(ray.origin, ray.direction, sum.rgb, found.a, distance_m, any);
    vec4 whole = vec4(min(light / VELUM_LUMINANCE_UNIT, vec3(most_half)), found.a);
    if (more) {
        lit[first - 1u] = pack_halves(whole);
        float end_m = end_of(host_distance(finer_pixel(of.block, of.which), ray));
        lit[first].x = pack_ways(distance_m, end_m);
        return;
    }
    /* Later frames look between rays of earlier ones too. */
    imageStore(light_out, of.block, whole);
    imageStore(distance_out, of.block, vec4(distance_m));
    if (keeps) {
        keep(of.block, ray, whole, distance_m);
    }
}
