#include "sky_key.h"

#include <math.h>
#include <string.h>

/* Of what light and air are multiplied by. */
#define NEAR_SHARE 0.002f
#define SHADE_LEAST 1e-4f
/* Of the eye's height: light falls with heights of 1 km (dust) to 8 km (air), by a thousandth or two over that much of
 * them, and to the rim of the air seen from afar by its angle. */
#define NEAR_HEIGHT 0.002f
/* In fog, and near it, light changes over metres. */
#define FOG_HEIGHT_M 0.1f
#define FOG_REACHES_M 200.0f
#define NEAR_FOG_TOP_M 0.1f
#define NEAR_SURFACE_M 1.0f
/* The sun's zenith angle: twilight falls by e in a degree. */
#define NEAR_SUN_RAD 4e-5
/* Where on the earth: by its radii of curvature alone. */
#define NEAR_UP 0.02f

sky_key sky_key_of(const velum_eye_block *eye) {
    sky_key key = {
        .fog_1_m = eye->drift[1], .fog_top_m = eye->drift[2], .haze_1_m = eye->drift[3], .surface_m = eye->span[2]};
    memcpy(key.scaled, eye->scaled, sizeof key.scaled);
    memcpy(key.position, eye->position, sizeof key.position);
    memcpy(key.up, eye->up, sizeof key.up);
    memcpy(key.sun, eye->sun, sizeof key.sun);
    memcpy(key.sun_lx, eye->sun_lx, sizeof key.sun_lx);
    memcpy(key.ground, eye->ground, sizeof key.ground);
    memcpy(key.shades, eye->shades, sizeof key.shades);
    return key;
}

bool sky_key_same(const sky_key *a, const sky_key *b) {
    return memcmp(a, b, sizeof *a) == 0;
}

static bool within(float a, float b, float most) {
    return fabsf(a - b) <= most;
}

static bool near_share(const float *made, const float *wanted, int count, float least) {
    for (int i = 0; i < count; i++) {
        if (!within(made[i], wanted[i], fmaxf(NEAR_SHARE * fabsf(made[i]), least))) {
            return false;
        }
    }
    return true;
}

static double sun_zenith_rad(const sky_key *k) {
    const double u[3] = {(double)k->up[0], (double)k->up[1], (double)k->up[2]};
    const double s[3] = {(double)k->sun[0], (double)k->sun[1], (double)k->sun[2]};
    const double x = u[1] * s[2] - u[2] * s[1], y = u[2] * s[0] - u[0] * s[2], z = u[0] * s[1] - u[1] * s[0];
    return atan2(sqrt(x * x + y * y + z * z), u[0] * s[0] + u[1] * s[1] + u[2] * s[2]);
}

static bool near_place(const sky_key *made, const sky_key *wanted) {
    const float height_m = made->up[3];
    const bool in_fog = made->fog_1_m > 0.0f && height_m < made->fog_top_m + FOG_REACHES_M;
    const float most_m = in_fog ? FOG_HEIGHT_M : INFINITY;
    return within(made->up[0], wanted->up[0], NEAR_UP) && within(made->up[1], wanted->up[1], NEAR_UP) &&
           within(made->up[2], wanted->up[2], NEAR_UP) &&
           within(height_m, wanted->up[3], fminf(NEAR_HEIGHT * fabsf(height_m), most_m));
}

bool sky_key_near(const sky_key *made, const sky_key *wanted) {
    return near_place(made, wanted) && fabs(sun_zenith_rad(made) - sun_zenith_rad(wanted)) <= NEAR_SUN_RAD &&
           near_share(made->sun_lx, wanted->sun_lx, 4, 0.0f) &&
           near_share(made->ground, wanted->ground, 3, SHADE_LEAST) && made->ground[3] == wanted->ground[3] &&
           near_share(made->shades[0], wanted->shades[0], 4 * VELUM_SHADE_LEVELS, SHADE_LEAST) &&
           near_share(&made->fog_1_m, &wanted->fog_1_m, 1, 0.0f) &&
           within(made->fog_top_m, wanted->fog_top_m, NEAR_FOG_TOP_M) &&
           near_share(&made->haze_1_m, &wanted->haze_1_m, 1, 0.0f) &&
           within(made->surface_m, wanted->surface_m, NEAR_SURFACE_M);
}
