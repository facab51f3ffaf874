#include "picture.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "metric.h"
#include "sample_host/png.h"
#include "sample_host/shaders/tone_map.h"

bool picture_init(picture *p, uint32_t width, uint32_t height) {
    size_t count = (size_t)width * height;
    *p = (picture){.width = width, .height = height, .count = (uint32_t)count};
    p->rgb = calloc(count * 3, sizeof(float));
    p->transmittance = calloc(count * 3, sizeof(float));
    p->distance = calloc(count, sizeof(float));
    p->luminance = calloc(count, sizeof(float));
    p->variance = calloc(count, sizeof(float));
    if (!p->rgb || !p->transmittance || !p->distance || !p->luminance || !p->variance) {
        fprintf(stderr, "velum-accuracy: out of memory\n");
        picture_finish(p);
        return false;
    }
    return true;
}

void picture_finish(picture *p) {
    free(p->rgb);
    free(p->transmittance);
    free(p->distance);
    free(p->luminance);
    free(p->variance);
    *p = (picture){0};
}

void picture_update_luminance(picture *p) {
    for (uint32_t i = 0; i < p->count; i++) {
        p->luminance[i] = (float)metric_luminance(&p->rgb[3 * i]);
    }
}

static void mix(float *into, const float *other, size_t count, double share) {
    for (size_t i = 0; i < count; i++) {
        into[i] = (float)((1.0 - share) * (double)into[i] + share * (double)other[i]);
    }
}

void picture_merge(picture *into, double paths, const picture *other, double more) {
    double share = more / (paths + more);
    mix(into->rgb, other->rgb, 3 * (size_t)into->count, share);
    mix(into->transmittance, other->transmittance, 3 * (size_t)into->count, share);
    mix(into->distance, other->distance, into->count, share);
    for (uint32_t i = 0; i < into->count; i++) {
        into->variance[i] = (float)((1.0 - share) * (1.0 - share) * (double)into->variance[i] +
                                    share * share * (double)other->variance[i]);
    }
    picture_update_luminance(into);
}

uint32_t picture_invalid(const picture *p) {
    uint32_t invalid = 0;
    for (uint32_t i = 0; i < p->count; i++) {
        bool ok = isfinite(p->distance[i]) && p->distance[i] >= 0.0f;
        for (uint32_t c = 3 * i; c < 3 * i + 3; c++) {
            ok = ok && isfinite(p->rgb[c]) && p->rgb[c] >= 0.0f;
            ok = ok && p->transmittance[c] >= 0.0f && p->transmittance[c] <= 1.0f;
        }
        invalid += ok ? 0 : 1;
    }
    return invalid;
}

/* Mean about a place, by a Gaussian; what is not a number is none. */
static void smooth(const picture *from, double x, double y, double deviation, float out[3]) {
    const int reach = (int)ceil(3.0 * deviation);
    double sum[3] = {0.0, 0.0, 0.0}, weights = 0.0;
    for (int row = (int)lround(y) - reach; row <= (int)lround(y) + reach; row++) {
        for (int column = (int)lround(x) - reach; column <= (int)lround(x) + reach; column++) {
            if (row < 0 || column < 0 || row >= (int)from->height || column >= (int)from->width) {
                continue;
            }
            const double away_2 = (x - column) * (x - column) + (y - row) * (y - row);
            const double weight = exp(-0.5 * away_2 / (deviation * deviation));
            const float *rgb = &from->rgb[3 * ((uint32_t)row * from->width + (uint32_t)column)];
            for (int c = 0; c < 3; c++) {
                sum[c] += isfinite(rgb[c]) ? weight * (double)rgb[c] : 0.0;
            }
            weights += weight;
        }
    }
    for (int c = 0; c < 3; c++) {
        out[c] = (float)(sum[c] / weights);
    }
}

bool picture_enlarge(const picture *from, uint32_t times, picture *out) {
    if (!picture_init(out, from->width * times, from->height * times)) {
        return false;
    }
    for (uint32_t i = 0; i < out->count; i++) {
        const double x = ((double)(i % out->width) + 0.5) / times - 0.5,
                     y = ((double)(i / out->width) + 0.5) / times - 0.5;
        float light[3], colour[3];
        smooth(from, x, y, 1.0, light);
        smooth(from, x, y, PICTURE_COLOUR_DEVIATION, colour);
        const double of = metric_luminance(colour);
        for (uint32_t c = 0; c < 3; c++) {
            out->rgb[3 * i + c] = of > 0.0 ? (float)((double)colour[c] * metric_luminance(light) / of) : 0.0f;
        }
    }
    picture_update_luminance(out);
    return true;
}

static int ascending(const void *a, const void *b) {
    float x = *(const float *)a;
    float y = *(const float *)b;
    return (x > y) - (x < y);
}

double picture_exposure(const picture *p) {
    float *sorted = malloc((p->count + 1u) * sizeof *sorted);
    double at = 0.0;
    if (sorted && p->count > 0) {
        memcpy(sorted, p->luminance, p->count * sizeof *sorted);
        qsort(sorted, p->count, sizeof *sorted, ascending);
        at = (double)sorted[(uint32_t)(0.98 * (p->count - 1))];
    }
    free(sorted);
    return at > 0.0 && isfinite(at) ? 1.0 / at : 1.0;
}

static uint8_t byte_of(double value) {
    return (uint8_t)lround(255.0 * fmin(fmax(value, 0.0), 1.0));
}

bool sheet_init(sheet *s, uint32_t width, uint32_t height) {
    *s = (sheet){.width = width, .height = height, .bytes = malloc((size_t)width * height * 3)};
    if (!s->bytes) {
        fprintf(stderr, "velum-accuracy: out of memory\n");
        return false;
    }
    memset(s->bytes, 255, (size_t)width * height * 3);
    return true;
}

void sheet_finish(sheet *s) {
    free(s->bytes);
    *s = (sheet){0};
}

static uint8_t *sheet_at(sheet *s, uint32_t x, uint32_t y, const picture *p, uint32_t i) {
    return &s->bytes[3 * ((size_t)(y + i / p->width) * s->width + x + i % p->width)];
}

void sheet_put_picture(sheet *s, uint32_t x, uint32_t y, const picture *p, double exposure_m2_cd) {
    for (uint32_t i = 0; i < p->count; i++) {
        uint8_t *at = sheet_at(s, x, y, p, i);
        float rgb[3];
        for (int c = 0; c < 3; c++) {
            float value = p->rgb[3 * i + (uint32_t)c];
            rgb[c] = isfinite(value) ? value * (float)exposure_m2_cd : 0.0f;
        }
        for (int c = 0; c < 3; c++) {
            at[c] = byte_of((double)tone_map(rgb[0], rgb[1], rgb[2], c));
        }
    }
}

bool sheet_put_difference(sheet *s, uint32_t x, uint32_t y, const picture *p, const picture *reference, double range) {
    float *difference = malloc((p->count + 1u) * sizeof *difference);
    if (!difference) {
        return false;
    }
    metric_difference(p->luminance, reference->luminance, reference->variance, p->width, p->height, difference);
    for (uint32_t i = 0; i < p->count; i++) {
        uint8_t *at = sheet_at(s, x, y, p, i);
        double e = round(16.0 * fmin(fmax((double)difference[i] / range, -1.0), 1.0)) / 16.0;
        double fade = 1.0 - fabs(e);
        at[0] = byte_of(e > 0.0 ? 1.0 : fade);
        at[1] = byte_of(fade);
        at[2] = byte_of(e < 0.0 ? 1.0 : fade);
    }
    free(difference);
    return true;
}

void sheet_put_noise(sheet *s, uint32_t x, uint32_t y, const picture *reference, double range) {
    double mean = 0.0;
    for (uint32_t i = 0; i < reference->count; i++) {
        mean += (double)reference->luminance[i] / reference->count;
    }
    for (uint32_t i = 0; i < reference->count; i++) {
        uint8_t *at = sheet_at(s, x, y, reference, i);
        double d = fmax(fmax((double)reference->luminance[i], 0.01 * mean), 1e-30);
        double noise = sqrt(fmax((double)reference->variance[i], 0.0)) / d;
        at[0] = at[1] = at[2] = byte_of(1.0 - round(16.0 * fmin(noise / range, 1.0)) / 16.0);
    }
}

bool sheet_write(const sheet *s, const char *path) {
    return png_write(path, s->width, s->height, 3, s->bytes);
}
