#include "measures.h"

#include <math.h>
#include <stdbool.h>

#include "sample_host/shaders/tone_map.h"

growth growth_of(const double *sizes, const double *costs, uint32_t count) {
    growth g = {.steepest = -INFINITY};
    double mean_x = 0.0, mean_y = 0.0, xx = 0.0, xy = 0.0, rest = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        mean_x += log(sizes[i]) / count;
        mean_y += log(costs[i]) / count;
    }
    for (uint32_t i = 0; i < count; i++) {
        xx += (log(sizes[i]) - mean_x) * (log(sizes[i]) - mean_x);
        xy += (log(sizes[i]) - mean_x) * (log(costs[i]) - mean_y);
        if (i > 0) {
            g.steepest = fmax(g.steepest, log(costs[i] / costs[i - 1]) / log(sizes[i] / sizes[i - 1]));
        }
    }
    g.exponent = xy / xx;
    for (uint32_t i = 0; i < count; i++) {
        double left = log(costs[i]) - mean_y - g.exponent * (log(sizes[i]) - mean_x);
        rest += left * left;
    }
    g.sigma = count > 2 ? sqrt(rest / (count - 2) / xx) : 0.0;
    return g;
}

void tone_mapped(const float *rgb, uint32_t pixels, double exposure_m2_cd, float *out) {
    const float scale = (float)exposure_m2_cd;
    for (uint32_t i = 0; i < 3 * pixels; i += 3) {
        for (uint32_t c = 0; c < 3; c++) {
            float code = tone_map(scale * rgb[i], scale * rgb[i + 1], scale * rgb[i + 2], (int)c);
            out[i + c] = 255.0f * fminf(fmaxf(code, 0.0f), 1.0f);
        }
    }
}

double mean_change(const float *a, const float *b, uint32_t pixels) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 3 * pixels; i++) {
        sum += fabs((double)b[i] - (double)a[i]);
    }
    return sum / (3.0 * pixels);
}

static double excess(const float *a, const float *b, const float *c, const float *d, uint32_t i) {
    return fmax(fabs((double)b[i] - (double)a[i]) - fabs((double)d[i] - (double)c[i]), 0.0);
}

double mean_excess(const float *a, const float *b, const float *c, const float *d, uint32_t pixels) {
    double sum = 0.0;
    for (uint32_t i = 0; i < 3 * pixels; i++) {
        sum += excess(a, b, c, d, i);
    }
    return sum / (3.0 * pixels);
}

double share_beyond(const float *a, const float *b, const float *c, const float *d, uint32_t pixels, double limit) {
    uint32_t count = 0;
    for (uint32_t i = 0; i < 3 * pixels; i += 3) {
        bool is_beyond = false;
        for (uint32_t k = i; k < i + 3; k++) {
            is_beyond = is_beyond || excess(a, b, c, d, k) > limit;
        }
        count += is_beyond ? 1 : 0;
    }
    return (double)count / pixels;
}
