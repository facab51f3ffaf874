/* The presets against what they are to hold over all scenes, with the references that are at hand. */
#include <math.h>

#include "program.h"

static const struct {
    int32_t quality;
    double error; /* root of the mean square over the scenes, of means over 8 x 8 */
    double bias;  /* mean over the scenes */
} bounds[] = {
    {VELUM_QUALITY_LOW, 0.25, 0.05},
    {VELUM_QUALITY_MEDIUM, 0.15, 0.02},
    {VELUM_QUALITY_HIGH, 0.10, 0.02},
};
enum { BOUNDS = sizeof bounds / sizeof bounds[0] };

/* Of a preset over the scenes. False: it does not hold its bound. */
static bool hold(const program *p, int at) {
    double square = 0.0, bias = 0.0;
    uint32_t count = 0;
    for (uint32_t i = 0; i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        if (m->value == (double)bounds[at].quality) {
            square += m->m_8.error * m->m_8.error;
            bias += m->m.bias;
            count++;
        }
    }
    const double error = sqrt(square / count);
    bias /= count;
    const bool holds = error <= bounds[at].error && fabs(bias) <= bounds[at].bias;
    printf("%-8s error %.3f (%.2f), bias %+.3f (%.2f) over %u scenes: %s\n", measure_preset(bounds[at].quality), error,
           bounds[at].error, bias, bounds[at].bias, count, holds ? "holds" : "MISSED");
    return holds;
}

int bounds_run(program *p) {
    p->reference.cached = true;
    p->at_hand = true;
    p->preset_count = 0;
    for (int i = 0; i < BOUNDS; i++) {
        p->presets[p->preset_count++] = bounds[i].quality;
    }
    for (const scene_row *row = scene_rows; row->name; row++) {
        if (program_wants(p, row)) {
            program_run_scene(p, row, true);
        }
    }
    if (p->result_count == 0) {
        return p->failed > 0;
    }
    bool ok = p->failed == 0;
    for (int i = 0; i < BOUNDS; i++) {
        ok = hold(p, i) && ok;
    }
    /* What some scenes lack is told; the others count. */
    p->skipped = 0;
    return !ok;
}
