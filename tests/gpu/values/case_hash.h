#include "case.h"
#include "shared/hash.h"
#include "shared/tile_address.h"

#define CASE_HASH_IN 4
#define CASE_HASH_OUT 11
CASE(case_hash) {
    VELUM_UINT x = IN_UINT(0);
    VELUM_UINT y = IN_UINT(1);
    VELUM_UINT z = IN_UINT(2);
    VELUM_UINT w = IN_UINT(3);
    VELUM_UINT key = velum_tile_key(x % 13u, y % 6u, z & 4095u, w & 4095u);
    OUT_UINT(0, velum_hash(x));
    OUT_UINT(1, velum_hash_2(x, y));
    OUT_UINT(2, velum_hash_3(x, y, z));
    OUT_UINT(3, velum_hash_4(x, y, z, w));
    OUT_FLOAT(4, velum_hash_unit(x));
    OUT_UINT(5, key);
    OUT_UINT(6, velum_tile_key_level(key));
    OUT_UINT(7, velum_tile_key_face(key));
    OUT_UINT(8, velum_tile_key_x(key));
    OUT_UINT(9, velum_tile_key_y(key));
    OUT_UINT(10, velum_table_hash(x, (1u << (y & 15u)) - 1u));
}
