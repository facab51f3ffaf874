/* Finding a common version, and refusing what has none. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <string.h>

#include <cmocka.h>

#include "host.h"

static test_host host;

static velum_host_info host_info(uint32_t abi_min, uint32_t abi_max) {
    test_log_clear(&host.log);
    return (velum_host_info){.struct_size = sizeof(velum_host_info),
                             .abi_min = abi_min,
                             .abi_max = abi_max,
                             .name = "tests",
                             .log = test_log_write,
                             .log_context = &host.log};
}

static velum_plugin_info empty_info(void) {
    velum_plugin_info info;
    memset(&info, 0xcd, sizeof info);
    info.struct_size = sizeof info;
    return info;
}

static void the_highest_common_major_is_taken(void **state) {
    (void)state;
    static const struct {
        uint32_t abi_min, abi_max;
        velum_result result;
    } cases[] = {
        {1, 1, VELUM_OK},
        {1, 9, VELUM_OK}, /* a future host that still speaks 1 */
        {0, 1, VELUM_OK},
        {0, UINT32_MAX, VELUM_OK},
        {2, 9, VELUM_ERROR_VERSION}, /* too new */
        {0, 0, VELUM_ERROR_VERSION}, /* too old */
        {UINT32_MAX, UINT32_MAX, VELUM_ERROR_VERSION},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        velum_host_info in = host_info(cases[i].abi_min, cases[i].abi_max);
        velum_plugin_info out = empty_info();
        assert_int_equal(host.negotiate(&in, &out), cases[i].result);
        assert_int_equal(out.abi, cases[i].result == VELUM_OK ? 1 : 0);
        assert_int_equal(out.abi_min, 1);
        assert_int_equal(out.abi_max, 1);
        assert_int_equal(host.log.failures > 0, cases[i].result != VELUM_OK);
        assert_string_equal(out.name, "Velum");
        assert_int_equal(out.reserved, 0);
        assert_int_equal(out.struct_size, sizeof out);
    }
}

static void a_range_upside_down_is_refused(void **state) {
    (void)state;
    velum_host_info in = host_info(2, 1);
    velum_plugin_info out = empty_info();
    velum_plugin_info before = out;
    assert_int_equal(host.negotiate(&in, &out), VELUM_ERROR_ARGUMENT);
    assert_memory_equal(&out, &before, sizeof out);
    assert_non_null(strstr(host.log.message, "abi_min"));
}

static void null_and_small_structs_are_refused(void **state) {
    (void)state;
    velum_host_info in = host_info(1, 1);
    velum_plugin_info out = empty_info();
    velum_plugin_info before = out;
    assert_int_equal(host.negotiate(NULL, &out), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.negotiate(&in, NULL), VELUM_ERROR_ARGUMENT);
    assert_int_equal(host.negotiate(NULL, NULL), VELUM_ERROR_ARGUMENT);
    for (uint32_t size = 0; size < sizeof in; size += 3) {
        in.struct_size = size;
        assert_int_equal(host.negotiate(&in, &out), VELUM_ERROR_STRUCT_SIZE);
    }
    in.struct_size = sizeof in;
    assert_memory_equal(&out, &before, sizeof out);
    for (uint32_t size = 0; size < sizeof out; size += 3) {
        before.struct_size = out.struct_size = size;
        assert_int_equal(host.negotiate(&in, &out), VELUM_ERROR_STRUCT_SIZE);
        assert_memory_equal(&out, &before, sizeof out);
    }
    in = host_info(1, 1);
    in.flags = 0x80000000u;
    out = empty_info();
    assert_int_equal(host.negotiate(&in, &out), VELUM_ERROR_FLAGS);
    assert_int_equal(host.log.failures, 1);
}

static void a_longer_struct_is_written_no_further_than_is_known(void **state) {
    (void)state;
    struct {
        velum_plugin_info info;
        uint8_t more[32];
    } out;
    memset(&out, 0xcd, sizeof out);
    out.info.struct_size = sizeof out;
    velum_host_info in = host_info(1, 9);
    assert_int_equal(host.negotiate(&in, &out.info), VELUM_OK);
    assert_int_equal(out.info.abi, 1);
    for (size_t i = 0; i < sizeof out.more; i++) {
        assert_true(out.more[i] == 0xcd || out.more[i] == 0);
    }
}

static void a_host_without_a_log_is_served(void **state) {
    (void)state;
    velum_host_info in = {.struct_size = sizeof in, .abi_min = 2, .abi_max = 3};
    velum_plugin_info out = empty_info();
    assert_int_equal(host.negotiate(&in, &out), VELUM_ERROR_VERSION);
    in.abi_min = 1;
    assert_int_equal(host.negotiate(&in, &out), VELUM_OK);
}

static void tables_have_ids_and_sizes(void **state) {
    (void)state;
    assert_true(host.world->struct_size >= sizeof(velum_world_api));
    assert_true(host.engine->struct_size >= sizeof(velum_engine_api));
    assert_true(host.vulkan->struct_size >= sizeof(velum_vulkan_api));
    assert_true(host.standalone->struct_size >= sizeof(velum_standalone_api));
    static const char *const unknown[] = {"",
                                          "velum.world",
                                          "velum.world/",
                                          "velum.world/0",
                                          "velum.world/2",
                                          "velum.world/1 ",
                                          "velum.world/11",
                                          "VELUM.WORLD/1",
                                          "velum.directx/1",
                                          "\xff\xfe"};
    for (size_t i = 0; i < sizeof unknown / sizeof unknown[0]; i++) {
        assert_null(host.info.get_table(unknown[i]));
    }
    assert_null(host.info.get_table(NULL));
}

static void tables_have_no_hole(void **state) {
    (void)state;
    const struct {
        const void *table;
        size_t size;
    } tables[] = {{host.world, sizeof *host.world},
                  {host.engine, sizeof *host.engine},
                  {host.vulkan, sizeof *host.vulkan},
                  {host.standalone, sizeof *host.standalone}};
    for (size_t i = 0; i < sizeof tables / sizeof tables[0]; i++) {
        for (size_t at = 8; at < tables[i].size; at += sizeof(void *)) {
            void *function = NULL;
            memcpy(&function, (const char *)tables[i].table + at, sizeof function);
            assert_non_null(function);
        }
    }
}

static void negotiation_is_pure(void **state) {
    (void)state;
    for (int i = 0; i < 100; i++) {
        velum_host_info in = host_info(1, 1);
        velum_plugin_info out = empty_info();
        assert_int_equal(host.negotiate(&in, &out), VELUM_OK);
        assert_ptr_equal(out.get_table, host.info.get_table);
        assert_ptr_equal(out.get_table(VELUM_WORLD_API_ID), host.world);
        assert_int_equal(host.log.count, 0);
    }
}

int main(void) {
    if (!test_host_open(&host)) {
        return 1;
    }
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_highest_common_major_is_taken),
        cmocka_unit_test(a_range_upside_down_is_refused),
        cmocka_unit_test(null_and_small_structs_are_refused),
        cmocka_unit_test(a_longer_struct_is_written_no_further_than_is_known),
        cmocka_unit_test(a_host_without_a_log_is_served),
        cmocka_unit_test(tables_have_ids_and_sizes),
        cmocka_unit_test(tables_have_no_hole),
        cmocka_unit_test(negotiation_is_pure),
    };
    int failed = cmocka_run_group_tests_name("abi negotiation", tests, NULL, NULL);
    test_host_close(&host);
    return failed;
}
