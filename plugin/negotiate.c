#include <string.h>

#include "arguments.h"
#include "tables.h"

static const void *VELUM_CALL get_table(const char *id) {
    static const struct {
        const char *id;
        const void *table;
    } tables[] = {{VELUM_WORLD_API_ID, &velum_world_table},
                  {VELUM_ENGINE_API_ID, &velum_engine_table},
                  {VELUM_VULKAN_API_ID, &velum_vulkan_table},
                  {VELUM_STANDALONE_API_ID, &velum_standalone_table}};
    for (size_t i = 0; id && i < sizeof tables / sizeof tables[0]; i++) {
        if (strcmp(id, tables[i].id) == 0) {
            return tables[i].table;
        }
    }
    return NULL;
}

velum_result VELUM_CALL velum_negotiate(const velum_host_info *host, velum_plugin_info *out) {
    if (!host || !out) {
        return VELUM_ERROR_ARGUMENT;
    }
    if (host->struct_size < V1_HOST_INFO || out->struct_size < V1_PLUGIN_INFO) {
        return VELUM_ERROR_STRUCT_SIZE;
    }
    log_sink sink = {host->log, host->log_context};
    checker check = {&sink, "negotiation", "velum_negotiate", VELUM_OK};
    if (!check_flags(&check, "host.flags", host->flags, 0)) {
        return check.result;
    }
    if (host->abi_min > host->abi_max) {
        check_fail(&check, VELUM_ERROR_ARGUMENT, "host.abi_min: found %u above abi_max %u", host->abi_min,
                   host->abi_max);
        return check.result;
    }
    velum_plugin_info info = {.abi_min = VELUM_ABI_MAJOR,
                              .abi_max = VELUM_ABI_MAJOR,
                              .version_major = 0,
                              .version_minor = 1,
                              .version_patch = 0,
                              .name = "Velum",
                              .get_table = get_table};
    bool common = host->abi_min <= info.abi_max && host->abi_max >= info.abi_min;
    info.abi = !common ? 0 : host->abi_max < info.abi_max ? host->abi_max : info.abi_max;
    write_struct(out, &info, sizeof info);
    if (!common) {
        check_fail(&check, VELUM_ERROR_VERSION, "the host speaks ABI %u..%u, this plugin %u..%u", host->abi_min,
                   host->abi_max, info.abi_min, info.abi_max);
    }
    return check.result;
}
