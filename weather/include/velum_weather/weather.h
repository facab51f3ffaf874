/* libvelum-weather: readers of weather files that make the plain data of velum/weather.h.
 *
 * A library of its own: it knows nothing of the plugin, textures or a GPU. No global state: objects may be used from
 * different threads, one thread at a time each. Formats, units, ranges, defaults and rules: weather/FORMAT.md.
 *
 * Heights of layers are metres MSL; camera heights are metres above the WGS84 ellipsoid (HAE). */
#ifndef VELUM_WEATHER_LIBRARY_H
#define VELUM_WEATHER_LIBRARY_H

#include <stdint.h>
#include <velum/weather.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Results of this library: VELUM_OK, VELUM_ERROR_ARGUMENT (the content is wrong), VELUM_ERROR_UNSUPPORTED (a kind of
 * file that is not supported), VELUM_ERROR_OUT_OF_MEMORY, VELUM_ERROR_STATE (the file cannot be read). */

/* The one error of a call. `text` is complete: "file:line:column: field: found X, expected Y" (line and column start at
 * 1; GRIB2: "file: message N: ..."). */
typedef struct velum_weather_error {
    char file[256];
    uint32_t line;    /* 0: does not apply */
    uint32_t column;  /* 0: does not apply */
    uint32_t message; /* GRIB2 message, from 1; 0: does not apply */
    char text[768];
} velum_weather_error;

/* A record that was left out of a good file. */
typedef struct velum_weather_refusal {
    char text[200]; /* "file:line: STATION: reason", "file:line: feature N: reason" */
} velum_weather_refusal;

/* What was read. Texts of refusals: the first 64 of each source; counts are complete. */
typedef struct velum_weather_report {
    uint32_t grid_nodes; /* made into cells */
    uint32_t grib_messages_used, grib_messages_seen;
    uint32_t stations_read; /* made into cells */
    uint32_t stations_refused;
    uint32_t regions_read;
    uint32_t regions_refused;
    uint32_t layers;        /* of all cells */
    uint32_t refusal_count; /* entries of refusals */
    velum_weather_refusal refusals[256];
} velum_weather_report;

/* A growing set of cells (and at most one grid) from any number of sources; owns all that its cells point to. */
typedef struct velum_weather_set velum_weather_set;
velum_weather_set *velum_weather_set_create(void); /* null: out of memory */
void velum_weather_set_destroy(velum_weather_set *set);

/* The state of the set, ready for velum_world_api.commit: pointers stay valid until the set changes or dies. */
void velum_weather_set_state(const velum_weather_set *set, velum_state_desc *out);

/* Readers append to the set; on error the set is unchanged. `report` (may be null) is added to, not cleared.
 * A set holds one grid: a second GRIB2 file replaces it. */
velum_result velum_weather_read_grib(velum_weather_set *set, const char *path, velum_weather_report *report,
                                     velum_weather_error *error);

/* METAR positions, elevations by station name; null members are skipped in the order given: columns of the file itself,
 * then `stations` (of the scenario), then the table at `table_path` (null: the system's weather-util-data table if it
 * is there, read once for each call that needs it). */
typedef struct velum_weather_station {
    char name[8]; /* ICAO, upper case */
    double lat_deg, lon_deg;
    float elevation_m; /* MSL */
} velum_weather_station;
typedef struct velum_weather_station_options {
    const velum_weather_station *stations;
    uint32_t station_count;
    const char *table_path;
    float radius_m; /* of influence; 0: 60000 */
} velum_weather_station_options;
velum_result velum_weather_read_metar(velum_weather_set *set, const char *path,
                                      const velum_weather_station_options *options, velum_weather_report *report,
                                      velum_weather_error *error);
velum_result velum_weather_read_geojson(velum_weather_set *set, const char *path, velum_weather_report *report,
                                        velum_weather_error *error);

/* The same from memory; `name` stands for the path in errors. For fuzzing and for hosts that hold their own files. */
velum_result velum_weather_read_grib_memory(velum_weather_set *set, const char *name, const void *data, uint64_t size,
                                            velum_weather_report *report, velum_weather_error *error);
velum_result velum_weather_read_metar_memory(velum_weather_set *set, const char *name, const char *text, uint64_t size,
                                             const velum_weather_station_options *options, velum_weather_report *report,
                                             velum_weather_error *error);
velum_result velum_weather_read_geojson_memory(velum_weather_set *set, const char *name, const char *text,
                                               uint64_t size, velum_weather_report *report, velum_weather_error *error);

/* ------------------------------------------------------------------ scenarios */

typedef struct velum_scenario_camera {
    double time_s;
    double lat_deg, lon_deg, height_m; /* HAE */
    double heading_deg, pitch_deg, roll_deg;
} velum_scenario_camera;

typedef struct velum_scenario_channel {
    char name[32];
    double yaw_deg, pitch_deg, roll_deg; /* in the eye's body frame, after its attitude */
    double hfov_deg;
    uint32_t width, height;
} velum_scenario_channel;

typedef struct velum_scenario_key {
    double time_s, transition_s;
    velum_weather_set *set; /* owned by the scenario */
} velum_scenario_key;

enum { VELUM_SCENARIO_SUN_COMPUTED = 0, VELUM_SCENARIO_SUN_FIXED = 1 };

typedef struct velum_scenario {
    char title[128];
    double start_unix_s; /* UTC */
    double duration_s;
    uint64_t seed;
    int32_t sun;                               /* VELUM_SCENARIO_SUN_* */
    double sun_azimuth_deg, sun_elevation_deg; /* at the first camera keyframe; fixed to the earth */
    float sun_illuminance_lx[3];               /* at the top of the atmosphere */
    uint32_t atmosphere_none;                  /* 1: no air and no haze */
    float ground_albedo[3];
    float geoid_undulation_m;
    velum_scenario_key *keys;
    uint32_t key_count;
    velum_scenario_camera *cameras;
    uint32_t camera_count;
    velum_scenario_channel *channels;
    uint32_t channel_count;
} velum_scenario;

/* Reads a scenario and all its sources; `extra` are paths of further sources (--weather; kind by content: GRIB magic,
 * JSON, else METAR) over every key's own, in the order given. Paths inside the file are relative to it. *out is null
 * after an error. */
velum_result velum_scenario_load(const char *path, const char *const *extra, uint32_t extra_count, velum_scenario **out,
                                 velum_weather_report *report, velum_weather_error *error);
/* The same from memory; `directory` stands for the file's own. */
velum_result velum_scenario_load_memory(const char *name, const char *directory, const char *text, uint64_t size,
                                        velum_scenario **out, velum_weather_report *report, velum_weather_error *error);
void velum_scenario_destroy(velum_scenario *scenario);

/* The eye at a time: keyframes interpolated (positions along the shortest way over the antimeridian and poles, attitude
 * by spherical interpolation), the first and last held. position: ECEF m. The columns of `body` are right, up and
 * forward in ECEF. */
void velum_scenario_pose(const velum_scenario *scenario, double time_s, velum_scenario_camera *out);

/* Attitude and position in ECEF: heading clockwise from north, pitch up, roll right wing down, about the ellipsoid's
 * normal. */
void velum_scenario_pose_ecef(const velum_scenario_camera *pose, double position_m[3], double right[3], double up[3],
                              double forward[3]);
/* A channel's axes from the eye's: yaw (right), pitch (up), roll (clockwise) in the body frame. */
void velum_scenario_channel_axes(const velum_scenario_channel *channel, const double eye_right[3],
                                 const double eye_up[3], const double eye_forward[3], double right[3], double up[3],
                                 double forward[3]);

/* Direction towards the sun, ECEF, unit: by angles at the first camera keyframe, or computed (libnova: apparent
 * position, sidereal time) from start_unix_s + time_s. */
void velum_scenario_sun(const velum_scenario *scenario, double time_s, double direction[3]);

#ifdef __cplusplus
}
#endif
#endif
