/* A flight through broken cloud, every frame drawn as a host would draw it: a strip of what it passes. */
#include <math.h>
#include <stdlib.h>

#include "chart.h"
#include "sample_host/files.h"

enum { COLUMNS = 4, ROWS = 5, SHOWN = COLUMNS * ROWS, GAP = 4, SHADOW_FRAMES = 60 };

/* 24 s at 250 m/s and 60 frames a second: over the tops, down between the towers, banking, out under the bases. */
static const double frame_s = 1.0 / 60.0, speed_m_s = 250.0, length_s = 24.0;
static const char *const sky =
    "{\"velum\": 1, \"title\": \"flight\", \"start\": \"2014-12-18T12:00:00Z\", \"seed\": 5,"
    "\"sun\": {\"azimuth_deg\": 240, \"elevation_deg\": 24, \"illuminance_lx\": [128000, 128000, 128000]},"
    "\"atmosphere\": \"earth\", \"ground\": {\"albedo\": [0.09, 0.11, 0.06]},"
    "\"weather\": [{\"time_s\": 0, \"sources\": [{\"global\": {\"visibility_m\": 40000, \"layers\": ["
    "{\"type\": \"Cu\", \"coverage\": 0.4, \"base_m\": 1000, \"top_m\": 2600, \"wind_from_deg\": 250, \"wind_m_s\": 8},"
    "{\"type\": \"Ci\", \"coverage\": 0.4, \"base_m\": 8500, \"top_m\": 9500, \"wind_from_deg\": 270, \"wind_m_s\": 30}"
    "]}}]}],"
    "\"camera\": [{\"lat_deg\": 50.0, \"lon_deg\": 8.5, \"height_m\": 3000, \"heading_deg\": 150}],"
    "\"channels\": [{\"name\": \"main\", \"hfov_deg\": 65, \"size\": [160, 90]}]}";

static double eased(double from, double to, double t) {
    t = fmin(fmax(t, 0.0), 1.0);
    return from + (to - from) * t * t * (3.0 - 2.0 * t);
}

static void place(double time_s, stage_camera *camera) {
    const double t = time_s / length_s;
    const double height_m = eased(3000.0, 500.0, 1.2 * t);
    const double bank_deg = 45.0 * (eased(0.0, 1.0, 6.0 * (t - 0.35)) - eased(0.0, 1.0, 6.0 * (t - 0.65)));
    const double heading_deg = 150.0 + eased(0.0, 60.0, 2.0 * (t - 0.35));
    const double away_deg = speed_m_s * time_s / 111200.0;
    stage_camera_place(camera, 50.0 - away_deg * 0.85, 8.5 + away_deg * 0.6, height_m, heading_deg,
                       eased(-8.0, 6.0, 1.4 * t - 0.3), bank_deg);
}

static bool fly(program *p, sheet *out) {
    stage_view v;
    stage_camera camera;
    picture now = {0};
    const uint32_t width = p->reference.width, height = p->reference.height;
    const int frames = (int)(length_s / frame_s);
    double exposure = 0.0;
    if (stage_load_text(&p->s, sky, 0.0f) != STAGE_OK) {
        return false;
    }
    stage_camera_init(&p->s, width, height, &camera);
    velum_result drawn = stage_view_init(&p->s, &v, VELUM_QUALITY_MEDIUM, width, height);
    if (drawn < 0) {
        stage_fail(&p->s, "view", drawn);
        return false;
    }
    bool ok = picture_init(&now, width, height);
    for (int i = 0; ok && i < frames; i++) {
        place(i * frame_s, &camera);
        ok = stage_prepare(&p->s, &camera, width, i * frame_s) &&
             (i % SHADOW_FRAMES != 0 || stage_cast_shadow(&p->s, &camera));
        drawn = ok ? stage_draw(&p->s, &v, &camera, i * frame_s, i == 0 ? VELUM_VIEW_CUT : 0, &now, NULL) : VELUM_OK;
        ok = ok && drawn >= 0;
        const int every = frames / SHOWN;
        if (ok && i % every == every - 1 && i / every < SHOWN) {
            const uint32_t k = (uint32_t)(i / every);
            exposure = exposure > 0.0 ? exposure : picture_exposure(&now);
            sheet_put_picture(out, k % COLUMNS * (width + GAP), k / COLUMNS * (height + GAP), &now, exposure);
        }
    }
    if (drawn < 0) {
        stage_fail(&p->s, "render", drawn);
    }
    picture_finish(&now);
    stage_view_finish(&v, &p->s);
    return ok;
}

int flight_run(program *p) {
    char path[CHART_PATH];
    struct files_folder folder = {.made = 0};
    sheet out = {0};
    if (!files_prepare_folder(p->folder, &folder)) {
        return 1;
    }
    bool ok = sheet_init(&out, COLUMNS * (p->reference.width + GAP) - GAP, ROWS * (p->reference.height + GAP) - GAP);
    snprintf(path, sizeof path, "%s/flight.png", p->folder);
    ok = ok && fly(p, &out) && sheet_write(&out, path);
    sheet_finish(&out);
    files_remove_empty(&folder);
    return ok ? 0 : 1;
}
