/* An eye that looks east from 50 N 8.5 E under, in and over one layer, without air: how it moves, and what it sees. */
#ifndef MOTION_RIG_H
#define MOTION_RIG_H

#include "fixture.h"

enum { W = 64, H = 48, PIXELS = W * H, AT_REST = 64 };
/* Of a view whose pixels are as fine as a window's. */
enum { FINE_W = 192, FINE_H = 144, FINE_PIXELS = FINE_W * FINE_H };
/* Blocks; rays of a frame at most, while something moves. */
enum { BLOCKS = PIXELS / 16, MOST = BLOCKS + BLOCKS * 2 / 9 * 3 };
#define FRAME_S (1.0 / 60.0)
extern const float motion_steady[2]; /* no jitter */

typedef struct motion_rig {
    fixture f;
    velum_view *view;
    uint32_t width, height;
    double east[3], north[3], up[3];
    double time_s;
    float light[FINE_PIXELS * 3], through[FINE_PIXELS * 3];
    const float *depth_m; /* of the host; null: none */
    float tan_x;
} motion_rig;

/* A view of W x H pixels, or of a size of its own, FINE_PIXELS at most; the fixture is borrowed. */
void motion_rig_init(motion_rig *r, const velum_layer *layer);
void motion_rig_init_sized(motion_rig *r, const velum_layer *layer, uint32_t width, uint32_t height);
void motion_rig_finish(motion_rig *r);
void motion_draw(motion_rig *r, double height_m, double climb_rad, const float jitter[2], uint32_t flags);
/* From a cut on, until nothing more changes. */
void motion_settle(motion_rig *r, double height_m, double climb_rad);
/* So many frames of a view that stands, while time goes on. */
void motion_stand(motion_rig *r, double height_m, uint32_t frames);
/* Rays of the last frame; of so many frames of a view that stands. */
uint32_t motion_rays(const motion_rig *r);
uint32_t motion_rays_standing(motion_rig *r, double height_m, uint32_t frames);
/* Light of another picture of as many pixels, of what there is. */
double motion_light_of(const float *other, const motion_rig *r);
/* Mean difference of transmittance. */
double motion_apart(const motion_rig *r, const float *other);

#endif
