/* play in windows: one for each channel, on its own monitor where there are several. */
#ifndef HOST_WINDOWS_H
#define HOST_WINDOWS_H

#include "options.h"

#include <stdbool.h>

/* A display is named by the environment. */
bool windows_display_exists(void);

bool windows_play(const struct options *options);

#endif
