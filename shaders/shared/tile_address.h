/* The planet's tiles: six cube faces (tangent-warped, on geodetic normals) of quadtrees. */
#ifndef VELUM_TILE_ADDRESS_H
#define VELUM_TILE_ADDRESS_H

#include "dialect.h"

#define VELUM_TILE_TEXELS 32      /* a side, without the apron */
#define VELUM_TILE_APRON 1
#define VELUM_TILE_SIDE 34        /* stored texels a side */
#define VELUM_TILE_LEVEL_MAX 12   /* texel of 76 m */
/* Smooth weather is never held coarser than this, where a finer key is asked for. */
#define VELUM_TILE_DATA_LEVEL_MIN 3
#define VELUM_TILE_FACE_M 1.0e7f  /* length of a face's side, nominal */
#define VELUM_TILE_KEY_NONE 0xffffffffu
/* Pages of a layer of their image, side by side: one page a layer is padded to twice its size on GPUs. */
#define VELUM_PAGE_COLUMNS 4u
#define VELUM_PAGE_ROWS 32u
#define VELUM_PAGES_A_LAYER (VELUM_PAGE_COLUMNS * VELUM_PAGE_ROWS)

/* Parts of a page's side. Of each part of a page is known between which heights there is anything (core/tile_spans.h): a
 * word each, row by row; then as many again of what falls, in pages of fringes. Low 16 bits: lowest height, as texels
 * store it; high ones: highest. */
#define VELUM_PARTS 4
#define VELUM_SPAN_WORDS (2 * VELUM_PARTS * VELUM_PARTS)
#define VELUM_SPAN_NONE 0x0000ffffu

/* Face n, its axes u and v. Faces 0..5: +X -X +Y -Y +Z -Z. */
VELUM_STRUCT(velum_face_place) {
    int face;
    float u, v; /* -1..1, warped */
};

/* atan(x) / x for |x| <= 1, within 2e-8 (Abramowitz & Stegun 1964, 4.4.49). */
VELUM_FN float velum_atan_ratio(float x2) {
    return 1.0f +
           x2 * (-0.3333314528f +
                 x2 * (0.1999355085f +
                       x2 * (-0.1420889944f +
                             x2 * (0.1065626393f +
                                   x2 * (-0.0752896400f +
                                         x2 * (0.0429096138f + x2 * (-0.0161657367f + x2 * 0.0028662257f)))))));
}

VELUM_FN velum_face_place velum_face_of(float nx, float ny, float nz) {
    velum_face_place place;
    float ax = VELUM_ABS(nx);
    float ay = VELUM_ABS(ny);
    float az = VELUM_ABS(nz);
    float major;
    float a;
    float b;
    if (ax >= ay && ax >= az) {
        place.face = nx >= 0.0f ? 0 : 1;
        major = ax;
        a = nx >= 0.0f ? ny : -ny;
        b = nz;
    } else if (ay >= az) {
        place.face = ny >= 0.0f ? 2 : 3;
        major = ay;
        a = ny >= 0.0f ? -nx : nx;
        b = nz;
    } else {
        place.face = nz >= 0.0f ? 4 : 5;
        major = az;
        a = ny;
        b = nz >= 0.0f ? -nx : nx;
    }
    float ta = a / major;
    float tb = b / major;
    place.u = 1.2732395447351628f * ta * velum_atan_ratio(ta * ta);
    place.v = 1.2732395447351628f * tb * velum_atan_ratio(tb * tb);
    return place;
}

/* level 0..12, face 0..5, x and y 0..2^level - 1 in one word. */
VELUM_FN VELUM_UINT velum_tile_key(VELUM_UINT level, VELUM_UINT face, VELUM_UINT x, VELUM_UINT y) {
    return (level << 27u) | (face << 24u) | (y << 12u) | x;
}
VELUM_FN VELUM_UINT velum_tile_key_level(VELUM_UINT key) {
    return key >> 27u;
}
VELUM_FN VELUM_UINT velum_tile_key_face(VELUM_UINT key) {
    return (key >> 24u) & 7u;
}
VELUM_FN VELUM_UINT velum_tile_key_y(VELUM_UINT key) {
    return (key >> 12u) & 4095u;
}
VELUM_FN VELUM_UINT velum_tile_key_x(VELUM_UINT key) {
    return key & 4095u;
}

/* Coordinate in the face, 0..2^level, of u or v. */
VELUM_FN float velum_tile_coordinate(float u, VELUM_UINT level) {
    return velum_clamp(0.5f * (u + 1.0f), 0.0f, 0.99999994f) * VELUM_TO_FLOAT(1u << level);
}

/* The level whose tiles have sides between 1/8 and 1/4 of the distance (texels 1/256 to 1/128 of it), scaled by detail
 * (1: as said; larger: finer). A function of the place alone: never of what is resident. */
VELUM_FN VELUM_UINT velum_tile_level(float distance_m, float detail) {
    float ratio = 4.0f * detail * VELUM_TILE_FACE_M / VELUM_MAX(distance_m, 1.0f);
    float level = VELUM_FLOOR(VELUM_LOG2(VELUM_MAX(ratio, 1.0f))) + 1.0f;
    return VELUM_TO_UINT(velum_clamp(level, 0.0f, VELUM_TO_FLOAT(VELUM_TILE_LEVEL_MAX)));
}

/* The page table: open addressing, linear probing, power of two of entries, as words of an array.
 * Word 0 key, 1 level of the data tile that stands for it (an ancestor, where the weather is smooth), 2 mask of slots
 * with cloud, from bit 8 on of those with a fringe, 3 where the pages of fringes stand, in words from the table's
 * beginning (0: there are none), 4 + slot: page of state A in the low 16 bits, of state B in the high ones. Pages of
 * fringes stand behind all entries, a word for each slot. */
#define VELUM_TABLE_WORDS 12
#define VELUM_TABLE_PAGES 4
#define VELUM_PAGE_NONE 0xffffu

VELUM_FN VELUM_UINT velum_table_hash(VELUM_UINT key, VELUM_UINT mask) {
    VELUM_UINT h = key * 2654435761u;
    return (h ^ (h >> 15u)) & mask;
}

#endif
