/* A host as the tests need it: the plugin loaded as hosts do, all tables, the newest line of its log. */
#ifndef TESTS_ABI_HOST_H
#define TESTS_ABI_HOST_H

#include <stdbool.h>
#include <velum/velum.h>
#include <velum/vulkan.h>

typedef struct test_log {
    uint32_t count;    /* of lines since test_log_clear */
    uint32_t failures; /* of those, ERROR and above */
    int32_t severity;  /* of the newest failure */
    char object[64], message[1024];
} test_log;

typedef struct test_host {
    void *library;
    velum_negotiate_fn negotiate;
    velum_plugin_info info;
    const velum_world_api *world;
    const velum_engine_api *engine;
    const velum_vulkan_api *vulkan;
    const velum_standalone_api *standalone;
    test_log log;
} test_host;

/* From the environment's VELUM_PLUGIN. False, having printed why. */
bool test_host_open(test_host *host);
void test_host_close(test_host *host);

void VELUM_CALL test_log_write(void *context, int32_t severity, const char *object, const char *message);
void test_log_clear(test_log *log);

velum_world *test_host_create_world(test_host *host, uint64_t seed);
/* One Sc layer of coverage 0.6, 900..1500 m, everywhere. 0: refused. */
uint64_t test_host_commit_overcast(test_host *host, velum_world *world, float coverage);
/* Null where there is no Vulkan device (or no loader). */
velum_engine *test_host_create_engine(test_host *host, velum_world *world);

/* Metres, ECEF, of WGS84. */
void test_ecef(double lat_deg, double lon_deg, double height_m, double out[3]);
velum_frame_info test_frame_info(void);
/* At 50 N 8.5 E, 300 m, looking east, a little up. `width` and `height` 0: the view's own. */
velum_view_frame test_view_frame(void);

#endif
