/* Where a place lies across the fibres of high cloud.
 *
 * Air that is colder towards the pole makes the wind grow eastward with height (thermal wind: Holton 2004, section
 * 3.4), and ice that falls through it is drawn out from west to east. So the noise of high cloud keeps its scale from
 * south to north and is stretched along parallels; waves of the air bend those. */
#ifndef VELUM_FIBRE_H
#define VELUM_FIBRE_H

#include "noise_axes.h"
#include "planet.h"

/* Waves run along the axes of noise, each of a length of its own; as steep as this, at most, against parallels. */
#define VELUM_WAVE_X_M 17000.0f
#define VELUM_WAVE_Y_M 23000.0f
#define VELUM_WAVE_Z_M 13000.0f
#define VELUM_WAVE_SLOPE 0.25f
/* By how much a place's metres across fibres (velum_north_m and waves) change over a metre, at most. */
#define VELUM_FIBRE_SLOPE 1.5f

/* Metres of noise over a metre, at most. */
VELUM_FN float velum_noise_run(float stretch) {
    return stretch + (1.0f - stretch) * VELUM_FIBRE_SLOPE;
}

/* Metres by which the point r from an eye (ECEF) lies north of it: along meridians of a sphere, by geocentric latitude.
 * Right to 90 degrees. */
VELUM_FN float velum_north_m(float eye_x, float eye_y, float eye_z, float rx, float ry, float rz) {
    float eye_out = VELUM_MAX(VELUM_SQRT(eye_x * eye_x + eye_y * eye_y), 1.0f);
    float grown = 2.0f * (eye_x * rx + eye_y * ry) + rx * rx + ry * ry;
    float x = eye_x + rx;
    float y = eye_y + ry;
    float point_out = VELUM_SQRT(x * x + y * y);
    float across = rz * eye_out - eye_z * grown / (point_out + eye_out);
    float along = point_out * eye_out + (eye_z + rz) * eye_z;
    float tangent = across / VELUM_MAX(along + VELUM_SQRT(across * across + along * along), 1.0f);
    tangent = velum_clamp(tangent, -1.0f, 1.0f);
    /* Arctangent: Abramowitz & Stegun 1964, 4.4.49. */
    float t2 = tangent * tangent;
    float turned =
        1.0f + t2 * (-0.3333314528f +
                     t2 * (0.1999355085f +
                           t2 * (-0.1420889944f +
                                 t2 * (0.1065626393f +
                                       t2 * (-0.0752896400f +
                                             t2 * (0.0429096138f + t2 * (-0.0161657367f + t2 * 0.0028662257f)))))));
    return 2.0f * VELUM_WGS84_A_M * tangent * turned;
}

/* -1..1, of period 1: parabolas in place of a sine. */
VELUM_FN float velum_wave(float x) {
    float u = x - VELUM_FLOOR(x + 0.5f);
    return 16.0f * u * (0.5f - VELUM_ABS(u));
}

/* Metres by which waves bend fibres to the north over and under a point (ECEF). */
VELUM_FN float velum_waves_m(float x_m, float y_m, float z_m) {
    float scale = VELUM_WGS84_A_M / VELUM_MAX(VELUM_SQRT(x_m * x_m + y_m * y_m + z_m * z_m), 1.0f);
    float x = (VELUM_NOISE_AX * x_m + VELUM_NOISE_AY * y_m + VELUM_NOISE_AZ * z_m) * scale / VELUM_WAVE_X_M;
    float y = (VELUM_NOISE_BX * x_m + VELUM_NOISE_BY * y_m + VELUM_NOISE_BZ * z_m) * scale / VELUM_WAVE_Y_M;
    float z = (VELUM_NOISE_CX * x_m + VELUM_NOISE_CY * y_m + VELUM_NOISE_CZ * z_m) * scale / VELUM_WAVE_Z_M;
    /* A parabola's greatest slope is 8 over its period. */
    return VELUM_WAVE_SLOPE / 8.0f *
           (VELUM_WAVE_X_M * velum_wave(x) + VELUM_WAVE_Y_M * velum_wave(y) + VELUM_WAVE_Z_M * velum_wave(z));
}

#endif
