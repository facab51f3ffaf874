/* From scene-linear Rec. 709 (exposed: 1 is a white surface that faces the sun) to sRGB code values, compiled as C and
 * as GLSL.
 *
 * AgX (T. Sobotka 2022), with the polynomial for its default contrast and the matrices of B. Wrensch, "Minimal AgX
 * Implementation" (2023). */
#ifndef HOST_TONE_MAP_H
#define HOST_TONE_MAP_H

#ifdef __STDC__
#include <math.h>
#define TONE_FUNCTION static inline
#define TONE_LOG2 log2f
#define TONE_POW powf
#define TONE_MAX fmaxf
#define TONE_MIN fminf
#else
#define TONE_FUNCTION
#define TONE_LOG2 log2
#define TONE_POW pow
#define TONE_MAX max
#define TONE_MIN min
#endif

/* IEC 61966-2-1. */
TONE_FUNCTION float tone_srgb(float linear) {
    float x = TONE_MIN(TONE_MAX(linear, 0.0f), 1.0f);
    return x <= 0.0031308f ? 12.92f * x : 1.055f * TONE_POW(x, 1.0f / 2.4f) - 0.055f;
}

/* Log encoding, then the contrast curve. Of the 16.5 stops of AgX those that a sky has: cloud is the white of this
 * picture, and what tells its shapes is the stop beneath. */
TONE_FUNCTION float tone_curve(float linear) {
    const float lowest_ev = -10.0f, highest_ev = 1.5f;
    float ev = TONE_MIN(TONE_MAX(TONE_LOG2(TONE_MAX(linear, 1e-10f)), lowest_ev), highest_ev);
    float x = (ev - lowest_ev) / (highest_ev - lowest_ev);
    float x2 = x * x;
    float x4 = x2 * x2;
    float y = 15.5f * x4 * x2 - 40.14f * x4 * x + 31.96f * x4 - 6.868f * x2 * x + 0.4298f * x2 + 0.1191f * x - 0.00232f;
    return TONE_MIN(TONE_MAX(y, 0.0f), 1.0f);
}

/* Look: a little more contrast and saturation than AgX's base, which is meant to be graded (ASC CDL: power, then
 * saturation about Rec. 709 luma). */
TONE_FUNCTION float tone_look(float value, float luma, float saturation) {
    return luma + saturation * (value - luma);
}

/* The code value (0..1) of one channel, 0 red, 1 green, 2 blue. */
TONE_FUNCTION float tone_map(float red, float green, float blue, int channel) {
    const float power = 1.12f, saturation = 1.15f;
    float r = TONE_MAX(red, 0.0f), g = TONE_MAX(green, 0.0f), b = TONE_MAX(blue, 0.0f);
    float u = TONE_POW(tone_curve(0.842479062f * r + 0.0784335999f * g + 0.0792237451f * b), power);
    float v = TONE_POW(tone_curve(0.0423282422f * r + 0.878468637f * g + 0.0791661275f * b), power);
    float w = TONE_POW(tone_curve(0.0423756549f * r + 0.0784336f * g + 0.879142974f * b), power);
    float luma = 0.2126f * u + 0.7152f * v + 0.0722f * w;
    u = tone_look(u, luma, saturation);
    v = tone_look(v, luma, saturation);
    w = tone_look(w, luma, saturation);
    float display;
    if (channel == 0) {
        display = 1.19687900f * u - 0.0980208811f * v - 0.0990297441f * w;
    } else if (channel == 1) {
        display = -0.0528968518f * u + 1.15190313f * v - 0.0989611768f * w;
    } else {
        display = -0.0529716355f * u - 0.0980434501f * v + 1.15107367f * w;
    }
    return tone_srgb(TONE_POW(TONE_MAX(display, 0.0f), 2.2f));
}

#endif
