/* The file of the pipeline cache: kept, and never in the way. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "cache.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static char folder[] = "/tmp/velum-cache-XXXXXX";

static int setup(void **state) {
    (void)state;
    return mkdtemp(folder) ? 0 : 1;
}

static int teardown(void **state) {
    static const char *const names[] = {"a/velum/x", "a/velum", "a", "file", "taken/x", "taken", ""};
    char path[FILES_PATH_MAX];
    (void)state;
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        snprintf(path, sizeof path, "%s/%s", folder, names[i]);
        remove(path);
    }
    return access(folder, F_OK) == 0; /* something was left behind */
}

static const char *path_of(const char *name) {
    static char path[FILES_PATH_MAX];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return path;
}

static void what_is_written_is_read_back(void **state) {
    static const char first[] = "first", second[] = "the second one";
    size_t size = 1;
    (void)state;
    assert_null(cache_read(path_of("a/velum/x"), &size));
    cache_write(path_of("a/velum/x"), first, sizeof first);
    cache_write(path_of("a/velum/x"), second, sizeof second);
    char *data = cache_read(path_of("a/velum/x"), &size);
    assert_non_null(data);
    assert_int_equal(size, sizeof second);
    assert_memory_equal(data, second, sizeof second);
    free(data);
}

static void what_is_in_the_way_is_left(void **state) {
    size_t size = 1;
    char long_path[FILES_PATH_MAX];
    (void)state;
    assert_int_equal(mkdir(path_of("taken"), 0777), 0);
    cache_write(path_of("taken"), "x", 1); /* a folder stands there */
    assert_null(cache_read(path_of("taken"), &size));
    FILE *file = fopen(path_of("file"), "w");
    assert_non_null(file);
    fclose(file);
    assert_null(cache_read(path_of("file"), &size)); /* empty */
    cache_write(path_of("file/velum/x"), "x", 1);
    assert_null(cache_read(path_of("file/velum/x"), &size));
    assert_int_equal(truncate(path_of("file"), 1LL << 40), 0);
    assert_null(cache_read(path_of("file"), &size)); /* absurdly long */
    assert_null(cache_read("/dev/zero", &size));
    memset(long_path, 'x', sizeof long_path);
    long_path[0] = '/';
    long_path[sizeof long_path - 1] = '\0';
    cache_write(long_path, "x", 1);
    assert_null(cache_read(long_path, &size));
}

#define NAME "ab000000000000000000000000000001-00000007.pipelines"

static void the_folder_is_the_users(void **state) {
    const char *const homes[][3] = {{"/cache", "/home/one", "/cache/velum/" NAME},
                                    {"relative", "/home/one", "/home/one/.cache/velum/" NAME},
                                    {NULL, "/home/one", "/home/one/.cache/velum/" NAME},
                                    {"", "relative", ""},
                                    {NULL, NULL, ""}};
    (void)state;
    const uint8_t uuid[VK_UUID_SIZE] = {0xab, [15] = 1};
    for (size_t i = 0; i < sizeof homes / sizeof homes[0]; i++) {
        char path[FILES_PATH_MAX] = "?";
        homes[i][0] ? setenv("XDG_CACHE_HOME", homes[i][0], 1) : unsetenv("XDG_CACHE_HOME");
        homes[i][1] ? setenv("HOME", homes[i][1], 1) : unsetenv("HOME");
        cache_path(uuid, 7, path);
        assert_string_equal(path, homes[i][2]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_is_written_is_read_back),
        cmocka_unit_test(what_is_in_the_way_is_left),
        cmocka_unit_test(the_folder_is_the_users),
    };
    return cmocka_run_group_tests_name("cache", tests, setup, teardown);
}
