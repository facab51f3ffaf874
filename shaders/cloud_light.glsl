/* Light that cloud sends along a ray. */
#ifndef VELUM_CLOUD_LIGHT_GLSL
#define VELUM_CLOUD_LIGHT_GLSL

#include "air_light.glsl"
#include "cloud_hit.glsl"
#include "scattering.glsl"
#include "shared/shade.h"
#ifdef VELUM_STUDY
#include "light_volume_source.glsl"
#endif

/* What holds along a ray: its angle to the sun never changes. */
struct ray_phases {
    float water, ice; /* first order */
    float cos_sun;
    vec3 direction;
};

ray_phases ray_phases_of(vec3 direction) {
    float cos_sun = dot(direction, eye.sun.xyz);
    ray_phases phases;
    phases.direction = direction;
    phases.cos_sun = cos_sun;
    phases.water = velum_phase_cloud(cos_sun, false);
    phases.ice = velum_phase_cloud(cos_sun, true);
    return phases;
}

/* The way to the sun within a layer, and how far of it sun_way_of looks. */
float sun_way_m(velum_slot_fields f, float height_m, float mu_sun) {
    return (f.top_m - height_m) / max(mu_sun, 0.06);
}
/* Few steps see one tower, not a row of them: beyond, storms stand by chance. */
const float storm_reach = 0.48;
float sun_reach_m(int slot, velum_slot_fields f, float height_m, float mu_sun) {
    float thicknesses = slot == VELUM_SLOT_STORM ? storm_reach : 2.5;
    return min(sun_way_m(f, height_m, mu_sun), thicknesses * (f.top_m - f.base_m) + 1500.0);
}

float across_cloud_m(int slot) {
    return velum_cloud_share(slot) / eye.slots[slot].shape_0.w;
}

/* Of the sun's light: what other layers leave, beam and flux as one; and of that, on the mean, the beam that passes the
 * layer's own clouds farther off, and the flux that they let through otherwise or send down from their sides. */
struct sun_left {
    float others, open, turned;
};

/* Coverage of storms half way from where the sun's way is no longer looked at to where it leaves them: beside a storm, and
 * on its own lit side, there is less of it than here. */
float storms_ahead(cloud_hit hit, velum_slot_fields f, float seen_m, float mu_sun) {
    float way_m = max(sun_way_m(f, hit.height_m, mu_sun), 0.0);
    float to_m = 0.5 * (min(seen_m, way_m) + way_m);
    vec3 aside = eye.sun.xyz - hit.normal * mu_sun;
    tile_place there = tile_move(hit.tile, normalize(hit.normal + aside * (to_m / VELUM_WGS84_A_M)),
                                 max(length(hit.r + eye.sun.xyz * to_m), 1.0));
    return there.missing ? f.coverage : slot_coverage(there, VELUM_SLOT_STORM, there.uv);
}

sun_left sun_left_at(cloud_hit hit, float mu_sun) {
    sun_left left = sun_left(1.0, 1.0, 0.0);
    for (uint rest = hit.tile.mask; rest != 0u; rest &= rest - 1u) {
        int slot = findLSB(rest);
        bool own = slot == hit.slot;
        velum_slot_fields f = hit.fields;
        float seen_m = max(sun_reach_m(hit.slot, f, hit.height_m, mu_sun), 1.0);
        if (!own) {
            f = slot_fields(hit.tile, slot, true);
            seen_m = 0.0;
        }
        if (slot == VELUM_SLOT_STORM) {
            f.coverage = storms_ahead(hit, f, seen_m, mu_sun);
        }
        velum_layer_light light = velum_layer_light_at(slot, f, hit.height_m, mu_sun, seen_m, across_cloud_m(slot));
        left.others *= own ? 1.0 : light.open + light.through;
        left.open = own ? light.open : left.open;
        /* What falls from storms sees their walls (shaft_walls). */
        bool shaft = slot == VELUM_SLOT_STORM && is_fringe(hit);
        left.turned = own ? light.through + (shaft ? 0.0 : light.sides) : left.turned;
    }
    return left;
}

/* Half of what a column's rank changes by over a step of a period, on the mean. */
const float step_spread = 1.0;
/* Most of the sun's light has turned before it comes, by ways aside: for that, lumps of water count as blurred over so many
 * metres, and over so much of the way to them. Else one sees each cloud's edge as a line on the bases behind it. No wider
 * than so much of the noise's period, over which ranks are as different as they come. */
const float aside_m = 150.0, aside_share = 0.3, aside_most = 0.17;

/* Of water, and no storm's. */
bool is_lumps(cloud_hit hit) {
    return hit.slot < VELUM_SLOT_HIGH && hit.slot != VELUM_SLOT_STORM && !is_fringe(hit);
}

/* Over so much of the way to the sun, at most, it is known how straight it meets a face. */
const float face_m = 1000.0;
/* Over so much of it a place's own face is told, where steps are as short as that: nearer, lumps tell nothing. */
const float near_m = 40.0;

struct sun_way {
    float depth;    /* optical, of the slot's cloud */
    float turned;   /* the same as light meets it that has turned: blurred */
    float coverage; /* in the last step */
    /* How the margin falls, in e a metre, whatever the fine detail: as far as face_m, and over the first step, or as far as
     * near_m. */
    float falls_1_m, falls_near_1_m;
};

/* The margin of the sample with such a lump, whatever the fine detail. */
float margin_here(cloud_hit hit, float lump) {
    return velum_margin(hit.profile, hit.excess, hit.height_fraction, lump, 0.5);
}

/* The way from a place towards the sun: few steps, each longer than the one before; of the fields coverage is that of the
 * way, the others are those of the place. */
sun_way sun_way_of(cloud_hit hit, float mu_sun, int steps) {
    velum_slot_fields f = hit.fields;
    float thickness = max(f.top_m - f.base_m, 1.0);
    float ahead = sun_reach_m(hit.slot, f, hit.height_m, mu_sun);
    /* The first is short enough for the next lump's shadow, however deep the cloud. */
    const float first_m = 90.0;
    /* Of it, where it is looked at: the same from place to place, or shadows would be hatched. */
    const float first_share = 0.44;
    float count = float(max(steps, 2));
    float ratio = max(pow(max(ahead, 1.0) / (1.3 * first_m), 1.0 / (count - 1.0)), 1.4);
    float dt = max(ahead, 0.0) * (ratio - 1.0) / (pow(ratio, count) - 1.0);
    vec2 rate = face_rate(hit.tile, hit.normal, eye.sun.xyz) *
                (float(VELUM_TILE_TEXELS) / (float(VELUM_TILE_SIDE) * hit.tile.side_m));
    float spread_1_m = step_spread * eye.slots[hit.slot].shape_0.w / max(f.coverage, 0.1);
    float blurs = is_lumps(hit) ? 1.0 : 0.0;
    float most_m = aside_most / eye.slots[hit.slot].shape_0.w;
    sun_way way = sun_way(0.0, 0.0, f.coverage, 0.0, 0.0);
    float done = 0.0;
    float own_lump = STUDIED(study_sun_lumps() ? hit.lump : 0.0, hit.lump);
    float here = margin_here(hit, own_lump);
    for (int i = 0; i < steps; ++i) {
        float t = done + dt * (i == 0 ? first_share : 0.5);
        float h = hit.height_m + t * mu_sun;
        vec3 p = hit.r + eye.sun.xyz * t;
        float z = clamp((h - f.base_m) / thickness, 0.0, 1.0);
        way.coverage = slot_coverage(hit.tile, hit.slot, hit.tile.uv + rate * t);
        float e = velum_excess(hit.profile, way.coverage, column_rank(hit.slot, f, p, hit.normal, h));
        float lump = 0.0;
        if (STUDIED(study_sun_lumps(), true)) {
            lump = lump_noise(hit.slot, f, p);
        }
        float fine = STUDIED(study_sun_fine(hit.slot, f, p), 0.5);
        float aside = max(dt, min(dt + blurs * (aside_m * smoothstep(0.0, first_m, t) + aside_share * t), most_m));
        float inside_m = z > 0.0 && z < 1.0 ? dt : 0.0;
        way.depth += inside_m * velum_body_over(hit.profile, e, z, h - f.base_m, lump, fine, spread_1_m * dt);
        way.turned += inside_m * velum_body_over(hit.profile, e, z, h - f.base_m, lump, fine, spread_1_m * aside);
        float there = velum_margin(hit.profile, e, z, lump, 0.5);
        float falls_1_m = (here - there) / max(t, 1.0);
        /* Lengths of steps go by height alone: one that came or went at once would draw a line at a height. */
        float counts = i == 0 ? 1.0 : smoothstep(1.3 * face_m, 0.7 * face_m, t);
        way.falls_1_m = mix(way.falls_1_m, falls_1_m, counts);
        way.falls_near_1_m = i == 0 || t < near_m ? falls_1_m : way.falls_near_1_m;
        done += dt;
        dt *= ratio;
    }
    way.depth *= f.extinction_1_m;
    way.turned *= f.extinction_1_m;
    return way;
}

/* How the margin falls upwards, in e a metre, whatever the fine detail. */
float falls_up_1_m(cloud_hit hit, float up_m) {
    velum_slot_fields f = hit.fields;
    vec3 p = hit.r + hit.normal * up_m;
    float h = hit.height_m + up_m;
    float z = clamp((h - f.base_m) / max(f.top_m - f.base_m, 1.0), 0.0, 1.0);
    float e = velum_excess(hit.profile, f.coverage, column_rank(hit.slot, f, p, hit.normal, h));
    return (margin_here(hit, hit.lump) - velum_margin(hit.profile, e, z, lump_noise(hit.slot, f, p), 0.5)) / up_m;
}

/* What the eye gets of a uniform layer from a step, over what the step takes. */
velum_slab_light slab_light(cloud_hit hit, velum_slab_span span, float mu_sun) {
    velum_slot_fields f = hit.fields;
    bool at_point = STUDIED(study_at_point(), false);
    float first = clamp(velum_height_along(hit.at_h_m, hit.rise, span.from_m), f.base_m, f.top_m);
    float last = clamp(velum_height_along(hit.at_h_m, hit.rise, span.to_m), f.base_m, f.top_m);
    first = at_point ? hit.height_m : first;
    last = at_point ? hit.height_m : last;
    float to_sun = eye.slots[hit.slot].optics.z * f.extinction_1_m / max(mu_sun, 1e-3);
    return velum_slab_light_of(at_point ? 0.0 : f.extinction_1_m * span.inside_m, to_sun * (f.top_m - first),
                               to_sun * (f.top_m - last));
}

/* What cloud with noise scatters of light that has turned goes by two streams (Shettle & Weinman 1970), from every side
 * at once: of the ways out of a place - up, down, through the nearest flank, to the lit face - each lets as much pass as
 * 1 / (1 + turns depth), and the place shines by the mean of what stands at their ends, weighted (below_share): with
 * light alike all round it shines alike, but for sky_share. Fitted to the reference over the scenes of
 * tests/accuracy. */
const float turns = 0.0504; /* 3/2 (1 - g), and less for uneven cloud, which leaks (Cahalan et al. 1994) */
const float lit_depth = 1.02; /* of the lit face, over that along the sun */
const float dark_share = 1.45; /* of the ways out of the dark side for the sun's light: Eddington's is 1 */
const float deep_share = 0.895;
const float below_share = 1.29; /* of the base among the ways out */
/* Clouds of less cover than this stand alone: no light of others comes to their dark sides. */
const float alone_from = 0.437, alone_lit = 3.4;
/* On a side that is turned away from the sun, where the margin grows towards it over so much of the lumps' period, light
 * leaves by the flank too; layers higher up lie too flat for that. */
const float lee_share = 0.143;
/* Of the light from all round, over that of the half worlds above and below a layer: the air and the cloud at its own
 * heights shine too. An overcast has no gaps for that; of storms and what falls it is not known. */
const float sky_share = 1.11;
/* Diffuse light leaves a face steeply rather than along it; beneath, what goes on to the dark side falls, the more the
 * nearer that is. */
const float limb = 2.53, falls = 1.96;
/* Of what a lit wall sends to its neighbours by the sun; by the rest of the light walls shine as all else around. Those of
 * heaps stand upright to a low sun; what they send goes back from it, and less of it onward: towards an eye that looks so
 * far into the sun. */
const float wall_share = 0.85, wall_onward = 0.7;
/* Cosine at which the sun meets the faces of a deck without gaps. */
const float deck_face = 0.391, deck_tilt = 0.251;
/* Lumps that have closed to an overcast leak less than broken ones: `lit_depth` is so much more; of what has turned they
 * send so much, and the more the higher the sun. Fitted to stratocumulus from below, within and above, the sun 12 to 60
 * degrees high. */
const float overcast_lit = 1.5, overcast_deep = 1.12, overcast_tilt = 0.32;
/* Views that rise so much see bases, and no flanks. */
const float base_rise = 0.33;
/* How heaps are lit. */
struct heap_light {
    float face, low;              /* cosine at which the sun meets their faces on the mean; of a low sun so much less */
    float near, near_low;         /* more where a place's own face is turned to the sun; to a low one as much more */
    float near_share;             /* ... by the fall of the margin over so much of the lumps' period */
    float high_up;                /* less from base to top: tops are round and lose light, niches low down get theirs */
    float falls;                  /* see limb */
    float sky;                    /* as sky_share */
    float walls;                  /* as wall_share */
    float ends;                   /* so much nearer than by `turns` the base must be to hide the flank from a level eye */
    float onward;                 /* of `onward`, where there are gaps */
};
/* On the mean; walls of cumulus send on by it, too. */
const float lump_face = 0.6;
const heap_light lumps_light = heap_light(lump_face, 0.484,    /* face, low */
                                          0.252, 0.0, 0.0357,  /* near, near_low, near_share */
                                          0.0,                 /* high_up */
                                          falls,               /* falls */
                                          sky_share,           /* sky */
                                          wall_share,          /* walls */
                                          1.0,                 /* ends */
                                          1.0);                /* onward */
/* Cumulus stand upright: a low sun meets what is turned to it straight, and flanks see the horizon, the brightest of the
 * sky. Fitted to references of 0.1 to 0.45 of cover with the sun 5 to 65 degrees high before, beside and behind the eye, to
 * the scenes of tests/accuracy and to the genus in tests/report/genera. */
const heap_light cumulus_light = heap_light(0.605, 0.32,       /* face, low */
                                            0.05, 1.2, 0.055,  /* near, near_low, near_share */
                                            0.2,               /* high_up */
                                            1.7,               /* falls */
                                            1.22,              /* sky */
                                            0.66,              /* walls */
                                            3.5,               /* ends */
                                            0.0);              /* onward */
const float shaft_walls = 0.6; /* of what flanks see, at least, in rain */
const float shaft_turns = 0.236, shaft_lit = 0.864; /* as turns and lit_depth, in what falls from storms */
/* Luminance of what a layer's clouds farther off let through, over that of an even half world of as much flux: it lies on
 * their flanks, which a low sun meets straight. */
const float field_share = 2.12;
/* How a storm is lit. Fitted to the scene `thunderstorm` and references of cumulonimbus in a field. */
const float storm_walls = 1.12;  /* light of walls, which is the most that storms have */
/* What flanks see of them: the more in shade that falls on what is turned to the sun, among walls that it lights. */
const float storm_beside = 0.17, storm_niche = 0.35;
const float storm_turned = 0.38; /* light of faces, on the mean... */
const float storm_meets = 0.28;  /* ... and more where the sun meets them straight */
const float storm_full = 0.4;    /* of that, as much more where storms cover all */
const float storm_base = 0.14;   /* as below_share */
const float storm_faces = 0.14;  /* how far tops are met as a deck's faces are, and not as a plane */
const float storm_slope = 0.137; /* of the noise's period: over it the margin of a face at 45 degrees falls by 1 */
const float storm_turns = 0.58, storm_lit = 1.43, storm_dark = 1.6; /* as turns, lit_depth and dark_share */
/* A storm's lumps: what is turned up sees the sky, and what is turned down the ground and the shade: so much more and less
 * than a wall's mean; and by the sun what is turned to it. Asked over so many metres; the less, the slower the margin falls
 * (in the lumps' period), and the deeper within, in e, for there light comes from all sides. */
const float storm_up = 0.5, storm_up_mean = 0.3, storm_lumps = 0.25, storm_lumps_mean = 0.3;
const float storm_up_m = 100.0, storm_even = 2.0, storm_within = 0.25;
/* Cosine at which a level top is met by a high sun, at most. */
const float storm_top = 0.6;
const float storm_graze = 0.01; /* cosine at which a low sun meets what does not face it, at least */
const float sky_aside = 0.537;  /* how far aside, m a metre down, what is seen between storms is their walls */
/* Behind a lit face light still goes the way of the sun's; deep in, as much comes back. */
const float onward = 0.104;
/* How far the sun meets lumps on a closed sheet's top, on the mean, and not a plane: a low one straighter, a high one less
 * so; hardly where they stand in each other's shadow, and the less the more cloud lies above, which scatters light anew,
 * or the less below, which sends it back. Fitted to references of stratus, altostratus and nimbostratus from above. */
const float sheet_faces = 0.6, sheet_up = 4.0, sheet_down = 8.0;
const float faces_shadow = 0.2; /* cosine of the sun's zenith angle below which they do */
const float closed_from = 0.15, closed_at = 0.5; /* of velum_profile.close: nothing of a closed sheet, all of one */
const float flank_share = 0.0905; /* of the noise's period: from hem to heart of what light crosses */
/* Of the lumps, in the shape whose flank is looked for: crests stand before it, in the light, crevices lie behind. */
const float flank_lumps = 0.4;
const float onset = 0.0481; /* of light that has turned, by the depth of all of the cloud */
/* What keeps near the forward peak, wider by each order and so by the depth (Riley et al. 2004). Of ice, whose peak is
 * narrow, on the mean. */
struct widened_peak {
    float share, loss; /* ... of which the depth takes away */
    float g, fade;     /* mean cosine, and how it falls with the depth */
};
const widened_peak water_widened = widened_peak(0.69, 0.0854, 0.749, 0.0946);
const widened_peak ice_widened = widened_peak(0.63, 0.0927, 0.55, 0.0);

struct ways_out {
    float up, down, flank; /* optical depths */
    float reach;           /* height fraction at which the column ends */
};

/* Of a column's optical depth what lies below a height fraction. Ice has less: towers count as far as half way to it. */
float depth_below(velum_profile p, float z) {
    float towers = velum_water_below(p, min(z, 0.5 * (VELUM_ICE_LOW + VELUM_ICE_HIGH)));
    return mix(velum_water_below(p, z), towers, p.damp);
}

/* Height fraction at which a column of such an excess ends. */
float column_reach(velum_profile p, float excess) {
    return pow(clamp(excess / max(p.reach, 0.05), 0.0, 1.0), 1.0 / max(p.power, 0.1));
}

/* Light comes down to a place by columns so far around it as by its own (fitted to cumulus that stand alone). */
const float around_m = 120.0;
const int around_count = 3;
const vec2 around[around_count] = vec2[](vec2(1.0, 0.0), vec2(-0.5, 0.8660254), vec2(-0.5, -0.8660254));

/* Excess of a column of lumps with those around it, on the mean; of others their own. */
float excess_around(cloud_hit hit) {
    int count = is_lumps(hit) ? around_count : 0;
    /* At a pole nothing is to the east: there the column counts alone. */
    vec3 east = vec3(-hit.normal.y, hit.normal.x, 0.0) / max(length(hit.normal.xy), 1.0e-6);
    vec3 north = cross(hit.normal, east);
    float sum = max(hit.excess, 0.0);
    for (int i = 0; i < count; ++i) {
        vec3 r = hit.r + around_m * (around[i].x * east + around[i].y * north);
        float rank = column_rank(hit.slot, hit.fields, r, hit.normal, hit.height_m);
        sum += max(velum_excess(hit.profile, hit.fields.coverage, rank), 0.0);
    }
    return sum / float(1 + count);
}

ways_out ways_out_of(cloud_hit hit) {
    velum_slot_fields f = hit.fields;
    /* How high this column's cloud stands, and how much of it, and over it of those around it, lies below and above: as if
     * they stood upright. */
    float reach = column_reach(hit.profile, hit.excess);
    float thickness = max(f.top_m - f.base_m, 1.0);
    float inner = f.extinction_1_m * hit.profile.density_scale;
    float z = clamp((hit.height_m - f.base_m) / thickness, 0.0, 1.0);
    float below = depth_below(hit.profile, z);
    ways_out ways;
    ways.reach = reach;
    float reach_around = column_reach(hit.profile, excess_around(hit));
    ways.up = inner * thickness * max(depth_below(hit.profile, max(reach_around, 0.1)) - below, 0.0);
    ways.down = inner * thickness * below;
    float margin = margin_here(hit, flank_lumps * hit.lump);
    ways.flank = inner * max(margin, 0.0) * flank_share / eye.slots[hit.slot].shape_0.w;
    return ways;
}

/* Towers stand so deep that low between them their walls are seen; these shine by the sun as far as it comes down to them,
 * and otherwise as the sky that they hide. */
vec3 between_storms(cloud_hit hit, vec3 sky, vec3 wall, float mu_sun, float ahead) {
    velum_slot_fields f = hit.fields;
    float over_m = max(f.top_m - hit.height_m, 0.0);
    float down = over_m / max(f.top_m - f.base_m, 1.0);
    float cloud_m = across_cloud_m(hit.slot);
    float sun_aside_m = over_m * sqrt(max(1.0 - mu_sun * mu_sun, 0.0)) / max(mu_sun, 0.02);
    float seen = velum_free_lines(f.coverage, down, sky_aside * over_m, cloud_m);
    float lit = velum_free_lines(ahead, down, sun_aside_m, cloud_m);
    return sky + wall * (lit * (1.0 - seen));
}

/* Deep under a face that the sun meets at this cosine: Eddington's half-space. */
float deep_under(float face) {
    return deep_share * VELUM_INV_4PI * face * (2.0 + 3.0 * face);
}

/* Cosine at which the sun meets the faces of a deck. */
float deck_faces(float mu_sun) {
    return deck_face + deck_tilt * mu_sun;
}

/* How far such faces stand free of each other's shadow. */
float faces_free(float mu_sun) {
    return sqrt(clamp(mu_sun / faces_shadow, 0.0, 1.0));
}

/* Of the angle whose tangent this is. */
float sine_of(float slope) {
    return slope * inversesqrt(1.0 + slope * slope);
}

/* Cosines at which a face is turned to the sun and upwards, as the margin falls that way, e a metre; where it hardly falls
 * (`even_1_m`) there is no face. */
struct face_cosines {
    float sun, up;
};
face_cosines face_of(float falls_sun_1_m, float falls_up_1_m, float mu_sun, float even_1_m) {
    float level = max(1.0 - mu_sun * mu_sun, 0.02);
    float aside = falls_sun_1_m - mu_sun * falls_up_1_m;
    /* As much again across, on the mean. */
    float steep = inversesqrt(falls_up_1_m * falls_up_1_m + 1.5 * aside * aside / level + even_1_m * even_1_m);
    return face_cosines(falls_sun_1_m * steep, falls_up_1_m * steep);
}

/* How far a kind of cloud closes to a sheet, 0..1. Stratocumulus keeps its lumps. */
float sheet_share(velum_profile p) {
    return clamp((p.close - closed_from) / (closed_at - closed_from), 0.0, 1.0);
}

/* Per unit of scattering. `sun`: the beam; `field`: luminance of the layer's clouds farther off, by the sun. */
vec3 uneven_source(cloud_hit hit, ray_phases phases, ways_out ways, vec3 sun, vec3 field, float mu_sun, sun_way way) {
    float depth = way.depth;
    float whole = ways.up + ways.down + depth;
    /* What is thin and open shines by itself, where the sun comes to it, and else by the cloud over it. */
    whole = FRINGED(hit.across > 0.0 ? hit.across + ways.up * (1.0 - exp(-0.25 * depth)) : whole, whole);
    bool storm = hit.slot == VELUM_SLOT_STORM;
    bool heaps = !storm && !is_fringe(hit);
    bool towers = storm && !is_fringe(hit);
    heap_light heap = lumps_light;
    if (heaps && hit.slot == VELUM_SLOT_CUMULUS) {
        heap = cumulus_light;
    }
    float slows = towers ? storm_turns : storm ? shaft_turns : turns;
    float up = 1.0 / (1.0 + slows * ways.up);
    float down = 1.0 / (1.0 + slows * ways.down);
    float flank = 1.0 / (1.0 + slows * ways.flank);
    float alone = heaps ? max(1.0 - hit.fields.coverage / alone_from, 0.0) : 0.0;
    float over = velum_overcast(hit.fields.coverage);
    float closes = is_lumps(hit) ? over * (1.0 - sheet_share(hit.profile)) : 0.0;
    float slows_lit = slows * (towers ? storm_lit : storm ? shaft_lit : lit_depth * mix(1.0, overcast_lit, closes));
    float lit = 1.0 / (1.0 + slows_lit * way.turned * (1.0 + alone_lit * alone));
    /* Near a top or a base the flank is no other way; an overcast has none. */
    float aside = flank * (1.0 - over);
    float base_near = mix(down, 1.0 / (1.0 + heap.ends * slows * ways.down), 1.0 - clamp(hit.rise / base_rise, 0.0, 1.0));
    flank = max(flank - max(up, base_near), 0.0) * (storm ? 1.0 : 1.0 - over);

    bool ice = hit.slot == VELUM_SLOT_HIGH;
    float first = (ice ? phases.ice : phases.water) * exp(-depth);
    widened_peak peak = water_widened;
    if (ice) {
        peak = ice_widened;
    }
    float peak_phase = velum_phase_hg(phases.cos_sun, peak.g * exp(-peak.fade * way.turned));
    float widened = peak.share * exp(-peak.loss * way.turned) * peak_phase * (1.0 - exp(-0.25 * whole));
    /* Lumps have faces turned to any sun. */
    float wall = storm ? min(storm_walls * sqrt(max(1.0 - mu_sun * mu_sun, 0.0)), 1.0) : 0.0;
    float low = 1.0 - clamp(mu_sun, 0.0, 1.0);
    float low4 = low * low * low * low;
    float face = max(mix(heap.face - heap.low * low4, deck_faces(mu_sun), over * over), wall);
    float even = deep_under(face);
    float deep = even;
    float opens_up = 1.0;
    float walls_seen = storm ? max(hit.fields.coverage, shaft_walls) : hit.fields.coverage;
    if (heaps) {
        float slope = way.falls_near_1_m * heap.near_share / eye.slots[hit.slot].lump_0.w;
        float near = sine_of(slope) * lit * (1.0 - over);
        near *= heap.near + heap.near_low * low * low * faces_free(mu_sun);
        deep = deep_under(clamp(face + near, 0.0, 1.0));
        deep *= 1.0 + heap.high_up * (0.5 - hit.height_fraction) * (1.0 - over);
        deep *= mix(1.0, overcast_deep + overcast_tilt * max(mu_sun, 0.0), closes);
    } else if (towers) {
        /* Anvils lie flat; towers stand upright where the margin falls towards the sun. */
        float straight = way.falls_1_m * storm_slope / eye.slots[hit.slot].shape_0.w;
        float meets = max(sine_of(straight), 0.0);
        float level = mix(clamp(mu_sun, storm_graze, storm_top), deck_faces(mu_sun), storm_faces * faces_free(mu_sun));
        float upright = 1.0 - velum_anvil(hit.height_fraction);
        float met = mix(level, face, meets * upright);
        deep = deep_under(met) * (storm_turned + storm_meets * meets) * (1.0 + storm_full * over);
        float relief = upright * exp(-max(hit.margin, 0.0) / storm_within);
        face_cosines turned_to = face_of(way.falls_near_1_m, falls_up_1_m(hit, storm_up_m), mu_sun,
                                         storm_even * eye.slots[hit.slot].lump_0.w);
        deep *= 1.0 + storm_lumps * (turned_to.sun - storm_lumps_mean) * relief;
        opens_up += storm_up * (turned_to.up - storm_up_mean) * relief;
        walls_seen = storm_beside + storm_niche * meets * (1.0 - lit);
    }
    float dark = down + max(flank - lit, 0.0);
    if (heaps) {
        float slope = way.falls_1_m * lee_share / eye.slots[hit.slot].lump_0.w;
        float lee = 0.5 - 0.5 * sine_of(slope);
        bool flat_layer = hit.slot == VELUM_SLOT_MIDDLE || hit.slot == VELUM_SLOT_HIGH;
        dark = flat_layer ? dark : down + aside * lee;
    }
    float turned = 1.0 - exp(-onset * whole);
    float falling = mix(heap.falls, falls, over);
    float steep = max(1.0 + turned * hit.rise * (falling * sqrt(down) - limb * up), 0.0);
    float diffuse = lit / (lit + (towers ? storm_dark : dark_share) * dark) * turned * steep;
    diffuse *= 1.0 + onward * mix(heap.onward, 1.0, over) * phases.cos_sun * (2.0 * lit - 1.0);
    vec3 above = ambient_over(hit.fields.top_m, false);
    vec3 below = ambient_under(hit.fields.base_m, false);
    if (storm) {
        above = between_storms(hit, above, storm_walls * even * sun, mu_sun, way.coverage);
    }
    vec3 open = 0.5 * (above + below) + field;
    above += field;
    float wall_light = even;
    if (hit.slot == VELUM_SLOT_CUMULUS) {
        float upright = deep_under(mix(lump_face, face, over * over));
        wall_light = mix(upright, even, wall_onward * max(phases.cos_sun, 0.0));
    }
    vec3 beside = open + walls_seen * (storm ? storm_walls : heap.walls) * wall_light * sun;
    down *= towers ? storm_base : below_share;
    vec3 all_round = (above * up + below * down + beside * flank) / (up + down + flank);
    float sky = heaps ? mix(heap.sky, 1.0, over) : opens_up;
    return sun * (first + widened + deep * diffuse) + sky * all_round;
}

/* How far a place is one of a closed sheet, 0..1: where a kind of cloud that closes covers all. */
float closed_share(cloud_hit hit) {
    float over = velum_overcast(hit.fields.coverage);
    return over * over * sheet_share(hit.profile);
}

/* What the softness of a column's top leaves of what stands over a place. */
float soft_share(cloud_hit hit, ways_out ways) {
    float z = hit.height_fraction;
    float whole = velum_margin(hit.profile, hit.excess, z, hit.lump, VELUM_FINE_NONE);
    float softness = velum_softness(hit.profile, hit.excess, whole, velum_thinned(hit.profile, z));
    /* From the top down, in lengths over which the boundary (a smoothstep) grows whole. */
    float lengths = max(ways.reach - z, 0.0) * hit.profile.power * max(hit.excess, 0.0);
    lengths /= max(softness * ways.reach, 1.0e-4);
    return lengths < 1.0 ? lengths * lengths * (1.0 - 0.5 * lengths) : 1.0 - 0.5 / lengths;
}

/* Cosine at which the sun meets a closed sheet where so much of it lies above and below: that of a plane, or, of its lumps
 * near by, of a deck's faces. */
float sheet_face(float mu_sun, float up, float down) {
    float near = exp(-up / sheet_up) * (1.0 - exp(-down / sheet_down));
    return mix(mu_sun, deck_faces(mu_sun), sheet_faces * faces_free(mu_sun) * near);
}

/* The same by a table (shared/scattering.h): of a uniform layer, what it is made for, or of cloud that has closed.
 * `place_m`: how far beyond the sample the light of a uniform layer comes from. */
vec3 table_source(cloud_hit hit, ray_phases phases, ways_out ways, vec3 sun, float mu_sun, float depth,
                  inout float place_m) {
    velum_slot_fields f = hit.fields;
    bool uniform_layer = hit.slot >= VELUM_SLOT_UNIFORM;
    bool ice = hit.slot == VELUM_SLOT_HIGH;
    vec4 optics = eye.slots[hit.slot].optics;
    velum_phase_lobes lobes = velum_phase_lobes_cloud(ice);
    float g = uniform_layer ? optics.y : lobes.g_first;
    float second = uniform_layer ? 0.0 : lobes.weight_second;
    float albedo = uniform_layer ? optics.x : 1.0;
    int which = uniform_layer ? hit.slot - VELUM_SLOT_UNIFORM : ice ? VELUM_SCATTERING_ICE : VELUM_SCATTERING_WATER;
    /* Of what meets a drop, straight on; all of it is the first lobe's. */
    float straight = uniform_layer ? 1.0 - optics.z : ice ? VELUM_SCATTERING_ICE_PEAK : VELUM_SCATTERING_WATER_PEAK;
    float peak = straight / max(albedo * (1.0 - second), 1e-6);
    float rest_g = uniform_layer ? velum_scattering_rest(g, peak)
                   : ice         ? VELUM_SCATTERING_ICE_REST
                                 : VELUM_SCATTERING_WATER_REST;
    float wide = velum_phase_draine(phases.cos_sun, lobes.g_second, lobes.alpha_second);
    velum_slab_span span = slab_span(hit);
    velum_slab_light light = slab_light(hit, span, mu_sun);
    /* Beyond what sun_way_of has seen, the sheet goes on as it was. */
    depth *= max(sun_way_m(f, hit.height_m, mu_sun) / max(sun_reach_m(hit.slot, f, hit.height_m, mu_sun), 1.0), 1.0);
    light.direct = uniform_layer ? light.direct : exp(-(1.0 - straight) * depth);
    float inside = f.extinction_1_m * span.inside_m;
    vec3 above = ambient_over(f.top_m, true);
    vec3 below = ambient_under(f.base_m, true);
    float up = ways.up * soft_share(hit, ways);
    float whole = up + ways.down;
    /* Beneath a top what lies towards the sun counts; deep below it light comes from all of the column. */
    float column = sqrt(up / max(whole, 1.0e-6));
    float face = uniform_layer ? mu_sun : sheet_face(mu_sun, up, ways.down);
    float toward = mix(min(depth * max(face, 0.0), whole), up, column);
    vec3 source = vec3(0.0);
    /* Two points of Gauss and Legendre over the light that a step through a uniform layer takes. */
    int points = uniform_layer ? 2 : 1;
    for (int i = 0; i < points; ++i) {
        float share = velum_slab_share(inside, i == 0 ? 0.21132487 : 0.78867513);
        float h = velum_height_along(hit.at_h_m, hit.rise, mix(span.from_m, span.to_m, share));
        h = STUDIED(study_at_point() ? hit.height_m : h, h);
        float over = uniform_layer ? f.extinction_1_m * max(f.top_m - h, 0.0) : toward;
        float under = uniform_layer ? f.extinction_1_m * max(h - f.base_m, 0.0) : mix(whole - toward, ways.down, column);
        float along = uniform_layer ? over / max(mu_sun, 1e-3) : depth;
        vec2 sky = scattered_sky(which, uniform_layer ? over : up, uniform_layer ? under : ways.down, -hit.rise);
        float narrow = velum_scattering_first(phases.cos_sun, g, peak, straight * along);
        float first = mix(narrow, wide, second) * albedo * light.direct;
        float later = scattered_sun(which, scattering_rest(rest_g, 1.0 - straight), over, under, face, -hit.rise,
                                    phases.cos_sun);
        source += sun * (first + later) + above * sky.x + below * sky.y;
    }
    float seen_m = mix(span.from_m, span.to_m, light.place);
    place_m = uniform_layer ? STUDIED(study_at_point() ? place_m : seen_m, seen_m) : place_m;
    return source / float(points);
}

/* Light scattered towards the eye by cloud, per unit of scattering: luminance per 1/m. `place_m`: how far beyond the
 * sample it comes from, if that is known better. */
vec3 cloud_source(cloud_hit hit, ray_phases phases, int steps, inout float place_m) {
    float mu_sun = dot(hit.normal, eye.sun.xyz);
    bool uniform_layer = hit.slot >= VELUM_SLOT_UNIFORM;
    float closed = velum_closes ? (uniform_layer ? 1.0 : closed_share(hit)) : 0.0;
#ifdef VELUM_FRINGED
    /* What falls gets its light by the column that stands over it, not by the one that it left. */
    if (hit.part >= VELUM_PART_FALL) {
        float rank = column_rank(hit.slot, hit.fields, hit.r, hit.normal, hit.at_h_m);
        hit.excess = velum_excess(hit.profile, hit.fields.coverage, rank);
    }
#endif
    sun_way way = sun_way_of(hit, mu_sun, steps);
    sun_left left = sun_left_at(hit, mu_sun);
    vec3 sun = eye.sun_lx.rgb * sun_through_air(hit.height_m, mu_sun) * left.others;
    vec3 field = sun * (max(mu_sun, 0.0) / PI * field_share * left.turned);
    way.depth = STUDIED(study_sun_depth(hit.r, way.depth), way.depth);
    way.turned = STUDIED(study_sun_depth(hit.r, way.turned), way.turned);
    ways_out ways = ways_out_of(hit);
    vec3 source = uneven_source(hit, phases, ways, sun * left.open, field, mu_sun, way);
#ifdef VELUM_STUDY
    if (study_volume() && volume_holds(hit.slot) && !is_fringe(hit)) {
        volume_beam beam = volume_beam(sun * left.open, phases.cos_sun, phases.water, way.depth);
        source = volume_source(source, hit.r, hit.height_m, phases.direction, beam);
    }
#endif
    if (velum_closes && closed > 0.0) {
        vec3 tabled = table_source(hit, phases, ways, sun, mu_sun, way.depth, place_m);
        source = uniform_layer ? tabled : mix(source, tabled, closed);
    }
#ifdef VELUM_STUDY
    if (study_octaves()) {
        velum_slot_fields f = hit.fields;
        float g = eye.slots[hit.slot].optics.y;
        bool ice = hit.slot == VELUM_SLOT_HIGH;
        study_light theirs;
        theirs.sun = sun * mix(left.open, 1.0, closed);
        theirs.above = uniform_layer ? vec3(0.0) : ambient_over(f.top_m, false) + field * (1.0 - closed);
        theirs.below = uniform_layer ? vec3(0.0) : ambient_under(f.base_m, false);
        theirs.cos_sun = phases.cos_sun;
        theirs.g = uniform_layer ? g : ice ? study_g_ice : study_g_water;
        theirs.first = uniform_layer ? velum_phase_hg(phases.cos_sun, g) : ice ? phases.ice : phases.water;
        theirs.depth = uniform_layer ? f.extinction_1_m * max(f.top_m - hit.height_m, 0.0) / max(mu_sun, 1e-3) : way.depth;
        theirs.depth_above = min(ways.up, ways.flank);
        theirs.depth_below = min(ways.down, ways.flank);
        source = study_octave_source(theirs) * (uniform_layer ? eye.slots[hit.slot].optics.x : 1.0);
    }
#endif
    return source;
}

#endif
