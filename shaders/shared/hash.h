/* Integer hashes, the same bit for bit in C and GLSL. */
#ifndef VELUM_HASH_H
#define VELUM_HASH_H

#include "dialect.h"

/* PCG-RXS-M-XS of 32 bits (O'Neill 2014), as a hash (Jarzynski & Olano 2020). */
VELUM_FN VELUM_UINT velum_hash(VELUM_UINT x) {
    VELUM_UINT state = x * 747796405u + 2891336453u;
    VELUM_UINT word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}
VELUM_FN VELUM_UINT velum_hash_2(VELUM_UINT x, VELUM_UINT y) {
    return velum_hash(x + velum_hash(y));
}
VELUM_FN VELUM_UINT velum_hash_3(VELUM_UINT x, VELUM_UINT y, VELUM_UINT z) {
    return velum_hash(x + velum_hash(y + velum_hash(z)));
}
VELUM_FN VELUM_UINT velum_hash_4(VELUM_UINT x, VELUM_UINT y, VELUM_UINT z, VELUM_UINT w) {
    return velum_hash(x + velum_hash(y + velum_hash(z + velum_hash(w))));
}
/* 0 <= value < 1, multiples of 2^-24: exact in a float. */
VELUM_FN float velum_hash_unit(VELUM_UINT hash) {
    return VELUM_TO_FLOAT(hash >> 8u) * 5.9604644775390625e-8f;
}

#endif
