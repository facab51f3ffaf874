/* Velum ABI, part 4: engines, eyes, views, shadow maps and frames. Table "velum.engine/1".
 *
 * An engine is made by "velum.vulkan/1" (on the host's device) or by "velum.standalone/1" (on its own). Eyes belong to
 * an engine, views to an eye. Order in a frame: begin_frame; record_shared (once); record_view and record_shadow (any
 * number, any order); end_frame. A standalone engine records and submits by itself.
 *
 * Positions and directions are ECEF: metres, double. Luminance is cd/m2, illuminance lx, per channel of linear
 * Rec. 709 primaries. */
#ifndef VELUM_ENGINE_H
#define VELUM_ENGINE_H

#include "world.h"

#ifdef __cplusplus
extern "C" {
#endif

enum {
    VELUM_QUALITY_DEFAULT = 0, /* medium */
    VELUM_QUALITY_LOW = 1,
    VELUM_QUALITY_MEDIUM = 2,
    VELUM_QUALITY_HIGH = 3,
    VELUM_QUALITY_ULTRA = 4,
    /* An unbiased path tracer over the same weather, phase functions, air, ground and sun: what the presets are
     * measured by. Each frame of a view adds paths to its pixels, as many as take about 30 ms, and gives the means so
     * far; it begins anew when anything changes that the picture depends on (also with VELUM_EYE_RESET and
     * VELUM_VIEW_CUT; not with the contents of a depth image). The same seed, camera and weather give the same picture
     * for the same number of paths, however frames divide them. */
    VELUM_QUALITY_REFERENCE = 5
};

enum { VELUM_ATMOSPHERE_EARTH = 0, VELUM_ATMOSPHERE_NONE = 1 };

/* Budgets. Plans are then Velum's own choice, from frame to frame; get_plan tells them with their reasons, and set_plan
 * repeats them bit for bit (given the same cameras, weather and times).
 *
 * budget_ms: device time of the eye's frames: march and resolve of all its views, and its share of the shared passes
 * (one of the eyes that record_shared names). Shadow maps are not in it: the host says when they are drawn, for all
 * eyes, and no plan changes them. It begins with the steps of `quality` and a ray for 16 pixels, and goes up to those
 * of VELUM_QUALITY_ULTRA with a ray for each pixel, and down to those of VELUM_QUALITY_LOW with a ray for 64, as the
 * times of finished frames tell; nothing is known of the frames in flight. Over the budget quality falls at once, under
 * it it rises by at most 3 % of time a frame; within -8 and +5 % nothing changes. A lone slow frame changes nothing.
 * After VELUM_EYE_RESET it is no better than at the beginning, until frames have finished again. Without cloud in sight
 * no quality is spent. Where even the least plan takes longer, or the best less, reasons say so. On a device without
 * timestamps create_eye warns, and plans are those of `quality`.
 *
 * budget_error: in place of `quality`, the cheapest preset whose error is not greater: root of the mean square of the
 * relative errors of luminance of means over 8 x 8 pixels, of settled pictures, over the scenes of
 * tests/report/accuracy. Those of one scene may be greater. If no preset is so good: the one with the least error, and
 * reasons say so.
 *
 * Both: time holds; quality is never better than budget_error asks for, and time that it does not need is left. */
typedef struct velum_eye_desc {
    uint32_t struct_size;
    uint32_t flags;     /* VELUM_EYE_STUDY */
    int32_t quality;    /* VELUM_QUALITY_* */
    float budget_ms;    /* 0.001..10000; 0: none. Not for VELUM_QUALITY_REFERENCE */
    float budget_error; /* 0.001..1; 0: none. Not for VELUM_QUALITY_REFERENCE */
    uint32_t reserved;
} velum_eye_desc;
/* Plans may ask for the methods of others (velum_plan, from `integrator` on), so that they can be compared. Compiles
 * pipelines of their own when such an eye is first made; a plan that asks for none of it still gets the ordinary ones.
 * Not for VELUM_QUALITY_REFERENCE. */
#define VELUM_EYE_STUDY 0x1u

typedef struct velum_view_desc {
    uint32_t struct_size;
    uint32_t flags;         /* 0 */
    uint32_t width, height; /* pixels, 1..8192, of the largest picture that the view will give */
    const char *name;       /* for logs and statistics, copied; may be null */
} velum_view_desc;

typedef struct velum_shadow_desc {
    uint32_t struct_size;
    uint32_t flags;  /* 0 */
    uint32_t levels; /* nested clip maps, 1..4; 0: 3 */
    uint32_t texels; /* a side, of each level: 64..1024, a multiple of 16; 0: 256 */
    float extent_m;  /* side of the finest level; each next is 4 times as wide; 1000..100000; 0: 8192 */
    uint32_t reserved;
} velum_shadow_desc;

/* What holds for all views of an engine's frame. */
typedef struct velum_frame_info {
    uint32_t struct_size;
    uint32_t flags;               /* 0 */
    uint64_t submit_serial;       /* of the submission that this frame is part of; strictly increasing, > 0 */
    uint64_t completed_serial;    /* of the newest submission that the device has finished; < submit_serial */
    double time_s;                /* on the weather timeline; may go backward */
    double sun_direction_ecef[3]; /* towards the sun, unit within 1e-3 */
    float sun_illuminance_lx[3];  /* at the top of the atmosphere, on a plane that faces the sun; >= 0 */
    float sun_angular_radius_rad; /* 0: 0.004654 */
    float ground_albedo[3];       /* 0..1 */
    int32_t atmosphere;           /* VELUM_ATMOSPHERE_* */
} velum_frame_info;

/* One eye in a frame. Its sky is drawn anew when a change since the last time would show (by a hundredth of its
 * luminance at most), and exactly with VELUM_EYE_RESET or where nothing that it depends on has changed for 16 frames.
 */
typedef struct velum_eye_frame {
    uint32_t struct_size;
    uint32_t flags; /* VELUM_EYE_RESET */
    velum_eye *eye;
    double position_ecef_m[3];
} velum_eye_frame;
#define VELUM_EYE_RESET 0x1u /* all views of the eye start anew, as after a cut */

enum {
    VELUM_DEPTH_REVERSED_INFINITE = 0, /* d = near / z, infinite far plane: 0 is infinity */
    VELUM_DEPTH_REVERSED = 1,          /* d = near (far - z) / (z (far - near)) */
    VELUM_DEPTH_FORWARD = 2,           /* d = far (z - near) / (z (far - near)) */
    VELUM_DEPTH_DISTANCE = 3           /* metres along the ray; 0 or infinity: nothing there */
};

#define VELUM_VIEW_CUT 0x1u          /* no history: the camera has jumped */
#define VELUM_VIEW_ORTHOGRAPHIC 0x2u /* tangents are half extents in metres */
#define VELUM_VIEW_GROUND 0x4u       /* draw the ellipsoid as ground where the host gives no depth */
#define VELUM_VIEW_SUN_DISC 0x8u     /* draw the sun's disc */

/* One view in a frame. right, up and forward are unit vectors, orthogonal within 1e-3, right-handed as
 * right x up = -forward. A pixel's ray is forward + right x + up y, x from tan_left to tan_right over the sub-rectangle
 * from left to right, y from tan_top to tan_bottom from the first row to the last. */
typedef struct velum_view_frame {
    uint32_t struct_size;
    uint32_t flags;            /* VELUM_VIEW_* */
    double position_ecef_m[3]; /* within 10 km of its eye's */
    double right_ecef[3];
    double up_ecef[3];
    double forward_ecef[3];
    float tan_left, tan_right;    /* left < right; off-axis is ordinary */
    float tan_bottom, tan_top;    /* bottom < top */
    float jitter_x, jitter_y;     /* of the host's own antialiasing, pixels, -1..1 */
    uint32_t x, y, width, height; /* sub-rectangle of the images; width, height 0: the view's */
    uint32_t array_layer;
    int32_t depth_convention; /* VELUM_DEPTH_*, of the host's depth image */
    float depth_near_m, depth_far_m;
    float luminance_scale; /* images hold luminance times this; > 0; 0: 1 */
    uint32_t path_limit;   /* of the reference: paths that a pixel gets at most; 0: no limit. Others: no effect */
} velum_view_frame;

/* Where a shadow map is wanted. It is snapped to texels of the world's own: the same centre gives the same map whatever
 * any camera does, as long as the sun stands. What is drawn goes on: as time does, the finest level is renewed in half
 * a second (in 16 frames, if those take longer), each next one in four times as much. When the sun has turned by 0.1
 * degrees since, the map turns to it, and is renewed as fast as that makes it stale. A sun that has turned by more than
 * half a degree since, time that goes back or on by more than a minute, and other weather draw the whole map anew. */
typedef struct velum_shadow_frame {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    double centre_ecef_m[3];
} velum_shadow_frame;

/* What the host's shaders need to sample a shadow map: the uniform block of velum_shadow.glsl, std140. Positions are
 * relative to origin_ecef_m. Texel (u, v) of level k at position p: uv = (dot(p, axis_u), dot(p, axis_v)) /
 * extent_m[k] + offset[k]. */
typedef struct velum_shadow_block {
    float axis_u[4];   /* unit, across the sun's direction; w: number of levels */
    float axis_v[4];   /* w: texels a side */
    float sun[4];      /* towards the sun of the map; w: 0 */
    float level[4][4]; /* per level: extent_m, offset_u, offset_v, reserved */
} velum_shadow_block;

typedef struct velum_shadow_geometry {
    uint32_t struct_size;
    uint32_t levels;
    uint32_t texels;
    uint32_t reserved;
    double origin_ecef_m[3]; /* the host subtracts this, in double, before it goes to float */
    velum_shadow_block block;
} velum_shadow_geometry;

/* Figures of the newest finished frame of a view. Times are of the device, ms; 0 where the device has no timestamps. */
typedef struct velum_view_stats {
    uint32_t struct_size;
    uint32_t incomplete; /* 1: tiles were missing */
    uint64_t frame;      /* submit_serial */
    uint64_t revision;   /* of the weather */
    uint64_t rays;       /* marched */
    uint64_t samples;    /* of the density function along rays, and towards the sun */
    uint64_t light_samples;
    float march_ms, resolve_ms; /* of this view */
    float shared_ms;            /* of the eye's shared passes of that frame */
    float shadow_ms;
    uint64_t weather_bytes; /* device memory: tiles, noise, tables; shared by all views */
    uint64_t view_bytes;    /* device memory of this view */
    /* Of the reference; else 0. */
    uint32_t paths_per_pixel; /* fewest that any pixel has had */
    float relative_error;     /* mean over the pixels of the standard error of their luminance, over the greater of it
                                 and 1 % of the picture's mean, when all pixels had the same number last; 0: unknown */
} velum_view_stats;

/* Bits of velum_plan.flags, for eyes with VELUM_EYE_STUDY alone.
 * STEP_THROUGH: no stretch of air is passed at once, however surely it is empty.
 * BASE_SEARCH: steps that look for cloud sample its base shape, without lumps and detail: it holds all of the cloud,
 * and more. No effect where long_step is 1. LIGHT_ALL: every sample in cloud finds its own light; else, behind a
 * transmittance of 0.3, that of the last will do. */
#define VELUM_PLAN_STEP_THROUGH 0x1u
#define VELUM_PLAN_BASE_SEARCH 0x2u
#define VELUM_PLAN_LIGHT_ALL 0x4u

/* How a step of length d through extinction s adds light of source S per unit of scattering, with T before it. */
enum {
    VELUM_INTEGRATOR_ENERGY = 0,   /* T S (1 - exp(-s d)): no light is made or lost (Hillaire 2016) */
    VELUM_INTEGRATOR_BEFORE = 1,   /* T S s d: too bright */
    VELUM_INTEGRATOR_AFTER = 2,    /* T exp(-s d) S s d: too dark */
    VELUM_INTEGRATOR_TRAPEZOID = 3 /* the mean of both */
};

/* Light of more than one order. */
enum {
    VELUM_SCATTERING_CLOSURE = 0, /* Velum's own: first order, widened peak, diffuse light of two streams */
    /* Octaves: each has half the scattering, extinction and asymmetry of the one before (Wrenninge et al. 2013;
     * a = b = c = 0.5). velum_plan.octaves of them; 1 is single scattering. */
    VELUM_SCATTERING_OCTAVES = 1,
    /* The sun's beam, however often it has gone on nearly straight, by the moments of its orders (Wang & Guth 1951);
     * all else by light that goes from cell to cell of a volume around the eye, as high as its clouds: in cells it is
     * scattered alike to all sides, by an extinction less what goes on forward (similarity; van de Hulst 1980), towards
     * the eye it goes on as Eddington has it (1916: mean and flux). Of a cell the cloud fills a box, by its mean place
     * and spread; air between clouds shines; sky and ground go by the cosine. The volume is 16, 32, 64 or 128 cells a
     * side, the first that make 12.8 km, and repeats itself beside; over its last four cells the closure takes its
     * place. Of low, middle and storm clouds but for scud, precipitation and closed sheets, which have the closure as
     * all other cloud; the sun in the volume is not dimmed by those. It is made anew in every frame in which the eye,
     * the sun, the time or the weather is another, in 64 passes: for pictures that stand. */
    VELUM_SCATTERING_VOLUME = 2
};

/* Depth of cloud towards the sun; of what lies aside of the way, light that has turned sees some too. No effect on uniform
 * layers, whose depth is known. */
enum {
    VELUM_SUN_DEPTH_STEPS = 0,  /* light_steps samples, with lumps, without fine detail */
    VELUM_SUN_DEPTH_COARSE = 1, /* without lumps */
    VELUM_SUN_DEPTH_FINE = 2,   /* all with lumps and fine detail */
    VELUM_SUN_DEPTH_MAP = 3     /* the engine's newest shadow map, no samples: too dark in cloud, as the map counts all
                                   cloud down to the ground. No map, or beside it: no cloud. Not deeper than 16 */
};

/* How a frame of an eye is made. Filled by get_plan; given to set_plan it is imposed. A view keeps its history from
 * plan to plan: standing, the new way takes over from the old within some ten samples a pixel, without a jump. */
typedef struct velum_plan {
    uint32_t struct_size;
    uint32_t flags;         /* VELUM_PLAN_* */
    uint32_t active_layers; /* bit per slot that can be seen */
    uint32_t march_steps;   /* along a ray, at most: 1..4096. They grow up to 17 times as long as they run out */
    uint32_t light_steps;   /* towards the sun: 1..64. A ray is lit at half as many places and one more, but at 4 to 6,
                               and at no more than 3 in frames in which blocks have more rays (finer_rays) */
    uint32_t ray_rate;      /* one ray for so many pixels: 1, 2, 4, 8, 16, 32 or 64. Pictures of more rays than the
                               device has room for (22 million of 2^27 texels) are drawn with fewer */
    uint32_t octaves;       /* of VELUM_SCATTERING_OCTAVES, 1..8. Of the reference: greatest order; 0: all */
    uint32_t blending;      /* 1: two weather states are mixed */
    float step_m;           /* least step that looks for cloud, 1..10000, beyond the first few, which begin at 12 m;
                               those in cloud are 0.18 of it, but no longer than 1.2 mean free paths of dense cloud
                               over what still comes through, where pixels show it. Both are shorter where cover is
                               rare, down to 0.3 of that */
    float step_growth;      /* relative growth with distance, 0..0.5 */
    float distance_m;       /* rays end here at the latest, 1..1e7 */

    /* From here on for eyes with VELUM_EYE_STUDY; else 0, as in every plan that Velum makes. */
    uint32_t integrator;      /* VELUM_INTEGRATOR_* */
    uint32_t scattering;      /* VELUM_SCATTERING_* */
    uint32_t sun_depth;       /* VELUM_SUN_DEPTH_* */
    float long_step;          /* steps that look for cloud, over those in it: 1..64; 1: all alike; 0: 1 / 0.18 */
    float thin_density;       /* less than this share of the layer's mean extinction counts as none: 0..1; 0: 0 */
    float exit_transmittance; /* a ray ends where less comes through: 1e-6..0.9; 0: 0.0015 */

    /* Of any eye again, but of no plan with a field of studies: one ray for so many pixels where rays find what history
     * holds already (tiles of 4 x 2 rays, to 6 % of what is seen), ray_rate elsewhere; history is moved when cloud has
     * drifted by half a pixel. In a view that has stood for three rounds of ray_rate, perspective, near its eye,
     * outside the cloud over it, without scud and precipitation in sight, at 10 Hz and more, while one weather state
     * holds, the sun turns by less than 2e-5 rad a frame and cloud drifts over it by less than half a pixel a frame. 0,
     * 1, 2, 4, .. 256; where it is not above ray_rate there is none of this. 0 where a budget_ms is kept. Who imposes a
     * ray_rate for views that stand imposes 0 here. */
    uint32_t standing_ray_rate;

    /* Of any eye, but of no plan with a field of studies. 1: where an eye or its weather moves, blocks of ray_rate
     * pixels around which rays have found much that differs (half of what is seen) have a ray in each of their
     * quarters: at most two in nine, so that there are at most 5 / 3 as many rays. With a ray_rate of 4 and more. 0:
     * never; so it is in plans of the reference, where a budget_ms leaves no time for them, and in plans of hosts whose
     * struct_size ends before it. */
    uint32_t finer_rays;

    /* With finer_rays: how many of 64 blocks (8 x 8) may be so, 1..14; 0: two in nine. What a budget_ms leaves when
     * steps are as short as they get, and twice the rays are too dear, goes to these, one by one. */
    uint32_t finer_blocks;

    /* 1: views that stand draw each pixel each frame, as those do that move, and not only where there are new rays; so
     * it is where a budget_ms is kept, which would be missed as soon as the eye moves. */
    uint32_t every_pixel;

    /* For eyes with VELUM_EYE_STUDY: side of a cell of VELUM_SCATTERING_VOLUME, m: 50..2000; 0: 100. Its height is a
     * fifth of that at least, and a thirty-second of what the volume must hold. */
    float volume_cell_m;
} velum_plan;

typedef struct velum_engine_api {
    uint32_t struct_size;
    uint32_t reserved;

    /* [control] Null is legal. VELUM_ERROR_STATE inside a frame, while eyes or shadow maps live, or while submissions
     * are in flight (completed_serial of the newest begin_frame, or of complete(), below the newest submit_serial). */
    velum_result(VELUM_CALL *destroy)(velum_engine *engine);

    /* [render] Tells, outside frames, what the device has finished. */
    velum_result(VELUM_CALL *complete)(velum_engine *engine, uint64_t completed_serial);

    /* [control] Eyes, views and shadow maps. Destroy: null is legal; device objects live on until the device has
     * passed them; VELUM_ERROR_STATE inside a frame, or for an eye with views. */
    velum_result(VELUM_CALL *create_eye)(velum_engine *engine, const velum_eye_desc *desc, velum_eye **out);
    velum_result(VELUM_CALL *destroy_eye)(velum_eye *eye);
    velum_result(VELUM_CALL *create_view)(velum_eye *eye, const velum_view_desc *desc, velum_view **out);
    velum_result(VELUM_CALL *destroy_view)(velum_view *view);
    velum_result(VELUM_CALL *create_shadow)(velum_engine *engine, const velum_shadow_desc *desc, velum_shadow **out);
    velum_result(VELUM_CALL *destroy_shadow)(velum_shadow *shadow);

    /* [render] */
    velum_result(VELUM_CALL *begin_frame)(velum_engine *engine, const velum_frame_info *frame);
    velum_result(VELUM_CALL *end_frame)(velum_engine *engine);

    /* [render] After record_shadow, also outside a frame: where the map lies. */
    velum_result(VELUM_CALL *get_shadow_geometry)(velum_shadow *shadow, velum_shadow_geometry *out);

    /* [render] The plan of the newest frame, and a text of its reasons, one a line (valid until the next frame). */
    velum_result(VELUM_CALL *get_plan)(velum_eye *eye, velum_plan *out, const char **out_reasons);
    /* [render] Outside a frame. Imposes a plan (fields in their ranges); null: Velum plans again. */
    velum_result(VELUM_CALL *set_plan)(velum_eye *eye, const velum_plan *plan);

    /* [render] VELUM_UNCHANGED while no frame of the view has finished. */
    velum_result(VELUM_CALL *get_stats)(velum_view *view, velum_view_stats *out);

    /* [render] Reserved: a depth-resolved volume of (L, T) along a view, for lights, particles and rotors in cloud.
     * VELUM_ERROR_UNSUPPORTED. */
    velum_result(VELUM_CALL *get_volume)(velum_view *view, void *reserved);
} velum_engine_api;

#define VELUM_ENGINE_API_ID "velum.engine/1"

#ifdef __cplusplus
}
#endif
#endif
