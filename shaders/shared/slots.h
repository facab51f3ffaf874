/* Layers stand in slots: each slot is one kind of cloud with one noise, so that neighbouring cells' layers of the same
 * kind blend. A cell's layers go to slots by genus; see core/slots.c. */
#ifndef VELUM_SLOTS_H
#define VELUM_SLOTS_H

#include "dialect.h"

#define VELUM_SLOT_LOW 0      /* St .. Sc */
#define VELUM_SLOT_LOW_2 1    /* a second, higher one */
#define VELUM_SLOT_CUMULUS 2
#define VELUM_SLOT_STORM 3    /* Cb */
#define VELUM_SLOT_MIDDLE 4   /* As .. Ns .. Ac */
#define VELUM_SLOT_HIGH 5     /* Cs .. Ci .. Cc */
#define VELUM_SLOT_UNIFORM 6  /* for measurements */
#define VELUM_SLOT_UNIFORM_2 7
#define VELUM_SLOT_COUNT 8

/* The parts of a slot: its cloud has the slot's own number; its hem (scud and transition band) and what falls
 * these and the slot's number. */
#define VELUM_PART_HEM 8
#define VELUM_PART_FALL 16
#define VELUM_FRINGE_PARTS 16

/* Place of a genus within its slot, 0..1. */
#define VELUM_KIND_ST 0.0f
#define VELUM_KIND_SC 1.0f
#define VELUM_KIND_AS 0.0f
#define VELUM_KIND_NS 0.5f
#define VELUM_KIND_AC 1.0f
#define VELUM_KIND_CS 0.0f
#define VELUM_KIND_CI 0.5f
#define VELUM_KIND_CC 1.0f
#define VELUM_KIND_CB 1.0f /* towers under an anvil; 0: an anvil alone, as at the edge of a storm */

/* Texels of a page, two textures of R16G16B16A16_UNORM:
 *   A: coverage, base, top, extinction      B: wind x, y, z (ECEF), kind
 * Heights HAE. Extinction is stored as its logarithm, so that it is exact to 2e-4 from 1e-7 to 10 1/m. */
#define VELUM_TEXEL_HEIGHT_MIN_M (-1000.0f)
#define VELUM_TEXEL_HEIGHT_RANGE_M 27000.0f
#define VELUM_TEXEL_WIND_RANGE_M_S 128.0f /* each component within +-this */
#define VELUM_TEXEL_WIND_ZERO (32768.0f / 65535.0f) /* a value that texels can hold: calm air is calm */
#define VELUM_TEXEL_LOG2_EXTINCTION_MIN (-24.0f)
#define VELUM_TEXEL_LOG2_EXTINCTION_RANGE 28.0f

VELUM_FN float velum_texel_height_m(float stored) {
    return VELUM_TEXEL_HEIGHT_MIN_M + stored * VELUM_TEXEL_HEIGHT_RANGE_M;
}
VELUM_FN float velum_texel_from_height(float height_m) {
    return velum_clamp((height_m - VELUM_TEXEL_HEIGHT_MIN_M) / VELUM_TEXEL_HEIGHT_RANGE_M, 0.0f, 1.0f);
}
VELUM_FN float velum_texel_extinction_1_m(float stored) {
    return VELUM_EXP2(VELUM_TEXEL_LOG2_EXTINCTION_MIN + stored * VELUM_TEXEL_LOG2_EXTINCTION_RANGE);
}
VELUM_FN float velum_texel_from_extinction(float extinction_1_m) {
    return velum_clamp((VELUM_LOG2(VELUM_MAX(extinction_1_m, 1.0e-7f)) - VELUM_TEXEL_LOG2_EXTINCTION_MIN) /
                           VELUM_TEXEL_LOG2_EXTINCTION_RANGE,
                       0.0f, 1.0f);
}
VELUM_FN float velum_texel_wind_m_s(float stored) {
    return (stored - VELUM_TEXEL_WIND_ZERO) * (2.0f * VELUM_TEXEL_WIND_RANGE_M_S);
}
VELUM_FN float velum_texel_from_wind(float wind_m_s) {
    return velum_clamp(VELUM_TEXEL_WIND_ZERO + wind_m_s / (2.0f * VELUM_TEXEL_WIND_RANGE_M_S), 0.0f, 1.0f);
}

/* How near to overcast: 0 up to 3/4 cover, 1 at all of it. */
VELUM_FN float velum_overcast(float coverage) {
    return velum_clamp(4.0f * coverage - 3.0f, 0.0f, 1.0f);
}

/* The fields of one slot at one place. */
VELUM_STRUCT(velum_slot_fields) {
    float coverage;
    float base_m, top_m; /* HAE */
    float extinction_1_m;
    float wind_x_m_s, wind_y_m_s, wind_z_m_s;
    float kind;
};

#endif
