/* Pixels in host memory, and their files. */
#ifndef ACCURACY_PICTURE_H
#define ACCURACY_PICTURE_H

#include <stdbool.h>
#include <stdint.h>

typedef struct picture {
    uint32_t width, height, count;
    float *rgb, *transmittance; /* count * 3 */
    float *distance;            /* count */
    float *luminance;           /* count, from rgb */
    float *variance;            /* count: of the luminance; 0 where nobody says */
} picture;

/* False, having said so: out of memory. */
bool picture_init(picture *p, uint32_t width, uint32_t height);
void picture_finish(picture *p);
void picture_update_luminance(picture *p);
/* Two independent pictures in one: means weighted by the paths of each, of which `into` has `paths` and `other` has
 * `more`; not by their variances, which know what was found and would favour what is dark. */
void picture_merge(picture *into, double paths, const picture *other, double more);
/* Pixels (of rgb, transmittance, distance) that are NaN, infinite or negative, or whose transmittance exceeds 1. */
uint32_t picture_invalid(const picture *p);

/* So many times as wide, smoothed by a Gaussian whose standard deviation is one of its pixels, for colours two: to be
 * looked at, where pixels are noise. False, having said so: out of memory. */
enum { PICTURE_COLOUR_DEVIATION = 2 };
bool picture_enlarge(const picture *from, uint32_t times, picture *out);

/* 1 over about the luminance of what is brightest, 98th percentile. */
double picture_exposure(const picture *p);

/* Several pictures in one file. */
typedef struct sheet {
    uint32_t width, height;
    uint8_t *bytes; /* RGB; white */
} sheet;

/* False, having said so: out of memory. */
bool sheet_init(sheet *s, uint32_t width, uint32_t height);
void sheet_finish(sheet *s);
/* At a place within the sheet. exposure_m2_cd: what makes a luminance 1. */
void sheet_put_picture(sheet *s, uint32_t x, uint32_t y, const picture *p, double exposure_m2_cd);
/* metric_difference: red where p is brighter, blue where darker, white where equal or explained by the reference's
 * noise; full colour at `range`, in 16 steps. */
bool sheet_put_difference(sheet *s, uint32_t x, uint32_t y, const picture *p, const picture *reference, double range);
/* Relative standard error of the reference's pixels; black at `range`. */
void sheet_put_noise(sheet *s, uint32_t x, uint32_t y, const picture *reference, double range);
bool sheet_write(const sheet *s, const char *path);

#endif
