/* Error against time: measures, then writes results.jsonl, data and scripts for gnuplot, SVG and PNG, tables in
 * Markdown, and a page with pictures. */
#include <errno.h>
#include <math.h>
#include <spawn.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include "pareto.h"
#include "program.h"

enum { CURVES_MAX = 64, POINTS_MAX = 512, PATH = 1200 };
extern char **environ;

/* The mean over scenes of one value of one curve. */
typedef struct point {
    const char *group, *name;
    method_motion motion;
    double value, ms, samples, square;
    uint32_t scenes;
    pareto_point by_ms, by_samples;
} point;

static FILE *create(const program *p, const char *name) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", p->folder, name);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "velum-accuracy: %s: cannot write: %s\n", path, strerror(errno));
    }
    return file;
}

static bool finish(FILE *file) {
    return file && fclose(file) == 0;
}

/* Pictures beside the page are of preset medium. */
static bool keep_picture(program *p, const measurement *m, const picture *found, const reference *r) {
    char path[PATH];
    if (strcmp(m->group, "preset") != 0 || m->value != (double)VELUM_QUALITY_MEDIUM) {
        return true;
    }
    double exposure = picture_exposure(&r->picture);
    snprintf(path, sizeof path, "%s/%s_ours.png", p->folder, m->scene);
    bool ok = picture_write_png(found, exposure, path);
    snprintf(path, sizeof path, "%s/%s_reference.png", p->folder, m->scene);
    ok = picture_write_png(&r->picture, exposure, path) && ok;
    snprintf(path, sizeof path, "%s/%s_difference.png", p->folder, m->scene);
    return picture_write_difference_png(found, &r->picture, 0.5, path) && ok;
}

static uint32_t collect(const program *p, point *points) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        uint32_t k = 0;
        while (k < count && (strcmp(points[k].group, m->group) != 0 || strcmp(points[k].name, m->name) != 0 ||
                             points[k].value != m->value)) {
            k++;
        }
        if (k == POINTS_MAX) {
            continue;
        }
        if (k == count) {
            points[count++] = (point){.group = m->group, .name = m->name, .motion = m->motion, .value = m->value};
        }
        points[k].ms += m->ms_per_megapixel;
        points[k].samples += m->samples + m->light_samples;
        points[k].square += program_error(p, m) * program_error(p, m);
        points[k].scenes++;
    }
    for (uint32_t k = 0; k < count; k++) {
        points[k].ms /= points[k].scenes;
        points[k].samples /= points[k].scenes;
        double error = sqrt(points[k].square / points[k].scenes);
        points[k].by_ms = (pareto_point){points[k].ms, error, false};
        points[k].by_samples = (pareto_point){points[k].samples, error, false};
    }
    return count;
}

/* The front is that of all curves of the group that move alike. */
static void mark_fronts(point *points, uint32_t count) {
    pareto_point by_ms[POINTS_MAX], by_samples[POINTS_MAX];
    for (uint32_t first = 0; first < count; first++) {
        uint32_t members = 0, index[POINTS_MAX];
        for (uint32_t k = 0; k < count; k++) {
            if (strcmp(points[k].group, points[first].group) == 0 && points[k].motion == points[first].motion) {
                by_ms[members] = points[k].by_ms;
                by_samples[members] = points[k].by_samples;
                index[members++] = k;
            }
        }
        pareto_mark(by_ms, members);
        pareto_mark(by_samples, members);
        for (uint32_t i = 0; i < members; i++) {
            points[index[i]].by_ms.on_front = by_ms[i].on_front;
            points[index[i]].by_samples.on_front = by_samples[i].on_front;
        }
    }
}

static bool run_gnuplot(const program *p, const char *script) {
    char path[PATH];
    snprintf(path, sizeof path, "%s/%s", p->folder, script);
    char program_name[] = "gnuplot";
    char *arguments[] = {program_name, path, NULL};
    pid_t child;
    int status = 0;
    int error = posix_spawnp(&child, program_name, NULL, NULL, arguments, environ);
    if (error || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fprintf(stderr, "velum-accuracy: gnuplot %s: %s\n", path, error ? strerror(error) : "failed");
        return false;
    }
    return true;
}

/* One axis of one group: a line for each curve, its values at the points, rings around the front. */
static bool draw_group(const program *p, const char *group, const point *points, uint32_t count, bool by_ms) {
    const char *names[CURVES_MAX];
    char name[256];
    uint32_t curves = 0;
    const char *axis = by_ms ? "ms" : "samples";
    snprintf(name, sizeof name, "%s_%s.gp", group, axis);
    FILE *file = create(p, name);
    if (!file) {
        return false;
    }
    for (uint32_t k = 0; k < count; k++) {
        bool known = strcmp(points[k].group, group) != 0;
        for (uint32_t c = 0; c < curves; c++) {
            known = known || strcmp(names[c], points[k].name) == 0;
        }
        if (!known && curves < CURVES_MAX) {
            names[curves++] = points[k].name;
        }
    }
    bool is_presets = strcmp(group, "preset") == 0;
    uint32_t lines = is_presets ? 1 : curves;
    for (uint32_t c = 0; c <= lines; c++) {
        bool front = c == lines;
        fprintf(file, "$%s%u << END\n", front ? "front" : "curve", front ? 0 : c);
        for (uint32_t k = 0; k < count; k++) {
            const pareto_point *at = by_ms ? &points[k].by_ms : &points[k].by_samples;
            bool here = strcmp(points[k].group, group) == 0;
            if (here && (front ? at->on_front : is_presets || strcmp(points[k].name, names[c]) == 0)) {
                char label[64];
                snprintf(label, sizeof label, "%g", points[k].value);
                fprintf(file, "%.6g %.6g \"%s\"\n", at->cost, fmax(at->error, 1e-6),
                        is_presets ? points[k].name : label);
            }
        }
        fprintf(file, "END\n");
    }
    fprintf(file,
            "set logscale xy\nset autoscale noextend\nset grid\nset key outside below\nset title \"%s\"\nset xlabel "
            "\"%s\"\n"
            "set ylabel \"relative root mean square error of luminance%s\"\nset offsets graph 0.08, graph 0.08, graph "
            "0.08, graph 0.08\n",
            group, by_ms ? "ms a megapixel" : "samples a pixel and frame, along rays and towards the sun",
            p->by_pixel ? "" : ", means over 8 x 8");
    for (int png = 0; png < 2; png++) {
        fprintf(file, "set terminal %s\nset output \"%s/%s_%s.%s\"\nplot ",
                png ? "pngcairo size 800,560" : "svg size 800,560 dynamic background \"white\"", p->folder, group, axis,
                png ? "png" : "svg");
        for (uint32_t c = 0; c < lines; c++) {
            fprintf(file,
                    "$curve%u using 1:2 with linespoints lw 2 pt 7 title \"%s\", $curve%u using 1:2:3 with labels "
                    "offset 0.5,0.8 font \",9\" notitle, ",
                    c, is_presets ? "presets" : names[c], c);
        }
        fprintf(file, "$front0 using 1:2 with points pt 6 ps 2.4 lw 2 lc rgb \"black\" title \"Pareto front\"\n");
    }
    return finish(file) && run_gnuplot(p, name);
}

static const measurement *preset_of(const program *p, const char *scene, int32_t quality) {
    for (uint32_t i = 0; i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        if (strcmp(m->group, "preset") == 0 && strcmp(m->scene, scene) == 0 && m->value == (double)quality) {
            return m;
        }
    }
    return NULL;
}

static void write_presets(const program *p, FILE *file) {
    fprintf(file,
            "Of %u x %u pixels, on %s: error of means over 8 x 8 pixels and of pixels (noise of the "
            "reference subtracted), bias, ms a megapixel. The reference's noise stands last, of both.\n\n| scene |",
            p->reference.width, p->reference.height, p->s.device_name);
    for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
        fprintf(file, " %s: 8 x 8 | pixels | bias | ms |", measure_preset(q));
    }
    fprintf(
        file, " noise |\n|%s\n",
        " --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    for (const scene_row *row = scene_rows; row->name; row++) {
        const measurement *last = NULL;
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            const measurement *m = preset_of(p, row->name, q);
            if (m && !last) {
                fprintf(file, "| %s |", row->name);
            }
            if (m) {
                fprintf(file, " %.3f | %.3f | %+.3f | %.0f |", m->m_8.error, m->m.error, m->m.bias,
                        m->ms_per_megapixel);
            } else if (last) {
                fprintf(file, " - | - | - | - |");
            }
            last = m ? m : last;
        }
        if (last) {
            fprintf(file, " %.3f, %.3f%s |\n", last->m_8.noise, last->m.noise, "");
        }
    }
}

static bool write_page(const program *p, const point *points, uint32_t count) {
    FILE *file = create(p, "index.html");
    if (!file) {
        return false;
    }
    fprintf(file,
            "<!doctype html><meta charset=\"utf-8\"><title>Velum: error against time</title>\n"
            "<style>body{font:15px sans-serif;margin:2em}img.p{width:320px;image-rendering:pixelated}"
            "td,th{padding:2px 8px;text-align:right}td:first-child{text-align:left}</style>\n"
            "<h1>Error against time</h1>\n<p>%s, %u x %u pixels. Error: relative root mean square error of luminance, "
            "each pixel over the greater of its reference and 1 %% of the scene's mean; noise of the reference "
            "subtracted. Made by <code>velum-accuracy chart</code>; <a href=\"tables.md\">tables</a>, "
            "<a href=\"results.jsonl\">results</a>.</p>\n",
            p->s.device_name, p->reference.width, p->reference.height);
    for (uint32_t k = 0; k < count; k++) {
        bool first = true;
        for (uint32_t i = 0; i < k; i++) {
            first = first && strcmp(points[i].group, points[k].group) != 0;
        }
        if (first) {
            fprintf(file,
                    "<img src=\"%s_ms.svg\" alt=\"%s against ms\"> <img src=\"%s_samples.svg\" alt=\"%s against "
                    "samples\"><br>\n",
                    points[k].group, points[k].group, points[k].group, points[k].group);
        }
    }
    fprintf(file,
            "<h2>Ours (medium), reference, difference</h2>\n<p>Red: ours is brighter; blue: darker; full colour at "
            "50 %%.</p>\n<table>\n");
    for (const scene_row *row = scene_rows; row->name; row++) {
        const measurement *m = preset_of(p, row->name, VELUM_QUALITY_MEDIUM);
        if (m) {
            fprintf(file,
                    "<tr><td>%s<br>%s<br>error %.3f (8 x 8: %.3f), bias %+.3f<br>99 %% within %.3f<br>noise %.3f (8 x "
                    "8: %.3f)%s<td><img class=p "
                    "src=\"%s_ours.png\"><td><img class=p src=\"%s_reference.png\"><td><img class=p "
                    "src=\"%s_difference.png\">\n",
                    row->name, row->about, m->m.error, m->m_8.error, m->m.bias, m->m.p99, m->m.noise, m->m_8.noise, "",
                    row->name, row->name, row->name);
        }
    }
    fprintf(file, "</table>\n");
    return finish(file);
}

static bool write_results(const program *p) {
    FILE *file = create(p, "results.jsonl");
    for (uint32_t i = 0; file && i < p->result_count; i++) {
        measure_print_json(file, &p->results[i]);
    }
    bool ok = finish(file);
    file = create(p, "tables.md");
    if (file) {
        fprintf(file, "## Presets\n\n");
        write_presets(p, file);
        fprintf(file, "\n## Published figures\n");
        tables_write(p, file);
    }
    return finish(file) && ok;
}

int chart_run(program *p) {
    static point points[POINTS_MAX];
    if (mkdir(p->folder, 0777) != 0 && errno != EEXIST) {
        fprintf(stderr, "velum-accuracy: %s: %s\n", p->folder, strerror(errno));
        return 1;
    }
    const char *method = p->method ? p->method : "all";
    if (p->preset_count == 0) {
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            p->presets[p->preset_count++] = q;
        }
    }
    p->on_picture = keep_picture;
    for (const scene_row *row = scene_rows; row->name; row++) {
        p->method = row->sweep ? method : NULL;
        if (program_wants(p, row)) {
            program_run_scene(p, row, true);
        }
    }
    uint32_t count = collect(p, points);
    mark_fronts(points, count);
    bool ok = write_results(p) && write_page(p, points, count);
    for (uint32_t k = 0; k < count; k++) {
        bool first = true;
        for (uint32_t i = 0; i < k; i++) {
            first = first && strcmp(points[i].group, points[k].group) != 0;
        }
        if (first) {
            ok = draw_group(p, points[k].group, points, count, true) && ok;
            ok = draw_group(p, points[k].group, points, count, false) && ok;
        }
    }
    return ok && p->failed == 0 ? 0 : 1;
}
