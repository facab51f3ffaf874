/* Fills the list of rays that due.glsl reads. */
#ifndef VELUM_DUE_LIST_GLSL
#define VELUM_DUE_LIST_GLSL

#include "due.glsl"

/* Room in lit_list for so many rays of an invocation: where they begin. All of a subgroup ask. */
uint due_room(uint count) {
    uint before = subgroupExclusiveAdd(count);
    uint all = subgroupAdd(count);
    uint first = 0u;
    if (subgroupElect()) {
        first = atomicAdd(due_count, all);
        atomicMax(due_rows, listed_rows(first + all));
    }
    return due_first() + subgroupMax(first) + before;
}

#endif
