/* What a frame makes of a view's history: whether it goes on, moves, rests, or is kept. */
#ifndef PLUGIN_HISTORY_H
#define PLUGIN_HISTORY_H

#include "engine.h"

/* Simulations slower than the display repeat each pose for a few frames: fewer than these. */
#define REPEATS_MOST 16

typedef enum history_way {
    HISTORY_MOVES, /* all of it is handed on to where it stands now */
    HISTORY_RESTS, /* pixel by pixel */
    HISTORY_KEEPS  /* the same, in place: only pixels with a ray are written */
} history_way;

typedef struct history_turn {
    bool anew;
    bool forgets; /* what history holds counts for nothing from then on */
    history_way way;
    float samples;       /* that a pixel's history counts for at most */
    float shown_samples; /* that a pixel which stands is shown as having at most */
    bool has_depth;      /* the host's, now or in the frame before; or air of its own */
    uint32_t round;
    /* Frames in which tiles of rays that find what history has take one turn; 0: all have rays in every frame. */
    uint32_t calm_turns;
    bool tiles_begin;  /* nothing is known of them */
    bool has_finer;    /* blocks may have rays more: see velum_plan.finer_rays */
    view_history next; /* the view's, once the frame is recorded */
} history_turn;

/* `cut`: the host says that nothing of the frame before is left. */
history_turn history_take(const view *v, bool cut, const camera *now, const velum_plan *plan);

#endif
