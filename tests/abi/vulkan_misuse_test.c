/* "velum.vulkan/1" on a lent device: frames out of order, serials that go backward, objects destroyed while the device
 * may still use them. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "misuse.h"
#include "vulkan_device.h"

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
enum { WIDTH = 32, HEIGHT = 16 };

static test_host host;
static vulkan_device device;
static bool has_device;
static char reason[256];

typedef struct fixture {
    velum_world *world;
    velum_engine *engine;
    velum_eye *eye;
    velum_view *view;
    velum_shadow *shadow;
    velum_vulkan_lend lend;
    velum_vulkan_images images;
    velum_frame_info frame;
    velum_eye_frame eye_frame;
    velum_view_frame view_frame;
    velum_shadow_frame shadow_frame;
    VkCommandBuffer commands;
} fixture;

static void fixture_init(fixture *f) {
    *f = (fixture){.eye = NULL};
    f->world = test_host_create_world(&host, 1);
    assert_non_null(f->world);
    assert_true(test_host_commit_overcast(&host, f->world, 0.6f) > 0);
    f->lend = vulkan_device_lend(&device, &host, f->world);
    assert_true(host.vulkan->create_engine(&f->lend, &f->engine) >= 0);
    velum_eye_desc eye = {.struct_size = sizeof eye, .quality = VELUM_QUALITY_LOW};
    velum_view_desc view = {.struct_size = sizeof view, .width = WIDTH, .height = HEIGHT};
    velum_shadow_desc shadow = {.struct_size = sizeof shadow, .levels = 1, .texels = 64};
    assert_int_equal(host.engine->create_eye(f->engine, &eye, &f->eye), VELUM_OK);
    assert_int_equal(host.engine->create_view(f->eye, &view, &f->view), VELUM_OK);
    assert_int_equal(host.engine->create_shadow(f->engine, &shadow, &f->shadow), VELUM_OK);
    assert_true(vulkan_device_images(&device, WIDTH, HEIGHT, &f->images));
    f->frame = test_frame_info();
    f->frame.submit_serial = 1;
    f->view_frame = test_view_frame();
    f->eye_frame = (velum_eye_frame){.struct_size = sizeof f->eye_frame, .eye = f->eye};
    memcpy(f->eye_frame.position_ecef_m, f->view_frame.position_ecef_m, sizeof f->eye_frame.position_ecef_m);
    f->shadow_frame = (velum_shadow_frame){.struct_size = sizeof f->shadow_frame};
    memcpy(f->shadow_frame.centre_ecef_m, f->view_frame.position_ecef_m, sizeof f->shadow_frame.centre_ecef_m);
    test_log_clear(&host.log);
}

static void fixture_finish(fixture *f) {
    assert_int_equal(host.engine->complete(f->engine, f->frame.submit_serial), VELUM_OK);
    assert_int_equal(host.engine->destroy_shadow(f->shadow), VELUM_OK);
    assert_int_equal(host.engine->destroy_view(f->view), VELUM_OK);
    assert_int_equal(host.engine->destroy_eye(f->eye), VELUM_OK);
    assert_int_equal(host.engine->destroy(f->engine), VELUM_OK);
    assert_int_equal(host.world->destroy(f->world), VELUM_OK);
}

#define FIXTURE(f)                                                                                                     \
    if (!has_device) {                                                                                                 \
        print_message("%s\n", reason);                                                                                 \
        skip();                                                                                                        \
    }                                                                                                                  \
    fixture f;                                                                                                         \
    fixture_init(&f);

static velum_result record_shared(fixture *f) {
    return host.vulkan->record_shared(f->engine, f->commands, &f->eye_frame, 1, 0);
}

static velum_result record_view(fixture *f) {
    return host.vulkan->record_view(f->view, f->commands, &f->view_frame, &f->images);
}

static velum_result record_shadow(fixture *f) {
    return host.vulkan->record_shadow(f->shadow, f->commands, &f->shadow_frame);
}

/* A frame that is recorded, submitted and done. */
static void whole_frame(fixture *f) {
    f->commands = vulkan_device_begin(&device, 0);
    assert_int_equal(host.engine->begin_frame(f->engine, &f->frame), VELUM_OK);
    assert_true(record_shared(f) >= 0);
    assert_true(record_view(f) >= 0);
    assert_true(record_shadow(f) >= 0);
    assert_int_equal(host.engine->end_frame(f->engine), VELUM_OK);
    assert_true(vulkan_device_submit(&device, 0) && vulkan_device_wait(&device, 0));
}

static void requirements_are_stated(void **state) {
    (void)state;
    velum_vulkan_requirements needed = {.struct_size = sizeof needed};
    assert_int_equal(host.vulkan->get_requirements(&needed), VELUM_OK);
    assert_true(needed.api_version >= VK_API_VERSION_1_3);
    assert_true(needed.features && needed.features11 && needed.features12 && needed.features13);
    assert_true(needed.features11->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_FEATURES);
    assert_true(needed.features12->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES);
    assert_true(needed.features13->sType == VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
    assert_true(needed.instance_extension_count == 0 || needed.instance_extensions);
    assert_true(needed.device_extension_count == 0 || needed.device_extensions);
    for (uint32_t size = 0; size < sizeof needed; size++) {
        needed.struct_size = size;
        assert_int_equal(host.vulkan->get_requirements(&needed), VELUM_ERROR_STRUCT_SIZE);
    }
    assert_int_equal(host.vulkan->get_requirements(NULL), VELUM_ERROR_ARGUMENT);
    char text[16] = "";
    assert_true(host.vulkan->check_device(NULL, VK_NULL_HANDLE, VK_NULL_HANDLE, text, sizeof text) < 0);
    assert_true(host.vulkan->check_device(NULL, VK_NULL_HANDLE, VK_NULL_HANDLE, NULL, 0) < 0);
    assert_true(memchr(text, '\0', sizeof text) != NULL);
}

static velum_result call_create(void *context) {
    fixture *f = context;
    velum_engine *engine = NULL;
    velum_result result = host.vulkan->create_engine(&f->lend, &engine);
    return result >= 0 ? host.engine->destroy(engine) : result;
}

static void lent_devices_are_checked(void **state) {
    (void)state;
    FIXTURE(f);
    misuse m = {.host = &host, .call_name = "create_engine", .call = call_create, .context = &f};
    m.silent_size = true; /* a struct of unknown size holds no log */
    misuse_expect_ok(&m, "the device as it is");
    misuse_struct(&m, &f.lend, sizeof f.lend, true, 0);
    velum_vulkan_lend lend = f.lend;
    f.lend.world = NULL;
    misuse_expect(&m, VELUM_ERROR_HANDLE, "");
    f.lend = lend;
    f.lend.get_instance_proc_addr = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "get_instance_proc_addr");
    f.lend = lend;
    f.lend.instance = VK_NULL_HANDLE;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "instance");
    f.lend = lend;
    f.lend.physical_device = VK_NULL_HANDLE;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "physical_device");
    f.lend = lend;
    f.lend.device = VK_NULL_HANDLE;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "device");
    f.lend = lend;
    f.lend.api_version = VK_API_VERSION_1_2;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "api_version");
    f.lend = lend;
    f.lend.queue_family = 1000;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "queue_family");
    f.lend = lend;
    static const uint32_t in_flight[] = {0, 5, UINT32_MAX};
    for (size_t i = 0; i < COUNT(in_flight); i++) {
        f.lend.frames_in_flight = in_flight[i];
        misuse_expect(&m, VELUM_ERROR_ARGUMENT, "frames_in_flight");
    }
    f.lend = lend;
    f.lend.enabled_extension_count = 1;
    f.lend.enabled_extensions = NULL;
    misuse_expect(&m, VELUM_ERROR_ARGUMENT, "enabled_extensions");
    f.lend = lend;
    /* A foreign or broken cache is no error: it is left alone. */
    static const uint8_t garbage[256] = {32, 0, 0, 0, 1, 0, 0, 0, 0xff, 0xff};
    f.lend.pipeline_cache = garbage;
    /* About the header's 32 bytes (VkPipelineCacheHeaderVersionOne), which the first four name as its length. */
    static const uint64_t sizes[] = {0, 31, 32, 33, sizeof garbage};
    for (size_t i = 0; i < COUNT(sizes); i++) {
        f.lend.pipeline_cache_size = sizes[i];
        misuse_expect_ok(&m, "a foreign cache");
    }
    f.lend = lend;
    assert_int_equal(m.wrong, 0);
    velum_engine *engine = NULL;
    test_log_clear(&host.log);
    assert_int_equal(host.vulkan->create_engine(NULL, &engine), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->create_engine(&f.lend, NULL), VELUM_ERROR_ARGUMENT);
    fixture_finish(&f);
}

static void the_pipeline_cache_comes_out_and_goes_in(void **state) {
    (void)state;
    FIXTURE(f);
    uint64_t size = 0;
    assert_int_equal(host.vulkan->get_pipeline_cache(f.engine, NULL, &size), VELUM_OK);
    assert_true(size >= 32);
    uint8_t *blob = calloc(1, size);
    assert_non_null(blob);
    uint64_t written = size;
    assert_true(host.vulkan->get_pipeline_cache(f.engine, blob, &written) >= 0);
    assert_true(written > 0 && written <= size);
    f.lend.pipeline_cache = blob;
    misuse m = {.host = &host, .call_name = "create_engine", .call = call_create, .context = &f};
    const uint64_t parts[] = {written, written / 2, 1}; /* whole, then cut short */
    for (size_t i = 0; i < COUNT(parts); i++) {
        f.lend.pipeline_cache_size = parts[i];
        misuse_expect_ok(&m, "a cache");
    }
    /* Too little room: an error or fewer bytes, never more. */
    uint8_t small[64];
    memset(small, 0xcd, sizeof small);
    uint64_t room = 40;
    host.vulkan->get_pipeline_cache(f.engine, small, &room);
    for (size_t i = 40; i < sizeof small; i++) {
        assert_int_equal(small[i], 0xcd);
    }
    assert_int_equal(m.wrong, 0);
    free(blob);
    fixture_finish(&f);
}

static void frames_have_an_order(void **state) {
    (void)state;
    FIXTURE(f);
    velum_shadow_geometry geometry = {.struct_size = sizeof geometry};
    f.commands = vulkan_device_begin(&device, 0);
    /* Before a frame. */
    assert_int_equal(host.engine->end_frame(f.engine), VELUM_ERROR_STATE);
    assert_int_equal(record_shared(&f), VELUM_ERROR_STATE);
    assert_int_equal(record_view(&f), VELUM_ERROR_STATE);
    assert_int_equal(record_shadow(&f), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->get_shadow_geometry(f.shadow, &geometry), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 5);
    /* In a frame, before what is shared. */
    assert_int_equal(host.engine->begin_frame(f.engine, &f.frame), VELUM_OK);
    test_log_clear(&host.log);
    assert_int_equal(host.engine->begin_frame(f.engine, &f.frame), VELUM_ERROR_STATE);
    assert_int_equal(record_view(&f), VELUM_ERROR_STATE);
    assert_int_equal(record_shadow(&f), VELUM_ERROR_STATE);
    /* [control] has no place in a frame. */
    velum_plan plan = {.struct_size = sizeof plan};
    assert_int_equal(host.engine->destroy_view(f.view), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->destroy_shadow(f.shadow), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->destroy_eye(f.eye), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->set_plan(f.eye, &plan), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->set_plan(f.eye, NULL), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->complete(f.engine, 0), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 10);
    assert_int_equal(host.vulkan->record_shared(f.engine, NULL, &f.eye_frame, 1, 0), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->record_shared(f.engine, f.commands, NULL, 1, 0), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->record_shared(f.engine, f.commands, &f.eye_frame, 1, 4), VELUM_ERROR_STRUCT_SIZE);
    velum_eye_frame twice[2] = {f.eye_frame, f.eye_frame};
    assert_true(host.vulkan->record_shared(f.engine, f.commands, twice, 2, 0) < 0);
    assert_true(record_shared(&f) >= 0);
    /* Once each. */
    test_log_clear(&host.log);
    assert_int_equal(record_shared(&f), VELUM_ERROR_STATE);
    assert_int_equal(host.vulkan->record_view(f.view, NULL, &f.view_frame, &f.images), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->record_view(f.view, f.commands, NULL, &f.images), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->record_view(f.view, f.commands, &f.view_frame, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->record_shadow(f.shadow, NULL, &f.shadow_frame), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.vulkan->record_shadow(f.shadow, f.commands, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 6);
    velum_vulkan_images images = f.images;
    f.images.luminance = VK_NULL_HANDLE;
    assert_int_equal(record_view(&f), VELUM_ERROR_ARGUMENT);
    f.images = images;
    f.images.transmittance = VK_NULL_HANDLE;
    assert_int_equal(record_view(&f), VELUM_ERROR_ARGUMENT);
    f.images = images;
    f.images.format = VK_FORMAT_R8G8B8A8_UNORM;
    assert_int_equal(record_view(&f), VELUM_ERROR_ARGUMENT);
    f.images = images;
    f.images.width = WIDTH - 1;
    assert_int_equal(record_view(&f), VELUM_ERROR_ARGUMENT);
    f.images = images;
    f.images.flags = 1;
    assert_int_equal(record_view(&f), VELUM_ERROR_FLAGS);
    f.images = images;
    f.images.reserved = 1;
    assert_int_equal(record_view(&f), VELUM_ERROR_FLAGS);
    f.images = images;
    f.images.struct_size = 32;
    assert_int_equal(record_view(&f), VELUM_ERROR_STRUCT_SIZE);
    f.images = images;
    f.view_frame.array_layer = 1; /* of images without layers */
    assert_int_equal(record_view(&f), VELUM_ERROR_ARGUMENT);
    f.view_frame.array_layer = 0;
    static const uint32_t outside[][4] = {{1, 0, WIDTH, HEIGHT},     {0, 1, WIDTH, HEIGHT}, {0, 0, WIDTH + 1, HEIGHT},
                                          {0, 0, WIDTH, HEIGHT + 1}, {WIDTH, 0, 1, 1},      {UINT32_MAX, 0, 16, 8},
                                          {0, UINT32_MAX, 16, 8},    {2, 2, UINT32_MAX, 8}};
    velum_view_frame view_frame = f.view_frame;
    for (size_t i = 0; i < COUNT(outside); i++) {
        f.view_frame.x = outside[i][0];
        f.view_frame.y = outside[i][1];
        f.view_frame.width = outside[i][2];
        f.view_frame.height = outside[i][3];
        assert_int_equal(record_view(&f), VELUM_ERROR_ARGUMENT);
    }
    f.view_frame = view_frame;
    assert_int_equal(host.log.failures, 14 + COUNT(outside));
    /* After all that the frame is as whole as before. */
    assert_true(record_view(&f) >= 0);
    assert_int_equal(record_view(&f), VELUM_ERROR_STATE);
    assert_true(record_shadow(&f) >= 0);
    assert_int_equal(host.engine->end_frame(f.engine), VELUM_OK);
    assert_int_equal(host.engine->end_frame(f.engine), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->get_shadow_geometry(f.shadow, &geometry), VELUM_OK);
    assert_true(vulkan_device_submit(&device, 0) && vulkan_device_wait(&device, 0));
    fixture_finish(&f);
}

static void serials_only_rise(void **state) {
    (void)state;
    FIXTURE(f);
    f.frame.submit_serial = 0;
    assert_int_equal(host.engine->begin_frame(f.engine, &f.frame), VELUM_ERROR_ARGUMENT);
    f.frame.submit_serial = 5;
    f.frame.completed_serial = 5;
    assert_int_equal(host.engine->begin_frame(f.engine, &f.frame), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.engine->begin_frame(f.engine, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.log.failures, 3);
    f.frame.completed_serial = 0;
    whole_frame(&f);
    test_log_clear(&host.log);
    for (uint64_t serial = 4; serial <= 5; serial++) {
        f.frame.submit_serial = serial;
        assert_int_equal(host.engine->begin_frame(f.engine, &f.frame), VELUM_ERROR_ARGUMENT);
    }
    assert_int_equal(host.log.failures, 2);
    assert_int_equal(host.engine->complete(f.engine, 5), VELUM_OK);
    assert_int_equal(host.engine->complete(f.engine, 4), VELUM_ERROR_ARGUMENT);
    f.frame.submit_serial = 6;
    f.frame.completed_serial = 5;
    whole_frame(&f);
    fixture_finish(&f);
}

static void what_is_in_flight_stays(void **state) {
    (void)state;
    FIXTURE(f);
    whole_frame(&f);
    /* The plugin has not been told that the device is done. */
    velum_view_stats stats = {.struct_size = sizeof stats};
    assert_int_equal(host.engine->get_stats(f.view, &stats), VELUM_UNCHANGED);
    assert_int_equal(host.engine->destroy_shadow(f.shadow), VELUM_OK); /* device objects live on */
    assert_int_equal(host.engine->destroy_view(f.view), VELUM_OK);
    assert_int_equal(host.engine->destroy_eye(f.eye), VELUM_OK);
    test_log_clear(&host.log);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 2);
    assert_int_equal(host.world->destroy(f.world), VELUM_ERROR_STATE);
    assert_int_equal(host.engine->complete(f.engine, 1), VELUM_OK);
    assert_int_equal(host.engine->destroy(f.engine), VELUM_OK);
    assert_int_equal(host.world->destroy(f.world), VELUM_OK);
}

/* More frames than were announced: refused, and possible again once the oldest has completed. */
static void frames_in_flight_are_counted(void **state) {
    (void)state;
    FIXTURE(f);
    for (uint64_t serial = 1; serial <= VULKAN_DEVICE_SLOTS; serial++) {
        f.frame.submit_serial = serial;
        whole_frame(&f);
    }
    f.frame.submit_serial = VULKAN_DEVICE_SLOTS + 1;
    test_log_clear(&host.log);
    assert_int_equal(host.engine->begin_frame(f.engine, &f.frame), VELUM_ERROR_STATE);
    assert_int_equal(host.log.failures, 1);
    f.frame.completed_serial = 1;
    whole_frame(&f);
    fixture_finish(&f);
}

static void figures_come_with_completion(void **state) {
    (void)state;
    FIXTURE(f);
    whole_frame(&f);
    assert_int_equal(host.engine->complete(f.engine, 1), VELUM_OK);
    velum_view_stats stats = {.struct_size = sizeof stats};
    assert_true(host.engine->get_stats(f.view, &stats) >= 0);
    assert_int_equal(stats.frame, 1);
    assert_true(stats.rays > 0 && stats.rays <= WIDTH * HEIGHT * 2);
    assert_in_range(stats.weather_bytes, 1, 64u << 20);
    assert_true(stats.view_bytes > 0);
    fixture_finish(&f);
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    has_device = vulkan_device_open(&device, &host, reason);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(requirements_are_stated),
        cmocka_unit_test(lent_devices_are_checked),
        cmocka_unit_test(the_pipeline_cache_comes_out_and_goes_in),
        cmocka_unit_test(frames_have_an_order),
        cmocka_unit_test(serials_only_rise),
        cmocka_unit_test(what_is_in_flight_stays),
        cmocka_unit_test(frames_in_flight_are_counted),
        cmocka_unit_test(figures_come_with_completion),
    };
    int failed = cmocka_run_group_tests_name("abi vulkan misuse", tests, NULL, NULL);
    if (has_device) {
        vulkan_device_close(&device);
    }
    test_host_close(&host);
    return failed;
}
