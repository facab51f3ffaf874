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
        a = velum_calibration_make(500.0f, 1.0587f, 0.4703f, -0.0081f, -0.0217f, 0.0435f, 1.8791f, -0.0433f, -0.0013f,
                                   0.0026f, 2.1936f, 0.0013f);
        b = velum_calibration_make(600.0f, 1.1194f, 0.4923f, -0.0160f, -0.0860f, 0.1670f, 2.7020f, -0.0546f, -0.0186f,
                                   0.0388f, 0.9129f, 0.0084f);
        t = kind;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        a = velum_calibration_make(1400.0f, 1.3110f, 0.5741f, -0.1483f, -0.4691f, 1.0840f, 3.5190f, -0.0468f, -0.1869f,
                                   0.3905f, 0.8783f, 0.0439f);
        b = velum_calibration_make(1400.0f, 1.3027f, 0.5575f, -0.1580f, -0.5249f, 1.2105f, 3.5177f, -0.0429f, -0.2146f,
                                   0.4514f, 0.9018f, 0.0519f);
        t = kind;
    } else if (slot == VELUM_SLOT_STORM) {
        a = velum_calibration_make(10600.0f, 1.7894f, 0.7280f, -0.0725f, -0.1748f, 0.3653f, 6.1570f, -0.0048f, -0.0196f,
                                   0.0534f, 1.0268f, 0.0197f);
        b = velum_calibration_make(10600.0f, 1.7894f, 0.7280f, -0.0725f, -0.1748f, 0.3653f, 6.1570f, -0.0048f, -0.0196f,
                                   0.0534f, 1.0268f, 0.0197f);
        t = 0.0f;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        if (kind < 0.5f) {
            a = velum_calibration_make(2000.0f, 1.0577f, 0.6739f, -0.0155f, -0.0295f, 0.0589f, 2.3815f, -0.0575f,
                                       -0.0040f, 0.0073f, 2.4658f, 0.0031f);
            b = velum_calibration_make(4200.0f, 1.0343f, 0.4621f, -0.0069f, -0.0041f, 0.0082f, 1.8127f, -0.0214f,
                                       0.0005f, -0.0010f, 3.5140f, -0.0069f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(4200.0f, 1.0343f, 0.4621f, -0.0069f, -0.0041f, 0.0082f, 1.8127f, -0.0214f,
                                       0.0005f, -0.0010f, 3.5140f, -0.0069f);
            b = velum_calibration_make(500.0f, 1.1462f, 0.5558f, -0.0328f, -0.1110f, 0.2257f, 3.9628f, -0.1855f,
                                       -0.0359f, 0.0664f, 0.9167f, 0.0103f);
            t = 2.0f * kind - 1.0f;
        }
    } else {
        if (kind < 0.5f) {
            a = velum_calibration_make(1500.0f, 1.0820f, 0.9997f, -0.0316f, -0.0916f, 0.1828f, 3.5877f, -0.1769f,
                                       -0.0188f, 0.0493f, 2.3924f, 0.0246f);
            b = velum_calibration_make(1500.0f, 1.1950f, 1.4167f, -0.0925f, -0.2696f, 0.5935f, 8.0529f, -0.8121f,
                                       -0.0837f, 0.2012f, 1.0818f, 0.0295f);
            t = 2.0f * kind;
        } else {
            a = velum_calibration_make(1500.0f, 1.1950f, 1.4167f, -0.0925f, -0.2696f, 0.5935f, 8.0529f, -0.8121f,
                                       -0.0837f, 0.2012f, 1.0818f, 0.0295f);
            b = velum_calibration_make(500.0f, 1.1786f, 0.9679f, -0.0610f, -0.2255f, 0.5068f, 4.8630f, -0.3396f,
                                       -0.0893f, 0.2080f, 0.9751f, 0.0238f);
            t = 2.0f * kind - 1.0f;
        }
    }
    return velum_calibration_mix(velum_calibration_from(a, coverage, thickness_m, optical_depth),
                                 velum_calibration_from(b, coverage, thickness_m, optical_depth), t);
}

#endif
