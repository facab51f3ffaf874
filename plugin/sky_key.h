/* What the picture of the sky depends on, and whether a change of it shows. */
#ifndef PLUGIN_SKY_KEY_H
#define PLUGIN_SKY_KEY_H

#include <stdbool.h>

#include "shared/arguments.h"
#include "shared/shade.h"

typedef struct sky_key {
    float scaled[4], position[4], up[4], sun[4], sun_lx[4], ground[4], shades[VELUM_SHADE_LEVELS][4];
    float fog_1_m, fog_top_m, haze_1_m, surface_m;
} sky_key;

sky_key sky_key_of(const velum_eye_block *eye);
bool sky_key_same(const sky_key *a, const sky_key *b);
/* Whether the sky made for one is the other's to a hundredth of its luminance, mostly to some thousandths. Sun and
 * horizon themselves need not agree: who reads the picture asks by the angles from them. */
bool sky_key_near(const sky_key *made, const sky_key *wanted);

#endif
