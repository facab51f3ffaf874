/* How time and memory grow: what the case measures, and its page. */
#ifndef BENCH_SCALING_H
#define BENCH_SCALING_H

#include "bench.h"
#include "measures.h"

enum { SCALING_SIZES = 8 };

/* One thing that grows, all others fixed. */
typedef struct scaling_axis {
    const char *name;
    const char *fixed;  /* what the rest is */
    const char *memory; /* whose memory */
    uint32_t count;
    double sizes[SCALING_SIZES];
    bench_series wall_ms[SCALING_SIZES], work_ms[SCALING_SIZES], samples[SCALING_SIZES];
    double bytes[SCALING_SIZES];
    growth time_growth, memory_growth;
} scaling_axis;

/* Of an exponent: linear, and what clouds that differ from view to view make of it. */
#define SCALING_BOUND 1.05

/* scaling.md and scaling.png (gnuplot) in a folder. False: said why. */
bool scaling_page(const bench *b, const scaling_axis *axes, uint32_t count, const char *folder);

#endif
