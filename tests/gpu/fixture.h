/* A world, an engine on the CPU device, cameras: what the tests of pictures start from. */
#ifndef GPU_FIXTURE_H
#define GPU_FIXTURE_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>
#include <velum/standalone.h>
#include <velum/world.h>

typedef struct fixture {
    const velum_world_api *world_api;
    const velum_engine_api *engine_api;
    const velum_standalone_api *standalone_api;
    velum_world *world;
    velum_engine *engine;
    velum_eye *eye;
    uint64_t state;      /* newest that fixture_commit made */
    uint32_t errors;     /* messages of severity ERROR and above */
    uint32_t validation; /* messages of validation layers */
    char newest[1024];
} fixture;

/* Tables alone. */
void fixture_tables(fixture *f);
void fixture_log(void *context, int32_t severity, const char *object, const char *message);
/* A processor, so that tests are alike on all machines; environment VELUM_TEST_DEVICE: index of another. */
int32_t fixture_device(void);
/* World, engine and eye; skips the test where there is no device. */
void fixture_init(fixture *f, bool validate);
/* A second engine on the same world. */
velum_engine *fixture_engine(fixture *f, bool validate);
void fixture_finish(fixture *f);

/* The world and the engine that all tests of a group have in common, for one at a time, and an eye of its own: an
 * engine of its own would make its pipelines anew. Without a timeline; the newest state is that of the test before. Of
 * messages those of validation layers alone are counted. */
void fixture_borrow(fixture *f);
void fixture_give_back(fixture *f);
/* Whether no eye and no shadow map of it lives: what is given back, or its end would fail. */
bool fixture_is_bare(velum_engine *engine);
/* Of what was borrowed, if anything was; a group's teardown. */
int fixture_shared_finish(void **state);

/* These layers all over the planet. */
velum_cell fixture_cell(const velum_layer *layers, uint32_t count);
/* Forgets the one before. */
void fixture_commit(fixture *f, const velum_layer *layers, uint32_t count);
void fixture_commit_cell(fixture *f, const velum_cell *cell);
/* One uniform layer of that optical depth between 1000 and 2000 m. */
velum_layer fixture_slab(float tau);
velum_layer fixture_cumulus(void);
/* Of another genus, with the same water and wind. */
velum_layer fixture_layer(int32_t genus, float coverage, float base_m, float top_m);

/* Place, local axes. */
void fixture_position(double lat_deg, double lon_deg, double height_m, double ecef_m[3]);
void fixture_axes(double lat_deg, double lon_deg, double east[3], double north[3], double up[3]);

velum_frame_info fixture_frame(const double sun[3], double time_s, int32_t atmosphere);
/* Looks along `forward`, half angles by tangent. */
velum_view_frame fixture_camera(const double position[3], const double forward[3], const double right[3], float tan_x,
                                float tan_y);

velum_view *fixture_view(fixture *f, velum_eye *eye, uint32_t width, uint32_t height);

/* internals.c: what no table tells. */
uint64_t fixture_pages_uploaded(velum_engine *engine);
uint64_t fixture_weather_bytes(velum_engine *engine);
uint64_t fixture_view_bytes(velum_view *view);
/* Drawn since it was made. */
uint64_t fixture_shadow_texels(velum_shadow *map);
/* For that eye. */
uint32_t fixture_skies_drawn(velum_eye *eye);
/* Its tiles, in the newest frame: not much the same everywhere. */
bool fixture_weather_is_uneven(velum_eye *eye);
/* From here on its device has none, as far as eyes know. */
void fixture_forget_timestamps(velum_engine *engine);
/* From here on its device's texel buffers hold no more. What they held. */
uint32_t fixture_limit_texels(velum_engine *engine, uint32_t most);

#endif
