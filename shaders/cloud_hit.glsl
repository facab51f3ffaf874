/* Cloud at a place along a ray: what is there, and how dense. */
#ifndef VELUM_CLOUD_HIT_GLSL
#define VELUM_CLOUD_HIT_GLSL

#include "fringe.glsl"
#include "shared/slab.h"
#include "study.glsl"
#include "weather.glsl"

/* Whether some cloud in sight may be a closed sheet or a uniform layer. The plain pipeline does not pay for their tables.
 */
layout(constant_id = 4) const bool velum_closes = true;

/* Cloud of a slot at a point. */
struct cloud_hit {
    int slot;
    int part; /* the slot, or VELUM_PART_* of it */
    velum_slot_fields fields;
    velum_profile profile;
    float excess; /* of its column; of what falls, of the one that it left */
    float margin; /* velum_margin */
    float lump;   /* its noise, -1..1 */
    float across; /* optical depth of a hem or of what falls, from side to side; of cloud 0 */
    float extinction_1_m;
    float height_fraction; /* of the layer */
    vec2 span_m;           /* heights between which there is something */
#ifdef VELUM_FRINGED
    velum_fringe fringe;
#endif
    bool within, covered;  /* the layer; a cloud's column, in it */
    bool sampled;          /* anything was asked for its density */
    bool smooth_part;      /* no noise that a long step would miss: rain, a transition band */
    vec3 r;
    vec3 normal;
    float height_m; /* of the light's place */
    float at_h_m, rise;       /* of the sample: height; metres that the ray gains a metre */
    float before_m, after_m; /* of the step, about the sample */
    tile_place tile;
};

velum_slab_span slab_span(cloud_hit hit) {
    return velum_slab_within(hit.at_h_m, hit.rise, hit.fields.base_m, hit.fields.top_m, hit.before_m, hit.after_m);
}

bool is_fringe(cloud_hit hit) {
    return FRINGED(hit.part >= VELUM_PART_HEM, false);
}

/* The cloud over a shaft is far and uneven: few steps would draw its shadows as steps. */
const int fringe_sun_steps = 2;

/* Fields, fringe and span where part, slot and tile are known; `some` false: nothing is there, coverage 0. */
void cloud_fields(inout cloud_hit hit, bool some) {
    hit.fields = slot_fields(hit.tile, hit.slot, some);
    hit.span_m = vec2(hit.fields.base_m, hit.fields.top_m);
#ifdef VELUM_FRINGED
    if (some && hit.part >= VELUM_PART_HEM) {
        hit.fringe = slot_fringe(hit.tile, hit.slot);
        hit.span_m = part_span(hit.part, hit.fields, hit.fringe);
    }
#endif
}

/* Extinction where slot, fields, profile, span, place, tile and step are known. `looking` false: nothing is there;
 * `base`: the shape without lumps and detail. */
void cloud_look(inout cloud_hit hit, bool looking, float distance_m, bool base) {
    int slot = hit.slot;
    velum_slot_fields f = hit.fields;
    bool uniform_layer = slot >= VELUM_SLOT_UNIFORM;
    float over_m = hit.at_h_m - f.base_m;
    float z = over_m / max(f.top_m - f.base_m, 1.0);
    bool fringe = is_fringe(hit);
    bool within = looking && z > 0.0 && z < 1.0 && f.coverage > 0.0 && !fringe;
    velum_profile profile = hit.profile;
    /* Cloud and its fringe have their noise from the same look-ups: software devices run all sides of branches. */
    vec4 from = vec4(hit.r, hit.at_h_m);
    bool in_fringe = false, has_lumps = false;
#ifdef VELUM_FRINGED
    in_fringe = fringe && f.coverage > 0.0 && hit.at_h_m > hit.span_m.x && hit.at_h_m < hit.span_m.y;
    from = fringe ? noise_from(hit.part, f, hit.fringe, hit.r, hit.normal, hit.at_h_m) : from;
    has_lumps = in_fringe && fringe_has_lumps(hit.part, hit.fringe);
#endif
    float e = velum_excess(profile, f.coverage, column_rank(slot, f, from.xyz, hit.normal, from.w));
    z = clamp(z, 0.0, 1.0);
    bool covered = within && e > velum_threshold(profile, z);
    has_lumps = has_lumps || (covered && !base);
    float lumps = 0.5;
    float fine = base && !fringe ? 1.0 : 0.5;
    if (has_lumps) {
        lumps = FRINGED(part_lumps(hit.part, f, from.xyz), slot_lumps(slot, f, from.xyz));
    }
    if (has_lumps && shows_fine(slot, distance_m)) {
        fine = fine_noise(slot, f, from.xyz);
    }
    float lump = base ? 1.0 : fringe ? 0.0 : 2.0 * lumps - 1.0;
    hit.excess = e;
    hit.lump = lump;
    hit.margin = velum_margin(profile, e, z, lump, fine);
    hit.height_fraction = z;
    hit.within = within;
    hit.covered = covered;
    hit.height_m = uniform_layer ? clamp(hit.at_h_m, f.base_m, f.top_m) : hit.at_h_m;
    float body = velum_body(profile, e, z, over_m, lump, fine);
    hit.extinction_1_m = covered && !uniform_layer ? f.extinction_1_m * body : 0.0;
#ifdef VELUM_STUDY
    hit.extinction_1_m = study_thinned(hit.extinction_1_m, f.extinction_1_m);
#endif
    hit.sampled = within;
    hit.across = 0.0;
    hit.smooth_part = false;
#ifdef VELUM_FRINGED
    if (fringe && f.coverage > 0.0) {
        hit.sampled = in_fringe;
        hit.smooth_part = hit.part >= VELUM_PART_FALL || hit.fringe.scud <= 0.0;
        float own = fringe_extinction(hit.part, f, profile, hit.fringe, e, hit.at_h_m, lumps, fine);
        hit.extinction_1_m = in_fringe ? own : 0.0;
        hit.margin = 0.0;
        hit.across = hit.extinction_1_m * part_across_m(hit.part);
    }
#endif
    /* Sharp faces: the share of the step that lies within them. */
    if (velum_closes && uniform_layer && !fringe && looking && f.coverage >= 0.5) {
        hit.extinction_1_m = f.extinction_1_m * slab_span(hit).inside_m / (hit.before_m + hit.after_m);
    }
}

#endif
