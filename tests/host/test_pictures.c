/* EXR and PNG: what is written is what is read, and a file appears whole or not at all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "exr.h"
#include "files.h"
#include "png.h"

#include <OpenEXR/openexr.h>
#include <dirent.h>
#include <spng.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { WIDTH = 7, HEIGHT = 5 };

struct folder {
    char path[64];
};

static int setup(void **state) {
    struct folder *folder = calloc(1, sizeof *folder);
    if (!folder) {
        return -1;
    }
    strcpy(folder->path, "/tmp/velum-test-XXXXXX");
    *state = folder;
    return mkdtemp(folder->path) ? 0 : -1;
}

static int count_files(const char *path, bool remove_them) {
    DIR *directory = opendir(path);
    int count = 0;
    assert_non_null(directory);
    for (struct dirent *entry = readdir(directory); entry; entry = readdir(directory)) {
        char file[400];
        if (strcmp(entry->d_name, ".") == 0 || strcmp(entry->d_name, "..") == 0) {
            continue;
        }
        count++;
        snprintf(file, sizeof file, "%s/%s", path, entry->d_name);
        if (remove_them) {
            unlink(file);
            rmdir(file);
        }
    }
    closedir(directory);
    return count;
}

static int teardown(void **state) {
    struct folder *folder = *state;
    count_files(folder->path, true);
    rmdir(folder->path);
    free(folder);
    return 0;
}

static void exr_holds_the_floats(void **state) {
    const struct folder *folder = *state;
    static const char *const names[] = {"A", "B", "G", "R", "TB", "TG", "TR", "Z"};
    struct exr_channel channels[8];
    float data[WIDTH * HEIGHT * 8];
    char path[FILES_PATH_MAX];
    for (int i = 0; i < WIDTH * HEIGHT * 8; i++) {
        data[i] = 1e6f / (float)(i + 1);
    }
    for (int c = 0; c < 8; c++) {
        channels[c] = (struct exr_channel){names[c], data + c, 8};
    }
    assert_true(files_join(folder->path, "a.exr", path));
    assert_true(exr_write(path, WIDTH, HEIGHT, channels, 8));
    assert_int_equal(count_files(folder->path, false), 1);

    exr_context_t context = NULL;
    exr_compression_t compression = EXR_COMPRESSION_ZIP;
    const exr_attr_chlist_t *list = NULL;
    exr_attr_box2i_t window;
    assert_int_equal(exr_start_read(&context, path, NULL), EXR_ERR_SUCCESS);
    assert_int_equal(exr_get_compression(context, 0, &compression), EXR_ERR_SUCCESS);
    assert_int_equal(compression, EXR_COMPRESSION_NONE);
    assert_int_equal(exr_get_channels(context, 0, &list), EXR_ERR_SUCCESS);
    assert_int_equal(list->num_channels, 8);
    for (int c = 0; c < 8; c++) {
        assert_string_equal(list->entries[c].name.str, names[c]);
        assert_int_equal(list->entries[c].pixel_type, EXR_PIXEL_FLOAT);
    }
    assert_int_equal(exr_get_data_window(context, 0, &window), EXR_ERR_SUCCESS);
    assert_int_equal(window.max.x - window.min.x + 1, WIDTH);
    assert_int_equal(window.max.y - window.min.y + 1, HEIGHT);
    for (int y = 0; y < HEIGHT; y++) {
        exr_chunk_info_t chunk;
        float line[8 * WIDTH];
        assert_int_equal(exr_read_scanline_chunk_info(context, 0, y, &chunk), EXR_ERR_SUCCESS);
        assert_int_equal(chunk.packed_size, sizeof line);
        assert_int_equal(exr_read_chunk(context, 0, &chunk, line), EXR_ERR_SUCCESS);
        for (int c = 0; c < 8; c++) {
            for (int x = 0; x < WIDTH; x++) {
                assert_float_equal(line[c * WIDTH + x], data[(y * WIDTH + x) * 8 + c], 0);
            }
        }
    }
    exr_finish(&context);
}

static void png_holds_the_pixels(void **state) {
    const struct folder *folder = *state;
    uint8_t pixels[WIDTH * HEIGHT * 3], read[WIDTH * HEIGHT * 3];
    char path[FILES_PATH_MAX];
    for (size_t i = 0; i < sizeof pixels; i++) {
        pixels[i] = (uint8_t)(i * 37);
    }
    assert_true(files_join(folder->path, "a.png", path));
    assert_true(png_write(path, WIDTH, HEIGHT, 3, pixels));
    assert_int_equal(count_files(folder->path, false), 1);
    FILE *file = fopen(path, "rb");
    assert_non_null(file);
    spng_ctx *context = spng_ctx_new(0);
    assert_non_null(context);
    struct spng_ihdr header;
    assert_int_equal(spng_set_png_file(context, file), 0);
    assert_int_equal(spng_get_ihdr(context, &header), 0);
    assert_int_equal(header.width, WIDTH);
    assert_int_equal(header.height, HEIGHT);
    assert_int_equal(spng_decode_image(context, read, sizeof read, SPNG_FMT_RGB8, 0), 0);
    assert_memory_equal(read, pixels, sizeof pixels);
    spng_ctx_free(context);
    fclose(file);
}

static void nothing_is_left_of_a_failure(void **state) {
    const struct folder *folder = *state;
    const float value = 1;
    const struct exr_channel channel = {"Y", &value, 1};
    const uint8_t grey = 7;
    char path[FILES_PATH_MAX];
    /* A folder stands where the file should go. */
    assert_true(files_join(folder->path, "taken", path));
    assert_int_equal(mkdir(path, 0777), 0);
    assert_false(exr_write(path, 1, 1, &channel, 1));
    assert_false(png_write(path, 1, 1, 1, &grey));
    assert_int_equal(count_files(folder->path, false), 1);
    assert_true(files_join(folder->path, "missing/a.exr", path));
    assert_false(exr_write(path, 1, 1, &channel, 1));
    assert_false(png_write(path, 1, 1, 1, &grey));
}

static void folders_are_made_and_checked(void **state) {
    const struct folder *folder = *state;
    char deep[FILES_PATH_MAX], file[FILES_PATH_MAX];
    struct stat status;
    struct files_folder made;
    assert_true(files_join(folder->path, "one", deep));
    assert_true(files_prepare_folder(deep, &made));
    assert_int_equal(stat(deep, &status), 0);
    assert_true(S_ISDIR(status.st_mode));
    assert_int_equal(count_files(deep, false), 0);
    assert_true(files_join(folder->path, "one/", file));
    assert_true(files_prepare_folder(file, &made));
    assert_false(files_prepare_parent(file, &made));
    assert_false(files_prepare_folder("", &made));
    assert_false(files_prepare_folder("/dev/null/x", &made));
}

static void only_what_was_made_and_is_empty_is_removed(void **state) {
    const struct folder *folder = *state;
    char path[FILES_PATH_MAX], deep[FILES_PATH_MAX], file[FILES_PATH_MAX];
    struct files_folder made;
    struct stat status;
    assert_true(files_join(folder->path, "top", path));
    assert_true(files_join(path, "middle//deep/", deep));
    assert_true(files_prepare_folder(deep, &made));
    files_remove_empty(&made);
    assert_int_not_equal(stat(path, &status), 0);
    assert_int_equal(stat(folder->path, &status), 0);

    assert_true(files_prepare_folder(path, &made));
    assert_true(files_prepare_folder(path, &made)); /* it was there */
    files_remove_empty(&made);
    assert_int_equal(stat(path, &status), 0);

    assert_true(files_join(path, "middle/deep/map.exr", file));
    assert_true(files_prepare_parent(file, &made));
    assert_true(files_join(path, "middle/kept", file));
    assert_int_equal(mkdir(file, 0777), 0);
    files_remove_empty(&made);
    assert_true(files_join(path, "middle/deep", deep));
    assert_int_not_equal(stat(deep, &status), 0);
    assert_int_equal(stat(file, &status), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(exr_holds_the_floats, setup, teardown),
        cmocka_unit_test_setup_teardown(png_holds_the_pixels, setup, teardown),
        cmocka_unit_test_setup_teardown(nothing_is_left_of_a_failure, setup, teardown),
        cmocka_unit_test_setup_teardown(folders_are_made_and_checked, setup, teardown),
        cmocka_unit_test_setup_teardown(only_what_was_made_and_is_empty_is_removed, setup, teardown),
    };
    return cmocka_run_group_tests_name("pictures", tests, NULL, NULL);
}
