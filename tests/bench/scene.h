/* What cases draw: a world, an engine on the bench's device, and eyes with views. */
#ifndef BENCH_SCENE_H
#define BENCH_SCENE_H

#include <velum_weather/weather.h>

#include "bench.h"

enum { SCENE_VIEWS = 8 };

typedef struct scene {
    bench *b;
    velum_world *world;
    velum_engine *engine;
    velum_shadow *shadow; /* null: frames have no shadow map */
    uint64_t serial;
    double time_s;
    double position_ecef_m[3], right[3], up[3], forward[3];
    double sun[3];
    float ground_albedo[3];
    double half_width_deg; /* of a view */
    float budget_ms;       /* of the next eye; 0: none */
    float depth_m;         /* of the host's surface before the next eye's views; 0: the host gives no depth */
} scene;

typedef struct scene_eye {
    velum_eye *eye;
    velum_view *views[SCENE_VIEWS];
    uint32_t count;
    double yaw_deg[SCENE_VIEWS];
    uint32_t width, height;
    velum_vulkan_images images[SCENE_VIEWS];
} scene_eye;

/* What one frame took. Zero where the device has no timestamps. */
typedef struct scene_frame {
    double wall_ms;   /* recording, submission, completion */
    double cpu_ms;    /* of all threads; with a software device that is its work */
    double record_ms; /* of that, the host's thread in the plugin */
    double shared_ms, shadow_ms, view_ms[SCENE_VIEWS], gpu_ms;
    double march_ms, resolve_ms; /* of all views */
    double rays, samples, light_samples;
    double weather_bytes, view_bytes;
    bool incomplete;
} scene_frame;

/* With the bench's scenario, seen through its first channel, or broken cumulus under thin cirrus. */
bool scene_init(scene *s, bench *b);
void scene_finish(scene *s);
/* Only a world, with the real forecast and reports if they are there. */
bool scene_world(scene *s, bench *b, velum_weather_report *report);
bool scene_engine(scene *s);
/* From now on frames renew a shadow map around the eye, and views light their ground through it. */
bool scene_shadow(scene *s);
void scene_place(scene *s, double lat_deg, double lon_deg, double height_m);

/* Views side by side. */
bool scene_eye_init(scene *s, scene_eye *eye, int32_t quality, uint32_t views, uint32_t width, uint32_t height);
void scene_eye_finish(scene_eye *eye, scene *s);

/* One frame at the scene's time, finished when it returns. */
bool scene_draw(scene *s, scene_eye *eye, scene_frame *out);
/* Tiles made, then frames until none is missing and `count` more. */
bool scene_settle(scene *s, scene_eye *eye, uint32_t count);
bool scene_prepare(scene *s, double *out_ms);

#endif
