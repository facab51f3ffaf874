/* The presets against what they are to hold over all scenes, and the volume of light in some, with the references that
 * are at hand. */
#include <math.h>
#include <string.h>

#include "plugin/preset_figures.h"
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
/* Of every scene. */
static const double scene_error = 0.22, scene_bias = 0.09;
/* Over what a preset came to when it was last charted. Scenes of real weather may be missing here. */
static const double slack = 1.08;

/* Of a preset over the scenes. False: it does not hold its bound. */
static bool hold(const program *p, int at) {
    double square = 0.0, bias = 0.0;
    uint32_t count = 0;
    bool holds = true;
    for (uint32_t i = 0; i < p->result_count; i++) {
        const measurement *m = &p->results[i];
        if (strcmp(m->group, "preset") == 0 && m->value == (double)bounds[at].quality) {
            if (!(m->m_8.error <= scene_error && fabs(m->m.bias) <= scene_bias)) {
                printf("%-8s %s: error %.3f (%.2f), bias %+.3f (%.2f): MISSED\n", measure_preset(bounds[at].quality),
                       m->scene, m->m_8.error, scene_error, m->m.bias, scene_bias);
                holds = false;
            }
            square += m->m_8.error * m->m_8.error;
            bias += m->m.bias;
            count++;
        }
    }
    const double error = sqrt(square / count);
    bias /= count;
    const double charted = slack * (double)preset_figures_of[bounds[at].quality - VELUM_QUALITY_LOW].error;
    holds = holds && error <= fmin(bounds[at].error, charted) && fabs(bias) <= bounds[at].bias;
    printf("%-8s error %.3f (%.3f, %.2f), bias %+.3f (%.2f) over %u scenes: %s\n", measure_preset(bounds[at].quality),
           error, charted, bounds[at].error, bias, bounds[at].bias, count, holds ? "holds" : "MISSED");
    return holds;
}

/* A volume of light knows no constant that was fitted: of one cloud from its side, and from under a deck, where light
 * comes by its flux, it gets all but what its cells blur. */
static const char volume_method[] = "volume of light, once made";
static const double volume_cell_m = 200.0;
static const struct {
    const char *scene;
    double error, bias;
} volume_bounds[] = {{"cumulus_side", 0.06, 0.012}, {"overcast_below", 0.14, 0.05}};

static bool hold_volume(program *p, int at) {
    const uint32_t before = p->result_count, failed = p->failed, skipped = p->skipped;
    bool wanted = false;
    p->method = volume_method;
    p->value = volume_cell_m;
    for (const scene_row *row = scene_rows; row->name; row++) {
        if (strcmp(row->name, volume_bounds[at].scene) == 0 && program_wants(p, row)) {
            wanted = true;
            program_run_scene(p, row, false);
        }
    }
    if (p->failed > failed || p->result_count == before) {
        return p->failed == failed && (!wanted || p->skipped > skipped);
    }
    const measurement *m = &p->results[before];
    const bool holds = m->m_8.error <= volume_bounds[at].error && fabs(m->m.bias) <= volume_bounds[at].bias;
    printf("%s, cells of %g m, %s: error %.3f (%.2f), bias %+.3f (%.3f): %s\n", volume_method, volume_cell_m, m->scene,
           m->m_8.error, volume_bounds[at].error, m->m.bias, volume_bounds[at].bias, holds ? "holds" : "MISSED");
    return holds;
}

int bounds_run(program *p) {
    uint32_t missing = 0;
    p->method = NULL;
    p->reference.cached = true;
    p->at_hand = true;
    p->preset_count = 0;
    for (int i = 0; i < BOUNDS; i++) {
        p->presets[p->preset_count++] = bounds[i].quality;
    }
    for (const scene_row *row = scene_rows; row->name; row++) {
        const uint32_t before = p->result_count;
        if (program_wants(p, row)) {
            program_run_scene(p, row, true);
            missing += p->result_count == before && !row->real;
        }
    }
    if (p->result_count == 0) {
        return p->failed > 0;
    }
    /* All are made for the same sources: where there are some, the others are lost, or their scenes have changed. */
    bool ok = p->failed == 0 && missing == 0;
    if (missing > 0) {
        printf("%u scenes without a reference: MISSED\n", missing);
    }
    for (int i = 0; i < BOUNDS; i++) {
        ok = hold(p, i) && ok;
    }
    for (size_t i = 0; i < sizeof volume_bounds / sizeof volume_bounds[0]; i++) {
        ok = hold_volume(p, (int)i) && ok;
    }
    /* Real weather may not be there: that is told, and the others count. */
    p->skipped = 0;
    return !ok;
}
