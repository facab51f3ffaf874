/* How far a picture is from its reference: one definition for every table and chart.
 *
 * Pictures are luminance, cd/m2: 0.2126 R + 0.7152 G + 0.0722 B of what the pilot sees (cloud, air, Velum's own ground;
 * nothing of a host's behind it). With p a pixel, r the reference's, m the mean of all r, d = max(r, m / 100):
 *   error_raw = sqrt(mean(((p - r) / d)^2)),  bias = mean(p) / m - 1,  p99 = 99th percentile of |p - r| / d.
 * The reference is a mean over paths with a known variance V, and its own noise is not charged:
 *   noise = sqrt(mean(V / d^2)),  error = sqrt(max(error_raw^2 - noise^2, 0)),
 * whose expectation is that of a reference without noise but for d, which holds a little of it. error^2 is left unsure
 * by s, s^2 = mean((4 (p - R)^2 V + 2 V^2) / d^4) / n with (p - R)^2 from (p - r)^2 - V (the variance of the square of
 * a normal deviate); error_sigma = sqrt(error^2 + s) - error. p99 holds the noise: take it over blocks. */
#ifndef ACCURACY_METRIC_H
#define ACCURACY_METRIC_H

#include <stdbool.h>
#include <stdint.h>

typedef struct metric {
    double error, error_sigma; /* relative, the reference's noise subtracted */
    double error_raw, noise;
    double bias, bias_sigma, p99;
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

/* (p - r) / d of means over 3 x 3 pixels, towards 0 by what the noise of those means explains: its square less V / d^2,
 * not below 0. NaN where either is invalid. Same arguments as above; out: width * height. */
void metric_difference(const float *picture, const float *reference, const float *variance, uint32_t width,
                       uint32_t height, float *out);
/* `noise` of pixels, and of means over 8 x 8. False: out of memory, or a black reference. */
bool metric_noise(const float *reference, const float *variance, uint32_t width, uint32_t height, double *out_noise,
                  double *out_noise_8);

#endif
