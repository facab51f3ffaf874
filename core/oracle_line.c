#include "oracle.h"

#include <math.h>
#include <string.h>

#include "geodesy.h"
#include "oracle_cursor.h"

/* No feature of the noises is smaller than its texels, 5 m for the finest; samples are a quarter of a panel apart. */
#define PANEL_M 8.0
#define DEPTH_MAX 16
#define CONTACT_WITHIN_M 0.2

typedef struct walk {
    oracle_cursor cursor;
    const double *from_m;
    double unit[3];
    float contact_1_m;
    double before_m; /* the last sample that was below the contact's threshold */
    bool is_before;
    core_oracle_line *out;
} walk;

static oracle_place place_at(walk *w, double t_m) {
    double point[3];
    for (int axis = 0; axis < 3; axis++) {
        point[axis] = w->from_m[axis] + w->unit[axis] * t_m;
    }
    return oracle_cursor_move(&w->cursor, point);
}

static double extinction_at(walk *w, double t_m) {
    oracle_place place = place_at(w, t_m);
    return (double)oracle_cursor_total(&w->cursor, &place);
}

/* Samples come in ascending order until there is contact. */
static void look_for_contact(walk *w, double t_m, double extinction) {
    if (w->out->has_contact) {
        return;
    }
    if (extinction <= (double)w->contact_1_m) {
        w->before_m = t_m;
        w->is_before = true;
        return;
    }
    double low_m = w->is_before ? w->before_m : t_m;
    double high_m = t_m;
    while (high_m - low_m > CONTACT_WITHIN_M) {
        double middle_m = 0.5 * (low_m + high_m);
        if (extinction_at(w, middle_m) > (double)w->contact_1_m) {
            high_m = middle_m;
        } else {
            low_m = middle_m;
        }
    }
    w->out->has_contact = true;
    w->out->first_contact_m = high_m;
}

/* Adaptive Simpson's rule (Lyness 1969). */
static double integrate(walk *w, double t0, double f0, double tm, double fm, double t1, double f1, int depth) {
    double tl = 0.5 * (t0 + tm);
    double tr = 0.5 * (tm + t1);
    double fl = extinction_at(w, tl);
    double fr = extinction_at(w, tr);
    double whole = (t1 - t0) / 6.0 * (f0 + 4.0 * fm + f1);
    double halves = (t1 - t0) / 12.0 * (f0 + 4.0 * fl + 2.0 * fm + 4.0 * fr + f1);
    double error = (halves - whole) / 15.0;
    if (depth == 0) {
        look_for_contact(w, t0, f0);
        look_for_contact(w, tl, fl);
        look_for_contact(w, tm, fm);
        look_for_contact(w, tr, fr);
        look_for_contact(w, t1, f1);
    }
    if (depth >= DEPTH_MAX || w->cursor.result != VELUM_OK || fabs(error) <= 2e-4 * halves ||
        fabs(error) <= 1e-10 * (t1 - t0)) {
        return halves + error;
    }
    return integrate(w, t0, f0, tl, fl, tm, fm, depth + 1) + integrate(w, tm, fm, tr, fr, t1, f1, depth + 1);
}

static void walk_stretch(walk *w, double begin_m, double end_m) {
    double t = begin_m;
    while (t < end_m && w->cursor.result == VELUM_OK) {
        oracle_place place = place_at(w, t);
        double clear_m = oracle_cursor_clear_m(&w->cursor, &place);
        if (clear_m > PANEL_M) {
            look_for_contact(w, t, 0.0);
            t += clear_m;
            continue;
        }
        double next = fmin(t + PANEL_M, end_m);
        double f0 = (double)oracle_cursor_total(&w->cursor, &place);
        double middle = 0.5 * (t + next);
        w->out->optical_depth += integrate(w, t, f0, middle, extinction_at(w, middle), next, extinction_at(w, next), 0);
        t = next;
    }
}

/* Where the line is inside the scaled sphere of radius a + over_m, along the unit ray. */
static bool sphere_span(const double from_m[3], const double unit[3], double over_m, double span[2]) {
    const double k = CORE_WGS84_A_M / CORE_WGS84_B_M;
    const double s[3] = {from_m[0], from_m[1], from_m[2] * k};
    const double d[3] = {unit[0], unit[1], unit[2] * k};
    double a = 0.0;
    double b = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        a += d[axis] * d[axis];
        b += s[axis] * d[axis];
    }
    double nearest = -b / a;
    double closest2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        double q = s[axis] + d[axis] * nearest;
        closest2 += q * q;
    }
    double radius = CORE_WGS84_A_M + over_m;
    double inside = radius * radius - closest2;
    if (!(inside > 0.0)) {
        return false;
    }
    double half = sqrt(inside / a);
    span[0] = nearest - half;
    span[1] = nearest + half;
    return true;
}

static bool heights_of(const core_oracle *oracle, double *base_m, double *top_m) {
    bool any = false;
    for (int s = 0; s < 2; s++) {
        float base;
        float top;
        if (oracle->state[s] && core_state_height_range(oracle->state[s], &base, &top)) {
            *base_m = any ? fmin(*base_m, (double)base) : (double)base;
            *top_m = any ? fmax(*top_m, (double)top) : (double)top;
            any = true;
        }
    }
    return any;
}

static void walk_between(walk *w, double length_m, double base_m, double top_m) {
    double outer[2];
    double inner[2];
    /* |s| - a lies between the height and a / b times it. */
    const double k = CORE_WGS84_A_M / CORE_WGS84_B_M;
    if (!sphere_span(w->from_m, w->unit, fmax(top_m, top_m * k) + 2.0, outer)) {
        return;
    }
    double begin_m = fmax(outer[0], 0.0);
    double end_m = fmin(outer[1], length_m);
    if (sphere_span(w->from_m, w->unit, fmin(base_m, base_m * k) - 2.0, inner)) {
        walk_stretch(w, begin_m, fmin(end_m, inner[0]));
        begin_m = fmax(begin_m, inner[1]);
    }
    walk_stretch(w, begin_m, end_m);
}

static bool is_finite_point(const double p[3]) {
    for (int axis = 0; axis < 3; axis++) {
        if (!isfinite(p[axis]) || fabs(p[axis]) > 1e15) {
            return false;
        }
    }
    return true;
}

velum_result core_oracle_along(const core_oracle *oracle, const double from_m[3], const double to_m[3],
                               double footprint_m, float contact_1_m, core_oracle_line *out, core_error *error) {
    memset(out, 0, sizeof *out);
    if (!is_finite_point(from_m) || !is_finite_point(to_m)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "line: expected finite ECEF metres");
    }
    if (!(footprint_m >= 0.0) || !isfinite(footprint_m)) {
        return core_fail(error, VELUM_ERROR_ARGUMENT, "footprint_m: found %g, expected 0 or more", footprint_m);
    }
    walk w = {.from_m = from_m, .contact_1_m = contact_1_m > 0.0f ? contact_1_m : 1e-4f, .out = out};
    double length2 = 0.0;
    for (int axis = 0; axis < 3; axis++) {
        w.unit[axis] = to_m[axis] - from_m[axis];
        length2 += w.unit[axis] * w.unit[axis];
    }
    double length_m = sqrt(length2);
    double base_m = 0.0;
    double top_m = 0.0;
    if (!(length_m > 0.0) || !heights_of(oracle, &base_m, &top_m)) {
        return VELUM_OK;
    }
    for (int axis = 0; axis < 3; axis++) {
        w.unit[axis] /= length_m;
    }
    oracle_cursor_init(&w.cursor, oracle, footprint_m);
    walk_between(&w, length_m, base_m, top_m);
    velum_result result = w.cursor.result;
    oracle_cursor_finish(&w.cursor);
    return result == VELUM_OK ? result : core_fail(error, result, "no memory for tiles");
}
