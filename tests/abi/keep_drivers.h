/* Vulkan drivers keep memory when they are unloaded, and a leak whose library is gone has no name to be suppressed by
 * (tests/lsan.supp). Called while a device lives, this keeps its driver for the rest of the process. */
#ifndef TESTS_ABI_KEEP_DRIVERS_H
#define TESTS_ABI_KEEP_DRIVERS_H

#include <dlfcn.h>
#include <link.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

typedef struct driver_names {
    uint32_t count;
    char names[8][512];
} driver_names;

static inline int collect_driver(struct dl_phdr_info *info, size_t size, void *context) {
    driver_names *found = context;
    (void)size;
    if (info->dlpi_name && strstr(info->dlpi_name, "/libvulkan_") && found->count < 8) {
        snprintf(found->names[found->count++], sizeof found->names[0], "%s", info->dlpi_name);
    }
    return 0;
}

static inline void keep_drivers(void) {
    driver_names found = {.count = 0};
    dl_iterate_phdr(collect_driver, &found);
    for (uint32_t i = 0; i < found.count; i++) {
        (void)dlopen(found.names[i], RTLD_NOW | RTLD_NOLOAD | RTLD_NODELETE);
    }
}

#endif
