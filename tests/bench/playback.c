#include "playback.h"

#include <stdlib.h>
#include <string.h>

bool playback_init(playback *p, bench *b) {
    *p = (playback){.b = b};
    if (!stage_init(&p->s, VELUM_DEVICE_AUTO)) {
        return false;
    }
    p->rougher = calloc((size_t)b->width * b->height, sizeof *p->rougher);
    return p->rougher != NULL;
}

static void eye_finish(playback_eye *e, stage *s) {
    if (e->v.eye) {
        stage_view_finish(&e->v, s);
    }
    picture_finish(&e->now);
    *e = (playback_eye){.v = {.eye = NULL}};
}

static void finish_eyes(playback *p) {
    eye_finish(&p->preset, &p->s);
    eye_finish(&p->every_pixel, &p->s);
    eye_finish(&p->truth, &p->s);
}

void playback_finish(playback *p) {
    finish_eyes(p);
    if (p->s.host.library) {
        stage_finish(&p->s);
    }
    free(p->rougher);
    p->rougher = NULL;
}

static bool impose_rate(playback *p, playback_eye *e, uint32_t ray_rate) {
    const velum_engine_api *api = p->s.host.engine;
    velum_plan plan = {.struct_size = sizeof plan};
    const char *reasons = NULL;
    velum_result result = api->get_plan(e->v.eye, &plan, &reasons);
    if (result >= 0) {
        plan.ray_rate = ray_rate;
        plan.standing_ray_rate = 0;
        result = api->set_plan(e->v.eye, &plan);
    }
    if (result < 0) {
        stage_fail(&p->s, "plan", result);
    }
    return result >= 0;
}

/* The plan is made with the first frame, and changed from then on. ray_rate 0: as it is. */
static bool eye_init(playback *p, playback_eye *e, const stage_camera *c, uint32_t ray_rate) {
    velum_result result = stage_view_init(&p->s, &e->v, VELUM_QUALITY_MEDIUM, p->b->width, p->b->height);
    if (result < 0) {
        stage_fail(&p->s, "view", result);
        return false;
    }
    return picture_init(&e->now, p->b->width, p->b->height) && playback_draw(p, e, c, 0.0, VELUM_VIEW_CUT) &&
           (ray_rate == 0 || impose_rate(p, e, ray_rate));
}

bool playback_load(playback *p, const char *folder, const char *name, float wind_east_m_s, stage_camera *c) {
    const scene_row row = {.name = name};
    finish_eyes(p);
    p->s.scenes = folder;
    if (stage_load(&p->s, &row, wind_east_m_s) != STAGE_OK) {
        return false;
    }
    stage_camera_init(&p->s, p->b->width, p->b->height, c);
    return stage_prepare(&p->s, c, p->b->width, 0.0) && eye_init(p, &p->preset, c, 0) &&
           eye_init(p, &p->every_pixel, c, 1) && eye_init(p, &p->truth, c, 1);
}

bool playback_draw(playback *p, playback_eye *e, const stage_camera *c, double time_s, uint32_t flags) {
    if ((flags & VELUM_VIEW_CUT) && !stage_prepare(&p->s, c, p->b->width, time_s)) {
        return false;
    }
    velum_result result = stage_draw(&p->s, &e->v, c, time_s, flags, &e->now, &e->cost);
    if (result < 0) {
        stage_fail(&p->s, "render", result);
    }
    return result >= 0;
}

bool playback_draw_truth(playback *p, const stage_camera *c, double time_s, uint32_t frames) {
    const picture *now = &p->truth.now;
    for (uint32_t i = 0; i < frames; i++) {
        if (!playback_draw(p, &p->truth, c, time_s, i == 0 ? VELUM_VIEW_CUT : 0)) {
            return false;
        }
        if (i + 1 == frames / 2) {
            memcpy(p->rougher, now->luminance, now->count * sizeof *p->rougher);
        }
    }
    metric m;
    if (!metric_compute(p->rougher, now->luminance, NULL, now->count, &m)) {
        return false;
    }
    p->truth_noise = m.error_raw;
    return true;
}
