/* "velum.engine/1" and "velum.standalone/1" in the hands of a careless host, and several engines beside each other. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "engine_fixture.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static test_host host;

static velum_result call_set_plan(void *context) {
    engine_fixture *f = context;
    return host.engine->set_plan(f->eye, &f->plan);
}

static velum_result call_create_eye(void *context) {
    engine_fixture *f = context;
    velum_eye *eye = NULL;
    velum_result result = host.engine->create_eye(f->engine, &f->eye_desc, &eye);
    return result >= 0 ? host.engine->destroy_eye(eye) : result;
}

static velum_result call_create_view(void *context) {
    engine_fixture *f = context;
    velum_view *view = NULL;
    velum_result result = host.engine->create_view(f->eye, &f->view_desc, &view);
    return result >= 0 ? host.engine->destroy_view(view) : result;
}

static velum_result call_create_shadow(void *context) {
    engine_fixture *f = context;
    velum_shadow *shadow = NULL;
    velum_result result = host.engine->create_shadow(f->engine, &f->shadow_desc, &shadow);
    return result >= 0 ? host.engine->destroy_shadow(shadow) : result;
}

static void engines_are_made_of_sound_descriptions(void **state) {
    (void)state;
    velum_world *world = test_host_create_world(&host, 1);
    velum_engine *engine = NULL;
    velum_standalone_desc desc = {.struct_size = sizeof desc,
                                  .world = world,
                                  .log = test_log_write,
                                  .log_context = &host.log,
                                  .device = VELUM_DEVICE_AUTO};
    assert_int_equal(host.standalone->create_engine(NULL, &engine), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.standalone->create_engine(&desc, NULL), VELUM_ERROR_ARGUMENT);
    for (uint32_t size = 0; size < sizeof desc; size++) {
        desc.struct_size = size;
        assert_int_equal(host.standalone->create_engine(&desc, &engine), VELUM_ERROR_STRUCT_SIZE);
    }
    desc.struct_size = sizeof desc;
    test_log_clear(&host.log);
    desc.flags = 0x10;
    assert_int_equal(host.standalone->create_engine(&desc, &engine), VELUM_ERROR_FLAGS);
    desc.flags = 0;
    desc.reserved = 1;
    assert_int_equal(host.standalone->create_engine(&desc, &engine), VELUM_ERROR_FLAGS);
    desc.reserved = 0;
    desc.world = NULL;
    assert_int_equal(host.standalone->create_engine(&desc, &engine), VELUM_ERROR_HANDLE);
    desc.world = (velum_world *)&desc;
    assert_int_equal(host.standalone->create_engine(&desc, &engine), VELUM_ERROR_HANDLE);
    desc.world = world;
    desc.device = -3;
    assert_int_equal(host.standalone->create_engine(&desc, &engine), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 5);
    desc.device = 1000; /* out of range, or there is no Vulkan at all */
    velum_result result = host.standalone->create_engine(&desc, &engine);
    assert_true(result == VELUM_ERROR_ARGUMENT || result == VELUM_ERROR_UNSUPPORTED);
    assert_int_equal(host.log.failures, 6);
    assert_null(engine);
    assert_int_equal(host.world->destroy(world), VELUM_OK);
}

static void objects_are_made_of_sound_descriptions(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    misuse eye = engine_fixture_misuse(&f, "create_eye", call_create_eye);
    misuse_expect_ok(&eye, "the eye as it is");
    misuse_struct(&eye, &f.eye_desc, sizeof f.eye_desc, true, VELUM_EYE_STUDY);
    static const field_rule eye_rules[] = {RULE_RESERVED(velum_eye_desc, reserved, FIELD_U32)};
    misuse_rules(&eye, &f.eye_desc, eye_rules, COUNT(eye_rules), true);
    static const int32_t qualities[] = {INT32_MIN, -1, 6, INT32_MAX};
    for (size_t i = 0; i < COUNT(qualities); i++) {
        f.eye_desc.quality = qualities[i];
        misuse_expect(&eye, VELUM_ERROR_ARGUMENT, "quality");
    }
    f.eye_desc.quality = VELUM_QUALITY_LOW;
    const float budgets[] = {1e-4f, 10001.0f, -1.0f, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT(budgets); i++) {
        f.eye_desc.budget_ms = budgets[i];
        misuse_expect(&eye, VELUM_ERROR_ARGUMENT, "budget_ms");
        f.eye_desc.budget_ms = 1.0f;
        f.eye_desc.budget_error = budgets[i];
        misuse_expect(&eye, VELUM_ERROR_ARGUMENT, "budget_error");
        f.eye_desc.budget_ms = 0.0f;
        misuse_expect(&eye, VELUM_ERROR_ARGUMENT, "budget_error");
        f.eye_desc.budget_error = 0.0f;
    }
    const float sound[][2] = {{0.001f, 0.0f}, {10000.0f, 0.0f}, {0.0f, 0.001f}, {0.0f, 1.0f}, {5.0f, 0.15f}};
    for (size_t i = 0; i < COUNT(sound); i++) {
        f.eye_desc.budget_ms = sound[i][0];
        f.eye_desc.budget_error = sound[i][1];
        misuse_expect_ok(&eye, "an eye with budgets");
        f.eye_desc.quality = VELUM_QUALITY_REFERENCE;
        misuse_expect(&eye, VELUM_ERROR_ARGUMENT, sound[i][0] > 0.0f ? "budget_ms" : "budget_error");
        f.eye_desc.quality = VELUM_QUALITY_LOW;
    }
    f.eye_desc.budget_ms = f.eye_desc.budget_error = 0.0f;

    misuse view = engine_fixture_misuse(&f, "create_view", call_create_view);
    misuse_struct(&view, &f.view_desc, sizeof f.view_desc, true, 0);
    static const uint32_t sizes[] = {0, 8193, UINT32_MAX};
    for (size_t i = 0; i < COUNT(sizes); i++) {
        f.view_desc.width = sizes[i];
        misuse_expect(&view, VELUM_ERROR_ARGUMENT, "width");
        f.view_desc.width = FIXTURE_WIDTH;
        f.view_desc.height = sizes[i];
        misuse_expect(&view, VELUM_ERROR_ARGUMENT, "height");
        f.view_desc.height = FIXTURE_HEIGHT;
    }
    f.view_desc.width = f.view_desc.height = 1;
    misuse_expect_ok(&view, "one pixel");
    f.view_desc.name = NULL;
    misuse_expect_ok(&view, "no name");

    misuse shadow = engine_fixture_misuse(&f, "create_shadow", call_create_shadow);
    misuse_struct(&shadow, &f.shadow_desc, sizeof f.shadow_desc, true, 0);
    static const field_rule shadow_rules[] = {RULE_RESERVED(velum_shadow_desc, reserved, FIELD_U32)};
    misuse_rules(&shadow, &f.shadow_desc, shadow_rules, COUNT(shadow_rules), true);
    f.shadow_desc.levels = 5;
    misuse_expect(&shadow, VELUM_ERROR_ARGUMENT, "levels");
    f.shadow_desc.levels = 1;
    static const uint32_t texels[] = {1, 16, 63, 65, 72, 1025, 1040, UINT32_MAX};
    for (size_t i = 0; i < COUNT(texels); i++) {
        f.shadow_desc.texels = texels[i];
        misuse_expect(&shadow, VELUM_ERROR_ARGUMENT, "texels");
    }
    f.shadow_desc.texels = FIXTURE_TEXELS;
    const float extents[] = {-1.0f, 1.0f, 999.0f, 100001.0f, NAN, INFINITY, -INFINITY};
    for (size_t i = 0; i < COUNT(extents); i++) {
        f.shadow_desc.extent_m = extents[i];
        misuse_expect(&shadow, VELUM_ERROR_ARGUMENT, "extent_m");
    }
    f.shadow_desc.extent_m = 1000.0f;
    misuse_expect_ok(&shadow, "the shadow map as it is");
    assert_int_equal(eye.wrong + view.wrong + shadow.wrong, 0);

    velum_eye *no_eye = NULL;
    velum_view *no_view = NULL;
    velum_shadow *no_shadow = NULL;
    test_log_clear(&host.log);
    assert_int_equal(host.engine->create_eye(f.engine, NULL, &no_eye), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->create_eye(f.engine, &f.eye_desc, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->create_view(f.eye, NULL, &no_view), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->create_view(f.eye, &f.view_desc, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->create_shadow(f.engine, NULL, &no_shadow), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->create_shadow(f.engine, &f.shadow_desc, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 6);
    assert_true(!no_eye && !no_view && !no_shadow);
    engine_fixture_finish(&f);
}

/* Every function that takes an object, with everything that is not one of that type. */
static void what_is_no_object_is_found_out(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    velum_view *dead = NULL;
    assert_int_equal(host.engine->create_view(f.eye, &f.view_desc, &dead), VELUM_OK);
    assert_int_equal(host.engine->destroy_view(dead), VELUM_OK);
    static uint64_t foreign[64];
    void *const none[] = {
        NULL, (void *)(uintptr_t)1, (void *)UINTPTR_MAX, foreign, dead, f.world, f.engine, f.eye, f.view, f.shadow};
    const size_t world = 5, engine = 6, eye = 7, view = 8, shadow = 9;
    (void)world;
    velum_view_stats stats = {.struct_size = sizeof stats};
    velum_shadow_geometry geometry = {.struct_size = sizeof geometry};
    velum_vulkan_shadow image = {.struct_size = sizeof image};
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    uint64_t size = 0;
    for (size_t i = 0; i < COUNT(none); i++) {
        void *object = none[i];
        void *out = NULL;
        test_log_clear(&host.log);
        if (i != engine) {
            assert_int_equal(host.engine->complete(object, 1), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->create_eye(object, &f.eye_desc, (velum_eye **)&out), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->create_shadow(object, &f.shadow_desc, (velum_shadow **)&out),
                             VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->begin_frame(object, &f.frame), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->end_frame(object), VELUM_ERROR_HANDLE);
            assert_int_equal(host.standalone->render(object, &f.frame, &f.eye_frame, 1, 0, &f.pixels, 1, 0),
                             VELUM_ERROR_HANDLE);
            assert_int_equal(host.standalone->render_shadow(object, &f.frame, f.shadow, &f.shadow_frame, f.shadow_map,
                                                            f.shadow_count),
                             VELUM_ERROR_HANDLE);
            assert_int_equal(host.vulkan->get_pipeline_cache(object, NULL, &size), VELUM_ERROR_HANDLE);
            assert_int_equal(host.vulkan->record_shared(object, NULL, &f.eye_frame, 1, 0), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->destroy(object), object ? VELUM_ERROR_HANDLE : VELUM_OK);
        }
        if (i != eye) {
            assert_int_equal(host.engine->create_view(object, &f.view_desc, (velum_view **)&out), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->get_plan(object, &plan, &reasons), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->set_plan(object, NULL), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->destroy_eye(object), object ? VELUM_ERROR_HANDLE : VELUM_OK);
            f.eye_frame.eye = object;
            assert_int_equal(engine_fixture_render(&f), VELUM_ERROR_HANDLE);
            f.eye_frame.eye = f.eye;
        }
        if (i != view) {
            assert_int_equal(host.engine->get_stats(object, &stats), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->get_volume(object, NULL), VELUM_ERROR_HANDLE);
            velum_vulkan_images images = {.struct_size = sizeof images};
            assert_int_equal(host.vulkan->record_view(object, NULL, &f.view_frame, &images), VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->destroy_view(object), object ? VELUM_ERROR_HANDLE : VELUM_OK);
            f.pixels.view = object;
            assert_int_equal(engine_fixture_render(&f), VELUM_ERROR_HANDLE);
            f.pixels.view = f.view;
        }
        if (i != shadow) {
            assert_int_equal(host.engine->get_shadow_geometry(object, &geometry), VELUM_ERROR_HANDLE);
            assert_int_equal(host.vulkan->record_shadow(object, NULL, &f.shadow_frame), VELUM_ERROR_HANDLE);
            assert_int_equal(host.vulkan->get_shadow_image(object, &image), VELUM_ERROR_HANDLE);
            assert_int_equal(host.standalone->render_shadow(f.engine, &f.frame, object, &f.shadow_frame, f.shadow_map,
                                                            f.shadow_count),
                             VELUM_ERROR_HANDLE);
            assert_int_equal(host.engine->destroy_shadow(object), object ? VELUM_ERROR_HANDLE : VELUM_OK);
        }
        assert_null(out);
        assert_true(i < 5 || host.log.failures > 0);
    }
    assert_true(engine_fixture_render(&f) >= 0);
    engine_fixture_finish(&f);
}

static void objects_go_in_order(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    test_log_clear(&host.log);
    assert_int_equal(host.world->destroy(f.world), VELUM_ERROR_STATE); /* an engine shows it */
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->destroy_eye(f.eye), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 3);
    assert_true(engine_fixture_render(&f) >= 0); /* nothing was lost */
    assert_int_equal(host.engine->destroy_view(f.view), VELUM_OK);
    assert_int_equal(host.engine->destroy_view(f.view), VELUM_ERROR_HANDLE);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_STATE); /* an eye and a shadow map */
    assert_int_equal(host.engine->destroy_eye(f.eye), VELUM_OK);
    assert_int_equal(host.engine->destroy_eye(f.eye), VELUM_ERROR_HANDLE);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_STATE); /* a shadow map */
    assert_int_equal(host.engine->destroy_shadow(f.shadow), VELUM_OK);
    assert_int_equal(host.engine->destroy_shadow(f.shadow), VELUM_ERROR_HANDLE);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_OK);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_HANDLE);
    assert_int_equal(host.world->destroy(f.world), VELUM_OK);
    free(f.luminance);
    free(f.transmittance);
    free(f.distance);
    free(f.shadow_map);
}

/* A standalone engine makes its own frames. */
static void calls_in_the_wrong_state_change_nothing(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    velum_frame_info frame = f.frame;
    frame.submit_serial = 1;
    velum_view_stats stats = {.struct_size = sizeof stats};
    velum_shadow_geometry geometry = {.struct_size = sizeof geometry};
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    test_log_clear(&host.log);
    assert_int_equal(host.engine->begin_frame(f.engine, &frame), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->end_frame(f.engine), VELUM_ERROR_STATE);
    VkCommandBuffer commands = (VkCommandBuffer)(uintptr_t)&frame; /* never touched */
    velum_vulkan_images images = {.struct_size = sizeof images};
    assert_int_equal(host.vulkan->record_shared(f.engine, commands, &f.eye_frame, 1, 0), VELUM_ERROR_STATE);
    assert_int_equal(host.vulkan->record_view(f.view, commands, &f.view_frame, &images), VELUM_ERROR_STATE);
    assert_int_equal(host.vulkan->record_shadow(f.shadow, commands, &f.shadow_frame), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 5);

    assert_int_equal(host.engine->get_stats(f.view, &stats), VELUM_UNCHANGED);
    assert_int_equal(host.engine->get_shadow_geometry(f.shadow, &geometry), VELUM_ERROR_STATE);
    velum_result result = host.engine->get_plan(f.eye, &plan, &reasons);
    assert_true(result == VELUM_ERROR_STATE || result == VELUM_UNCHANGED);
    assert_int_equal(host.engine->get_volume(f.view, NULL), VELUM_ERROR_UNSUPPORTED);

    assert_true(engine_fixture_render(&f) >= 0);
    assert_true(engine_fixture_shadow(&f) >= 0);
    assert_true(host.engine->get_stats(f.view, &stats) >= 0);
    assert_true(stats.rays > 0);
    assert_int_equal(host.engine->get_shadow_geometry(f.shadow, &geometry), VELUM_OK);
    assert_int_equal(geometry.texels, FIXTURE_TEXELS);
    assert_int_equal(host.engine->get_plan(f.eye, &plan, &reasons), VELUM_OK);
    assert_true(reasons && reasons[0]);
    engine_fixture_finish(&f);
}

static void answers_are_checked(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    assert_true(engine_fixture_render(&f) >= 0);
    assert_true(engine_fixture_shadow(&f) >= 0);
    velum_view_stats stats = {.struct_size = 16};
    velum_shadow_geometry geometry = {.struct_size = 16};
    velum_vulkan_shadow image = {.struct_size = 4};
    velum_plan plan = {.struct_size = 16};
    const char *reasons = NULL;
    test_log_clear(&host.log);
    assert_int_equal(host.engine->get_stats(f.view, &stats), VELUM_ERROR_STRUCT_SIZE);
    assert_int_equal(host.engine->get_stats(f.view, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->get_shadow_geometry(f.shadow, &geometry), VELUM_ERROR_STRUCT_SIZE);
    assert_int_equal(host.engine->get_shadow_geometry(f.shadow, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->get_shadow_image(f.shadow, &image), VELUM_ERROR_STRUCT_SIZE);
    assert_int_equal(host.vulkan->get_shadow_image(f.shadow, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->get_plan(f.eye, &plan, &reasons), VELUM_ERROR_STRUCT_SIZE);
    assert_int_equal(host.engine->get_plan(f.eye, NULL, &reasons), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->get_pipeline_cache(f.engine, NULL, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 9);
    assert_null(reasons);

    /* A cache comes out whole or not at all. */
    uint64_t size = 0;
    assert_int_equal(host.vulkan->get_pipeline_cache(f.engine, NULL, &size), VELUM_OK);
    assert_true(size > 0);
    plan.struct_size = sizeof plan;
    assert_int_equal(host.engine->get_plan(f.eye, &plan, NULL), VELUM_OK);

    f.plan = plan;
    misuse m = engine_fixture_misuse(&f, "set_plan", call_set_plan);
    misuse_expect_ok(&m, "the plan as it was");
    /* As version 1 froze it. */
    const uint32_t frozen = offsetof(velum_plan, finer_rays);
    f.plan.struct_size = frozen;
    misuse_expect_ok(&m, "a plan of the first version");
    f.plan.struct_size = sizeof f.plan;
    misuse_struct(&m, &f.plan, frozen, true, VELUM_PLAN_STEP_THROUGH | VELUM_PLAN_BASE_SEARCH | VELUM_PLAN_LIGHT_ALL);
    static const field_rule rules[] = {
        RULE(velum_plan, step_m, FIELD_F32, -INFINITY, INFINITY),
        RULE(velum_plan, step_growth, FIELD_F32, 0, INFINITY),
        RULE(velum_plan, distance_m, FIELD_F32, 0, INFINITY),
        RULE(velum_plan, blending, FIELD_U32, 0, 1),
        RULE(velum_plan, finer_rays, FIELD_U32, 0, 1),
        RULE(velum_plan, finer_blocks, FIELD_U32, 0, 14),
        RULE(velum_plan, every_pixel, FIELD_U32, 0, 1),
        RULE(velum_plan, integrator, FIELD_U32, 0, VELUM_INTEGRATOR_TRAPEZOID),
        RULE(velum_plan, scattering, FIELD_U32, 0, VELUM_SCATTERING_VOLUME),
        RULE(velum_plan, sun_depth, FIELD_U32, 0, VELUM_SUN_DEPTH_MAP),
        RULE(velum_plan, long_step, FIELD_F32, 0, 64),
        RULE(velum_plan, thin_density, FIELD_F32, 0, 1),
        RULE(velum_plan, exit_transmittance, FIELD_F32, 0, 0.9),
        RULE(velum_plan, volume_cell_m, FIELD_F32, 0, 2000),
    };
    misuse_rules(&m, &f.plan, rules, COUNT(rules), false);
    static const uint32_t rates[] = {0, 3, 5, 12, 15, 17, 63, 65, 128, UINT32_MAX};
    for (size_t i = 0; i < COUNT(rates); i++) {
        f.plan.ray_rate = rates[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "ray_rate");
    }
    for (f.plan.ray_rate = 1; f.plan.ray_rate <= 64; f.plan.ray_rate *= 2) {
        misuse_expect_ok(&m, "ray_rate");
    }
    f.plan = plan;
    static const uint32_t standing_rates[] = {3, 17, 63, 65, 129, 255, 257, 512, UINT32_MAX};
    for (size_t i = 0; i < COUNT(standing_rates); i++) {
        f.plan.standing_ray_rate = standing_rates[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "standing_ray_rate");
    }
    f.plan = plan;
    f.plan.march_steps = UINT32_MAX;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "march_steps");
    f.plan = plan;
    f.plan.light_steps = UINT32_MAX;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "light_steps");
    f.plan = plan;
    f.plan.octaves = UINT32_MAX;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "octaves");
    f.plan = plan;
    f.plan.step_m = 0.0f;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "step_m");
    assert_int_equal(m.wrong, 0);
    assert_int_equal(host.engine->set_plan(f.eye, NULL), VELUM_OK);
    assert_true(engine_fixture_render(&f) >= 0);
    engine_fixture_finish(&f);
}

/* Two engines on two worlds: what one does cannot be seen in the other; objects of one are not the other's. */
static void engines_are_independent(void **state) {
    (void)state;
    ENGINE_FIXTURE(a);
    engine_fixture b;
    assert_true(engine_fixture_init(&b, &host));
    uint64_t clear = test_host_commit_overcast(&host, b.world, 0.0f);
    assert_true(clear > 0);
    a.eye_frame.flags = b.eye_frame.flags = VELUM_EYE_RESET;
    assert_true(engine_fixture_render(&a) >= 0);
    float *alone = calloc(FIXTURE_PIXELS * 3, sizeof(float));
    assert_non_null(alone);
    memcpy(alone, a.luminance, FIXTURE_PIXELS * 3 * sizeof(float));
    assert_true(engine_fixture_render(&b) >= 0);
    assert_true(memcmp(alone, b.luminance, FIXTURE_PIXELS * 3 * sizeof(float)) != 0);
    assert_true(engine_fixture_render(&a) >= 0);
    assert_memory_equal(alone, a.luminance, FIXTURE_PIXELS * 3 * sizeof(float));

    a.eye_frame.eye = b.eye;
    test_log_clear(&host.log);
    velum_result result = engine_fixture_render(&a);
    assert_true(result == VELUM_ERROR_HANDLE || result == VELUM_ERROR_ARGUMENT);
    a.eye_frame.eye = a.eye;
    a.pixels.view = b.view;
    result = engine_fixture_render(&a);
    assert_true(result < 0);
    a.pixels.view = a.view;
    result =
        host.standalone->render_shadow(a.engine, &a.frame, b.shadow, &a.shadow_frame, a.shadow_map, a.shadow_count);
    assert_true(result == VELUM_ERROR_HANDLE || result == VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 3);
    engine_fixture_finish(&b);
    assert_true(engine_fixture_render(&a) >= 0);
    assert_memory_equal(alone, a.luminance, FIXTURE_PIXELS * 3 * sizeof(float));
    free(alone);
    engine_fixture_finish(&a);
}

/* Several engines show one world; it goes last. */
static void engines_share_a_world(void **state) {
    (void)state;
    ENGINE_FIXTURE(f);
    velum_engine *second = test_host_create_engine(&host, f.world);
    assert_non_null(second);
    assert_int_equal(host.world->destroy(f.world), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->destroy(second), VELUM_OK);
    assert_int_equal(host.world->destroy(f.world), VELUM_ERROR_STATE);
    engine_fixture_finish(&f);
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(engines_are_made_of_sound_descriptions),
        cmocka_unit_test(objects_are_made_of_sound_descriptions),
        cmocka_unit_test(what_is_no_object_is_found_out),
        cmocka_unit_test(objects_go_in_order),
        cmocka_unit_test(calls_in_the_wrong_state_change_nothing),
        cmocka_unit_test(answers_are_checked),
        cmocka_unit_test(engines_are_independent),
        cmocka_unit_test(engines_share_a_world),
    };
    int failed = cmocka_run_group_tests_name("abi engine misuse", tests, NULL, NULL);
    test_host_close(&host);
    return failed;
}
