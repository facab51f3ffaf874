#include <math.h>
#include <string.h>

#include "chart.h"

static bool any_of(const program *p, const char *scene) {
    for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
        if (chart_preset(p, scene, q)) {
            return true;
        }
    }
    return false;
}

/* Over all scenes. */
static void write_overall(const program *p, FILE *file) {
    fprintf(
        file,
        "| preset | error, 8 x 8 | error, pixels | bias, mean | bias, largest | 99 %% within, mean | ms a megapixel | "
        "samples a pixel | scenes |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n");
    for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
        double square_8 = 0.0, square = 0.0, bias = 0.0, largest = 0.0, within = 0.0, ms = 0.0, samples = 0.0,
               noise = 0.0;
        uint32_t count = 0;
        for (const scene_row *row = scene_rows; row->name; row++) {
            const measurement *m = chart_preset(p, row->name, q);
            if (m) {
                square_8 += m->m_8.error * m->m_8.error;
                square += m->m.error * m->m.error;
                noise = fmax(noise, m->m.noise);
                bias += m->m.bias;
                largest = fabs(m->m.bias) > fabs(largest) ? m->m.bias : largest;
                within += m->p99_4;
                ms += m->ms_per_megapixel;
                samples += m->samples + m->light_samples;
                count++;
            }
        }
        if (count > 0) {
            fprintf(file, "| %s | %.3f | %s%.3f | %+.3f | %+.3f | %.2f | %.0f | %.1f | %u |\n", measure_preset(q),
                    sqrt(square_8 / count), noise > 0.1 ? "~" : "", sqrt(square / count), bias / count, largest,
                    within / count, ms / count, samples / count, count);
        }
    }
}

static void write_scenes(const program *p, FILE *file) {
    fprintf(file, "| scene |");
    for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
        fprintf(file, " %s: error | bias | 99 %% | ms |", measure_preset(q));
    }
    fprintf(file, " the reference's noise |\n| ---");
    for (int k = 0; k < 17; k++) {
        fprintf(file, " | ---");
    }
    fprintf(file, " |\n");
    for (const scene_row *row = scene_rows; row->name; row++) {
        const measurement *last = NULL;
        if (!any_of(p, row->name)) {
            continue;
        }
        fprintf(file, "| %s |", row->name);
        for (int32_t q = VELUM_QUALITY_LOW; q <= VELUM_QUALITY_ULTRA; q++) {
            const measurement *m = chart_preset(p, row->name, q);
            if (m) {
                const metric *of = p->by_pixel ? &m->m : &m->m_8;
                fprintf(file, " %.3f ± %.3f | %+.3f | %.2f | %.0f |", of->error, of->error_sigma, m->m.bias, m->p99_4,
                        m->ms_per_megapixel);
                last = m;
            } else {
                fprintf(file, " - | - | - | - |");
            }
        }
        fprintf(file, " %.3f, %.3f, %.0f |\n", last->m_8.noise, last->m.noise, last->paths);
    }
}

static void write_charts(const chart *c, FILE *file) {
    fprintf(
        file,
        "\n## Charts\n\nMeans over the scenes marked so in `velum-accuracy list`; numbers at the points are the "
        "curve's values. A ring marks the Pareto front of those that move alike. A third chart, where there is one, "
        "compares each curve with the finest of the same instead of the reference: what is left is the error of "
        "the steps alone.\n");
    bool methods = false;
    for (uint32_t k = 0; k < c->count; k++) {
        const char *group = c->points[k].group;
        if (!chart_is_first(c, k)) {
            continue;
        }
        bool is_preset = strcmp(group, "preset") == 0;
        bool has_limit = false;
        for (uint32_t i = k; i < c->count; i++) {
            has_limit = has_limit || (strcmp(c->points[i].group, group) == 0 && c->points[i].square_limit > 1e-10);
        }
        fprintf(file,
                "\n### %s\n\n![%s, ms](%s_ms.png) ([SVG](%s_ms.svg))\n![%s, samples](%s_samples.png) "
                "([SVG](%s_samples.svg))\n",
                chart_title(group), group, group, group, group, group, group);
        if (has_limit) {
            fprintf(file, "![%s, against the finest](%s_limit.png) ([SVG](%s_limit.svg))\n", group, group, group);
        }
        methods = methods || !is_preset;
    }
    if (methods) {
        fprintf(file, "\n### All on one\n\n![all](all_ms.png) ([SVG](all_ms.svg))\n");
    }
}

static void write_pictures(const program *p, FILE *file) {
    fprintf(
        file,
        "\n## Pictures\n\nFrom left to right: low, medium, high, ultra, reference. Below each preset its difference "
        "from the reference (means over 3 x 3, less what the reference's noise explains): red is too bright, blue "
        "too dark, full colour at 50 %%; below the reference the standard error of its pixels, black at 50 %%.\n");
    for (const scene_row *row = scene_rows; row->name; row++) {
        if (any_of(p, row->name)) {
            fprintf(file, "\n%s: %s\n\n![%s](%s.png)\n", row->name, row->about, row->name, row->name);
        }
    }
}

bool chart_write_page(const chart *c) {
    const program *p = c->p;
    FILE *file = chart_create(p, "README.md");
    if (!file) {
        return false;
    }
    fprintf(
        file,
        "# Error against time\n\nMade by\n\n    velum-accuracy reference --size %ux%u\n    velum-accuracy chart DIR "
        "--size %ux%u --method %s%s%s\n\non %s; pictures of %u x %u pixels. Every figure is in "
        "[results.jsonl](results.jsonl).\n\n"
        "Error: relative root mean square error of luminance against the unbiased reference, each pixel (or mean over "
        "8 x 8) over the greater of its "
        "reference and 1 %% of the scene's mean; the reference's own noise is subtracted, ± is what it leaves "
        "unsure. Bias: of the mean luminance. 99 %%: of means over 4 x 4 pixels so many lie within (with what noise "
        "they have). ms: of the view alone, a megapixel, median of the settled frames "
        "([metric.h](../accuracy/metric.h)).\n\n## Presets\n\nOver all scenes (root of the mean square; means):\n\n",
        p->reference.width, p->reference.height, p->reference.width, p->reference.height, c->method,
        p->by_pixel ? " --pixels" : "", p->reference.cached ? " --cached" : "", p->s.device_name, p->reference.width,
        p->reference.height);
    write_overall(p, file);
    fprintf(file, "\nScene by scene, error %s:\n\n", p->by_pixel ? "of pixels" : "of means over 8 x 8");
    write_scenes(p, file);
    fprintf(file, "\nThe reference's noise: of means over 8 x 8, of pixels; its paths a pixel, from the variance of "
                  "which the noise is known. ~: some reference's pixels are noisier than 10 %%, and divide by their "
                  "noise: errors of pixels are then too large.\n");
    write_charts(c, file);
    fprintf(file,
            "\n## Published figures beside ours\n\nTheir works gave times on other machines and no errors: times are "
            "ratios to each one's own base, our errors stand beside.\n");
    tables_write(p, file);
    write_pictures(p, file);
    return chart_finish(file);
}
