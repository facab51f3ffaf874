/* One text, two languages: headers of this folder compile as C and as GLSL. Scalars only, structs by value. */
#ifndef VELUM_DIALECT_H
#define VELUM_DIALECT_H

#ifdef VULKAN
#define VELUM_FN
#define VELUM_STRUCT(name) struct name
#define VELUM_UINT uint
#define VELUM_ABS(x) abs(x)
#define VELUM_ACOS(x) acos(x)
#define VELUM_COS(x) cos(x)
#define VELUM_EXP(x) exp(x)
#define VELUM_EXP2(x) exp2(x)
#define VELUM_FLOOR(x) floor(x)
#define VELUM_LOG(x) log(x)
#define VELUM_LOG2(x) log2(x)
#define VELUM_MAX(x, y) max(x, y)
#define VELUM_MIN(x, y) min(x, y)
#define VELUM_POW(x, y) pow(x, y)
#define VELUM_SIN(x) sin(x)
#define VELUM_SQRT(x) sqrt(x)
#define VELUM_TO_UINT(x) uint(x)
#define VELUM_TO_INT(x) int(x)
#define VELUM_TO_FLOAT(x) float(x)
#else
#include <math.h>
#include <stdint.h>
#define VELUM_FN static inline
#define VELUM_STRUCT(name)                                                                                            \
    typedef struct name name;                                                                                         \
    struct name
#define VELUM_UINT uint32_t
#define VELUM_ABS(x) fabsf(x)
#define VELUM_ACOS(x) acosf(x)
#define VELUM_COS(x) cosf(x)
#define VELUM_EXP(x) expf(x)
#define VELUM_EXP2(x) exp2f(x)
#define VELUM_FLOOR(x) floorf(x)
#define VELUM_LOG(x) logf(x)
#define VELUM_LOG2(x) log2f(x)
#define VELUM_MAX(x, y) ((x) > (y) ? (x) : (y))
#define VELUM_MIN(x, y) ((x) < (y) ? (x) : (y))
#define VELUM_POW(x, y) powf(x, y)
#define VELUM_SIN(x) sinf(x)
#define VELUM_SQRT(x) sqrtf(x)
#define VELUM_TO_UINT(x) ((uint32_t)(x))
#define VELUM_TO_INT(x) ((int32_t)(x))
#define VELUM_TO_FLOAT(x) ((float)(x))
#endif

VELUM_FN float velum_clamp(float x, float low, float high) {
    return VELUM_MIN(VELUM_MAX(x, low), high);
}

VELUM_FN float velum_mix(float a, float b, float t) {
    return a + (b - a) * t;
}

VELUM_FN float velum_smoothstep(float low, float high, float x) {
    float t = velum_clamp((x - low) / (high - low), 0.0f, 1.0f);
    return t * t * (3.0f - 2.0f * t);
}

VELUM_FN float velum_fract(float x) {
    return x - VELUM_FLOOR(x);
}

#endif
