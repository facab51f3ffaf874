/* The volume of light around a view's eye that VELUM_SCATTERING_VOLUME asks for: shaders/light_volume.glsl. */
#ifndef PLUGIN_LIGHT_VOLUME_H
#define PLUGIN_LIGHT_VOLUME_H

#include "engine.h"

/* Whether a plan asks for one. */
bool light_volume_wanted(const velum_plan *plan);
/* Memory for the grid of a plan that wants one. */
bool light_volume_grow(view *v, const velum_plan *plan);
void light_volume_finish(gpu *g, view *v);
/* Makes it anew where the eye, the sun or the weather is no longer what it was made for. The view's sets are bound;
 * `fill`: PASS_VOLUME_FILL or its variant. */
void light_volume_record(view *v, VkCommandBuffer commands, const velum_plan *plan, pass fill);

#endif
