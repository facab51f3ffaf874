#include "engine.h"
#include "handle.h"
#include "tables.h"

#define OBJECT(type, name, handle, which, call)                                                                        \
    type *name = handle_get(handle, which);                                                                            \
    if (!name) {                                                                                                       \
        return handle_fail(handle, which, call);                                                                       \
    }

/* On an engine that has its own device, render() alone makes frames. */
static velum_result refuse_standalone(const engine *e, const char *call) {
    return e->owner ? log_fail(&e->sink, VELUM_ERROR_STATE, "engine", "%s: not legal on a standalone engine", call)
                    : VELUM_OK;
}

static velum_result VELUM_CALL destroy(velum_engine *handle) {
    if (!handle) {
        return VELUM_OK;
    }
    OBJECT(engine, e, handle, HANDLE_ENGINE, "destroy")
    return engine_destroy(e);
}

static velum_result VELUM_CALL complete(velum_engine *handle, uint64_t completed_serial) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "complete")
    velum_result result = refuse_standalone(e, "complete");
    return result < 0 ? result : engine_complete(e, completed_serial);
}

static velum_result VELUM_CALL create_eye(velum_engine *handle, const velum_eye_desc *desc, velum_eye **out) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "create_eye")
    return eye_create(e, desc, out);
}

static velum_result VELUM_CALL destroy_eye(velum_eye *handle) {
    if (!handle) {
        return VELUM_OK;
    }
    OBJECT(eye, y, handle, HANDLE_EYE, "destroy_eye")
    return eye_destroy(y);
}

static velum_result VELUM_CALL create_view(velum_eye *handle, const velum_view_desc *desc, velum_view **out) {
    OBJECT(eye, y, handle, HANDLE_EYE, "create_view")
    return view_create(y, desc, out);
}

static velum_result VELUM_CALL destroy_view(velum_view *handle) {
    if (!handle) {
        return VELUM_OK;
    }
    OBJECT(view, v, handle, HANDLE_VIEW, "destroy_view")
    return view_destroy(v);
}

static velum_result VELUM_CALL create_shadow(velum_engine *handle, const velum_shadow_desc *desc, velum_shadow **out) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "create_shadow")
    return shadow_create(e, desc, out);
}

static velum_result VELUM_CALL destroy_shadow(velum_shadow *handle) {
    if (!handle) {
        return VELUM_OK;
    }
    OBJECT(shadow, s, handle, HANDLE_SHADOW, "destroy_shadow")
    return shadow_destroy(s);
}

static velum_result VELUM_CALL begin_frame(velum_engine *handle, const velum_frame_info *frame) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "begin_frame")
    velum_result result = refuse_standalone(e, "begin_frame");
    return result < 0 ? result : engine_begin_frame(e, frame);
}

static velum_result VELUM_CALL end_frame(velum_engine *handle) {
    OBJECT(engine, e, handle, HANDLE_ENGINE, "end_frame")
    velum_result result = refuse_standalone(e, "end_frame");
    return result < 0 ? result : engine_end_frame(e);
}

static velum_result VELUM_CALL get_shadow_geometry(velum_shadow *handle, velum_shadow_geometry *out) {
    OBJECT(shadow, s, handle, HANDLE_SHADOW, "get_shadow_geometry")
    checker check = {&s->e->sink, "shadow", "get_shadow_geometry", VELUM_OK};
    if (!check_out(&check, "out", out, V1_SHADOW_GEOMETRY)) {
        return check.result;
    }
    if (!s->drawn) {
        check_fail(&check, VELUM_ERROR_STATE, "no frame has drawn it yet");
        return check.result;
    }
    write_struct(out, &s->geometry, sizeof s->geometry);
    return VELUM_OK;
}

static velum_result VELUM_CALL get_plan(velum_eye *handle, velum_plan *out, const char **out_reasons) {
    OBJECT(eye, y, handle, HANDLE_EYE, "get_plan")
    checker check = {&y->e->sink, "eye", "get_plan", VELUM_OK};
    if (!check_out(&check, "out", out, V1_PLAN)) {
        return check.result;
    }
    if (y->frame == 0) {
        check_fail(&check, VELUM_ERROR_STATE, "no frame has named the eye yet");
        return check.result;
    }
    write_struct(out, &y->plan, sizeof y->plan);
    if (out_reasons) {
        *out_reasons = y->reasons;
    }
    return VELUM_OK;
}

static velum_result VELUM_CALL set_plan(velum_eye *handle, const velum_plan *plan) {
    OBJECT(eye, y, handle, HANDLE_EYE, "set_plan")
    return plan_impose(y, plan);
}

static velum_result VELUM_CALL get_stats(velum_view *handle, velum_view_stats *out) {
    OBJECT(view, v, handle, HANDLE_VIEW, "get_stats")
    checker check = {&v->eye->e->sink, v->name, "get_stats", VELUM_OK};
    if (!check_out(&check, "out", out, V1_VIEW_STATS)) {
        return check.result;
    }
    if (!v->has_stats) {
        return VELUM_UNCHANGED;
    }
    write_struct(out, &v->stats, sizeof v->stats);
    return VELUM_OK;
}

static velum_result VELUM_CALL get_volume(velum_view *handle, void *reserved) {
    OBJECT(view, v, handle, HANDLE_VIEW, "get_volume")
    (void)reserved;
    return log_fail(&v->eye->e->sink, VELUM_ERROR_UNSUPPORTED, v->name, "get_volume: reserved");
}

const velum_engine_api velum_engine_table = {.struct_size = sizeof velum_engine_table,
                                             .destroy = destroy,
                                             .complete = complete,
                                             .create_eye = create_eye,
                                             .destroy_eye = destroy_eye,
                                             .create_view = create_view,
                                             .destroy_view = destroy_view,
                                             .create_shadow = create_shadow,
                                             .destroy_shadow = destroy_shadow,
                                             .begin_frame = begin_frame,
                                             .end_frame = end_frame,
                                             .get_shadow_geometry = get_shadow_geometry,
                                             .get_plan = get_plan,
                                             .set_plan = set_plan,
                                             .get_stats = get_stats,
                                             .get_volume = get_volume};
