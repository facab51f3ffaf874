#include "handle.h"
#include "tables.h"
#include "world.h"

#define WORLD(w, handle, call)                                                                                         \
    world *w = handle_get(handle, HANDLE_WORLD);                                                                       \
    if (!w) {                                                                                                          \
        return handle_fail(handle, HANDLE_WORLD, call);                                                                \
    }

static velum_result VELUM_CALL destroy(velum_world *handle) {
    if (!handle) {
        return VELUM_OK;
    }
    WORLD(w, handle, "destroy")
    return world_destroy(w);
}

static velum_result VELUM_CALL commit(velum_world *handle, const velum_state_desc *state, uint64_t *out_state) {
    WORLD(w, handle, "commit")
    return world_commit(w, state, out_state);
}

static velum_result VELUM_CALL retire(velum_world *handle, uint64_t state) {
    WORLD(w, handle, "retire")
    return world_retire(w, state);
}

static velum_result VELUM_CALL set_timeline(velum_world *handle, const velum_timeline_key *keys, uint32_t count,
                                            uint32_t stride) {
    WORLD(w, handle, "set_timeline")
    return world_set_timeline(w, keys, count, stride);
}

static velum_result VELUM_CALL prepare(velum_world *handle, const velum_prepare_info *info) {
    WORLD(w, handle, "prepare")
    return world_prepare(w, info);
}

static velum_result VELUM_CALL query_point(velum_world *handle, const velum_point_query *query,
                                           velum_point_answer *out) {
    WORLD(w, handle, "query_point")
    return world_query_point(w, query, out);
}

static velum_result VELUM_CALL query_line(velum_world *handle, const velum_line_query *query, velum_line_answer *out) {
    WORLD(w, handle, "query_line")
    return world_query_line(w, query, out);
}

static velum_result VELUM_CALL get_info(const velum_world *handle, velum_world_info *out) {
    WORLD(w, handle, "get_info")
    return world_get_info(w, out);
}

static velum_result VELUM_CALL create(const velum_world_desc *desc, velum_world **out) {
    return world_create(desc, out);
}

const velum_world_api velum_world_table = {.struct_size = sizeof velum_world_table,
                                           .create = create,
                                           .destroy = destroy,
                                           .commit = commit,
                                           .retire = retire,
                                           .set_timeline = set_timeline,
                                           .prepare = prepare,
                                           .query_point = query_point,
                                           .query_line = query_line,
                                           .get_info = get_info};
