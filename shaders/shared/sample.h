/* From the fields of a slot and noise to extinction at a point. */
#ifndef VELUM_SAMPLE_H
#define VELUM_SAMPLE_H

#include "density.h"

/* Mix of two independent ranks, uniform again: the distribution of w0 r0 + w1 r1 is a trapezium (Irwin-Hall for two
 * weighted uniforms), and its cumulative function makes it flat. */
VELUM_FN float velum_rank_mix(float r0, float r1, float w1) {
    float w0 = 1.0f - w1;
    float a = VELUM_MIN(w0, w1);
    float b = VELUM_MAX(w0, w1);
    float x = w0 * r0 + w1 * r1;
    if (a < 1.0e-4f) {
        return x;
    }
    if (x < a) {
        return x * x / (2.0f * a * b);
    }
    if (x <= b) {
        return (x - 0.5f * a) / b;
    }
    return 1.0f - (1.0f - x) * (1.0f - x) / (2.0f * a * b);
}

/* Two weather states: coverage is mixed; what a layer is like, by how much of it each state has. */
VELUM_FN velum_slot_fields velum_fields_mix(velum_slot_fields a, velum_slot_fields b, float t) {
    velum_slot_fields f;
    float wa = (1.0f - t) * a.coverage;
    float wb = t * b.coverage;
    float s = wa + wb > 1.0e-6f ? wb / (wa + wb) : t;
    f.coverage = wa + wb;
    f.base_m = velum_mix(a.base_m, b.base_m, s);
    f.top_m = velum_mix(a.top_m, b.top_m, s);
    f.extinction_1_m = VELUM_EXP2(
        velum_mix(VELUM_LOG2(VELUM_MAX(a.extinction_1_m, 1.0e-7f)), VELUM_LOG2(VELUM_MAX(b.extinction_1_m, 1.0e-7f)), s));
    f.wind_x_m_s = velum_mix(a.wind_x_m_s, b.wind_x_m_s, s);
    f.wind_y_m_s = velum_mix(a.wind_y_m_s, b.wind_y_m_s, s);
    f.wind_z_m_s = velum_mix(a.wind_z_m_s, b.wind_z_m_s, s);
    f.kind = velum_mix(a.kind, b.kind, s);
    return f;
}

/* Extinction of a slot, 1/m. rank: of the column, 0..1; lump: -1..1; fine: 0..1. */
VELUM_FN float velum_slot_extinction(int slot, velum_slot_fields f, float height_m, float rank, float lump, float fine) {
    if (f.coverage <= 0.0f || height_m < f.base_m || height_m > f.top_m) {
        return 0.0f;
    }
    if (slot >= VELUM_SLOT_UNIFORM) {
        return f.coverage >= 0.5f ? f.extinction_1_m : 0.0f;
    }
    velum_profile profile = velum_profile_of(slot, f.kind);
    float e = velum_excess(profile, f.coverage, rank);
    if (e <= 0.0f) {
        return 0.0f;
    }
    float z = (height_m - f.base_m) / VELUM_MAX(f.top_m - f.base_m, 1.0f);
    return f.extinction_1_m * velum_body(profile, e, z, height_m - f.base_m, lump, fine);
}

#endif
