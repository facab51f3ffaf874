/* What cases make of their figures: the growth of a cost, the change of a picture. */
#ifndef BENCH_MEASURES_H
#define BENCH_MEASURES_H

#include <stdint.h>

/* A cost that grows as size^exponent: least squares of the logarithms; sizes and costs above 0, two at least. */
typedef struct growth {
    double exponent, sigma; /* standard error; 0 of two points */
    double steepest;        /* between neighbours */
} growth;

growth growth_of(const double *sizes, const double *costs, uint32_t count);

/* Luminance (linear, 3 floats a pixel) as the sample host shows it, 0..255 a channel, not rounded: the mean of a change
 * is that of the rounded values. exposure_m2_cd: what makes a luminance 1. */
void tone_mapped(const float *rgb, uint32_t pixels, double exposure_m2_cd, float *out);
/* Mean over pixels and channels of |b - a|. */
double mean_change(const float *a, const float *b, uint32_t pixels);
/* Mean over pixels and channels of how much |b - a| exceeds |d - c|. */
double mean_excess(const float *a, const float *b, const float *c, const float *d, uint32_t pixels);
/* Share of pixels of which a channel exceeds so by more than `limit`. */
double share_beyond(const float *a, const float *b, const float *c, const float *d, uint32_t pixels, double limit);

#endif
