/* Commands that need no device: check, probe, tiles. */
#ifndef HOST_INSPECT_H
#define HOST_INSPECT_H

#include "options.h"
#include "scene.h"

#include <stdbool.h>

bool inspect_check(const struct options *options);
bool inspect_probe(const struct options *options);
bool inspect_tiles(const struct options *options);

#endif
