/* The grid of a volume of light: see light_volume.glsl. */
#ifndef VELUM_LIGHT_VOLUME_H
#define VELUM_LIGHT_VOLUME_H

#include "arguments.h"

#define VELUM_LIGHT_VOLUME_SIDE_M 12800.0f /* as long as its cells are not too many */
#define VELUM_LIGHT_VOLUME_CELLS_LEAST 16
#define VELUM_LIGHT_VOLUME_CELLS_MOST 128 /* on a side */
#define VELUM_LIGHT_VOLUME_ROWS_MOST 32
#define VELUM_LIGHT_VOLUME_FLATNESS 0.2f /* height of a cell over its side, at least */
/* Vectors of a cell. */
#define VELUM_LIGHT_VOLUME_EVEN 0 /* two, written in turn, after even and odd passes: mean luminance from */
#define VELUM_LIGHT_VOLUME_ODD 1  /* all round of light that has been scattered; w: extinction of the transport, 1/m */
#define VELUM_LIGHT_VOLUME_SUN 2  /* mean luminance of the sun's light still on its way; w: low corner of its cloud's box */
#define VELUM_LIGHT_VOLUME_FLUX 3 /* net flux of the former over 4 pi: east, north, up; w: high corner */
#define VELUM_LIGHT_VOLUME_VECTORS 4
/* How often light goes on from cell to cell. In the last passes the mean of what each has found is kept; in those before,
 * more than each has found, as what is missing is much the same from pass to pass (over-relaxation: Young 1954). */
#define VELUM_LIGHT_VOLUME_PASSES 64
#define VELUM_LIGHT_VOLUME_SETTLED 56
#define VELUM_LIGHT_VOLUME_STRIDE 1.6f

/* In front of the cells, as many vectors as here. */
#define VELUM_LIGHT_VOLUME_HEAD 4
VELUM_STRUCT(velum_light_volume_block) {
    VELUM_VEC4(east);  /* level, ECEF, unit: east and north, but near a pole any two; side of a cell m */
    VELUM_VEC4(north); /* height of a cell m */
    VELUM_VEC4(span);  /* lowest, highest HAE m; share of this pass in what is kept; 0 */
    VELUM_UVEC4(grid); /* cells a side; rows; pass; slots that it holds */
};

#endif
