/* Of the places at which rays of cloud are lit (lit.glsl): what C and GLSL share. */
#ifndef VELUM_LIT_H
#define VELUM_LIT_H

/* Places of a ray, at most: half as many as there are steps from each to the sun and one more, but no fewer than the
 * least; bytes of one; for how many of them there is room for each block. Before them, of so many bytes each: dispatch and
 * count of the places, then those of the rays that are due, and the number of finer blocks. */
#define VELUM_LIT_PLACES 6
#define VELUM_LIT_PLACES_LEAST 4
#define VELUM_LIT_BYTES 8
#define VELUM_LIT_ROOM 6
#define VELUM_LIT_DISPATCH_BYTES 16
#define VELUM_LIT_HEAD_BYTES (3 * VELUM_LIT_DISPATCH_BYTES)
/* Where some blocks have four rays: places of any ray then; of a group of blocks that may have them, in ninths; the same
 * of 64; least contrast with the rays around. Two of nine with three rays more, of three places and a head, and three
 * places for each block have that room; so have five listed places, and the numbers of finer blocks behind them. */
#define VELUM_FINER_PLACES 3
#define VELUM_FINER_NINTHS 2
#define VELUM_FINER_BLOCKS (64.0f * 2.0f / 9.0f)
#define VELUM_FINER_CONTRAST 0.5f
/* Of a pipeline: whether rays of calm tiles take turns (view.glsl), or that it asks the view. */
#define VELUM_TURNS_NONE 0u
#define VELUM_TURNS_SOME 1u
#define VELUM_TURNS_ASKED 2u
/* Columns of dispatches over lists; rows as many as it takes. */
#define VELUM_LIT_COLUMNS 16

#endif
