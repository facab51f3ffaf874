/* Light that cloud sends to the eye by the volume of light around it. */
#ifndef VELUM_LIGHT_VOLUME_SOURCE_GLSL
#define VELUM_LIGHT_VOLUME_SOURCE_GLSL

#include "light_volume.glsl"
#include "study.glsl"

/* Cells from a side of the volume over which our own light takes its place. */
const float volume_rim = 4.0;

bool volume_holds(int slot) {
    return (volume.grid.w & (1u << uint(slot))) != 0u;
}

/* Of the cells around a place, by how much cloud they have: the eye sees the light of that, not of the air beside it. */
struct volume_light {
    vec3 light, sun, flux;
    float transport_1_m; /* 0: there is none */
};
volume_light volume_light_at(vec3 place) {
    ivec3 first = ivec3(floor(place - 0.5));
    vec3 share = place - 0.5 - vec3(first);
    int count = volume_count();
    volume_light sum = volume_light(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    float whole = 0.0;
    for (int i = 0; i < 8; ++i) {
        ivec3 corner = ivec3(i & 1, i >> 1 & 1, i >> 2);
        int at = volume_index(first + corner);
        vec3 weights = mix(1.0 - share, share, vec3(corner));
        vec4 light = volume_cell(volume_newest() * count + at);
        float weight = weights.x * weights.y * weights.z * light.w;
        sum.light += weight * light.rgb;
        sum.sun += weight * volume_cell(VELUM_LIGHT_VOLUME_SUN * count + at).rgb;
        sum.flux += weight * volume_cell(VELUM_LIGHT_VOLUME_FLUX * count + at).xyz;
        sum.transport_1_m += weight * light.w;
        whole += weight;
    }
    float share_1 = 1.0 / max(whole, 1.0e-12);
    return volume_light(sum.light * share_1, sum.sun * share_1, sum.flux * share_1, sum.transport_1_m * share_1);
}

/* The sun's beam at a place. */
struct volume_beam {
    vec3 sun;
    float cos_sun, first; /* phase function of one order */
    float depth;          /* on the way to the sun */
};

/* What droplets send on of the beam, however often it has been scattered on its way, less an even share for what has turned
 * and is the volume's: so the mean is that of what still goes on by the transport, and the higher moments fall as they do
 * along a straight way (Wang & Guth 1951). Orders of the wide lobe, each wider by those of the narrow one. Backwards it may
 * be less than nothing, by no more than the volume has too much. */
float volume_beam_sent(volume_beam beam) {
    const int orders = 24;
    const float wide = VELUM_DROPLET_20_WEIGHT;
    float once = velum_phase_draine(beam.cos_sun, VELUM_DROPLET_20_G_DRAINE, VELUM_DROPLET_20_ALPHA);
    float wide_g = velum_phase_draine_mean_cosine(VELUM_DROPLET_20_G_DRAINE, VELUM_DROPLET_20_ALPHA);
    float clear = exp(-beam.depth);
    float chance = exp(-wide * beam.depth); /* of so many wide orders */
    float narrow_orders = (1.0 - wide) * beam.depth;
    float any_orders = narrow_orders / max(1.0 - exp(-narrow_orders), 1.0e-6);
    float narrow = velum_phase_hg(beam.cos_sun, pow(VELUM_DROPLET_20_G_HG, 1.0 + any_orders));
    float sent = beam.first * clear + (chance - clear) * mix(narrow, once, wide);
    float rest = 1.0 - chance;
    float g = wide_g * pow(VELUM_DROPLET_20_G_HG, narrow_orders);
    for (int order = 1; order < orders; ++order) {
        chance *= wide * beam.depth / float(order);
        rest -= chance;
        g *= wide_g;
        float more = velum_phase_hg(beam.cos_sun, g);
        sent += chance * mix(once, more, wide);
        once = more;
    }
    float turned = 1.0 - exp(-(1.0 - study_g_water) * beam.depth);
    return sent + (max(rest, 0.0) - turned) * VELUM_INV_4PI;
}

/* `source`: our own light there, which holds beside the volume and where it has no cloud. */
vec3 volume_source(vec3 source, vec3 r, float height_m, vec3 direction, volume_beam beam) {
    vec3 place = volume_place(r, height_m);
    vec2 aside = min(place.xy, float(volume.grid.x) - place.xy) / volume_rim;
    float share = clamp(min(aside.x, aside.y), 0.0, 1.0);
    if (share <= 0.0) {
        return source;
    }
    volume_light cells = volume_light_at(place);
    if (cells.transport_1_m <= 0.0) {
        return source;
    }
    /* What a cell scatters once more within itself, where more or less of the sun's light comes to the place than to it. */
    float again = 1.0 - exp(-cells.transport_1_m * volume.east.w);
    float onward = exp(-(1.0 - study_g_water) * beam.depth);
    vec3 within = (beam.sun * (VELUM_INV_4PI * onward) - cells.sun) * again;
    /* What goes on forward still goes the way of the flux (Eddington's approximation). */
    float mean = max(dot(cells.light, VELUM_LUMINANCE_OF), 1.0e-6);
    float flows = 3.0 * study_g_water * dot(cells.flux, volume_east_north_up(-direction)) / mean;
    vec3 light = cells.light * max(1.0 + flows, 0.0) + within + beam.sun * volume_beam_sent(beam);
    return mix(source, max(light, vec3(0.0)), share);
}

#endif
