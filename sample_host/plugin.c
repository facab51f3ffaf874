#include "plugin.h"

#include "files.h"
#include "report.h"

#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* A table of another size than ours may lack functions that we call. */
static bool get_table(struct plugin *plugin, const char *path, const char *id, uint32_t size, const void **out) {
    const void *table = plugin->info.get_table ? plugin->info.get_table(id) : NULL;
    uint32_t table_size = 0;
    if (table) {
        memcpy(&table_size, table, sizeof table_size);
    }
    if (table_size < size) {
        report_error("%s: plugin '%s' %u.%u.%u %s the table '%s'", path, plugin->info.name ? plugin->info.name : "?",
                     plugin->info.version_major, plugin->info.version_minor, plugin->info.version_patch,
                     table ? "has an older form of" : "lacks", id);
        return false;
    }
    *out = table;
    return true;
}

static bool find(char out[FILES_PATH_MAX]) {
    char folder[FILES_PATH_MAX];
    ssize_t length = readlink("/proc/self/exe", folder, sizeof folder - 1);
    if (length <= 0) {
        report_error("cannot find the plugin: /proc/self/exe cannot be read; use --plugin");
        return false;
    }
    folder[length] = '\0';
    char *slash = strrchr(folder, '/');
    if (slash) {
        *slash = '\0';
    }
    if (!files_join(folder, "../plugin/libvelum.so", out)) {
        return false;
    }
    return access(out, F_OK) == 0 || files_join(folder, "libvelum.so", out);
}

bool plugin_load(struct plugin *plugin, const char *path) {
    char found[FILES_PATH_MAX];
    *plugin = (struct plugin){.info = {.struct_size = sizeof plugin->info}};
    if (path) {
        /* Without a slash dlopen() would search the system's folders. */
        if (!files_join(path[0] == '/' ? "" : ".", path[0] == '/' ? path + 1 : path, found)) {
            return false;
        }
    } else if (!find(found)) {
        return false;
    }
    dlerror();
    plugin->library = dlopen(found, RTLD_NOW | RTLD_LOCAL);
    if (!plugin->library) {
        const char *error = dlerror();
        report_error("cannot load the plugin: %s", error ? error : found);
        return false;
    }
    union {
        void *symbol;
        velum_negotiate_fn function;
    } negotiate = {.symbol = dlsym(plugin->library, "velum_negotiate")};
    if (!negotiate.symbol) {
        report_error("%s: not a Velum plugin: it has no velum_negotiate", found);
        goto error;
    }
    const velum_host_info host = {.struct_size = sizeof host,
                                  .abi_min = VELUM_ABI_MAJOR,
                                  .abi_max = VELUM_ABI_MAJOR,
                                  .name = "velum-host",
                                  .log = plugin_log,
                                  .log_context = plugin};
    velum_result result = negotiate.function(&host, &plugin->info);
    if (result == VELUM_ERROR_VERSION || (result == VELUM_OK && plugin->info.abi != VELUM_ABI_MAJOR)) {
        report_error("%s: plugin of another version: it speaks ABI %u to %u, this host %u", found, plugin->info.abi_min,
                     plugin->info.abi_max, VELUM_ABI_MAJOR);
        goto error;
    }
    if (result < 0) {
        plugin_report(plugin, found, result);
        goto error;
    }
    const void *world = NULL, *engine = NULL, *vulkan = NULL;
    if (!get_table(plugin, found, VELUM_WORLD_API_ID, sizeof *plugin->world, &world) ||
        !get_table(plugin, found, VELUM_ENGINE_API_ID, sizeof *plugin->engine, &engine) ||
        !get_table(plugin, found, VELUM_VULKAN_API_ID, sizeof *plugin->vulkan, &vulkan)) {
        goto error;
    }
    plugin->world = world;
    plugin->engine = engine;
    plugin->vulkan = vulkan;
    return true;

error:
    plugin_unload(plugin);
    return false;
}

void plugin_unload(struct plugin *plugin) {
    if (plugin && plugin->library) {
        dlclose(plugin->library);
        plugin->library = NULL;
    }
}

void plugin_log(void *context, int32_t severity, const char *object, const char *message) {
    struct plugin *plugin = context;
    if (severity >= VELUM_LOG_ERROR) {
        snprintf(plugin->message, sizeof plugin->message, "%s%s%s", object ? object : "", object ? ": " : "",
                 message ? message : "");
    } else if (severity == VELUM_LOG_WARNING) {
        report_warning("%s: %s", object ? object : "plugin", message ? message : "");
    }
}

void plugin_report(struct plugin *plugin, const char *what, velum_result result) {
    if (plugin->message[0] != '\0') {
        report_error("%s: %s (%s)", what, plugin->message, velum_result_name(result));
    } else {
        report_error("%s: %s", what, velum_result_name(result));
    }
    plugin->message[0] = '\0';
}
