/* A world with weather in it, and everything that its functions may be given. */
#ifndef TESTS_ABI_WORLD_FIXTURE_H
#define TESTS_ABI_WORLD_FIXTURE_H

#include "misuse.h"

typedef struct world_fixture {
    test_host *host;
    velum_world *world;
    uint64_t state;
    velum_layer layer;
    velum_lat_lon points[8];
    uint32_t ring_sizes[2];
    velum_cell cell;
    velum_cell nodes[4];
    velum_grid grid;
    velum_state_desc desc;
    velum_timeline_key keys[2];
    uint32_t key_count, key_stride;
    velum_prepare_eye eye;
    velum_prepare_info prepare;
    velum_point_query point;
    velum_point_answer point_answer;
    velum_line_query line;
    velum_line_answer line_answer;
    uint64_t out_state;
    bool retire; /* what a legal commit made, at once */
} world_fixture;

void world_fixture_init(world_fixture *f, test_host *host, int32_t kind);
void world_fixture_finish(world_fixture *f);
/* What a refused call must not change. */
void world_fixture_snapshot(void *context, void *out256);
misuse world_fixture_misuse(world_fixture *f, const char *name, misuse_call call);

#endif
