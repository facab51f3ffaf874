/* Where scenes are played: the plugin through its public tables alone, a world and an engine for the scene, views. */
#ifndef ACCURACY_STAGE_H
#define ACCURACY_STAGE_H

#include <velum_weather/weather.h>

#include "../abi/host.h"
#include "picture.h"
#include "scenes.h"

typedef struct stage {
    test_host host;
    int32_t device;        /* VELUM_DEVICE_* */
    char device_name[256]; /* once there is an engine */
    uint64_t revision;     /* of what shapes a reference: of the sources; of another library than theirs, its file */
    const char *scenes;    /* folder */
    const char *shared;    /* folder of the real weather files */
    velum_world *world;
    velum_engine *engine;
    velum_shadow *shadow;
    uint64_t seed; /* of the world */
    velum_scenario *scenario;
    uint64_t scenario_hash; /* of its text and its sources' */
    float ground_albedo[3];
    int32_t atmosphere;
    float sun_lx[3];
    double sun[3];
    bool hides_ground; /* pictures without Velum's own ground */
} stage;

/* A camera that stands, or where it stands in one frame of a motion. */
typedef struct stage_camera {
    double position_m[3], right[3], up[3], forward[3];
    double tan_x, tan_y; /* half angles */
} stage_camera;

typedef struct stage_view {
    velum_eye *eye;
    velum_view *view;
    uint32_t width, height;
    const float *depth; /* metres along the rays, 0: nothing there; null: the host gives none */
} stage_view;

/* What one frame took. */
typedef struct stage_cost {
    double view_ms, shared_ms; /* of the device; wall clock where it has no timestamps */
    double rays, samples, light_samples;
    double wall_ms;
} stage_cost;

enum { STAGE_OK = 0, STAGE_SKIPPED = 1, STAGE_FAILED = 2 };

/* False, having said why. The plugin's path: VELUM_PLUGIN, else beside this program in the build tree. */
bool stage_init(stage *s, int32_t device);
void stage_finish(stage *s);

/* STAGE_*; says why unless it is OK. */
int stage_load(stage *s, const scene_row *scene, float wind_east_m_s);
/* The same for a scenario's text. */
int stage_load_text(stage *s, const char *text, float wind_east_m_s);

/* The scenario's first camera and channel. */
void stage_camera_init(const stage *s, uint32_t width, uint32_t height, stage_camera *out);
void stage_camera_place(stage_camera *c, double lat_deg, double lon_deg, double height_m, double heading_deg,
                        double pitch_deg, double roll_deg);
bool stage_prepare(stage *s, const stage_camera *c, uint32_t width, double time_s);

/* A shadow map about the camera, for the views of the engine: ground lies in shadow of clouds. */
bool stage_cast_shadow(stage *s, const stage_camera *c);

/* How many texels of such a map, of its own and soon gone, are not within 0..1. */
bool stage_check_shadow(stage *s, const stage_camera *c, double time_s, uint32_t *out_wrong);

/* Of an eye with VELUM_EYE_STUDY, but for the reference. */
velum_result stage_view_init(stage *s, stage_view *v, int32_t quality, uint32_t width, uint32_t height);
void stage_view_finish(stage_view *v, stage *s);

/* flags: VELUM_VIEW_CUT or 0. `cost` may be null. width, height 0: all of the view. */
velum_result stage_draw(stage *s, stage_view *v, const stage_camera *c, double time_s, uint32_t flags, picture *out,
                        stage_cost *cost);

double stage_now_ms(void);
void stage_fail(const stage *s, const char *what, velum_result result);
uint64_t stage_hash(uint64_t hash, const void *data, size_t size); /* FNV-1a; begin with 0 */
/* In host memory, ends with 0; null, having said why. */
char *stage_read_file(const char *path, size_t *out_size);

#endif
