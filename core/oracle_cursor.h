/* Fields and noise around a point that moves: what stays from one point to the next is kept. */
#ifndef VELUM_CORE_ORACLE_CURSOR_H
#define VELUM_CORE_ORACLE_CURSOR_H

#include "cloud_sample.h"
#include "oracle.h"
#include "tile_spans.h"

typedef struct oracle_cursor {
    const core_oracle *oracle;
    velum_result result; /* the first error; everything is 0 from then on */
    uint32_t level;
    double distance_m; /* at which a picture's pixel is as large as the footprint */
    uint32_t key, data_key;
    core_tile *tile[2];
    velum_span_m all;                    /* of what there is in the tiles */
    velum_span_m span[VELUM_SLOT_COUNT]; /* of what there is between the texels about the place */
    uint32_t quad;                       /* those texels */
    double same_m;                       /* as far from the place, at least, the spans hold */
    double noise_origin_m[3];
    bool has_noise;
    core_cloud_noise noise[VELUM_SLOT_COUNT];
} oracle_cursor;

/* A point: where it is, and where in the cursor's tiles. */
typedef struct oracle_place {
    double ecef_m[3], normal[3];
    double height_m; /* HAE */
    float s, t;
} oracle_place;

void oracle_cursor_init(oracle_cursor *cursor, const core_oracle *oracle, double footprint_m);
void oracle_cursor_finish(oracle_cursor *cursor);

/* Moves to a point and finds its tiles. */
oracle_place oracle_cursor_move(oracle_cursor *cursor, const double ecef_m[3]);
/* Slots with cloud in the tiles. */
uint32_t oracle_cursor_mask(const oracle_cursor *cursor);
velum_slot_fields oracle_cursor_fields(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot);
/* Of a slot's cloud; of its hem and of what falls from it. */
typedef struct oracle_extinction {
    float cloud_1_m, fringe_1_m;
} oracle_extinction;
oracle_extinction oracle_cursor_slot(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot);
float oracle_cursor_total(const oracle_cursor *cursor, const oracle_place *place);
/* As far as this there is nothing around the place to which the cursor moved last; 0 or less: not known. */
double oracle_cursor_clear_m(const oracle_cursor *cursor, const oracle_place *place);

#endif
