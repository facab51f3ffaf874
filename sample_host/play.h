/* play: the scenario as pictures, or in windows. */
#ifndef HOST_PLAY_H
#define HOST_PLAY_H

#include "options.h"

#include <stdbool.h>

/* The times that a command line asks for: count pictures, the first at from_s, each next step_s later. */
struct play_times {
    double from_s, step_s;
    uint64_t count;
};
bool play_times(const struct options *options, double duration_s, struct play_times *out);

bool play(const struct options *options);

#endif
