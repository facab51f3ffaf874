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
    double squares = 0.0, noise = 0.0;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (!is_valid(picture[i], reference[i])) {
            continue;
        }
        double d = fmax((double)reference[i], 0.01 * out->mean);
        double e = ((double)picture[i] - (double)reference[i]) / d;
        squares += e * e;
        relative[kept++] = fabs(e);
        if (variance && isfinite(variance[i])) {
            noise += fmax((double)variance[i], 0.0) / (d * d);
        }
    }
    out->error = sqrt(squares / out->pixels);
    out->noise = sqrt(noise / out->pixels);
    out->error_corrected = sqrt(fmax(squares - noise, 0.0) / out->pixels);
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
