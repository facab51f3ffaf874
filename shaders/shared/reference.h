/* What the reference's pipelines and the plugin share. Bindings of set 1 besides the view's block (VELUM_BIND_VIEW),
 * its output images and its depth image, which keep their numbers. */
#ifndef VELUM_REFERENCE_H
#define VELUM_REFERENCE_H

#include "arguments.h"

#define VELUM_BIND_REFERENCE_PATHS 1  /* storage: velum_reference_path for each path of the slice */
#define VELUM_BIND_REFERENCE_PIXELS 2 /* storage: velum_reference_pixel for each pixel of the view */
#define VELUM_BIND_REFERENCE_BOUNDS 3 /* storage: velum_page_bounds for each page */
#define VELUM_BIND_REFERENCE_NOISE 4  /* storage: how steep the shape noise is, VELUM_SLOPE_* */
#define VELUM_BIND_REFERENCE_OUT_VARIANCE 5
#define VELUM_BIND_REFERENCE_ERROR 6 /* storage: VELUM_SLICE_* */
#define VELUM_BIND_REFERENCE_LANES 7 /* storage: velum_reference_lane for each invocation, between dispatches */

/* How steep the shape noise is about the cells between the centres of its texels, a byte each: change of filtered rank
 * over a period, within a radius. */
#define VELUM_SLOPE_SIDE 128
#define VELUM_SLOPE_BYTES (128 * 128 * 128)
#define VELUM_SLOPE_CELLS 2
#define VELUM_SLOPE_RADIUS 0.0156f /* 2 cells of the period, less what rounding takes */
#define VELUM_SLOPE_UNIT 0.5f
/* What filtering with few digits may add to a rank. */
#define VELUM_SLOPE_SLACK 0.006f

/* How far away the shape noise reaches a rank: a byte for each cell, two texels wide, at each of some ranks. They
 * follow the slopes in the same buffer. */
#define VELUM_AWAY_SIDE 64
#define VELUM_AWAY_LEVELS 16
#define VELUM_AWAY_BYTES (VELUM_AWAY_LEVELS * 64 * 64 * 64)
#define VELUM_AWAY_UNIT 0.25f
VELUM_FN float velum_away_rank(int level) {
    float low = 1.0f - VELUM_TO_FLOAT(level) * (1.0f / 16.0f);
    return 1.0f - low * low;
}
/* The highest level whose rank is not above this one. */
VELUM_FN int velum_away_level(float rank) {
    int level = VELUM_TO_INT(16.0f * (1.0f - VELUM_SQRT(velum_clamp(1.0f - rank, 0.0f, 1.0f))));
    return level < VELUM_AWAY_LEVELS - 1 ? level : VELUM_AWAY_LEVELS - 1;
}

/* What holds for a slot anywhere in a page. Of a page of fringes: most: hem, fall, 1/m; height: lowest and highest of
 * either, lowest above highest where there is none. */
VELUM_STRUCT(velum_page_bounds) {
    VELUM_VEC4(most);   /* effective coverage; extinction, 1/m; reach, lowest; power, highest */
    VELUM_VEC4(height); /* lowest, highest base; lowest, highest top: HAE m */
    VELUM_VEC4(shape);  /* change over a metre at most: of wind, 1/s; of effective coverage, or of coverage or a storm's
                           kind if that is more; of base and top together, m; of how columns lean, m of noise */
    VELUM_UVEC4(
        even); /* a bit for each part whose texels, with those next to them, are all like one; that texel; 0, 0 */
    VELUM_UVEC4(parts); /* a byte for each of VELUM_PARTS^2 parts of the page, a word for each row: effective coverage
                           at most, in it and those around it, over that of the page; 255: 1 */
};

/* What else changes with coverage, where effective coverage does: so many times as fast, both. */
#define VELUM_FADE_OTHERS 2.0f
/* Effective coverage of a storm, or of cumulus, over a change of its height by all of its thickness. */
#define VELUM_FADE_BEND 1.7f
/* Of a storm's margin, over a change of coverage or of kind with what else does (VELUM_FADE_OTHERS): its stem and what
 * ice takes from what is carved off change by less than 4.3 with the one, as an overcast opens, and 1.9 with the other.
 */
#define VELUM_STORM_EDGE ((4.3f + 1.9f) / VELUM_FADE_OTHERS)

/* Places on a pixel's ray from which one path goes on, with all orders of scattering from each. 4 at most: a byte each
 * of a word tells what is there. */
#define VELUM_REFERENCE_CHAINS 4

/* What one path found. */
VELUM_STRUCT(velum_reference_path) {
    VELUM_VEC4(light);   /* luminance, cd/m2; distance of cloud times its weight */
    VELUM_VEC4(through); /* transmittance; weight of cloud */
};

/* A flight that waits. */
#define VELUM_REFERENCE_FLIGHTS 4
VELUM_STRUCT(velum_reference_flight) {
    VELUM_VEC4(r);      /* w: order */
    VELUM_VEC4(d);      /* w: 1: from the ground */
    VELUM_VEC4(weight); /* w: 0 */
};

/* An invocation between two dispatches of one slice. */
VELUM_STRUCT(velum_reference_lane) {
    VELUM_UVEC4(state);  /* what it is at; path; key; drawn */
    VELUM_UVEC4(flags);  /* order, flights that wait; media (newest, chosen); bits */
    VELUM_VEC4(r);       /* w: rest of the ray */
    VELUM_VEC4(d);       /* w: along the pixel's ray */
    VELUM_VEC4(clear_0); /* of slots 0 to 3 */
    VELUM_VEC4(clear_4); /* of slots 4 to 7 */
    VELUM_VEC4(tracked); /* w: to where air is looked at */
    VELUM_VEC4(light);   /* w: sum of what could be chosen */
    VELUM_VEC4(through); /* w: transmittance of cloud */
    VELUM_VEC4(origin);  /* w: distance of cloud */
    VELUM_UVEC4(media);  /* chosen, a byte each; weight of cloud (a float); clear of scud, of what falls
                              (floats) */
    VELUM_VEC4(next_d);  /* w: below which roulette begins */
    VELUM_VEC4(next);    /* weight; bound of air */
    VELUM_VEC4(own_0);   /* bounds in the tile: of slots 0 to 3 */
    VELUM_VEC4(own_4);   /* of slots 4 to 7 */
    VELUM_VEC4(held);    /* how far they hold; those of scud, of what falls; 0 */
    velum_reference_flight flights[VELUM_REFERENCE_FLIGHTS];
#ifdef VULKAN
    vec4 chosen[VELUM_REFERENCE_CHAINS]; /* weight, distance */
#else
    float chosen[VELUM_REFERENCE_CHAINS][4];
#endif
};

/* Means over the paths of a pixel. */
VELUM_STRUCT(velum_reference_pixel) {
    VELUM_VEC4(light);    /* luminance, cd/m2; paths */
    VELUM_VEC4(through);  /* transmittance; sum of squared deviations of luminance Y (Welford 1962) */
    VELUM_VEC4(distance); /* distance of cloud times its weight, its weight, 0, 0 */
};

/* Pixels take turns in blocks, so that lanes that work side by side see much the same; blocks follow one another far
 * apart, so that any run of turns is spread over the picture. `side`: of a square of blocks that holds all. */
#define VELUM_REFERENCE_BLOCK_W 8u
#define VELUM_REFERENCE_BLOCK_H 4u
#define VELUM_REFERENCE_BLOCK 32u
VELUM_FN VELUM_UINT velum_reference_blocks(VELUM_UINT width, VELUM_UINT height) {
    return ((width + VELUM_REFERENCE_BLOCK_W - 1u) / VELUM_REFERENCE_BLOCK_W) *
           ((height + VELUM_REFERENCE_BLOCK_H - 1u) / VELUM_REFERENCE_BLOCK_H);
}
/* Its own inverse. */
VELUM_FN VELUM_UINT velum_reference_block_turn(VELUM_UINT block, VELUM_UINT side) {
    return (block % side) * side + block / side;
}
/* x, y in one number, y * 65536 + x: outside the picture where no pixel has the turn. */
VELUM_FN VELUM_UINT velum_reference_pixel_of(VELUM_UINT turn, VELUM_UINT side, VELUM_UINT width) {
    VELUM_UINT block = velum_reference_block_turn(turn / VELUM_REFERENCE_BLOCK, side);
    VELUM_UINT within = turn % VELUM_REFERENCE_BLOCK;
    VELUM_UINT columns = (width + VELUM_REFERENCE_BLOCK_W - 1u) / VELUM_REFERENCE_BLOCK_W;
    VELUM_UINT x = block % columns * VELUM_REFERENCE_BLOCK_W + within % VELUM_REFERENCE_BLOCK_W;
    VELUM_UINT y = block / columns * VELUM_REFERENCE_BLOCK_H + within / VELUM_REFERENCE_BLOCK_W;
    return y * 65536u + x;
}
VELUM_FN VELUM_UINT velum_reference_turn_of(VELUM_UINT x, VELUM_UINT y, VELUM_UINT side, VELUM_UINT width) {
    VELUM_UINT columns = (width + VELUM_REFERENCE_BLOCK_W - 1u) / VELUM_REFERENCE_BLOCK_W;
    VELUM_UINT block = y / VELUM_REFERENCE_BLOCK_H * columns + x / VELUM_REFERENCE_BLOCK_W;
    return velum_reference_block_turn(block, side) * VELUM_REFERENCE_BLOCK +
           y % VELUM_REFERENCE_BLOCK_H * VELUM_REFERENCE_BLOCK_W + x % VELUM_REFERENCE_BLOCK_W;
}

/* In velum_view_block, of the reference: march_size: first turn of the slice, turns, paths for each, number of the
 * first path; steps: greatest order (0: all), side of the turns, 1: lanes go on, rounds of a lane's loop at most;
 * march: branches for each collision, slot of the narrowest forward peak, slope of the detail noise, worth below which
 * roulette begins. */

/* Words of a frame's counters: rays, samples, light samples, missing tiles; samples above their majorant; paths whose
 * light is no number. */
#define VELUM_COUNTER_WORDS 8
#define VELUM_COUNTER_ABOVE 4
#define VELUM_COUNTER_BAD 5

/* Words of a view's slice, which may take several frames: paths begun, done, done when last the pixels took them in;
 * relative error (a float); 0. */
#define VELUM_SLICE_BEGUN 0
#define VELUM_SLICE_DONE 1
#define VELUM_SLICE_TAKEN 2
#define VELUM_SLICE_ERROR 3
#define VELUM_SLICE_NOTHING 4
#define VELUM_SLICE_WORDS 5

/* Invocations of a work group of the tracer. */
#define VELUM_REFERENCE_GROUP 64

#endif
