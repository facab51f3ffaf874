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
        a = velum_calibration_make(500.0f, 1.0665f, 0.4658f, -0.0106f, -0.0197f, 0.0393f, 1.8766f, -0.0451f, -0.0026f,
                                   0.0053f, 2.1770f, 0.0063f);
        b = velum_calibration_make(600.0f, 1.1098f, 0.5207f, -0.0190f, -0.0945f, 0.1777f, 2.6944f, -0.0504f, -0.0184f,
                                   0.0331f, 0.9139f, 0.0070f);
        t = kind;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        a = velum_calibration_make(1400.0f, 1.2229f, 0.6073f, -0.1176f, -0.4152f, 0.8674f, 3.2508f, -0.0347f, -0.1154f,
                                   0.2487f, 0.8558f, 0.0411f);
        b = velum_calibration_make(1400.0f, 1.2234f, 0.5970f, -0.1251f, -0.4640f, 0.9573f, 3.2625f, -0.0293f, -0.1362f,
                                   0.2845f, 0.8817f, 0.0449f);
        t = kind;
    } else if (slot == VELUM_SLOT_STORM) {
        a = velum_calibration_make(10600.0f, 1.7917f, 0.7563f, -0.0881f, -0.1686f, 0.3694f, 6.1108f, -0.0379f, -0.0249f,
                                   0.0622f, 1.0183f, 0.0300f);
        b = velum_calibration_make(10600.0f, 1.7917f, 0.7563f, -0.0881f, -0.1686f, 0.3694f, 6.1108f, -0.0379f, -0.0249f,
                                   0.0622f, 1.0183f, 0.0300f);
        t = 0.0f;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        if (kind < 0.5f) {
            a = velum_calibration_make(2000.0f, 1.0576f, 0.6875f, -0.0154f, -0.0226f, 0.0504f, 2.3876f, -0.0580f,
                                       0.0036f, -0.0001f, 2.4714f, -0.0013f);
            b = velum_calibration_make(4200.0f, 1.0315f, 0.4697f, -0.0068f, -0.0051f, 0.0102f, 1.8105f, -0.0207f,
                                       0.0001f, -0.0001f, 3.5104f, 0.0009f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(4200.0f, 1.0315f, 0.4697f, -0.0068f, -0.0051f, 0.0102f, 1.8105f, -0.0207f,
                                       0.0001f, -0.0001f, 3.5104f, 0.0009f);
            b = velum_calibration_make(500.0f, 1.1521f, 0.5358f, -0.0307f, -0.0917f, 0.1949f, 3.9683f, -0.1878f,
                                       -0.0216f, 0.0586f, 0.9229f, 0.0132f);
            t = 2.0f * kind - 1.0f;
        }
    } else {
        if (kind < 0.5f) {
            a = velum_calibration_make(1500.0f, 1.0789f, 1.0258f, -0.0302f, -0.1238f, 0.2255f, 3.6067f, -0.1907f,
                                       -0.0264f, 0.0530f, 2.4155f, 0.0137f);
            b = velum_calibration_make(1500.0f, 1.1910f, 1.4161f, -0.0923f, -0.2634f, 0.5827f, 8.2647f, -0.8833f,
                                       -0.0940f, 0.1879f, 1.1024f, 0.0191f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(1500.0f, 1.1910f, 1.4161f, -0.0923f, -0.2634f, 0.5827f, 8.2647f, -0.8833f,
                                       -0.0940f, 0.1879f, 1.1024f, 0.0191f);
            b = velum_calibration_make(500.0f, 1.1863f, 0.9376f, -0.0526f, -0.1604f, 0.4183f, 4.9070f, -0.3380f,
                                       -0.0801f, 0.1911f, 0.9893f, 0.0197f);
            t = 2.0f * kind - 1.0f;
        }
    }
    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),
                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);
}

#endif
