/* What the reference's pipelines and the plugin share. Bindings of set 1 besides the view's block (VELUM_BIND_VIEW),
 * its output images and its depth image, which keep their numbers. */
#ifndef VELUM_REFERENCE_H
#define VELUM_REFERENCE_H

#include "arguments.h"

#define VELUM_BIND_REFERENCE_PATHS 1  /* storage: velum_reference_path for each path of the slice */
#define VELUM_BIND_REFERENCE_PIXELS 2 /* storage: velum_reference_pixel for each pixel of the view */
#define VELUM_BIND_REFERENCE_BOUNDS 3 /* storage: velum_page_bounds for each page */
#define VELUM_BIND_REFERENCE_NOISE 4  /* storage: greatest values of the noises, VELUM_NOISE_* */
#define VELUM_BIND_REFERENCE_OUT_VARIANCE 5
#define VELUM_BIND_REFERENCE_ERROR 6 /* storage: VELUM_SLICE_* */
#define VELUM_BIND_REFERENCE_LANES                                                                                     \
    7 /* storage: velum_reference_lane for each invocation, where they are interrupted                                 \
       */

/* Greatest values of the noises, a byte each, 255: 1, where filtering can read them: between the centres of
 * neighbouring texels of the shape; over blocks of 8 such cells a side; between those of the detail. Places in bytes.
 */
#define VELUM_NOISE_SHAPE_CELLS 128
#define VELUM_NOISE_SHAPE_BLOCKS 16
#define VELUM_NOISE_DETAIL_CELLS 32
#define VELUM_NOISE_BLOCKS_AT (128 * 128 * 128)
#define VELUM_NOISE_DETAIL_AT (VELUM_NOISE_BLOCKS_AT + 16 * 16 * 16)
#define VELUM_NOISE_MOST_BYTES (VELUM_NOISE_DETAIL_AT + 32 * 32 * 32)

/* What holds for a slot anywhere in a page. */
VELUM_STRUCT(velum_page_bounds) {
    VELUM_VEC4(most);   /* effective coverage; extinction before height is counted, 1/m; growth; reach, lowest */
    VELUM_VEC4(height); /* lowest, highest base; lowest, highest top: HAE m */
    VELUM_VEC4(shape);  /* greatest power; least softness, amplitude and foot */
};

/* What one path found. */
VELUM_STRUCT(velum_reference_path) {
    VELUM_VEC4(light);   /* luminance, cd/m2; distance of cloud times its weight */
    VELUM_VEC4(through); /* transmittance; weight of cloud */
};

/* An invocation between two dispatches of one slice. */
VELUM_STRUCT(velum_reference_lane) {
    VELUM_UVEC4(state);  /* what it is at; path; key; drawn */
    VELUM_UVEC4(flags);  /* order, order that waits; media (newest, chosen); bits */
    VELUM_UVEC4(tile);   /* slots, table entry, rest of the tile (a float), 0 */
    VELUM_VEC4(r);       /* w: rest of the ray */
    VELUM_VEC4(d);       /* w: along the pixel's ray */
    VELUM_VEC4(stretch); /* rest, bound; chosen distance; weight of cloud */
    VELUM_VEC4(weight);  /* w: transmittance of cloud */
    VELUM_VEC4(light);   /* w: sum of what could be chosen */
    VELUM_VEC4(through); /* w: distance of cloud */
    VELUM_VEC4(origin);
    VELUM_VEC4(chosen);
    VELUM_VEC4(incoming);
    VELUM_VEC4(sun);
    VELUM_VEC4(waiting_r);
    VELUM_VEC4(waiting_d);
    VELUM_VEC4(waiting_weight);
};

/* Means over the paths of a pixel. */
VELUM_STRUCT(velum_reference_pixel) {
    VELUM_VEC4(light);    /* luminance, cd/m2; paths */
    VELUM_VEC4(through);  /* transmittance; sum of squared deviations of luminance Y (Welford 1962) */
    VELUM_VEC4(distance); /* distance of cloud times its weight, its weight, 0, 0 */
};

/* Which pixel has which turn, and which turn a pixel has: both ways the same, over side^2 >= pixels, so that any run of
 * turns is spread over the picture and costs what any other does. */
VELUM_FN VELUM_UINT velum_reference_pixel_of(VELUM_UINT turn, VELUM_UINT side) {
    return (turn % side) * side + turn / side;
}

/* In velum_view_block, of the reference: march_size: first turn of the slice, turns, paths for each, number of the
 * first path; steps: greatest order (0: all), side of the turns, 1: lanes go on, rounds of a lane's
 * loop at most; march: branches for each collision, asymmetry of their
 * lobe, unused, worth below which roulette begins. */

/* Words of a frame's counters: rays, samples, light samples, missing tiles; samples above their majorant. */
#define VELUM_COUNTER_WORDS 8
#define VELUM_COUNTER_ABOVE 4

/* Words of a view's slice, which may take several frames: paths begun, done, done when last the pixels took them in;
 * relative error (a float). */
#define VELUM_SLICE_BEGUN 0
#define VELUM_SLICE_DONE 1
#define VELUM_SLICE_TAKEN 2
#define VELUM_SLICE_ERROR 3
#define VELUM_SLICE_WORDS 4

/* Invocations of a work group of the tracer. */
#define VELUM_REFERENCE_GROUP 64

#endif
