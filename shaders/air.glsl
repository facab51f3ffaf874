/* What the air is: extinction of gas, haze and fog by height. */
#ifndef VELUM_AIR_GLSL
#define VELUM_AIR_GLSL

#include "engine.glsl"

const vec3 rayleigh_1_m = vec3(VELUM_RAYLEIGH_R, VELUM_RAYLEIGH_G, VELUM_RAYLEIGH_B);
const vec3 ozone_1_m = vec3(VELUM_OZONE_R, VELUM_OZONE_G, VELUM_OZONE_B);

vec3 air_extinction_1_m(float height_m) {
    return rayleigh_1_m * velum_rayleigh_density(height_m) +
           vec3(VELUM_AEROSOL_EXTINCTION * velum_aerosol_density(height_m)) + ozone_1_m * velum_ozone_density(height_m);
}

float fog_extinction_1_m(float height_m) {
    return eye.drift.y * velum_fog_density(height_m, eye.drift.z);
}

/* Haze thins out upward from the surface; it has no top. A place has fog or haze. */
const float haze_scale_m = 1500.0;
const float haze_g = 0.7;
float haze_extinction_1_m(float height_m) {
    return eye.drift.w * exp(-max(height_m - eye.span.z, 0.0) / haze_scale_m);
}

#endif
