#include "metric.h"

#include <math.h>
#include <stdlib.h>

double metric_luminance(const float rgb[3]) {
    return 0.2126 * (double)rgb[0] + 0.7152 * (double)rgb[1] + 0.0722 * (double)rgb[2];
}

static bool is_valid(float a, float b) {
    return isfinite(a) && isfinite(b) && a >= 0.0f && b >= 0.0f;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a;
    double y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The least value that at least 99 % of all do not exceed. */
static double percentile_99(double *values, uint32_t count) {
    qsort(values, count, sizeof *values, ascending);
    uint32_t rank = (uint32_t)ceil(0.99 * count - 1e-9);
    return values[rank > 0 ? rank - 1 : 0];
}

bool metric_compute(const float *picture, const float *reference, const float *variance, uint32_t count, metric *out) {
    *out = (metric){0};
    double *relative = malloc((count + 1u) * sizeof *relative);
    if (!relative) {
        return false;
    }
    double sum_picture = 0.0, sum_reference = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        if (is_valid(picture[i], reference[i])) {
            sum_picture += (double)picture[i];
            sum_reference += (double)reference[i];
            out->pixels++;
        } else {
            out->invalid++;
        }
    }
    bool ok = out->pixels > 0 && (sum_reference > 0.0 || sum_picture == 0.0);
    if (!ok || sum_reference == 0.0) {
        goto done;
    }
    out->mean = sum_reference / out->pixels;
    out->bias = sum_picture / sum_reference - 1.0;
    double squares = 0.0, noise = 0.0, unsure = 0.0, spread = 0.0;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!is_valid(picture[i], reference[i])) {
            continue;
        }
        double d = fmax((double)reference[i], 0.01 * out->mean);
        double e = ((double)picture[i] - (double)reference[i]) / d;
        double v = variance && isfinite(variance[i]) ? fmax((double)variance[i], 0.0) / (d * d) : 0.0;
        squares += e * e;
        noise += v;
        unsure += 4.0 * fmax(e * e - v, 0.0) * v + 2.0 * v * v;
        spread += v * d * d;
        relative[kept++] = fabs(e);
    }
    double square = fmax(squares - noise, 0.0) / out->pixels;
    out->error_raw = sqrt(squares / out->pixels);
    out->noise = sqrt(noise / out->pixels);
    out->error = sqrt(square);
    out->error_sigma = sqrt(square + sqrt(unsure) / out->pixels) - out->error;
    out->bias_sigma = sqrt(spread) / sum_reference;
    out->p99 = percentile_99(relative, kept);
done:
    free(relative);
    return ok;
}

uint32_t metric_blocks(const float *picture, const float *variance, uint32_t width, uint32_t height, uint32_t side,
                       float *out_picture, float *out_variance) {
    uint32_t count = 0;
    for (uint32_t top = 0; top < height; top += side) {
        for (uint32_t left = 0; left < width; left += side) {
            double sum = 0.0, spread = 0.0;
            uint32_t pixels = 0;
            for (uint32_t y = top; y < height && y < top + side; y++) {
                for (uint32_t x = left; x < width && x < left + side; x++) {
                    sum += (double)picture[y * width + x];
                    spread += variance ? (double)variance[y * width + x] : 0.0;
                    pixels++;
                }
            }
            out_picture[count] = (float)(sum / pixels);
            if (out_variance) {
                out_variance[count] = (float)(spread / pixels / pixels);
            }
            count++;
        }
    }
    return count;
}

/* Sums of valid pixels over the 3 x 3 about (x, y). */
typedef struct neighbourhood {
    double picture, reference, variance;
    uint32_t count;
} neighbourhood;

static neighbourhood about(const float *picture, const float *reference, const float *variance, uint32_t width,
                           uint32_t height, uint32_t x, uint32_t y) {
    neighbourhood n = {.count = 0};
    for (uint32_t v = y > 0 ? y - 1 : 0; v < height && v <= y + 1; v++) {
        for (uint32_t u = x > 0 ? x - 1 : 0; u < width && u <= x + 1; u++) {
            uint32_t i = v * width + u;
            if (is_valid(picture[i], reference[i])) {
                n.picture += (double)picture[i];
                n.reference += (double)reference[i];
                n.variance += variance && isfinite(variance[i]) ? fmax((double)variance[i], 0.0) : 0.0;
                n.count++;
            }
        }
    }
    return n;
}

void metric_difference(const float *picture, const float *reference, const float *variance, uint32_t width,
                       uint32_t height, float *out) {
    double sum = 0.0;
    uint32_t valid = 0;
    for (uint32_t i = 0; i < width * height; i++) {
        if (is_valid(picture[i], reference[i])) {
            sum += (double)reference[i];
            valid++;
        }
    }
    double floor_of_d = valid ? 0.01 * sum / valid : 0.0;
    for (uint32_t i = 0; i < width * height; i++) {
        if (!is_valid(picture[i], reference[i])) {
            out[i] = NAN;
            continue;
        }
        neighbourhood n = about(picture, reference, variance, width, height, i % width, i / width);
        double d = fmax(fmax(n.reference / n.count, floor_of_d), 1e-30);
        double e = (n.picture - n.reference) / n.count / d;
        double v = n.variance / n.count / n.count / (d * d);
        out[i] = (float)copysign(sqrt(fmax(e * e - v, 0.0)), e);
    }
}

bool metric_noise(const float *reference, const float *variance, uint32_t width, uint32_t height, double *out_noise,
                  double *out_noise_8) {
    uint32_t count = width * height;
    uint32_t blocks = ((width + 7) / 8) * ((height + 7) / 8);
    float *mean = calloc(2u * blocks + 1u, sizeof *mean);
    double sum = 0.0, noise = 0.0, noise_8 = 0.0;
    for (uint32_t i = 0; i < count; i++) {
        sum += isfinite(reference[i]) ? (double)reference[i] / count : 0.0;
    }
    bool ok = mean && sum > 0.0;
    for (uint32_t i = 0; i < count && ok; i++) {
        double d = fmax((double)reference[i], 0.01 * sum);
        noise += (double)variance[i] / (d * d) / count;
    }
    if (ok) {
        metric_blocks(reference, variance, width, height, 8, mean, mean + blocks);
    }
    for (uint32_t i = 0; i < blocks && ok; i++) {
        double d = fmax((double)mean[i], 0.01 * sum);
        noise_8 += (double)mean[blocks + i] / (d * d) / blocks;
    }
    free(mean);
    *out_noise = ok ? sqrt(noise) : (double)INFINITY;
    *out_noise_8 = ok ? sqrt(noise_8) : (double)INFINITY;
    return ok;
}
