#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench.h"

double bench_now_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

double bench_cpu_ms(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec * 1e3 + (double)now.tv_nsec * 1e-6;
}

void bench_add(bench_series *series, double value) {
    if (series->count < BENCH_SAMPLES) {
        series->values[series->count++] = value;
    }
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(const bench_series *series) {
    if (series->count == 0) {
        return 0.0;
    }
    double sorted[BENCH_SAMPLES];
    memcpy(sorted, series->values, series->count * sizeof sorted[0]);
    qsort(sorted, series->count, sizeof sorted[0], compare);
    return 0.5 * (sorted[(series->count - 1) / 2] + sorted[series->count / 2]);
}

double bench_least(const bench_series *series) {
    double least = INFINITY;
    for (uint32_t i = 0; i < series->count; i++) {
        least = fmin(least, series->values[i]);
    }
    return least;
}

double bench_greatest(const bench_series *series) {
    double greatest = -INFINITY;
    for (uint32_t i = 0; i < series->count; i++) {
        greatest = fmax(greatest, series->values[i]);
    }
    return greatest;
}

/* Names are ours, devices' names are not. */
static void write_string(const char *text) {
    putchar('"');
    for (; *text; text++) {
        if (*text == '"' || *text == '\\') {
            putchar('\\');
        }
        putchar((unsigned char)*text < 0x20 ? ' ' : *text);
    }
    putchar('"');
}

typedef struct judgement {
    bench_sense sense;
    double bound;
} judgement;

static void print(const bench *b, const char *variant, const char *figure, const char *unit, const bench_series *series,
                  const judgement *judged) {
    if (series->count == 0) {
        return;
    }
    double median = bench_median(series), low = bench_least(series), high = bench_greatest(series);
    bool at_most = judged && judged->sense == BENCH_AT_MOST;
    bool holds = judged && (at_most ? median <= judged->bound : median >= judged->bound);
    if (b->json) {
        printf("{\"case\": ");
        write_string(b->case_name);
        printf(", \"variant\": ");
        write_string(variant);
        printf(", \"figure\": ");
        write_string(figure);
        printf(", \"unit\": ");
        write_string(unit);
        printf(", \"median\": %.9g, \"min\": %.9g, \"max\": %.9g, \"runs\": %u, \"device\": ", median, low, high,
               series->count);
        write_string(b->has_device ? b->device.name : "");
        if (judged) {
            printf(", \"%s\": %.9g, \"holds\": %s", at_most ? "at_most" : "at_least", judged->bound,
                   holds ? "true" : "false");
        }
        printf("}\n");
    } else {
        printf("%-22s %-26s %-24s %14.6g %-6s %12.6g .. %-12.6g %u", b->case_name, variant, figure, median, unit, low,
               high, series->count);
        if (judged) {
            printf("  bound %s %.6g: %s", at_most ? "<=" : ">=", judged->bound, holds ? "holds" : "MISSED");
        }
        printf("\n");
    }
    fflush(stdout);
}

void bench_report(const bench *b, const char *variant, const char *figure, const char *unit,
                  const bench_series *series) {
    print(b, variant, figure, unit, series, NULL);
}

void bench_judge(const bench *b, const char *variant, const char *figure, const char *unit, const bench_series *series,
                 bench_sense sense, double bound) {
    print(b, variant, figure, unit, series, &(judgement){sense, bound});
}

void bench_judge_value(const bench *b, const char *variant, const char *figure, const char *unit, double value,
                       bench_sense sense, double bound) {
    bench_series one = {.count = 1, .values = {value}};
    bench_judge(b, variant, figure, unit, &one, sense, bound);
}

void bench_report_value(const bench *b, const char *variant, const char *figure, const char *unit, double value) {
    bench_series one = {.count = 1, .values = {value}};
    bench_report(b, variant, figure, unit, &one);
}

void bench_skip(const bench *b, const char *reason) {
    if (b->json) {
        printf("{\"case\": ");
        write_string(b->case_name);
        printf(", \"skipped\": ");
        write_string(reason);
        printf("}\n");
    } else {
        printf("%-22s skipped: %s\n", b->case_name, reason);
    }
    fflush(stdout);
}

bool bench_fail(const bench *b, const char *what, velum_result result) {
    fprintf(stderr, "velum-bench: %s: %s: %s: %s\n", b->case_name, what, velum_result_name(result),
            b->host.log.message);
    return false;
}
