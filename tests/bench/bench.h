/* velum-bench: a named table of cases. Variants of a case run in turn (A B A B ...), so that a machine that gets slower
 * gets slower for all; medians are reported. Bounds stand beside their figures with whether they hold; a case fails
 * only where it cannot measure. */
#ifndef BENCH_BENCH_H
#define BENCH_BENCH_H

#include <stdio.h>

#include "../abi/host.h"
#include "../abi/vulkan_device.h"

enum { BENCH_SAMPLES = 1024 };

/* Values of one figure of one variant. */
typedef struct bench_series {
    uint32_t count;
    double values[BENCH_SAMPLES];
} bench_series;

typedef struct bench {
    test_host host;
    vulkan_device device;
    bool has_device;
    char no_device[256];
    const char *shared;     /* folder of real weather files; may be missing */
    const char *scenario;   /* null: the built-in weather */
    const char *out;        /* folder of charts and pictures; null: none are made */
    uint32_t width, height; /* of the cases that compare pictures */
    uint32_t rounds, frames;
    bool json;
    const char *case_name;
} bench;

typedef struct bench_case {
    const char *name;
    const char *about;
    bool (*run)(bench *b); /* false: failed, said */
} bench_case;

/* Each ends with a null name. */
extern const bench_case bench_frame_cases[], bench_weather_cases[], bench_fetch_cases[], bench_scaling_cases[],
    bench_motion_cases[], bench_flicker_cases[], bench_budget_cases[];

double bench_now_ms(void);
/* Of all threads of the process: with a software device the work itself, whatever else the machine does. */
double bench_cpu_ms(void);
void bench_add(bench_series *series, double value);
double bench_median(const bench_series *series);
double bench_least(const bench_series *series);
double bench_greatest(const bench_series *series);
/* One line: the median, the least and the greatest. `unit`: "ms", "bytes", "1" for counts and ratios. */
void bench_report(const bench *b, const char *variant, const char *figure, const char *unit,
                  const bench_series *series);
void bench_report_value(const bench *b, const char *variant, const char *figure, const char *unit, double value);
/* The same with a bound on the median. */
typedef enum bench_sense { BENCH_AT_MOST, BENCH_AT_LEAST } bench_sense;
void bench_judge(const bench *b, const char *variant, const char *figure, const char *unit, const bench_series *series,
                 bench_sense sense, double bound);
void bench_judge_value(const bench *b, const char *variant, const char *figure, const char *unit, double value,
                       bench_sense sense, double bound);
void bench_skip(const bench *b, const char *reason);
bool bench_fail(const bench *b, const char *what, velum_result result);

#endif
