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
        a = velum_calibration_make(500.0f, 1.0547f, 0.4640f, -0.0053f, -0.4190f, 0.3162f, 1.9213f, -0.0325f, -0.2312f,
                                   -0.0593f, 2.2331f, 0.0303f);
        b = velum_calibration_make(600.0f, 1.1589f, 0.9845f, -0.0265f, -0.1372f, 0.1752f, 4.4694f, -0.1528f, -0.0266f,
                                   -0.0336f, 0.9248f, 0.0163f);
        t = kind;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        a = velum_calibration_make(1400.0f, 1.3110f, 0.5741f, -0.1483f, -0.4691f, 1.0840f, 3.5190f, -0.0468f, -0.1869f,
                                   0.3905f, 0.8783f, 0.0439f);
        b = velum_calibration_make(1400.0f, 1.3027f, 0.5575f, -0.1580f, -0.5249f, 1.2105f, 3.5177f, -0.0429f, -0.2146f,
                                   0.4514f, 0.9018f, 0.0519f);
        t = kind;
    } else if (slot == VELUM_SLOT_STORM) {
        a = velum_calibration_make(10600.0f, 1.1257f, 0.3209f, -0.0360f, -0.1140f, 0.2280f, 2.9930f, -0.0258f, -0.0174f,
                                   0.0349f, 0.9605f, 0.0085f);
        b = velum_calibration_make(10600.0f, 1.3077f, 0.9596f, -0.0092f, -0.1255f, 0.0193f, 3.4413f, -0.0358f, -0.6241f,
                                   0.2111f, 1.1528f, -0.0042f);
        t = kind;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        if (kind < 0.5f) {
            a = velum_calibration_make(2000.0f, 1.0230f, 0.4014f, -0.0035f, -0.5872f, 0.5077f, 1.8727f, -0.0482f,
                                       -0.3698f, 0.0729f, 3.6995f, 0.0405f);
            b = velum_calibration_make(4200.0f, 1.0126f, 0.1241f, -0.0018f, -0.6467f, 0.6268f, 1.4143f, -0.0224f,
                                       -0.4752f, 0.2837f, 6.2517f, 0.0777f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(4200.0f, 1.0126f, 0.1241f, -0.0018f, -0.6467f, 0.6268f, 1.4143f, -0.0224f,
                                       -0.4752f, 0.2837f, 6.2517f, 0.0777f);
            b = velum_calibration_make(500.0f, 1.1462f, 0.5558f, -0.0328f, -0.1110f, 0.2257f, 3.9628f, -0.1855f,
                                       -0.0359f, 0.0664f, 0.9167f, 0.0103f);
            t = 2.0f * kind - 1.0f;
        }
    } else {
        if (kind < 0.5f) {
            a = velum_calibration_make(1500.0f, 1.0378f, 0.8151f, -0.0034f, -0.2098f, -0.0183f, 3.0049f, -0.0304f,
                                       -0.1338f, -0.1761f, 3.5997f, 0.0118f);
            b = velum_calibration_make(1500.0f, 0.6601f, 1.5462f, -0.0478f, -0.2937f, 0.5972f, 10.5516f, -0.2567f,
                                       -0.1061f, 0.2284f, 1.3265f, 0.0787f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(1500.0f, 0.6601f, 1.5462f, -0.0478f, -0.2937f, 0.5972f, 10.5516f, -0.2567f,
                                       -0.1061f, 0.2284f, 1.3265f, 0.0787f);
            b = velum_calibration_make(500.0f, 1.2510f, 1.1294f, -0.1203f, -0.4181f, 1.0499f, 6.8745f, -0.5838f,
                                       -0.2271f, 0.5334f, 1.3372f, 0.0756f);
            t = 2.0f * kind - 1.0f;
        }
    }
    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),
                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);
}

#endif
