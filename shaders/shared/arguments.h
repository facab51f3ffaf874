/* Blocks and bindings that C and GLSL share. Vectors of four alone, so that std140 has no say: offsets are those of C.
 */
#ifndef VELUM_ARGUMENTS_H
#define VELUM_ARGUMENTS_H

#include "slots.h"

#define VELUM_SHADE_LEVELS 32 /* see shade.h */

#ifdef VULKAN
#define VELUM_VEC4(name) vec4 name
#define VELUM_UVEC4(name) uvec4 name
#define VELUM_VEC4S(name, count) vec4 name[count]
#else
#define VELUM_VEC4(name) float name[4]
#define VELUM_UVEC4(name) uint32_t name[4]
#define VELUM_VEC4S(name, count) float name[count][4]
#endif

/* Noise and bounds of a slot, as seen from the eye. Phases are noise coordinates of the eye (rotated ECEF position over
 * the period, plus the offsets of seed and drift cycle), modulo 1, formed in double; w is 1 / period, 1/m. Phases 0
 * and 1 belong to the two drift phases; lumps and fine detail of phase 1 use the phases of phase 0 plus cycle_offset.
 */
VELUM_STRUCT(velum_slot_block) {
    VELUM_VEC4(shape_0);
    VELUM_VEC4(shape_1);
    VELUM_VEC4(lump_0);
    VELUM_VEC4(lump_1);
    VELUM_VEC4(fine_0);
    VELUM_VEC4(fine_1);
    VELUM_VEC4(bounds); /* lowest base, highest top (HAE m) among the tiles of the table; stretch of the shape; of the
                           reference alone: greatest extinction */
    VELUM_VEC4(optics); /* uniform slots: albedo, Henyey-Greenstein g, share of the extinction by which the sun's
                           light falls off (shared/scattering.h); else 1, 0, 0; stretch of
                           fine detail */
    /* velum_profile in its order, and two unused, where all that the eye has of the slot has the same. */
    VELUM_VEC4(profile_0);
    VELUM_VEC4(profile_1);
    VELUM_VEC4(profile_2);
    VELUM_VEC4(profile_3);
};

/* An eye in a frame. */
VELUM_STRUCT(velum_eye_block) {
    VELUM_VEC4(scaled);   /* velum_eye_geometry: unit scaled position; |s| m */
    VELUM_VEC4(position); /* ECEF m; |s|^2 - a^2 m2 */
    VELUM_VEC4(up);       /* geodetic normal; height HAE m */
    VELUM_UVEC4(table); /* words before the eye's table in the table buffer; entries - 1; mask of slots with cloud; of their fringes
                           (VELUM_PART_*) */
    VELUM_VEC4(weather); /* detail of tiles; blend of states 0..1; displacement times tau 0, tau 1 of drift, s */
    VELUM_VEC4(drift);   /* weight of drift phase 1, 0..1; fog extinction at the surface 1/m; fog top HAE m; haze
                            extinction 1/m that visibility at the surface adds to clean air (0: none) */
    VELUM_VEC4(sun);     /* unit, ECEF, towards; cosine of the angular radius */
    VELUM_VEC4(sun_lx);  /* at the top of the atmosphere; angular radius rad */
    VELUM_VEC4(ground);  /* albedo; 1: air, 0: none */
    VELUM_VEC4(span); /* lowest base, highest top HAE m over all slots; surface elevation HAE m; greatest distance m */
    VELUM_VEC4S(shades, VELUM_SHADE_LEVELS); /* velum_shade: mean light of clouds over the eye's place, by height */
    velum_slot_block slots[VELUM_SLOT_COUNT];
    VELUM_VEC4S(fringes, VELUM_FRINGE_PARTS); /* by part, from VELUM_PART_HEM on: lowest, highest (HAE m), greatest
                                                 extinction (1/m) among the tiles of the table; 0 */
};

#define VELUM_VIEW_BLOCK_CUT 1u
#define VELUM_VIEW_BLOCK_ORTHOGRAPHIC 2u
#define VELUM_VIEW_BLOCK_GROUND 4u
#define VELUM_VIEW_BLOCK_SUN_DISC 8u
#define VELUM_VIEW_BLOCK_DEPTH 16u /* a depth image is bound */
#define VELUM_VIEW_BLOCK_SETTLE                                                                                        \
    32u /* what history holds is shown until a pixel has a ray of its own, and then forgotten */
#define VELUM_VIEW_BLOCK_FINER 64u /* some blocks have four rays: finer.comp */

/* A view in a frame. Offsets are from the eye of this frame, m. */
VELUM_STRUCT(velum_view_block) {
    VELUM_VEC4(right);        /* w: tan_left */
    VELUM_VEC4(up);           /* w: tan_right */
    VELUM_VEC4(forward);      /* w: tan_bottom */
    VELUM_VEC4(offset);       /* w: tan_top */
    VELUM_VEC4(before_right); /* the frame before, its offset too from the eye of this frame */
    VELUM_VEC4(before_up);
    VELUM_VEC4(before_forward);
    VELUM_VEC4(before_offset);
    VELUM_VEC4(
        scale); /* luminance scale; jitter x, y in pixels; samples that history counts for at most */
    VELUM_VEC4(depth);       /* convention, near m, far m; greatest number that the images can hold */
    VELUM_UVEC4(size);       /* width, height, x, y of the sub-rectangle */
    VELUM_UVEC4(march_size); /* width, height of the march images; rays' block width (1 to 8); frames since reset */
    VELUM_UVEC4(frame);      /* pixel of the block this frame (its index); VELUM_VIEW_BLOCK_*; array layer; seed */
    VELUM_VEC4(march);       /* step m (the first few are shorter), growth, distance m, sample offset 0..1 of this frame */
    VELUM_UVEC4(steps);      /* along the ray at most, towards the sun, octaves; rays' block height */
    /* Pixel of a block that has the ray: x, y; 1: x alternates from row to row of blocks; frames in which a calm tile has
     * rays once, 0: all tiles have rays. */
    VELUM_UVEC4(turn);
    VELUM_VEC4(room);        /* width, height of the march images; of history */
    VELUM_UVEC4(study);      /* velum_plan: flags, integrator, scattering, sun_depth */
    VELUM_VEC4(before_jitter); /* of the frame before: x, y in pixels; of 64 blocks, how many may be finer; samples shown */
    VELUM_VEC4(study_limits); /* long steps over the ordinary ones, 0: all alike; thin_density; exit_transmittance; 0 */
    /* How far cloud at the levels of shade.h over the eye has drifted since the time that history shows, m. */
    VELUM_VEC4S(drifts, VELUM_SHADE_LEVELS);
};

/* As VELUM_PLAN_*, VELUM_INTEGRATOR_*, VELUM_SCATTERING_* and VELUM_SUN_DEPTH_* of engine.h. */
#define VELUM_STUDY_STEP_THROUGH 1u
#define VELUM_STUDY_BASE_SEARCH 2u
#define VELUM_STUDY_LIGHT_ALL 4u
#define VELUM_STUDY_BEFORE 1u
#define VELUM_STUDY_AFTER 2u
#define VELUM_STUDY_TRAPEZOID 3u
#define VELUM_STUDY_OCTAVES 1u
#define VELUM_STUDY_VOLUME 2u
#define VELUM_STUDY_SUN_COARSE 1u
#define VELUM_STUDY_SUN_FINE 2u
#define VELUM_STUDY_SUN_MAP 3u

/* A level of a shadow map. */
VELUM_STRUCT(velum_shadow_level_block) {
    VELUM_VEC4(axis_u); /* w: texel m */
    VELUM_VEC4(axis_v); /* w: texels a side */
    VELUM_VEC4(origin); /* corner of texel (0, 0) on the plane through it, from the eye's block position, m; w: level */
    VELUM_UVEC4(window); /* first column, first row, columns, rows of this dispatch */
};

/* Set 0: the engine and the eye. */
#define VELUM_BIND_EYE 0     /* uniform velum_eye_block, dynamic offset */
#define VELUM_BIND_TABLE 1   /* storage, words: page tables */
#define VELUM_BIND_TILES_A 2 /* sampler2DArray */
#define VELUM_BIND_TILES_B 3
#define VELUM_BIND_SHAPE 4   /* sampler3D, R16 128^3, repeating, linear */
#define VELUM_BIND_DETAIL 5  /* sampler3D, R16 64^3 */
#define VELUM_BIND_AIR 6     /* sampler2D: transmittance to space, VELUM_AIR_W x VELUM_AIR_H, RGBA16F */
#define VELUM_BIND_AIR_OUT 7 /* the same as storage image */
#define VELUM_BIND_SKY 8     /* sampler2D: sky of the eye, VELUM_SKY_COLUMNS x VELUM_SKY_H, RGBA16F */
#define VELUM_BIND_SKY_OUT 9
#define VELUM_BIND_GLOW 10 /* sampler2D: all orders of air, VELUM_GLOW_SIDE^2, RGBA16F */
#define VELUM_BIND_GLOW_OUT 11
#define VELUM_BIND_SHADOW 12 /* sampler2DArray: the engine's newest shadow map, or a white texel */
#define VELUM_BIND_SHADOW_BLOCK                                                                                        \
    13 /* uniform velum_shadow_block (engine.h), origin relative to the eye in axis rows' dot */
#define VELUM_BIND_SCATTERING 14 /* sampler3D: shared/scattering.h, RGBA16F */
#define VELUM_BIND_SPANS 15 /* storage, words: VELUM_SPAN_WORDS of each page */
#define VELUM_BIND_COUNT 16

/* Set 1: the view. */
#define VELUM_BIND_VIEW 0           /* uniform velum_view_block, dynamic offset */
#define VELUM_BIND_MARCH_LIGHT 1    /* storage image RGBA16F: luminance (unscaled / VELUM_LUMINANCE_UNIT), T */
#define VELUM_BIND_MARCH_DISTANCE 2 /* storage image R32F */
#define VELUM_BIND_MARCH_LIGHT_IN 3 /* sampler2D of the same */
#define VELUM_BIND_MARCH_DISTANCE_IN 4
#define VELUM_BIND_HISTORY_IN 5      /* sampler2D RGBA16F: luminance, T of cloud */
#define VELUM_BIND_HISTORY_DATA_IN 6 /* sampler2D RG16F: distance / 100 m, number of samples */
#define VELUM_BIND_HISTORY_OUT 7     /* storage images of the same: other ones, or the very same where history is kept */
#define VELUM_BIND_HISTORY_DATA_OUT 8
#define VELUM_BIND_OUT_LUMINANCE 9 /* storage images, format of the host; written without format */
#define VELUM_BIND_OUT_TRANSMITTANCE 10
#define VELUM_BIND_OUT_DISTANCE 11 /* R32F, or a dummy */
#define VELUM_BIND_DEPTH 12        /* sampler2D, or a dummy */
#define VELUM_BIND_COUNTERS 13     /* storage: uint rays, samples, light samples, missing tiles */
#define VELUM_BIND_REFERENCE_COUNT 14
#define VELUM_BIND_LIT 14      /* storage: two dispatches and three counts, then places of rays that get light (lit.glsl) */
#define VELUM_BIND_LIT_LIST 15 /* storage: uint, those of them that there are; finer blocks; rays that are due (due.glsl) */
#define VELUM_BIND_RAYS 16     /* storage: of each ray and tile of rays, what view.glsl says */
#define VELUM_BIND_LIGHT_VOLUME 17 /* storage: shared/light_volume.h, or a dummy */
#define VELUM_BIND_LIT_TEXELS 18 /* samplerBuffer RGBA16F: VELUM_BIND_LIT, of which the reader knows what are halves */
#define VELUM_BIND_RAYS_TEXELS 19 /* usamplerBuffer RG32UI: VELUM_BIND_RAYS */
#define VELUM_BIND_LIGHT_VOLUME_TEXELS 20 /* samplerBuffer RGBA32F: VELUM_BIND_LIGHT_VOLUME, or a dummy */
#define VELUM_BIND_VIEW_COUNT 21

/* Set 1 of the shadow pass. */
#define VELUM_BIND_SHADOW_LEVEL 0 /* uniform velum_shadow_level_block, dynamic offset */
#define VELUM_BIND_SHADOW_OUT 1   /* storage image 2D array R16F: transmittance */

#define VELUM_AIR_W 256
#define VELUM_AIR_H 64
#define VELUM_SKY_W 192
#define VELUM_SKY_SHARES 64
#define VELUM_SKY_COLUMNS (VELUM_SKY_W + 2 + VELUM_SKY_SHARES)
#define VELUM_SKY_H 108
#define VELUM_GLOW_SIDE 32

/* Luminance of linear Rec. 709 primaries (ITU-R BT.709), in GLSL. */
#define VELUM_LUMINANCE_OF vec3(0.2126, 0.7152, 0.0722)

/* March images and history hold luminance over this, so that half floats do not overflow: cd/m2. */
#define VELUM_LUMINANCE_UNIT 16.0f

/* Work groups. */
#define VELUM_GROUP 8 /* x and y of every 2D pass */

/* Rays of a tile, that are left out together: one run of lanes. */
#define VELUM_TILE_RAYS_W 4
#define VELUM_TILE_RAYS_H 2
/* How restless a tile is: the sum over its rays of by how much of what is seen they differ from history, and one for each
 * pixel whose history is lost, in units of one over this; the frames before count for less each time it has rays, by one
 * part in VELUM_RESTLESS_FRAMES. */
#define VELUM_RESTLESS_UNIT 256u
#define VELUM_RESTLESS_FRAMES 8u
#define VELUM_RESTLESS_MOST 16384u
/* Mean difference, from which on it has rays in every frame. */
#define VELUM_RESTLESS 0.06f

#endif
