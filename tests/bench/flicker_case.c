/* Change from frame to frame that is not the clouds'. */
#include <stdlib.h>
#include <string.h>

#include "measures.h"
#include "playback.h"

#define FRAME_S (1.0 / 60.0)
#define BOUND 1.0 /* of 255 */
#define SPARK 4.0 /* the same */

/* Frames until the picture has settled to what the moving clouds allow; then pairs of neighbours. Truths of neighbours
 * are of the same places along the same rays: few frames make them differ by the clouds alone. */
enum { SETTLE = 48, PAIRS = 3, TRUTH_FRAMES = 4 };

typedef struct sky {
    const char *case_name, *name, *folder, *scenario;
    float wind_east_m_s;
} sky;

static const sky skies[] = {{"flicker_fair", "fair weather", BENCH_HOST_SCENES, "fair_weather", 0.0f},
                            {"flicker_overcast", "overcast", ACCURACY_SCENES, "overcast_below", 12.0f},
                            {"flicker_storm", "thunderstorm", ACCURACY_SCENES, "thunderstorm", 12.0f}};

/* As shown, 0..255: this frame's and the last one's, of the preset and of the truth. */
typedef struct shown {
    float *preset[2], *truth[2];
} shown;

static bool play(playback *p, const sky *which, const stage_camera *c, shown *s) {
    static bench_series change, own, beyond, excess, sparks;
    memset(&change, 0, sizeof change);
    memset(&own, 0, sizeof own);
    memset(&beyond, 0, sizeof beyond);
    memset(&excess, 0, sizeof excess);
    memset(&sparks, 0, sizeof sparks);
    const uint32_t pixels = p->preset.now.count;
    double exposure = 0.0;
    for (uint32_t frame = 0; frame <= SETTLE + PAIRS; frame++) {
        const double t_s = FRAME_S * frame;
        const uint32_t now = frame & 1u;
        if (!playback_draw(p, &p->preset, c, t_s, frame == 0 ? VELUM_VIEW_CUT : 0)) {
            return false;
        }
        if (frame < SETTLE) {
            continue;
        }
        if (!playback_draw_truth(p, c, t_s, TRUTH_FRAMES)) {
            return false;
        }
        exposure = exposure > 0.0 ? exposure : picture_exposure(&p->truth.now);
        tone_mapped(p->preset.now.rgb, pixels, exposure, s->preset[now]);
        tone_mapped(p->truth.now.rgb, pixels, exposure, s->truth[now]);
        if (frame > SETTLE) {
            double whole = mean_change(s->preset[now ^ 1u], s->preset[now], pixels);
            double clouds = mean_change(s->truth[now ^ 1u], s->truth[now], pixels);
            bench_add(&change, whole);
            bench_add(&own, clouds);
            bench_add(&beyond, whole - clouds);
            bench_add(&sparks, share_beyond(s->preset[now ^ 1u], s->preset[now], s->truth[now ^ 1u], s->truth[now],
                                            pixels, SPARK));
            bench_add(&excess,
                      mean_excess(s->preset[now ^ 1u], s->preset[now], s->truth[now ^ 1u], s->truth[now], pixels));
        }
    }
    const bench *b = p->b;
    bench_report(b, which->name, "change", "1/255", &change);
    bench_report(b, which->name, "clouds_own_change", "1/255", &own);
    bench_judge(b, which->name, "beyond_clouds_own", "1/255", &beyond, BENCH_AT_MOST, BOUND);
    /* Pixel by pixel: what moves too little somewhere does not make up for what moves too much elsewhere. */
    bench_judge(b, which->name, "beyond_by_pixel", "1/255", &excess, BENCH_AT_MOST, BOUND);
    bench_report(b, which->name, "pixels_beyond_by_4", "1", &sparks);
    return true;
}

static bool flicker(bench *b) {
    playback p;
    shown s = {.preset = {NULL}};
    const size_t bytes = 3 * (size_t)b->width * b->height * sizeof(float);
    bool ok = playback_init(&p, b);
    for (int i = 0; i < 2; i++) {
        s.preset[i] = malloc(bytes);
        s.truth[i] = malloc(bytes);
        ok = ok && s.preset[i] && s.truth[i];
    }
    for (size_t i = 0; i < sizeof skies / sizeof skies[0] && ok; i++) {
        stage_camera c;
        if (strcmp(b->case_name, skies[i].case_name) == 0) {
            ok = playback_load(&p, skies[i].folder, skies[i].scenario, skies[i].wind_east_m_s, &c) &&
                 play(&p, &skies[i], &c, &s);
        }
    }
    for (int i = 0; i < 2; i++) {
        free(s.preset[i]);
        free(s.truth[i]);
    }
    playback_finish(&p);
    return ok;
}

const bench_case bench_flicker_cases[] = {
    {"flicker_fair",
     "fair weather, standing, wind on, settled: change of pixels from frame to frame beyond the clouds' own", flicker},
    {"flicker_overcast", "the same under overcast stratocumulus", flicker},
    {"flicker_storm", "the same before a thunderstorm", flicker},
    {NULL, NULL, NULL},
};
