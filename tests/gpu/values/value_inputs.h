/* Inputs of the cases: the first are edges, the others drawn by the shared hash. */
#ifndef VELUM_TESTS_VALUE_INPUTS_H
#define VELUM_TESTS_VALUE_INPUTS_H

#include <stdint.h>

/* i: number of the invocation; in: its words. */
void fill_hash(uint32_t i, uint32_t *in);
void fill_tile(uint32_t i, uint32_t *in);
void fill_planet(uint32_t i, uint32_t *in);
void fill_phase(uint32_t i, uint32_t *in);
void fill_air(uint32_t i, uint32_t *in);
void fill_sample(uint32_t i, uint32_t *in);
void fill_density(uint32_t i, uint32_t *in);
void fill_cloud(uint32_t i, uint32_t *in);

float word_float(uint32_t word);
uint32_t float_word(float value);

#endif
