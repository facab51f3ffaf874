#version 460
#extension GL_GOOGLE_include_directive : require
/* All orders of scattering in air beyond the first, as a mean luminance from all round per unit sun (Hillaire 2020,
 * eq. 5-10), over a sphere: first rows without a ground's light, second with what a white one adds. What molecules scatter
 * first goes by their phase function: a low sun's stands at the horizon. So they turn more of it onto level rays: over an
 * even phase function theirs is 1 + P2 / 2 of the cosine, and by the addition theorem of Legendre polynomials, on the mean
 * of all azimuths, 1 + w P2 of the ray's, where w is half of the mean of P2 over the light (of the first order, and of
 * green; taken for all). Once. */
#include "air_light.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 0, binding = VELUM_BIND_GLOW_OUT, rgba16f) uniform writeonly image2D glow_out;

const int zeniths = 16, azimuths = 4; /* on one side of the plane through sun and zenith: the other is alike */
const int steps = 20;

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (texel.x >= VELUM_GLOW_SIDE || texel.y >= 2 * VELUM_GLOW_SIDE) {
        return;
    }
    bool of_ground = texel.y >= VELUM_GLOW_SIDE;
    vec2 place = vec2(texel.x, texel.y % VELUM_GLOW_SIDE) / float(VELUM_GLOW_SIDE - 1);
    float mu_sun = place.x * 2.0 - 1.0;
    float height_m = max(place.y * VELUM_AIR_TOP_M, 1.0);
    vec3 sun = vec3(sqrt(max(1.0 - mu_sun * mu_sun, 0.0)), 0.0, mu_sun);
    float r = VELUM_WGS84_A_M + height_m;
    float top = VELUM_WGS84_A_M + VELUM_AIR_TOP_M;
    vec3 second = vec3(0.0);
    vec3 factor = vec3(0.0);
    float moment = 0.0; /* of P2 */
    for (int k = 0; k < zeniths * azimuths; ++k) {
        /* Finest at the horizon, where air shines most. */
        float u = 1.0 - 2.0 * (float(k / azimuths) + 0.5) / float(zeniths);
        float c = u * abs(u);
        float weight = 2.0 * abs(u) / float(zeniths * azimuths);
        float a = PI * (float(k % azimuths) + 0.5) / float(azimuths);
        float s = sqrt(max(1.0 - c * c, 0.0));
        vec3 d = vec3(s * cos(a), s * sin(a), c);
        float cos_sun = dot(d, sun);
        float p2 = 1.5 * c * c - 0.5;
        float b = r * c;
        float over = height_m * (2.0 * VELUM_WGS84_A_M + height_m);
        float to_ground = b * b - over;
        bool hits = c < 0.0 && to_ground > 0.0;
        float distance_m = hits ? -b - sqrt(to_ground) : -b + sqrt(max(b * b - r * r + top * top, 0.0));
        vec3 t = vec3(1.0);
        float dt = distance_m / float(steps);
        for (int i = 0; i < steps; ++i) {
            float x = (float(i) + 0.5) * dt;
            float up = over + x * (x + 2.0 * b);
            float radius = sqrt(VELUM_WGS84_A_M * VELUM_WGS84_A_M + up);
            float h = max(up / (radius + VELUM_WGS84_A_M), 0.0);
            float mu = (r * mu_sun + x * cos_sun) / radius;
            vec3 rayleigh = rayleigh_1_m * velum_rayleigh_density(h);
            float aerosol = aerosol_1_m(h);
            vec3 extinction = air_extinction_1_m(h);
            vec3 step_t = exp(-extinction * dt);
            vec3 seen = weight * t * (1.0 - step_t) / max(extinction, vec3(1e-12));
            float lit = smoothstep(-0.005, 0.005, mu - velum_horizon_mu(h));
            vec3 beam = air_to_space(h, max(mu, velum_horizon_mu(h)));
            vec3 first = rayleigh * phase_rayleigh(cos_sun) + aerosol * VELUM_INV_4PI;
            vec3 light = of_ground ? vec3(0.0) : seen * first * beam * lit;
            second += light;
            moment += light.g * p2;
            factor += seen * (rayleigh + aerosol);
            t *= step_t;
        }
        if (hits && of_ground) {
            float mu = (r * mu_sun + distance_m * cos_sun) / VELUM_WGS84_A_M;
            vec3 light = weight * t * air_to_space(0.0, max(mu, 0.0)) * sky_gain_at(0.0, mu) * (max(mu, 0.0) / PI);
            second += light;
            moment += light.g * p2;
        }
    }
    imageStore(glow_out, texel, vec4(second / max(1.0 - factor, vec3(0.05)), 0.5 * moment / max(second.g, 1.0e-12)));
}
