#version 460
#extension GL_GOOGLE_include_directive : require
/* Every pixel: this frame's rays where there is one, moved history elsewhere; then sky, air and ground around it. */
#include "air_light.glsl"
#include "shared/hash.h"
#include "lit.glsl"
#include "moved.glsl"
/* Positions from the eye: the block is shifted to it. */
#define VELUM_SHADOW_SET 0
#define VELUM_SHADOW_BLOCK_BINDING VELUM_BIND_SHADOW_BLOCK
#define VELUM_SHADOW_MAP_BINDING VELUM_BIND_SHADOW
#include "velum/velum_shadow.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 1, binding = VELUM_BIND_MARCH_LIGHT_IN) uniform sampler2D march_light;
layout(set = 1, binding = VELUM_BIND_MARCH_DISTANCE_IN) uniform sampler2D march_distance;
layout(set = 1, binding = VELUM_BIND_LIT_TEXELS) uniform samplerBuffer lit_texels;
layout(set = 1, binding = VELUM_BIND_RAYS_TEXELS) uniform usamplerBuffer rays_texels;
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

/* Pixels that history has moved since the frame before: all is believed of it, nothing beyond what this frame saw. */
const float trusted = 0.15;
/* How much rays tell of history's bounds (see bound_by_rays): where it holds what has gone, and where it holds the same as
 * they see, by its distance over theirs. */
const float told_little = 0.5, told_much = 3.0, same_from = 0.85, same_to = 0.97;
/* Of the light: rays that differ by no more see one even thing. */
const float even_share = 0.02;
/* Where history moves so many pixels a frame, but for the strides of standing views, it counts for less when a pixel's ray
 * comes: each time that it is handed on blurs it, the more often the fewer rays there are. It counts for nothing where the
 * ray has met another thing. */
const float renewed_from = 0.01, renewed_to = 0.05;
/* Samples of a pixel that is shown until it has one of its own. */
const float borrowed = 0.75;
/* Share of what a pixel lies beyond those beside it that is not shown; the less where pixels are wider than this, for then
 * clouds vary as much. */
const float evened_share = 0.6, evened_rad = 1.2e-3;
/* Strides lose so much of that by filters, at most. */
const float filtered = 0.03;

/* The host draws the ground, or nobody: then the pass spends nothing on ours; nor on the host's depth where it gives
 * none; nor on where history has moved to where all stands; nor on rays where history is kept in place: gather.comp has put
 * them there. */
layout(constant_id = 5) const bool draws_ground = true;
layout(constant_id = 7) const bool moves = true;
layout(constant_id = 8) const bool keeps = false;
/* The eye's sky does not tell of the air before the view: it is far from the eye, or made otherwise, or very high. */
layout(constant_id = 11) const bool has_own_air = true;

/* Where what a ray meets would have stood, had the eye turned and nothing moved. */
vec2 turned_of(view_ray ray) {
    return past_place_of(ray.origin - view.offset.xyz + ray.direction * nothing_m()).pixel;
}

/* From where history stood to where it stands. */
float moved_pixels(history_place place, ivec2 pixel) {
    return length(place.pixel - (vec2(pixel) + 0.5));
}

/* See trusted. In views that stand history moves in strides, and rays of calm tiles are of earlier frames. */
float believed() {
    return takes_turns() ? doubted : trusted;
}

vec4 excess_over(vec4 light, vec4 a, vec4 b) {
    return light - clamp(light, min(a, b), max(a, b));
}
/* How far it lies beyond both at its sides, or over and under it: the more of either. */
vec4 excess_of(vec4 light, light_beside beside) {
    vec4 across = excess_over(light, beside.left, beside.right);
    vec4 along = excess_over(light, beside.over, beside.under);
    return mix(across, along, lessThan(abs(across), abs(along)));
}

/* Light of a pixel of history, as far as this frame has seen the like of it (`low` to `high`); the pixel's own (`light`)
 * where there is none, or where the host has drawn something that ended a ray there and not here (`ended`). */
vec4 light_at_side(ivec2 pixel, vec4 there, vec4 light, vec4 low, vec4 high, bool ended) {
    bool is_in = all(greaterThanEqual(pixel, ivec2(0))) && all(lessThan(pixel, ivec2(view.size.xy)));
    if (has_depth) {
        is_in = is_in && (texelFetch(history_data_in, clamp(pixel, ivec2(0), ivec2(view.size.xy) - 1), 0).g < 0.0) == ended;
    }
    return is_in ? clamp(there, low, high) : light;
}

/* What of a pixel's excess is taken for an edge's teeth. Orthographic views, whose pixels have no angle, are shown as they
 * are. */
float toothed() {
    float pixel_rad = (view.up.w - view.right.w) / float(view.size.x);
    float share = evened_share * min(evened_rad * evened_rad / (pixel_rad * pixel_rad), 1.0);
    return view_flag(VELUM_VIEW_BLOCK_ORTHOGRAPHIC) ? 0.0 : share;
}

/* What is shown of a pixel that lies beyond both at its sides, or over and under it: rays step on by offsets of their own,
 * by which edges would be specked. What history holds is the ray's. */
vec4 evened(vec4 light, ivec2 cell, light_beside beside, vec4 low, vec4 high, bool ended) {
    ivec2 x = ivec2(1, 0);
    ivec2 y = ivec2(0, 1);
    light_beside seen = light_beside(light_at_side(cell - x, beside.left, light, low, high, ended),
                                     light_at_side(cell + x, beside.right, light, low, high, ended),
                                     light_at_side(cell - y, beside.over, light, low, high, ended),
                                     light_at_side(cell + y, beside.under, light, low, high, ended));
    return light - toothed() * excess_of(light, seen);
}

/* What many pixels read comes quicker as texels: what near.comp and gather.comp have left in lit, as they packed it. */
vec4 lit_halves(uint place) {
    return texelFetch(lit_texels, int(place) + VELUM_LIT_HEAD_BYTES / VELUM_LIT_BYTES);
}
/* Number of a block among the finer ones, and one; 0: it is none. */
uint finer_number(ivec2 block) {
    return view_flag(VELUM_VIEW_BLOCK_FINER) ? texelFetch(rays_texels, int(ray_of(block))).y : 0u;
}

/* What a ray of this frame has found. */
struct found_ray {
    vec4 light;
    float distance_m;
    float end_m; /* see end_of */
};

/* Of a block, or of a quarter of one: where that has none the block's own. */
found_ray ray_found(ivec2 place, bool of_quarter) {
    ivec2 block = of_quarter ? place / 2 : place;
    uint which = of_quarter ? finer_which(place & 1) : 0u;
    uint number = which != 0u ? finer_number(block) : 0u;
    which = number != 0u ? which : 0u;
    if (!moves) {
        ivec2 pixel = ray_pixel(block);
        float end_m = has_depth ? end_of(host_distance(pixel, ray_of_pixel(pixel))) : 0.0;
        return found_ray(texelFetch(march_light, block, 0), texelFetch(march_distance, block, 0).r, end_m);
    }
    uint own = own_head(ray_of(block), view_flag(VELUM_VIEW_BLOCK_FINER));
    uint head = which != 0u ? finer_head(block_count(), number - 1u, which) : own;
    vec2 ways_m = way_unit_m * lit_halves(head + 1u).xy;
    return found_ray(lit_halves(head), ways_m.x, ways_m.y);
}

/* Whether what a ray has found is as good for a pixel whose own way ends so far away. */
bool found_fits(found_ray found, float end_m) {
    return !has_depth || hides(found.light, found.distance_m, end_m) || alike(found.end_m, end_m);
}

/* The bounds of what rays around a place between blocks have seen, about what there is between the four next to it
 * (`light`): each ray tells the less the farther off it is, for bounds by the four alone change in steps, from block to
 * block. `held_m`: see history_place; `near_m`: what the nearest of the four has met. Where history holds what is nearer than
 * that, it has gone, and rays tell little beyond that mean. */
void bound_by_rays(vec2 at, ivec2 last, bool of_quarter, vec4 light, float end_m, float held_m, float near_m, out vec4 low,
                   out vec4 high) {
    float told = mix(told_little, told_much, smoothstep(same_from, same_to, held_m / near_m));
    ivec2 nearest = ivec2(floor(at + 0.5));
    low = high = light;
    for (int k = 0; k < 9; ++k) {
        ivec2 to = nearest + ivec2(k % 3 - 1, k / 3 - 1);
        found_ray there = ray_found(clamp(to, ivec2(0), last), of_quarter);
        vec2 tells = clamp(told * (1.0 - abs(at - vec2(to)) / 1.5), 0.0, 1.0);
        vec4 beside = mix(light, there.light, found_fits(there, end_m) ? tells.x * tells.y : 0.0);
        low = min(low, beside);
        high = max(high, beside);
    }
}

/* Share of what rays tell of the lag of history that is made up for in a frame. */
const float caught_share = 0.25;

/* History (`light`, of so much) nearer to what the rays of blocks around a pixel have found: each is asked of the place where
 * it has found it, so that detail between them stays. Where they see another thing than history holds here they tell nothing
 * of it; beside what is far brighter, no more than there is. `end_m`: where the pixel's own way ends. */
vec4 caught_up(ivec2 pixel, vec4 light, float held_m, float end_m) {
    ivec2 side = ray_block_size();
    ivec2 last = ivec2(view.march_size.xy) - 1;
    vec2 at = clamp((vec2(pixel) - vec2(ray_turn(pixel.y / side.y))) / vec2(side), vec2(0.0), vec2(last));
    vec4 lag = vec4(0.0);
    for (int k = 0; k < 4; ++k) {
        ivec2 aside = ivec2(k & 1, k >> 1);
        ivec2 block = min(ivec2(at) + aside, last);
        found_ray there = ray_found(block, false);
        vec2 share = mix(1.0 - fract(at), fract(at), vec2(aside));
        bool fit = found_fits(there, end_m) && alike(held_m, met_m(there.distance_m));
        uint head = own_head(ray_of(block), view_flag(VELUM_VIEW_BLOCK_FINER));
        float tells = fit ? share.x * share.y * sees_alike(abs(there.light.a - light.a)) : 0.0;
        lag += tells * lit_halves(head + 2u);
    }
    return light + caught_share * travels() * clamp(lag, -light, vec4(light.rgb, 1.0 - light.a));
}

/* Share of a ray beside history of the same thing: a half where each pixel has one in each frame, more the longer history is
 * handed on. Of a half, three quarters and all for 1 ray in 16, three quarters shows most detail without specks. */
float renewed_share() {
    return 1.0 - 0.5 * inversesqrt(sqrt(float(ray_block_size().x * ray_block_size().y)));
}

/* What history has is lost, or was never there. */
const vec4 lost = vec4(1.0e4);

/* How far so many samples are from having stepped from all places, 0..1. */
float waits(float samples) {
    return clamp(places_of_steps - filtered - samples, 0.0, 1.0);
}

/* Of history beside a pixel of a view that stands; its own light where another thing is in sight there. */
vec4 rests_beside(ivec2 there, cloud_pixel cloud, view_ray ray, float end_m) {
    there = clamp(there, ivec2(0), ivec2(view.size.xy) - 1);
    vec4 light = texelFetch(history_in, there, 0);
    if (has_depth) {
        vec2 data = texelFetch(history_data_in, there, 0).rg;
        float distance_m = distance_in(data.x, 1.0 - light.a) * distance_unit_m;
        float there_hit_m = host_distance(there, ray);
        float there_m = end_of(there_hit_m);
        /* Of what the host draws there now. */
        bool holds = (data.y < 0.0) == (there_hit_m >= 0.0 && light.a >= shut) && distance_m <= 1.02 * there_m;
        bool fit = hides(light, distance_m, end_m) ||
                   (holds && (alike(there_m, end_m) || hides(cloud.light, cloud.distance_m, there_m)));
        light = fit ? light : cloud.light;
    }
    return light;
}

/* Of a view that stands; `cell`: where the pixel's history is. Places to step from lie on a checkerboard, and that in
 * fours: the mean leaves nothing of the first and half of the others. Where a pixel is shown as having fewer samples, the
 * newest ray shows, and edges have teeth when a pixel has seen them from all: see evened. */
vec4 shown_at_rest(cloud_pixel cloud, ivec2 cell, view_ray ray, float hit_m) {
    float end_m = end_of(hit_m);
    light_beside beside = light_beside(rests_beside(cell - ivec2(1, 0), cloud, ray, end_m),
                                       rests_beside(cell + ivec2(1, 0), cloud, ray, end_m),
                                       rests_beside(cell - ivec2(0, 1), cloud, ray, end_m),
                                       rests_beside(cell + ivec2(0, 1), cloud, ray, end_m));
    vec4 own = cloud.light - waits(view.before_jitter.w) * toothed() * excess_of(cloud.light, beside);
    vec4 mean = 0.5 * cloud.light + 0.125 * (beside.left + beside.right + beside.over + beside.under);
    return mix(own, mean, waits(cloud.samples));
}

/* Whether what history holds goes on, where the host's surface is so far away now (`hit_m`; below 0: none): not cloud behind
 * what is in sight here; nor what was in sight there and has hidden what is now, if a ray `tells` of that; nor both. */
bool stands_before(history_place place, float end_m, float hit_m, bool tells) {
    bool behind = place.held_m < nothing_m() && place.held_m > 1.02 * end_m;
    bool hidden = place.ended.x && (hit_m < 0.0 || (!place.ended.y && tells));
    return !behind && !hidden;
}

/* `hit_m`: the host's surface; below 0: none. `shown`: light and transmittance in the picture. */
cloud_pixel resolve_cloud(ivec2 pixel, view_ray ray, float hit_m, out vec4 shown) {
    ivec2 side = ray_block_size();
    ivec2 block = pixel / side;
    ivec2 turn = ray_turn(block.y);
    ivec2 last = ivec2(view.march_size.xy) - 1;
    bool finer = moves && finer_number(block) != 0u;
    ivec2 within = pixel - block * side;
    bool own = within == turn && (!takes_turns() || block_has_ray(block));
    vec2 middle = vec2(turn);
    if (finer) {
        side = quarter_size();
        last = 2 * last + 1;
        own = within == finer_turn(block.y, finer_which(within / side));
        middle = 0.5 * vec2(side - 1);
    }

    /* This frame's ray, or between its neighbours. */
    cloud_pixel fresh;
    fresh.change = lost;
    vec2 at = (vec2(pixel) - middle) / vec2(side);
    at = own ? vec2(pixel / side) : clamp(at, vec2(0.0), vec2(last));
    fresh.light = vec4(0.0);
    fresh.distance_m = 0.0;
    if (!moves) {
        /* The images may have room for more rays and pixels than this frame has. */
        fresh.light = textureLod(march_light, (at + 0.5) / view.room.xy, 0.0);
        fresh.distance_m = texelFetch(march_distance, clamp(ivec2(floor(at + 0.5)), ivec2(0), last), 0).r;
    }
    fresh.samples = own ? 1.0 : 0.0;

    bool first = view.march_size.w == 0u;
    float end_m = end_of(hit_m);
    float near_m = nothing_m();
    float far_m = 0.0;
    history_place place;
    place.pixel = vec2(pixel) + 0.5;
    place.known = true;
    cloud_pixel old;
    if (!moves) {
        bool ended;
        old = standing_at(pixel, ended);
        place.held_m = held_of(old.distance_m, 1.0 - old.light.a);
        place.ended = bvec2(ended);
        place.known = !has_depth || stands_before(place, end_m, hit_m, true);
    }
    /* Rays around it tell of a pixel that has none and no history. */
    bool asks = moves || (!own && (first || (has_depth && (!place.known || old.samples < has_ray))));

    /* What this frame saw around the pixel. */
    vec4 low = moves ? vec4(1.0e9) : fresh.light;
    vec4 high = fresh.light;
    float blend = 0.0;
    vec4 mixed = vec4(0.0);
    float weights = 0.0;
    float nearby = 0.0;
    bool fits = false; /* a ray has ended as far away as the pixel does */
    for (int k = asks ? 0 : 4; k < 4; ++k) {
        found_ray there = ray_found(clamp(ivec2(floor(at)) + ivec2(k & 1, k >> 1), ivec2(0), last), finer);
        vec4 light = there.light;
        float distance_m = there.distance_m;
        vec2 share = mix(1.0 - fract(at), fract(at), vec2(k & 1, k >> 1));
        float weight = share.x * share.y;
        bool fit = found_fits(there, end_m);
        if (has_depth) {
            weight = own ? weight : max(weight, 1e-2) * (fit ? 1.0 : 1e-8);
        }
        mixed += weight * light;
        nearby += weight * nearness(distance_m, ray.direction);
        weights += weight;
        blend += weight * (1.0 - light.a) * distance_m;
        distance_m = met_m(distance_m);
        if (has_depth && fit && !fits) {
            /* What those before it saw lies elsewhere. */
            low = high = light;
            near_m = far_m = distance_m;
        }
        bool counts = !has_depth || fit || !fits;
        low = counts ? min(low, light) : low;
        high = counts ? max(high, light) : high;
        near_m = counts ? min(near_m, distance_m) : near_m;
        far_m = counts ? max(far_m, distance_m) : far_m;
        fits = fits || fit;
    }
    if (moves || (has_depth && asks)) {
        fresh.light = mixed / weights;
        blend /= weights;
        nearby *= sees_alike(high.a - low.a) / weights;
    }
    fresh.distance_m = blend > 0.0 ? distance_in(blend, 1.0 - fresh.light.a) : fresh.distance_m;
    if (has_depth && asks && !own && !fits && fresh.distance_m > end_m) {
        /* Rays have passed beside what is in sight here, and found what lies behind it. */
        fresh.light = vec4(0.0, 0.0, 0.0, 1.0);
        fresh.distance_m = 0.0;
        low = high = fresh.light;
    }
    shown = fresh.light;
    if (first) {
        return fresh;
    }
    vec2 size = vec2(view.size.xy);
    bool calm = false;
    if (moves) {
        float fresh_m = met_m(fresh.distance_m);
        bool one;
        place = history_of(ray, min(own ? fresh_m : near_m, end_m), min(own ? fresh_m : far_m, end_m), one);
        /* All has moved alike, and little: history is believed, whatever other rays have seen. */
        calm = !has_depth && one && travels() < stays && moved_pixels(place, pixel) < believed() &&
               (own || place.samples >= has_ray);
    }
    if (moves && has_depth) {
        place.known = place.known && stands_before(place, end_m, hit_m, own || fits);
    }
    if (!place.known) {
        return fresh;
    }
    light_beside stood_beside;
    if (moves) {
        old = cloud_pixel(history_light(place.pixel, size, stood_beside), place.distance_m, place.samples, vec4(0.0));
    }
    /* 0: no ray of its own yet. Below 1: none since the picture came to rest; what there is counts for nothing then. */
    float count = min(view_flag(VELUM_VIEW_BLOCK_SETTLE) ? min(old.samples, borrowed) : old.samples, view.scale.w);
    float renewed = 0.0;

    /* No ray of its own yet: between those of pixels beside it that have had one. */
    vec4 beside = vec4(0.0);
    float rays_beside = 0.0;
    ivec2 old_pixel = ivec2(place.pixel);
    for (int k = !own && old.samples < has_ray ? 0 : 9; k < 9; ++k) {
        ivec2 there = clamp(old_pixel + ivec2(k % 3 - 1, k / 3 - 1), ivec2(0), ivec2(size) - 1);
        vec2 data = texelFetch(history_data_in, there, 0).rg;
        vec4 light = texelFetch(history_in, there, 0);
        bool fit = !has_depth || (data.y < 0.0) == (hit_m >= 0.0) ||
                   (data.y >= 0.0 && hides(light, distance_in(data.x, 1.0 - light.a) * distance_unit_m, end_m));
        float seen = abs(data.y) >= has_ray && fit ? 1.0 : 0.0;
        beside += seen * light;
        rays_beside += seen;
    }
    old.light = rays_beside > 0.0 ? beside / rays_beside : old.light;

    if (moves) {
        float opacity = 1.0 - old.light.a;
        if (history_lags() && !own && count >= has_ray) {
            old.light = caught_up(pixel, old.light, place.held_m, end_m);
        }
        if (!calm && fits && any(greaterThan(high - low, even_share * vec4(high.rgb, 1.0)))) {
            bound_by_rays(at, last, finer, fresh.light, end_m, place.held_m, near_m, low, high);
        }
        /* Rays are blocks apart: what stands between them is held back where history has come from elsewhere, and some
         * where the eye goes through air that may hold cloud; not where it has but turned, for all turns alike. */
        float lost_from = believed();
        float apart = length(place.pixel - turned_of(ray));
        float trust = count < has_ray ? 0.0 : 1.0 - smoothstep(lost_from, lost_from + doubted - trusted, apart);
        vec4 bright = vec4(max(high, old.light).rgb, 1.0);
        vec4 slack = (high - low) * 0.25 + bright * 0.02;
        vec4 wide = ((high - low) * 0.3 + bright * 0.03) / travels();
        vec4 held = mix(clamp(old.light, low - slack, high + slack), clamp(old.light, low - wide, high + wide), trust);
        /* Cloud that is added so is where this frame's is. */
        float added = own || calm ? 0.0 : max(1.0 - held.a - opacity, 0.0);
        old.distance_m = distance_in(opacity * old.distance_m + added * fresh.distance_m, opacity + added);
        old.light = calm ? old.light : held;
        count = count < has_ray ? 0.0 : max(count, 1.0);
        float moved = takes_turns() ? 0.0 : smoothstep(renewed_from, renewed_to, moved_pixels(place, pixel));
        count = min(count, mix(view.scale.w, 1.0, moved));
        renewed = moved * (alike(place.held_m, met_m(fresh.distance_m)) ? renewed_share() : 1.0);
    }

    cloud_pixel result;
    if (own) {
        result = with_ray(old, count, fresh, renewed);
        if (!moves && count >= 1.0) {
            result.samples = stepped(old, result.samples);
        }
    } else if (count < has_ray) {
        /* Never hit by a ray of its own: as good as this frame's neighbours. */
        result = fresh;
        result.light = mix(old.light, fresh.light, moves ? 0.25 : 1.0 / (1.0 + rays_beside));
        result.distance_m = fresh.distance_m > 0.0 ? fresh.distance_m : old.distance_m;
    } else {
        result = old;
        /* What history counts for when a ray comes is asked then; what has had its rays keeps them while the view stands. */
        bool stands = !view_flag(VELUM_VIEW_BLOCK_SETTLE) && (!moves || takes_turns());
        result.samples = stands ? stepped(old, count) : count;
    }
    if (moves) {
        /* Of near cloud rays say all; where it has come from they tell badly. */
        float product = mix((1.0 - result.light.a) * result.distance_m, (1.0 - fresh.light.a) * fresh.distance_m, nearby);
        result.light = mix(result.light, fresh.light, nearby);
        result.distance_m = distance_in(product, 1.0 - result.light.a);
    }
    shown = result.light;
    if (moves && !takes_turns() && result.distance_m > 0.0) {
        /* As history itself is: see held. */
        vec4 slack = own || calm ? vec4(1.0e9) : (high - low) * 0.25 + vec4(high.rgb, 1.0) * 0.02;
        bool ended = has_depth && hit_m >= 0.0 && shown.a >= shut;
        shown = evened(shown, old_pixel, stood_beside, low - slack, high + slack, ended);
    } else if (!moves || takes_turns()) {
        shown = shown_at_rest(result, old_pixel, ray, hit_m);
    }
    return result;
}

void main() {
    ivec2 group = dealt_group();
    if (draws_ground) {
        /* The last rows of groups: those before them have none of it. */
        group.y += (int(view.size.y) + VELUM_GROUP - 1) / VELUM_GROUP - int(gl_NumWorkGroups.y);
    }
    ivec2 pixel = group * VELUM_GROUP + ivec2(gl_LocalInvocationID.xy);
    if (pixel.x >= int(view.size.x) || pixel.y >= int(view.size.y)) {
        return;
    }
    view_ray ray = view_ray_at(vec2(pixel) + 0.5 + view.scale.yz);
    float hit = has_depth ? host_distance(pixel, ray) : -1.0;
    bool host = hit >= 0.0;
    cloud_pixel cloud;
    vec4 shown;
    if (keeps) {
        bool ended;
        cloud = standing_at(pixel, ended);
        shown = shown_at_rest(cloud, pixel, ray, hit);
    } else {
        cloud = resolve_cloud(pixel, ray, hit, shown);
        uint chance = velum_hash(uint(pixel.x) + (uint(pixel.y) << 16u) + 0x9e3779b9u * view.march_size.w);
        history_store(pixel, cloud, host && cloud.light.a >= shut, moves, chance);
    }

    float ground = ground_distance(ray.origin, ray.direction);
    hit = host ? hit : ground;
    bool solid = hit >= 0.0;
    float through = shown.a;
    vec3 light = shown.rgb * VELUM_LUMINANCE_UNIT;
    vec3 transmittance = vec3(through);
    vec3 change = cloud.change.rgb * VELUM_LUMINANCE_UNIT;

    if (eye.ground.w != 0.0) {
        vec2 texel = sky_texel(ray.direction, ground >= 0.0);
        sky_light sky = sky_light_at(texel);
        vec3 whole = sky.transmittance;
        vec3 air = whole;
        if (has_depth && has_own_air) {
            float enter_m;
            vec2 near = into_air(start_of(ray.origin, ray.direction), enter_m);
            whole = air_along(near, enter_m, ground);
            float before_m = hit - enter_m;
            vec2 there = along_ray(near.x, near.y, max(before_m, 0.0));
            air = air_between(stretch_of(near, there), before_m);
            air = before_m > 0.0 && enter_m >= 0.0 ? air : vec3(1.0);
        } else if (has_depth && host) {
            air = air_before(start_by_eye(ray.origin, ray.direction), texel.y, ground, hit);
        }
        air = host ? air : whole;
        /* Of the light of all the way, the share before what is hit. */
        vec3 share = host ? clamp((1.0 - air) / max(1.0 - whole, vec3(1e-4)), 0.0, 1.0) : vec3(1.0);
        light += through * sky.luminance * share;
        change += cloud.change.a * sky.luminance * share;
        transmittance *= air;
    }
    if (!keeps && takes_turns()) {
        history_unrest(pixel / ray_block_size(), vec4(change, cloud.change.a), light);
    }
    if (draws_ground && !host && ground >= 0.0) {
        vec3 r = ray.origin + ray.direction * ground;
        velum_place to = place_of(r);
        float mu_sun = dot(vec3(to.nx, to.ny, to.nz), eye.sun.xyz);
        float fog = exp(-fog_over(0.0) / max(mu_sun, 1e-3));
        vec3 sun = eye.sun_lx.rgb * sun_through_air(0.0, mu_sun) * max(mu_sun, 0.0) * velum_shadow(r) * fog;
        vec3 sky_up = eye.ground.w != 0.0 ? half_world(0.0, false, true) * PI : vec3(0.0);
        light += transmittance * eye.ground.rgb / PI * (sun + sky_up);
        transmittance = vec3(0.0);
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
    float mean = dot(transmittance, VELUM_LUMINANCE_OF);
    imageStore(luminance_out, OUT_PIXEL(out_pixel), vec4(min(light, vec3(view.depth.w)), mean));
    imageStore(transmittance_out, OUT_PIXEL(out_pixel), vec4(transmittance, mean));
    imageStore(distance_out, OUT_PIXEL(out_pixel), vec4(through < 0.9999 ? cloud.distance_m : 0.0));
}
