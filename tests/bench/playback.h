/* Scenes in motion, seen by three eyes: the preset as it is, the same with a ray for every pixel, and one that stays at
 * an instant until its picture has settled: the truth of that instant, but for what the preset itself gets wrong. */
#ifndef BENCH_PLAYBACK_H
#define BENCH_PLAYBACK_H

#include "../accuracy/metric.h"
#include "../accuracy/stage.h"
#include "bench.h"

typedef struct playback_eye {
    stage_view v;
    picture now;
    stage_cost cost; /* of the newest frame */
} playback_eye;

typedef struct playback {
    bench *b;
    stage s;
    playback_eye preset, every_pixel, truth;
    float *rougher;     /* luminance of the truth, half settled */
    double truth_noise; /* relative r.m.s. of what the newest truth still changed by in the second half of settling */
} playback;

/* The stage has a host of its own. False: said why. */
bool playback_init(playback *p, bench *b);
void playback_finish(playback *p);

/* A scenario NAME.json of a folder, with more wind from the west; eyes anew, where `c` stands. */
bool playback_load(playback *p, const char *folder, const char *name, float wind_east_m_s, stage_camera *c);

/* flags: VELUM_VIEW_CUT or 0. */
bool playback_draw(playback *p, playback_eye *e, const stage_camera *c, double time_s, uint32_t flags);
/* Over so many frames, even; each has a place of its own along all rays (plugin/record_view.c). */
bool playback_draw_truth(playback *p, const stage_camera *c, double time_s, uint32_t frames);

#endif
