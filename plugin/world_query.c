/* Questions about the weather, answered by the picture's own density function. */
#include <math.h>
#include <string.h>

#include "arguments.h"
#include "core/geodesy.h"
#include "core/oracle.h"
#include "world.h"

/* An oracle over the world's tiles. [weather] calls do not overlap, so the cache is the only thing to guard. */
typedef struct session {
    core_oracle oracle;
    world_weather weather;
} session;

static core_tile *tile_of(void *context, const core_state *state, uint32_t key) {
    bool rasterised;
    return world_tile(context, state, key, true, &rasterised);
}

static void open_session(world *w, double time_s, session *out) {
    *out = (session){0};
    world_weather_at(w, time_s, &out->weather);
    out->oracle = (core_oracle){.noise = core_noise_built(),
                                .state = {out->weather.state[0], out->weather.state[1]},
                                .blend = out->weather.blend,
                                .drift = core_drift_at(time_s, w->seed),
                                .detail = WORLD_TILE_DETAIL,
                                .tile = tile_of,
                                .tile_context = w};
}

velum_result world_query_point(world *w, const velum_point_query *query, velum_point_answer *out) {
    checker check = {&w->sink, "world", "query_point", VELUM_OK};
    velum_point_query q;
    if (!check_in(&check, "query", &q, sizeof q, query, V1_POINT_QUERY) ||
        !check_out(&check, "out", out, V1_POINT_ANSWER) || !check_flags(&check, "query.flags", q.flags, 0) ||
        !check_position(&check, "query.position_ecef_m", q.position_ecef_m) ||
        !check_range(&check, "query.time_s", q.time_s, -1e15, 1e15) ||
        !check_range(&check, "query.footprint_m", q.footprint_m, 0.0, 1e7)) {
        return check.result;
    }
    session s;
    open_session(w, q.time_s, &s);
    core_oracle_point point;
    core_error error = {0};
    velum_result result = core_oracle_at(&s.oracle, q.position_ecef_m, q.footprint_m, &point, &error);
    world_weather_finish(&s.weather);
    if (result < 0) {
        check_fail(&check, result, "%s", error.text);
        return result;
    }
    velum_point_answer answer = {.lat_deg = point.place.lat_deg,
                                 .lon_deg = point.place.lon_deg,
                                 .height_hae_m = point.place.height_m,
                                 .extinction_1_m = point.extinction_1_m,
                                 .water_g_m3 = point.water_g_m3,
                                 .coverage = point.coverage,
                                 .base_m = point.base_m,
                                 .top_m = point.top_m,
                                 .visibility_m = point.visibility_m,
                                 .precipitation_mm_h = point.precipitation_mm_h,
                                 .precipitation = point.precipitation,
                                 .temperature_k = point.temperature_k,
                                 .genus = point.genus};
    memcpy(answer.wind_ecef_m_s, point.wind_ecef_m_s, sizeof answer.wind_ecef_m_s);
    write_struct(out, &answer, sizeof answer);
    return result;
}

velum_result world_query_line(world *w, const velum_line_query *query, velum_line_answer *out) {
    checker check = {&w->sink, "world", "query_line", VELUM_OK};
    velum_line_query q;
    if (!check_in(&check, "query", &q, sizeof q, query, V1_LINE_QUERY) ||
        !check_out(&check, "out", out, V1_LINE_ANSWER) || !check_flags(&check, "query.flags", q.flags, 0) ||
        !check_position(&check, "query.from_ecef_m", q.from_ecef_m) ||
        !check_position(&check, "query.to_ecef_m", q.to_ecef_m) ||
        !check_range(&check, "query.time_s", q.time_s, -1e15, 1e15) ||
        !check_range(&check, "query.footprint_m", q.footprint_m, 0.0, 1e7) ||
        !check_range(&check, "query.contact_extinction_1_m", (double)q.contact_extinction_1_m, 0.0, 100.0)) {
        return check.result;
    }
    if (q.reserved != 0.0f) {
        check_fail(&check, VELUM_ERROR_FLAGS, "query.reserved: expected 0");
        return check.result;
    }
    session s;
    open_session(w, q.time_s, &s);
    core_oracle_line line;
    core_error error = {0};
    float contact_1_m = q.contact_extinction_1_m > 0.0f ? q.contact_extinction_1_m : 1e-4f;
    velum_result result =
        core_oracle_along(&s.oracle, q.from_ecef_m, q.to_ecef_m, q.footprint_m, contact_1_m, &line, &error);
    world_weather_finish(&s.weather);
    if (result < 0) {
        check_fail(&check, result, "%s", error.text);
        return result;
    }
    velum_line_answer answer = {.has_contact = line.has_contact,
                                .optical_depth = line.optical_depth,
                                .transmittance = exp(-line.optical_depth),
                                .first_contact_m = line.has_contact ? line.first_contact_m : 0.0};
    write_struct(out, &answer, sizeof answer);
    return result;
}
