#include "pareto.h"

#include <math.h>

static bool beats(const pareto_point *a, const pareto_point *b) {
    return a->cost <= b->cost && a->error <= b->error && (a->cost < b->cost || a->error < b->error);
}

void pareto_mark(pareto_point *points, uint32_t count) {
    for (uint32_t i = 0; i < count; i++) {
        points[i].on_front = !isnan(points[i].cost) && !isnan(points[i].error);
        for (uint32_t k = 0; k < count && points[i].on_front; k++) {
            points[i].on_front = !beats(&points[k], &points[i]);
        }
    }
}
