/* Velum ABI, part 1: calling convention, results, logging, negotiation.
 *
 * Rules that hold for every struct and function in this folder:
 *
 * - Every struct that crosses the border begins with `uint32_t struct_size`: the caller sets it to sizeof of the type
 *   that it was compiled with. The plugin copies min(struct_size, its own) bytes into a zeroed local, so a field that
 *   the caller does not know reads as 0, and 0 always means "the default". A size below the frozen v1 size is refused
 *   (VELUM_ERROR_STRUCT_SIZE). For structs that the plugin fills, it writes min(struct_size, its own) bytes.
 * - Arrays cross as pointer, count and stride in bytes (stride 0: sizeof the element's own struct_size).
 * - Flags that the plugin does not know are refused (VELUM_ERROR_FLAGS). Reserved fields must be 0.
 * - Pointers given to a function need live only until it returns, unless its comment says otherwise.
 * - Roles: [control] creation, destruction, configuration; [weather] commits, timelines, prepare; [render] frames;
 *   [any] no restriction. A role is a mutual exclusion, not a thread: calls of the same role on objects of one engine
 *   (or one world) must not overlap. [weather] calls may run beside [render] calls. [control] excludes both.
 * - A call in a state in which it is not legal returns VELUM_ERROR_STATE and changes nothing.
 * - Results: 0 ok, > 0 qualified success, < 0 error. After an error the state is unchanged, except after
 *   VELUM_ERROR_OUT_OF_MEMORY and VELUM_ERROR_DEVICE_LOST. Every failure is logged first, naming object and field.
 * - Strings are UTF-8, NUL-terminated.
 */
#ifndef VELUM_ABI_H
#define VELUM_ABI_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(_WIN32)
#define VELUM_CALL __cdecl
#define VELUM_EXPORT __declspec(dllexport)
#else
#define VELUM_CALL
#define VELUM_EXPORT __attribute__((visibility("default")))
#endif

/* Major version of the ABI in these headers. Majors differ when a frozen struct or table changes. */
#define VELUM_ABI_MAJOR 1u

typedef int32_t velum_result;
enum {
    VELUM_OK = 0,
    VELUM_INCOMPLETE = 1, /* done, but some data was not ready: the picture lacks detail; call prepare() and go on */
    VELUM_DEGRADED = 2,   /* done, with a stated loss of quality (a limit of the device or of memory was met) */
    VELUM_UNCHANGED = 3,  /* nothing to do */

    VELUM_ERROR_ARGUMENT = -1,    /* a null pointer or a value outside its range; the log names the field */
    VELUM_ERROR_STRUCT_SIZE = -2, /* struct_size below the frozen v1 size */
    VELUM_ERROR_FLAGS = -3,       /* an unknown flag or a reserved field that is not 0 */
    VELUM_ERROR_STATE = -4,       /* the call is not legal in this state */
    VELUM_ERROR_VERSION = -5,     /* no common version */
    VELUM_ERROR_UNSUPPORTED = -6, /* reserved for later, or not possible on this device */
    VELUM_ERROR_OUT_OF_MEMORY = -7,
    VELUM_ERROR_DEVICE_LOST = -8,
    VELUM_ERROR_VULKAN = -9, /* any other failure of a Vulkan call; the log holds call and VkResult */
    VELUM_ERROR_HANDLE = -10 /* not a live object of this type (destroyed twice, foreign, null) */
};

/* The name of a result, "VELUM_OK" and so on; "VELUM_?" for a value that is none. */
static inline const char *velum_result_name(velum_result result) {
    switch (result) {
    case VELUM_OK: return "VELUM_OK";
    case VELUM_INCOMPLETE: return "VELUM_INCOMPLETE";
    case VELUM_DEGRADED: return "VELUM_DEGRADED";
    case VELUM_UNCHANGED: return "VELUM_UNCHANGED";
    case VELUM_ERROR_ARGUMENT: return "VELUM_ERROR_ARGUMENT";
    case VELUM_ERROR_STRUCT_SIZE: return "VELUM_ERROR_STRUCT_SIZE";
    case VELUM_ERROR_FLAGS: return "VELUM_ERROR_FLAGS";
    case VELUM_ERROR_STATE: return "VELUM_ERROR_STATE";
    case VELUM_ERROR_VERSION: return "VELUM_ERROR_VERSION";
    case VELUM_ERROR_UNSUPPORTED: return "VELUM_ERROR_UNSUPPORTED";
    case VELUM_ERROR_OUT_OF_MEMORY: return "VELUM_ERROR_OUT_OF_MEMORY";
    case VELUM_ERROR_DEVICE_LOST: return "VELUM_ERROR_DEVICE_LOST";
    case VELUM_ERROR_VULKAN: return "VELUM_ERROR_VULKAN";
    case VELUM_ERROR_HANDLE: return "VELUM_ERROR_HANDLE";
    default: return "VELUM_?";
    }
}

enum {
    VELUM_LOG_DEBUG = 0,
    VELUM_LOG_INFO = 1,
    VELUM_LOG_WARNING = 2,
    VELUM_LOG_ERROR = 3,        /* something outside both sides failed (device, memory) */
    VELUM_LOG_HOST_MISUSE = 4,  /* the host broke a rule of these headers */
    VELUM_LOG_PLUGIN_DEFECT = 5 /* Velum broke one: please report it */
};

/* Called in the thread of the call that logs; what validation layers say (VELUM_STANDALONE_VALIDATE) also in threads
 * that work for create_engine, several at once. `object` and `message` die when it returns. It must not call back into
 * the plugin. A null callback is legal and silent. */
typedef void(VELUM_CALL *velum_log_fn)(void *context, int32_t severity, const char *object, const char *message);

/* What the host says of itself. */
typedef struct velum_host_info {
    uint32_t struct_size;
    uint32_t abi_min; /* lowest and highest ABI major that the host can speak */
    uint32_t abi_max;
    uint32_t flags;   /* 0 */
    const char *name; /* may be null */
    velum_log_fn log; /* may be null; used during negotiation only */
    void *log_context;
} velum_host_info;

/* What the plugin answers. All pointers are static data of the plugin, valid until it is unloaded. */
typedef struct velum_plugin_info {
    uint32_t struct_size; /* in: set by the host */
    uint32_t abi;         /* the highest common major; 0 if there is none */
    uint32_t abi_min;
    uint32_t abi_max;
    uint32_t version_major; /* of the plugin, for people */
    uint32_t version_minor;
    uint32_t version_patch;
    uint32_t reserved;
    const char *name; /* "Velum" */
    /* [any] The table of that id ("velum.world/1", "velum.engine/1", "velum.vulkan/1", "velum.standalone/1"), or null
     * if there is none. Every table begins with its own uint32_t struct_size. */
    const void *(VELUM_CALL *get_table)(const char *id);
} velum_plugin_info;

/* [any] The plugin's only exported symbol. Pure and allocation-free: may be called at any time, often, from any
 * thread. VELUM_ERROR_VERSION if the ranges do not overlap (out->abi is 0, abi_min and abi_max are filled). */
typedef velum_result(VELUM_CALL *velum_negotiate_fn)(const velum_host_info *host, velum_plugin_info *out);
VELUM_EXPORT velum_result VELUM_CALL velum_negotiate(const velum_host_info *host, velum_plugin_info *out);

/* Opaque objects. */
typedef struct velum_world velum_world;   /* the weather of the planet, on the CPU; engines share it */
typedef struct velum_engine velum_engine; /* one per device */
typedef struct velum_eye velum_eye;       /* a point of view: time, plan, budget, seam rules */
typedef struct velum_view velum_view;     /* one camera of an eye, with its own history */
typedef struct velum_shadow velum_shadow; /* a cloud shadow map around a centre */

#ifdef __cplusplus
}
#endif
#endif
