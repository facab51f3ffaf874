/* Light of a uniform layer along a step, in closed form: as right for a step through all of it as for small ones. */
#ifndef VELUM_SLAB_H
#define VELUM_SLAB_H

#include "planet.h"

#ifndef VULKAN
#include <stdbool.h>
#endif

/* Along a ray, from a place on it. */
VELUM_STRUCT(velum_slab_span) {
    float from_m, to_m; /* from <= to */
    float inside_m;     /* the length of it that lies in the layer: less only where the ray dips below it in between */
};

/* Where a ray is below `face_m`, from `before_m` behind a place at height h to `after_m` ahead of it, if it rises by
 * `rise` a metre there: curvature adds t^2 (1 - rise^2) / 2a. */
VELUM_FN velum_slab_span velum_slab_below(float h, float rise, float face_m, float before_m, float after_m) {
    velum_slab_span span;
    float bend = VELUM_MAX(1.0f - rise * rise, 1.0e-6f) / (2.0f * VELUM_WGS84_A_M);
    float over = h - face_m;
    float inside = rise * rise - 4.0f * bend * over;
    float q = -0.5f * (rise + (rise < 0.0f ? -1.0f : 1.0f) * VELUM_SQRT(VELUM_MAX(inside, 0.0f)));
    float t1 = q / bend;
    float t2 = q != 0.0f ? over / q : 0.0f;
    span.from_m = velum_clamp(VELUM_MIN(t1, t2), -before_m, after_m);
    span.to_m = inside > 0.0f ? velum_clamp(VELUM_MAX(t1, t2), -before_m, after_m) : span.from_m;
    span.inside_m = span.to_m - span.from_m;
    return span;
}

/* The same between a layer's faces; of what a ray that dips below it leaves on both sides, one side is named. */
VELUM_FN velum_slab_span velum_slab_within(float h, float rise, float base_m, float top_m, float before_m,
                                           float after_m) {
    velum_slab_span span = velum_slab_below(h, rise, top_m, before_m, after_m);
    velum_slab_span under = velum_slab_below(h, rise, base_m, before_m, after_m);
    span.inside_m = VELUM_MAX(span.inside_m - under.inside_m, 0.0f);
    if (under.inside_m > 0.0f) {
        bool falls = under.from_m - span.from_m > span.to_m - under.to_m;
        span.to_m = falls ? under.from_m : span.to_m;
        span.from_m = falls ? span.from_m : under.to_m;
    }
    return span;
}

/* Height at t. */
VELUM_FN float velum_height_along(float h, float rise, float t) {
    return h + t * (rise + t * (1.0f - rise * rise) / (2.0f * VELUM_WGS84_A_M));
}

/* 1 - exp(-depth), of which `through` is exp(-depth): thin steps keep their digits. */
VELUM_FN float velum_opacity(float depth, float through) {
    return depth < 0.01f ? depth * (1.0f - depth * (0.5f - depth * (1.0f / 6.0f))) : 1.0f - through;
}

/* Mean of exp(-t) over t from 0 to depth. */
VELUM_FN float velum_mean_transmittance(float depth) {
    float through = VELUM_EXP(-depth);
    return depth < 0.01f ? 1.0f - depth * (0.5f - depth * (1.0f / 6.0f)) : (1.0f - through) / depth;
}

/* How far through a step of optical depth `depth`, 0..1, a share of all that it takes has been taken. */
VELUM_FN float velum_slab_share(float depth, float share) {
    float opacity = 1.0f - VELUM_EXP(-depth);
    return depth < 0.01f ? share : VELUM_MIN(-VELUM_LOG(1.0f - share * opacity) / depth, 1.0f);
}

/* Means over a step of optical depth `depth`, each place weighted by the share of its light that leaves the near end.
 */
VELUM_STRUCT(velum_slab_light) {
    float direct; /* exp(-d), d being the depth from there towards the sun */
    float place;  /* of the way through the step, 0..1 */
};

/* d falls or rises in proportion from `near_depth` to `far_depth`, both >= 0. */
VELUM_FN velum_slab_light velum_slab_light_of(float depth, float near_depth, float far_depth) {
    velum_slab_light light;
    float mean = velum_mean_transmittance(depth);
    /* exp(-d) exp(-t) is one exponential: of its two ends the greater stands before the mean. */
    float turn = depth - near_depth + far_depth;
    float most = VELUM_EXP(-VELUM_MIN(near_depth, far_depth + depth));
    light.direct = VELUM_MIN(most * velum_mean_transmittance(VELUM_ABS(turn)) / mean, 1.0f);
    /* t / depth - t / (exp(depth) - 1), t = 1 at the far end. */
    light.place = depth < 0.03f ? 0.5f - depth * (1.0f / 12.0f)
                                : VELUM_MAX(1.0f / depth - VELUM_EXP(-depth) / (1.0f - VELUM_EXP(-depth)), 0.0f);
    return light;
}

#endif
