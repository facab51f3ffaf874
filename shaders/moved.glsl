/* What history holds of what is seen now, and where it stood in the frame before. */
#ifndef VELUM_MOVED_GLSL
#define VELUM_MOVED_GLSL

#include "engine.glsl"
#include "history.glsl"
#include "near.glsl"
#include "shared/shade.h"

layout(constant_id = 6) const bool has_depth = true;

/* Of the eye in a frame: on such a way cloud around it shows. */
const float travel_m = 2.0;
/* Share of it below which an eye stands or turns. */
const float stays = 2e-3;
/* Below it a pixel is as good as clear. */
const float least_opacity = 0.005;
/* Between places of history that are taken for one. */
const float alike_pixels = 0.15;
/* Samples of a place that a ray has told of, as a filter mixes them: one of four that has had one ray is none. */
const float has_ray = 0.3;
/* Places of history so many pixels apart are not the same; history that has moved so far is doubted. */
const float doubted = 1.0;

/* How much the eye goes through air that may hold cloud, 0..1. */
float travels() {
    return clamp(length(view.offset.xyz - view.before_offset.xyz) / travel_m, 1e-3, 1.0);
}

/* Whether history falls behind what there is: where the eye travels, clouds turn and their light changes. */
bool history_lags() {
    return !takes_turns() && travels() > stays;
}

/* What history holds where the point of a ray at some distance stood in the frame before. History keeps opacity times
 * distance / distance_unit_m, and samples: filters may mix them, as they do light. Where the host's depth ended the ray,
 * samples are kept negative. */
struct history_place {
    vec2 pixel; /* of that frame, from its upper left corner */
    float samples;
    bvec2 ended; /* any of the pixels there by the host's depth; all that closed cloud does not hide */
    float distance_m; /* how far along the ray what is held there would be; 0: nothing is */
    float held_m; /* the same; nothing_m(): as good as nothing is */
    bool known; /* within that picture */
};

/* Where something that a ray meets stood in the frame before. */
struct past_place {
    vec2 pixel; /* see history_place */
    float away_m;
    bool known;
};

/* See history_place. */
float held_of(float distance_m, float opacity) {
    return opacity > least_opacity && distance_m > 0.0 ? min(distance_m, nothing_m()) : nothing_m();
}

past_place past_place_of(vec3 q) {
    past_place p;
    vec2 plane = vec2(dot(q, view.before_right.xyz), dot(q, view.before_up.xyz));
    float depth_m = dot(q, view.before_forward.xyz);
    p.away_m = view_flag(VELUM_VIEW_BLOCK_ORTHOGRAPHIC) ? depth_m : length(q);
    plane /= view_flag(VELUM_VIEW_BLOCK_ORTHOGRAPHIC) ? 1.0 : depth_m;
    vec2 corner = vec2(view.before_right.w, view.before_offset.w);
    vec2 size = vec2(view.size.xy);
    p.pixel = size * (plane - corner) / (vec2(view.before_up.w, view.before_forward.w) - corner) - view.before_jitter.xy;
    p.known = depth_m > 0.0 && all(greaterThanEqual(p.pixel, vec2(0.0))) && all(lessThan(p.pixel, size));
    p.pixel = p.known ? clamp(p.pixel, vec2(0.5), size - 0.5) : vec2(0.5);
    return p;
}

past_place past_of(view_ray ray, float distance_m) {
    float rise = dot(ray.direction, eye.up.xyz);
    float height_m = eye.up.w + dot(ray.origin, eye.up.xyz) +
                     distance_m * (rise + 0.5 * distance_m * (1.0 - rise * rise) / VELUM_WGS84_A_M);
    vec3 drift_m = view.drifts[int(velum_shade_level_of(height_m) + 0.5)].xyz;
    return past_place_of(ray.origin + ray.direction * distance_m - drift_m - view.before_offset.xyz);
}

history_place history_at(past_place past, float distance_m) {
    history_place p;
    p.pixel = past.pixel;
    p.known = past.known;
    vec2 at = p.pixel / view.room.zw;
    vec2 data = textureLod(history_data_in, at, 0.0).rg;
    float opacity = 1.0 - textureLod(history_in, at, 0.0).a;
    p.samples = abs(data.y);
    p.ended = bvec2(false);
    if (has_depth) {
        /* Asked where the four meet: devices round places, and nearer to a pixel's middle may take its other neighbours. */
        vec2 corner = floor(p.pixel - 0.5) + 1.0;
        vec4 around = textureGather(history_data_in, corner / view.room.zw, 1);
        vec2 f = p.pixel + 0.5 - corner;
        vec4 weight = vec4(1.0 - f.x, f.x, f.x, 1.0 - f.x) * vec4(f.y, f.y, 1.0 - f.y, 1.0 - f.y);
        bvec4 ends = lessThan(around, vec4(0.0));
        bvec4 counts = greaterThan(weight, vec4(0.01));
        /* Of what closed cloud hides nothing is known, and nothing needs to be. */
        bvec4 closed = lessThan(textureGather(history_in, corner / view.room.zw, 3), vec4(shut));
        bool all_end = all(bvec4(uvec4(ends) | uvec4(closed) | uvec4(not(counts))));
        p.ended = bvec2(any(bvec4(uvec4(ends) & uvec4(counts))), all_end);
        p.samples = dot(abs(around), weight);
        if (p.ended.x && !p.ended.y) {
            /* A filter would mix what stands on either side of the edge. */
            ivec2 nearest = ivec2(p.pixel);
            data = texelFetch(history_data_in, nearest, 0).rg;
            opacity = 1.0 - texelFetch(history_in, nearest, 0).a;
        }
    }
    /* From where the eye is now. */
    p.distance_m = distance_in(data.x, opacity) * distance_unit_m * distance_m / max(past.away_m, 1.0);
    p.held_m = held_of(p.distance_m, opacity);
    return p;
}

/* Of a pixel around which there is something from so near to so far away: what stood where the nearest would have, or
 * the farthest, and is there by its own distance too; of two the nearer hides the other. What is nearer than all that
 * was seen has gone, unless it would have stayed. `one`: all of it has moved alike. */
history_place history_of(view_ray ray, float near_m, float far_m, out bool one) {
    past_place past_far = past_of(ray, far_m);
    past_place past = past_of(ray, near_m);
    float distance_m = near_m;
    one = past.known && past_far.known && length(past.pixel - past_far.pixel) < alike_pixels;
    history_place place;
    history_place other; /* that of the turn before */
    other.held_m = nothing_m();
    for (int turn = 0; turn < 4; ++turn) {
        place = history_at(past, distance_m);
        past_place held = past_of(ray, place.held_m);
        bool is_there = place.known && alike(place.held_m, other.held_m);
        bool is_done = turn == 3;
        if (turn == 0) {
            one = one && held.known && length(past.pixel - held.pixel) < alike_pixels;
            place.pixel = one ? held.pixel : place.pixel;
            is_done = one;
        } else if (turn == 1) {
            is_done = is_there && alike_ratio * other.held_m > near_m;
        } else if (turn == 3) {
            bool is_same = length(place.pixel - other.pixel) < doubted;
            bool is_seen = alike_ratio * other.held_m > near_m;
            bool is_known = other.known && (is_same || (is_seen && is_there));
            if (!is_there) {
                place = other;
            }
            place.known = is_known;
        }
        if (is_done) {
            break;
        }
        other = place;
        past = held;
        distance_m = place.held_m;
        if (turn == 1) {
            past = past_far;
            distance_m = far_m;
        }
    }
    return place;
}

/* The central difference, no steeper than twice either side's: what a cell may lean by without a new extreme (monotonized
 * central limiter, van Leer 1977). */
vec4 lean_of(vec4 before, vec4 after) {
    vec4 least = min(0.5 * abs(before + after), 2.0 * min(abs(before), abs(after)));
    return mix(vec4(0.0), sign(after) * least, greaterThan(before * after, vec4(0.0)));
}

/* What comes in along one axis less what leaves, where `from` stands in the flow before `here`, and `beyond` before that;
 * `after` behind it; by so much of a pixel. */
vec4 flow(vec4 beyond, vec4 from, vec4 here, vec4 after, float share) {
    float half_left = 0.5 * (1.0 - share);
    return share * (from - here + half_left * (lean_of(from - beyond, here - from) - lean_of(here - from, after - here)));
}

/* Light that stood beside a pixel: to both sides, over and under it. */
struct light_beside {
    vec4 left, right, over, under;
};

/* History between its pixels, as a flow from cell to cell with limited slopes: edges stay as sharp as they are however
 * often they are handed on, and move as far as they should. A filter blurs them; Catmull and Rom's spline, held back from
 * new extremes, moves a step half as far. */
vec4 history_light(vec2 place, vec2 size, out light_beside beside) {
    ivec2 last = ivec2(size) - 1;
    ivec2 cell = ivec2(place);
    vec2 from = place - (vec2(cell) + 0.5);
    ivec2 x = ivec2(from.x < 0.0 ? -1 : 1, 0);
    ivec2 y = ivec2(0, from.y < 0.0 ? -1 : 1);
    vec4 here = texelFetch(history_in, cell, 0);
    vec4 left = texelFetch(history_in, clamp(cell + x, ivec2(0), last), 0);
    vec4 left_2 = texelFetch(history_in, clamp(cell + 2 * x, ivec2(0), last), 0);
    vec4 right = texelFetch(history_in, clamp(cell - x, ivec2(0), last), 0);
    vec4 over = texelFetch(history_in, clamp(cell + y, ivec2(0), last), 0);
    vec4 over_2 = texelFetch(history_in, clamp(cell + 2 * y, ivec2(0), last), 0);
    vec4 under = texelFetch(history_in, clamp(cell - y, ivec2(0), last), 0);
    vec4 corner = texelFetch(history_in, clamp(cell + x + y, ivec2(0), last), 0);
    beside = light_beside(x.x < 0 ? left : right, x.x < 0 ? right : left, y.y < 0 ? over : under, y.y < 0 ? under : over);
    vec2 share = abs(from);
    vec4 sum = here + flow(left_2, left, here, right, share.x) + flow(over_2, over, here, under, share.y) +
               share.x * share.y * (corner - left - over + here);
    return clamp(sum, min(min(here, corner), min(left, over)), max(max(here, corner), max(left, over)));
}

#endif
