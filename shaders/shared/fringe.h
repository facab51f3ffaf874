/* What a layer has beyond its cloud proper: scud under its base, a band over which it thins out, and what falls from
 * it. Base, top, coverage and water path of the layer are those of the cloud proper (density.h).
 *
 * Precipitation falls from columns that are thick enough, as streaks that lag behind the cloud where the wind is weaker
 * below (parabolas; Marshall 1953), and evaporates on its way. Of Sundqvist's (1988) evaporation, in proportion to the
 * dryness of the air and to the square root of the rate, 1e-5 s-1 (kg m-2 s-1)^-1/2 (the upper of CAM3's values for
 * sheets; Collins et al. 2004, table C.1), in air of 1.1 kg/m3 whose relative humidity falls by 1 in 2500 m below the
 * base, follows in closed form: the square root of the rate falls by the share
 * (depth / reach)^2, where reach = 3900 m R^1/4, R in mm/h at the base. What has not come down by then is virga. */
#ifndef VELUM_FRINGE_H
#define VELUM_FRINGE_H

#include "density.h"

/* Texels of a page of fringes, one texture of R16G16B16A16_UNORM: scud; transition; fourth root of the rate; kind. */
#define VELUM_TEXEL_TRANSITION_RANGE_M 25000.0f
#define VELUM_TEXEL_FALL_RANGE 4.8f /* 530 mm/h */

/* The fringe of a slot at a place. */
VELUM_STRUCT(velum_fringe) {
    float scud;         /* 0..1 */
    float transition_m; /* depth of the band under the base and over tops; 0: none */
    float fall;         /* fourth root of the rate at the base in mm/h; 0: dry */
    float fall_kind;    /* VELUM_FALL_* */
};

/* Kinds of what falls, 0..1 so that they blend: by size, the largest drops first. */
#define VELUM_FALL_SHOWER 0.0f
#define VELUM_FALL_RAIN 0.25f
#define VELUM_FALL_DRIZZLE 0.5f
#define VELUM_FALL_SLEET 0.75f
#define VELUM_FALL_SNOW 1.0f

/* Extinction of 1 mm/h, 1/m, and its power of the rate: pi N0 / L^3 of exponential spectra N0 exp(-L D), L as R^-0.21
 * (efficiency 2). Showers and drizzle: Joss et al. 1968; rain: Marshall & Palmer 1948. Snow: Gunn & Marshall 1958, of
 * melted diameters, with flakes of a tenth of the density of water, whose sections are 10^(2/3) as large: nine times the
 * rain's, and what Stallabrass (1985) measured, 10.36e-3 C^0.78 of C g/m3, falling at 1.2 m/s. */
#define VELUM_SHOWER_1_M 1.629e-4f
#define VELUM_RAIN_1_M 3.647e-4f
#define VELUM_DRIZZLE_1_M 5.089e-4f
#define VELUM_SNOW_1_M 3.342e-3f
#define VELUM_RAIN_POWER 0.63f
#define VELUM_SNOW_POWER 0.57f
/* Mean speeds of fall. */
#define VELUM_SHOWER_M_S 7.0f
#define VELUM_RAIN_M_S 5.0f
#define VELUM_DRIZZLE_M_S 2.5f
#define VELUM_SNOW_M_S 1.2f

#define VELUM_FALL_REACH_M 3900.0f
#define VELUM_FALL_FLOOR_M (-600.0f) /* no surface lies lower (HAE) */
/* Below the base the wind is less by that share of the layer's own a metre. */
#define VELUM_FALL_SHEAR_1_M (1.0f / 6000.0f)
/* Over the base it comes from as much of the layer. */
#define VELUM_FALL_JOIN 0.2f
#define VELUM_FALL_JOIN_MOST_M 400.0f
/* Excess rank from where it rains to where it rains in full; streaks, over the mean. */
#define VELUM_FALL_RIM 0.3f
#define VELUM_FALL_STREAKS 0.6f
#define VELUM_FALL_FINE 0.4f

/* Scud: as deep as this under the base, no lower than that share of the base's own height; not thicker than cloud. */
#define VELUM_SCUD_SHALLOW_M 120.0f
#define VELUM_SCUD_DEEP_M 380.0f
#define VELUM_SCUD_LOWEST 0.3f
#define VELUM_SCUD_OVER_M 60.0f /* into the cloud, no more than a share of it */
#define VELUM_SCUD_OVER 0.12f
#define VELUM_SCUD_HANGS_M 240.0f /* so much lower ends what has no cloud over it */
#define VELUM_SCUD_SHARE 0.5f
#define VELUM_SCUD_MOST_1_M 0.04f
#define VELUM_SCUD_RIM 0.15f /* excess rank */
#define VELUM_SCUD_SOFTNESS 0.15f
#define VELUM_SCUD_FULL 0.65f /* rank of its noise down to which the fullest scud reaches, from above */
#define VELUM_SCUD_FINE 0.35f /* of its noise */
#define VELUM_SCUD_LUMPS 3.0f /* so many times finer than the cloud's */
/* Transition band: of the layer's extinction where the cloud proper ends; and it goes as deep into the cloud. */
#define VELUM_BAND_SHARE 0.5f
#define VELUM_BAND_JOIN 0.12f
#define VELUM_BAND_JOIN_MOST_M 60.0f

VELUM_FN velum_fringe velum_fringe_of_texel(float c0, float c1, float c2, float c3) {
    velum_fringe g;
    g.scud = c0;
    g.transition_m = c1 * VELUM_TEXEL_TRANSITION_RANGE_M;
    g.fall = c2 * VELUM_TEXEL_FALL_RANGE;
    g.fall_kind = c3;
    return g;
}

/* Of two states, `share` that of the second (by coverage: velum_fields_share). */
VELUM_FN velum_fringe velum_fringe_mix(velum_fringe a, velum_fringe b, float share) {
    velum_fringe g;
    g.scud = velum_mix(a.scud, b.scud, share);
    g.transition_m = velum_mix(a.transition_m, b.transition_m, share);
    g.fall = velum_mix(a.fall, b.fall, share);
    float second = share * b.fall;
    g.fall_kind = velum_mix(a.fall_kind, b.fall_kind, g.fall > 1.0e-9f ? second / g.fall : 0.0f);
    return g;
}

/* Of the rate whose fourth root is given, 1/m. */
VELUM_FN float velum_fall_extinction_1_m(float fall, float kind) {
    float of_one = velum_mix(VELUM_SHOWER_1_M, VELUM_RAIN_1_M, velum_clamp(4.0f * kind, 0.0f, 1.0f));
    of_one = velum_mix(of_one, VELUM_DRIZZLE_1_M, velum_clamp(4.0f * kind - 1.0f, 0.0f, 1.0f));
    float snow = velum_clamp(2.0f * kind - 1.0f, 0.0f, 1.0f);
    of_one = velum_mix(of_one, VELUM_SNOW_1_M, snow);
    float power = 4.0f * velum_mix(VELUM_RAIN_POWER, VELUM_SNOW_POWER, snow);
    return fall > 0.0f ? of_one * VELUM_POW(fall, power) : 0.0f;
}

VELUM_FN float velum_fall_speed_m_s(float kind) {
    float speed = velum_mix(VELUM_SHOWER_M_S, VELUM_RAIN_M_S, velum_clamp(4.0f * kind, 0.0f, 1.0f));
    speed = velum_mix(speed, VELUM_DRIZZLE_M_S, velum_clamp(4.0f * kind - 1.0f, 0.0f, 1.0f));
    return velum_mix(speed, VELUM_SNOW_M_S, velum_clamp(2.0f * kind - 1.0f, 0.0f, 1.0f));
}

/* Fourth root of the rate that is left so deep under the base. */
VELUM_FN float velum_fall_left(float fall, float depth_m) {
    float x = VELUM_MAX(depth_m, 0.0f) / VELUM_MAX(VELUM_FALL_REACH_M * fall, 1.0f);
    return fall * VELUM_SQRT(VELUM_MAX(1.0f - x * x, 0.0f));
}

/* The layer's own wind over so long lies between what falls there and the column that it came from. */
VELUM_FN float velum_fall_lag_s(velum_fringe g, float depth_m) {
    float d = VELUM_MAX(depth_m, 0.0f);
    return 0.5f * VELUM_FALL_SHEAR_1_M * d * d / velum_fall_speed_m_s(g.fall_kind);
}

VELUM_FN float velum_fall_join_m(velum_slot_fields f) {
    return VELUM_MIN(VELUM_FALL_JOIN * (f.top_m - f.base_m), VELUM_FALL_JOIN_MOST_M);
}

/* Heights of what falls, and of scud: low, high. */
VELUM_STRUCT(velum_span_m) {
    float low, high;
};

VELUM_FN velum_span_m velum_fall_span(velum_slot_fields f, velum_fringe g) {
    velum_span_m s;
    s.low = VELUM_MAX(f.base_m - VELUM_FALL_REACH_M * g.fall, VELUM_FALL_FLOOR_M);
    s.high = f.base_m + velum_fall_join_m(f);
    return s;
}

VELUM_FN velum_span_m velum_scud_span(velum_slot_fields f, velum_fringe g) {
    velum_span_m s;
    float deep_m = VELUM_SCUD_SHALLOW_M + VELUM_SCUD_DEEP_M * g.scud;
    s.low = VELUM_MAX(f.base_m - deep_m, VELUM_MIN(VELUM_SCUD_LOWEST * f.base_m, f.base_m - 10.0f));
    s.high = f.base_m + VELUM_MIN(VELUM_SCUD_OVER_M, VELUM_SCUD_OVER * (f.top_m - f.base_m));
    return s;
}

VELUM_FN velum_span_m velum_band_span(velum_slot_fields f, velum_fringe g) {
    velum_span_m s;
    s.low = VELUM_MAX(f.base_m - g.transition_m, VELUM_FALL_FLOOR_M);
    s.high = f.top_m + g.transition_m;
    return s;
}

/* Of both together: they are one part. */
VELUM_FN velum_span_m velum_hem_span(velum_slot_fields f, velum_fringe g) {
    velum_span_m scud = velum_scud_span(f, g);
    velum_span_m band = velum_band_span(f, g);
    velum_span_m s;
    s.low = g.scud > 0.0f ? scud.low : band.low;
    s.high = g.scud > 0.0f ? scud.high : band.high;
    s.low = g.transition_m > 0.0f ? VELUM_MIN(s.low, band.low) : s.low;
    s.high = g.transition_m > 0.0f ? VELUM_MAX(s.high, band.high) : s.high;
    return s;
}

/* No more than this. */
VELUM_FN float velum_fall_most_1_m(velum_fringe g) {
    return velum_fall_extinction_1_m(g.fall, g.fall_kind) * (1.0f + VELUM_FALL_STREAKS);
}
VELUM_FN float velum_scud_most_1_m(velum_slot_fields f, velum_fringe g) {
    return g.scud > 0.0f ? VELUM_MIN(VELUM_SCUD_SHARE * f.extinction_1_m, VELUM_SCUD_MOST_1_M) : 0.0f;
}

/* From noise of a column: lump -1..1, fine 0..1. */
VELUM_FN float velum_fall_streak(float lump, float fine) {
    return velum_mix(0.5f + 0.5f * lump, fine, VELUM_FALL_FINE);
}

/* Extinction of what falls, 1/m, at a height of a column of excess rank e where it left the cloud; streak 0..1, mean
 * 0.5, of that column. */
VELUM_FN float velum_fall_1_m(velum_profile p, velum_slot_fields f, velum_fringe g, float e, float height_m,
                              float streak) {
    float depth_m = f.base_m - height_m;
    float from = velum_threshold(p, 0.3f);
    float under = velum_smoothstep(from, from + VELUM_FALL_RIM, e);
    float join_m = VELUM_MAX(velum_fall_join_m(f), 1.0f);
    float joined = 1.0f - velum_smoothstep(0.0f, join_m, -depth_m);
    float uneven = 1.0f + VELUM_FALL_STREAKS * (2.0f * streak - 1.0f);
    float left = height_m > VELUM_FALL_FLOOR_M ? velum_fall_left(g.fall, depth_m) : 0.0f;
    return velum_fall_extinction_1_m(left, g.fall_kind) * under * joined * uneven;
}

/* Noise of scud, 0..1: detail at its two scales. */
VELUM_FN float velum_scud_noise(float lump, float fine) {
    return velum_mix(lump, fine, VELUM_SCUD_FINE);
}

/* Extinction of scud, 1/m, at a height of a column of excess rank e. Never less for more scud. It comes up to the base
 * where cloud stands over it, whatever most lumps carve off its foot; at that one's rim there is less, hanging lower. */
VELUM_FN float velum_scud_1_m(velum_profile p, velum_slot_fields f, velum_fringe g, float e, float height_m,
                              float noise) {
    velum_span_m span = velum_scud_span(f, g);
    float depth_m = f.base_m - height_m;
    float rim = VELUM_MAX(velum_carve(p, 0.0f, -0.5f, 0.5f), VELUM_SCUD_RIM);
    float under = velum_smoothstep(0.0f, rim, e - velum_threshold(p, 0.0f));
    float deep = velum_clamp(depth_m / VELUM_MAX(f.base_m - span.low, 1.0f), 0.0f, 1.0f);
    float over_m = VELUM_SCUD_HANGS_M * (1.0f - under) - depth_m;
    float above = velum_smoothstep(0.0f, VELUM_MAX(span.high - f.base_m, 1.0e-3f), over_m);
    float amount = g.scud * under * (1.0f - deep) * (1.0f - above);
    float margin = noise - 1.0f + VELUM_SCUD_FULL * VELUM_SQRT(VELUM_MAX(amount, 0.0f));
    return velum_scud_most_1_m(f, g) * velum_smoothstep(0.0f, VELUM_SCUD_SOFTNESS, margin);
}

/* Extinction of the transition band, 1/m, at a height of a column of excess rank e: falls with the square of the way
 * that is left, under the layer's base and, of sheets, over the column's own top: heaps keep their outlines. Never less
 * for a deeper band. */
VELUM_FN float velum_band_1_m(velum_profile p, velum_slot_fields f, velum_fringe g, float e, float height_m) {
    float thickness_m = VELUM_MAX(f.top_m - f.base_m, 1.0f);
    float share = velum_clamp(e / VELUM_MAX(p.reach, 0.05f), 0.0f, 1.0f);
    float top_m = f.base_m + thickness_m * VELUM_POW(share, 1.0f / VELUM_MAX(p.power, 0.1f));
    float outside_m = VELUM_MAX(f.base_m - height_m, height_m - top_m);
    float left = velum_clamp(1.0f - outside_m / VELUM_MAX(g.transition_m, 1.0e-3f), 0.0f, 1.0f);
    left = outside_m > 0.0f ? left : 1.0f;
    float join_m = VELUM_MIN(VELUM_BAND_JOIN * thickness_m, VELUM_BAND_JOIN_MOST_M);
    float joined = 1.0f - velum_smoothstep(0.0f, join_m, -outside_m);
    float under = velum_smoothstep(0.0f, VELUM_SCUD_RIM, e - velum_threshold(p, 0.0f));
    under = height_m - top_m > f.base_m - height_m ? under * VELUM_MIN(2.0f * p.close, 1.0f) : under;
    return g.transition_m > 0.0f ? VELUM_BAND_SHARE * f.extinction_1_m * left * left * joined * under : 0.0f;
}

#endif
