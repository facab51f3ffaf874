#include "case.h"
#include "shared/tile_address.h"

#define CASE_TILE_IN 6
#define CASE_TILE_OUT 6
CASE(case_tile) {
    velum_face_place place = velum_face_of(IN_FLOAT(0), IN_FLOAT(1), IN_FLOAT(2));
    OUT_UINT(0, VELUM_TO_UINT(place.face));
    OUT_UINT(1, velum_tile_level(IN_FLOAT(3), IN_FLOAT(4)));
    OUT_FLOAT(2, place.u);
    OUT_FLOAT(3, place.v);
    OUT_FLOAT(4, velum_tile_coordinate(place.u, IN_UINT(5)) / VELUM_TO_FLOAT(1u << IN_UINT(5)));
    OUT_FLOAT(5, velum_tile_coordinate(place.v, IN_UINT(5)) / VELUM_TO_FLOAT(1u << IN_UINT(5)));
}
