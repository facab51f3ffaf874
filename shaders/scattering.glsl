/* The table of multiple scattering on the device (shared/scattering.h). */
#ifndef VELUM_SCATTERING_GLSL
#define VELUM_SCATTERING_GLSL

#include "engine.glsl"
#include "shared/scattering.h"

layout(set = 0, binding = VELUM_BIND_SCATTERING) uniform sampler3D scattering_table;

vec4 scattering_texel(int which, float above, float below, float slice) {
    vec3 node = vec3(float(which * VELUM_SCATTERING_DEPTHS) + velum_scattering_depth_node(above),
                     velum_scattering_depth_node(below), slice);
    const vec3 size = vec3(float(VELUM_SCATTERING_TABLES * VELUM_SCATTERING_DEPTHS), float(VELUM_SCATTERING_DEPTHS),
                           float(VELUM_SCATTERING_SLICES));
    return textureLod(scattering_table, (node + 0.5) / size, 0.0);
}

/* Of what a table is for: mean cosine that its peak leaves, and share of extinction that is not that peak. */
struct scattering_rest {
    float g, scale;
};

/* Source function by all orders but the first, for a sun of illuminance 1: optical depths out of the layer towards the
 * side of its normal and away from it; cosines of that normal with the sun and with the way of the light, and of the
 * angle by which light turns. */
float scattered_sun(int which, scattering_rest rest, float above, float below, float mu_sun, float mu, float cos_sun) {
    bool turned = mu_sun < 0.0;
    float lit = turned ? below : above;
    float dark = turned ? above : below;
    float towards = turned ? -mu : mu;
    float height = abs(mu_sun);
    float sun = velum_scattering_sun_node(height);
    float low = min(floor(sun), float(VELUM_SCATTERING_SUNS - 2));
    float slice = low * float(VELUM_SCATTERING_MUS) + velum_scattering_mu_node(towards);
    vec4 c = mix(scattering_texel(which, lit, dark, slice),
                 scattering_texel(which, lit, dark, slice + float(VELUM_SCATTERING_MUS)), sun - low);
    float azimuth = velum_scattering_azimuth(towards, height, cos_sun);
    float shape = velum_scattering_shape(cos_sun, rest.g, velum_scattering_turning(lit, height, rest.scale));
    return velum_scattering_value(c.x, c.y, c.z, c.w, azimuth) * shape * velum_scattering_thin(above + below);
}

/* The same by all orders of even light from beyond the side of the normal (x), and from beyond the other (y). */
vec2 scattered_sky(int which, float above, float below, float mu) {
    const float first = float(VELUM_SCATTERING_MUS * VELUM_SCATTERING_SUNS);
    return exp2(scattering_texel(which, above, below, first + velum_scattering_mu_node(mu)).xy);
}

#endif
