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
    float r0, r_over_1, r_over_2;                    /* reach */
};

VELUM_FN velum_calibration_row velum_calibration_make(float thickness_m, float s0, float s_share, float s_octave,
                                                      float s_over_1, float s_over_2, float w0, float w_octave,
                                                      float w_over_1, float w_over_2, float r0, float r_over_1,
                                                      float r_over_2) {
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
    r.r_over_1 = r_over_1;
    r.r_over_2 = r_over_2;
    return r;
}

VELUM_FN velum_calibration velum_calibration_from(velum_calibration_row r, float coverage, float thickness_m,
                                                  float optical_depth) {
    float share = VELUM_SQRT(VELUM_MIN(0.1f, 0.5f / VELUM_MAX(optical_depth, 1.0e-3f)));
    float octaves = velum_clamp(VELUM_LOG2(VELUM_MAX(thickness_m, 1.0f) / r.thickness_m), -2.0f, 1.5f);
    float t = velum_overcast(coverage);
    velum_calibration c;
    c.coverage = (r.s0 + r.s_share * share + r.s_octave * octaves) * (1.0f + t * (r.s_over_1 + t * r.s_over_2));
    c.density = (r.w0 + r.w_octave * octaves) * (1.0f + t * (r.w_over_1 + t * r.w_over_2)) / c.coverage;
    c.reach = r.r0 * (1.0f + t * (r.r_over_1 + t * r.r_over_2));
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
        a = velum_calibration_make(500.0f, 1.0849f, 0.7852f, -0.0048f, -0.3695f, 0.2125f, 2.0612f, -0.0329f, -0.1892f,
                                   -0.1439f, 2.2414f, -0.0109f, 0.0213f);
        b = velum_calibration_make(600.0f, 1.1614f, 0.9709f, -0.0263f, -0.1436f, 0.1897f, 4.5075f, -0.1573f, -0.0387f,
                                   -0.0218f, 0.9363f, -0.0185f, 0.0336f);
        t = kind;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        a = velum_calibration_make(1400.0f, 1.2853f, 0.8752f, 0.0074f, -0.2333f, 0.4375f, 5.7877f, 0.0198f, -0.1484f,
                                   0.1647f, 0.8210f, -0.0325f, 0.0448f);
        b = a;
        t = 0.0f;
    } else if (slot == VELUM_SLOT_STORM) {
        a = velum_calibration_make(10600.0f, 1.1343f, 0.0143f, -0.1918f, -0.1491f, 0.0405f, 3.8006f, -0.0538f, -0.8305f,
                                   0.2666f, 0.8846f, 0.4374f, -0.3065f);
        b = a;
        t = 0.0f;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        if (kind < 0.5f) {
            a = velum_calibration_make(2000.0f, 1.0463f, 0.7841f, -0.0031f, -0.5229f, 0.3774f, 2.0242f, -0.0491f,
                                       -0.3175f, -0.0319f, 3.7013f, -0.0093f, 0.0187f);
            b = velum_calibration_make(4200.0f, 1.0273f, 0.4733f, -0.0020f, -0.6127f, 0.5587f, 1.5750f, -0.0238f,
                                       -0.3926f, 0.1186f, 6.2509f, -0.0115f, 0.0231f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(4200.0f, 1.0273f, 0.4733f, -0.0020f, -0.6127f, 0.5587f, 1.5750f, -0.0238f,
                                       -0.3926f, 0.1186f, 6.2509f, -0.0115f, 0.0231f);
            b = velum_calibration_make(500.0f, 1.1587f, 0.6943f, -0.0323f, -0.1004f, 0.2078f, 4.0332f, -0.1817f,
                                       -0.0387f, 0.0642f, 0.9184f, -0.0189f, 0.0262f);
            t = 2.0f * kind - 1.0f;
        }
    } else {
        if (kind < 0.5f) {
            a = velum_calibration_make(1500.0f, 1.0378f, 0.8141f, -0.0037f, -0.2105f, -0.0174f, 3.0063f, -0.0305f,
                                       -0.1339f, -0.1759f, 3.6000f, -0.0049f, 0.0087f);
            b = velum_calibration_make(1500.0f, 0.6592f, 1.5472f, -0.0506f, -0.2914f, 0.6021f, 10.5699f, -0.2579f,
                                       -0.0997f, 0.2257f, 1.3363f, 0.0559f, 0.0041f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(1500.0f, 0.6592f, 1.5472f, -0.0506f, -0.2914f, 0.6021f, 10.5699f, -0.2579f,
                                       -0.0997f, 0.2257f, 1.3363f, 0.0559f, 0.0041f);
            b = velum_calibration_make(500.0f, 1.2484f, 1.1274f, -0.1242f, -0.5052f, 1.2212f, 6.8409f, -0.5751f,
                                       -0.2774f, 0.6294f, 1.3489f, -0.0392f, 0.0993f);
            t = 2.0f * kind - 1.0f;
        }
    }
    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),
                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);
}

#endif
