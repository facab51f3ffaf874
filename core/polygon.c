#include "polygon.h"

#include "geodesy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct edge {
    double lat1, lon1, lat2, lon2;
    bool boundary; /* false: counts for inside only */
} edge;

#define MAX_CUTS 4096u
#define MAX_BANDS 1024u

/* Edges stand in bands of latitude, each edge in every band that it touches. */
struct core_polygon {
    core_lat_lon_box box;
    double breadth_m, longest_edge_m;
    uint32_t band_count;
    uint32_t *band_start; /* band_count + 1 */
    edge *edges;          /* by band */
};

static double meridian_radius_m(double sin_lat) {
    double w = 1.0 - CORE_WGS84_E2 * sin_lat * sin_lat;
    return CORE_WGS84_A_M * (1.0 - CORE_WGS84_E2) / (w * sqrt(w));
}

static double normal_radius_m(double sin_lat) {
    return CORE_WGS84_A_M / sqrt(1.0 - CORE_WGS84_E2 * sin_lat * sin_lat);
}

static uint32_t band_of(const core_polygon *polygon, double lat) {
    double height = polygon->box.north - polygon->box.south;
    double at = height > 0.0 ? (lat - polygon->box.south) / height * polygon->band_count : 0.0;
    return (uint32_t)fmin(fmax(at, 0.0), (double)polygon->band_count - 1.0);
}

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

static bool on_antimeridian(const edge *e) {
    return e->lon1 == e->lon2 && (e->lon1 == 180.0 || e->lon1 == -180.0);
}

/* Replaces the edges along the antimeridian by: the same, not boundary, for the inside; and boundary pieces where only
 * one side has an edge. `edges` has room for three times as many. Returns the new count. */
static uint32_t resolve_antimeridian(edge *edges, uint32_t count, double *cuts) {
    uint32_t cut_count = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (on_antimeridian(&edges[i])) {
            cuts[cut_count++] = edges[i].lat1;
            cuts[cut_count++] = edges[i].lat2;
        }
    }
    if (cut_count > MAX_CUTS) {
        return count;
    }
    /* Those edges first, so that only they are looked at. */
    uint32_t seam = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (on_antimeridian(&edges[i])) {
            edge swap = edges[seam];
            edges[seam++] = edges[i];
            edges[i] = swap;
        }
    }
    qsort(cuts, cut_count, sizeof *cuts, compare_doubles);
    uint32_t end = count;
    for (uint32_t k = 0; k + 1 < cut_count; k++) {
        double low = cuts[k];
        double high = cuts[k + 1];
        bool east = false;
        bool west = false;
        if (!(high > low)) {
            continue;
        }
        for (uint32_t i = 0; i < seam; i++) {
            const edge *e = &edges[i];
            if (fmin(e->lat1, e->lat2) <= low && fmax(e->lat1, e->lat2) >= high) {
                *(e->lon1 > 0.0 ? &east : &west) ^= true;
            }
        }
        if (east != west) {
            double lon = east ? 180.0 : -180.0;
            /* Twice: the parity of crossings stays as it was. */
            edges[end++] = (edge){low, lon, high, lon, true};
            edges[end++] = (edge){low, lon, high, lon, true};
        }
    }
    for (uint32_t i = 0; i < seam; i++) {
        edges[i].boundary = false;
    }
    return end;
}

static void measure(core_polygon *polygon, const edge *edges, uint32_t count) {
    double area = 0.0;
    double perimeter = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        const edge *e = &edges[i];
        double sin1 = sin(e->lat1 * CORE_DEG);
        double sin2 = sin(e->lat2 * CORE_DEG);
        double sin_mean = sin(0.5 * (e->lat1 + e->lat2) * CORE_DEG);
        double dx = (e->lon2 - e->lon1) * CORE_DEG * CORE_RADIUS_M;
        double dy = (e->lat2 - e->lat1) * CORE_DEG * CORE_RADIUS_M;
        double widest = sqrt(1.0 - fmin(sin1 * sin1, sin2 * sin2));
        area += 0.5 * dx * (sin1 + sin2) * CORE_RADIUS_M;
        if (e->boundary) {
            perimeter += hypot(dx * sqrt(1.0 - sin_mean * sin_mean), dy);
        }
        polygon->longest_edge_m = fmax(polygon->longest_edge_m, hypot(dx * widest, dy));
    }
    polygon->breadth_m = perimeter > 0.0 ? fabs(area) / perimeter : CORE_RADIUS_M;
}

static uint64_t entries_in_bands(const core_polygon *polygon, const edge *edges, uint32_t count) {
    uint64_t entries = 0;
    for (uint32_t i = 0; i < count; i++) {
        entries += band_of(polygon, fmax(edges[i].lat1, edges[i].lat2)) -
                   band_of(polygon, fmin(edges[i].lat1, edges[i].lat2)) + 1u;
    }
    return entries;
}

core_polygon *core_polygon_create(const velum_lat_lon *points, const uint32_t *ring_sizes, uint32_t ring_count) {
    core_polygon *polygon = calloc(1, sizeof *polygon);
    edge *edges = NULL;
    double *cuts = NULL;
    uint32_t *fill = NULL;
    uint32_t count = 0;
    size_t total = 0;
    for (uint32_t r = 0; r < ring_count; r++) {
        total += ring_sizes[r];
    }
    /* Pieces between sorted cuts: fewer than cuts, two entries each. */
    edges = calloc(total * 5 + 1, sizeof *edges);
    cuts = calloc(total * 2 + 1, sizeof *cuts);
    if (!polygon || !edges || !cuts) {
        goto error;
    }
    polygon->box = (core_lat_lon_box){points[0].lat_deg, points[0].lat_deg, points[0].lon_deg, points[0].lon_deg};
    size_t first = 0;
    for (uint32_t r = 0; r < ring_count; r++) {
        for (uint32_t i = 0; i < ring_sizes[r]; i++) {
            const velum_lat_lon *p = &points[first + i];
            const velum_lat_lon *q = &points[first + (i + 1 < ring_sizes[r] ? i + 1 : 0)];
            polygon->box.south = fmin(polygon->box.south, p->lat_deg);
            polygon->box.north = fmax(polygon->box.north, p->lat_deg);
            polygon->box.west = fmin(polygon->box.west, p->lon_deg);
            polygon->box.east = fmax(polygon->box.east, p->lon_deg);
            if (p->lat_deg != q->lat_deg || p->lon_deg != q->lon_deg) {
                bool pole = p->lat_deg == q->lat_deg && fabs(p->lat_deg) == 90.0;
                edges[count++] = (edge){p->lat_deg, p->lon_deg, q->lat_deg, q->lon_deg, !pole};
            }
        }
        first += ring_sizes[r];
    }
    count = resolve_antimeridian(edges, count, cuts);
    measure(polygon, edges, count);

    polygon->band_count = count / 4 < 1 ? 1 : count / 4 > MAX_BANDS ? MAX_BANDS : count / 4;
    while (polygon->band_count > 1 && entries_in_bands(polygon, edges, count) > (uint64_t)count * 6) {
        polygon->band_count /= 2;
    }
    polygon->band_start = calloc((size_t)polygon->band_count + 1, sizeof *polygon->band_start);
    fill = calloc((size_t)polygon->band_count + 1, sizeof *fill);
    if (!polygon->band_start || !fill) {
        goto error;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t last = band_of(polygon, fmax(edges[i].lat1, edges[i].lat2));
        for (uint32_t b = band_of(polygon, fmin(edges[i].lat1, edges[i].lat2)); b <= last; b++) {
            polygon->band_start[b + 1]++;
        }
    }
    for (uint32_t b = 0; b < polygon->band_count; b++) {
        polygon->band_start[b + 1] += polygon->band_start[b];
        fill[b] = polygon->band_start[b];
    }
    polygon->edges = calloc((size_t)polygon->band_start[polygon->band_count] + 1, sizeof *polygon->edges);
    if (!polygon->edges) {
        goto error;
    }
    for (uint32_t i = 0; i < count; i++) {
        uint32_t last = band_of(polygon, fmax(edges[i].lat1, edges[i].lat2));
        for (uint32_t b = band_of(polygon, fmin(edges[i].lat1, edges[i].lat2)); b <= last; b++) {
            polygon->edges[fill[b]++] = edges[i];
        }
    }
    free(fill);
    free(cuts);
    free(edges);
    return polygon;
error:
    free(fill);
    free(cuts);
    free(edges);
    core_polygon_destroy(polygon);
    return NULL;
}

void core_polygon_destroy(core_polygon *polygon) {
    if (polygon) {
        free(polygon->band_start);
        free(polygon->edges);
        free(polygon);
    }
}

size_t core_polygon_bytes(const core_polygon *polygon) {
    return sizeof *polygon + (polygon->band_count + 1) * sizeof *polygon->band_start +
           polygon->band_start[polygon->band_count] * sizeof *polygon->edges;
}

double core_polygon_breadth_m(const core_polygon *polygon) {
    return polygon->breadth_m;
}

double core_polygon_longest_edge_m(const core_polygon *polygon) {
    return polygon->longest_edge_m;
}

/* Even-odd, by the crossings of the parallel east of the point. */
static bool inside(const core_polygon *polygon, double lat, double lon) {
    const core_lat_lon_box *box = &polygon->box;
    bool in = false;
    if (lat < box->south || lat > box->north || lon < box->west || lon > box->east) {
        return false;
    }
    /* Half-open in latitude, so the northernmost row counts with the one below it. */
    if (lat >= box->north) {
        lat = nextafter(box->north, -1000.0);
    }
    uint32_t band = band_of(polygon, lat);
    for (uint32_t i = polygon->band_start[band]; i < polygon->band_start[band + 1]; i++) {
        const edge *e = &polygon->edges[i];
        if ((e->lat1 > lat) != (e->lat2 > lat)) {
            double cross = e->lon1 + (e->lon2 - e->lon1) * ((lat - e->lat1) / (e->lat2 - e->lat1));
            if (lon < cross) {
                in = !in;
            }
        }
    }
    return in;
}

double core_polygon_distance_m(const core_polygon *polygon, double lat_deg, double lon_deg, double reach_m) {
    double sin_lat = sin(lat_deg * CORE_DEG);
    double y_scale = meridian_radius_m(sin_lat) * CORE_DEG;
    double x_scale = normal_radius_m(sin_lat) * sqrt(1.0 - sin_lat * sin_lat) * CORE_DEG;
    double reach_deg = reach_m / y_scale;
    double best2 = reach_m * reach_m;
    bool in = false;
    uint32_t low = band_of(polygon, lat_deg - reach_deg);
    uint32_t high = band_of(polygon, lat_deg + reach_deg);
    for (int turn = -1; turn <= 1; turn++) {
        double lon = lon_deg + 360.0 * turn;
        double gap_x = fmax(fmax(polygon->box.west - lon, lon - polygon->box.east), 0.0) * x_scale;
        double gap_y = fmax(fmax(polygon->box.south - lat_deg, lat_deg - polygon->box.north), 0.0) * y_scale;
        if (gap_x * gap_x + gap_y * gap_y >= best2) {
            continue;
        }
        in = in != inside(polygon, lat_deg, lon);
        for (uint32_t i = polygon->band_start[low]; i < polygon->band_start[high + 1]; i++) {
            const edge *e = &polygon->edges[i];
            if (!e->boundary) {
                continue;
            }
            double x1 = (e->lon1 - lon) * x_scale;
            double y1 = (e->lat1 - lat_deg) * y_scale;
            double dx = (e->lon2 - e->lon1) * x_scale;
            double dy = (e->lat2 - e->lat1) * y_scale;
            double square = dx * dx + dy * dy;
            double t = square > 0.0 ? fmin(fmax(-(x1 * dx + y1 * dy) / square, 0.0), 1.0) : 0.0;
            double px = x1 + dx * t;
            double py = y1 + dy * t;
            best2 = fmin(best2, px * px + py * py);
        }
    }
    return in ? -sqrt(best2) : sqrt(best2);
}
