#include "tile_bounds.h"

#include <math.h>
#include <string.h>

#include "shared/sample.h"

/* Between texels fields are mixed before the profile is formed, which is not quite linear in them. */
#define SLACK 1.02f

static float unit(uint16_t stored) {
    return (float)stored * (1.0f / 65535.0f);
}

void core_tile_bounds(const core_tile *tile, uint32_t slot, velum_page_bounds *out) {
    const core_tile_slot *from = &tile->slot[slot];
    memset(out, 0, sizeof *out);
    if (!from->a) {
        return;
    }
    bool even = true;
    for (uint32_t i = 0; i < VELUM_TILE_SIDE * VELUM_TILE_SIDE; i++) {
        const uint16_t *a = from->a + (size_t)i * 4;
        const uint16_t *b = from->b + (size_t)i * 4;
        bool same = i > 0 && memcmp(a, a - 4, 4 * sizeof *a) == 0 && memcmp(b, b - 4, 4 * sizeof *b) == 0;
        if (same) {
            continue;
        }
        even = even && i == 0;
        velum_slot_fields f = velum_fields_of_texels(unit(a[0]), unit(a[1]), unit(a[2]), unit(a[3]), unit(b[0]),
                                                     unit(b[1]), unit(b[2]), unit(b[3]));
        velum_profile p = {.coverage_scale = 1.0f, .density_scale = 1.0f};
        if (slot < VELUM_SLOT_UNIFORM) {
            p = velum_profile_of((int)slot, f);
        }
        const float most[3] = {f.coverage * p.coverage_scale, f.extinction_1_m * p.density_scale, p.growth};
        for (int k = 0; k < 3; k++) {
            out->most[k] = i == 0 ? most[k] : fmaxf(out->most[k], most[k]);
        }
        out->most[3] = i == 0 ? p.reach : fminf(out->most[3], p.reach);
        const float height[4] = {f.base_m, f.base_m, f.top_m, f.top_m};
        for (int k = 0; k < 4; k++) {
            bool least = k % 2 == 0;
            out->height[k] = i == 0  ? height[k]
                             : least ? fminf(out->height[k], height[k])
                                     : fmaxf(out->height[k], height[k]);
        }
        out->shape[0] = i == 0 ? p.power : fmaxf(out->shape[0], p.power);
        const float least[3] = {p.softness, p.amplitude, p.foot};
        for (int k = 0; k < 3; k++) {
            out->shape[k + 1] = i == 0 ? least[k] : fminf(out->shape[k + 1], least[k]);
        }
    }
    if (!even && slot < VELUM_SLOT_UNIFORM) {
        out->most[0] *= SLACK;
        out->most[1] *= SLACK;
        out->most[3] /= SLACK;
    }
}
