/* A device that a host lends: that of a standalone engine, with command buffers and images of the test's own. */
#ifndef GPU_LENT_H
#define GPU_LENT_H

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <velum/vulkan.h>

#include "fixture.h"

typedef struct lent lent;

/* Of f->engine's device; frames_in_flight command buffers. */
lent *lent_create(fixture *f, uint32_t frames_in_flight, uint32_t width, uint32_t height);
void lent_destroy(lent *l);
/* What create_engine wants. */
velum_vulkan_lend lent_desc(const lent *l);
/* Waits until the command buffer of that turn is free, and begins it. */
VkCommandBuffer lent_begin(lent *l, uint32_t turn);
void lent_submit(lent *l, uint32_t turn);
void lent_wait(lent *l);
/* Images of view `index` (0, 1): arrays of two layers, in GENERAL. */
velum_vulkan_images lent_images(lent *l, VkCommandBuffer commands, uint32_t index);
/* Between two frames that draw into the same images. */
void lent_barrier(lent *l, VkCommandBuffer commands);

#endif
