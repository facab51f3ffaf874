#include "shades.h"

#include <math.h>

#include "shared/density.h"
#include "shared/shade.h"

/* Light of the whole sky, as if it all came at this cosine; of one that is lit by a sun on the horizon, at the other
 * (fitted to the reference: the scene `sunset`, and genera from below at dusk). */
#define SKY_MU 0.657f
#define SKY_LOW_MU 0.437f

/* What layers that absorb nothing send back of light that they let through one by one: with light that goes to and fro
 * between them, (1 - t) / t adds up. */
static float add_layer(float hindrance, float through) {
    return hindrance + (1.0f - through) / fmaxf(through, 1e-6f);
}

/* Of a column, at a height. */
static void add_shade(const core_column *column, float mu_sun, float albedo, float height_m, float weight,
                      float shade[4]) {
    float beam = 1.0f, sun = 0.0f, sky = 0.0f, below = 0.0f;
    float sky_mu = velum_mix(SKY_LOW_MU, SKY_MU, velum_aside_of(mu_sun));
    for (uint32_t slot = 0; slot < VELUM_SLOT_COUNT; slot++) {
        if (!(column->mask & (1u << slot))) {
            continue;
        }
        velum_slot_fields f = column->slot[slot];
        float cloud_m = velum_cloud_share((int)slot) * velum_noise_of((int)slot).shape_period_m;
        velum_layer_light above = velum_layer_light_at((int)slot, f, height_m, mu_sun, 0.0f, cloud_m);
        velum_layer_light even = velum_layer_light_at((int)slot, f, height_m, sky_mu, 0.0f, cloud_m);
        beam *= above.open;
        sun = add_layer(sun, above.open + above.through + above.aside + above.sides);
        sky = add_layer(sky, even.open + even.through + even.aside * velum_aside_of(mu_sun));
        f.top_m = fminf(f.top_m, height_m);
        if (f.top_m > f.base_m) {
            velum_layer_light under = velum_layer_light_at((int)slot, f, f.base_m, mu_sun, 0.0f, cloud_m);
            below = add_layer(below, under.open + under.through + under.aside + under.sides);
        }
    }
    float reflected = below / (1.0f + below);
    /* The ground and the clouds below send light back to the clouds above: what these let through has come again. */
    float dark = 1.0f - velum_shade_albedo(reflected, albedo, albedo);
    float through_sun = (1.0f + sky) / ((1.0f + sun) * (1.0f + dark * sky));
    float through_sky = 1.0f / (1.0f + dark * sky);
    const float found[4] = {beam, fmaxf(through_sun - beam, 0.0f), reflected, through_sky};
    for (int i = 0; i < 4; i++) {
        shade[i] += weight * found[i];
    }
}

void shades_add(const core_column *column, float mu_sun, float albedo, float weight,
                float shades[VELUM_SHADE_LEVELS][4]) {
    for (uint32_t k = 0; k < VELUM_SHADE_LEVELS; k++) {
        add_shade(column, mu_sun, albedo, velum_shade_height_m((int)k), weight, shades[k]);
    }
}
