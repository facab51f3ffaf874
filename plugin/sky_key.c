#include "sky_key.h"

#include <math.h>
#include <string.h>

#include "shared/air.h"

/* Of what light and air are multiplied by; and what of it counts as nothing. */
#define NEAR_SHARE 0.001f
#define ALBEDO_LEAST 1e-4f
#define SHADE_LEAST 1e-5f
#define HAZE_LEAST_1_M 1e-8f
/* Of the eye's height: light falls with heights of 1 km (dust) to 8 km (air), by a thousandth or two over that much of
 * them. Near the ground nothing shows of less than the least. */
#define NEAR_HEIGHT 0.002f
#define HEIGHT_LEAST_M 0.02f
#define HEIGHT_MOST_M 16.0f /* in the air */
/* In fog light changes over metres. */
#define FOG_HEIGHT_M 0.1f
#define NEAR_FOG_TOP_M 0.1f
#define NEAR_SURFACE_M 1.0f
/* The sun's zenith angle: twilight falls by e in a degree. Seen from afar so does the rim of the air, by how low the
 * horizon is. */
#define NEAR_SUN_RAD 4e-5
#define NEAR_DIP_RAD 2e-5
/* Where on the earth: by its radii of curvature alone. */
#define NEAR_UP 0.02f

sky_key sky_key_of(const velum_eye_block *eye) {
    sky_key key = {.fog_1_m = eye->drift[1], .haze_1_m = eye->drift[3]};
    /* Without fog and haze nothing asks for these. */
    key.fog_top_m = key.fog_1_m > 0.0f ? eye->drift[2] : 0.0f;
    key.surface_m = key.fog_1_m > 0.0f || key.haze_1_m > 0.0f ? eye->span[2] : 0.0f;
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

static double horizon_zenith_rad(const sky_key *k) {
    return acos((double)velum_horizon_mu(k->up[3]));
}

static float height_step_m(const sky_key *made) {
    const float height_m = made->up[3];
    float most_m = fmaxf(NEAR_HEIGHT * fabsf(height_m), HEIGHT_LEAST_M);
    if (height_m < VELUM_AIR_TOP_M) {
        most_m = fminf(most_m, HEIGHT_MOST_M);
    }
    if (made->fog_1_m > 0.0f) {
        most_m = fminf(most_m, fmaxf(NEAR_HEIGHT * (height_m - made->fog_top_m), FOG_HEIGHT_M));
    }
    return most_m;
}

static bool near_place(const sky_key *made, const sky_key *wanted) {
    return within(made->up[0], wanted->up[0], NEAR_UP) && within(made->up[1], wanted->up[1], NEAR_UP) &&
           within(made->up[2], wanted->up[2], NEAR_UP) && within(made->up[3], wanted->up[3], height_step_m(made)) &&
           (made->up[3] < VELUM_AIR_TOP_M ||
            fabs(horizon_zenith_rad(made) - horizon_zenith_rad(wanted)) <= NEAR_DIP_RAD);
}

bool sky_key_near(const sky_key *made, const sky_key *wanted) {
    return near_place(made, wanted) && fabs(sun_zenith_rad(made) - sun_zenith_rad(wanted)) <= NEAR_SUN_RAD &&
           near_share(made->sun_lx, wanted->sun_lx, 4, 0.0f) &&
           near_share(made->ground, wanted->ground, 3, ALBEDO_LEAST) && made->ground[3] == wanted->ground[3] &&
           near_share(made->shades[0], wanted->shades[0], 4 * VELUM_SHADE_LEVELS, SHADE_LEAST) &&
           near_share(&made->fog_1_m, &wanted->fog_1_m, 1, 0.0f) &&
           within(made->fog_top_m, wanted->fog_top_m, NEAR_FOG_TOP_M) &&
           near_share(&made->haze_1_m, &wanted->haze_1_m, 1, HAZE_LEAST_1_M) &&
           within(made->surface_m, wanted->surface_m, NEAR_SURFACE_M);
}
