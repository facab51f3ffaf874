#include "fixture.h"
#include "plugin/engine.h"
#include "plugin/handle.h"

uint64_t fixture_pages_uploaded(velum_engine *handle) {
    engine *e = handle_get(handle, HANDLE_ENGINE);
    assert_non_null(e);
    return e->pages.uploaded;
}

bool fixture_is_bare(velum_engine *handle) {
    engine *e = handle_get(handle, HANDLE_ENGINE);
    assert_non_null(e);
    return e->eye_count == 0 && e->shadow_count == 0;
}

uint64_t fixture_weather_bytes(velum_engine *handle) {
    engine *e = handle_get(handle, HANDLE_ENGINE);
    assert_non_null(e);
    return engine_weather_bytes(e);
}

uint64_t fixture_view_bytes(velum_view *handle) {
    view *v = handle_get(handle, HANDLE_VIEW);
    assert_non_null(v);
    return v->bytes;
}

uint64_t fixture_shadow_texels(velum_shadow *handle) {
    shadow *s = handle_get(handle, HANDLE_SHADOW);
    assert_non_null(s);
    return s->texels_drawn;
}

uint32_t fixture_skies_drawn(velum_eye *handle) {
    eye *y = handle_get(handle, HANDLE_EYE);
    assert_non_null(y);
    return y->sky_count;
}

bool fixture_weather_is_uneven(velum_eye *handle) {
    eye *y = handle_get(handle, HANDLE_EYE);
    assert_non_null(y);
    return y->tiles.uneven;
}

uint32_t fixture_limit_texels(velum_engine *handle, uint32_t most) {
    engine *e = handle_get(handle, HANDLE_ENGINE);
    assert_non_null(e);
    const uint32_t held = e->g.properties.limits.maxTexelBufferElements;
    e->g.properties.limits.maxTexelBufferElements = most;
    return held;
}

void fixture_forget_timestamps(velum_engine *handle) {
    engine *e = handle_get(handle, HANDLE_ENGINE);
    assert_non_null(e);
    e->g.has_timestamps = false;
}
