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
    float t = velum_overcast(coverage);
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
        a = velum_calibration_make(500.0f, 1.0537f, 0.4652f, -0.0055f, -0.4197f, 0.3176f, 1.9228f, -0.0327f, -0.2312f,
                                   -0.0594f, 2.2354f, 0.0295f);
        b = velum_calibration_make(600.0f, 1.1614f, 0.9709f, -0.0263f, -0.1436f, 0.1897f, 4.5075f, -0.1573f, -0.0387f,
                                   -0.0218f, 0.9363f, 0.0142f);
        t = kind;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        a = velum_calibration_make(1400.0f, 1.3010f, 0.8008f, -0.1302f, -0.4506f, 1.0154f, 4.1047f, -0.0697f, -0.1582f,
                                   0.3283f, 0.8752f, 0.0370f);
        b = velum_calibration_make(1400.0f, 1.3042f, 0.8117f, -0.1432f, -0.5335f, 1.1991f, 4.1965f, -0.0678f, -0.2018f,
                                   0.4168f, 0.9020f, 0.0438f);
        t = kind;
    } else if (slot == VELUM_SLOT_STORM) {
        a = velum_calibration_make(10600.0f, 1.1284f, 0.6306f, -0.0355f, -0.1113f, 0.2239f, 3.0817f, -0.0251f, -0.0106f,
                                   0.0208f, 0.9637f, 0.0108f);
        b = velum_calibration_make(10600.0f, 1.2577f, 0.8131f, -0.0198f, -0.1109f, 0.0531f, 3.5812f, -0.0453f, -0.5643f,
                                   0.1791f, 1.1198f, -0.0023f);
        t = kind;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        if (kind < 0.5f) {
            a = velum_calibration_make(2000.0f, 1.0226f, 0.4028f, -0.0033f, -0.5873f, 0.5080f, 1.8722f, -0.0481f,
                                       -0.3698f, 0.0729f, 3.6949f, 0.0413f);
            b = velum_calibration_make(4200.0f, 1.0124f, 0.1248f, -0.0018f, -0.6468f, 0.6270f, 1.4141f, -0.0224f,
                                       -0.4751f, 0.2835f, 6.2454f, 0.0776f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(4200.0f, 1.0124f, 0.1248f, -0.0018f, -0.6468f, 0.6270f, 1.4141f, -0.0224f,
                                       -0.4751f, 0.2835f, 6.2454f, 0.0776f);
            b = velum_calibration_make(500.0f, 1.1474f, 0.5554f, -0.0335f, -0.1153f, 0.2334f, 3.9725f, -0.1841f,
                                       -0.0363f, 0.0669f, 0.9207f, 0.0079f);
            t = 2.0f * kind - 1.0f;
        }
    } else {
        if (kind < 0.5f) {
            a = velum_calibration_make(1500.0f, 1.0378f, 0.8141f, -0.0037f, -0.2105f, -0.0174f, 3.0063f, -0.0305f,
                                       -0.1339f, -0.1759f, 3.6000f, 0.0138f);
            b = velum_calibration_make(1500.0f, 0.6592f, 1.5472f, -0.0506f, -0.2914f, 0.6021f, 10.5699f, -0.2579f,
                                       -0.0997f, 0.2257f, 1.3363f, 0.0802f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(1500.0f, 0.6592f, 1.5472f, -0.0506f, -0.2914f, 0.6021f, 10.5699f, -0.2579f,
                                       -0.0997f, 0.2257f, 1.3363f, 0.0802f);
            b = velum_calibration_make(500.0f, 1.2484f, 1.1274f, -0.1242f, -0.5052f, 1.2212f, 6.8409f, -0.5751f,
                                       -0.2774f, 0.6294f, 1.3489f, 0.0810f);
            t = 2.0f * kind - 1.0f;
        }
    }
    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),
                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);
}

#endif
