/* The plugin: found, loaded, negotiated with. */
#ifndef HOST_PLUGIN_H
#define HOST_PLUGIN_H

#include <stdbool.h>
#include <velum/engine.h>
#include <velum/vulkan.h>
#include <velum/world.h>

struct plugin {
    void *library;
    velum_plugin_info info;
    const velum_world_api *world;
    const velum_engine_api *engine;
    const velum_vulkan_api *vulkan;
    char message[1024]; /* the newest error that the plugin logged; "" if none */
};

/* path null: ../plugin/libvelum.so from the executable's folder (the build tree), else libvelum.so beside it.
 * Failures are reported in one line. */
bool plugin_load(struct plugin *plugin, const char *path);
void plugin_unload(struct plugin *plugin);

/* A velum_log_fn; context: the plugin. Warnings are printed, errors kept for plugin_report(). */
void plugin_log(void *context, int32_t severity, const char *object, const char *message);

/* "WHAT: what the plugin logged (VELUM_ERROR_...)", and forgets it. */
void plugin_report(struct plugin *plugin, const char *what, velum_result result);

#endif
