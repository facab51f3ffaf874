#include "cover.h"

#include <math.h>

static const double pi = 3.14159265358979323846;
static const double step_deg = 0.033, radius_steps = 4, level_m = 250, tick_s = 20;

static bool ask(struct scene *scene, const struct cover_answer *of, double lat_deg, double lon_deg,
                struct cloud_cover *out) {
    static const double top_m = 25000, footprint_m = 20000;
    const double height_m = (double)of->level * level_m;
    const double time_s = (double)of->tick * tick_s;
    velum_point_query point = {.struct_size = sizeof point, .time_s = time_s, .footprint_m = footprint_m};
    velum_point_answer weather = {.struct_size = sizeof weather};
    velum_line_query line = {.struct_size = sizeof line, .time_s = time_s, .footprint_m = footprint_m};
    velum_line_answer depth = {.struct_size = sizeof depth};
    scene_point(lat_deg, lon_deg, height_m, point.position_ecef_m);
    velum_result result = scene->plugin.world->query_point(scene->world, &point, &weather);
    if (result >= 0 && height_m < top_m) {
        scene_point(lat_deg, lon_deg, height_m, line.from_ecef_m);
        scene_point(lat_deg, lon_deg, top_m, line.to_ecef_m);
        result = scene->plugin.world->query_line(scene->world, &line, &depth);
    }
    if (result < 0) {
        plugin_report(&scene->plugin, "cloud cover", result);
        return false;
    }
    *out = (struct cloud_cover){(double)weather.coverage, depth.optical_depth};
    return true;
}

static uint64_t rest_of(int64_t value, uint64_t count) {
    return (uint64_t)value % count;
}

/* Neighbours on the lattice, as many as are asked for at once, never share a place here. */
static struct cover_answer *slot_of(struct cover_answers *answers, const struct cover_answer *of) {
    const uint64_t place = rest_of(of->row, COVER_ROWS) * COVER_ROWS + rest_of(of->column, COVER_ROWS);
    return &answers->at[(place * 2 + rest_of(of->level, 2)) * COVER_TICKS + rest_of(of->tick, COVER_TICKS)];
}

static bool is_known(struct cover_answers *answers, const struct cover_answer *of) {
    const struct cover_answer *known = slot_of(answers, of);
    return known->is_known && known->row == of->row && known->column == of->column && known->level == of->level &&
           known->tick == of->tick;
}

static bool add(struct scene *scene, struct cover_answers *answers, struct cover_answer of, double lat_deg,
                double lon_deg, double weight, struct cloud_cover *sum) {
    struct cover_answer *known = slot_of(answers, &of);
    if (!is_known(answers, &of)) {
        of.is_known = ask(scene, &of, lat_deg, lon_deg, &of.cover);
        *known = of;
    }
    sum->coverage += weight * known->cover.coverage;
    sum->optical_depth += weight * known->cover.optical_depth;
    return known->is_known;
}

/* Between heights and times of the lattice. Of those of the next tick `early` more are asked, a few in each frame. */
static bool add_place(struct scene *scene, struct cover_answers *answers, struct cover_answer of, double lon_step_deg,
                      const double rest[2], double weight, int *early, struct cloud_cover *sum) {
    const double lat_deg = fmin(fmax((double)of.row * step_deg, -90), 90);
    struct cover_answer later = of;
    struct cloud_cover unused = {0, 0};
    later.tick += 2;
    for (; *early > 0 && rest[1] > 0 && later.level <= of.level + (rest[0] > 0); later.level++) {
        if (!is_known(answers, &later)) {
            --*early;
            if (!add(scene, answers, later, lat_deg, (double)of.column * lon_step_deg, 0, &unused)) {
                return false;
            }
        }
    }
    for (int k = 0; k < 4; k++) {
        struct cover_answer corner = of;
        corner.level += k & 1;
        corner.tick += k >> 1;
        const double share = (k & 1 ? rest[0] : 1 - rest[0]) * (k >> 1 ? rest[1] : 1 - rest[1]);
        if (share > 0 && !add(scene, answers, corner, lat_deg, (double)of.column * lon_step_deg, weight * share, sum)) {
            return false;
        }
    }
    return true;
}

/* Over places that are fixed to the world, with weights that fade to 0 some 15 km away: the light of everything must
 * not change with each cloud that passes the eye. */
bool cover_around(struct scene *scene, struct cover_answers *answers, const velum_scenario_camera *place,
                  double height_m, double time_s, struct cloud_cover *out) {
    const double level = floor(height_m / level_m);
    const double tick = floor(time_s / tick_s);
    const double rest[2] = {height_m / level_m - level, time_s / tick_s - tick};
    const double row_0 = floor(place->lat_deg / step_deg);
    double weights = 0;
    int early = 2;
    *out = (struct cloud_cover){0, 0};
    for (double row = row_0 - 3; row <= row_0 + 4; row++) {
        const double lat_deg = fmin(fmax(row * step_deg, -90), 90);
        const double lon_step_deg = step_deg / fmax(cos(lat_deg * pi / 180), 0.01);
        const double column_0 = floor(place->lon_deg / lon_step_deg);
        for (double column = column_0 - 3; column <= column_0 + 4; column++) {
            const double north = place->lat_deg / step_deg - row;
            const double east = place->lon_deg / lon_step_deg - column;
            const double fade = 1 - (north * north + east * east) / (radius_steps * radius_steps);
            const struct cover_answer of = {
                .row = (int64_t)row, .column = (int64_t)column, .level = (int64_t)level, .tick = (int64_t)tick};
            if (fade > 0) {
                weights += fade * fade;
                if (!add_place(scene, answers, of, lon_step_deg, rest, fade * fade, &early, out)) {
                    return false;
                }
            }
        }
    }
    out->coverage /= weights;
    out->optical_depth /= weights;
    return true;
}
