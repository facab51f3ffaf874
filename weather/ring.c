#include "ring.h"

#include <math.h>
#include <stdlib.h>

static const double touch_deg = 1e-6; /* 0.1 m on a meridian */
enum { STEPS_PER_EDGE = 64, STEPS_LEAST = 1 << 16 };

typedef struct box {
    double south, north, west, east;
} box;

/* A binary tree of boxes around runs of edges: node i holds nodes 2i and 2i + 1, node `leaves` + i holds edge i. */
typedef struct search {
    const velum_lat_lon *points;
    uint32_t count, leaves;
    box *boxes;
    uint64_t steps_left;
    velum_lat_lon at;
} search;

static int overlap(const box *a, const box *b) {
    return a->south <= b->north && b->south <= a->north && a->west <= b->east && b->west <= a->east;
}

/* Of `p` from the line through a and b, to its left, degrees; 0 where it touches. */
static double offset_deg(const velum_lat_lon *a, const velum_lat_lon *b, const velum_lat_lon *p) {
    double dx = b->lon_deg - a->lon_deg, dy = b->lat_deg - a->lat_deg;
    double length = hypot(dx, dy);
    double offset = length > 0 ? (dx * (p->lat_deg - a->lat_deg) - dy * (p->lon_deg - a->lon_deg)) / length : 0;
    return fabs(offset) > touch_deg ? offset : 0;
}

static int edges_cross(search *s, uint32_t first, uint32_t second) {
    const velum_lat_lon *a = &s->points[first], *b = &s->points[(first + 1) % s->count];
    const velum_lat_lon *c = &s->points[second], *d = &s->points[(second + 1) % s->count];
    double at_c = offset_deg(a, b, c), at_d = offset_deg(a, b, d);
    if (!(at_c * at_d < 0) || !(offset_deg(c, d, a) * offset_deg(c, d, b) < 0)) {
        return 0;
    }
    double t = at_c / (at_c - at_d);
    s->at = (velum_lat_lon){.lat_deg = c->lat_deg + t * (d->lat_deg - c->lat_deg),
                            .lon_deg = c->lon_deg + t * (d->lon_deg - c->lon_deg)};
    return 1;
}

/* Of two nodes of the same level. */
static int nodes_cross(search *s, uint32_t a, uint32_t b) {
    if (s->steps_left == 0 || !overlap(&s->boxes[a], &s->boxes[b])) {
        return 0;
    }
    s->steps_left--;
    if (a >= s->leaves) {
        return edges_cross(s, a - s->leaves, b - s->leaves);
    }
    return nodes_cross(s, 2 * a, 2 * b) || nodes_cross(s, 2 * a, 2 * b + 1) || nodes_cross(s, 2 * a + 1, 2 * b) ||
           nodes_cross(s, 2 * a + 1, 2 * b + 1);
}

velum_result weather_ring_check(const velum_lat_lon *points, uint32_t count, velum_lat_lon *at) {
    search s = {.points = points, .count = count, .leaves = 1};
    velum_result result = VELUM_OK;
    while (s.leaves < count) {
        s.leaves *= 2;
    }
    s.steps_left = STEPS_LEAST + (uint64_t)STEPS_PER_EDGE * count;
    s.boxes = malloc(2 * (size_t)s.leaves * sizeof *s.boxes);
    if (!s.boxes) {
        return VELUM_ERROR_OUT_OF_MEMORY;
    }
    for (uint32_t i = 0; i < s.leaves; i++) {
        box *leaf = &s.boxes[s.leaves + i];
        *leaf = (box){INFINITY, -INFINITY, INFINITY, -INFINITY};
        if (i < count) {
            const velum_lat_lon *p = &points[i], *q = &points[(i + 1) % count];
            *leaf = (box){fmin(p->lat_deg, q->lat_deg), fmax(p->lat_deg, q->lat_deg), fmin(p->lon_deg, q->lon_deg),
                          fmax(p->lon_deg, q->lon_deg)};
        }
    }
    for (uint32_t i = s.leaves - 1; i > 0; i--) {
        const box *a = &s.boxes[2 * i], *b = &s.boxes[2 * i + 1];
        s.boxes[i] =
            (box){fmin(a->south, b->south), fmax(a->north, b->north), fmin(a->west, b->west), fmax(a->east, b->east)};
    }
    for (uint32_t i = 1; i < s.leaves && result == VELUM_OK; i++) {
        if (nodes_cross(&s, 2 * i, 2 * i + 1)) {
            *at = s.at;
            result = VELUM_ERROR_ARGUMENT;
        }
    }
    free(s.boxes);
    return result;
}
