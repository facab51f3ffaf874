/* One picture made one way, against its reference. */
#ifndef ACCURACY_MEASURE_H
#define ACCURACY_MEASURE_H

#include <stdio.h>

#include "methods.h"
#include "metric.h"
#include "reference.h"

typedef struct measurement {
    const char *scene, *group, *name, *unit; /* group "preset": name is the preset's */
    method_motion motion;
    double value;
    metric m, m_8;      /* of pixels; of means over 8 x 8 */
    double p99_4;       /* 99th percentile of means over 4 x 4, with what noise they have */
    double error_limit; /* of pixels against what the curve tends to; negative: unknown */
    uint32_t frames;
    double ms, ms_per_megapixel;         /* a frame with what views share; of the view alone */
    double rays, samples, light_samples; /* a pixel and frame */
    uint32_t invalid;                    /* pixels of the last frame that are no numbers, or negative */
    double paths;                        /* a pixel of the reference, at least */
} measurement;

/* quality: the preset, or with `row` that of the row with its value set. `out` is the last frame; limit: may be null.
 * The stage must hold the scene (with the motion's wind). False, having said why. */
bool measure(stage *s, const char *scene, const stage_camera *c, const method_row *row, double value, int32_t quality,
             const reference *r, const picture *limit, picture *out, measurement *result);

float measure_wind(method_motion motion);
const char *measure_preset(int32_t quality);

void measure_print_head(void);
void measure_print(const measurement *m);
void measure_print_json(FILE *file, const measurement *m);

#endif
