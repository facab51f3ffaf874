#include "cache.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { SIZE_MAX_BYTES = 64 * 1024 * 1024 };

void cache_path(const uint8_t device_uuid[VK_UUID_SIZE], uint32_t driver_version, char path[FILES_PATH_MAX]) {
    const char *folder = getenv("XDG_CACHE_HOME"), *below = "";
    char uuid[2 * VK_UUID_SIZE + 1];
    if (!folder || *folder != '/') { /* a relative one is to be ignored (XDG base directory specification 0.8) */
        folder = getenv("HOME");
        below = "/.cache";
    }
    path[0] = '\0';
    if (!folder || *folder != '/') {
        return;
    }
    for (uint32_t i = 0; i < VK_UUID_SIZE; i++) {
        snprintf(uuid + 2 * i, 3, "%02x", device_uuid[i]);
    }
    int length = snprintf(path, FILES_PATH_MAX, "%s%s/velum/%s-%08x.pipelines", folder, below, uuid, driver_version);
    if (length < 0 || length >= FILES_PATH_MAX) {
        path[0] = '\0';
    }
}

void *cache_read(const char *path, size_t *size) {
    struct stat status;
    char *data = NULL;
    size_t used = 0;
    *size = 0;
    /* O_NONBLOCK: a pipe in its place must not hold us. */
    int file = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (file >= 0 && fstat(file, &status) == 0 && S_ISREG(status.st_mode) && status.st_size > 0 &&
        status.st_size <= SIZE_MAX_BYTES) {
        *size = (size_t)status.st_size;
        data = malloc(*size);
    }
    for (ssize_t got = 1; data && used < *size && got > 0; used += got > 0 ? (size_t)got : 0) {
        got = read(file, data + used, *size - used);
    }
    if (file >= 0) {
        close(file);
    }
    if (used < *size) {
        free(data);
        data = NULL;
    }
    return data;
}

void cache_write(const char *path, const void *data, size_t size) {
    char temporary[FILES_PATH_MAX];
    int length = snprintf(temporary, sizeof temporary, "%s.%ld.tmp", path, (long)getpid());
    if (length < 0 || (size_t)length >= sizeof temporary) {
        return;
    }
    for (char *slash = strchr(temporary + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(temporary, 0700);
        *slash = '/';
    }
    FILE *file = fopen(temporary, "wb");
    if (!file) {
        return;
    }
    bool whole = fwrite(data, 1, size, file) == size;
    whole = fclose(file) == 0 && whole;
    if (!whole || rename(temporary, path) != 0) {
        unlink(temporary);
    }
}
