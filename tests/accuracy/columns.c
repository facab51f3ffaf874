#include "columns.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/geodesy.h"
#include "shared/hash.h"

const column_case column_cases[COLUMN_CASES] = {
    {"St", VELUM_SLOT_LOW, VELUM_KIND_ST, 300.0f, 800.0f, 0.060f, 0.0f},
    {"Sc", VELUM_SLOT_LOW, VELUM_KIND_SC, 900.0f, 1500.0f, 0.045f, 0.0f},
    {"Cu", VELUM_SLOT_CUMULUS, 0.0f, 1000.0f, 2400.0f, 0.050f, 0.0f},
    {"Cb", VELUM_SLOT_STORM, VELUM_KIND_CB, 900.0f, 11500.0f, 0.060f, 0.0f},
    {"As", VELUM_SLOT_MIDDLE, VELUM_KIND_AS, 3500.0f, 5500.0f, 0.010f, 0.0f},
    {"Ns", VELUM_SLOT_MIDDLE, VELUM_KIND_NS, 800.0f, 5000.0f, 0.030f, 0.0f},
    {"Ac", VELUM_SLOT_MIDDLE, VELUM_KIND_AC, 3500.0f, 4000.0f, 0.020f, 0.0f},
    {"Cs", VELUM_SLOT_HIGH, VELUM_KIND_CS, 8000.0f, 9500.0f, 0.0006f, 0.0f},
    {"Ci", VELUM_SLOT_HIGH, VELUM_KIND_CI, 8000.0f, 9500.0f, 0.0004f, 0.0f},
    {"Cc", VELUM_SLOT_HIGH, VELUM_KIND_CC, 7000.0f, 7500.0f, 0.0020f, 0.0f},
};

/* A height counts as cloud where extinction exceeds this share of what was asked for. */
#define EDGE_SHARE 0.01f
#define BISECTIONS 12

typedef struct column {
    const core_cloud_noise *cloud;
    velum_slot_fields fields;
    velum_profile profile; /* of the fields */
    float foot[3], normal[3];
    float rank; /* negative: that of the foot */
} column;

static float extinction_at(const column *c, float height_m) {
    const float point[3] = {c->foot[0] + c->normal[0] * height_m, c->foot[1] + c->normal[1] * height_m,
                            c->foot[2] + c->normal[2] * height_m};
    const float rank = c->rank < 0.0f ? core_cloud_rank(c->cloud, &c->fields, point, c->normal, height_m) : c->rank;
    return core_cloud_extinction_of(c->cloud, &c->fields, &c->profile, rank, point, height_m, true);
}

/* Between a height in cloud and one that is not. */
static float edge_between(const column *c, float in_m, float out_m) {
    for (int i = 0; i < BISECTIONS; i++) {
        float middle_m = 0.5f * (in_m + out_m);
        if (extinction_at(c, middle_m) > EDGE_SHARE * c->fields.extinction_1_m) {
            in_m = middle_m;
        } else {
            out_m = middle_m;
        }
    }
    return in_m;
}

typedef struct sums {
    double depth;
    int covered, columns;
    float *bases_m, *tops_m;
} sums;

static void measure_column(const column *c, int steps, sums *s) {
    const velum_slot_fields *f = &c->fields;
    float thickness_m = f->top_m - f->base_m;
    float step_m = thickness_m / (float)steps;
    float threshold = fminf(0.5f, 0.1f * f->extinction_1_m * thickness_m);
    double depth = 0.0;
    int first = -1;
    int last = -1;
    for (int i = 0; i < steps; i++) {
        float extinction = extinction_at(c, f->base_m + ((float)i + 0.5f) * step_m);
        depth += (double)(extinction * step_m);
        if (extinction > EDGE_SHARE * f->extinction_1_m) {
            first = first < 0 ? i : first;
            last = i;
        }
    }
    s->columns++;
    s->depth += depth;
    if (depth > (double)threshold && first >= 0) {
        float in_m = f->base_m + ((float)first + 0.5f) * step_m;
        s->bases_m[s->covered] = edge_between(c, in_m, in_m - step_m);
        in_m = f->base_m + ((float)last + 0.5f) * step_m;
        s->tops_m[s->covered] = edge_between(c, in_m, in_m + step_m);
        s->covered++;
    }
}

static void blow(column *c, float wind_m_s) {
    const float across = fmaxf(hypotf(c->normal[0], c->normal[1]), 1.0e-6f);
    c->fields.wind_x_m_s = -wind_m_s * c->normal[1] / across;
    c->fields.wind_y_m_s = wind_m_s * c->normal[0] / across;
    c->profile = velum_profile_of(c->cloud->slot, c->fields);
}

static int compare(const void *a, const void *b) {
    float x = *(const float *)a;
    float y = *(const float *)b;
    return (x > y) - (x < y);
}

static bool sums_init(sums *s, size_t columns) {
    *s = (sums){.bases_m = malloc(columns * sizeof(float)), .tops_m = malloc(columns * sizeof(float))};
    return s->bases_m && s->tops_m;
}

static void sums_finish(sums *s, const velum_slot_fields *f, column_stats *out) {
    *out = (column_stats){0};
    if (s->columns > 0 && f) {
        out->coverage = (double)s->covered / s->columns;
        out->water = s->depth / s->columns / (double)(f->coverage * f->extinction_1_m * (f->top_m - f->base_m));
    }
    if (s->covered > 0 && f) {
        size_t count = (size_t)s->covered;
        qsort(s->bases_m, count, sizeof(float), compare);
        qsort(s->tops_m, count, sizeof(float), compare);
        out->base_error_m = (double)(s->bases_m[(size_t)(0.01 * (double)(count - 1) + 0.5)] - f->base_m);
        out->top_error_m = (double)(s->tops_m[(size_t)(0.99 * (double)(count - 1) + 0.5)] - f->top_m);
    }
    free(s->bases_m);
    free(s->tops_m);
}

static velum_slot_fields fields_of(const column_case *of, float coverage) {
    return (velum_slot_fields){.coverage = coverage,
                               .base_m = of->base_m,
                               .top_m = of->top_m,
                               .extinction_1_m = of->extinction_1_m,
                               .kind = of->kind};
}

bool columns_measure(const core_noise *noise, const column_case *of, float coverage, double lat_deg, double lon_deg,
                     double side_m, int n, int steps, column_stats *out) {
    sums s;
    if (!sums_init(&s, (size_t)n * (size_t)n)) {
        sums_finish(&s, NULL, out);
        return false;
    }
    double up[3];
    double east[3];
    double north[3];
    double origin[3];
    core_normal(lat_deg, lon_deg, up);
    core_east_north(up, east, north);
    core_position(up, 0.0, origin);
    const core_drift drift = core_drift_at(1000.0, 7);
    const core_cloud_noise cloud = core_cloud_noise_at(noise, (uint32_t)of->slot, origin, &drift);
    column c = {.cloud = &cloud, .fields = fields_of(of, coverage), .rank = -1.0f};
    for (int j = 0; j < n; j++) {
        for (int i = 0; i < n; i++) {
            double x = side_m * ((i + 0.5) / n - 0.5) / CORE_RADIUS_M;
            double y = side_m * ((j + 0.5) / n - 0.5) / CORE_RADIUS_M;
            double normal[3];
            double foot[3];
            double length = sqrt(1.0 + x * x + y * y);
            for (int axis = 0; axis < 3; axis++) {
                normal[axis] = (up[axis] + x * east[axis] + y * north[axis]) / length;
            }
            core_position(normal, 0.0, foot);
            for (int axis = 0; axis < 3; axis++) {
                c.foot[axis] = (float)(foot[axis] - origin[axis]);
                c.normal[axis] = (float)normal[axis];
            }
            blow(&c, of->wind_m_s);
            measure_column(&c, steps, &s);
        }
    }
    sums_finish(&s, &c.fields, out);
    return true;
}

bool columns_measure_anywhere(const core_noise *noise, const column_case *of, float coverage, int count, int steps,
                              column_stats *out) {
    sums s;
    /* Columns that lean have another rank at each height: theirs are those of places, at random, and more of them. */
    const velum_slot_fields fields = fields_of(of, coverage);
    const bool leans = velum_lean_slope(of->slot, fields) > 0.0f;
    count = leans ? 4 * count : count;
    if (!sums_init(&s, (size_t)count)) {
        sums_finish(&s, NULL, out);
        return false;
    }
    double origin[3] = {0.0, 0.0, 0.0};
    const core_drift drift = core_drift_at(1000.0, 7);
    core_cloud_noise cloud = core_cloud_noise_at(noise, (uint32_t)of->slot, origin, &drift);
    column c = {.cloud = &cloud, .fields = fields};
    /* Ranks that can be cloud, evenly; the rest of the sky is clear. */
    const velum_profile profile = velum_profile_of(of->slot, c.fields);
    const float sky = leans ? 1.0f : fminf(coverage * profile.coverage_scale, 1.0f);
    for (int i = 0; i < count; i++) {
        c.rank = leans ? -1.0f : 1.0f - sky * ((float)i + 0.5f) / (float)count;
        for (uint32_t axis = 0; axis < 3; axis++) {
            c.foot[axis] = 1.0e5f * velum_hash_unit(velum_hash_2((uint32_t)i, axis));
        }
        float z = 2.0f * velum_hash_unit(velum_hash_2((uint32_t)i, 3)) - 1.0f;
        float turn = 6.2831853f * velum_hash_unit(velum_hash_2((uint32_t)i, 4));
        float across = sqrtf(fmaxf(1.0f - z * z, 0.0f));
        c.normal[0] = across * cosf(turn);
        c.normal[1] = across * sinf(turn);
        c.normal[2] = z;
        if (of->slot == VELUM_SLOT_HIGH) {
            /* Its noise goes by latitude: columns stand on the earth; others' about its centre as well. */
            const double normal[3] = {(double)c.normal[0], (double)c.normal[1], (double)c.normal[2]};
            core_position(normal, 0.0, origin);
            cloud = core_cloud_noise_at(noise, (uint32_t)of->slot, origin, &drift);
            memset(c.foot, 0, sizeof c.foot);
        }
        blow(&c, of->wind_m_s);
        measure_column(&c, steps, &s);
    }
    sums_finish(&s, &c.fields, out);
    out->coverage *= (double)sky;
    out->water *= (double)sky;
    return true;
}
