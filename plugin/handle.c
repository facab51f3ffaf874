#include "handle.h"

#include <pthread.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { ENTRIES = 16384, INDEX_BITS = 16, GENERATION_SHIFT = INDEX_BITS + 4 };

_Static_assert(sizeof(void *) == 8, "handles need 64 bits");

typedef struct entry {
    uint64_t generation; /* of the newest use, from 1 */
    void *object;        /* null: free */
    const void *parent;
    log_sink sink;
    handle_type type;
    uint32_t next_free; /* index + 1 */
} entry;

static entry registry[ENTRIES];
static uint32_t registry_used;
static uint32_t registry_free; /* index + 1 */
static pthread_mutex_t registry_mutex = PTHREAD_MUTEX_INITIALIZER;

static entry *entry_of(const void *handle) {
    uint64_t value = (uint64_t)(uintptr_t)handle;
    uint32_t index = (uint32_t)(value & ((1u << INDEX_BITS) - 1u));
    if (index >= registry_used || registry[index].generation != value >> GENERATION_SHIFT ||
        registry[index].type != (handle_type)((value >> INDEX_BITS) & 15u)) {
        return NULL;
    }
    return &registry[index];
}

void *handle_create(handle_type type, void *object, const void *parent, const log_sink *sink) {
    void *handle = NULL;
    pthread_mutex_lock(&registry_mutex);
    uint32_t index = ENTRIES;
    if (registry_free) {
        index = registry_free - 1;
        registry_free = registry[index].next_free;
    } else if (registry_used < ENTRIES) {
        index = registry_used++;
    }
    if (index < ENTRIES) {
        entry *e = &registry[index];
        e->generation++;
        e->object = object;
        e->parent = parent;
        e->sink = *sink;
        e->type = type;
        handle = (void *)(uintptr_t)((e->generation << GENERATION_SHIFT) | ((uint64_t)type << INDEX_BITS) | index);
    }
    pthread_mutex_unlock(&registry_mutex);
    return handle;
}

void *handle_get(const void *handle, handle_type type) {
    pthread_mutex_lock(&registry_mutex);
    entry *e = entry_of(handle);
    void *object = e && e->type == type ? e->object : NULL;
    pthread_mutex_unlock(&registry_mutex);
    return object;
}

void handle_destroy(void *handle) {
    pthread_mutex_lock(&registry_mutex);
    entry *e = entry_of(handle);
    if (e && e->object) {
        e->object = NULL;
        e->next_free = registry_free;
        registry_free = (uint32_t)(e - registry) + 1u;
    }
    pthread_mutex_unlock(&registry_mutex);
}

velum_result handle_fail(const void *handle, handle_type type, const char *call) {
    static const char *const names[] = {"object", "world", "engine", "eye", "view", "shadow"};
    log_sink sink = {0};
    bool known = false;
    pthread_mutex_lock(&registry_mutex);
    for (entry *e = entry_of(handle); e; e = entry_of(e->parent)) {
        known = true;
        if (e->object) {
            sink = e->sink;
            break;
        }
    }
    pthread_mutex_unlock(&registry_mutex);
    return log_fail(&sink, VELUM_ERROR_HANDLE, names[type], "%s: found %s, expected a live %s", call,
                    !handle ? "null"
                    : known ? "an object that is destroyed or of another type"
                            : "a foreign pointer",
                    names[type]);
}
