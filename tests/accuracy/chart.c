/* Error against time: measures, then writes results.jsonl, charts, and a page with tables and pictures. */
#include "chart.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "sample_host/files.h"

enum { COLUMNS = 5 };

static chart own;
static sheet strip;

FILE *chart_create(const program *p, const char *name) {
    char path[CHART_PATH];
    snprintf(path, sizeof path, "%s/%s", p->folder, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "velum-accuracy: %s: cannot write: %s\n", path, strerror(errno));
    }
    return file;
}

bool chart_finish(FILE *file) {
    return file && fclose(file) == 0;
}

bool chart_is_first(const chart *c, uint32_t k) {
    for (uint32_t i = 0; i < k; i++) {
        if (strcmp(c->points[i].group, c->points[k].group) == 0) {
            return false;
        }
    }
    return true;
}

double chart_error(const chart_point *at) {
    return sqrt(at->square / at->scenes);
}

const char *chart_title(const char *group) {
    static const char *const titles[][2] = {{"preset", "Presets"},
                                            {"steps", "Step length"},
                                            {"growth", "Growth of steps with distance"},
                                            {"march_steps", "Steps along a ray, at most"},
                                            {"sun", "Samples towards the sun"},
                                            {"rays", "Rays a frame, still and moving"},
                                            {"orders", "Multiple scattering"},
                                            {"integrators", "Integrators"},
                                            {"empty", "Long steps in empty air"},
                                            {"exit", "Early exit"},
                                            {"thin", "Thin samples skipped"},
                                            {"ladder", "Ford's ladder"}};
    for (size_t i = 0; i < sizeof titles / sizeof titles[0]; i++) {
        if (strcmp(group, titles[i][0]) == 0) {
            return titles[i][1];
        }
    }
    return group;
}

const measurement *chart_preset(const program *p, const char *scene, int32_t quality) {
    for (uint32_t i = 0; i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        if (strcmp(m->group, "preset") == 0 && strcmp(m->scene, scene) == 0 && m->value == (double)quality) {
            return m;
        }
    }
    return NULL;
}

/* Presets from left to right, then the reference; their differences below. */
static bool keep_picture(program *p, const measurement *m, const picture *found, const reference *r) {
    (void)p;
    if (strcmp(m->group, "preset") != 0) {
        return true;
    }
    double exposure = picture_exposure(&r->picture);
    uint32_t column = (uint32_t)m->value - VELUM_QUALITY_LOW;
    uint32_t w = found->width + 2, h = found->height + 2;
    if (!strip.bytes && !sheet_init(&strip, COLUMNS * w - 2, 2 * h - 2)) {
        return false;
    }
    sheet_put_picture(&strip, column * w, 0, found, exposure);
    sheet_put_picture(&strip, (COLUMNS - 1) * w, 0, &r->picture, exposure);
    sheet_put_noise(&strip, (COLUMNS - 1) * w, h, &r->picture, 0.5);
    return sheet_put_difference(&strip, column * w, h, found, &r->picture, 0.5);
}

static bool finish_strip(const program *p, const char *scene) {
    char path[CHART_PATH];
    snprintf(path, sizeof path, "%s/%s.png", p->folder, scene);
    bool ok = !strip.bytes || sheet_write(&strip, path);
    sheet_finish(&strip);
    return ok;
}

static void collect(chart *c) {
    const program *p = c->p;
    c->count = 0;
    for (uint32_t i = 0; i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        uint32_t k = 0;
        while (k < c->count && (strcmp(c->points[k].group, m->group) != 0 || strcmp(c->points[k].name, m->name) != 0 ||
                                c->points[k].value != m->value)) {
            k++;
        }
        if (k == CHART_POINTS_MAX) {
            fprintf(stderr, "velum-accuracy: more points than %d\n", CHART_POINTS_MAX);
            return;
        }
        chart_point *at = &c->points[k];
        if (k == c->count) {
            *at = (chart_point){.group = m->group, .name = m->name, .motion = m->motion, .value = m->value};
            c->count++;
        }
        at->ms += m->ms_per_megapixel;
        at->samples += m->samples + m->light_samples;
        at->square += program_error(p, m) * program_error(p, m);
        at->square_limit += m->error_limit < 0.0 ? -1e9 : m->error_limit * m->error_limit; /* stays negative */
        at->scenes++;
    }
    for (uint32_t k = 0; k < c->count; k++) {
        chart_point *at = &c->points[k];
        at->ms /= at->scenes;
        at->samples /= at->scenes;
        at->by_ms = (pareto_point){at->ms, chart_error(at), false};
        at->by_samples = (pareto_point){at->samples, chart_error(at), false};
    }
}

/* The front is that of all curves of the group that move alike. */
static void mark_fronts(chart *c) {
    static pareto_point by_ms[CHART_POINTS_MAX], by_samples[CHART_POINTS_MAX];
    for (uint32_t first = 0; first < c->count; first++) {
        uint32_t members = 0, index[CHART_POINTS_MAX];
        for (uint32_t k = 0; k < c->count; k++) {
            if (strcmp(c->points[k].group, c->points[first].group) == 0 &&
                c->points[k].motion == c->points[first].motion) {
                by_ms[members] = c->points[k].by_ms;
                by_samples[members] = c->points[k].by_samples;
                index[members++] = k;
            }
        }
        pareto_mark(by_ms, members);
        pareto_mark(by_samples, members);
        for (uint32_t i = 0; i < members; i++) {
            c->points[index[i]].by_ms.on_front = by_ms[i].on_front;
            c->points[index[i]].by_samples.on_front = by_samples[i].on_front;
        }
    }
}

int chart_run(program *p) {
    struct files_folder folder;
    if (!chart_can_draw() || !files_prepare_folder(p->folder, &folder)) {
        return 1;
    }
    p->log = chart_create(p, "results.jsonl");
    if (!p->log) {
        return 1;
    }
    const char *method = p->method ? p->method : "all";
    if (p->preset_count == 0) {
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            p->presets[p->preset_count++] = q;
        }
    }
    p->on_picture = keep_picture;
    bool ok = true;
    for (const scene_row *row = scene_rows; row->name; row++) {
        p->method = row->sweep ? method : NULL;
        if (program_wants(p, row)) {
            program_run_scene(p, row, true);
            ok = finish_strip(p, row->name) && ok;
        }
    }
    own.p = p;
    own.method = method;
    collect(&own);
    mark_fronts(&own);
    ok = chart_finish(p->log) && ok;
    p->log = NULL;
    ok = chart_draw(&own) && ok;
    ok = chart_write_page(&own) && ok;
    return ok && p->failed == 0 ? 0 : 1;
}
