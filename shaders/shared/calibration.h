/* Measured by tests/accuracy/velum-calibrate over the noise and the profiles; see density.h. Do not edit. */
#ifndef VELUM_CALIBRATION_H
#define VELUM_CALIBRATION_H

#include "slots.h"

/* Factors of a profile's. */
VELUM_STRUCT(velum_calibration) {
    float coverage, density, reach;
};

/* Of one kind of cloud: at half cover and its usual thickness, how that changes with the square root of the share of
 * the optical depth that counts as covered, with each octave of thickness, and from 3/4 cover to overcast. */
VELUM_STRUCT(velum_calibration_row) {
    float thickness_m;
    float s0, s_share, s_octave, s_over_1, s_over_2; /* coverage */
    float w0, w_octave, w_over_1, w_over_2;          /* coverage x density */
    float r0, r_over;                                /* reach */
};

VELUM_FN velum_calibration_row velum_calibration_make(float thickness_m, float s0, float s_share, float s_octave,
                                                      float s_over_1, float s_over_2, float w0, float w_octave,
                                                      float w_over_1, float w_over_2, float r0, float r_over) {
    velum_calibration_row r;
    r.thickness_m = thickness_m;
    r.s0 = s0;
    r.s_share = s_share;
    r.s_octave = s_octave;
    r.s_over_1 = s_over_1;
    r.s_over_2 = s_over_2;
    r.w0 = w0;
    r.w_octave = w_octave;
    r.w_over_1 = w_over_1;
    r.w_over_2 = w_over_2;
    r.r0 = r0;
    r.r_over = r_over;
    return r;
}

VELUM_FN velum_calibration velum_calibration_from(velum_calibration_row r, float coverage, float thickness_m,
                                                  float optical_depth) {
    float share = VELUM_SQRT(VELUM_MIN(0.1f, 0.5f / VELUM_MAX(optical_depth, 1.0e-3f)));
    float octaves = velum_clamp(VELUM_LOG2(VELUM_MAX(thickness_m, 1.0f) / r.thickness_m), -2.0f, 1.5f);
    float t = velum_clamp(4.0f * coverage - 3.0f, 0.0f, 1.0f);
    velum_calibration c;
    c.coverage = (r.s0 + r.s_share * share + r.s_octave * octaves) * (1.0f + t * (r.s_over_1 + t * r.s_over_2));
    c.density = (r.w0 + r.w_octave * octaves) * (1.0f + t * (r.w_over_1 + t * r.w_over_2)) / c.coverage;
    c.reach = r.r0 + r.r_over * t * t;
    return c;
}

VELUM_FN velum_calibration velum_calibration_mix(velum_calibration a, velum_calibration b, float t) {
    velum_calibration c;
    c.coverage = velum_mix(a.coverage, b.coverage, t);
    c.density = velum_mix(a.density, b.density, t);
    c.reach = velum_mix(a.reach, b.reach, t);
    return c;
}

VELUM_FN velum_calibration velum_calibration_of(int slot, float kind, float coverage, float thickness_m,
                                                float optical_depth) {
    velum_calibration_row a;
    velum_calibration_row b;
    float t;
    if (slot == VELUM_SLOT_LOW || slot == VELUM_SLOT_LOW_2) {
        a = velum_calibration_make(500.0f, 1.0835f, 0.4317f, -0.0109f, -0.0270f, 0.0540f, 1.8799f, -0.0446f, -0.0038f,
                                   0.0075f, 2.1771f, 0.0086f);
        b = velum_calibration_make(600.0f, 1.1402f, 0.6111f, -0.0287f, -0.1324f, 0.2569f, 2.7168f, -0.0515f, -0.0280f,
                                   0.0564f, 0.9167f, 0.0103f);
        t = kind;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        a = velum_calibration_make(1400.0f, 1.1505f, 0.5841f, -0.0365f, -0.1278f, 0.2572f, 3.8391f, -0.0625f, -0.0228f,
                                   0.0499f, 0.8706f, 0.0103f);
        b = velum_calibration_make(1400.0f, 1.1537f, 0.5370f, -0.0463f, -0.1568f, 0.3132f, 3.4779f, -0.0460f, -0.0278f,
                                   0.0637f, 0.8887f, 0.0196f);
        t = kind;
    } else if (slot == VELUM_SLOT_STORM) {
        a = velum_calibration_make(10600.0f, 1.8050f, 0.7773f, -0.0946f, -0.1992f, 0.4424f, 6.3035f, -0.0391f, -0.0343f,
                                   0.0843f, 1.0187f, 0.0340f);
        b = velum_calibration_make(10600.0f, 1.8050f, 0.7773f, -0.0946f, -0.1992f, 0.4424f, 6.3035f, -0.0391f, -0.0343f,
                                   0.0843f, 1.0187f, 0.0340f);
        t = 0.0f;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        if (kind < 0.5f) {
            a = velum_calibration_make(2000.0f, 1.0683f, 0.6949f, -0.0191f, -0.0346f, 0.0711f, 2.3984f, -0.0572f,
                                       -0.0051f, 0.0106f, 2.4722f, 0.0029f);
            b = velum_calibration_make(4200.0f, 1.0356f, 0.4809f, -0.0083f, -0.0067f, 0.0134f, 1.8154f, -0.0206f,
                                       0.0000f, -0.0000f, 3.5114f, 0.0018f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(4200.0f, 1.0356f, 0.4809f, -0.0083f, -0.0067f, 0.0134f, 1.8154f, -0.0206f,
                                       0.0000f, -0.0000f, 3.5114f, 0.0018f);
            b = velum_calibration_make(500.0f, 1.1766f, 0.6679f, -0.0403f, -0.1290f, 0.3078f, 4.0182f, -0.1916f,
                                       -0.0429f, 0.1074f, 0.9242f, 0.0189f);
            t = 2.0f * kind - 1.0f;
        }
    } else {
        if (kind < 0.5f) {
            a = velum_calibration_make(1500.0f, 1.1013f, 1.0181f, -0.0285f, -0.1488f, 0.2786f, 3.6320f, -0.1896f,
                                       -0.0300f, 0.0644f, 2.4155f, 0.0199f);
            b = velum_calibration_make(1500.0f, 1.2309f, 1.6475f, -0.1182f, -0.3744f, 0.8581f, 8.6407f, -0.9177f,
                                       -0.1459f, 0.3120f, 1.1092f, 0.0291f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(1500.0f, 1.2309f, 1.6475f, -0.1182f, -0.3744f, 0.8581f, 8.6407f, -0.9177f,
                                       -0.1459f, 0.3120f, 1.1092f, 0.0291f);
            b = velum_calibration_make(500.0f, 1.2259f, 1.0798f, -0.0617f, -0.2311f, 0.6662f, 5.0520f, -0.3437f,
                                       -0.1429f, 0.3386f, 1.0021f, 0.0212f);
            t = 2.0f * kind - 1.0f;
        }
    }
    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),
                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);
}

#endif
