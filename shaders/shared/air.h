/* Clear air: molecules, aerosol, ozone. Coefficients at sea level, 1/m, for red, green, blue.
 * Rayleigh and ozone: Bruneton & Neyret (2008), Bruneton (2017); aerosol and the ozone tent: Hillaire (2020), table 1.
 */
#ifndef VELUM_AIR_PHYSICS_H
#define VELUM_AIR_PHYSICS_H

#include "dialect.h"
#include "planet.h"

#define VELUM_AIR_TOP_M 1.0e5f
#define VELUM_RAYLEIGH_R 5.802e-6f
#define VELUM_RAYLEIGH_G 13.558e-6f
#define VELUM_RAYLEIGH_B 33.1e-6f
#define VELUM_RAYLEIGH_SCALE_M 8000.0f
#define VELUM_AEROSOL_SCATTERING 3.996e-6f
#define VELUM_AEROSOL_EXTINCTION 4.44e-6f
#define VELUM_AEROSOL_SCALE_M 1200.0f
#define VELUM_AEROSOL_G 0.8f
#define VELUM_OZONE_R 0.650e-6f
#define VELUM_OZONE_G 1.881e-6f
#define VELUM_OZONE_B 0.085e-6f
#define VELUM_OZONE_CENTRE_M 25000.0f
#define VELUM_OZONE_HALF_M 15000.0f

/* Fog: full up to the top less this, none above the top; Henyey and Greenstein's function and a share that it scatters
 * evenly. */
#define VELUM_FOG_RAMP_M 120.0f
#define VELUM_FOG_G 0.75f
#define VELUM_FOG_EVEN 0.3f

VELUM_FN float velum_rayleigh_density(float height_m) {
    return VELUM_EXP(-VELUM_MAX(height_m, -500.0f) / VELUM_RAYLEIGH_SCALE_M);
}
VELUM_FN float velum_aerosol_density(float height_m) {
    return VELUM_EXP(-VELUM_MAX(height_m, -500.0f) / VELUM_AEROSOL_SCALE_M);
}
VELUM_FN float velum_ozone_density(float height_m) {
    return VELUM_MAX(0.0f, 1.0f - VELUM_ABS(height_m - VELUM_OZONE_CENTRE_M) / VELUM_OZONE_HALF_M);
}

/* Share of the fog's surface extinction at a height, and its integral over height from far below, m. */
VELUM_FN float velum_fog_density(float height_m, float top_m) {
    return velum_clamp((top_m - height_m) / VELUM_FOG_RAMP_M, 0.0f, 1.0f);
}
VELUM_FN float velum_fog_column_m(float height_m, float top_m) {
    float knee = top_m - VELUM_FOG_RAMP_M;
    float x = velum_clamp(height_m - knee, 0.0f, VELUM_FOG_RAMP_M);
    return VELUM_MIN(height_m, knee) + x - 0.5f * x * x / VELUM_FOG_RAMP_M;
}

/* Place in the transmittance table (Bruneton 2017): distances to the top, from the shortest to the longest. */
VELUM_STRUCT(velum_air_uv) {
    float u, v;
};
VELUM_FN velum_air_uv velum_air_uv_of(float height_m, float mu) {
    velum_air_uv uv;
    float ground = VELUM_WGS84_A_M;
    float top = VELUM_WGS84_A_M + VELUM_AIR_TOP_M;
    float h = velum_clamp(height_m, 0.0f, VELUM_AIR_TOP_M);
    float r = ground + h;
    float longest = VELUM_SQRT(VELUM_AIR_TOP_M * (2.0f * ground + VELUM_AIR_TOP_M));
    float rho = VELUM_SQRT(h * (2.0f * ground + h));
    float d = -r * mu + VELUM_SQRT(VELUM_MAX(r * r * (mu * mu - 1.0f) + top * top, 0.0f));
    float d_min = top - r;
    float d_max = rho + longest;
    uv.u = velum_clamp((d - d_min) / VELUM_MAX(d_max - d_min, 1.0f), 0.0f, 1.0f);
    uv.v = rho / longest;
    return uv;
}
VELUM_STRUCT(velum_air_ray) {
    float height_m, mu;
};
VELUM_FN velum_air_ray velum_air_ray_of(float u, float v) {
    velum_air_ray ray;
    float ground = VELUM_WGS84_A_M;
    float top = VELUM_WGS84_A_M + VELUM_AIR_TOP_M;
    float longest = VELUM_SQRT(VELUM_AIR_TOP_M * (2.0f * ground + VELUM_AIR_TOP_M));
    float rho = v * longest;
    float r = VELUM_SQRT(rho * rho + ground * ground);
    float d_min = top - r;
    float d = d_min + u * (rho + longest - d_min);
    ray.height_m = rho * rho / (r + ground);
    ray.mu = d > 0.0f ? velum_clamp((longest * longest - rho * rho - d * d) / (2.0f * r * d), -1.0f, 1.0f) : 1.0f;
    return ray;
}

/* Cosine of the zenith angle of the geometric horizon. */
VELUM_FN float velum_horizon_mu(float height_m) {
    float h = VELUM_MAX(height_m, 0.0f);
    float r = VELUM_WGS84_A_M + h;
    return -VELUM_SQRT(h * (2.0f * VELUM_WGS84_A_M + h)) / r;
}

/* What lies on a slant way to space over what lies straight up, of matter that thins out upward exponentially with
 * `scale_m`: Chapman 1931, sqrt(pi x / 2) exp(z^2) erfc(z), by the approximation of Ren & MacKenzie 2007. mu: cosine to
 * the vertical; below the horizon as at it. */
VELUM_FN float velum_slant(float scale_m, float height_m, float mu) {
    const float a = 2.9110f;
    float x = 1.5707963f * (VELUM_WGS84_A_M + height_m) / scale_m;
    float z2 = x * VELUM_MAX(mu, 0.0f) * VELUM_MAX(mu, 0.0f);
    return VELUM_SQRT(x) * a / ((a - 1.0f) * VELUM_SQRT(z2) + VELUM_SQRT(z2 + a * a));
}

/* Diffuse light within a plane layer that absorbs nothing, under a sun of illuminance 1 and over a ground: radiance is
 * mean + mu flux, mu: cosine of its way to the nadir. Eddington's approximation for an anisotropic phase function
 * (Shettle & Weinman 1970), depths and mean cosine after delta scaling (Joseph et al. 1976). */
VELUM_STRUCT(velum_diffuse) {
    float mean, flux;
};
VELUM_FN velum_diffuse velum_diffuse_in(float above, float below, float g, float mu_sun, float albedo) {
    velum_diffuse d;
    float direct = 0.75f * mu_sun * 0.318309886f;
    float dark = 1.0f - albedo;
    float all = above + below;
    float here = VELUM_EXP(-above / mu_sun);
    float last = VELUM_EXP(-all / mu_sun);
    float net = dark * direct * (mu_sun + 0.666666667f + (0.666666667f - mu_sun) * last) /
                (dark * (1.0f - g) * all + 1.333333333f);
    d.flux = net - direct * here;
    d.mean = direct * (mu_sun + 0.666666667f - mu_sun * here) - net * (0.666666667f + (1.0f - g) * above);
    d.mean = VELUM_MAX(d.mean, 0.0f);
    return d;
}
/* The same of an even luminance of 1 that comes from below. */
VELUM_FN velum_diffuse velum_diffuse_from_below(float above, float below, float g) {
    velum_diffuse d;
    float net = 1.0f / (1.333333333f + (1.0f - g) * (above + below));
    d.flux = -net;
    d.mean = net * (0.666666667f + (1.0f - g) * above);
    return d;
}
/* Share of the sun's flux that comes through such a layer over black ground. */
VELUM_FN float velum_flux_under(float depth, float g, float mu_sun) {
    float last = VELUM_EXP(-depth / mu_sun);
    return (mu_sun + 0.666666667f + (0.666666667f - mu_sun) * last) / (1.333333333f + (1.0f - g) * depth);
}

/* Clear air; depth: of what turns light, straight up. Flux of sun and sky on black ground over the sun's own, whose
 * light passes `slant` such depths; and the share of the ground's light that the air sends back. */
VELUM_FN float velum_sky_gain(float depth, float slant) {
    return velum_flux_under(depth, 0.0f, 1.0f / slant) * VELUM_EXP(depth * slant);
}
VELUM_FN float velum_sky_back(float depth) {
    return depth / (1.333333333f + depth);
}

#endif
