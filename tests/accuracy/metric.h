/* How far a picture is from its reference: one definition for every table and chart.
 *
 * Pictures are luminance, cd/m2: 0.2126 R + 0.7152 G + 0.0722 B of what the pilot sees (cloud, air, Velum's own ground;
 * nothing of a host's behind it). With p a pixel, r the reference's, m the mean of all r, d = max(r, m / 100):
 *   error = sqrt(mean(((p - r) / d)^2)),  bias = mean(p) / m - 1,  p99 = 99th percentile of |p - r| / d.
 * The reference is a mean with a variance: noise = sqrt(mean(variance / d^2)) is what error would be of a perfect
 * picture against it, and error_corrected = sqrt(max(error^2 - noise^2, 0)). */
#ifndef ACCURACY_METRIC_H
#define ACCURACY_METRIC_H

#include <stdbool.h>
#include <stdint.h>

typedef struct metric {
    double error, error_corrected, noise;
    double bias, p99;
    double mean;      /* of the reference, cd/m2 */
    uint32_t pixels;  /* that were compared */
    uint32_t invalid; /* NaN, infinite or negative, in either picture: left out of the rest */
} metric;

double metric_luminance(const float rgb[3]);
/* Of `count` pixels. variance: of the reference's luminance, may be null. False: out of memory, or nothing to compare
 * (no valid pixel; a black reference of a picture that is not black). */
bool metric_compute(const float *picture, const float *reference, const float *variance, uint32_t count, metric *out);
/* Means over blocks of side x side pixels (fewer at the right and lower edge), and the variance of those means. Returns
 * their number; `variance` and `out_variance` may be null. */
uint32_t metric_blocks(const float *picture, const float *variance, uint32_t width, uint32_t height, uint32_t side,
                       float *out_picture, float *out_variance);

#endif
