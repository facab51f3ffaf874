/* Ten genera at morning, noon and dusk, from below, within and above, each beside its reference: a sheet for each genus
 * and a page. With references as they are in the cache, those that are not there are left out. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "chart.h"
#include "sample_host/files.h"

typedef struct genus_row {
    const char *type, *name;
    double coverage, base_m, top_m;
    double below_pitch_deg; /* of the view from the ground: high cloud stands high in the sky */
} genus_row;

static const genus_row genera[] = {
    {"Cu", "cumulus", 0.4, 1000, 2400, 18},     {"Sc", "stratocumulus", 0.75, 900, 1500, 20},
    {"St", "stratus", 1.0, 400, 800, 15},       {"Cb", "cumulonimbus", 0.3, 900, 11500, 20},
    {"Ns", "nimbostratus", 1.0, 900, 4800, 18}, {"Ac", "altocumulus", 0.6, 3600, 4200, 35},
    {"As", "altostratus", 1.0, 3200, 5000, 30}, {"Cs", "cirrostratus", 0.95, 7500, 9000, 25},
    {"Ci", "cirrus", 0.5, 8200, 9600, 40},      {"Cc", "cirrocumulus", 0.6, 7300, 7700, 45},
};
enum { GENERA = sizeof genera / sizeof genera[0], HOURS = 3, PLACES = 3, GAP = 4, FRAMES = 64, DRAWN_W = 288 };

/* How many times as wide pictures are as their references: to be looked at. */
static uint32_t enlarged(const program *p) {
    return (DRAWN_W + p->reference.width - 1) / p->reference.width;
}

static const struct {
    const char *name;
    double azimuth_deg, elevation_deg;
} hours[HOURS] = {{"morning", 105, 15}, {"noon", 180, 58}, {"dusk", 255, 3}};
static const char *const places[PLACES] = {"below", "within", "above"};

/* Of one picture. */
typedef struct genus_figure {
    double error, bias, noise;
} genus_figure;

static void write_scenario(const genus_row *g, int hour, int place, char *out, size_t size) {
    const double heights_m[PLACES] = {120.0, 0.5 * (g->base_m + g->top_m), g->top_m + 900.0};
    const double pitches_deg[PLACES] = {g->below_pitch_deg, 0.0, -14.0};
    snprintf(out, size,
             "{\"velum\": 1, \"title\": \"%s\", \"start\": \"2014-12-18T12:00:00Z\", \"seed\": 11,"
             "\"sun\": {\"azimuth_deg\": %g, \"elevation_deg\": %g, \"illuminance_lx\": [128000, 128000, 128000]},"
             "\"atmosphere\": \"earth\", \"ground\": {\"albedo\": [0.09, 0.11, 0.06]},"
             "\"weather\": [{\"time_s\": 0, \"sources\": [{\"global\": {\"visibility_m\": 40000, \"layers\": ["
             "{\"type\": \"%s\", \"coverage\": %g, \"base_m\": %g, \"top_m\": %g}]}}]}],"
             "\"camera\": [{\"lat_deg\": 50.0, \"lon_deg\": 8.5, \"height_m\": %g, \"heading_deg\": 150, "
             "\"pitch_deg\": %g}],"
             "\"channels\": [{\"name\": \"main\", \"hfov_deg\": 70, \"size\": [160, 90]}]}",
             g->name, hours[hour].azimuth_deg, hours[hour].elevation_deg, g->type, g->coverage, g->base_m, g->top_m,
             heights_m[place], pitches_deg[place]);
}

static bool draw_preset(stage *s, uint32_t width, uint32_t height, picture *out) {
    stage_camera camera;
    stage_view v;
    stage_camera_init(s, width, height, &camera);
    if (!stage_prepare(s, &camera, width, 0.0) || !stage_cast_shadow(s, &camera) || !picture_init(out, width, height)) {
        return false;
    }
    velum_result drawn = stage_view_init(s, &v, VELUM_QUALITY_HIGH, width, height);
    if (drawn < 0) {
        stage_fail(s, "view", drawn);
        return false;
    }
    for (int i = 0; i < FRAMES && drawn >= 0; i++) {
        drawn = stage_draw(s, &v, &camera, 0.0, i == 0 ? VELUM_VIEW_CUT : 0, out, NULL);
    }
    if (drawn < 0) {
        stage_fail(s, "render", drawn);
    }
    stage_view_finish(&v, s);
    return drawn >= 0;
}

/* Nine pictures and, where there are any, their references. */
typedef struct genus_sheet {
    picture found[HOURS][PLACES];
    reference references[HOURS][PLACES];
    genus_figure figures[HOURS][PLACES];
    uint32_t reference_count;
} genus_sheet;

/* How many references each device made. */
enum { DEVICES = 4 };
typedef struct genus_devices {
    char names[DEVICES][256];
    uint32_t counts[DEVICES];
} genus_devices;

static void count_device(genus_devices *devices, const char *name) {
    int i = 0;
    while (i < DEVICES - 1 && devices->counts[i] > 0 && strcmp(devices->names[i], name) != 0) {
        i++;
    }
    snprintf(devices->names[i], sizeof devices->names[i], "%s", name);
    devices->counts[i]++;
}

static bool draw_one(program *p, const genus_row *g, int hour, int place, genus_sheet *out) {
    char text[1200], name[64];
    const uint32_t width = p->reference.width, height = p->reference.height;
    reference *r = &out->references[hour][place];
    genus_figure *figure = &out->figures[hour][place];
    stage_camera camera;
    write_scenario(g, hour, place, text, sizeof text);
    snprintf(name, sizeof name, "genus_%s_%s_%s", g->type, hours[hour].name, places[place]);
    if (stage_load_text(&p->s, text, 0.0f) != STAGE_OK) {
        return false;
    }
    if (!draw_preset(&p->s, enlarged(p) * width, enlarged(p) * height, &out->found[hour][place])) {
        return false;
    }
    stage_camera_init(&p->s, width, height, &camera);
    if (!stage_prepare(&p->s, &camera, width, 0.0) || !stage_cast_shadow(&p->s, &camera)) {
        return false;
    }
    bool has = p->reference.cached ? reference_load(&p->s, name, &camera, 0.0f, &p->reference, r)
                                   : reference_get(&p->s, name, &camera, 0.0f, &p->reference, r) == STAGE_OK;
    if (!has && !p->reference.cached) {
        return false;
    }
    measurement m;
    *figure = (genus_figure){NAN, NAN, NAN};
    if (!has) {
        return true;
    }
    out->reference_count++;
    picture measured = {0};
    bool ok = picture_init(&measured, width, height) &&
              measure(&p->s, name, &camera, NULL, 0.0, VELUM_QUALITY_HIGH, r, NULL, &measured, &m);
    picture_finish(&measured);
    *figure = ok ? (genus_figure){m.m_8.error, m.m.bias, r->noise_8} : *figure;
    return ok;
}

static void write_row(FILE *page, const genus_row *g, const genus_sheet *drawn) {
    fprintf(page,
            "\n## %s (%s)\n\nCoverage %g, from %g to %g m.\n\n![%s](%s.png)\n\n| | below | within | above |\n"
            "| --- | --- | --- | --- |\n",
            g->name, g->type, g->coverage, g->base_m, g->top_m, g->name, g->name);
    for (int hour = 0; hour < HOURS; hour++) {
        fprintf(page, "| %s |", hours[hour].name);
        for (int place = 0; place < PLACES; place++) {
            const genus_figure *f = &drawn->figures[hour][place];
            if (isnan(f->error)) {
                fprintf(page, " no reference |");
            } else {
                fprintf(page, " %.2f, %+.2f (%.2f) |", f->error, f->bias, f->noise);
            }
        }
        fprintf(page, "\n");
    }
}

static bool write_sheet(const program *p, const genus_row *g, const genus_sheet *drawn) {
    const uint32_t w = enlarged(p) * p->reference.width, h = enlarged(p) * p->reference.height;
    const uint32_t pair = drawn->reference_count > 0 ? 2 * w : w;
    char path[CHART_PATH];
    sheet out = {0};
    bool ok = sheet_init(&out, PLACES * (pair + 2 * GAP) - 2 * GAP, HOURS * (h + GAP) - GAP);
    for (uint32_t hour = 0; ok && hour < HOURS; hour++) {
        for (uint32_t place = 0; ok && place < PLACES; place++) {
            const picture *found = &drawn->found[hour][place], *r = &drawn->references[hour][place].picture;
            picture large = {0};
            const double exposure = picture_exposure(found); /* the reference's brightest are noise */
            const uint32_t x = place * (pair + 2 * GAP), y = hour * (h + GAP);
            sheet_put_picture(&out, x, y, found, exposure);
            if (r->count > 0) {
                ok = picture_enlarge(r, enlarged(p), &large);
                sheet_put_picture(&out, x + w, y, &large, exposure);
            }
            picture_finish(&large);
        }
    }
    snprintf(path, sizeof path, "%s/%s.png", p->folder, g->name);
    ok = ok && sheet_write(&out, path);
    sheet_finish(&out);
    return ok;
}

static bool draw_genus(program *p, const genus_row *g, FILE *page, genus_devices *devices) {
    genus_sheet drawn = {.reference_count = 0};
    bool ok = true;
    for (int hour = 0; ok && hour < HOURS; hour++) {
        for (int place = 0; ok && place < PLACES; place++) {
            ok = !reference_is_stopped() && draw_one(p, g, hour, place, &drawn);
        }
    }
    ok = ok && write_sheet(p, g, &drawn);
    if (ok) {
        write_row(page, g, &drawn);
    }
    for (int hour = 0; hour < HOURS; hour++) {
        for (int place = 0; place < PLACES; place++) {
            if (drawn.references[hour][place].parts > 0) {
                count_device(devices, drawn.references[hour][place].made_on);
            }
            picture_finish(&drawn.found[hour][place]);
            reference_finish(&drawn.references[hour][place]);
        }
    }
    return ok;
}

int genera_run(program *p) {
    struct files_folder folder = {.made = 0};
    genus_devices devices = {.counts = {0}};
    if (!files_prepare_folder(p->folder, &folder)) {
        return 1;
    }
    FILE *page = chart_create(p, "README.md");
    bool ok = page != NULL;
    if (ok) {
        fprintf(page,
                "# Ten genera\n\nMade by\n\n    velum-accuracy genera DIR --size %ux%u --seconds %g --error %g --paths "
                "%g%s\n\nEach sheet has the sun at morning (%g degrees high), noon (%g) and dusk (%g) from top to "
                "bottom; from below, within and above the layer from left to right; of each pair left preset high, "
                "right the reference, at the same exposure, of pixels %u times as wide, smoothed by a Gaussian "
                "(standard deviation: one of its pixels, for colours %d), for each is noisy. Figures, of the preset at "
                "the reference's size and of what is not smoothed: error of means over 8 x 8 pixels, bias of the whole "
                "picture (noise of the reference's means over 8 x 8, which is subtracted).\n",
                p->reference.width, p->reference.height, p->reference.seconds, p->reference.error, p->reference.paths,
                p->reference.cached ? " --cached" : "", hours[0].elevation_deg, hours[1].elevation_deg,
                hours[2].elevation_deg, enlarged(p), (int)PICTURE_COLOUR_DEVIATION);
    }
    for (int i = 0; ok && i < GENERA; i++) {
        ok = draw_genus(p, &genera[i], page, &devices);
    }
    /* The device is known once there is an engine. */
    ok = ok && fprintf(page, "\nMade on %s.\n", p->s.device_name) > 0;
    for (int i = 0; ok && i < DEVICES && devices.counts[i] > 0; i++) {
        ok = fprintf(page, "%u references are of %s.\n", devices.counts[i], devices.names[i]) > 0;
    }
    ok = chart_finish(page) && ok;
    files_remove_empty(&folder);
    return ok ? 0 : 1;
}
