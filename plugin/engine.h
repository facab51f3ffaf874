/* Engine, eye, view and shadow map, as the plugin sees them. Frames: begin; shared; views and shadow maps; end. */
#ifndef PLUGIN_ENGINE_H
#define PLUGIN_ENGINE_H

#include "arguments.h"
#include "core/drift.h"
#include "core/geodesy.h"
#include "governor.h"
#include "gpu.h"
#include "pages.h"
#include "shared/arguments.h"
#include "shared/lit.h"
#include "shared/scattering.h"
#include "sky_key.h"
#include "tiles.h"
#include "world.h"

enum {
    FRAMES_MAX = 4,
    FRAME_UNIFORM_BYTES = 256 << 10,
    FRAME_QUERIES = 512,
    FRAME_RECORDS = 128, /* views in a frame */
    FRAME_POOL_SETS = 64,
    FRAME_POOLS = 8,
    EYES_MAX = 16, /* in a frame */
    COUNTER_STRIDE = 256,
    STAGE_TOTAL_BYTES = 10 << 20, /* over all frames in flight */
    RENDER_TILES = 16,            /* rasterised by a frame at most where the host does not prepare() */
    SHADOW_LEVELS_MAX = 4,
    VIEW_SIDE_MOST = 8192, /* pixels */
    PATH_BLOCK = 4,        /* pixels of a march block's side, as presets have it */
    RAY_RATE_MOST = 64,
    STANDING_RAY_RATE_MOST = 256
};

typedef struct engine engine;
typedef struct eye eye;
typedef struct view view;
typedef struct shadow shadow;

/* Variants of a pass, added to its first: two weather states, or two lives of the noise; closed sheets and uniform
 * layers; layers with scud, transition band or precipitation. */
enum { PASS_MIXED = 1, PASS_CLOSED = 2, PASS_FRINGED = 4, PASS_VARIANTS = 8 };
/* In the place of PASS_CLOSED, of PASS_SHADOW: weather that differs from place to place. */
enum { PASS_UNEVEN = PASS_CLOSED };
/* Those of PASS_RESOLVE: there may be ground in sight that the host does not draw; has given its depth; gives arrays of
 * pictures; history moves, or is kept where it is; moves though the view stands. */
enum { PASS_GROUND = 1, PASS_DEPTH = 2, PASS_LAYERED = 4, PASS_MOVES = 8, PASS_KEEPS = 16, PASS_STANDS = 32 };
enum { PASS_RESOLVE_VARIANTS = 64 };
/* In the place of PASS_KEEPS, with PASS_DEPTH: the eye's sky does not tell of the air before them. */
enum { PASS_ASIDE = PASS_KEEPS };

typedef enum pass {
    PASS_AIR,
    PASS_GLOW,
    PASS_SKY,
    PASS_SKY_FOG,     /* where there is fog */
    PASS_DUE,         /* rays of views that stand */
    PASS_FINER,       /* rays of views that move */
    PASS_NEAR,        /* and of those that meet near cloud */
    PASS_NEAR_DEPTH,  /* before what the host has drawn */
    PASS_VOLUME_FILL, /* two, PASS_MIXED; for studies, made when they are asked for */
    PASS_VOLUME_SUN = PASS_VOLUME_FILL + PASS_MIXED + 1,
    PASS_VOLUME_SPREAD,
    PASS_MARCH,                                     /* eight */
    PASS_MARCH_UNEVEN = PASS_MARCH + PASS_VARIANTS, /* eight, for weather that differs from place to place */
    PASS_LIGHT = PASS_MARCH_UNEVEN + PASS_VARIANTS, /* of the places that rays have found: eight; then for each ray */
    PASS_GATHER = PASS_LIGHT + PASS_VARIANTS,
    PASS_GATHER_KEEPS, /* where history is kept */
    PASS_MARCH_STUDY,  /* eight, PASS_CLOSED without effect; made with the first eye that wants them */
    PASS_SHADOW = PASS_MARCH_STUDY + PASS_VARIANTS, /* eight */
    PASS_RESOLVE = PASS_SHADOW + PASS_VARIANTS,     /* sixty-four */
    /* Of everything; from here on made with the first eye that wants them. */
    PASS_REFERENCE = PASS_RESOLVE + PASS_RESOLVE_VARIANTS,
    PASS_REFERENCE_FRINGED,
    PASS_REFERENCE_RESOLVE,
    PASS_REFERENCE_RESOLVE_LAYERED,
    PASS_REFERENCE_ERROR,
    PASS_COUNT
} pass;

/* Variants of the tracer; past them the one of everything serves. */
enum { TRACERS_MAX = 32 };

typedef struct pipelines {
    VkDescriptorSetLayout set_engine, set_view, set_shadow, set_reference;
    VkPipelineLayout layout_engine, layout_view, layout_shadow, layout_reference;
    VkPipeline pipeline[PASS_COUNT];
    VkPipeline tracer[TRACERS_MAX];
    uint32_t tracer_key[TRACERS_MAX], tracer_count;
    VkPipelineCache cache;
    VkSampler linear, repeat, nearest;
} pipelines;

velum_result pipelines_init(pipelines *p, gpu *g, const void *blob, uint64_t blob_size, bool arrays);
/* Invocations of a work group of PASS_REFERENCE: on software devices one thread's vector. */
uint32_t pipelines_reference_lanes(const gpu *g);
/* [control, render] Makes what is not there yet of these. False: the device refuses. */
bool pipelines_need(pipelines *p, gpu *g, const pass *needed, uint32_t count);
/* [control] Of VELUM_EYE_STUDY, if they are not there yet. */
velum_result pipelines_add_study(pipelines *p, gpu *g);
/* [control] The reference's, if they are not there yet. */
velum_result pipelines_add_reference(pipelines *p, gpu *g);
/* The tracer for what a frame has, made when it is first asked for. Null: the device refuses. */
VkPipeline pipelines_tracer(pipelines *p, gpu *g, bool mixes, bool air, uint32_t slots, bool fringed);
void pipelines_finish(pipelines *p, gpu *g);
/* As get_pipeline_cache. */
velum_result pipelines_get_cache(pipelines *p, gpu *g, void *data, uint64_t *size);
VkPipelineLayout pipelines_layout(const pipelines *p, pass which);

/* What is to be read back of a view once its frame has completed. */
typedef struct frame_record {
    view *v;        /* null: destroyed since */
    uint32_t query; /* first of three; FRAME_QUERIES: none */
    uint64_t slice; /* of the reference; 0: none */
    uint32_t paths; /* that it has */
    uint32_t rounds;
    bool is_governed; /* its time teaches its eye's governor */
    governor_setting setting;
    velum_view_stats stats;
} frame_record;

/* One frame in flight. */
typedef struct frame_slot {
    uint64_t serial; /* 0: never used, or read back */
    stage staged;
    VkDeviceSize uniform_first, uniform_used;
    VkDescriptorPool pool[FRAME_POOLS];
    uint32_t pool_now;
    VkQueryPool queries; /* null: the device has no timestamps */
    uint32_t query_count;
    uint32_t shared_query, shadow_query[SHADOW_LEVELS_MAX * 4]; /* first of two */
    uint32_t shadow_queries;
    uint32_t eye_count;  /* that its shared passes are for */
    gpu_buffer counters; /* read back */
    frame_record record[FRAME_RECORDS];
    uint32_t record_count;
} frame_slot;

/* What a table of multiple scattering is for. */
typedef struct scattering_key {
    float albedo;
    velum_phase_lobes phase;
    bool filled; /* false: nothing yet */
} scattering_key;

typedef enum engine_state { ENGINE_IDLE, ENGINE_BEGUN, ENGINE_SHARED } engine_state;

struct engine {
    log_sink sink;
    velum_engine *handle;
    world *w;
    gpu g;
    pipelines passes;
    void *owner;                        /* of a standalone engine: what owns the device; null: the host */
    void (*release_owner)(void *owner); /* what it has of the device, before the engine goes */
    void (*destroy_owner)(void *owner); /* the device, after */
    bool inside;                        /* a call of the standalone table is at work */

    uint32_t frames_in_flight;
    engine_state state;
    uint64_t newest_serial, completed_serial;
    uint64_t frames;
    frame_slot slots[FRAMES_MAX];
    frame_slot *now;
    gpu_buffer uniforms;
    gpu_buffer counters; /* of the frame being recorded: device memory */

    velum_frame_info frame;
    world_weather weather;
    core_drift drift;

    pages pages;
    table_space tables;
    gpu_image shape, detail, air, glow, white, scattering;
    gpu_image nothing, nothing_layered; /* stand in for images that the host does not give */
    gpu_buffer noise_upload;
    uint64_t noise_serial;                                  /* of the frame that sends it */
    bool filled;                                            /* noise and white are on the device */
    scattering_key scattering_key[VELUM_SCATTERING_TABLES]; /* what is there of them */
    bool air_ready;                                         /* the tables of air and glow */
    shadow *newest_shadow;                                  /* drawn last */
    shadow *bound_shadow;                                   /* that this frame's views see; null: none */
    gpu_buffer noise_slope; /* of the reference (shared/reference.h), once an eye wants it */
    float detail_slope;

    uint32_t eye_count, shadow_count;
    eye *eyes;      /* alive */
    eye *dead_eyes; /* until the device has passed them */
    view *dead_views;
    shadow *shadows, *dead_shadows;
};

/* Of the clouds about an eye. */
typedef struct cloud_wind {
    float m_s[VELUM_SHADE_LEVELS][3]; /* at the levels of shared/shade.h; ECEF */
    /* How fast they go by at most in the zenith and in the nadir. INFINITY, both: some are at the eye's height, or are
     * in sight and not over it. */
    float above_rad_s, below_rad_s;
} cloud_wind;

struct eye {
    engine *e;
    velum_eye *handle;
    eye *next;
    int32_t quality;
    bool has_study; /* VELUM_EYE_STUDY */
    uint32_t view_count;
    uint64_t last_serial; /* that uses its device objects */
    tiles tiles;
    gpu_image sky;
    sky_key sky_made, sky_wanted; /* for what it was drawn; the newest frame's */
    uint32_t sky_rests;           /* frames in a row that want the same */
    uint32_t sky_count;           /* drawn so far */
    /* of the newest frame */
    uint64_t frame; /* engine's count; 0: none */
    bool reset;
    double position_ecef_m[3];
    velum_eye_block block;
    VkDescriptorSet set;
    bool incomplete, degraded;
    cloud_wind wind;
    velum_plan plan, imposed;
    bool is_imposed;
    float budget_ms, budget_error; /* 0: none */
    governor governor;             /* where there is a budget_ms */
    bool is_governed;              /* the newest plan is the governor's */
    char reasons[1024];
};

/* What a picture of the reference depends on. */
typedef struct reference_key {
    velum_eye_block eye;
    velum_view_block view; /* what of it does not change from slice to slice */
    uint64_t state[2], tables;
} reference_key;

/* A view's accumulation. A slice of paths may take several frames: what it has come to is learnt when they are done. */
typedef struct reference {
    gpu_buffer paths, pixels, slice_words, lanes;
    uint32_t path_room;               /* paths of a slice at most */
    uint32_t rounds;                  /* of a lane's loop that a submission has time for, on software devices */
    uint64_t slice;                   /* number of the present one; 0: none */
    bool begun;                       /* it has been recorded before */
    bool complete;                    /* and is done */
    uint32_t turn;                    /* of the pixels (shared/reference.h): first of the slice */
    uint32_t turns;                   /* of the slice */
    uint32_t done;                    /* paths that each pixel has had */
    uint32_t paths_now;               /* for each pixel in this round */
    uint32_t side;                    /* of the square of blocks that take turns */
    float most_1_m[VELUM_SLOT_COUNT]; /* extinction of each slot, over all that the eye has */
    reference_key *key;               /* null: nothing yet */
} reference;

/* A camera as the frame after it needs it. */
typedef struct camera {
    double position[3], right[3], up[3], forward[3];
    float tan[4]; /* left, right, bottom, top */
    float jitter[2];
    uint32_t flags, width, height;
    float scale;
    double time_s;
    double sun[3];
    uint64_t state[2];
    float blend;
    bool is_aside; /* so far from its eye, or so made, that its air is not the eye's */
    bool has_depth;
} camera;

/* What a view's frame leaves to the next. */
typedef struct view_history {
    bool is_there;
    camera before;
    velum_plan plan;     /* of that frame */
    double time_s;       /* that history shows */
    uint32_t counter;    /* frames since reset */
    uint32_t rounds;     /* in which every pixel's turn came, since history was begun, or begun anew at rest */
    uint32_t begun;      /* counter since when one number of rays has held: rounds go on from there */
    uint32_t still;      /* frames in a row that showed the same */
    uint32_t rest;       /* so many are a rest: more than the host repeats a pose while it moves */
    bool has_moved;      /* some frame since then did not */
    uint32_t stood;      /* frames in a row in which only cloud drifted, slowly */
    uint32_t yields;     /* frames at rest in which what it had while it stood yet gives way */
    uint32_t calm_turns; /* of tiles of rays, in that frame: see history_turn */
} view_history;

/* What a volume of light is made for. */
typedef struct light_volume_key {
    velum_eye_block eye;
    double position[3];
    uint64_t state[2], tables, skies;
    float cell_m;
    uint32_t reserved;
} light_volume_key;

typedef struct light_volume {
    gpu_buffer buffer; /* velum_light_volume_block and cells; none until a plan wants it */
    bool is_made;
    light_volume_key key;
} light_volume;

struct view {
    eye *eye;
    velum_view *handle;
    view *next;
    char name[64];
    uint32_t width, height;
    uint64_t last_serial;
    uint64_t frame; /* engine's count; 0: none */
    gpu_image march_light, march_distance;
    gpu_buffer lit;  /* of as many rays (shaders/lit.glsl): places, then their list, then that of rays that are due */
    gpu_buffer rays; /* the same (shaders/view.glsl) */
    gpu_image history[2], history_data[2];
    light_volume light_volume;
    uint32_t newest; /* of history */
    view_history past;
    velum_view_stats stats;
    bool has_stats;
    uint64_t bytes;
    reference reference;
};

typedef struct shadow_level {
    uint32_t next_row, stale_rows; /* stale: show an earlier time */
    double due_rows;               /* of them, to be drawn by now */
} shadow_level;

struct shadow {
    engine *e;
    velum_shadow *handle;
    shadow *next;
    uint32_t levels, texels;
    double extent_m;
    uint64_t last_serial;
    uint64_t frame;
    tiles tiles;
    gpu_image image;
    gpu_image spare; /* a level on its way to its new place */
    bool drawn, incomplete;
    shadow_level level[SHADOW_LEVELS_MAX];
    uint64_t texels_drawn;
    velum_shadow_geometry geometry;
    /* what is drawn */
    struct shadow_key {
        double sun[3], origin[3];
        double corner[SHADOW_LEVELS_MAX][2]; /* along the axes across the sun, m */
        double phase[SHADOW_LEVELS_MAX][2];  /* of its grid of texels, from the earth's centre, m */
        double time_s;
        uint64_t state[2];
        float blend;
        uint32_t reserved;
    } key;
    uint64_t bytes;
};

/* engine.c. `arrays`: the host may give arrays of pictures. */
velum_result engine_create(const velum_vulkan_lend *lend, world *w, bool arrays, velum_engine **out);
velum_result engine_destroy(engine *e);
velum_result engine_begin_frame(engine *e, const velum_frame_info *frame);
velum_result engine_end_frame(engine *e);
velum_result engine_complete(engine *e, uint64_t completed_serial);
uint64_t engine_weather_bytes(const engine *e);

/* frame.c: what a frame in flight gives out. */
bool frame_slot_init(engine *e, frame_slot *slot, uint32_t index);
void frame_slot_finish(engine *e, frame_slot *slot);
bool frame_slot_begin(engine *e, frame_slot *slot);
/* Space for a block; its dynamic offset. False: none is left, logged. */
bool frame_uniform(engine *e, const void *block, uint32_t size, uint32_t *offset);
bool frame_set(engine *e, VkDescriptorSetLayout layout, VkDescriptorSet *out);
uint32_t frame_queries(engine *e, uint32_t count);
void frame_timestamp(engine *e, VkCommandBuffer commands, uint32_t query);
/* Set 0 with an eye's sky. */
bool frame_engine_set(engine *e, const gpu_image *sky, VkDescriptorSet *out);

/* stats.c: takes in what finished frames have left. */
void stats_read(engine *e, frame_slot *slot);
void stats_forget(engine *e, const view *v);

/* objects.c */
velum_result eye_create(engine *e, const velum_eye_desc *desc, velum_eye **out);
velum_result eye_destroy(eye *y);
velum_result view_create(eye *y, const velum_view_desc *desc, velum_view **out);
velum_result view_destroy(view *v);
/* Of each texel's line: segments.glsl. */
uint32_t shadow_segments(const gpu *g);
velum_result shadow_create(engine *e, const velum_shadow_desc *desc, velum_shadow **out);
velum_result shadow_destroy(shadow *s);
void objects_bury(engine *e); /* frees what the device has passed */

/* view_images.c: what a view has of the device. */
bool view_images_init(view *v);
void view_images_finish(gpu *g, view *v);
/* Whether the device can hold so many rays; room for them: what is too small is buried. */
bool view_images_hold(const view *v, uint32_t rays_w, uint32_t rays_h);
bool view_images_grow(view *v, uint32_t rays_w, uint32_t rays_h);
/* Where the list of places begins in view.lit. */
VkDeviceSize view_images_list_at(const view *v);

/* view_check.c: what a host gives of a view in a frame. Fills in what it may leave 0. */
bool view_check_frame(checker *check, const view *v, velum_view_frame *f);
bool view_check_images(checker *check, const velum_view_frame *f, const velum_vulkan_images *images);

/* record_*.c */
velum_result record_shared(engine *e, VkCommandBuffer commands, const velum_eye_frame *eyes, uint32_t count,
                           uint32_t stride);
velum_result record_view(view *v, VkCommandBuffer commands, const velum_view_frame *frame,
                         const velum_vulkan_images *images);
/* record_reference.c: views of eyes of VELUM_QUALITY_REFERENCE. */
velum_result reference_enable(engine *e);
bool reference_init(view *v);
void reference_finish(gpu *g, view *v);
velum_result record_reference(view *v, VkCommandBuffer commands, const velum_view_frame *frame,
                              const velum_vulkan_images *images, velum_view_block *block, bool cut);
/* Takes in how far a frame came, and how long it took (0: unknown); completes the statistics. */
void reference_learn(view *v, const frame_record *record, const uint32_t *slice_words, float ms);
velum_result record_shadow(shadow *s, VkCommandBuffer commands, const velum_shadow_frame *frame);
/* Uploads staged by `context` since, between barriers. */
void record_uploads(engine *e, VkCommandBuffer commands, const tiles_context *context);
tiles_context record_tiles_context(engine *e, uint32_t *budget, VkBufferCopy *copies, uint32_t copy_capacity);
void record_dispatch(engine *e, VkCommandBuffer commands, pass which, uint32_t width, uint32_t height);
/* The same with so many layers of groups. */
void record_layers(engine *e, VkCommandBuffer commands, pass which, uint32_t width, uint32_t height, uint32_t layers);

/* noise_volumes.c: the first frame's uploads. */
bool noise_volumes_init(engine *e);
velum_result noise_volumes_record(engine *e, VkCommandBuffer commands);
/* Frees what it took to send them, once the device has them. */
void noise_volumes_bury(engine *e);

/* scattering.c */
bool scattering_init(engine *e);
/* What is not there yet of this frame's weather. */
velum_result scattering_record(engine *e, VkCommandBuffer commands);

/* plan.c */
const char *plan_preset_name(int32_t quality);
void plan_make(const engine *e, eye *y);
void plan_reason(eye *y, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* Whether it asks for what the ordinary pipelines do not do. */
bool plan_is_study(const velum_plan *plan);
velum_result plan_impose(eye *y, const velum_plan *plan);

#endif
