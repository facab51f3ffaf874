#include "swapchain.h"

#include "report.h"

static bool create_semaphore(struct device *device, VkSemaphore *out) {
    const VkSemaphoreCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
    return device_ok(vkCreateSemaphore(device->handle, &info, NULL, out), "vkCreateSemaphore");
}

/* 8 bits, not sRGB: the picture is encoded already. */
static bool choose_format(struct device *device, VkSurfaceKHR surface, VkSurfaceFormatKHR *out) {
    VkSurfaceFormatKHR formats[64];
    uint32_t count = 64;
    if (!device_ok(vkGetPhysicalDeviceSurfaceFormatsKHR(device->physical, surface, &count, formats),
                   "vkGetPhysicalDeviceSurfaceFormatsKHR")) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        if ((formats[i].format == VK_FORMAT_B8G8R8A8_UNORM || formats[i].format == VK_FORMAT_R8G8B8A8_UNORM) &&
            formats[i].colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) {
            *out = formats[i];
            return true;
        }
    }
    report_error("window: the display offers no format of 8 bits");
    return false;
}

static bool create_swapchain(struct swapchain *swapchain, struct device *device, uint32_t width, uint32_t height) {
    VkSurfaceCapabilitiesKHR can;
    VkSurfaceFormatKHR format;
    if (!device_ok(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device->physical, swapchain->surface, &can),
                   "vkGetPhysicalDeviceSurfaceCapabilitiesKHR") ||
        !choose_format(device, swapchain->surface, &format)) {
        return false;
    }
    VkExtent2D extent = can.currentExtent;
    if (extent.width == UINT32_MAX) {
        extent = (VkExtent2D){width, height};
        extent.width = extent.width < can.minImageExtent.width ? can.minImageExtent.width : extent.width;
        extent.height = extent.height < can.minImageExtent.height ? can.minImageExtent.height : extent.height;
        extent.width = extent.width > can.maxImageExtent.width ? can.maxImageExtent.width : extent.width;
        extent.height = extent.height > can.maxImageExtent.height ? can.maxImageExtent.height : extent.height;
    }
    swapchain->extent = extent;
    if (extent.width == 0 || extent.height == 0) {
        return true;
    }
    if (!(can.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT)) {
        report_error("window: its images cannot be copied into");
        return false;
    }
    uint32_t images = can.minImageCount + 1;
    if (can.maxImageCount > 0 && images > can.maxImageCount) {
        images = can.maxImageCount;
    }
    const VkCompositeAlphaFlagBitsKHR opaque = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    const VkSwapchainCreateInfoKHR info = {
        .sType = VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR,
        .surface = swapchain->surface,
        .minImageCount = images,
        .imageFormat = format.format,
        .imageColorSpace = format.colorSpace,
        .imageExtent = extent,
        .imageArrayLayers = 1,
        .imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT,
        .preTransform = can.currentTransform,
        .compositeAlpha = (can.supportedCompositeAlpha & opaque) ? opaque : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR,
        .presentMode = VK_PRESENT_MODE_FIFO_KHR,
        .clipped = VK_TRUE};
    if (!device_ok(vkCreateSwapchainKHR(device->handle, &info, NULL, &swapchain->handle), "vkCreateSwapchainKHR")) {
        swapchain->handle = VK_NULL_HANDLE;
        return false;
    }
    swapchain->image_count = SWAPCHAIN_IMAGES_MAX;
    if (!device_ok(
            vkGetSwapchainImagesKHR(device->handle, swapchain->handle, &swapchain->image_count, swapchain->images),
            "vkGetSwapchainImagesKHR")) {
        return false;
    }
    for (uint32_t i = 0; i < swapchain->image_count; i++) {
        if (!create_semaphore(device, &swapchain->presentable[i])) {
            return false;
        }
    }
    for (uint32_t s = 0; s < RENDERER_SLOTS_MAX; s++) {
        if (!create_semaphore(device, &swapchain->acquired[s])) {
            return false;
        }
    }
    return true;
}

static void destroy_swapchain(struct swapchain *swapchain, struct device *device) {
    for (uint32_t i = 0; i < SWAPCHAIN_IMAGES_MAX; i++) {
        vkDestroySemaphore(device->handle, swapchain->presentable[i], NULL);
        swapchain->presentable[i] = VK_NULL_HANDLE;
    }
    for (uint32_t s = 0; s < RENDERER_SLOTS_MAX; s++) {
        vkDestroySemaphore(device->handle, swapchain->acquired[s], NULL);
        swapchain->acquired[s] = VK_NULL_HANDLE;
    }
    vkDestroySwapchainKHR(device->handle, swapchain->handle, NULL);
    swapchain->handle = VK_NULL_HANDLE;
}

bool swapchain_init(struct swapchain *swapchain, struct device *device, VkSurfaceKHR surface, uint32_t width,
                    uint32_t height) {
    VkBool32 supported = VK_FALSE;
    *swapchain = (struct swapchain){.surface = surface};
    if (!device_ok(vkGetPhysicalDeviceSurfaceSupportKHR(device->physical, device->family, surface, &supported),
                   "vkGetPhysicalDeviceSurfaceSupportKHR")) {
        return false;
    }
    if (!supported) {
        report_error("window: the device '%s' cannot show anything there", device->properties.deviceName);
        return false;
    }
    return create_swapchain(swapchain, device, width, height);
}

void swapchain_finish(struct swapchain *swapchain, struct device *device) {
    if (swapchain && device->handle) {
        destroy_swapchain(swapchain, device);
    }
    if (swapchain && device->instance) {
        vkDestroySurfaceKHR(device->instance, swapchain->surface, NULL);
        swapchain->surface = VK_NULL_HANDLE;
    }
}

bool swapchain_resize(struct swapchain *swapchain, struct device *device, uint32_t width, uint32_t height) {
    destroy_swapchain(swapchain, device);
    swapchain->out_of_date = false;
    return create_swapchain(swapchain, device, width, height);
}

bool swapchain_acquire(struct swapchain *swapchain, struct device *device, uint32_t slot) {
    if (!swapchain->handle) {
        swapchain->out_of_date = true;
        return false;
    }
    VkResult result = vkAcquireNextImageKHR(device->handle, swapchain->handle, UINT64_MAX, swapchain->acquired[slot],
                                            VK_NULL_HANDLE, &swapchain->current);
    if (result == VK_ERROR_OUT_OF_DATE_KHR) {
        swapchain->out_of_date = true;
        return false;
    }
    swapchain->out_of_date = result == VK_SUBOPTIMAL_KHR;
    return device_ok(result, "vkAcquireNextImageKHR");
}

void swapchain_fill(struct swapchain *swapchain, VkCommandBuffer commands, const struct gpu_image *picture) {
    VkImage image = swapchain->images[swapchain->current];
    const VkImageBlit region = {
        .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .srcOffsets = {{0, 0, 0}, {(int32_t)picture->width, (int32_t)picture->height, 1}},
        .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
        .dstOffsets = {{0, 0, 0}, {(int32_t)swapchain->extent.width, (int32_t)swapchain->extent.height, 1}}};
    const VkPipelineStageFlags2 transfer = VK_PIPELINE_STAGE_2_TRANSFER_BIT;
    gpu_image_barrier(commands, image, transfer, 0, VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_IMAGE_LAYOUT_UNDEFINED,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL);
    vkCmdBlitImage(commands, picture->handle, VK_IMAGE_LAYOUT_GENERAL, image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                   &region, VK_FILTER_LINEAR);
    gpu_image_barrier(commands, image, transfer, VK_ACCESS_2_TRANSFER_WRITE_BIT, 0,
                      VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_IMAGE_LAYOUT_PRESENT_SRC_KHR);
}
