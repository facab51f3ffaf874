#include <math.h>
#include <spawn.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "chart.h"

enum { CURVES_MAX = 32 };
extern char **environ;

typedef enum chart_axis { BY_MS, BY_SAMPLES, BY_LIMIT } chart_axis;
static const char *const suffixes[] = {"ms", "samples", "limit"};

/* M. Okabe, K. Ito 2008: told apart by all eyes. */
static const char *const colours[] = {"#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#999999"};
enum { COLOURS = sizeof colours / sizeof colours[0] };

typedef struct range {
    double low, high;
} range;

static double cost_of(const chart_point *at, chart_axis axis) {
    return axis == BY_MS ? at->ms : at->samples;
}

static double error_of(const chart_point *at, chart_axis axis) {
    return fmax(axis == BY_LIMIT ? sqrt(at->square_limit / at->scenes) : chart_error(at), 1e-5);
}

/* What lies on the axes at all: with a limit, not the limit itself. */
static bool is_drawn(const chart_point *at, const char *group, chart_axis axis) {
    bool there = strcmp(at->group, group) == 0;
    return there && (axis != BY_LIMIT || at->square_limit > 1e-10) && cost_of(at, axis) > 0.0;
}

static void extend(range *r, double value) {
    r->low = fmin(r->low, value);
    r->high = fmax(r->high, value);
}

/* Ticks of 1, 2 and 5 where the scale is logarithmic. */
static void write_axis(FILE *file, char name, range r, const char *label) {
    bool logarithmic = r.high > 3.0 * r.low;
    fprintf(file, "set %clabel \"%s\"\n", name, label);
    if (!logarithmic) {
        double margin = fmax(0.15 * (r.high - r.low), 0.02 * r.high);
        fprintf(file, "unset logscale %c\nset %ctics autofreq\nset %crange [%.6g:%.6g]\n", name, name, name,
                r.low - margin, r.high + margin);
        return;
    }
    double margin = pow(r.high / r.low, 0.08);
    fprintf(file, "set logscale %c\nset %crange [%.6g:%.6g]\nset %ctics (", name, name, r.low / margin, r.high * margin,
            name);
    bool first = true;
    bool sparse = r.high > 1e4 * r.low;
    for (int decade = -6; decade < 9; decade++) {
        for (int k = 0; k < (sparse ? 1 : 3); k++) {
            double at = pow(10.0, decade) * (k == 0 ? 1.0 : k == 1 ? 2.0 : 5.0);
            if (at >= r.low / margin && at <= r.high * margin) {
                fprintf(file, "%s\"%.6g\" %.6g", first ? "" : ", ", at, at);
                first = false;
            }
        }
    }
    fprintf(file, ")\n");
}

static bool run_gnuplot(char *option, char *argument) {
    char program_name[] = "gnuplot";
    char *arguments[] = {program_name, option, argument, NULL};
    pid_t child;
    int status = 0;
    int error = posix_spawnp(&child, program_name, NULL, NULL, arguments, environ);
    if (error || waitpid(child, &status, 0) != child || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        fprintf(stderr, "velum-accuracy: gnuplot %s: %s\n", option, error ? strerror(error) : "failed");
        return false;
    }
    return true;
}

bool chart_can_draw(void) {
    char option[] = "-e", argument[] = "exit";
    return run_gnuplot(option, argument);
}

static bool run_script(const program *p, const char *script) {
    char path[CHART_PATH];
    snprintf(path, sizeof path, "%s/%s", p->folder, script);
    bool ok = run_gnuplot(path, NULL);
    if (ok) {
        unlink(path);
    }
    return ok;
}

static void write_head(FILE *file, const chart *c, const char *title, chart_axis axis, range x, range y) {
    static const char *const costs[] = {"ms a megapixel",
                                        "samples of density a pixel and frame, with those towards the sun",
                                        "samples of density a pixel and frame, with those towards the sun"};
    char error[128];
    snprintf(error, sizeof error, "%s",
             axis == BY_LIMIT ? "relative r.m.s. difference from the finest of the same"
             : c->p->by_pixel ? "relative r.m.s. error of luminance"
                              : "relative r.m.s. error of luminance, means over 8 x 8");
    fprintf(file,
            "set title \"%s\" noenhanced\nset grid lt 1 lw 0.7 lc rgb \"#cccccc\"\nset key outside right top vertical "
            "Left reverse samplen 2 spacing 1.3\n",
            title);
    write_axis(file, 'x', x, costs[axis]);
    write_axis(file, 'y', y, error);
}

/* The same plot twice. */
static void write_plot(FILE *file, const program *p, const char *name, const char *plot) {
    for (int png = 0; png < 2; png++) {
        fprintf(file, "set terminal %s noenhanced\nset output \"%s/%s.%s\"\nplot %s\n",
                png ? "pngcairo size 900,500 font \"Sans,10\""
                    : "svg size 1060,600 font \"Sans,13\" background \"white\"",
                p->folder, name, png ? "png" : "svg", plot);
    }
}

static uint32_t names_of(const chart *c, const char *group, const char *names[CURVES_MAX]) {
    uint32_t count = 0;
    for (uint32_t k = 0; k < c->count; k++) {
        bool known = strcmp(c->points[k].group, group) != 0;
        for (uint32_t i = 0; i < count; i++) {
            known = known || strcmp(names[i], c->points[k].name) == 0;
        }
        if (!known && count < CURVES_MAX) {
            names[count++] = c->points[k].name;
        }
    }
    return count;
}

static void write_points(FILE *file, const chart *c, const char *group, const char *name, chart_axis axis, bool front) {
    for (uint32_t k = 0; k < c->count; k++) {
        const chart_point *at = &c->points[k];
        bool on_front = axis == BY_MS ? at->by_ms.on_front : at->by_samples.on_front;
        if (is_drawn(at, group, axis) && (!name || strcmp(at->name, name) == 0) && (!front || on_front)) {
            fprintf(file, "%.6g %.6g \"%g\"\n", cost_of(at, axis), error_of(at, axis), at->value);
        }
    }
}

/* A line for each curve, its values at the points, rings around the front. */
static bool draw_group(const chart *c, const char *group, chart_axis axis) {
    const char *names[CURVES_MAX];
    char name[128], script[160], plot[8192];
    range x = {INFINITY, 0.0}, y = {INFINITY, 0.0};
    uint32_t drawn = 0;
    for (uint32_t k = 0; k < c->count; k++) {
        if (is_drawn(&c->points[k], group, axis)) {
            extend(&x, cost_of(&c->points[k], axis));
            extend(&y, error_of(&c->points[k], axis));
            drawn++;
        }
    }
    if (drawn == 0) {
        return true;
    }
    snprintf(name, sizeof name, "%s_%s", group, suffixes[axis]);
    snprintf(script, sizeof script, "%s.gp", name);
    FILE *file = chart_create(c->p, script);
    if (!file) {
        return false;
    }
    uint32_t curves = names_of(c, group, names);
    size_t used = 0;
    for (uint32_t i = 0; i < curves; i++) {
        fprintf(file, "$curve%u << END\n", i);
        write_points(file, c, group, names[i], axis, false);
        fprintf(file, "END\n");
        const char *colour = colours[i % COLOURS];
        used += (size_t)snprintf(plot + used, sizeof plot - used,
                                 "$curve%u using 1:2 with linespoints lw 2 pt 7 ps 0.7 lc rgb \"%s\" title \"%s\", "
                                 "$curve%u using 1:2:3 with labels offset 0,0.8 font \",9\" tc rgb \"%s\" notitle, ",
                                 i, colour, names[i], i, colour);
    }
    const char *unit = "";
    for (const method_row *row = method_rows; row->group && !*unit; row++) {
        unit = strcmp(row->group, group) == 0 ? row->unit : "";
    }
    char title[256];
    snprintf(title, sizeof title, "%s%s%s%s", chart_title(group), *unit ? " (at the points: " : "", unit,
             *unit ? ")" : "");
    write_head(file, c, title, axis, x, y);
    if (axis != BY_LIMIT) {
        fprintf(file, "$front << END\n");
        write_points(file, c, group, NULL, axis, true);
        fprintf(file, "END\n");
        snprintf(plot + used, sizeof plot - used,
                 "$front using 1:2 with points pt 6 ps 2 lw 1.5 lc rgb \"black\" title \"Pareto front\"");
    } else {
        plot[used - 2] = '\0';
    }
    write_plot(file, c->p, name, plot);
    return chart_finish(file) && run_script(c->p, script);
}

static void write_scene_lines(FILE *file, const chart *c, chart_axis axis, range *x, range *y) {
    fprintf(file, "$scenes << END\n");
    for (const scene_row *row = scene_rows; row->name; row++) {
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            const measurement *m = chart_preset(c->p, row->name, q);
            if (m) {
                double cost = axis == BY_MS ? m->ms_per_megapixel : m->samples + m->light_samples;
                double error = fmax(program_error(c->p, m), 1e-4);
                if (!(cost > 0.0)) { /* no place on the axis */
                    continue;
                }
                fprintf(file, "%.6g %.6g\n", cost, error);
                extend(x, cost);
                extend(y, error);
            }
        }
        fprintf(file, "\n");
    }
    fprintf(file, "END\n");
}

/* Each scene's, and over all. */
static bool draw_presets(const chart *c, chart_axis axis) {
    char name[128], script[160], plot[1024];
    range x = {INFINITY, 0.0}, y = {INFINITY, 0.0};
    snprintf(name, sizeof name, "preset_%s", suffixes[axis]);
    snprintf(script, sizeof script, "%s.gp", name);
    FILE *file = chart_create(c->p, script);
    if (!file) {
        return false;
    }
    write_scene_lines(file, c, axis, &x, &y);
    fprintf(file, "$all << END\n");
    for (uint32_t k = 0; k < c->count; k++) {
        const chart_point *at = &c->points[k];
        if (is_drawn(at, "preset", axis)) {
            fprintf(file, "%.6g %.6g \"%s\"\n", cost_of(at, axis), error_of(at, axis), at->name);
            extend(&x, cost_of(at, axis));
            extend(&y, error_of(at, axis));
        }
    }
    fprintf(file, "END\n");
    write_head(file, c, chart_title("preset"), axis, x, y);
    snprintf(
        plot, sizeof plot,
        "$scenes using 1:2 with linespoints lw 1 pt 7 ps 0.4 lc rgb \"#bbbbbb\" title \"each scene\", $all using 1:2 "
        "with linespoints lw 3 pt 7 ps 1.2 lc rgb \"%s\" title \"over all scenes\", $all using 1:2:3 with labels "
        "offset 0,1.1 font \",11\" notitle",
        colours[0]);
    write_plot(file, c->p, name, plot);
    return chart_finish(file) && run_script(c->p, script);
}

/* What each point would be on the scenes that methods are compared on: presets too. */
static bool preset_on_sweeps(const chart *c, int32_t quality, double *ms, double *error) {
    uint32_t count = 0;
    *ms = *error = 0.0;
    for (const scene_row *row = scene_rows; row->name; row++) {
        const measurement *m = row->sweep ? chart_preset(c->p, row->name, quality) : NULL;
        if (m) {
            *ms += m->ms_per_megapixel;
            *error += program_error(c->p, m) * program_error(c->p, m);
            count++;
        }
    }
    *ms /= count ? count : 1;
    *error = sqrt(*error / (count ? count : 1));
    return count > 0;
}

/* Everything that stands still, on one chart. */
static bool draw_all(const chart *c) {
    char plot[8192];
    range x = {INFINITY, 0.0}, y = {INFINITY, 0.0};
    pareto_point front[CHART_POINTS_MAX];
    uint32_t groups = 0, members = 0;
    size_t used = 0;
    FILE *file = chart_create(c->p, "all_ms.gp");
    if (!file) {
        return false;
    }
    for (uint32_t k = 0; k < c->count; k++) {
        const char *group = c->points[k].group;
        if (!chart_is_first(c, k) || strcmp(group, "preset") == 0) {
            continue;
        }
        fprintf(file, "$group%u << END\n", groups);
        for (uint32_t i = k; i < c->count; i++) {
            const chart_point *at = &c->points[i];
            if (is_drawn(at, group, BY_MS) && at->motion == MOTION_STILL) {
                fprintf(file, "%.6g %.6g\n", at->ms, chart_error(at));
                extend(&x, at->ms);
                extend(&y, chart_error(at));
                front[members++] = at->by_ms;
            }
        }
        fprintf(file, "END\n");
        used += (size_t)snprintf(plot + used, sizeof plot - used,
                                 "$group%u using 1:2 with points pt %u ps 0.8 lc rgb \"%s\" title \"%s\", ", groups,
                                 groups < COLOURS ? 7 : 5, colours[groups % COLOURS], chart_title(group));
        groups++;
    }
    fprintf(file, "$presets << END\n");
    for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
        double ms, error;
        if (preset_on_sweeps(c, q, &ms, &error)) {
            fprintf(file, "%.6g %.6g \"%s\"\n", ms, error, measure_preset(q));
            extend(&x, ms);
            extend(&y, error);
            front[members++] = (pareto_point){ms, error, false};
        }
    }
    pareto_mark(front, members);
    fprintf(file, "END\n$front << END\n");
    for (uint32_t i = 0; i < members; i++) {
        if (front[i].on_front) {
            fprintf(file, "%.6g %.6g\n", front[i].cost, front[i].error);
        }
    }
    fprintf(file, "END\n");
    write_head(file, c, "All methods and presets, on the scenes that methods are compared on", BY_MS, x, y);
    snprintf(
        plot + used, sizeof plot - used,
        "$front using 1:2 smooth unique with lines lw 1.5 dt 2 lc rgb \"black\" title \"Pareto front\", $presets "
        "using 1:2 with linespoints lw 2 pt 9 ps 1.6 lc rgb \"black\" title \"presets\", $presets using 1:2:3 with "
        "labels offset 0,1.1 notitle");
    write_plot(file, c->p, "all_ms", plot);
    return chart_finish(file) && run_script(c->p, "all_ms.gp");
}

bool chart_draw(const chart *c) {
    bool ok = true, methods = false;
    for (uint32_t k = 0; k < c->count; k++) {
        const char *group = c->points[k].group;
        if (!chart_is_first(c, k)) {
            continue;
        }
        if (strcmp(group, "preset") == 0) {
            ok = draw_presets(c, BY_MS) && ok;
            ok = draw_presets(c, BY_SAMPLES) && ok;
            continue;
        }
        methods = true;
        for (chart_axis axis = BY_MS; axis <= BY_LIMIT; axis++) {
            ok = draw_group(c, group, axis) && ok;
        }
    }
    return (!methods || draw_all(c)) && ok;
}
