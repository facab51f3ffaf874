/* A progress bar on stderr, where that is a terminal. */
#ifndef HOST_PROGRESS_H
#define HOST_PROGRESS_H

#include <stdbool.h>
#include <stdint.h>

struct progress {
    bool shown;
    uint64_t total;
    double started_s, drawn_s;
};

void progress_start(struct progress *progress, uint64_t total);
void progress_update(struct progress *progress, uint64_t done);
/* Wipes the bar. May be called twice. */
void progress_finish(struct progress *progress);

#endif
