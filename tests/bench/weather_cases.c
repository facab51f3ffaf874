/* Weather: files to cells, cells to tiles, questions. */
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "scene.h"

static bool has_files(const bench *b) {
    char path[1024];
    snprintf(path, sizeof path, "%s/data/gfs.t12z.pgrbf120.2p5deg.grib2", b->shared);
    if (access(path, R_OK) != 0) {
        return false;
    }
    snprintf(path, sizeof path, "%s/data/metars-20141218.csv", b->shared);
    return access(path, R_OK) == 0;
}

static bool reading(bench *b) {
    if (!has_files(b)) {
        bench_skip(b, "the forecast and the reports are not there (VELUM_SHARED)");
        return true;
    }
    bench_series grib_ms = {0}, metar_ms = {0}, commit_ms = {0}, sum_ms = {0};
    velum_weather_report report;
    velum_world_info info = {.struct_size = sizeof info};
    char grib[1024], metar[1024];
    snprintf(grib, sizeof grib, "%s/data/gfs.t12z.pgrbf120.2p5deg.grib2", b->shared);
    snprintf(metar, sizeof metar, "%s/data/metars-20141218.csv", b->shared);
    for (uint32_t round = 0; round < b->rounds; round++) {
        velum_weather_error error = {{0}, 0, 0, 0, {0}};
        velum_weather_set *set = velum_weather_set_create();
        velum_world *world = test_host_create_world(&b->host, 1);
        memset(&report, 0, sizeof report);
        double start_ms = bench_now_ms();
        velum_result result = velum_weather_read_grib(set, grib, &report, &error);
        double grib_done_ms = bench_now_ms();
        if (result >= 0) {
            result = velum_weather_read_metar(set, metar, NULL, &report, &error);
        }
        double metar_done_ms = bench_now_ms();
        velum_state_desc state = {.struct_size = sizeof state};
        uint64_t id = 0;
        if (result >= 0) {
            velum_weather_set_state(set, &state);
            result = b->host.world->commit(world, &state, &id);
        }
        double done_ms = bench_now_ms();
        b->host.world->get_info(world, &info);
        b->host.world->destroy(world);
        velum_weather_set_destroy(set);
        if (result < 0) {
            fprintf(stderr, "velum-bench: %s\n", error.text);
            return bench_fail(b, "reading", result);
        }
        bench_add(&grib_ms, grib_done_ms - start_ms);
        bench_add(&metar_ms, metar_done_ms - grib_done_ms);
        bench_add(&commit_ms, done_ms - metar_done_ms);
        bench_add(&sum_ms, done_ms - start_ms);
    }
    bench_report(b, "GRIB2", "read", "ms", &grib_ms);
    bench_report(b, "METAR", "read", "ms", &metar_ms);
    bench_report(b, "both", "commit", "ms", &commit_ms);
    bench_report(b, "both", "files_to_cells", "ms", &sum_ms);
    bench_report_value(b, "both", "nodes", "1", report.grid_nodes);
    bench_report_value(b, "both", "stations", "1", report.stations_read);
    bench_report_value(b, "both", "stations_refused", "1", report.stations_refused);
    bench_report_value(b, "both", "layers", "1", report.layers);
    bench_report_value(b, "both", "host_memory", "bytes", (double)info.bytes);
    return true;
}

static const double places[][2] = {{50.03, 8.55},    {40.64, -73.78}, {35.55, 139.78}, {-33.95, 151.18},
                                   {-22.81, -43.25}, {1.36, 103.99},  {64.13, -21.94}, {25.25, 55.36}};

/* Places far apart, none seen before: from cells to tiles, then to the device. The pictures are small, so that what is
 * measured is not lost in the march. */
static bool new_place(bench *b) {
    scene s;
    if (has_files(b)) {
        velum_weather_report report = {0};
        if (!scene_world(&s, b, &report) || !scene_engine(&s)) {
            return false;
        }
    } else if (!scene_init(&s, b)) {
        return false;
    }
    const char *world = has_files(b) ? "forecast and reports" : "built-in weather";
    scene_eye eye = {.count = 0};
    bench_series cpu_ms = {0}, gpu_ms = {0}, all_ms = {0}, tiles = {0}, frames = {0};
    scene_frame frame;
    bool ok = scene_eye_init(&s, &eye, VELUM_QUALITY_LOW, 3, 32, 18);
    scene_place(&s, -50.0, -120.0, 300.0); /* pipelines, noise, tables */
    ok = ok && scene_settle(&s, &eye, 4);
    for (size_t i = 0; i < sizeof places / sizeof places[0] && ok; i++) {
        velum_world_info before = {.struct_size = sizeof before};
        velum_world_info after = before;
        scene_place(&s, places[i][0], places[i][1], 300.0);
        b->host.world->get_info(s.world, &before);
        double prepare_ms;
        ok = scene_prepare(&s, &prepare_ms);
        b->host.world->get_info(s.world, &after);
        /* Frames that upload, against frames at the same place that do not. */
        double uploading_ms = 0.0, settled_ms = 0.0;
        uint32_t count = 0;
        do {
            ok = ok && scene_draw(&s, &eye, &frame);
            uploading_ms += frame.wall_ms;
            count++;
        } while (ok && frame.incomplete && count < 64);
        for (uint32_t j = 0; j < 3 && ok; j++) {
            ok = scene_draw(&s, &eye, &frame);
            settled_ms += frame.wall_ms / 3.0;
        }
        double upload_ms = fmax(uploading_ms - (double)count * settled_ms, 0.0);
        bench_add(&cpu_ms, prepare_ms);
        bench_add(&gpu_ms, upload_ms);
        bench_add(&all_ms, prepare_ms + upload_ms);
        bench_add(&tiles, (double)(after.tiles_rasterised - before.tiles_rasterised));
        bench_add(&frames, count);
    }
    if (ok) {
        bench_report(b, world, "cells_to_tiles", "ms", &cpu_ms);
        bench_report(b, world, "tiles_to_gpu", "ms", &gpu_ms);
        bench_report(b, world, "cells_to_gpu", "ms", &all_ms);
        bench_report(b, world, "tiles", "1", &tiles);
        bench_report(b, world, "frames_to_complete", "1", &frames);
        bench_report_value(b, world, "weather_memory", "bytes", frame.weather_bytes);
    }
    if (eye.eye) {
        scene_eye_finish(&eye, &s);
    }
    scene_finish(&s);
    return ok;
}

/* The real sky over three airports. */
static bool forecast(bench *b) {
    if (!has_files(b)) {
        bench_skip(b, "the forecast and the reports are not there (VELUM_SHARED)");
        return true;
    }
    static const char *const names[] = {"Frankfurt", "New York", "Tokyo"};
    scene s;
    velum_weather_report report = {0};
    if (!scene_world(&s, b, &report) || !scene_engine(&s)) {
        return false;
    }
    scene_eye eye = {.count = 0};
    bool ok = scene_eye_init(&s, &eye, VELUM_QUALITY_MEDIUM, 1, 640, 360);
    for (size_t i = 0; i < 3 && ok; i++) {
        bench_series wall = {0}, cpu = {0}, samples = {0}, light = {0};
        scene_place(&s, places[i][0], places[i][1], 300.0);
        ok = scene_settle(&s, &eye, 2);
        for (uint32_t j = 0; j < b->frames && ok; j++) {
            scene_frame frame;
            s.time_s += 1.0 / 60.0;
            ok = scene_draw(&s, &eye, &frame);
            bench_add(&wall, frame.wall_ms);
            bench_add(&cpu, frame.cpu_ms);
            bench_add(&samples, frame.samples);
            bench_add(&light, frame.light_samples);
        }
        if (ok) {
            bench_report(b, names[i], "frame", "ms", &wall);
            bench_report(b, names[i], "cpu", "ms", &cpu);
            bench_report(b, names[i], "samples", "1", &samples);
            bench_report(b, names[i], "light_samples", "1", &light);
        }
    }
    if (eye.eye) {
        scene_eye_finish(&eye, &s);
    }
    scene_finish(&s);
    return ok;
}

static bool queries(bench *b) {
    scene s;
    if (!scene_init(&s, b)) {
        return false;
    }
    bench_series point_us = {0}, line_us = {0};
    bool ok = true;
    for (uint32_t round = 0; round < b->rounds && ok; round++) {
        double start_ms = bench_now_ms();
        for (int i = 0; i < 200 && ok; i++) {
            velum_point_query query = {.struct_size = sizeof query};
            velum_point_answer answer = {.struct_size = sizeof answer};
            test_ecef(50.0 + 0.001 * i, 8.5, 1100.0 + 5.0 * i, query.position_ecef_m);
            ok = b->host.world->query_point(s.world, &query, &answer) >= 0;
        }
        bench_add(&point_us, (bench_now_ms() - start_ms) * 1e3 / 200.0);
        start_ms = bench_now_ms();
        for (int i = 0; i < 5 && ok; i++) {
            velum_line_query query = {.struct_size = sizeof query};
            velum_line_answer answer = {.struct_size = sizeof answer};
            test_ecef(50.0, 8.5, 300.0, query.from_ecef_m);
            test_ecef(50.0 + 0.02 * i, 8.7, 3000.0, query.to_ecef_m);
            ok = b->host.world->query_line(s.world, &query, &answer) >= 0;
        }
        bench_add(&line_us, (bench_now_ms() - start_ms) * 1e3 / 5.0);
    }
    if (ok) {
        bench_report(b, "point", "query", "us", &point_us);
        bench_report(b, "line of 15 km", "query", "us", &line_us);
    } else {
        bench_fail(b, "query", VELUM_ERROR_STATE);
    }
    scene_finish(&s);
    return ok;
}

const bench_case bench_weather_cases[] = {
    {"reading", "a GFS forecast and 4,538 METAR reports read and made into cells", reading},
    {"new_place", "tiles for places not seen before, three channels, from cells to GPU", new_place},
    {"forecast", "one view of 640x360 under the forecast and the reports, medium", forecast},
    {"queries", "questions about points and lines", queries},
    {NULL, NULL, NULL},
};
