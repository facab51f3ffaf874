#include "stability.h"

#include <math.h>
#include <string.h>

#define EARTH_A_M 6378137.0
#define EARTH_A_OVER_B (6378137.0 / 6356752.314245179)

/* The brightest that cloud away from the sun can be, several times over. */
#define GREATEST_CD_M2 5e5

trial_weather trial_no_air(const char *layers) {
    return (trial_weather){.layers = layers, .atmosphere = "none", .sun_elevation_deg = 45.0};
}

trial_weather trial_air(const char *layers, double sun_elevation_deg) {
    return (trial_weather){.layers = layers,
                           .atmosphere = "earth",
                           .albedo = 0.1,
                           .sun_azimuth_deg = 160.0,
                           .sun_elevation_deg = sun_elevation_deg,
                           .lat_deg = 50.0,
                           .lon_deg = 8.5};
}

stage_camera trial_camera(double lat_deg, double lon_deg, double height_m, double heading_deg, double pitch_deg,
                          double tan_x) {
    stage_camera c = {.tan_x = tan_x, .tan_y = tan_x * TRIAL_HIGH / TRIAL_WIDE};
    stage_camera_place(&c, lat_deg, lon_deg, height_m, heading_deg, pitch_deg, 0.0);
    return c;
}

bool trial_load(trial *t, const trial_weather *w) {
    char text[2048];
    trial_close(t);
    snprintf(text, sizeof text,
             "{\"velum\": 1, \"start\": \"2014-12-18T12:00:00Z\", \"duration_s\": 1e9, \"seed\": 7, \"sun\": "
             "{\"azimuth_deg\": %.9g, \"elevation_deg\": %.9g}, \"atmosphere\": \"%s\", \"ground\": {\"albedo\": "
             "[%g, %g, %g]}, \"weather\": [{\"time_s\": 0, "
             "\"sources\": [{\"global\": {\"layers\": [%s]}}]}], \"camera\": [{\"lat_deg\": %.9g, \"lon_deg\": %.9g, "
             "\"height_m\": 0}]}",
             w->sun_azimuth_deg, w->sun_elevation_deg, w->atmosphere, w->albedo, w->albedo, w->albedo, w->layers,
             w->lat_deg, w->lon_deg);
    t->is_new = true;
    t->s->hides_ground = strcmp(w->atmosphere, "none") == 0;
    return stage_load_text(t->s, text, w->wind_east_m_s) == STAGE_OK;
}

void trial_close(trial *t) {
    if (t->v.eye) {
        stage_view_finish(&t->v, t->s);
    }
    picture_finish(&t->now);
}

bool trial_open(trial *t, uint32_t width, uint32_t height) {
    trial_close(t);
    velum_result result = stage_view_init(t->s, &t->v, t->quality, width, height);
    if (result < 0) {
        stage_fail(t->s, "view", result);
        return false;
    }
    return picture_init(&t->now, width, height);
}

bool trial_draw(trial *t, const stage_camera *c, double time_s, uint32_t flags, uint32_t frames) {
    if ((flags & VELUM_VIEW_CUT) && !stage_prepare(t->s, c, t->now.width, time_s)) {
        return false;
    }
    for (uint32_t i = 0; i < frames; i++) {
        velum_result result = stage_draw(t->s, &t->v, c, time_s, i == 0 ? flags : 0, &t->now, NULL);
        if (result < 0) {
            stage_fail(t->s, "render", result);
            return false;
        }
        t->invalid += picture_invalid(&t->now);
        for (uint32_t k = 0; k < t->now.count; k++) {
            t->invalid += (double)t->now.luminance[k] > t->greatest_cd_m2 ? 1 : 0;
        }
    }
    uint32_t wrong = 0;
    bool ok = !t->is_new || stage_check_shadow(t->s, c, time_s, &wrong);
    t->is_new = false;
    t->invalid += wrong;
    return ok;
}

bool trial_settle(trial *t, const trial_weather *weather, const stage_camera *c, double time_s) {
    return trial_load(t, weather) && trial_open(t, TRIAL_WIDE, TRIAL_HIGH) &&
           trial_draw(t, c, time_s, VELUM_VIEW_CUT, TRIAL_SETTLE);
}

bool trial_plan(trial *t, void (*change)(velum_plan *plan, double value), double value) {
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    velum_result result = t->s->host.engine->get_plan(t->v.eye, &plan, &reasons);
    if (result >= 0) {
        change(&plan, value);
        result = t->s->host.engine->set_plan(t->v.eye, &plan);
    }
    if (result < 0) {
        stage_fail(t->s, "plan", result);
    }
    return result >= 0;
}

/* To the ellipsoid's surface, or far beyond all cloud. */
static double ray_end(const double from[3], const double direction[3]) {
    const double p[3] = {from[0], from[1], from[2] * EARTH_A_OVER_B};
    const double d[3] = {direction[0], direction[1], direction[2] * EARTH_A_OVER_B};
    double dd = 0.0, pd = 0.0, pp = 0.0;
    for (int i = 0; i < 3; i++) {
        dd += d[i] * d[i];
        pd += p[i] * d[i];
        pp += p[i] * p[i];
    }
    double disc = pd * pd - dd * (pp - EARTH_A_M * EARTH_A_M);
    double t = disc > 0.0 ? (-pd - sqrt(disc)) / dd : -1.0;
    return t > 0.0 ? t : 3e6;
}

void trial_ray(const trial *t, const stage_camera *c, uint32_t x, uint32_t y, double out[3]) {
    double u = c->tan_x * (2.0 * (x + 0.5) / t->now.width - 1.0);
    double v = c->tan_y * (1.0 - 2.0 * (y + 0.5) / t->now.height);
    double length = 0.0;
    for (int k = 0; k < 3; k++) {
        out[k] = c->forward[k] + u * c->right[k] + v * c->up[k];
        length += out[k] * out[k];
    }
    for (int k = 0; k < 3; k++) {
        out[k] /= sqrt(length);
    }
}

bool trial_transmittance(trial *t, const stage_camera *c, double time_s, double *out_worst, double *out_mean) {
    const picture *p = &t->now;
    double sum = 0.0;
    *out_worst = 0.0;
    for (uint32_t j = 0; j < 8; j++) {
        for (uint32_t i = 0; i < 8; i++) {
            uint32_t x = (2 * i + 1) * p->width / 16, y = (2 * j + 1) * p->height / 16;
            double d[3];
            velum_line_query line = {.struct_size = sizeof line, .time_s = time_s};
            velum_line_answer answer = {.struct_size = sizeof answer};
            trial_ray(t, c, x, y, d);
            double end = ray_end(c->position_m, d);
            for (int k = 0; k < 3; k++) {
                line.from_ecef_m[k] = c->position_m[k];
                line.to_ecef_m[k] = c->position_m[k] + end * d[k];
            }
            velum_result result = t->s->host.world->query_line(t->s->world, &line, &answer);
            if (result < 0) {
                stage_fail(t->s, "query_line", result);
                return false;
            }
            double found = (double)p->transmittance[3 * (y * p->width + x) + 1];
            double miss = fabs(found - answer.transmittance) - 0.01 * answer.transmittance;
            *out_worst = isnan(found) ? NAN : fmax(*out_worst, miss);
            sum += fabs(found - answer.transmittance);
        }
    }
    if (out_mean) {
        *out_mean = sum / 64.0;
    }
    return true;
}

double trial_difference(const trial *t, const picture *other) {
    metric m;
    return other->count == t->now.count && metric_compute(t->now.luminance, other->luminance, NULL, other->count, &m) &&
                   m.invalid == 0
               ? m.error
               : NAN;
}

bool trial_keep(const trial *t, picture *out) {
    if (!picture_init(out, t->now.width, t->now.height)) {
        return false;
    }
    memcpy(out->rgb, t->now.rgb, 3 * sizeof(float) * out->count);
    memcpy(out->transmittance, t->now.transmittance, 3 * sizeof(float) * out->count);
    picture_update_luminance(out);
    return true;
}

double trial_mean(const trial *t) {
    double sum = 0.0;
    for (uint32_t i = 0; i < t->now.count; i++) {
        sum += (double)t->now.luminance[i] / t->now.count;
    }
    return sum;
}

double trial_worse(double a, double b) {
    return isnan(a) || isnan(b) ? NAN : fmax(a, b);
}

static bool is_wanted(const program *p, const char *name) {
    bool wanted = p->scene_count == 0;
    for (uint32_t i = 0; i < p->scene_count; i++) {
        wanted = wanted || strcmp(p->scenes[i], name) == 0;
    }
    return wanted;
}

/* Whether it holds. */
static bool try_case(program *p, const stability_case *c, int32_t quality) {
    trial t = {.s = &p->s, .quality = quality, .value = NAN, .greatest_cd_m2 = GREATEST_CD_M2};
    bool ran = c->run(&t);
    bool holds = ran && t.invalid == 0 && t.value <= c->bound;
    trial_close(&t);
    if (p->json) {
        printf("{\"case\": \"%s\", \"preset\": \"%s\", \"bound\": %g, \"found\": ", c->name, measure_preset(quality),
               c->bound);
        printf(isfinite(t.value) ? "%.6g" : "null", t.value);
        printf(", \"invalid\": %u, \"holds\": %s}\n", t.invalid, holds ? "true" : "false");
    } else {
        printf("  %-7s %-6s %10.3g %8u  %s\n", measure_preset(quality),
               holds ? "holds"
               : ran ? "BROKEN"
                     : "FAILED",
               t.value, t.invalid, t.text);
    }
    fflush(stdout);
    return holds;
}

int stability_run(program *p) {
    const stability_case *const tables[] = {stability_places, stability_media, stability_times};
    uint32_t tried = 0, broken = 0;
    if (p->preset_count == 0) {
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            p->presets[p->preset_count++] = q;
        }
    }
    for (uint32_t i = 0; i < 3; i++) {
        for (const stability_case *c = tables[i]; c->name; c++) {
            if (!is_wanted(p, c->name)) {
                continue;
            }
            if (!p->json) {
                printf("%s\n  usually   %s\n  here      %s\n  measured  %s; at most %g\n"
                       "  preset            found  invalid\n",
                       c->name, c->usual, c->ours, c->measured, c->bound);
            }
            for (uint32_t q = 0; q < p->preset_count; q++) {
                tried++;
                broken += try_case(p, c, p->presets[q]) ? 0 : 1;
            }
            if (!p->json) {
                printf("\n");
            }
        }
    }
    p->s.hides_ground = false;
    if (!p->json) {
        printf("on %s: %u of %u hold\ninvalid: pixels and texels of shadow maps, of all frames, that are no number, "
               "infinite, negative or out of range\n",
               p->s.device_name, tried - broken, tried);
    }
    if (tried == 0 || broken > 0) {
        fprintf(stderr, "velum-accuracy: %s\n", tried ? "not all cases hold" : "no such case");
    }
    return tried == 0 || broken > 0 ? 1 : 0;
}
