/* Handles: what hosts hold in place of pointers. A handle names an entry of a registry and the generation of its use,
 * so a handle that was destroyed twice, is null, foreign or of another type is found out without touching what it
 * points to.
 *
 * The registry is the plugin's one piece of global state: a host may hand in any handle at any time, and nothing that
 * an object owns can tell that the object is gone. It holds no weather and no device: objects of one host cannot be
 * reached through another's. */
#ifndef PLUGIN_HANDLE_H
#define PLUGIN_HANDLE_H

#include "log.h"

typedef enum handle_type {
    HANDLE_WORLD = 1,
    HANDLE_ENGINE = 2,
    HANDLE_EYE = 3,
    HANDLE_VIEW = 4,
    HANDLE_SHADOW = 5
} handle_type;

/* Null: too many objects live. `parent` (may be null) logs for the object when it is dead; `sink` while it lives. */
void *handle_create(handle_type type, void *object, const void *parent, const log_sink *sink);
/* The object, or null if there is none of that type. */
void *handle_get(const void *handle, handle_type type);
void handle_destroy(void *handle);

/* Logs that `handle` is no live object, through the nearest ancestor that is alive; VELUM_ERROR_HANDLE. */
velum_result handle_fail(const void *handle, handle_type type, const char *call);

#endif
