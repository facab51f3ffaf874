#include "engine_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static void prepare_frame(engine_fixture *f) {
    f->frame = test_frame_info();
    f->view_frame = test_view_frame();
    f->eye_frame = (velum_eye_frame){.struct_size = sizeof f->eye_frame, .eye = f->eye};
    memcpy(f->eye_frame.position_ecef_m, f->view_frame.position_ecef_m, sizeof f->eye_frame.position_ecef_m);
    f->shadow_frame = (velum_shadow_frame){.struct_size = sizeof f->shadow_frame};
    memcpy(f->shadow_frame.centre_ecef_m, f->view_frame.position_ecef_m, sizeof f->shadow_frame.centre_ecef_m);
    f->pixels = (velum_pixels){.struct_size = sizeof f->pixels,
                               .view = f->view,
                               .frame = &f->view_frame,
                               .luminance_rgb = f->luminance,
                               .transmittance_rgb = f->transmittance,
                               .distance_m = f->distance,
                               .width = FIXTURE_WIDTH,
                               .height = FIXTURE_HEIGHT};
    f->eye_count = f->view_count = 1;
    f->eye_stride = f->view_stride = 0;
}

bool engine_fixture_init(engine_fixture *f, test_host *host) {
    *f = (engine_fixture){.host = host,
                          .eye_desc = {.struct_size = sizeof f->eye_desc, .quality = VELUM_QUALITY_LOW},
                          .view_desc = {.struct_size = sizeof f->view_desc,
                                        .width = FIXTURE_WIDTH,
                                        .height = FIXTURE_HEIGHT,
                                        .name = "view"},
                          .shadow_desc = {.struct_size = sizeof f->shadow_desc, .levels = 1, .texels = FIXTURE_TEXELS}};
    f->world = test_host_create_world(host, 1);
    assert_non_null(f->world);
    assert_true(test_host_commit_overcast(host, f->world, 0.6f) > 0);
    f->engine = test_host_create_engine(host, f->world);
    if (!f->engine) {
        assert_int_equal(host->world->destroy(f->world), VELUM_OK);
        return false;
    }
    assert_int_equal(host->engine->create_eye(f->engine, &f->eye_desc, &f->eye), VELUM_OK);
    assert_int_equal(host->engine->create_view(f->eye, &f->view_desc, &f->view), VELUM_OK);
    assert_int_equal(host->engine->create_shadow(f->engine, &f->shadow_desc, &f->shadow), VELUM_OK);
    f->luminance = calloc(FIXTURE_PIXELS * 3, sizeof(float));
    f->transmittance = calloc(FIXTURE_PIXELS * 3, sizeof(float));
    f->distance = calloc(FIXTURE_PIXELS, sizeof(float));
    f->shadow_count = FIXTURE_TEXELS * FIXTURE_TEXELS;
    f->shadow_map = calloc(f->shadow_count, sizeof(float));
    assert_true(f->luminance && f->transmittance && f->distance && f->shadow_map);
    prepare_frame(f);
    return true;
}

void engine_fixture_finish(engine_fixture *f) {
    assert_int_equal(f->host->engine->destroy_shadow(f->shadow), VELUM_OK);
    assert_int_equal(f->host->engine->destroy_view(f->view), VELUM_OK);
    assert_int_equal(f->host->engine->destroy_eye(f->eye), VELUM_OK);
    assert_int_equal(f->host->engine->destroy(f->engine), VELUM_OK);
    assert_int_equal(f->host->world->destroy(f->world), VELUM_OK);
    free(f->luminance);
    free(f->transmittance);
    free(f->distance);
    free(f->shadow_map);
}

velum_result engine_fixture_render(void *context) {
    engine_fixture *f = context;
    return f->host->standalone->render(f->engine, &f->frame, &f->eye_frame, f->eye_count, f->eye_stride, &f->pixels,
                                       f->view_count, f->view_stride);
}

velum_result engine_fixture_shadow(void *context) {
    engine_fixture *f = context;
    return f->host->standalone->render_shadow(f->engine, &f->frame, f->shadow, &f->shadow_frame, f->shadow_map,
                                              f->shadow_count);
}

misuse engine_fixture_misuse(engine_fixture *f, const char *name, misuse_call call) {
    return (misuse){.host = f->host, .call_name = name, .call = call, .context = f};
}
