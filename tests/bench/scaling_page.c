#include <errno.h>
#include <string.h>

#include "scaling.h"

enum { PAGE_PATH = 1024 };

static const char *verdict(double exponent) {
    return exponent <= SCALING_BOUND ? "holds" : "missed";
}

static void write_axis(FILE *file, const bench *b, const scaling_axis *a) {
    fprintf(file, "\n## %s\n\n%s. Memory: of the %s.\n\n| %s | ms a frame | ms of %s | samples | MB |\n", a->name,
            a->fixed, a->memory, a->name, b->device.is_processor ? "processor" : "device");
    fprintf(file, "| --- | --- | --- | --- | --- |\n");
    for (uint32_t i = 0; i < a->count; i++) {
        fprintf(file, "| %.3g | %.0f | %.0f | %.3g M | %.1f |\n", a->sizes[i], bench_median(&a->wall_ms[i]),
                bench_median(&a->work_ms[i]), 1e-6 * bench_median(&a->samples[i]), 1e-6 * a->bytes[i]);
    }
    fprintf(file,
            "\nTime grows as the power %.2f (standard error %.2f; between neighbours at most %.2f), memory as %.2f; "
            "bound %.2f: %s, %s.\n",
            a->time_growth.exponent, a->time_growth.sigma, a->time_growth.steepest, a->memory_growth.exponent,
            SCALING_BOUND, verdict(a->time_growth.exponent), verdict(a->memory_growth.exponent));
}

static bool write_page(const bench *b, const scaling_axis *axes, uint32_t count, const char *folder) {
    char path[PAGE_PATH];
    snprintf(path, sizeof path, "%s/scaling.md", folder);
    FILE *file = fopen(path, "w");
    if (!file) {
        fprintf(stderr, "velum-bench: %s: %s\n", path, strerror(errno));
        return false;
    }
    fprintf(file,
            "# How time and memory grow\n\nMade by `velum-bench --case scaling --out tests/report` on %s. Preset "
            "medium, time goes on, a shadow map is renewed each frame; medians of frames in turn. Exponents are least "
            "squares of the logarithms, of the %s's time, which other work on the machine disturbs least.\n\n"
            "![growth](scaling.png)\n",
            b->device.name, b->device.is_processor ? "processor" : "device");
    for (uint32_t i = 0; i < count; i++) {
        write_axis(file, b, &axes[i]);
    }
    bool ok = !ferror(file);
    return fclose(file) == 0 && ok;
}

static void write_data(FILE *file, const scaling_axis *a, bool memory) {
    for (uint32_t i = 0; i < a->count; i++) {
        fprintf(file, "%.9g %.9g\n", a->sizes[i], memory ? 1e-6 * a->bytes[i] : bench_median(&a->work_ms[i]));
    }
    fprintf(file, "e\n");
}

/* Beside each curve, what is linear from its last point. */
static void write_plot(FILE *file, const bench *b, const scaling_axis *a) {
    const uint32_t last = a->count - 1;
    double per_ms = bench_median(&a->work_ms[last]) / a->sizes[last];
    double per_mb = 1e-6 * a->bytes[last] / a->sizes[last];
    fprintf(file, "set title \"%s\" noenhanced\nset xlabel \"%s\"\nset xrange [%.9g:%.9g]\n", a->fixed, a->name,
            0.8 * a->sizes[0], 1.25 * a->sizes[last]);
    fprintf(file, "set xtics (");
    for (uint32_t i = 0; i < a->count; i++) {
        fprintf(file, "%s\"%.2g\" %.9g", i ? ", " : "", a->sizes[i], a->sizes[i]);
    }
    fprintf(file, ")\n");
    fprintf(file,
            "plot '-' with linespoints lw 2 pt 7 lc rgb \"#0072B2\" title \"ms of %s, power %.2f\", "
            "'-' with linespoints lw 2 pt 5 lc rgb \"#D55E00\" title \"MB of the %s, power %.2f\", "
            "%.9g*x with lines dt 2 lc rgb \"#0072B2\" title \"linear\", "
            "%.9g*x with lines dt 2 lc rgb \"#D55E00\" notitle\n",
            b->device.is_processor ? "processor" : "device", a->time_growth.exponent, a->memory,
            a->memory_growth.exponent, per_ms, per_mb);
    write_data(file, a, false);
    write_data(file, a, true);
}

static bool write_chart(const bench *b, const scaling_axis *axes, uint32_t count, const char *folder) {
    FILE *file = popen("gnuplot", "w");
    if (!file) {
        fprintf(stderr, "velum-bench: gnuplot: %s\n", strerror(errno));
        return false;
    }
    fprintf(file,
            "set terminal pngcairo size 1200,420 font \"Sans,10\"\nset output \"%s/scaling.png\"\n"
            "set logscale xy\nset grid lt 1 lw 0.7 lc rgb \"#cccccc\"\nset key top left Left reverse samplen 2\n"
            "set yrange [1:20000]\nset multiplot layout 1,%u\n",
            folder, count);
    for (uint32_t i = 0; i < count; i++) {
        write_plot(file, b, &axes[i]);
    }
    fprintf(file, "unset multiplot\n");
    int status = pclose(file);
    if (status != 0) {
        fprintf(stderr, "velum-bench: gnuplot failed\n");
    }
    return status == 0;
}

bool scaling_page(const bench *b, const scaling_axis *axes, uint32_t count, const char *folder) {
    return write_page(b, axes, count, folder) && write_chart(b, axes, count, folder);
}
