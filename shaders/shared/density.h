/* The shape of clouds: from the smooth fields of a slot at a place to extinction at a point.
 *
 * The includer defines before, for its own language and textures,
 *     float velum_shape_at(float x, float y, float z);   Perlin-Worley 128^3, equalised: its values are ranks, uniform
 *     float velum_detail_at(float x, float y, float z);  Worley 64^3, mean 0.5
 * both tiling with period 1 and filtered trilinearly.
 *
 * Coverage is exact by construction: with q the rank of the shape noise at the foot of the column, the column is
 * covered where q > 1 - c, and e = (q - 1 + c) / c is again uniform over the covered columns. Noise in three dimensions
 * only moves the boundary of a column that is covered already, so it cannot change coverage; the mean over e, height
 * and noise depends on the profile alone and is divided out (calibration.h). Columns that lean (of cumulus, storms and
 * cirrus: velum_lean) have another rank at each height: of these coverage too is right by calibration. */
#ifndef VELUM_DENSITY_H
#define VELUM_DENSITY_H

#include "calibration.h"
#include "slots.h"

/* How a kind of cloud fills its layer: a column of excess rank e is cloud at height fraction z where e > g(z) and what
 * lumps and fine detail carve off. */
VELUM_STRUCT(velum_profile) {
    float reach;       /* g at the top: share of covered columns that stay below the top */
    float power;       /* of z in g: below 1 walls, above 1 domes */
    float amplitude;   /* of the lumps, in e */
    float softness;    /* of the boundary, in e */
    float rim;         /* how many times softer it is where hardly anything is left: wisps rather than crumbs */
    float erosion;     /* of the boundary by fine detail, in e */
    float foot;        /* share of the carving at the base: little leaves plates, all of it ragged feet */
    float stem;        /* how much more g is below the anvil (VELUM_STEM_FOOT), 0: no anvil */
    float damp;        /* how much thinner than the towers the anvil is, and softer */
    float close;       /* how far overcast goes beyond covering: sheets have no holes then, nor thin places */
    float growth;      /* of extinction with height: 0 constant, 1 adiabatic, see velum_water */
    float base_soft_m; /* the base is not a knife's edge */
    float coverage_scale, density_scale; /* calibration.h */
};

/* Noise of a slot, by slot alone: where kinds blend, the noise stays. Metres of a period. */
VELUM_STRUCT(velum_slot_noise) {
    float shape_period_m;
    float lump_period_m;
    float fine_period_m;
    float stretch;      /* of the shape along parallels: below 1 there are fibres (fibre.h) */
    float fine_stretch; /* the same of fine detail */
};

VELUM_FN velum_slot_noise velum_noise_of(int slot) {
    velum_slot_noise n;
    n.shape_period_m = 10500.0f;
    n.lump_period_m = 2100.0f;
    n.fine_period_m = 310.0f;
    n.stretch = 1.0f;
    n.fine_stretch = 1.0f;
    if (slot == VELUM_SLOT_LOW || slot == VELUM_SLOT_LOW_2) {
        n.shape_period_m = 8000.0f;
        n.lump_period_m = 2900.0f;
    } else if (slot == VELUM_SLOT_CUMULUS) {
        n.shape_period_m = 14000.0f;
        n.lump_period_m = 1500.0f;
        n.fine_period_m = 350.0f;
    } else if (slot == VELUM_SLOT_STORM) {
        n.shape_period_m = 90000.0f;
        n.lump_period_m = 9000.0f;
        n.fine_period_m = 1800.0f;
    } else if (slot == VELUM_SLOT_MIDDLE) {
        n.shape_period_m = 6500.0f;
        n.lump_period_m = 2100.0f;
    } else if (slot == VELUM_SLOT_HIGH) {
        n.shape_period_m = 2500.0f;
        n.lump_period_m = 1000.0f;
        n.fine_period_m = 300.0f;
        n.stretch = 0.06f;
        n.fine_stretch = 0.06f;
    }
    return n;
}

VELUM_FN velum_profile velum_profile_blend(velum_profile a, velum_profile b, float t) {
    velum_profile p;
    p.reach = velum_mix(a.reach, b.reach, t);
    p.power = velum_mix(a.power, b.power, t);
    p.amplitude = velum_mix(a.amplitude, b.amplitude, t);
    p.softness = velum_mix(a.softness, b.softness, t);
    p.rim = velum_mix(a.rim, b.rim, t);
    p.erosion = velum_mix(a.erosion, b.erosion, t);
    p.foot = velum_mix(a.foot, b.foot, t);
    p.stem = velum_mix(a.stem, b.stem, t);
    p.damp = velum_mix(a.damp, b.damp, t);
    p.close = velum_mix(a.close, b.close, t);
    p.growth = velum_mix(a.growth, b.growth, t);
    p.base_soft_m = velum_mix(a.base_soft_m, b.base_soft_m, t);
    p.coverage_scale = 1.0f;
    p.density_scale = 1.0f;
    return p;
}

VELUM_FN velum_profile velum_profile_make(float reach, float power, float amplitude, float softness, float erosion,
                                          float stem, float close, float growth, float base_soft_m) {
    velum_profile p;
    p.reach = reach;
    p.power = power;
    p.amplitude = amplitude;
    p.softness = softness;
    p.rim = 1.0f;
    p.erosion = erosion;
    p.foot = 0.35f;
    p.stem = stem;
    p.damp = 0.0f;
    p.close = close;
    p.growth = growth;
    p.base_soft_m = base_soft_m;
    p.coverage_scale = 1.0f;
    p.density_scale = 1.0f;
    return p;
}

/* Of cirrus, how far its trails reach; and no farther than so many thicknesses of the layer. */
#define VELUM_TRAIL_M 3750.0f
#define VELUM_TRAIL_MOST 5.0f
/* Of a storm: for how long the wind has carried its anvil, no farther than so many thicknesses. */
#define VELUM_ANVIL_LAG_S 150.0f
#define VELUM_ANVIL_LAG_MOST 0.3f
/* How far a column's noise changes with height, m a metre: towers have turrets, not flutes; cumulus bulge and lean
 * in. */
#define VELUM_STORM_TURRETS 0.2f
#define VELUM_CUMULUS_TURRETS 0.25f
/* Of cumulus, up to so high over the base, m: beyond, as much would lie beside as over their feet. */
#define VELUM_CUMULUS_TURNS_M 4000.0f
VELUM_FN float velum_turrets(int slot) {
    return slot == VELUM_SLOT_STORM ? VELUM_STORM_TURRETS : slot == VELUM_SLOT_CUMULUS ? VELUM_CUMULUS_TURRETS : 0.0f;
}

/* How fibrous: 1 cirrus; 0 cirrostratus and cirrocumulus. */
VELUM_FN float velum_fibrous(int slot, float kind) {
    float fibrous = 1.0f - VELUM_MIN(VELUM_MAX(2.0f * kind - 1.0f, 1.0f - 2.0f * kind), 1.0f);
    return slot == VELUM_SLOT_HIGH ? fibrous : 0.0f;
}

VELUM_FN float velum_wind_m_s(velum_slot_fields f) {
    return VELUM_SQRT(f.wind_x_m_s * f.wind_x_m_s + f.wind_y_m_s * f.wind_y_m_s + f.wind_z_m_s * f.wind_z_m_s);
}

/* How far the wind carries a storm's top beyond its foot: m over m/s, and m. */
VELUM_FN float velum_anvil_lag_s(velum_slot_fields f) {
    float most_m = VELUM_ANVIL_LAG_MOST * VELUM_MAX(f.top_m - f.base_m, 1.0f);
    return VELUM_MIN(VELUM_ANVIL_LAG_S, most_m / VELUM_MAX(velum_wind_m_s(f), 1.0e-3f));
}
VELUM_FN float velum_anvil_m(velum_slot_fields f) {
    return velum_anvil_lag_s(f) * velum_wind_m_s(f);
}

/* Thickness of a storm, m, from which it is told how what it covers changes with that. */
#define VELUM_STORM_THICKNESS_M 10600.0f
/* Of velum_beside at no cover: over how far the wind carries an anvil, in this, m, and its power of that over the
 * storm's thickness. */
#define VELUM_ANVIL_COVER 1.42f
#define VELUM_ANVIL_COVER_M (0.8f * VELUM_STORM_THICKNESS_M)
#define VELUM_ANVIL_COVER_POWER 0.6f

/* What anvils that the wind carries cover beside their towers, over what is covered in calm air: the more the less that
 * is. Fitted to what velum-calibrate finds in winds of 10 to 30 m/s, 5 to 19 km deep. */
VELUM_FN float velum_beside(velum_slot_fields f) {
    float over = velum_overcast(f.coverage);
    float clear = (1.0f - 0.83f * f.coverage) * (1.0f - 0.4f * over * over);
    float far_m = velum_anvil_m(f);
    float aslant = VELUM_POW(far_m / VELUM_MAX(f.top_m - f.base_m, 1.0f), VELUM_ANVIL_COVER_POWER);
    return VELUM_ANVIL_COVER * (far_m / VELUM_ANVIL_COVER_M) * aslant * clear;
}
/* Its change with coverage at most, over its value at no cover; and a metre farther. */
#define VELUM_BESIDE_SLOPE 1.2f
#define VELUM_BESIDE_1_M (0.78f * VELUM_ANVIL_COVER / VELUM_ANVIL_COVER_M) /* 1.6 x 0.3^0.6 */

/* Optical depth of a storm from which it is told how what it covers changes with that. */
#define VELUM_STORM_DEPTH 636.0f

/* Turrets cover the more beside their feet the smaller and the taller those are, and anvils the less the thinner: what
 * is left to feet, over that at half cover. Fitted to what velum-calibrate finds from 0.06 of cover to all, 5 to 19 km
 * deep, of optical depths of 100 to 3000 (at 5, in parts to 0.06 of cover). */
VELUM_FN float velum_storm_feet(float coverage, float thickness_m, float optical_depth) {
    float octaves = VELUM_LOG2(VELUM_MAX(thickness_m, 1.0f) / VELUM_STORM_THICKNESS_M);
    float o = velum_clamp(octaves, -2.0f, 1.5f);
    float power = VELUM_MAX(0.142f + 0.095f * o, 0.0f);
    float many = velum_clamp(coverage - 0.5f, 0.0f, 0.25f);
    float tall = (1.0f + 0.69f * VELUM_MAX(o, 0.0f) * many * many) * (1.0f - 0.038f * o * o);
    float thin = velum_clamp(VELUM_LOG2(VELUM_STORM_DEPTH / VELUM_MAX(optical_depth, 1.0e-3f)), -0.6f, 7.0f);
    float unseen = 0.0317f * thin * (1.9f - 1.8f * coverage) * (1.0f + 0.47f * o);
    return VELUM_POW(2.0f * VELUM_MAX(coverage, 0.02f), power) * tall * (1.0f + unseen);
}

/* Of cumulus, m: thickness from which it is told how what they take changes with that. */
#define VELUM_CUMULUS_THICKNESS_M 1400.0f

/* The deeper and the fewer cumulus are, the more they bulge over their feet; the fewer, the more lumps carve off; as
 * they close, shallow ones leave holes and deep ones have bulged less. Over what they have at half cover and that
 * thickness; fitted to what velum-calibrate finds from 0.05 of cover to all, 350 m to 10 km deep. */
VELUM_FN velum_calibration velum_cumulus_factors(float coverage, float thickness_m) {
    float octaves = VELUM_LOG2(VELUM_MAX(thickness_m, 1.0f) / VELUM_CUMULUS_THICKNESS_M);
    float o = velum_clamp(octaves, -2.0f, 1.5f);
    float beyond = velum_clamp(octaves - 1.5f, 0.0f, 1.5f);
    float x = VELUM_MIN(coverage, 0.75f) - 0.5f;
    float t = velum_overcast(coverage);
    float deep = VELUM_MAX(o, 0.0f);
    float holes = VELUM_MAX(-o, 0.0f) * t * t * t;
    float bulges = deep * deep * t * (1.0f - 0.85f * t);
    float far = 1.0f - beyond * (0.04f - 0.0075f * beyond) * (1.0f - 1.5f * x);
    float water = 1.0f - o * (0.0385f + 0.0017f * o) +
                  x * (0.0611f * o - 0.4210f + x * (0.0217f - 0.0741f * o + 0.4361f * x));
    velum_calibration c;
    c.coverage = 1.0f - o * (0.1294f + o * (0.0324f + 0.0034f * o)) +
                 x * (0.0339f + o * (0.2100f + 0.0240f * o) - x * (0.1293f + 0.0768f * o - 0.7171f * x));
    c.coverage = c.coverage * (1.0f + 0.05f * holes) * (1.0f + 0.09f * bulges);
    c.coverage = c.coverage * (1.0f - beyond * (0.35f - 0.115f * beyond) * (1.0f - x) * (1.0f - 0.5f * t));
    c.density = water * (1.0f + 0.027f * holes) * far / c.coverage;
    c.reach = (1.0f - o * (0.0186f + 0.0064f * o) + x * (0.1205f + 0.0368f * o)) * far;
    return c;
}

/* Of velum_profile.stem: of a storm in a field of them, and towards the edge of one. */
#define VELUM_STEM 0.65f
#define VELUM_STEM_EDGE 1.3f

VELUM_FN velum_profile velum_profile_of(int slot, velum_slot_fields fields) {
    float kind = fields.kind;
    float over = velum_overcast(fields.coverage);
    velum_profile p;
    if (slot == VELUM_SLOT_LOW || slot == VELUM_SLOT_LOW_2) {
        /* St: a sheet. Sc: lumps and rolls. */
        p = velum_profile_blend(velum_profile_make(0.40f, 4.0f, 0.12f, 0.30f, 0.06f, 0.0f, 0.6f, 0.5f, 60.0f),
                                velum_profile_make(0.85f, 1.6f, 0.45f, 0.25f, 0.25f, 0.0f, 0.1f, 0.7f, 60.0f), kind);
        p.rim = velum_mix(3.0f, 1.0f, kind);
    } else if (slot == VELUM_SLOT_CUMULUS) {
        /* The fewer they are the steeper e rises from their edges, and the more of it lumps must carve to be seen. */
        float crowd = velum_clamp((fields.coverage - 0.1f) / 0.7f, 0.0f, 1.0f);
        p = velum_profile_make(0.95f, 0.9f, velum_mix(0.55f, 0.40f, crowd), 0.05f, velum_mix(0.42f, 0.28f, crowd), 0.0f,
                               0.0f, 0.8f, 25.0f);
        p.rim = 6.0f;
    } else if (slot == VELUM_SLOT_STORM) {
        /* Towers under an anvil, which alone is left at the edge of a storm; an overcast is all towers. */
        float stem = VELUM_STEM * (1.0f - over) + VELUM_STEM_EDGE * (1.0f - kind);
        p = velum_profile_make(0.80f, 24.0f, 0.40f, 0.06f, 0.24f, stem, 0.0f, 0.4f, 150.0f);
        p.rim = 4.0f;
        p.damp = 0.97f * (1.0f - over * kind);
    } else if (slot == VELUM_SLOT_MIDDLE) {
        /* As: a veil; Ns: a deep sheet; Ac: cells. */
        if (kind < 0.5f) {
            p = velum_profile_blend(velum_profile_make(0.25f, 3.0f, 0.05f, 0.30f, 0.04f, 0.0f, 0.8f, 0.2f, 180.0f),
                                    velum_profile_make(0.15f, 4.0f, 0.05f, 0.06f, 0.04f, 0.0f, 0.8f, 0.3f, 150.0f),
                                    2.0f * kind);
            p.rim = velum_mix(3.0f, 8.0f, 2.0f * kind);
        } else {
            p = velum_profile_blend(velum_profile_make(0.15f, 4.0f, 0.05f, 0.06f, 0.04f, 0.0f, 0.8f, 0.3f, 150.0f),
                                    velum_profile_make(0.88f, 1.3f, 0.45f, 0.14f, 0.22f, 0.0f, 0.0f, 0.5f, 25.0f),
                                    2.0f * kind - 1.0f);
            p.rim = velum_mix(8.0f, 2.0f, 2.0f * kind - 1.0f);
        }
    } else {
        /* Cs: a veil; Ci: fibres; Cc: grains. */
        if (kind < 0.5f) {
            p = velum_profile_blend(velum_profile_make(0.25f, 2.0f, 0.02f, 0.60f, 0.15f, 0.0f, 0.5f, 0.0f, 300.0f),
                                    velum_profile_make(0.60f, 1.2f, 0.02f, 0.90f, 0.90f, 0.0f, 0.0f, 0.0f, 300.0f),
                                    2.0f * kind);
        } else {
            p = velum_profile_blend(velum_profile_make(0.60f, 1.2f, 0.02f, 0.90f, 0.90f, 0.0f, 0.0f, 0.0f, 300.0f),
                                    velum_profile_make(0.60f, 1.2f, 0.80f, 0.35f, 0.10f, 0.0f, 0.0f, 0.0f, 40.0f),
                                    2.0f * kind - 1.0f);
        }
    }
    p.foot = slot == VELUM_SLOT_CUMULUS ? 0.75f : slot == VELUM_SLOT_STORM ? 0.6f : p.foot;
    float thickness_m = VELUM_MAX(fields.top_m - fields.base_m, 1.0f);
    float optical_depth = fields.extinction_1_m * thickness_m;
    velum_calibration measured = velum_calibration_of(slot, kind, fields.coverage, thickness_m, optical_depth);
    p.reach = p.reach * measured.reach;
    p.base_soft_m = VELUM_MIN(p.base_soft_m, 0.12f * thickness_m);
    p.coverage_scale = measured.coverage * (1.0f + p.close * over * over);
    p.density_scale = measured.density;
    float fibrous = velum_fibrous(slot, kind);
    if (fibrous > 0.0f) {
        /* Trails cover the more beside their heads the smaller those are: fitted to what velum-calibrate finds from 1
         * to 7 oktas, over that at 4. */
        float c = fields.coverage;
        float heads = velum_mix(1.0f, 0.42f + c * (1.82f + c * (1.155f * c - 1.906f)), fibrous);
        p.coverage_scale = p.coverage_scale * heads;
        p.density_scale = p.density_scale * velum_mix(1.0f, 0.909f + c * (0.255f - 0.147f * c), fibrous) / heads;
        p.reach = p.reach * VELUM_MIN(0.85f + 0.15f * heads, 1.0f); /* there are as many tops as ever */
    }
    if (slot == VELUM_SLOT_CUMULUS) {
        velum_calibration of = velum_cumulus_factors(fields.coverage, thickness_m);
        p.coverage_scale = p.coverage_scale * of.coverage;
        p.density_scale = p.density_scale * of.density;
        p.reach = p.reach * of.reach;
    }
    if (slot == VELUM_SLOT_STORM) {
        float feet = velum_storm_feet(fields.coverage, thickness_m, optical_depth) / (1.0f + velum_beside(fields));
        p.coverage_scale = p.coverage_scale * feet;
        p.density_scale = p.density_scale / feet;
    }
    return p;
}

/* Excess rank of a column: > 0 where it is covered, 1 at its heart. */
VELUM_FN float velum_excess(velum_profile p, float coverage, float rank) {
    float c = coverage * p.coverage_scale;
    return c > 1.0e-6f ? (rank - 1.0f + c) / c : -1.0f;
}

/* Excess rank, and margin over `erosion` before fine detail carves, up to which cloud is a rim. */
#define VELUM_RIM 0.5f

/* An anvil's underside slopes up and out between these height fractions; and towers turn to ice between those. */
#define VELUM_ANVIL_LOW 0.76f
#define VELUM_ANVIL_HIGH 0.96f
#define VELUM_ICE_LOW 0.70f
#define VELUM_ICE_HIGH 0.84f
/* Change of either over a unit of height fraction, at most: see velum_smoothstep. */
#define VELUM_ANVIL_SLOPE (1.5f / (VELUM_ANVIL_HIGH - VELUM_ANVIL_LOW))
#define VELUM_ICE_SLOPE (1.5f / (VELUM_ICE_HIGH - VELUM_ICE_LOW))
/* Towers stand within so much of `stem` of their anvil's rim, and narrow upwards by all of it: of the least excess
 * there are but feet, low towers about the tall ones. They stand within all of what `stem` is more than in a field,
 * towards the edge of a storm, at any height: they end before its cover does. */
#define VELUM_STEM_FOOT 0.05f
/* Ice: anvils thin out over so much of e; and so many times what they are thinner by is taken from what is carved off
 * them. */
#define VELUM_ANVIL_SOFTNESS 1.0f
#define VELUM_ANVIL_SMOOTH 0.5f

VELUM_FN float velum_anvil(float z) {
    return velum_smoothstep(VELUM_ANVIL_LOW, VELUM_ANVIL_HIGH, z);
}

/* What the anvil has less of than the towers, 0..1. */
VELUM_FN float velum_thinned(velum_profile p, float z) {
    return p.damp > 0.0f ? p.damp * velum_smoothstep(VELUM_ICE_LOW, VELUM_ICE_HIGH, z) : 0.0f;
}

/* What `stem` adds to g below the anvil. */
VELUM_FN float velum_stem_at(velum_profile p, float z) {
    return VELUM_MIN(p.stem, VELUM_STEM) * (VELUM_STEM_FOOT + VELUM_MAX(z, 0.0f)) +
           VELUM_MAX(p.stem - VELUM_STEM, 0.0f);
}

/* Threshold of e at height fraction z is no lower. */
VELUM_FN float velum_threshold_least(velum_profile p, float z) {
    return p.reach * VELUM_POW(VELUM_MAX(z, 0.0f), p.power);
}

/* Threshold of e is no lower anywhere between two height fractions, the lower one first. */
VELUM_FN float velum_threshold_between(velum_profile p, float low, float high) {
    float g = velum_threshold_least(p, low);
    if (p.stem > 0.0f) {
        g = g + velum_stem_at(p, low) * (1.0f - velum_anvil(high));
    }
    return g;
}

/* Threshold of e at height fraction z. */
VELUM_FN float velum_threshold(velum_profile p, float z) {
    return velum_threshold_between(p, z, z);
}

/* Fine detail from which on nothing is carved off. */
#define VELUM_FINE_NONE 0.8f

/* What lump -1..1 and fine 0..1 carve off the boundary, in e: less at the foot than aloft (0 and 0.5 where the pixel
 * shows neither). */
VELUM_FN float velum_carve(velum_profile p, float z, float lump, float fine) {
    float carve = p.amplitude * VELUM_MAX(0.6f - lump, 0.0f) + p.erosion * VELUM_MAX(VELUM_FINE_NONE - fine, 0.0f);
    carve = carve * velum_mix(p.foot, 1.0f, velum_smoothstep(0.0f, 0.3f, z));
    return carve * (1.0f - VELUM_ANVIL_SMOOTH * velum_thinned(p, z));
}

/* How far inside the boundary, in e; negative outside. */
VELUM_FN float velum_margin(velum_profile p, float e, float z, float lump, float fine) {
    return e - velum_threshold(p, z) - velum_carve(p, z, lump, fine);
}

/* Of the boundary, in e: where a column is hardly covered, and where fine detail leaves but crumbs (`whole`: margin
 * without what that carves off; sheets, which close, have none), cloud is wisps. */
VELUM_FN float velum_softness(velum_profile p, float e, float whole, float thinned) {
    float firm = VELUM_MIN(e, whole / VELUM_MAX(p.erosion, 1.0e-3f) + p.close);
    float rim = velum_mix(p.rim, 1.0f, velum_smoothstep(0.0f, VELUM_RIM, firm));
    return velum_mix(p.softness * rim, VELUM_ANVIL_SOFTNESS, thinned);
}

/* Extinction at height fraction z over its mean. Water that grows linearly from the base in as many drops (adiabatic)
 * has an extinction that grows as its power 2/3, 5/3 z^(2/3) of the mean: within 0.08 of 0.4 + 1.2 z above the lowest
 * fifth. */
#define VELUM_WATER_LEAN 0.6f
VELUM_FN float velum_water(velum_profile p, float z) {
    return 1.0f + p.growth * (2.0f * z - 1.0f) * VELUM_WATER_LEAN;
}
/* Its integral from the base. */
VELUM_FN float velum_water_below(velum_profile p, float z) {
    return z * (1.0f + p.growth * (z - 1.0f) * VELUM_WATER_LEAN);
}

/* Relative extinction of a covered column at height fraction z: mean over columns, heights and noise is 1. `spread`:
 * half of how much the margin changes over the stretch that the value is to stand for, in e; 0: a point. */
VELUM_FN float velum_body_over(velum_profile p, float e, float z, float height_over_base_m, float lump, float fine,
                               float spread) {
    float f = velum_margin(p, e, z, lump, fine);
    float thinned = velum_thinned(p, z);
    float softness = velum_softness(p, e, velum_margin(p, e, z, lump, VELUM_FINE_NONE), thinned);
    float inside = velum_smoothstep(-spread, softness + spread, f);
    float water = velum_water(p, z);
    float foot = velum_smoothstep(0.0f, p.base_soft_m, height_over_base_m);
    water = water * (1.0f - thinned);
    return inside * water * foot * p.density_scale;
}

VELUM_FN float velum_body(velum_profile p, float e, float z, float height_over_base_m, float lump, float fine) {
    return velum_body_over(p, e, z, height_over_base_m, lump, fine, 0.0f);
}

#endif
