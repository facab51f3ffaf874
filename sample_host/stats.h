/* --stats: one JSON object a line for each view and frame. */
#ifndef HOST_STATS_H
#define HOST_STATS_H

#include "renderer.h"

#include <jansson.h>

#include <stdbool.h>
#include <stdio.h>

struct stats {
    const char *path;
    FILE *file; /* null: not asked for */
};

/* path null: nothing is written. Failures are reported. */
bool stats_open(struct stats *stats, const char *path);
/* After renderer_wait(). settle: which of the frames that settle this picture. */
bool stats_write(struct stats *stats, struct renderer *renderer, uint64_t picture, uint32_t settle, double time_s,
                 double wall_ms);
bool stats_close(struct stats *stats);
/* The plan of a line: every field by its name in engine.h, choices and flags by theirs. 0 in the last three is Velum's
 * own value. The caller's. */
json_t *stats_plan(const velum_plan *plan);

#endif
