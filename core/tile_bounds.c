#include "tile_bounds.h"

#include <math.h>
#include <string.h>

#include "shared/sample.h"
#include "shared/tile_address.h"

/* Between texels fields are mixed before the profile is formed, which is not quite linear in them. */
#define SLACK 1.03f
#define NOWHERE_M 1e9f

static velum_slot_fields fields_of(const core_tile_slot *from, size_t i) {
    const uint16_t *a = from->a + i * 4;
    const uint16_t *b = from->b + i * 4;
    return velum_fields_of_texels(core_texel_unit(a[0]), core_texel_unit(a[1]), core_texel_unit(a[2]),
                                  core_texel_unit(a[3]), core_texel_unit(b[0]), core_texel_unit(b[1]),
                                  core_texel_unit(b[2]), core_texel_unit(b[3]));
}

/* Change from one texel to its neighbours, over a metre, at most: between texels fields are bilinear. */
typedef struct slopes {
    float wind_1_s, coverage_1_m, height, kind_1_m;
} slopes;

static slopes slopes_of(const core_tile_slot *from, float texel_m) {
    float wind = 0.0f, coverage = 0.0f, height = 0.0f, kind = 0.0f;
    for (uint32_t i = 0; i < VELUM_TILE_SIDE * VELUM_TILE_SIDE; i++) {
        for (int turn = 0; turn < 2; turn++) {
            const uint32_t step = turn == 0 ? 1 : VELUM_TILE_SIDE;
            if (turn == 0 ? i % VELUM_TILE_SIDE == VELUM_TILE_SIDE - 1 : i / VELUM_TILE_SIDE == VELUM_TILE_SIDE - 1) {
                continue;
            }
            const uint16_t *a = from->a + (size_t)i * 4;
            const uint16_t *next_a = a + (size_t)step * 4;
            const uint16_t *b = from->b + (size_t)i * 4;
            const uint16_t *next_b = b + (size_t)step * 4;
            float square = 0.0f;
            for (uint32_t k = 0; k < 3; k++) {
                float off =
                    velum_texel_wind_m_s(core_texel_unit(b[k])) - velum_texel_wind_m_s(core_texel_unit(next_b[k]));
                square += off * off;
            }
            wind = fmaxf(wind, square);
            coverage = fmaxf(coverage, fabsf(core_texel_unit(a[0]) - core_texel_unit(next_a[0])));
            kind = fmaxf(kind, fabsf(core_texel_unit(b[3]) - core_texel_unit(next_b[3])));
            for (uint32_t k = 1; k < 3; k++) {
                height = fmaxf(height, fabsf(velum_texel_height_m(core_texel_unit(a[k])) -
                                             velum_texel_height_m(core_texel_unit(next_a[k]))));
            }
        }
    }
    /* Both axes together; texels are as narrow as 0.7 of the nominal side. */
    const float scale = sqrtf(2.0f) / (0.7f * texel_m);
    return (slopes){sqrtf(wind) * scale, coverage * scale, 2.0f * height * scale, kind * scale};
}

/* Metres of noise over a metre along the layer by which columns lean more or less: see velum_lean. */
static float lean_change(uint32_t slot, slopes change) {
    switch (slot) {
    case VELUM_SLOT_HIGH:
        return velum_noise_of((int)slot).stretch *
               (2.0f * VELUM_TRAIL_M * change.kind_1_m + 3.0f * VELUM_TRAIL_MOST * change.height);
    case VELUM_SLOT_STORM: return VELUM_ANVIL_LAG_S * change.wind_1_s + 3.0f * VELUM_ANVIL_LAG_MOST * change.height;
    default: return velum_turrets((int)slot) * change.height;
    }
}

/* What a storm's anvils and turrets take from its feet is most where it covers least, and mixed states may do that in
 * its wind. */
static float page_most_1_m(uint32_t slot, velum_slot_fields f, velum_profile p) {
    float most = f.extinction_1_m * p.density_scale * (1.0f + VELUM_WATER_LEAN * fmaxf(p.growth, 0.0f));
    if (slot == VELUM_SLOT_STORM) {
        velum_slot_fields least = f;
        least.coverage = 0.0f;
        most *= (1.0f + velum_beside(least)) / (1.0f + velum_beside(f));
    }
    return most;
}

/* Effective coverage changes so many times as fast as coverage, beyond what it does in calm air. */
static float coverage_factor(const core_tile_slot *from, uint32_t slot) {
    float most = 0.0f;
    for (size_t i = 0; slot == VELUM_SLOT_STORM && i < VELUM_TILE_SIDE * VELUM_TILE_SIDE; i++) {
        velum_slot_fields f = fields_of(from, i);
        f.coverage = 0.0f;
        most = fmaxf(most, velum_beside(f));
    }
    return 1.0f + VELUM_BESIDE_SLOPE * most;
}

/* Coverage as velum_excess takes it, at most: a storm's is largest in calm air, and winds may cancel between texels. */
static float effective_coverage(uint32_t slot, velum_slot_fields f, velum_profile p) {
    if (slot == VELUM_SLOT_STORM) {
        f.wind_x_m_s = f.wind_y_m_s = f.wind_z_m_s = 0.0f;
        p = velum_profile_of((int)slot, f);
    }
    return f.coverage * p.coverage_scale;
}

/* How many times as fast as coverage effective coverage changes at most between two of them, at least 1: as an overcast
 * closes, several times. */
static float effective_slope(uint32_t slot, velum_slot_fields f, float least, float most) {
    enum { STEPS = 64 };
    const float step = (most - least) / (float)STEPS;
    float slope = 1.0f, last = 0.0f;
    for (int i = 0; slot < VELUM_SLOT_UNIFORM && step > 1e-6f && i <= STEPS; i++) {
        f.coverage = least + (float)i * step;
        const float effective = effective_coverage(slot, f, velum_profile_of((int)slot, f));
        slope = i > 0 ? fmaxf(slope, fabsf(effective - last) / step) : slope;
        last = effective;
    }
    return slope;
}

/* Uniform layers have none: what they hold is as it is. */
static velum_profile profile_of(uint32_t slot, velum_slot_fields f) {
    return slot < VELUM_SLOT_UNIFORM ? velum_profile_of((int)slot, f)
                                     : (velum_profile){.coverage_scale = 1.0f, .density_scale = 1.0f};
}

/* Of each texel. */
static void fill_effective(const core_tile_slot *from, uint32_t slot, float out[VELUM_TILE_SIDE * VELUM_TILE_SIDE]) {
    for (size_t i = 0; i < VELUM_TILE_SIDE * VELUM_TILE_SIDE; i++) {
        velum_slot_fields f = fields_of(from, i);
        out[i] = from->a[i * 4] > 0 ? effective_coverage(slot, f, profile_of(slot, f)) : 0.0f;
    }
}

/* Texels are counted with the apron: part i and its neighbours are filtered from 8 i - 8 to 8 i + 17. */
static uint32_t part(const float *effective, uint32_t x, uint32_t y, float most) {
    const int step = VELUM_TILE_TEXELS / VELUM_PARTS;
    float own = 0.0f;
    for (int j = (int)y * step - step; j <= (int)y * step + 2 * step + 1; j++) {
        for (int i = (int)x * step - step; i <= (int)x * step + 2 * step + 1; i++) {
            if (i >= 0 && j >= 0 && i < VELUM_TILE_SIDE && j < VELUM_TILE_SIDE) {
                own = fmaxf(own, effective[j * VELUM_TILE_SIDE + i]);
            }
        }
    }
    float share = ceilf(own * SLACK / fmaxf(most, 1e-9f) * 255.0f);
    return share < 255.0f ? (uint32_t)share : 255;
}

static bool same_texel(const core_tile_slot *from, size_t i, size_t j) {
    return memcmp(from->a + i * 4, from->a + j * 4, 4 * sizeof *from->a) == 0 &&
           memcmp(from->b + i * 4, from->b + j * 4, 4 * sizeof *from->b) == 0;
}

/* Parts whose texels, as far as filtering reaches, are all like the one. */
static uint32_t even_parts(const core_tile_slot *from, size_t like) {
    const uint32_t step = VELUM_TILE_TEXELS / VELUM_PARTS;
    uint32_t mask = 0;
    for (uint32_t part = 0; part < VELUM_PARTS * VELUM_PARTS; part++) {
        bool even = true;
        for (uint32_t i = 0; even && i < (step + 2) * (step + 2); i++) {
            const uint32_t x = part % VELUM_PARTS * step + i % (step + 2);
            const uint32_t y = part / VELUM_PARTS * step + i / (step + 2);
            even = same_texel(from, (size_t)y * VELUM_TILE_SIDE + x, like);
        }
        mask |= (uint32_t)even << part;
    }
    return mask;
}

/* Fields halfway between four texels: profiles are not linear in them. */
static void add_fields(uint32_t slot, const core_tile_slot *from, const size_t texels[4], bool first,
                       velum_page_bounds *out) {
    float v[8] = {0};
    for (uint32_t k = 0; k < 4; k++) {
        for (uint32_t channel = 0; channel < 4; channel++) {
            v[channel] += 0.25f * core_texel_unit(from->a[texels[k] * 4 + channel]);
            v[4 + channel] += 0.25f * core_texel_unit(from->b[texels[k] * 4 + channel]);
        }
    }
    velum_slot_fields f = velum_fields_of_texels(v[0], v[1], v[2], v[3], v[4], v[5], v[6], v[7]);
    const velum_profile p = profile_of(slot, f);
    /* Where coverage runs out, too: the fewer and smaller its clouds, the denser they are. */
    out->most[0] = fmaxf(out->most[0], effective_coverage(slot, f, p));
    out->most[1] = fmaxf(out->most[1], page_most_1_m(slot, f, p));
    if (slot == VELUM_SLOT_CUMULUS) {
        velum_slot_fields fewest = f;
        for (uint32_t k = 0; k < 4; k++) {
            fewest.coverage = fminf(fewest.coverage, core_texel_unit(from->a[texels[k] * 4]));
        }
        out->most[1] = fmaxf(out->most[1], page_most_1_m(slot, fewest, profile_of(slot, fewest)));
    }
    out->most[2] = first ? p.reach : fminf(out->most[2], p.reach);
    out->most[3] = fmaxf(out->most[3], p.power);
    const float height[4] = {f.base_m, f.base_m, f.top_m, f.top_m};
    for (int k = 0; k < 4; k++) {
        bool least = k % 2 == 0;
        out->height[k] = first   ? height[k]
                         : least ? fminf(out->height[k], height[k])
                                 : fmaxf(out->height[k], height[k]);
    }
}

void core_tile_bounds(const core_tile *tile, uint32_t slot, velum_page_bounds *out) {
    const core_tile_slot *from = &tile->slot[slot];
    memset(out, 0, sizeof *out);
    if (!from->a) {
        return;
    }
    const uint32_t side = VELUM_TILE_SIDE;
    bool even = true;
    uint32_t densest = 0;
    add_fields(slot, from, (const size_t[4]){0, 0, 0, 0}, true, out);
    for (uint32_t i = 0; i < side * side; i++) {
        densest = from->a[(size_t)i * 4] > from->a[(size_t)densest * 4] ? i : densest;
        if (i > 0 && !same_texel(from, i, i - 1)) {
            even = false;
            add_fields(slot, from, (const size_t[4]){i, i, i, i}, false, out);
        }
        const uint32_t right = i % side < side - 1 ? i + 1 : i;
        const uint32_t down = i / side < side - 1 ? i + side : i;
        const uint32_t across = down + right - i;
        if (!same_texel(from, i, right) || !same_texel(from, i, down) || !same_texel(from, i, across)) {
            add_fields(slot, from, (const size_t[4]){i, i, right, right}, false, out);
            add_fields(slot, from, (const size_t[4]){i, i, down, down}, false, out);
            add_fields(slot, from, (const size_t[4]){i, right, down, across}, false, out);
        }
    }
    out->even[0] = even_parts(from, densest);
    out->even[1] = densest;
    const float side_m = VELUM_TILE_FACE_M / (float)(1u << velum_tile_key_level(tile->key));
    if (!even) {
        slopes change = slopes_of(from, side_m / (float)VELUM_TILE_TEXELS);
        float least = 1.0f;
        for (uint32_t i = 0; i < side * side; i++) {
            least = fminf(least, core_texel_unit(from->a[(size_t)i * 4]));
        }
        const velum_slot_fields dense = fields_of(from, densest);
        out->shape[0] = change.wind_1_s;
        out->shape[1] =
            change.coverage_1_m * coverage_factor(from, slot) * effective_slope(slot, dense, least, dense.coverage);
        if (slot == VELUM_SLOT_STORM) {
            out->shape[1] = fmaxf(out->shape[1], change.kind_1_m);
        }
        out->shape[2] = change.height;
        out->shape[3] = lean_change(slot, change);
    }
    if (!even && slot < VELUM_SLOT_UNIFORM) {
        out->most[0] *= SLACK;
        out->most[1] *= SLACK;
        out->most[2] /= SLACK;
    }
    float effective[VELUM_TILE_SIDE * VELUM_TILE_SIDE];
    if (!even) {
        fill_effective(from, slot, effective);
    }
    for (uint32_t i = 0; i < VELUM_PARTS * VELUM_PARTS; i++) {
        uint32_t share = even ? 255 : part(effective, i % VELUM_PARTS, i / VELUM_PARTS, out->most[0]);
        out->parts[i / VELUM_PARTS] |= share << i % VELUM_PARTS * 8;
    }
}

void core_tile_fringe_bounds(const core_tile *tile, uint32_t slot, velum_page_bounds *out) {
    const core_tile_slot *from = &tile->slot[slot];
    const velum_span_m *spans[2] = {&from->hem_m, &from->fall_m};
    memset(out, 0, sizeof *out);
    out->most[0] = from->max_scud_1_m + from->max_band_1_m;
    out->most[1] = from->max_fall_1_m;
    for (int i = 0; i < 2; i++) {
        const bool some = core_span_has_some(*spans[i]);
        out->height[2 * i] = some ? spans[i]->low : NOWHERE_M;
        out->height[2 * i + 1] = some ? spans[i]->high : -NOWHERE_M;
    }
}
