/* Light through air: transmittance between points, sun at a point, the eye's sky. */
#ifndef VELUM_AIR_GLSL
#define VELUM_AIR_GLSL

#include "engine.glsl"
#include "shared/phase.h"

const vec3 rayleigh_1_m = vec3(VELUM_RAYLEIGH_R, VELUM_RAYLEIGH_G, VELUM_RAYLEIGH_B);
const vec3 ozone_1_m = vec3(VELUM_OZONE_R, VELUM_OZONE_G, VELUM_OZONE_B);

vec3 air_extinction_1_m(float height_m) {
    return rayleigh_1_m * velum_rayleigh_density(height_m) +
           vec3(VELUM_AEROSOL_EXTINCTION * velum_aerosol_density(height_m)) + ozone_1_m * velum_ozone_density(height_m);
}

float fog_extinction_1_m(float height_m) {
    return eye.drift.y * velum_fog_density(height_m, eye.drift.z);
}

/* Haze thins out upward from the surface; it has no top. */
const float haze_scale_m = 1500.0;
float haze_extinction_1_m(float height_m) {
    return eye.drift.w * exp(-max(height_m - eye.span.z, 0.0) / haze_scale_m);
}

/* Of clean air, from a height to space; below the horizon as at it. */
vec3 air_to_space(float height_m, float mu) {
    velum_air_uv uv = velum_air_uv_of(height_m, mu);
    vec2 size = vec2(VELUM_AIR_W, VELUM_AIR_H);
    vec2 place = (vec2(uv.u, uv.v) * (size - 1.0) + 0.5) / size;
    return textureLod(air_table, place, 0.0).rgb;
}

/* Share of the sun's disc over the horizon (linear in the angle: within 4 % of the circle's segment). */
float sun_over_horizon(float height_m, float mu) {
    float radius = max(eye.sun_lx.w, 1e-4);
    return smoothstep(-radius, radius, mu - velum_horizon_mu(height_m));
}

/* Asymmetry of haze; what it scatters forward, as delta-M has it (Wiscombe 1977), still counts as the sun's. */
const float haze_g = 0.7;

float sun_through_haze(float height_m, float mu) {
    float slant = velum_slant(haze_scale_m, height_m, mu);
    return exp(-(1.0 - haze_g * haze_g) * haze_extinction_1_m(height_m) * haze_scale_m * slant);
}

/* Transmittance of air, fog apart, between the eye's side and the sun; 1 without air. */
vec3 sun_through_air(float height_m, float mu) {
    if (eye.ground.w == 0.0) {
        return vec3(1.0);
    }
    return air_to_space(height_m, max(mu, velum_horizon_mu(height_m))) * sun_over_horizon(height_m, mu) *
           sun_through_haze(height_m, mu);
}

/* Of fog and haze over a straight stretch between two heights. */
float fog_between(float h0, float h1, float distance_m) {
    float rise = h1 - h0;
    bool level = abs(rise) < 1.0;
    float fog = level ? velum_fog_density(h0, eye.drift.z)
                      : (velum_fog_column_m(h1, eye.drift.z) - velum_fog_column_m(h0, eye.drift.z)) / rise;
    float e0 = haze_extinction_1_m(h0);
    float e1 = haze_extinction_1_m(h1);
    float haze = level ? e0 : haze_scale_m * (e0 - e1) / rise;
    return exp(-(eye.drift.y * max(fog, 0.0) + max(haze, 0.0)) * distance_m);
}

/* Of air and fog between a point at height h0 with ray cosine mu0 and one at height h1, cosine mu1, so far on. */
vec3 air_between(float h0, float mu0, float h1, float mu1, float distance_m) {
    bool rises = mu0 + mu1 >= 0.0;
    vec3 through = air_to_space(rises ? h0 : h1, rises ? mu0 : -mu1);
    vec3 beyond = air_to_space(rises ? h1 : h0, rises ? mu1 : -mu0);
    vec3 t = clamp(through / max(beyond, vec3(1e-6)), vec3(0.0), vec3(1.0)) * fog_between(h0, h1, distance_m);
    return eye.ground.w == 0.0 ? vec3(1.0) : t;
}

float phase_rayleigh(float c) {
    return 3.0 / (16.0 * PI) * (1.0 + c * c);
}
/* All orders beyond the first, as if isotropic (Hillaire 2020, section 5.5): luminance per unit sun. */
vec3 glow_at(float height_m, float mu_sun) {
    vec2 place = vec2(0.5 + 0.5 * mu_sun, clamp(height_m / VELUM_AIR_TOP_M, 0.0, 1.0));
    place = (place * float(VELUM_GLOW_SIDE - 1) + 0.5) / float(VELUM_GLOW_SIDE);
    return textureLod(glow_table, place, 0.0).rgb;
}

/* Luminance per unit length that air sends along a ray, from sun and glow. */
vec3 air_source(float height_m, float mu_sun, float cos_sun, bool with_glow) {
    vec3 sun = sun_through_air(height_m, mu_sun);
    vec3 rayleigh = rayleigh_1_m * velum_rayleigh_density(height_m);
    float aerosol = VELUM_AEROSOL_SCATTERING * velum_aerosol_density(height_m);
    vec3 source = sun * (rayleigh * phase_rayleigh(cos_sun) + aerosol * velum_phase_hg(cos_sun, VELUM_AEROSOL_G));
    if (with_glow) {
        source += (rayleigh + aerosol) * glow_at(height_m, mu_sun);
    }
    return source;
}

/* Share of daylight at a height: below the clouds over the eye what they let through, on the mean; above them all. */
float daylight_share(float height_m) {
    return mix(eye.shade.x, 1.0, smoothstep(eye.shade.y, max(eye.shade.z, eye.shade.y + 1.0), height_m));
}

struct air_light {
    vec3 luminance; /* per unit sun_lx, already times it */
    vec3 transmittance;
};

/* Air and fog from offset o along d. */
air_light air_march(vec3 o, vec3 d, float distance_m, int steps, bool with_glow) {
    air_light result = air_light(vec3(0.0), vec3(1.0));
    if (eye.ground.w == 0.0) {
        return result;
    }
    float cos_sun = dot(d, eye.sun.xyz);
    float before = 0.0;
    for (int i = 0; i < steps; ++i) {
        float x = float(i + 1) / float(steps);
        float t1 = distance_m * x * x;
        float t = 0.5 * (before + t1);
        float dt = t1 - before;
        before = t1;
        velum_place p = place_of(o + d * t);
        float mu_sun = dot(vec3(p.nx, p.ny, p.nz), eye.sun.xyz);
        float fog = fog_extinction_1_m(p.height_m);
        float haze = haze_extinction_1_m(p.height_m);
        vec3 extinction = air_extinction_1_m(p.height_m) + vec3(fog + haze);
        vec3 source = air_source(p.height_m, mu_sun, cos_sun, with_glow);
        for (int once = haze > 0.0 ? 0 : 1; once < 1; ++once) {
            source += haze * (sun_through_air(p.height_m, mu_sun) * velum_phase_hg(cos_sun, haze_g) +
                              1.5 * glow_at(p.height_m, mu_sun));
        }
        for (int once = fog > 0.0 ? 0 : 1; once < 1; ++once) {
            /* Fog scatters all it takes, many times over: its first order is dimmed by the fog above, and what was
             * scattered before comes from all sides. */
            float above = eye.drift.y * max(velum_fog_column_m(eye.drift.z, eye.drift.z) -
                                                velum_fog_column_m(p.height_m, eye.drift.z), 0.0);
            vec3 sun = sun_through_air(p.height_m, mu_sun);
            float direct = exp(-above / max(mu_sun, 0.05));
            float diffuse = max(mu_sun, 0.0) / (1.0 + 0.12 * above);
            source += fog * sun * (direct * (0.7 * velum_phase_hg(cos_sun, 0.75) + 0.3 / (4.0 * PI)) + diffuse * 0.8 / PI);
            source += fog * glow_at(p.height_m, mu_sun);
        }
        source *= daylight_share(p.height_m);
        vec3 step_t = exp(-extinction * dt);
        result.luminance += result.transmittance * source * (1.0 - step_t) / max(extinction, vec3(1e-12));
        result.transmittance *= step_t;
    }
    result.luminance *= eye.sun_lx.rgb;
    return result;
}

/* The sky table: azimuth from the sun (0..pi, symmetric) and elevation, finer towards the horizon; its last row holds
 * ambient light (see sky.comp). */
vec2 sky_place(vec3 d) {
    vec3 up = eye.up.xyz;
    float mu = clamp(dot(d, up), -1.0, 1.0);
    float horizon = acos(clamp(-velum_horizon_mu(eye.up.w), -1.0, 1.0)); /* zenith angle of horizon = pi - this */
    float zenith = acos(mu);
    float edge = PI - horizon;
    float v;
    if (zenith < edge) {
        v = 0.5 + 0.5 * sqrt(max(1.0 - zenith / edge, 0.0));
    } else {
        v = 0.5 - 0.5 * sqrt(max((zenith - edge) / max(PI - edge, 1e-4), 0.0));
    }
    vec3 side = d - up * mu;
    vec3 sun_side = eye.sun.xyz - up * dot(eye.sun.xyz, up);
    float cos_azimuth = dot(side, sun_side) * inversesqrt(max(dot(side, side) * dot(sun_side, sun_side), 1e-12));
    float u = sqrt(acos(clamp(cos_azimuth, -1.0, 1.0)) / PI);
    return vec2(u, v);
}

/* Above and below the horizon are different worlds: the table's halves are not filtered into each other. */
vec3 sky_luminance(vec3 d, bool to_ground) {
    if (eye.ground.w == 0.0) {
        return vec3(0.0);
    }
    vec2 place = sky_place(d);
    vec2 size = vec2(VELUM_SKY_W, VELUM_SKY_H - 1);
    float row = place.y * (size.y - 1.0);
    float middle = 0.5 * (size.y - 1.0);
    row = to_ground ? min(row, floor(middle)) : max(row, floor(middle) + 1.0);
    vec2 texel = vec2(place.x * (size.x - 1.0) + 0.5, row + 0.5) / vec2(VELUM_SKY_W, VELUM_SKY_H);
    return textureLod(sky_table, texel, 0.0).rgb * VELUM_LUMINANCE_UNIT;
}

/* Mean luminance of the upper (below: the lower) half of the world as seen from a height over the eye. */
vec3 ambient_at(float height_m, bool below) {
    float x = clamp(sqrt(max(height_m, 0.0) / 20000.0), 0.0, 1.0) * 15.0 + (below ? 16.0 : 0.0) + 0.5;
    return textureLod(sky_table, vec2(x / float(VELUM_SKY_W), (float(VELUM_SKY_H) - 0.5) / float(VELUM_SKY_H)), 0.0)
        .rgb * VELUM_LUMINANCE_UNIT;
}

#endif
