#include "measure.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { PRESET_FRAMES = 48, FRAMES_MAX = 256 };
static const double frame_s = 1.0 / 60.0;

float measure_wind(method_motion motion) {
    return motion == MOTION_WIND ? 50.0f : 0.0f;
}

const char *measure_preset(int32_t quality) {
    static const char *const names[] = {"default", "low", "medium", "high", "ultra", "reference"};
    return quality >= 0 && quality <= VELUM_QUALITY_REFERENCE ? names[quality] : "?";
}

/* `ago`: frames until the scene's own pose. */
static void moved(const stage_camera *c, method_motion motion, uint32_t ago, stage_camera *out) {
    *out = *c;
    double back = ago * frame_s;
    if (motion == MOTION_FORWARD) {
        for (int i = 0; i < 3; i++) {
            out->position_m[i] -= 250.0 * back * c->forward[i];
        }
    } else if (motion == MOTION_ROLL) {
        double angle = -back * 3.14159265358979323846 / 3.0;
        for (int i = 0; i < 3; i++) {
            out->right[i] = cos(angle) * c->right[i] - sin(angle) * c->up[i];
            out->up[i] = cos(angle) * c->up[i] + sin(angle) * c->right[i];
        }
    }
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, ascending);
    return count ? values[count / 2] : 0.0;
}

static bool impose(stage *s, stage_view *v, const method_row *row, double value) {
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    velum_result result = s->host.engine->get_plan(v->eye, &plan, &reasons);
    if (result >= 0) {
        row->set(&plan, value);
        result = s->host.engine->set_plan(v->eye, &plan);
    }
    if (result < 0) {
        stage_fail(s, row->name, result);
    }
    return result >= 0;
}

static bool compare_blocks(const picture *p, const picture *q, uint32_t side, metric *out) {
    uint32_t blocks = ((p->width + side - 1) / side) * ((p->height + side - 1) / side);
    float *means = calloc(3u * blocks, sizeof *means);
    bool ok = means != NULL;
    if (ok) {
        metric_blocks(p->luminance, NULL, p->width, p->height, side, means, NULL);
        metric_blocks(q->luminance, q->variance, p->width, p->height, side, means + blocks, means + 2 * blocks);
        ok = metric_compute(means, means + blocks, means + 2 * blocks, blocks, out);
    }
    free(means);
    return ok;
}

static bool compare(const picture *p, const reference *r, measurement *m) {
    const picture *q = &r->picture;
    metric m_4;
    bool ok = metric_compute(p->luminance, q->luminance, q->variance, p->count, &m->m) &&
              compare_blocks(p, q, 8, &m->m_8) && compare_blocks(p, q, 4, &m_4);
    if (!ok) {
        fprintf(stderr, "velum-accuracy: %s: nothing to compare\n", m->scene);
        return false;
    }
    m->p99_4 = m_4.p99;
    return true;
}

bool measure(stage *s, const char *scene, const stage_camera *c, const method_row *row, double value, int32_t quality,
             const reference *r, const picture *limit, picture *out, measurement *result) {
    uint32_t frames = row ? row->frames : PRESET_FRAMES;
    method_motion motion = row ? row->motion : MOTION_STILL;
    *result = (measurement){.scene = scene,
                            .group = row ? row->group : "preset",
                            .name = row ? row->name : measure_preset(quality),
                            .unit = row ? row->unit : "",
                            .motion = motion,
                            .value = value,
                            .frames = frames,
                            .paths = r->paths,
                            .error_limit = -1.0};
    stage_view v;
    double view_ms[FRAMES_MAX], all_ms[FRAMES_MAX];
    bool ok = false;
    velum_result drawn = stage_view_init(s, &v, row ? row->quality : quality, out->width, out->height);
    if (drawn < 0) {
        stage_fail(s, "view", drawn);
        return false;
    }
    /* The first frame makes the plan that is changed, and is not counted. */
    uint32_t flags = VELUM_VIEW_CUT;
    for (uint32_t i = 0; i <= frames && drawn >= 0; i++) {
        stage_camera now;
        stage_cost cost = {0};
        moved(c, motion, i == 0 ? frames - 1 : frames - i, &now);
        double time_s = motion == MOTION_WIND ? -frame_s * (i == 0 ? frames - 1 : frames - i) : 0.0;
        drawn = stage_draw(s, &v, &now, time_s, flags, out, &cost);
        if (i == 0) {
            if (drawn >= 0 && row && !impose(s, &v, row, value)) {
                goto done;
            }
            continue;
        }
        flags = 0;
        view_ms[(i - 1) % FRAMES_MAX] = cost.view_ms;
        all_ms[(i - 1) % FRAMES_MAX] = cost.view_ms + cost.shared_ms;
        result->rays += cost.rays / frames / out->count;
        result->samples += cost.samples / frames / out->count;
        result->light_samples += cost.light_samples / frames / out->count;
    }
    if (drawn < 0) {
        stage_fail(s, "render", drawn);
        goto done;
    }
    result->ms = median(all_ms, frames);
    result->ms_per_megapixel = median(view_ms, frames) * 1e6 / out->count;
    result->invalid = picture_invalid(out);
    ok = compare(out, r, result);
    metric against;
    if (limit && metric_compute(out->luminance, limit->luminance, NULL, out->count, &against)) {
        result->error_limit = against.error;
    }
done:
    stage_view_finish(&v, s);
    return ok;
}

/* error: of pixels, the reference's noise subtracted, and how unsure that leaves it; 99 %: of means over 4 x 4. */
void measure_print_head(void) {
    printf("%-21s %-11s %-22s %9s | %7s %7s %7s %7s %7s | %7s %8s %7s %7s %7s | %7s %7s\n", "scene", "group", "method",
           "value", "error", "+-", "bias", "99% 4x4", "err 8x8", "ms", "ms/Mpix", "rays", "samples", "to sun", "noise",
           "n. 8x8");
}

void measure_print(const measurement *m) {
    printf("%-21s %-11s %-22s %9g | %7.4f %7.4f %+7.4f %7.4f %7.4f | %7.2f %8.1f %7.4f %7.2f %7.2f | %7.4f %7.4f%s\n",
           m->scene, m->group, m->name, m->value, m->m.error, m->m.error_sigma, m->m.bias, m->p99_4, m->m_8.error,
           m->ms, m->ms_per_megapixel, m->rays, m->samples, m->light_samples, m->m.noise, m->m_8.noise,
           m->invalid ? " INVALID" : "");
    fflush(stdout);
}

void measure_print_json(FILE *file, const measurement *m) {
    fprintf(file,
            "{\"scene\": \"%s\", \"group\": \"%s\", \"method\": \"%s\", \"value\": %.9g, \"error\": %.5g, "
            "\"error_sigma\": %.3g, \"bias\": %.5g, \"bias_sigma\": %.3g, \"p99_4x4\": %.5g, \"error_8x8\": %.5g, "
            "\"error_8x8_sigma\": %.3g, \"noise\": %.4g, \"noise_8x8\": %.4g, \"mean_cd_m2\": %.6g, \"ms\": %.4f, "
            "\"ms_per_megapixel\": %.2f, \"frames\": %u, \"rays_per_pixel\": %.5g, \"samples_per_pixel\": %.5g, "
            "\"light_samples_per_pixel\": %.5g, \"reference_paths\": %g, \"invalid_pixels\": %u",
            m->scene, m->group, m->name, m->value, m->m.error, m->m.error_sigma, m->m.bias, m->m.bias_sigma, m->p99_4,
            m->m_8.error, m->m_8.error_sigma, m->m.noise, m->m_8.noise, m->m.mean, m->ms, m->ms_per_megapixel,
            m->frames, m->rays, m->samples, m->light_samples, m->paths, m->invalid);
    if (m->error_limit >= 0.0) {
        fprintf(file, ", \"error_against_limit\": %.5g", m->error_limit);
    }
    fprintf(file, "}\n");
    fflush(file);
}
