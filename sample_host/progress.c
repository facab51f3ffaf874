#include "progress.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { BAR_COLUMNS = 40 };

static double now_s(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (double)time.tv_sec + 1e-9 * (double)time.tv_nsec;
}

void progress_start(struct progress *progress, uint64_t total) {
    *progress = (struct progress){.shown = isatty(STDERR_FILENO) == 1 && total > 1, .total = total};
    progress->started_s = now_s();
    progress_update(progress, 0);
}

void progress_update(struct progress *progress, uint64_t done) {
    double now = progress->shown ? now_s() : 0;
    if (!progress->shown || (now - progress->drawn_s < 0.1 && done < progress->total)) {
        return;
    }
    progress->drawn_s = now;
    char bar[BAR_COLUMNS + 1];
    uint64_t full = done * BAR_COLUMNS / progress->total;
    for (uint64_t i = 0; i < BAR_COLUMNS; i++) {
        bar[i] = i < full ? '#' : '.';
    }
    bar[BAR_COLUMNS] = '\0';
    double left_s = done > 0 ? (now - progress->started_s) * (double)(progress->total - done) / (double)done : 0;
    fprintf(stderr, "\r[%s] %llu/%llu  %.0f s left \033[K", bar, (unsigned long long)done,
            (unsigned long long)progress->total, left_s);
    fflush(stderr);
}

void progress_finish(struct progress *progress) {
    if (progress->shown) {
        fputs("\r\033[K", stderr);
        fflush(stderr);
        progress->shown = false;
    }
}
