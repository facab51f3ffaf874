/* From fields and noise to extinction: what the march, the shadow maps and the CPU's queries have in common. */
#ifndef VELUM_SAMPLE_H
#define VELUM_SAMPLE_H

#include "density.h"
#include "fibre.h"

#ifndef VULKAN
#include <stdbool.h>
#endif

/* Two drift phases' ranks in one. w0 r0 + w1 r1 of two uniform numbers has a trapezoid for a density; its distribution
 * function makes it uniform again, so coverage stays what it is while the phases fade. */
VELUM_FN float velum_rank_mix(float r0, float r1, float w1) {
    float w = velum_clamp(w1, 0.0f, 1.0f);
    float x = (1.0f - w) * r0 + w * r1;
    float a = VELUM_MIN(w, 1.0f - w);
    float b = 1.0f - a;
    float rank = x;
    if (a > 1.0e-4f) {
        float scale = 0.5f / (a * b);
        if (x < a) {
            rank = x * x * scale;
        } else if (x <= b) {
            rank = (x - 0.5f * a) / b;
        } else {
            rank = 1.0f - (1.0f - x) * (1.0f - x) * scale;
        }
    }
    return rank;
}

/* Two drift phases' lumps or fine detail (0..1, mean 0.5) in one: the contrast stays while they fade. */
VELUM_FN float velum_detail_mix(float d0, float d1, float w1) {
    float w = velum_clamp(w1, 0.0f, 1.0f);
    float v = 1.0f - w;
    float x = (v * (d0 - 0.5f) + w * (d1 - 0.5f)) / VELUM_SQRT(v * v + w * w);
    return velum_clamp(0.5f + x, 0.0f, 1.0f);
}

/* The blend of two weather states: coverage fades; the rest is weighted by it, so that a cloud that only one state has
 * keeps its height. */
VELUM_FN float velum_fields_share(velum_slot_fields a, velum_slot_fields b, float t) {
    float wa = (1.0f - t) * a.coverage;
    float wb = t * b.coverage;
    float sum = wa + wb;
    return sum > 1.0e-9f ? wb / sum : 0.0f;
}
VELUM_FN velum_slot_fields velum_fields_mix(velum_slot_fields a, velum_slot_fields b, float t) {
    float sum = (1.0f - t) * a.coverage + t * b.coverage;
    float s = velum_fields_share(a, b, t);
    velum_slot_fields f;
    f.coverage = sum;
    f.base_m = velum_mix(a.base_m, b.base_m, s);
    f.top_m = velum_mix(a.top_m, b.top_m, s);
    f.extinction_1_m = VELUM_EXP2(velum_mix(VELUM_LOG2(VELUM_MAX(a.extinction_1_m, 1.0e-7f)),
                                            VELUM_LOG2(VELUM_MAX(b.extinction_1_m, 1.0e-7f)), s));
    f.wind_x_m_s = velum_mix(a.wind_x_m_s, b.wind_x_m_s, s);
    f.wind_y_m_s = velum_mix(a.wind_y_m_s, b.wind_y_m_s, s);
    f.wind_z_m_s = velum_mix(a.wind_z_m_s, b.wind_z_m_s, s);
    f.kind = velum_mix(a.kind, b.kind, s);
    return f;
}

/* The fields that two texels of a page stand for, each value 0..1. */
VELUM_FN velum_slot_fields velum_fields_of_texels(float a0, float a1, float a2, float a3, float b0, float b1, float b2,
                                                  float b3) {
    velum_slot_fields f;
    f.coverage = a0;
    f.base_m = velum_texel_height_m(a1);
    f.top_m = velum_texel_height_m(a2);
    f.extinction_1_m = velum_texel_extinction_1_m(a3);
    f.wind_x_m_s = velum_texel_wind_m_s(b0);
    f.wind_y_m_s = velum_texel_wind_m_s(b1);
    f.wind_z_m_s = velum_texel_wind_m_s(b2);
    f.kind = b3;
    return f;
}

/* Whether a pixel so far away shows the fine noise at all; elsewhere it counts as 0.5. Of fibres, which are all that
 * cirrus shows, so far that one is some ten pixels wide in a picture of 1920 over 60 degrees. */
VELUM_FN bool velum_shows_fine(float distance_m, float period_inv_1_m, float stretch) {
    return distance_m * period_inv_1_m < (stretch < 1.0f ? 150.0f : 50.0f);
}

VELUM_STRUCT(velum_noise_point) {
    float x, y, z;
};

VELUM_FN float velum_trail_reach_m(int slot, velum_slot_fields f) {
    float thickness_m = VELUM_MAX(f.top_m - f.base_m, 1.0f);
    return velum_fibrous(slot, f.kind) * VELUM_MIN(VELUM_TRAIL_M, VELUM_TRAIL_MOST * thickness_m);
}

/* Of velum_lean, m over a metre of height, at most. */
VELUM_FN float velum_lean_slope(int slot, velum_slot_fields f) {
    float trail_m = velum_trail_reach_m(slot, f);
    return slot == VELUM_SLOT_STORM ? 2.0f * VELUM_ANVIL_LAG_MOST + VELUM_STORM_TURRETS
                                    : velum_turrets(slot) + 2.0f * trail_m / VELUM_MAX(f.top_m - f.base_m, 1.0f);
}

/* Where else than over its foot a column's noise is looked up at a height, m: cumulus have it from their base. Ice that
 * falls out of cirrus is left behind to the west, by the wind that grows with height, on a parabola (Marshall 1953).
 * The wind bends storms, anvils most. */
VELUM_FN velum_noise_point velum_lean(int slot, velum_slot_fields f, float height_m, float normal_x, float normal_y,
                                      float normal_z) {
    float thickness_m = VELUM_MAX(f.top_m - f.base_m, 1.0f);
    float depth = velum_clamp((f.top_m - height_m) / thickness_m, 0.0f, 1.0f);
    float over_m = VELUM_MIN(VELUM_MAX(height_m - f.base_m, 0.0f), VELUM_CUMULUS_TURNS_M);
    float turned_m = velum_turrets(slot) * (slot == VELUM_SLOT_STORM ? height_m : over_m);
    velum_noise_point p;
    if (slot == VELUM_SLOT_STORM) {
        float lag_s = velum_anvil_lag_s(f) * (1.0f - depth) * (1.0f - depth);
        p.x = turned_m * normal_x - f.wind_x_m_s * lag_s;
        p.y = turned_m * normal_y - f.wind_y_m_s * lag_s;
        p.z = turned_m * normal_z - f.wind_z_m_s * lag_s;
    } else {
        float east = VELUM_MAX(VELUM_SQRT(normal_x * normal_x + normal_y * normal_y), 2.0e-3f);
        float scale = velum_trail_reach_m(slot, f) * depth * depth / east;
        p.x = turned_m * normal_x - normal_y * scale;
        p.y = turned_m * normal_y + normal_x * scale;
        p.z = turned_m * normal_z;
    }
    return p;
}

/* Where the offset r from the eye lies in a noise: phase of the eye, plus the turned offset over the period. Where that
 * is stretched, across fibres it goes by `across_m` (velum_north_m and waves). */
VELUM_FN velum_noise_point velum_noise_place(float phase_x, float phase_y, float phase_z, float period_inv_1_m,
                                             float stretch, float across_m, float rx, float ry, float rz) {
    velum_noise_point p;
    float x = stretch * rx;
    float y = stretch * ry;
    float z = stretch * rz + (1.0f - stretch) * across_m;
    p.x = phase_x + (VELUM_NOISE_AX * x + VELUM_NOISE_AY * y + VELUM_NOISE_AZ * z) * period_inv_1_m;
    p.y = phase_y + (VELUM_NOISE_BX * x + VELUM_NOISE_BY * y + VELUM_NOISE_BZ * z) * period_inv_1_m;
    p.z = phase_z + (VELUM_NOISE_CX * x + VELUM_NOISE_CY * y + VELUM_NOISE_CZ * z) * period_inv_1_m;
    return p;
}

/* Extinction, 1/m, at height (HAE) in a column of that rank; 0 outside the layer. Lump -1..1, fine 0..1. */
VELUM_FN float velum_slot_extinction(int slot, velum_slot_fields f, float height_m, float rank, float lump,
                                     float fine) {
    float extinction = 0.0f;
    if (slot >= VELUM_SLOT_UNIFORM) {
        if (height_m >= f.base_m && height_m <= f.top_m && f.coverage >= 0.5f) {
            extinction = f.extinction_1_m;
        }
    } else {
        float over_m = height_m - f.base_m;
        float z = over_m / VELUM_MAX(f.top_m - f.base_m, 1.0f);
        if (z > 0.0f && z < 1.0f && f.coverage > 0.0f) {
            velum_profile profile = velum_profile_of(slot, f);
            float e = velum_excess(profile, f.coverage, rank);
            if (e > 0.0f) {
                extinction = f.extinction_1_m * velum_body(profile, e, z, over_m, lump, fine);
            }
        }
    }
    return extinction;
}

#endif
