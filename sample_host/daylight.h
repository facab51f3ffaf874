/* Rough daylight for the host's own ground and for the exposure: what stands over the ground, not a sky model. */
#ifndef HOST_DAYLIGHT_H
#define HOST_DAYLIGHT_H

#include <stdbool.h>

/* Cloud over a place: its share of the sky, and the mean optical depth of a vertical line through all of it. */
struct cloud_cover {
    double coverage;
    double optical_depth;
};

struct daylight {
    float sun_lx[3]; /* through clear air, facing the sun */
    float sky_lx[3]; /* of sky and cloud on level ground */
};

/* sine: of the sun's elevation. illuminance: at the top of the atmosphere. */
void daylight_compute(double sun_sine, const float illuminance_lx[3], bool atmosphere, const struct cloud_cover *cover,
                      struct daylight *out);

/* 1 / luminance (cd/m2) such that the product is right for tone_map(). `cover`: over the eye. */
double daylight_exposure(double sun_sine, const float illuminance_lx[3], bool atmosphere,
                         const struct cloud_cover *cover);

#endif
