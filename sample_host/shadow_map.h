/* shadow: the cloud shadow map as an EXR. */
#ifndef HOST_SHADOW_MAP_H
#define HOST_SHADOW_MAP_H

#include "options.h"

#include <stdbool.h>

bool shadow_map(const struct options *options);

#endif
