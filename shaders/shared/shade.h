/* What broken cloud leaves of the sun, on the mean: free lines of sight, and what the clouds let through. */
#ifndef VELUM_SHADE_H
#define VELUM_SHADE_H

#include "air.h"
#include "arguments.h"
#include "slots.h"

/* Share of the extinction that takes light off its way: delta scaling (Joseph et al. 1976), mean cosine 0.86. */
#define VELUM_TURNING_SHARE 0.26f
/* Of the noise's period: across a cloud; and a storm, whose towers are narrower than what it covers. */
#define VELUM_CLOUD_SHARE 0.15f
#define VELUM_TOWER_SHARE 0.076f
VELUM_FN float velum_cloud_share(int slot) {
    return slot == VELUM_SLOT_STORM ? VELUM_TOWER_SHARE : VELUM_CLOUD_SHARE;
}

/* Flux that a plane layer without absorption lets through, of what falls on it: Eddington's approximation over black
 * ground (Shettle & Weinman 1970); mean cosine 0.86 of droplets. */
VELUM_FN float velum_flux_through(float depth, float mu_sun) {
    const float turned_g = 1.0f - 0.14f / VELUM_TURNING_SHARE;
    return velum_flux_under(VELUM_TURNING_SHARE * depth, turned_g, VELUM_MAX(mu_sun, 0.02f));
}

/* Depth of plane cloud that lets as much flux through, over that of uneven cloud: much comes through where it is thin
 * (Cahalan et al. 1994: 0.7 of stratocumulus). Sheets are plane. Fitted to what the reference's ground gets. */
#define VELUM_LEAKY_DEPTH 0.788f
VELUM_FN float velum_leaky_depth(int slot, float kind) {
    float uneven = 1.0f;
    if (slot == VELUM_SLOT_LOW || slot == VELUM_SLOT_LOW_2) {
        uneven = kind;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        uneven = VELUM_MAX(2.0f * kind - 1.0f, 0.0f);
    } else if (slot == VELUM_SLOT_HIGH) {
        uneven = VELUM_MIN(2.0f * kind, 1.0f);
    } else if (slot >= VELUM_SLOT_UNIFORM) {
        uneven = 0.0f;
    }
    return velum_mix(1.0f, VELUM_LEAKY_DEPTH, uneven);
}

/* Share of lines of sight that meet none of the clouds that cover `coverage` of a level plane: a slant line meets more,
 * by how far it goes sideways in the layer (Kauth & Penquite 1967). */
VELUM_FN float velum_free_lines(float coverage, float down, float aside_m, float cloud_m) {
    return VELUM_EXP2((down + aside_m / cloud_m) * VELUM_LOG2(VELUM_MAX(1.0f - coverage, 1.0e-6f)));
}

/* Of what clouds turn back, by the gaps between them. Fitted to the reference, to haze under broken cloud. */
#define VELUM_ASIDE_SHARE 0.641f
/* A sun whose cosine is less meets the sides of clouds, and the sky is bright where they stand closest. */
#define VELUM_ASIDE_LOW 0.3f
VELUM_FN float velum_aside_of(float mu_sun) {
    return VELUM_MIN(VELUM_MAX(mu_sun, 0.0f) * (1.0f / VELUM_ASIDE_LOW), 1.0f);
}

/* Of what a sun on the horizon sends into the sides of clouds, over the sky that they leave. Fitted to the reference,
 * to cumulus, stratocumulus and altocumulus at dusk. */
#define VELUM_SIDES_SHARE 0.425f

VELUM_STRUCT(velum_layer_light) {
    float open;    /* share of the sun's beam that passes the layer above a height, or nearly keeps its way in it */
    float through; /* share of its flux that comes through otherwise */
    float aside;   /* share of it that leaves the clouds sideways and comes down between them */
    float sides;   /* share of it, of a low sun, that meets the sides of clouds, which send it down between them */
};

/* `seen_m`: so far along the way the cloud is known, and none of it counts; 0: nothing is known. */
VELUM_FN velum_layer_light velum_layer_light_at(int slot, velum_slot_fields f, float height_m, float mu_sun,
                                                float seen_m, float cloud_m) {
    velum_layer_light light;
    float over_m = VELUM_MAX(f.top_m - VELUM_MAX(height_m, f.base_m), 0.0f);
    float way_m = over_m / VELUM_MAX(mu_sun, 0.02f);
    float aside_m = VELUM_MAX(way_m - seen_m, 0.0f) * VELUM_SQRT(VELUM_MAX(1.0f - mu_sun * mu_sun, 0.0f));
    float down = seen_m > 0.0f ? 0.0f : over_m / VELUM_MAX(f.top_m - f.base_m, 1.0f);
    float depth = f.extinction_1_m * over_m;
    float unmet = velum_free_lines(f.coverage, down, aside_m, cloud_m);
    float straight = VELUM_EXP(-VELUM_TURNING_SHARE * depth / VELUM_MAX(mu_sun, 0.02f));
    light.open = unmet + (1.0f - unmet) * straight;
    light.through = (1.0f - unmet) *
                    VELUM_MAX(velum_flux_through(velum_leaky_depth(slot, f.kind) * depth, mu_sun) - straight, 0.0f);
    float rest = VELUM_MAX(1.0f - light.open - light.through, 0.0f);
    float high = velum_aside_of(mu_sun);
    float low = mu_sun > 0.0f ? 1.0f - high : 0.0f;
    light.aside = VELUM_ASIDE_SHARE * high * unmet * rest;
    light.sides = VELUM_SIDES_SHARE * low * (1.0f - f.coverage) * rest;
    return light;
}

/* Of cloud that absorbs nothing over ground: together they send back. `mean`: of the ground's colours. */
VELUM_FN float velum_shade_albedo(float reflected, float ground, float mean) {
    float through = 1.0f - reflected;
    return reflected + through * through * ground / VELUM_MAX(1.0f - reflected * mean, 1.0e-6f);
}

/* By height: x, the share of the sun's beam that passes between the clouds above; y, of its flux that comes through
 * them, aside of them and from their sides; z, the reflectance of the clouds below; w, the share of the sky's flux that
 * passes the clouds above. Levels at heights VELUM_SHADE_TOP_M (i / last)^2. */
#define VELUM_SHADE_TOP_M 20000.0f
VELUM_FN float velum_shade_level_of(float height_m) {
    return VELUM_SQRT(velum_clamp(height_m / VELUM_SHADE_TOP_M, 0.0f, 1.0f)) * VELUM_TO_FLOAT(VELUM_SHADE_LEVELS - 1);
}
VELUM_FN float velum_shade_height_m(int level) {
    float x = VELUM_TO_FLOAT(level) / VELUM_TO_FLOAT(VELUM_SHADE_LEVELS - 1);
    return VELUM_SHADE_TOP_M * x * x;
}

#endif
