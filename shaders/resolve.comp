#version 460
#extension GL_GOOGLE_include_directive : require
/* Every pixel: this frame's rays where there is one, moved history elsewhere; then sky, air and ground around it. */
#include "air.glsl"
#include "view.glsl"
/* Positions from the eye: the block is shifted to it. */
#define VELUM_SHADOW_SET 0
#define VELUM_SHADOW_BLOCK_BINDING VELUM_BIND_SHADOW_BLOCK
#define VELUM_SHADOW_MAP_BINDING VELUM_BIND_SHADOW
#include "velum/velum_shadow.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT_IN) uniform sampler2D march_light;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE_IN) uniform sampler2D march_distance;
layout(set = 1, binding = VELUM_BIND_HISTORY_IN) uniform sampler2D history_in;
layout(set = 1, binding = VELUM_BIND_HISTORY_DATA_IN) uniform sampler2D history_data_in;
layout(set = 1, binding = VELUM_BIND_HISTORY_OUT, rgba16f) uniform writeonly image2D history_out;
layout(set = 1, binding = VELUM_BIND_HISTORY_DATA_OUT, rg16f) uniform writeonly image2D history_data_out;
/* resolve: the host's views are 2D (velum_vulkan_images.layers 0). resolve_layered: 2D arrays (layers >= 1). */
#ifdef VELUM_LAYERED
#define OUT_IMAGE image2DArray
#define OUT_PIXEL(p) ivec3(p, int(view.frame.z))
#else
#define OUT_IMAGE image2D
#define OUT_PIXEL(p) (p)
#endif
layout(set = 1, binding = VELUM_BIND_OUT_LUMINANCE) uniform writeonly OUT_IMAGE luminance_out;
layout(set = 1, binding = VELUM_BIND_OUT_TRANSMITTANCE) uniform writeonly OUT_IMAGE transmittance_out;
layout(set = 1, binding = VELUM_BIND_OUT_DISTANCE) uniform writeonly OUT_IMAGE distance_out;

const float distance_unit_m = 100.0;
/* Where a ray met no cloud, history is moved as if it had been so far away. */
const float nothing_m = 60000.0;
/* Pixels that history has moved since the frame before: all is believed of it, nothing beyond what this frame saw. */
const float trusted = 0.15, doubted = 1.0;
/* Samples of a pixel that is shown until it has one of its own. */
const float shown = 0.75;

struct cloud_pixel {
    vec4 light;       /* luminance / VELUM_LUMINANCE_UNIT, transmittance */
    float distance_m; /* 0: none */
    float samples;
};

/* Where the cloud point r stood in the picture of the frame before, 0..1; outside: false. */
bool place_before(vec3 r, out vec2 uv) {
    vec3 q = r - view.drifted.xyz - view.before_offset.xyz;
    float x = dot(q, view.before_right.xyz);
    float y = dot(q, view.before_up.xyz);
    if (!view_flag(VELUM_VIEW_BLOCK_ORTHOGRAPHIC)) {
        float z = dot(q, view.before_forward.xyz);
        if (z <= 0.0) {
            return false;
        }
        x /= z;
        y /= z;
    }
    uv.x = (x - view.before_right.w) / (view.before_up.w - view.before_right.w);
    uv.y = (y - view.before_offset.w) / (view.before_forward.w - view.before_offset.w);
    return all(greaterThanEqual(uv, vec2(0.0))) && all(lessThan(uv, vec2(1.0)));
}

cloud_pixel resolve_cloud(ivec2 pixel, view_ray ray) {
    ivec2 side = ray_block_size();
    ivec2 block = pixel / side;
    ivec2 turn = ray_turn(block.y);
    bool own = pixel - block * side == turn;
    ivec2 last = ivec2(view.march_size.xy) - 1;

    /* This frame's ray, or between its neighbours. */
    cloud_pixel fresh;
    vec2 at = (vec2(pixel) - vec2(turn)) / vec2(side);
    at = own ? vec2(block) : clamp(at, vec2(0.0), vec2(last));
    /* The images may have room for more rays and pixels than this frame has. */
    fresh.light = textureLod(march_light, (at + 0.5) / view.room.xy, 0.0);
    fresh.distance_m = texelFetch(march_distance, clamp(ivec2(floor(at + 0.5)), ivec2(0), last), 0).r;
    fresh.samples = own ? 1.0 : 0.0;

    if (view.march_size.w == 0u) {
        return fresh;
    }
    bool still = view.scale.w == 0.0;
    vec2 size = vec2(view.size.xy);
    vec2 uv = (vec2(pixel) + 0.5) / size;
    if (!still) {
        float far = fresh.distance_m > 0.0 ? fresh.distance_m : nothing_m;
        if (!place_before(ray.origin + ray.direction * far, uv)) {
            return fresh;
        }
    }
    /* A filter's weights have 8 bits: standing history would bleed into its neighbours frame by frame. */
    vec4 old = still ? texelFetch(history_in, pixel, 0) : textureLod(history_in, uv * (size / view.room.zw), 0.0);
    ivec2 old_pixel = clamp(ivec2(uv * size), ivec2(0), ivec2(size) - 1);
    vec2 data = texelFetch(history_data_in, old_pixel, 0).rg;
    /* 0: no ray of its own yet. Below 1: none since the picture came to rest; what there is counts for nothing then. */
    float count = min(view_flag(VELUM_VIEW_BLOCK_SETTLE) ? min(data.g, shown) : data.g, view.drifted.w);
    /* Until a ray of its own has come, the distance is a neighbour's. */
    float old_distance_m = count < 1.0 && own ? 0.0 : data.r * distance_unit_m;

    /* No ray of its own yet: between those of pixels beside it that have had one. */
    vec4 beside = vec4(0.0);
    float rays_beside = 0.0;
    for (int k = !own && data.g < 0.5 ? 0 : 9; k < 9; ++k) {
        ivec2 there = clamp(old_pixel + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), ivec2(size) - 1);
        float seen = texelFetch(history_data_in, there, 0).g < 0.5 ? 0.0 : 1.0;
        beside += seen * texelFetch(history_in, there, 0);
        rays_beside += seen;
    }
    old = rays_beside > 0.0 ? beside / rays_beside : old;

    /* What this frame saw around the pixel bounds what can have been there. */
    vec4 low = fresh.light;
    vec4 high = fresh.light;
    for (int k = still ? 8 : 0; k < 9; ++k) {
        vec4 near = texelFetch(march_light, clamp(block + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), last), 0);
        low = min(low, near);
        high = max(high, near);
    }
    if (!still) {
        vec4 slack = (high - low) * 0.25 + vec4(0.02 * high.rgb, 0.02);
        /* Rays are blocks apart: what stands between them is held back only where history has come from elsewhere. */
        float moved = length(uv * size - (vec2(pixel) + 0.5));
        float trust = count < 0.5 ? 0.0 : 1.0 - smoothstep(trusted, doubted, moved);
        old = mix(clamp(old, low - slack, high + slack), old, trust);
        count = count < 0.5 ? 0.0 : clamp(count, 1.0, view.scale.w);
    }

    cloud_pixel result;
    if (own) {
        float n = count < 1.0 ? 1.0 : count + 1.0;
        result.light = mix(old, fresh.light, 1.0 / n);
        result.distance_m = old_distance_m > 0.0 && fresh.distance_m > 0.0
                                ? mix(old_distance_m, fresh.distance_m, 1.0 / n)
                                : max(old_distance_m, fresh.distance_m);
        result.samples = min(n, 1024.0);
    } else if (count < 0.5) {
        /* Never hit by a ray of its own: as good as this frame's neighbours. */
        result = fresh;
        result.light = mix(old, fresh.light, still ? 1.0 / (1.0 + rays_beside) : 0.25);
    } else {
        result.light = old;
        result.distance_m = old_distance_m;
        result.samples = count;
    }
    return result;
}

/* Height and cosine of the zenith angle so far along a ray that starts at height h0 with cosine mu0, on a sphere: for
 * air, which does not mind the metres by which the ellipsoid differs. */
vec2 along_ray(float h0, float mu0, float distance_m) {
    float r0 = VELUM_WGS84_A_M + h0;
    float step = distance_m * (2.0 * r0 * mu0 + distance_m);
    float r1 = sqrt(r0 * r0 + step);
    return vec2(h0 + step / (r0 + r1), (r0 * mu0 + distance_m) / r1);
}

/* Distance along such a ray to a height: where it comes down to it, or where it leaves upward; below 0: never. */
float along_to(float h0, float mu0, float height_m, bool upward) {
    float r0 = VELUM_WGS84_A_M + h0;
    float b = r0 * mu0;
    float over = (h0 - height_m) * (r0 + VELUM_WGS84_A_M + height_m);
    float inside = b * b - over;
    return inside >= 0.0 ? -b + (upward ? 1.0 : -1.0) * sqrt(inside) : -1.0;
}

/* The host draws the ground, or nobody: then the pass spends nothing on ours. */
layout(constant_id = 0) const bool draws_ground = true;

void main() {
    ivec2 pixel = dealt_group() * VELUM_GROUP + ivec2(gl_LocalInvocationID.xy);
    if (pixel.x >= int(view.size.x) || pixel.y >= int(view.size.y)) {
        return;
    }
    view_ray ray = view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);
    cloud_pixel cloud = resolve_cloud(pixel, ray);
    imageStore(history_out, pixel, cloud.light);
    imageStore(history_data_out, pixel, vec4(cloud.distance_m / distance_unit_m, cloud.samples, 0.0, 0.0));

    float hit = host_distance(pixel, ray);
    bool host = hit >= 0.0;
    float ground = ground_distance(ray.origin, ray.direction);
    hit = host ? hit : ground;
    bool solid = hit >= 0.0;
    float through = cloud.light.a;
    vec3 light = cloud.light.rgb * VELUM_LUMINANCE_UNIT;
    vec3 transmittance = vec3(through);

    if (eye.ground.w != 0.0) {
        velum_place from = place_of(ray.origin);
        vec2 near = vec2(from.height_m, dot(vec3(from.nx, from.ny, from.nz), ray.direction));
        float enter_m = near.x > VELUM_AIR_TOP_M ? along_to(near.x, near.y, VELUM_AIR_TOP_M, false) : 0.0;
        near = enter_m > 0.0 ? along_ray(near.x, near.y, enter_m) : near;
        /* All the way: to the ground, or to space. Then, of the light of all the way, the share before what is hit. */
        bool to_ground = ground >= 0.0;
        float way = to_ground ? ground - enter_m : along_to(near.x, near.y, VELUM_AIR_TOP_M, true);
        vec2 far = along_ray(near.x, near.y, max(way, 0.0));
        vec3 whole = enter_m < 0.0 ? vec3(1.0) : air_between(near.x, near.y, far.x, far.y, way);
        vec3 air = whole;
        /* A loop that runs once or not at all: see march.comp. */
        for (int once = host ? 0 : 1; once < 1; ++once) {
            float before_m = hit - enter_m;
            vec2 there = along_ray(near.x, near.y, max(before_m, 0.0));
            air = air_between(near.x, near.y, there.x, there.y, before_m);
            air = before_m > 0.0 && enter_m >= 0.0 ? air : vec3(1.0);
        }
        vec3 sky = sky_luminance(ray.direction, to_ground);
        vec3 share = host ? clamp((1.0 - air) / max(1.0 - whole, vec3(1e-4)), 0.0, 1.0) : vec3(1.0);
        light += through * sky * share;
        transmittance *= air;
    }
    if (draws_ground) {
        vec3 r = ray.origin + ray.direction * max(ground, 0.0);
        velum_place to = place_of(r);
        float mu_sun = dot(vec3(to.nx, to.ny, to.nz), eye.sun.xyz);
        vec3 sun = eye.sun_lx.rgb * sun_through_air(0.0, mu_sun) * max(mu_sun, 0.0) * velum_shadow(r);
        vec3 sky_up = eye.ground.w != 0.0 ? ambient_of(0.0, false) * PI : vec3(0.0);
        bool drawn = !host && ground >= 0.0;
        light += drawn ? transmittance * eye.ground.rgb / PI * (sun + sky_up) : vec3(0.0);
        transmittance = drawn ? vec3(0.0) : transmittance;
    }
    if (!solid && view_flag(VELUM_VIEW_BLOCK_SUN_DISC)) {
        float radius = max(eye.sun_lx.w, 1e-4);
        /* acos loses its digits near 1: the chord does not. */
        float angle = length(ray.direction - eye.sun.xyz);
        float edge = clamp((radius - angle) / (0.02 * radius) + 0.5, 0.0, 1.0);
        light += transmittance * edge * eye.sun_lx.rgb / (PI * radius * radius);
    }
    light *= view.scale.x;
    ivec2 out_pixel = pixel + ivec2(view.size.zw);
    float mean = dot(transmittance, vec3(0.2126, 0.7152, 0.0722));
    imageStore(luminance_out, OUT_PIXEL(out_pixel), vec4(min(light, vec3(view.depth.w)), mean));
    imageStore(transmittance_out, OUT_PIXEL(out_pixel), vec4(transmittance, mean));
    imageStore(distance_out, OUT_PIXEL(out_pixel), vec4(through < 0.9999 ? cloud.distance_m : 0.0));
}
