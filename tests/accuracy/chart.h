/* velum-accuracy chart: what its parts share. */
#ifndef ACCURACY_CHART_H
#define ACCURACY_CHART_H

#include <stdio.h>

#include "pareto.h"
#include "program.h"

enum { CHART_POINTS_MAX = 512, CHART_PATH = 1200 };

/* Over scenes, one value of one curve: mean cost, root mean square error. */
typedef struct chart_point {
    const char *group, *name;
    method_motion motion;
    double value, ms, samples, square;
    double square_limit; /* against what the curve tends to; negative: unknown */
    uint32_t scenes;
    pareto_point by_ms, by_samples;
} chart_point;

typedef struct chart {
    const program *p;
    const char *method;
    chart_point points[CHART_POINTS_MAX];
    uint32_t count;
} chart;

FILE *chart_create(const program *p, const char *name);
bool chart_finish(FILE *file);                   /* false: could not be written */
bool chart_is_first(const chart *c, uint32_t k); /* of its group */
const char *chart_title(const char *group);
double chart_error(const chart_point *at);
/* Of a preset; null: not measured. */
const measurement *chart_preset(const program *p, const char *scene, int32_t quality);

/* False (reported): there is no gnuplot. */
bool chart_can_draw(void);
/* chart_draw.c: SVG and PNG of all curves of each group, of the presets, and of all points, by gnuplot. */
bool chart_draw(const chart *c);
/* chart_page.c: README.md, with tables and pictures. */
bool chart_write_page(const chart *c);

#endif
