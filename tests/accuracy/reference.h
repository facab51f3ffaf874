/* References: made once with VELUM_QUALITY_REFERENCE, kept in files under a key of everything that they depend on. */
#ifndef ACCURACY_REFERENCE_H
#define ACCURACY_REFERENCE_H

#include "stage.h"

typedef struct reference_options {
    const char *cache; /* folder */
    double error;      /* stop when the noise of means over blocks of 8 x 8 pixels is below this... */
    double seconds;    /* ... or after so long */
    uint32_t width, height;
} reference_options;

typedef struct reference {
    picture picture;
    double noise, noise_8; /* relative: of pixels, of means over blocks of 8 x 8 */
    double seconds;        /* that it took */
    double paths;          /* a pixel */
    uint32_t frames;
    bool stand_in; /* the plugin has no reference: long settled steps of the best preset instead */
    bool cached;
} reference;

/* Of the stage's scenario. name: of the scene; wind: part of the key. STAGE_*. */
int reference_get(stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                  const reference_options *options, reference *out);
void reference_finish(reference *r);
/* Of a picture with variance: see reference. */
void reference_noise(const picture *p, double *out_noise, double *out_noise_8);

#endif
