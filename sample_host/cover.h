/* How much cloud there is around the eye: for the host's own daylight and exposure. */
#ifndef HOST_COVER_H
#define HOST_COVER_H

#include "daylight.h"
#include "scene.h"

#include <stdint.h>

enum { COVER_ROWS = 8, COVER_TICKS = 4, COVER_ANSWERS = COVER_ROWS * COVER_ROWS * 2 * COVER_TICKS };

/* What the plugin said of a place, a height and a time on the lattice of those. */
struct cover_answer {
    bool is_known;
    int64_t row, column, level, tick;
    struct cloud_cover cover;
};

/* One for each height that is asked for again and again; zeroed at first. */
struct cover_answers {
    struct cover_answer at[COVER_ANSWERS];
};

/* Cloud over a height at the place of a camera. False: the plugin refused (reported). */
bool cover_around(struct scene *scene, struct cover_answers *answers, const velum_scenario_camera *place,
                  double height_m, double time_s, struct cloud_cover *out);

#endif
