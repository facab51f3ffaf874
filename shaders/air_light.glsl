/* Light through air: transmittance between points, sun at a point, the eye's sky. */
#ifndef VELUM_AIR_LIGHT_GLSL
#define VELUM_AIR_LIGHT_GLSL

#include "air.glsl"
#include "scattering.glsl"
#include "shared/phase.h"
#include "shared/shade.h"

/* Whether there may be fog. The sky without it does not pay for its light. */
layout(constant_id = 12) const bool velum_fog = true;

/* Depth of haze straight down from a height to the surface; below it the haze is even. */
float haze_under(float height_m) {
    float over_m = height_m - eye.span.z;
    return eye.drift.w * (over_m > 0.0 ? haze_scale_m * (1.0 - exp(-over_m / haze_scale_m)) : over_m);
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

/* What haze scatters forward still counts as on its way (delta-Eddington, Joseph et al. 1976); the other mean cosine is
 * what is left. */
const float haze_forward = haze_g * haze_g;
const float haze_turned_g = (haze_g - haze_forward) / (1.0 - haze_forward);
/* Along the eye's way it is less that counts so: the horizon is a bright line, and the ground and the zenith are dark
 * beside it. Fitted to the reference, to haze of 22 to 50 km over black and white ground. */
const float haze_ahead = 0.2;
const float haze_seen_g = (haze_g - haze_ahead) / (1.0 - haze_ahead);

/* Depth of haze over a height that takes light off its way. */
float haze_depth_over(float height_m) {
    return (1.0 - haze_forward) * haze_extinction_1_m(height_m) * haze_scale_m;
}

/* Of a low sun, light that haze turns but a little does not come on either: it meets the ground, or rises. Fitted to the
 * reference, to haze of 40 km under a sun 3 degrees high. */
const float haze_low_mu = 0.07;
float sun_through_haze(float height_m, float mu) {
    float forward = haze_forward * max(mu, 0.0) / (max(mu, 0.0) + haze_low_mu);
    float depth = haze_extinction_1_m(height_m) * haze_scale_m * velum_slant(haze_scale_m, height_m, mu);
    return exp(-(1.0 - forward) * depth);
}

/* Optical depth of fog straight up from a height. */
float fog_over(float height_m) {
    float top_m = eye.drift.z;
    return eye.drift.y * max(velum_fog_column_m(top_m, top_m) - velum_fog_column_m(min(height_m, top_m), top_m), 0.0);
}

/* Transmittance of air between a place and the sun: of clean air, and with haze, but without fog; 1 without air. */
vec3 sun_through_clean_air(float height_m, float mu) {
    if (eye.ground.w == 0.0) {
        return vec3(1.0);
    }
    return air_to_space(height_m, max(mu, velum_horizon_mu(height_m))) * sun_over_horizon(height_m, mu);
}
vec3 sun_through_air(float height_m, float mu) {
    return sun_through_clean_air(height_m, mu) * sun_through_haze(height_m, mu);
}

/* Depth of haze from a height to space; a way below the horizontal passes its lowest point. */
float haze_to_space(float height_m, float mu) {
    float even_m = max(eye.span.z - height_m, 0.0);
    float own = haze_extinction_1_m(height_m) * velum_slant(haze_scale_m, height_m, abs(mu));
    own *= 1.0 + even_m / haze_scale_m;
    float r = VELUM_WGS84_A_M + height_m;
    float lowest_m = r * sqrt(max(1.0 - mu * mu, 0.0)) - VELUM_WGS84_A_M;
    float through = 2.0 * haze_extinction_1_m(lowest_m) * velum_slant(haze_scale_m, lowest_m, 0.0);
    return haze_scale_m * (mu < 0.0 ? through - own : own);
}

/* Longer ways bend round the planet; on shorter ones what is left of two ways to space has no digits. */
const float straight_m = 60000.0;

/* Of a ray, turned so that it rises: heights of two places and cosines of its zenith angle there. */
struct air_stretch {
    float low, high, mu_low, mu_high;
};
air_stretch stretch_of(vec2 from, vec2 to) {
    bool rises = from.y + to.y >= 0.0;
    return air_stretch(rises ? from.x : to.x, rises ? to.x : from.x, rises ? from.y : -to.y, rises ? to.y : -from.y);
}

/* Depth of haze between the places of a stretch, so far apart. */
float haze_between(air_stretch s, float distance_m) {
    float rise = s.high - s.low;
    float straight = abs(rise) < 1.0 ? haze_extinction_1_m(s.low) : (haze_under(s.high) - haze_under(s.low)) / rise;
    float haze = distance_m < straight_m ? straight * distance_m
                                         : haze_to_space(s.low, s.mu_low) - haze_to_space(s.high, s.mu_high);
    return max(haze, 0.0);
}

/* Of fog: it ends at its top. */
float fog_between(air_stretch s, float distance_m) {
    float top_m = eye.drift.z;
    float under_m = max(top_m - s.low, 0.0);
    float to_top = sqrt(s.mu_low * s.mu_low + 2.0 * under_m / VELUM_WGS84_A_M) - s.mu_low;
    float inside_m = min(distance_m, VELUM_WGS84_A_M * to_top);
    float end_m = min(s.high, top_m);
    float climb = end_m - s.low;
    float fog = abs(climb) < 1.0 ? velum_fog_density(s.low, top_m)
                                 : (velum_fog_column_m(end_m, top_m) - velum_fog_column_m(s.low, top_m)) / climb;
    return s.low < top_m ? eye.drift.y * max(fog, 0.0) * max(inside_m, 0.0) : 0.0;
}

/* Transmittance of clean air. */
vec3 clean_between(air_stretch s) {
    vec3 through = air_to_space(s.low, s.mu_low);
    vec3 beyond = air_to_space(s.high, s.mu_high);
    return clamp(through / max(beyond, vec3(1e-6)), vec3(0.0), vec3(1.0));
}
/* With haze and fog. */
vec3 air_between(air_stretch s, float distance_m) {
    float dust = haze_between(s, distance_m) + fog_between(s, distance_m);
    return eye.ground.w == 0.0 ? vec3(1.0) : clean_between(s) * exp(-dust);
}

/* Height and cosine of the zenith angle so far along a ray that starts at height h0 with cosine mu0, on a sphere: for
 * air, which does not mind the metres by which the ellipsoid differs. */
vec2 along_ray(float h0, float mu0, float distance_m) {
    float r0 = VELUM_WGS84_A_M + h0;
    float step = distance_m * (2.0 * r0 * mu0 + distance_m);
    float r1 = sqrt(r0 * r0 + step);
    return vec2(h0 + step / (r0 + r1), (r0 * mu0 + distance_m) / r1);
}

/* Distance along such a ray to a height: where it comes down to it, or where it leaves upward; below 0: never. */
float along_to(float h0, float mu0, float height_m, bool upward) {
    float r0 = VELUM_WGS84_A_M + h0;
    float b = r0 * mu0;
    float over = (h0 - height_m) * (r0 + VELUM_WGS84_A_M + height_m);
    float inside = b * b - over;
    return inside >= 0.0 ? -b + (upward ? 1.0 : -1.0) * sqrt(inside) : -1.0;
}

/* Height, and cosine of the zenith angle, where a ray begins; the same of one that begins near the eye, where level is as it
 * is there. */
vec2 start_of(vec3 o, vec3 d) {
    velum_place from = place_of(o);
    return vec2(from.height_m, dot(vec3(from.nx, from.ny, from.nz), d));
}
vec2 start_by_eye(vec3 o, vec3 d) {
    return vec2(eye.up.w + dot(o, eye.up.xyz), dot(d, eye.up.xyz));
}

/* Where a ray that begins so comes into the air: height and cosine there, and how far along; below 0: it passes by. */
vec2 into_air(vec2 start, out float enter_m) {
    enter_m = start.x > VELUM_AIR_TOP_M ? along_to(start.x, start.y, VELUM_AIR_TOP_M, false) : 0.0;
    return enter_m > 0.0 ? along_ray(start.x, start.y, enter_m) : start;
}

/* All the way from there: to the ground, so far along the ray, or (below 0) to space. */
float air_way_m(vec2 near, float enter_m, float ground_m) {
    return ground_m >= 0.0 ? ground_m - enter_m : along_to(near.x, near.y, VELUM_AIR_TOP_M, true);
}
vec3 air_along(vec2 near, float enter_m, float ground_m) {
    float way_m = air_way_m(near, enter_m, ground_m);
    vec2 far = along_ray(near.x, near.y, max(way_m, 0.0));
    return enter_m < 0.0 ? vec3(1.0) : air_between(stretch_of(near, far), way_m);
}

float phase_rayleigh(float c) {
    return 3.0 / (16.0 * PI) * (1.0 + c * c);
}
/* Mean light of the clouds over the eye's place, at a height (shared/shade.h). */
vec4 shade_at(float height_m) {
    float level = velum_shade_level_of(height_m);
    int k = min(int(level), VELUM_SHADE_LEVELS - 2);
    return mix(eye.shades[k], eye.shades[k + 1], level - float(k));
}

/* Of the clear sky's light, what comes through the clouds over a height: from high up. Of a low sun's sky they hide the
 * horizon, which is red. Fitted to the reference, to air under clouds at dusk. */
const vec2 low_sky_hidden = vec2(0.93, 0.50); /* red, green */
vec3 sky_under(vec4 shade, float mu_sun) {
    vec2 hidden = low_sky_hidden * (1.0 - velum_aside_of(mu_sun));
    return shade.w * exp2(log2(max(shade.w, 1e-6)) * vec3(hidden, 0.0));
}

/* What the world below a height sends back, clouds and ground. */
vec3 albedo_below(vec4 shade) {
    float mean = dot(eye.ground.rgb, vec3(1.0 / 3.0));
    vec3 ground = eye.ground.rgb;
    return vec3(velum_shade_albedo(shade.z, ground.r, mean), velum_shade_albedo(shade.z, ground.g, mean),
                velum_shade_albedo(shade.z, ground.b, mean));
}

/* What aerosol scatters. */
float aerosol_1_m(float height_m) {
    return VELUM_AEROSOL_SCATTERING * velum_aerosol_density(height_m);
}

/* Of what dust scatters, what counts as still on its way to the eye. */
float goes_on_1_m(float height_m, float haze) {
    return haze_ahead * (haze + aerosol_1_m(height_m));
}

/* Depth of clear air over a height that turns light. */
vec3 air_depth_over(float height_m) {
    float aerosol = (1.0 - VELUM_AEROSOL_G) * VELUM_AEROSOL_SCATTERING * VELUM_AEROSOL_SCALE_M;
    return rayleigh_1_m * (VELUM_RAYLEIGH_SCALE_M * velum_rayleigh_density(height_m)) +
           aerosol * velum_aerosol_density(height_m);
}

/* Flux of sun and sky over the sun's own, on a level face. */
vec3 sky_gain_at(float height_m, float mu_sun) {
    vec3 depth = air_depth_over(height_m);
    float slant = velum_slant(VELUM_RAYLEIGH_SCALE_M, height_m, mu_sun);
    return vec3(velum_sky_gain(depth.r, slant), velum_sky_gain(depth.g, slant), velum_sky_gain(depth.b, slant));
}

/* Flux of sun and sky, through haze, on level black ground, per unit sun; of either's, what clouds leave. */
vec3 flux_on_ground(float mu_sun, float sun_share, vec3 sky_share) {
    float haze_mu = 1.0 / velum_slant(haze_scale_m, 0.0, mu_sun);
    float through = velum_flux_under(haze_depth_over(eye.span.z), haze_turned_g, haze_mu);
    float level = max(mu_sun, 0.0);
    vec3 gain = sun_share + (sky_gain_at(0.0, mu_sun) - 1.0) * sky_share;
    return air_to_space(0.0, level) * gain * (level * through);
}

/* All that a world below sends up, over what it is sent from above: air sends some of it back again. */
vec3 albedo_under_air(vec3 albedo, float height_m) {
    vec3 depth = air_depth_over(height_m);
    return albedo / (1.0 - albedo * vec3(velum_sky_back(depth.r), velum_sky_back(depth.g), velum_sky_back(depth.b)));
}

/* All orders beyond the first (Hillaire 2020, section 5.5): mean luminance from all round per unit sun; w: how much more
 * of it molecules turn along a ray, times P2 of the cosine of the ray's zenith angle (glow.comp). */
struct air_glow {
    vec4 sky, ground; /* the latter over a white ground */
};
air_glow glow_at(float height_m, float mu_sun) {
    vec2 place = vec2(0.5 + 0.5 * mu_sun, clamp(height_m / VELUM_AIR_TOP_M, 0.0, 1.0));
    place = place * float(VELUM_GLOW_SIDE - 1) + 0.5;
    const vec2 size = vec2(VELUM_GLOW_SIDE, 2 * VELUM_GLOW_SIDE);
    return air_glow(textureLod(glow_table, place / size, 0.0),
                    textureLod(glow_table, (place + vec2(0.0, VELUM_GLOW_SIDE)) / size, 0.0));
}

/* Of light that clouds have turned, with all orders of it in air and haze: fitted to the reference, to haze under
 * overcast. */
const float diffused = 1.25;

struct air_light {
    vec3 luminance; /* per unit sun_lx, already times it */
    vec3 transmittance;
    vec3 reaches; /* of light from beyond, that haze scatters forward too */
};

const float fog_mean_cosine = (1.0 - VELUM_FOG_EVEN) * VELUM_FOG_G;

/* Cosine of the sun, as low as fog and haze take it for. */
float sun_on_fog(float mu_sun) {
    return max(mu_sun, 0.06);
}

/* Share of the sun's flux that comes to the ground under fog of so much optical depth, by Eddington's approximation. */
float sun_under_fog(float depth, float mu_sun, float albedo) {
    const float g = fog_mean_cosine;
    float scaled = (1.0 - g * g) * depth;
    velum_diffuse surface = velum_diffuse_in(scaled, 0.0, g / (1.0 + g), mu_sun, albedo);
    return exp(-scaled / mu_sun) + (PI / mu_sun) * (surface.mean + surface.flux * (2.0 / 3.0));
}

/* Fog, per unit of its scattering, with what the ground sends: what it scatters more than once of a sun of illuminance
 * 1, by the table; all that it scatters of even light from above, over half of that light's luminance; and the share of
 * the sun's flux that both send back to the sky. */
struct fog_light {
    vec3 sun, sky;
    float back;
};
fog_light fog_light_at(float above, float below, float mu_sun, float cos_sun, float rise, vec3 albedo) {
    const float g = fog_mean_cosine;
    float mean = dot(albedo, vec3(1.0 / 3.0));
    float lit = sun_under_fog(above + below, mu_sun, mean);
    float through = 1.0 / (1.0 + 0.75 * (1.0 - mean) * (1.0 - g) * (above + below)); /* Eddington's, of even light */
    vec2 sky = scattered_sky(VELUM_SCATTERING_FOG, above, below, -rise);
    fog_light light;
    light.sun = albedo * (lit * mu_sun / PI * sky.y) +
                scattered_sun(VELUM_SCATTERING_FOG, scattering_rest(g, 1.0), above, below, mu_sun, -rise, cos_sun);
    light.sky = 2.0 * (sky.x + albedo * (through * sky.y));
    light.back = 1.0 - (1.0 - mean) * lit;
    return light;
}

/* Of the clear sky's light, what an even sky of as much flux would have: it is brightest at the horizon. Fitted to the
 * reference; of molecules that shine alike at all heights it would be 0.52, 0.61 and 0.74, (1 - 2 E3) / (1 - E2). */
const float fog_sky = 0.81;
/* The same of light that has come through cloud, which sends less to its sides than even light has. Fitted to the
 * reference, to fog under stratus with the sun 15 and 50 degrees high. */
const float fog_clouded = 0.95;

/* The sun's light that haze has turned, of a sun of 1 over it, at a height: Eddington's, but where haze is thin, it stands at
 * the horizon: its mean, E2 of the depth, is more. The constant is fitted to the reference. */
velum_diffuse haze_of_sun(float height_m, float above, float below, float mu_sun) {
    float mu = 1.0 / velum_slant(haze_scale_m, height_m, mu_sun);
    velum_diffuse sun = velum_diffuse_in(above, below, haze_turned_g, mu, 0.0);
    sun.mean *= max(1.0 - 0.5 * log(max(above + below, 1e-6)), 1.0);
    return sun;
}

/* Of haze, per unit of its scattering: the sun's light that it has turned before, of a sun whose light without it were
 * `clean`, and what the ground sends that gets `flux`, both on their way to an eye whose ray rises so. Light comes
 * to the eye against its ray: upward rays see what goes down. */
vec3 haze_diffuse(float height_m, vec3 clean, vec3 flux, float mu_sun, float rise, vec3 albedo) {
    float above = haze_depth_over(height_m);
    float below = max(haze_depth_over(eye.span.z) - above, 0.0);
    velum_diffuse sun = haze_of_sun(height_m, above, below, mu_sun);
    velum_diffuse ground = velum_diffuse_from_below(above, below, haze_turned_g);
    vec3 sent = albedo_under_air(albedo, 0.0) * flux / PI;
    return clean * max(sun.mean + haze_seen_g * rise * sun.flux, 0.0) +
           sent * (ground.mean + haze_seen_g * rise * ground.flux);
}

/* What comes of the former to the air about and over the haze, from all round; clouds between hide it. */
vec3 haze_on_air(float height_m, float mu_sun, vec4 shade) {
    float low_m = min(height_m, eye.span.z + haze_scale_m);
    float above = haze_depth_over(height_m);
    float below = max(haze_depth_over(eye.span.z) - above, 0.0);
    vec4 there = shade_at(low_m);
    vec3 clean = sun_through_clean_air(low_m, mu_sun) * ((there.x + there.y) * (1.0 - shade.z));
    return clean * haze_of_sun(low_m, above, below, mu_sun).mean;
}

/* Light from below that aerosol turns on upward or downward, over what it would turn evenly: by the half of its phase
 * function ahead (Henyey & Greenstein 1941, integrated). */
const float aerosol_ahead = 0.9;

/* Luminance per unit length and unit sun that air, haze and fog send along a ray. The first order of haze goes by the
 * phase function over scaled depths (Nakajima & Tanaka 1988). */
vec3 air_source(float height_m, float haze, float fog, float mu_sun, float cos_sun, float rise, bool with_glow) {
    vec4 shade = shade_at(height_m);
    float beam = shade.x;
    vec3 albedo = albedo_below(shade);
    float daylight = shade.x + shade.y;
    vec3 sky = sky_under(shade, mu_sun);
    vec3 clean = sun_through_clean_air(height_m, mu_sun);
    vec3 sun = clean * sun_through_haze(height_m, mu_sun);
    vec3 rayleigh = rayleigh_1_m * velum_rayleigh_density(height_m);
    float aerosol = aerosol_1_m(height_m);
    vec3 of_sky = rayleigh + (1.0 - haze_ahead) * aerosol;
    vec3 single = rayleigh * phase_rayleigh(cos_sun) + aerosol * velum_phase_hg(cos_sun, VELUM_AEROSOL_G);
    vec3 source = sun * beam * single;
    const float least_1_m = 1e-10;
    if (haze > least_1_m) {
        vec3 flux = flux_on_ground(mu_sun, daylight, sky);
        vec3 others = haze_diffuse(height_m, daylight * clean, flux, mu_sun, rise, albedo);
        source += haze * sun * beam * velum_phase_hg(cos_sun, haze_g);
        source += (1.0 - haze_ahead) * haze * others;
    }
    if (eye.drift.w > least_1_m) {
        source += of_sky * haze_on_air(height_m, mu_sun, shade);
    }
    /* The clouds below stand about half way to the ground. */
    float below_m = 0.5 * shade.z * min(height_m, VELUM_SHADE_TOP_M);
    vec3 reflected = albedo_under_air(albedo, below_m);
    vec3 of_ground = of_sky - (aerosol_ahead - haze_ahead) * rise * aerosol;
    vec3 of_cloud = diffused * (of_sky + (1.0 - haze_forward) * haze);
    of_sky += (1.0 - haze_ahead) * haze;
    vec3 of_back = vec3(0.0);
    if (fog > 0.0) {
        float above = fog_over(height_m);
        float below = max(fog_over(eye.span.z) - above, 0.0);
        float sun_height = sun_on_fog(mu_sun);
        fog_light light = fog_light_at(above, below, sun_height, cos_sun, rise, albedo);
        float first = velum_phase_lobes_at(velum_phase_lobes_fog(), cos_sun);
        source += sun * (fog * beam) * (exp(-above / sun_height) * first + light.sun);
        of_sky += fog * light.sky * fog_sky;
        of_cloud += fog * light.sky * fog_clouded;
        of_back = fog * light.sky * light.back;
    }
    /* What has come through cloud, or aside of it, comes from all over it. */
    source += of_cloud * sun * shade.y * 2.0 * max(mu_sun, 0.0) * VELUM_INV_4PI;
    if (with_glow) {
        air_glow glow = glow_at(height_m, mu_sun);
        vec3 tilted = rayleigh * (1.5 * rise * rise - 0.5);
        source += sky * (of_sky + tilted * glow.sky.w) * glow.sky.rgb;
        source += sky * reflected * (of_ground + tilted * glow.ground.w) * glow.ground.rgb;
        if (fog > 0.0) {
            /* Of a white ground's glow half a world is the ground; the rest the sky sends. */
            source += sky * of_back * max(glow.ground.rgb - flux_on_ground(mu_sun, 1.0, vec3(1.0)) / (2.0 * PI), vec3(0.0));
        }
    }
    return source;
}

/* From where to where a ray is in the fog, within its way; alike: nowhere. */
vec2 fog_way_m(vec3 o, vec3 d, float distance_m) {
    vec2 way = vec2(0.0);
    if (eye.drift.y > 0.0) {
        velum_place p = place_of(o);
        float rise = dot(vec3(p.nx, p.ny, p.nz), d);
        float inside = rise * rise - 2.0 * (p.height_m - eye.drift.z) / VELUM_WGS84_A_M;
        float root = sqrt(max(inside, 0.0));
        vec2 at = VELUM_WGS84_A_M * (vec2(-root, root) - rise);
        way = inside > 0.0 && at.x < distance_m ? clamp(at, vec2(0.0), vec2(distance_m)) : vec2(0.0);
    }
    return way;
}

/* Where a share of the steps along a way of air ends: they are finest about `low_m`, and more so the steeper it is. */
float air_node(float share, float way_m, float low_m, float steep) {
    float low = clamp(low_m, 0.0, way_m);
    float before = sqrt(low) / max(sqrt(low) + sqrt(way_m - low), 1e-6);
    float y = share < before ? 1.0 - share / before : (share - before) / max(1.0 - before, 1e-6);
    float bent = y * y * mix(1.0, y, steep);
    return share < before ? low * (1.0 - bent) : low + (way_m - low) * bent;
}

/* Air and fog from offset o along d; `veiled`: what lies beyond the clouds above is seen through them, of whose sky's flux
 * so much comes through; 0: as if there were none. */
air_light air_march_under(vec3 o, vec3 d, float distance_m, int steps, bool with_glow, float veiled) {
    air_light result = air_light(vec3(0.0), vec3(1.0), vec3(1.0));
    if (eye.ground.w == 0.0) {
        return result;
    }
    float cos_sun = dot(d, eye.sun.xyz);
    if (eye.up.w > VELUM_AIR_TOP_M) {
        velum_span air = velum_sphere_span(eye_geometry(), o.x, o.y, o.z, d.x, d.y, d.z, VELUM_AIR_TOP_M);
        float enter_m = air.enter_m <= air.leave_m ? clamp(air.enter_m, 0.0, distance_m - 1.0) : 0.0;
        o += d * enter_m;
        distance_m -= enter_m;
    }
    /* Before fog, in it and behind it; from within it there is no before. */
    vec2 fog_m = fog_way_m(o, d, distance_m);
    bool foggy = fog_m.y > fog_m.x;
    bool ends = fog_m.y < 0.98 * distance_m;
    bool within = foggy && fog_m.x <= 0.0;
    int inside = !foggy ? 0 : within && !ends ? steps : steps / 3;
    int behind = !foggy || within ? steps - inside : ends ? steps / 6 : 0;
    int ahead = steps - inside - behind;
    /* The lowest place is where most of the air is, if it is much lower than the first. */
    velum_place first = place_of(o);
    float fall = -dot(vec3(first.nx, first.ny, first.nz), d);
    float lowest_m = clamp(VELUM_WGS84_A_M * fall, 0.0, distance_m);
    float drop_m = max(lowest_m * (fall - lowest_m / (2.0 * VELUM_WGS84_A_M)), 0.0);
    float low_m = lowest_m * (1.0 - exp(-drop_m / 3000.0));
    float steep = min(drop_m / 30000.0, 1.0);
    float before = 0.0;
    for (int i = 0; i < steps; ++i) {
        int part = i < ahead ? 0 : i < ahead + inside ? 1 : 2;
        float from_m = part == 0 ? 0.0 : part == 1 ? fog_m.x : fog_m.y;
        float way_m = (part == 0 ? fog_m.x : part == 1 ? fog_m.y : distance_m) - from_m;
        int done = part == 0 ? 0 : part == 1 ? ahead : ahead + inside;
        float x = float(i + 1 - done) / float(part == 0 ? ahead : part == 1 ? inside : behind);
        /* From above, of fog the skin is seen. */
        bool skin = part == 1 && ahead > 0;
        float t1 = from_m + (skin ? way_m * x * x * x : air_node(x, way_m, low_m - from_m, steep));
        float t = 0.5 * (before + t1);
        float dt = t1 - before;
        before = t1;
        velum_place p = place_of(o + d * t);
        vec3 normal = vec3(p.nx, p.ny, p.nz);
        float mu_sun = dot(normal, eye.sun.xyz);
        float fog = velum_fog ? fog_extinction_1_m(p.height_m) : 0.0;
        float haze = haze_extinction_1_m(p.height_m);
        vec3 extinction = air_extinction_1_m(p.height_m) + vec3(fog + haze);
        vec3 dims = extinction - vec3(goes_on_1_m(p.height_m, haze));
        vec3 source = air_source(p.height_m, haze, fog, mu_sun, cos_sun, dot(normal, d), with_glow);
        vec3 step_t = exp(-dims * dt);
        float seen = veiled > 0.0 ? min(veiled / max(shade_at(p.height_m).w, 1e-4), 1.0) : 1.0;
        result.luminance += seen * result.reaches * source * (1.0 - step_t) / max(dims, vec3(1e-12));
        result.reaches *= step_t;
        result.transmittance *= exp(-extinction * dt);
    }
    result.luminance *= eye.sun_lx.rgb;
    return result;
}

air_light air_march(vec3 o, vec3 d, float distance_m, int steps, bool with_glow) {
    return air_march_under(o, d, distance_m, steps, with_glow, 0.0);
}

/* The sky table: azimuth from the sun (0..pi, symmetric) and elevation, finer towards the horizon; its last columns hold
 * optical depths, its last row ambient light (see sky.comp). */
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

struct sky_light {
    vec3 luminance;
    vec3 transmittance; /* of all the way: to the ground, or to space */
};

const vec2 sky_size = vec2(VELUM_SKY_COLUMNS, VELUM_SKY_H);

/* Column and row. Above and below the horizon are different worlds: the table's halves are not filtered into each
 * other. */
vec2 sky_texel(vec3 d, bool to_ground) {
    vec2 place = sky_place(d);
    vec2 size = vec2(VELUM_SKY_W, VELUM_SKY_H - 1);
    float row = place.y * (size.y - 1.0);
    float middle = 0.5 * (size.y - 1.0);
    row = to_ground ? min(row, floor(middle)) : max(row, floor(middle) + 1.0);
    return vec2(place.x * (size.x - 1.0), row) + 0.5;
}

sky_light sky_light_at(vec2 texel) {
    sky_light sky;
    sky.luminance = textureLod(sky_table, texel / sky_size, 0.0).rgb;
    sky.luminance *= eye.ground.w == 0.0 ? 0.0 : VELUM_LUMINANCE_UNIT;
    sky.transmittance = exp(-textureLod(sky_table, vec2(VELUM_SKY_W + 1.0, texel.y) / sky_size, 0.0).rgb);
    return sky;
}

/* Of all the way, in [0, 1], that to a column of the extinctions of clean air and haze: finest at both ends. */
float sky_share_of(int column) {
    return 0.5 - 0.5 * cos(PI * float(column) / float(VELUM_SKY_SHARES - 1));
}

/* The table's unit of extinction: what a kilometre has, for halves. */
const float sky_length_m = 1000.0;

/* Transmittance of air and fog before what stands so far along a ray that begins near the eye; `ground_m`: as of
 * ground_distance. */
vec3 air_before(vec2 start, float row, float ground_m, float distance_m) {
    float way_m = air_way_m(start, 0.0, ground_m);
    distance_m = ground_m >= 0.0 ? distance_m : min(distance_m, way_m);
    float share = clamp(distance_m / max(way_m, 1.0), 0.0, 1.0);
    float column = acos(1.0 - 2.0 * share) * (float(VELUM_SKY_SHARES - 1) / PI);
    vec2 texel = vec2(float(VELUM_SKY_W) + 2.5 + column, row);
    vec3 clear_1_m = textureLod(sky_table, texel / sky_size, 0.0).rgb / sky_length_m;
    vec2 there = along_ray(start.x, start.y, distance_m);
    return exp(-clear_1_m * distance_m - fog_between(stretch_of(start, there), distance_m));
}

/* Light of cloud so far away, and of the air before it: it dims, and shines in the share that the cloud covers. */
vec3 air_before_cloud(vec3 o, vec3 d, vec3 light, float through, float distance_m, bool any) {
    air_light air = air_march(o, d, max(distance_m, 1.0), any ? 6 : 0, true);
    return any && eye.ground.w != 0.0 ? light * air.transmittance + air.luminance * (1.0 - through) : light;
}

/* The upper (below: the lower) half of the world as seen from a height, by levels as in shared/shade.h: mean luminance;
 * `even`: of an even half whose flux onto a level face is the same. */
vec3 half_world(float level, bool below, bool even) {
    float x = level + float((below ? VELUM_SHADE_LEVELS : 0) + (even ? 2 * VELUM_SHADE_LEVELS : 0)) + 0.5;
    vec2 place = vec2(x / float(VELUM_SKY_COLUMNS), (float(VELUM_SKY_H) - 0.5) / float(VELUM_SKY_H));
    return textureLod(sky_table, place, 0.0).rgb * VELUM_LUMINANCE_UNIT;
}

/* From the next level beyond a layer's face: with nothing of the layer itself. */
vec3 ambient_over(float top_m, bool even) {
    return half_world(ceil(velum_shade_level_of(top_m)), false, even);
}
vec3 ambient_under(float base_m, bool even) {
    return half_world(floor(velum_shade_level_of(base_m)), true, even);
}

#endif
