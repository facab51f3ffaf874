/* The plugin's pipeline cache, kept in a file between runs. Whatever is wrong with the file, it is made anew: nothing
 * here is reported. */
#ifndef HOST_CACHE_H
#define HOST_CACHE_H

#include "files.h"

#include <vulkan/vulkan.h>

/* $XDG_CACHE_HOME/velum/DEVICE-DRIVER.pipelines, or the same below ~/.cache. "" if there is no place for it. */
void cache_path(const uint8_t device_uuid[VK_UUID_SIZE], uint32_t driver_version, char path[FILES_PATH_MAX]);

/* malloc, the caller's to free; null: there is no such file that can be used. */
void *cache_read(const char *path, size_t *size);

/* With the folders above it; the file appears whole or stays as it was. */
void cache_write(const char *path, const void *data, size_t size);

#endif
