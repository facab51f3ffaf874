/* Buffers, images, compute pipelines and barriers over the host's device. Failures are reported; destroy functions
 * accept what was never made. */
#ifndef HOST_GPU_H
#define HOST_GPU_H

#include "device.h"

struct gpu_buffer {
    VkBuffer handle;
    VkDeviceMemory memory;
    VkDeviceSize size;
    void *mapped; /* host memory, coherent */
};

struct gpu_image {
    VkImage handle;
    VkImageView view;
    VkDeviceMemory memory;
    VkFormat format;
    uint32_t width, height;
};

struct gpu_pipeline {
    VkDescriptorSetLayout set_layout;
    VkPipelineLayout layout;
    VkPipeline handle;
};

/* Mapped, coherent; cached where the host reads. */
bool gpu_buffer_create(struct device *device, VkDeviceSize size, VkBufferUsageFlags usage, bool host_reads,
                       struct gpu_buffer *out);
void gpu_buffer_destroy(struct device *device, struct gpu_buffer *buffer);

/* 2D, storage, sampled and source of copies. */
bool gpu_image_create(struct device *device, uint32_t width, uint32_t height, VkFormat format, struct gpu_image *out);
void gpu_image_destroy(struct device *device, struct gpu_image *image);

/* A compute pipeline over a set layout, which stays the caller's. constant: null, or specialisation constant 0. */
bool gpu_pipeline_create(struct device *device, const uint32_t *spirv, size_t spirv_size, const uint32_t *constant,
                         VkDescriptorSetLayout set_layout, struct gpu_pipeline *out);
void gpu_pipeline_destroy(struct device *device, struct gpu_pipeline *pipeline);

void gpu_barrier(VkCommandBuffer commands, VkPipelineStageFlags2 from_stage, VkAccessFlags2 from_access,
                 VkPipelineStageFlags2 to_stage, VkAccessFlags2 to_access);
/* Of a colour image: from and to a layout, `stages` both before and after. */
void gpu_image_barrier(VkCommandBuffer commands, VkImage image, VkPipelineStageFlags2 stages,
                       VkAccessFlags2 from_access, VkAccessFlags2 to_access, VkImageLayout from, VkImageLayout to);
/* Contents may be lost. */
void gpu_image_to_general(VkCommandBuffer commands, VkImage image);
void gpu_copy_image(VkCommandBuffer commands, const struct gpu_image *image, const struct gpu_buffer *to,
                    VkDeviceSize offset);

#endif
