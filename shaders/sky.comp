#version 460
#extension GL_GOOGLE_include_directive : require
/* The sky from an eye, cd/m2 over VELUM_LUMINANCE_UNIT: to space above the horizon, to the ground below it. Then two
 * columns, alike: optical depth of that way; then mean extinction, over sky_length_m, of clean air and haze as far as
 * shares of it (sky_share_of). Last row: mean luminance of the half world above (texels 0..31) and below (32..63), at the
 * levels of shared/shade.h; then the same of even halves of as much flux (64..127). */
#include "air_light.glsl"
layout(local_size_x = VELUM_GROUP, local_size_y = VELUM_GROUP) in;
layout(set = 0, binding = VELUM_BIND_SKY_OUT, rgba16f) uniform writeonly image2D sky_out;

/* A level direction towards the sun; in its zenith, any. */
vec3 towards_sun(vec3 up) {
    vec3 side = eye.sun.xyz - up * dot(eye.sun.xyz, up);
    if (dot(side, side) < 1e-10) {
        side = abs(up.z) < 0.9 ? cross(up, vec3(0.0, 0.0, 1.0)) : cross(up, vec3(1.0, 0.0, 0.0));
    }
    return normalize(side);
}

/* Distance through the air, or to the ground: where the ray from o leaves or ends; start is where it enters. */
float air_distance(vec3 o, vec3 d, bool to_ground, out float start) {
    velum_span air = velum_sphere_span(eye_geometry(), o.x, o.y, o.z, d.x, d.y, d.z, VELUM_AIR_TOP_M);
    start = max(air.enter_m, 0.0);
    float end = air.leave_m;
    if (to_ground) {
        float ground = ground_distance(o, d);
        /* On the horizon a ray may just miss: it ends where it is lowest. */
        end = ground >= 0.0 ? ground : 0.5 * (air.enter_m + air.leave_m);
    }
    return max(end - start, 0.0);
}

/* What a level white face sends that is lit by the sun. */
vec3 sunlit_luminance(float height_m, float mu_sun) {
    return eye.sun_lx.rgb * (max(mu_sun, 0.0) / PI) * sun_through_air(height_m, mu_sun);
}
/* By sun and sky, under clouds. */
vec3 daylit_luminance(float height_m, float mu_sun, vec4 shade) {
    vec3 by_sun = sunlit_luminance(height_m, mu_sun) * (shade.x + shade.y);
    if (eye.ground.w == 0.0) {
        return by_sun;
    }
    vec3 of_sky = (sky_gain_at(height_m, mu_sun) - 1.0) * sky_under(shade, mu_sun);
    return by_sun + eye.sun_lx.rgb * (max(mu_sun, 0.0) / PI) * sun_through_clean_air(height_m, mu_sun) * of_sky;
}

/* What a world below sends, in light that goes to and fro between it and the air. */
vec3 sent_up(float height_m, vec3 albedo) {
    return eye.ground.w != 0.0 ? albedo_under_air(albedo, height_m) : albedo;
}

/* Under the clouds over the eye. */
vec3 ground_luminance(float mu_sun) {
    vec4 shade = shade_at(0.0);
    float fog = 1.0;
    if (velum_fog) {
        fog = sun_under_fog(fog_over(eye.span.z), sun_on_fog(mu_sun), dot(eye.ground.rgb, vec3(1.0 / 3.0)));
    }
    vec3 flux = vec3(max(mu_sun, 0.0) * (shade.x + shade.y));
    if (eye.ground.w != 0.0) {
        flux = flux_on_ground(mu_sun, shade.x + shade.y, sky_under(shade, mu_sun));
    }
    return eye.sun_lx.rgb * flux / PI * fog * sent_up(0.0, eye.ground.rgb);
}

vec3 ambient(int index) {
    bool even = index >= 2 * VELUM_SHADE_LEVELS;
    bool below = (index / VELUM_SHADE_LEVELS & 1) != 0;
    float height_m = velum_shade_height_m(index % VELUM_SHADE_LEVELS);
    vec3 up = eye.up.xyz;
    vec3 o = up * (max(height_m, 10.0) - eye.up.w);
    vec3 side = towards_sun(up);
    vec3 across = cross(up, side);
    float mu_sun = dot(up, eye.sun.xyz);
    vec4 here = shade_at(height_m);
    vec3 from_ground = ground_luminance(mu_sun);
    /* The sun's way to here holds all of the air: what clouds turn of it is not dimmed again. */
    vec3 from_above = sunlit_luminance(height_m, mu_sun) * here.y;
    /* The clouds below stand about half way to the ground. */
    float cloud_m = 0.5 * height_m;
    vec3 from_cloud = daylit_luminance(cloud_m, mu_sun, here) * sent_up(cloud_m, vec3(here.z));
    vec3 sum = vec3(0.0);
    const int count = 16;
    for (int k = 0; k < count; ++k) {
        float c = (float(k / 4) + 0.5) / 4.0;
        float a = 2.0 * PI * (float(k % 4) + 0.5 + 0.25 * float(k / 4)) / 4.0;
        float s = sqrt(1.0 - c * c);
        vec3 d = side * (s * cos(a)) + across * (s * sin(a)) + up * (below ? -c : c);
        float start;
        float distance_m = air_distance(o, d, below, start);
        air_light light = air_march_under(o + d * start, d, distance_m, 8, true, below ? 0.0 : max(here.w, 1e-4));
        vec3 luminance = light.luminance;
        if (below) {
            luminance += light.reaches * (from_ground * (1.0 - here.z) + from_cloud);
        } else {
            luminance += from_above;
        }
        sum += (even ? 2.0 * c : 1.0) * luminance;
    }
    return sum / float(count);
}

const float black = 1e-6;

/* Of clean air and haze so far along a ray that begins at such a height with such a cosine. */
vec3 clear_depth(vec2 near, float way_m) {
    air_stretch whole = stretch_of(near, along_ray(near.x, near.y, way_m));
    float low_m = clamp(-VELUM_WGS84_A_M * near.y, 0.0, way_m);
    vec3 clean = vec3(0.0);
    float before_m = 0.0;
    const int steps = 24;
    for (int i = 0; i < (way_m < straight_m ? steps : 0); ++i) {
        float to_m = air_node(float(i + 1) / float(steps), way_m, low_m, 1.0);
        float height_m = along_ray(near.x, near.y, 0.5 * (before_m + to_m)).x;
        clean += air_extinction_1_m(height_m) * (to_m - before_m);
        before_m = to_m;
    }
    vec3 longer = -log(max(clean_between(whole), vec3(black)));
    return (way_m < straight_m ? clean : longer) + haze_between(whole, way_m);
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (texel.x >= VELUM_SKY_COLUMNS || texel.y >= VELUM_SKY_H) {
        return;
    }
    vec3 result = vec3(0.0);
    if (texel.y == VELUM_SKY_H - 1) {
        if (texel.x < 4 * VELUM_SHADE_LEVELS) {
            result = ambient(texel.x) / VELUM_LUMINANCE_UNIT;
        }
    } else if (eye.ground.w != 0.0) {
        vec2 place = vec2(texel) / vec2(VELUM_SKY_W - 1, VELUM_SKY_H - 2);
        vec3 up = eye.up.xyz;
        float edge = PI - acos(clamp(-velum_horizon_mu(eye.up.w), -1.0, 1.0));
        bool to_ground = texel.y <= (VELUM_SKY_H - 2) / 2;
        float zenith;
        if (to_ground) {
            float y = 1.0 - 2.0 * place.y;
            zenith = edge + y * y * (PI - edge);
        } else {
            float y = 2.0 * place.y - 1.0;
            zenith = edge * (1.0 - y * y);
        }
        float azimuth = min(place.x * place.x, 1.0) * PI;
        vec3 sun_side = towards_sun(up);
        vec3 across = cross(up, sun_side);
        vec3 d = up * cos(zenith) + (sun_side * cos(azimuth) + across * sin(azimuth)) * sin(zenith);
        float start;
        float distance_m = air_distance(vec3(0.0), d, to_ground, start);
        if (texel.x >= VELUM_SKY_W) {
            float enter_m;
            vec2 near = into_air(start_of(vec3(0.0), d), enter_m);
            float ground_m = to_ground ? start + distance_m : -1.0;
            if (texel.x < VELUM_SKY_W + 2) {
                result = -log(max(air_along(near, enter_m, ground_m), vec3(black)));
            } else {
                float share = sky_share_of(texel.x - (VELUM_SKY_W + 2));
                float way_m = share * air_way_m(near, max(enter_m, 0.0), ground_m);
                vec3 here_1_m = air_extinction_1_m(near.x) + haze_extinction_1_m(near.x);
                result = sky_length_m * (way_m > 1.0 ? clear_depth(near, way_m) / way_m : here_1_m);
            }
        } else {
            air_light light = air_march(d * start, d, distance_m, 24, true);
            result = light.luminance;
            if (to_ground) {
                /* What haze scatters forward of the ground's light; the rest of it is transmittance. */
                vec3 end = normalize(up * (VELUM_WGS84_A_M + eye.up.w) + d * (start + distance_m));
                result += (light.reaches - light.transmittance) * ground_luminance(dot(end, eye.sun.xyz));
            }
            result /= VELUM_LUMINANCE_UNIT;
        }
    }
    imageStore(sky_out, texel, vec4(result, 1.0));
}
