/* A case is one text that C and GLSL compile: words in, words out, of one invocation. */
#ifndef VELUM_TESTS_CASE_H
#define VELUM_TESTS_CASE_H

#include "shared/dialect.h"

#ifdef VULKAN
#define CASE(name) void name(uint case_in, uint case_out)
#define IN_UINT(n) input_words[case_in + n]
#define IN_INT(n) int(input_words[case_in + n])
#define IN_FLOAT(n) uintBitsToFloat(input_words[case_in + n])
#define OUT_UINT(n, x) output_words[case_out + n] = x
#define OUT_FLOAT(n, x) output_words[case_out + n] = floatBitsToUint(x)
#else
#include <string.h>
static inline float case_float(uint32_t word) {
    float value;
    memcpy(&value, &word, sizeof value);
    return value;
}
static inline uint32_t case_word(float value) {
    uint32_t word;
    memcpy(&word, &value, sizeof word);
    return word;
}
#define CASE(name) static void name(const uint32_t *case_in, uint32_t *case_out)
#define IN_UINT(n) case_in[n]
#define IN_INT(n) ((int32_t)case_in[n])
#define IN_FLOAT(n) case_float(case_in[n])
#define OUT_UINT(n, x) case_out[n] = x
#define OUT_FLOAT(n, x) case_out[n] = case_word(x)
#endif

#endif
