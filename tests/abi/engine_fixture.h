/* A standalone engine with an eye, a view and a shadow map, and everything that its functions may be given. */
#ifndef TESTS_ABI_ENGINE_FIXTURE_H
#define TESTS_ABI_ENGINE_FIXTURE_H

#include "misuse.h"

enum { FIXTURE_WIDTH = 32, FIXTURE_HEIGHT = 16, FIXTURE_PIXELS = FIXTURE_WIDTH * FIXTURE_HEIGHT, FIXTURE_TEXELS = 64 };

typedef struct engine_fixture {
    test_host *host;
    velum_world *world;
    velum_engine *engine;
    velum_eye *eye;
    velum_view *view;
    velum_shadow *shadow;
    velum_eye_desc eye_desc;
    velum_view_desc view_desc;
    velum_shadow_desc shadow_desc;
    velum_frame_info frame;
    velum_eye_frame eye_frame;
    velum_view_frame view_frame;
    velum_shadow_frame shadow_frame;
    velum_pixels pixels;
    uint32_t eye_count, eye_stride, view_count, view_stride;
    float *luminance, *transmittance, *distance, *shadow_map;
    uint64_t shadow_count;
    velum_plan plan;
} engine_fixture;

/* False: no Vulkan device; the host's log says why. */
bool engine_fixture_init(engine_fixture *f, test_host *host);
void engine_fixture_finish(engine_fixture *f);
misuse engine_fixture_misuse(engine_fixture *f, const char *name, misuse_call call);

/* misuse_calls; context: the fixture. */
velum_result engine_fixture_render(void *context);
velum_result engine_fixture_shadow(void *context);

/* At the head of a test that needs a device. */
#define ENGINE_FIXTURE(f)                                                                                              \
    engine_fixture f;                                                                                                  \
    if (!engine_fixture_init(&f, &host)) {                                                                             \
        print_message("no Vulkan device: %s\n", host.log.message);                                                     \
        skip();                                                                                                        \
    }

#endif
