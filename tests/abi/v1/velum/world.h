/* Velum ABI, part 3: the world. Table "velum.world/1".
 *
 * A world holds weather states and a timeline, and answers questions about the weather. It lives on the CPU, owns no
 * thread and needs no device; several engines may share one. Order: create, commit, set_timeline, then queries,
 * prepare and frames in any order; further commits at any time; destroy last, after its engines. */
#ifndef VELUM_WORLD_H
#define VELUM_WORLD_H

#include "weather.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct velum_world_desc {
    uint32_t struct_size;
    uint32_t flags;   /* 0 */
    uint64_t seed;    /* of all noise: the same seed, states and time give the same sky */
    velum_log_fn log; /* may be null */
    void *log_context;
} velum_world_desc;

/* A question about one place. */
typedef struct velum_point_query {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    double position_ecef_m[3];
    double time_s;      /* on the timeline */
    double footprint_m; /* size of the detail asked for; 0: the finest */
} velum_point_query;

typedef struct velum_point_answer {
    uint32_t struct_size;
    uint32_t reserved;
    double lat_deg, lon_deg, height_hae_m;
    float extinction_1_m;   /* of cloud, its transition band, scud and precipitation, all layers, at the point */
    float water_g_m3;       /* water content of cloud, without what falls from it */
    float coverage;         /* greatest of the layers over the place, 0..1 */
    float base_m, top_m;    /* MSL, of the lowest layer over the place; 0, 0: none */
    float visibility_m;     /* at the point: of haze, fog and all that extinction_1_m is of, together */
    float wind_ecef_m_s[3]; /* at the point */
    float precipitation_mm_h;
    int32_t precipitation; /* VELUM_PRECIPITATION_* */
    float temperature_k;   /* surface; 0: not known */
    int32_t genus;         /* of the layer with most extinction at the point, else of the lowest; 0: none */
} velum_point_answer;

/* A question about the straight line from one point to another. */
typedef struct velum_line_query {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    double from_ecef_m[3];
    double to_ecef_m[3];
    double time_s;
    double footprint_m;
    float contact_extinction_1_m; /* first contact is where extinction first exceeds this; 0: 1e-4 */
    float reserved;
} velum_line_query;

typedef struct velum_line_answer {
    uint32_t struct_size;
    uint32_t has_contact;
    double optical_depth;   /* of cloud, transition bands, scud and precipitation along the line */
    double transmittance;   /* exp(-optical_depth) */
    double first_contact_m; /* from `from`, within 1 m; not set without contact */
} velum_line_answer;

/* CPU work ahead of frames: tiles for places that eyes see or will see. */
typedef struct velum_prepare_eye {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    double position_ecef_m[3];
    double time_s;
    double pixel_rad;  /* angular size of the finest pixel, > 0; 0: 0.001 */
    double distance_m; /* how far clouds are wanted; 0: to the horizon of the highest cloud */
} velum_prepare_eye;

typedef struct velum_prepare_info {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    const velum_prepare_eye *eyes;
    uint32_t eye_count;
    uint32_t eye_stride;
    uint32_t max_tiles; /* budget: tiles rasterised by this call at most; 0: all that are wanted */
    uint32_t reserved;
} velum_prepare_info;

typedef struct velum_world_info {
    uint32_t struct_size;
    uint32_t state_count;
    uint64_t revision;         /* changes with every commit, retire and set_timeline */
    uint64_t tiles_rasterised; /* since creation: counts work, does not jitter */
    uint32_t tiles_resident;
    uint32_t cells; /* of all live states */
    uint64_t bytes; /* host memory */
} velum_world_info;

typedef struct velum_world_api {
    uint32_t struct_size;
    uint32_t reserved;

    /* [control] */
    velum_result(VELUM_CALL *create)(const velum_world_desc *desc, velum_world **out);

    /* [control] Null is legal and does nothing. VELUM_ERROR_STATE while an engine uses it, VELUM_ERROR_HANDLE if it is
     * not a live world. */
    velum_result(VELUM_CALL *destroy)(velum_world *world);

    /* [weather] Copies the state, checks it whole and makes it available under a new id (> 0). Nothing is taken over if
     * any part is refused; the log names cell, layer and field. Without a timeline the newest state holds. */
    velum_result(VELUM_CALL *commit)(velum_world *world, const velum_state_desc *state, uint64_t *out_state);

    /* [weather] Forgets a state. VELUM_ERROR_STATE while the timeline names it; states that were derived from it stay.
     */
    velum_result(VELUM_CALL *retire)(velum_world *world, uint64_t state);

    /* [weather] Replaces the timeline. count 0 removes it: then the newest state holds at all times. */
    velum_result(VELUM_CALL *set_timeline)(velum_world *world, const velum_timeline_key *keys, uint32_t count,
                                           uint32_t stride);

    /* [weather] Rasterises what the eyes will need. VELUM_INCOMPLETE if max_tiles was reached first. */
    velum_result(VELUM_CALL *prepare)(velum_world *world, const velum_prepare_info *info);

    /* [weather] Agree with the picture: extinction within 1e-3 (relative), first contact within 1 m. */
    velum_result(VELUM_CALL *query_point)(velum_world *world, const velum_point_query *query, velum_point_answer *out);
    velum_result(VELUM_CALL *query_line)(velum_world *world, const velum_line_query *query, velum_line_answer *out);

    /* [any] */
    velum_result(VELUM_CALL *get_info)(const velum_world *world, velum_world_info *out);
} velum_world_api;

#define VELUM_WORLD_API_ID "velum.world/1"

#ifdef __cplusplus
}
#endif
#endif
