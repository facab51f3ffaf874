/* Directions drawn from the phase functions of phase.h, for the reference, which must draw exactly what it evaluates.
 * Functions return 1 - cos of the angle by which light turns (0..2): next to a forward peak the cosine alone has no
 * digits left. u: uniform in 0..1; more of it turns less. */
#ifndef VELUM_PHASE_SAMPLE_H
#define VELUM_PHASE_SAMPLE_H

#include "air.h"
#include "phase.h"

/* Two lobes, the second a Draine function: all phase functions in use are of this form. */
VELUM_STRUCT(velum_phase_lobes) {
    float g_first;
    float g_second, alpha_second;
    float weight_second;
};

VELUM_FN velum_phase_lobes velum_phase_lobes_make(float g_first, float g_second, float alpha_second,
                                                  float weight_second) {
    velum_phase_lobes p;
    p.g_first = g_first;
    p.g_second = g_second;
    p.alpha_second = alpha_second;
    p.weight_second = weight_second;
    return p;
}

VELUM_FN velum_phase_lobes velum_phase_lobes_fog(void) {
    return velum_phase_lobes_make(VELUM_FOG_G, 0.0f, 0.0f, VELUM_FOG_EVEN);
}

/* As velum_phase_cloud. */
VELUM_FN velum_phase_lobes velum_phase_lobes_cloud(bool ice) {
    velum_phase_lobes p;
    if (ice) {
        p = velum_phase_lobes_make(VELUM_ICE_G_FORWARD, VELUM_ICE_G_WIDE, 0.0f, 0.5f);
    } else {
        p = velum_phase_lobes_make(VELUM_DROPLET_20_G_HG, VELUM_DROPLET_20_G_DRAINE, VELUM_DROPLET_20_ALPHA,
                                   VELUM_DROPLET_20_WEIGHT);
    }
    return p;
}

VELUM_FN velum_phase_lobes velum_phase_lobes_droplet(velum_phase_droplet d) {
    return velum_phase_lobes_make(d.g_hg, d.g_draine, d.alpha, d.weight_draine);
}

VELUM_FN float velum_phase_lobes_at(velum_phase_lobes p, float c) {
    return velum_mix(velum_phase_hg(c, p.g_first), velum_phase_draine(c, p.g_second, p.alpha_second), p.weight_second);
}

/* The same of 1 - c, with all its digits. */
VELUM_FN float velum_phase_hg_turn(float turn, float g) {
    float d = VELUM_MAX((1.0f - g) * (1.0f - g) + 2.0f * g * turn, 1.0e-12f);
    return VELUM_INV_4PI * (1.0f - g * g) / (d * VELUM_SQRT(d));
}
VELUM_FN float velum_phase_lobes_turn(velum_phase_lobes p, float turn) {
    float c = 1.0f - turn;
    float second = velum_phase_hg_turn(turn, p.g_second) * (1.0f + p.alpha_second * c * c) /
                   (1.0f + p.alpha_second * (1.0f + 2.0f * p.g_second * p.g_second) * (1.0f / 3.0f));
    return velum_mix(velum_phase_hg_turn(turn, p.g_first), second, p.weight_second);
}

/* Henyey & Greenstein 1941, inverted (Witt 1977) and written without cancellation. */
VELUM_FN float velum_phase_hg_sample(float g, float u) {
    float d = VELUM_MAX(1.0f - g + 2.0f * g * u, 1.0e-12f);
    float s = (1.0f - g * g) / d;
    return velum_clamp((1.0f - g) * (1.0f - u) / d * (s + 1.0f - g), 0.0f, 2.0f);
}

/* Draws 1 - cos. Draine's function (2003) is Henyey and Greenstein's times 1 + alpha c^2, by rejection (von Neumann
 * 1951): at most 1 + alpha tries on average. The includer defines VELUM_PHASE_DRAW(), a new number in 0..1. */
#ifdef VELUM_PHASE_DRAW
VELUM_FN float velum_phase_lobes_draw(velum_phase_lobes p) {
    bool second = VELUM_PHASE_DRAW() < p.weight_second;
    float g = second ? p.g_second : p.g_first;
    float alpha = second ? p.alpha_second : 0.0f;
    float turn = 0.0f;
    for (int i = 0; i < 64; ++i) {
        turn = velum_phase_hg_sample(g, VELUM_PHASE_DRAW());
        float c = 1.0f - turn;
        if (alpha == 0.0f || VELUM_PHASE_DRAW() * (1.0f + alpha) < 1.0f + alpha * c * c) {
            break;
        }
    }
    return turn;
}
#endif

/* A table: values of the phase function, 1/sr, at `count` cosines that ascend from -1 to 1, linear between. The
 * includer defines, before, float velum_phase_table_cos(int i), velum_phase_table_value(int i) and, made by
 * velum_phase_table_area, velum_phase_table_share(int i): the share of light up to node i (0 at the first, 1 at the
 * last). */
VELUM_FN float velum_phase_table_area(float c0, float p0, float c1, float p1) {
    return 3.1415926536f * (c1 - c0) * (p0 + p1);
}
#ifdef VELUM_PHASE_TABLE
VELUM_FN int velum_phase_table_find_share(int count, float u) {
    int low = 0;
    int high = count - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (velum_phase_table_share(middle) <= u) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}
VELUM_FN float velum_phase_table_at(int count, float c) {
    int low = 0;
    int high = count - 1;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        if (velum_phase_table_cos(middle) <= c) {
            low = middle;
        } else {
            high = middle;
        }
    }
    float c0 = velum_phase_table_cos(low);
    float t = velum_clamp((c - c0) / VELUM_MAX(velum_phase_table_cos(high) - c0, 1.0e-9f), 0.0f, 1.0f);
    return velum_mix(velum_phase_table_value(low), velum_phase_table_value(high), t);
}
VELUM_FN float velum_phase_table_sample(int count, float u) {
    int i = velum_phase_table_find_share(count, u);
    float c0 = velum_phase_table_cos(i);
    float width = velum_phase_table_cos(i + 1) - c0;
    float p0 = velum_phase_table_value(i);
    float p1 = velum_phase_table_value(i + 1);
    float s0 = velum_phase_table_share(i);
    float t = velum_clamp((u - s0) / VELUM_MAX(velum_phase_table_share(i + 1) - s0, 1.0e-12f), 0.0f, 1.0f);
    /* (p1 - p0) x^2 / 2 + p0 x = t (p0 + p1) / 2, by the stable quadratic. */
    float target = t * (p0 + p1);
    float x = target / VELUM_MAX(p0 + VELUM_SQRT(VELUM_MAX(p0 * p0 + (p1 - p0) * target, 0.0f)), 1.0e-12f);
    return velum_clamp(1.0f - (c0 + width * x), 0.0f, 2.0f);
}
#endif

#endif
