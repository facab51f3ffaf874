/* Fields and noise around a point that moves: what stays from one point to the next is kept. */
#ifndef VELUM_CORE_ORACLE_CURSOR_H
#define VELUM_CORE_ORACLE_CURSOR_H

#include "cloud_sample.h"
#include "oracle.h"

typedef struct oracle_cursor {
    const core_oracle *oracle;
    velum_result result; /* the first error; everything is 0 from then on */
    uint32_t level;
    double distance_m; /* at which a picture's pixel is as large as the footprint */
    uint32_t key, data_key;
    core_tile *tile[2];
    float min_base_m, max_top_m; /* of the tiles, with hems and what falls */
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
/* Extinction of a slot's cloud at the place, 1/m; of its scud and of what falls from it. */
float oracle_cursor_cloud(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot);
float oracle_cursor_fringe(const oracle_cursor *cursor, const oracle_place *place, uint32_t slot);
float oracle_cursor_total(oracle_cursor *cursor, const oracle_place *place);

#endif
