/* A swapchain of a window, into which pictures are blitted. */
#ifndef HOST_SWAPCHAIN_H
#define HOST_SWAPCHAIN_H

#include "gpu.h"
#include "renderer.h"

#include <stdbool.h>

enum { SWAPCHAIN_IMAGES_MAX = 16 };

struct swapchain {
    VkSurfaceKHR surface;
    VkSwapchainKHR handle;
    VkExtent2D extent;
    VkImage images[SWAPCHAIN_IMAGES_MAX];
    VkSemaphore presentable[SWAPCHAIN_IMAGES_MAX]; /* signalled by the frame that fills the image */
    VkSemaphore acquired[RENDERER_SLOTS_MAX];
    uint32_t image_count;
    uint32_t current;
    bool out_of_date;
};

/* Takes over the surface. */
bool swapchain_init(struct swapchain *swapchain, struct device *device, VkSurfaceKHR surface, uint32_t width,
                    uint32_t height);
void swapchain_finish(struct swapchain *swapchain, struct device *device);

/* After the device is idle: follows the window's size. An extent of 0 means that nothing can be shown now. */
bool swapchain_resize(struct swapchain *swapchain, struct device *device, uint32_t width, uint32_t height);

/* False, with out_of_date set, if there is no image to fill now; false without it: failed (reported). */
bool swapchain_acquire(struct swapchain *swapchain, struct device *device, uint32_t slot);

/* The picture, stretched over the image, which is then ready to be presented. */
void swapchain_fill(struct swapchain *swapchain, VkCommandBuffer commands, const struct gpu_image *picture);

#endif
