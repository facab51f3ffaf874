/* References: made with VELUM_QUALITY_REFERENCE, kept in files under a key of everything that they depend on, and
 * continued from there: what is added has random numbers of its own, and counts by its paths. */
#ifndef ACCURACY_REFERENCE_H
#define ACCURACY_REFERENCE_H

#include "stage.h"

typedef struct reference_options {
    const char *cache; /* folder */
    const char *kept;  /* folder of those that come with the sources: read where the cache has none */
    double error;      /* enough when the noise of means over blocks of 8 x 8 pixels is below this... */
    double paths;      /* ... or a pixel has so many; 0: no such limit... */
    double seconds;    /* ... or all that has been done took so long */
    double patience;   /* times that, for as long as there is nothing that could be kept */
    bool cached;       /* whatever is in the cache is enough, and nothing is added */
    uint32_t width, height;
} reference_options;

typedef struct reference {
    picture picture;
    double noise, noise_8; /* relative: of pixels, of means over blocks of 8 x 8 */
    double seconds;        /* that all of it took */
    double paths;          /* a pixel, at least */
    uint32_t parts;        /* that were made apart */
    char made_on[256];     /* the device of the last of them */
} reference;

/* Of the stage's scenario. name: of the scene; wind: part of the key. What is in the cache, continued where it is not
 * enough and kept every half minute, so that it can be stopped at any time. STAGE_*. */
int reference_get(stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                  const reference_options *options, reference *out);
/* What is in the cache alone. False: nothing. */
bool reference_load(stage *s, const char *name, const stage_camera *c, float wind_east_m_s,
                    const reference_options *options, reference *out);
/* For signal(): ends what is being made, which is kept, and program_make_references. */
void reference_stop(int signal_number);
bool reference_is_stopped(void);
bool reference_is_enough(const reference *r, const reference_options *options);
void reference_finish(reference *r);

#endif
