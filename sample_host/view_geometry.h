/* From poses and channels to what the plugin and the host's own passes are given. */
#ifndef HOST_VIEW_GEOMETRY_H
#define HOST_VIEW_GEOMETRY_H

#include "scene.h"
#include "shaders/host_arguments.h"

#include <velum/engine.h>
#include <velum_weather/weather.h>

/* The camera of a channel. Sizes in pixels come from `width` and `height`. */
void view_geometry_frame(const struct eye_pose *pose, const velum_scenario_channel *channel, uint32_t width,
                         uint32_t height, velum_view_frame *out);

/* Angular size of the finest pixel of a view, rad. */
double view_geometry_pixel_rad(const velum_view_frame *view, uint32_t width, uint32_t height);

/* The parts that follow from where the view is: axes, ellipsoid raised by `ground_m`, patterns. */
void view_geometry_ground(const velum_view_frame *view, uint32_t width, uint32_t height, double ground_m,
                          struct host_view_arguments *out);

#endif
