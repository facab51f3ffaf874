/* Files of the tests (behind cmocka.h): VELUM_SOURCE is the source root, VELUM_SHARED (default: beside it) holds the
 * real weather. */
#ifndef VELUM_TESTS_FILES_H
#define VELUM_TESTS_FILES_H

#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>

/* Of a file of the repository. Skips the test if VELUM_SOURCE is not set and the file is not below this folder. */
static inline const char *source_path(char path[1024], const char *name) {
    const char *root = getenv("VELUM_SOURCE");
    struct stat status;
    snprintf(path, 1024, "%s/%s", root ? root : ".", name);
    if (!root && stat(path, &status) != 0) {
        print_message("%s is not there (set VELUM_SOURCE to the folder of the repository)\n", path);
        skip();
    }
    return path;
}

/* 0 when the file is not there. */
static inline int shared_path(char path[1024], const char *name) {
    const char *shared = getenv("VELUM_SHARED");
    const char *root = getenv("VELUM_SOURCE");
    struct stat status;
    if (shared) {
        snprintf(path, 1024, "%s/%s", shared, name);
    } else {
        snprintf(path, 1024, "%s/../shared/%s", root ? root : ".", name);
    }
    return stat(path, &status) == 0;
}

/* malloc; null when it cannot be read. */
static inline char *read_all(const char *path, size_t *size) {
    FILE *file = fopen(path, "rb");
    char *bytes = NULL;
    *size = 0;
    if (file && fseek(file, 0, SEEK_END) == 0) {
        const long length = ftell(file);
        rewind(file);
        bytes = length >= 0 ? malloc((size_t)length + 1) : NULL;
        *size = bytes ? fread(bytes, 1, (size_t)length, file) : 0;
    }
    if (file) {
        fclose(file);
    }
    return bytes;
}

#endif
