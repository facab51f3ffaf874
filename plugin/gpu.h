/* The lent device: functions, limits, memory, images, buffers. Nothing here knows what a cloud is. */
#ifndef PLUGIN_GPU_H
#define PLUGIN_GPU_H

#ifndef VK_NO_PROTOTYPES
#define VK_NO_PROTOTYPES
#endif
#include <stdbool.h>
#include <velum/vulkan.h>

#include "log.h"

#define GPU_INSTANCE_FUNCTIONS(X)                                                                                      \
    X(GetDeviceProcAddr)                                                                                               \
    X(GetPhysicalDeviceFormatProperties2)                                                                              \
    X(GetPhysicalDeviceMemoryProperties)                                                                               \
    X(GetPhysicalDeviceProperties2)                                                                                    \
    X(GetPhysicalDeviceQueueFamilyProperties)

#define GPU_DEVICE_FUNCTIONS(X)                                                                                        \
    X(AllocateDescriptorSets)                                                                                          \
    X(AllocateMemory)                                                                                                  \
    X(BindBufferMemory)                                                                                                \
    X(BindImageMemory)                                                                                                 \
    X(CmdBindDescriptorSets)                                                                                           \
    X(CmdBindPipeline)                                                                                                 \
    X(CmdClearColorImage)                                                                                              \
    X(CmdCopyBuffer)                                                                                                   \
    X(CmdCopyBufferToImage)                                                                                            \
    X(CmdCopyImage)                                                                                                    \
    X(CmdDispatch)                                                                                                     \
    X(CmdDispatchIndirect)                                                                                             \
    X(CmdFillBuffer)                                                                                                   \
    X(CmdPipelineBarrier2)                                                                                             \
    X(CmdResetQueryPool)                                                                                               \
    X(CmdUpdateBuffer)                                                                                                 \
    X(CmdWriteTimestamp2)                                                                                              \
    X(CreateBuffer)                                                                                                    \
    X(CreateBufferView)                                                                                                \
    X(CreateComputePipelines)                                                                                          \
    X(CreateDescriptorPool)                                                                                            \
    X(CreateDescriptorSetLayout)                                                                                       \
    X(CreateImage)                                                                                                     \
    X(CreateImageView)                                                                                                 \
    X(CreatePipelineCache)                                                                                             \
    X(CreatePipelineLayout)                                                                                            \
    X(CreateQueryPool)                                                                                                 \
    X(CreateSampler)                                                                                                   \
    X(CreateShaderModule)                                                                                              \
    X(DestroyBuffer)                                                                                                   \
    X(DestroyBufferView)                                                                                               \
    X(DestroyDescriptorPool)                                                                                           \
    X(DestroyDescriptorSetLayout)                                                                                      \
    X(DestroyImage)                                                                                                    \
    X(DestroyImageView)                                                                                                \
    X(DestroyPipeline)                                                                                                 \
    X(DestroyPipelineCache)                                                                                            \
    X(DestroyPipelineLayout)                                                                                           \
    X(DestroyQueryPool)                                                                                                \
    X(DestroySampler)                                                                                                  \
    X(DestroyShaderModule)                                                                                             \
    X(FlushMappedMemoryRanges)                                                                                         \
    X(FreeMemory)                                                                                                      \
    X(GetBufferMemoryRequirements)                                                                                     \
    X(GetImageMemoryRequirements)                                                                                      \
    X(GetPipelineCacheData)                                                                                            \
    X(GetQueryPoolResults)                                                                                             \
    X(InvalidateMappedMemoryRanges)                                                                                    \
    X(MapMemory)                                                                                                       \
    X(ResetDescriptorPool)                                                                                             \
    X(UpdateDescriptorSets)

typedef struct gpu_block gpu_block;

typedef struct gpu {
    const log_sink *sink;
    VkPhysicalDevice physical;
    VkDevice device;
    VkPhysicalDeviceProperties properties;
    VkPhysicalDeviceMemoryProperties memory;
    bool has_timestamps;
    VkResult result; /* of the newest call that failed */
    gpu_block *blocks;
    uint64_t allocated_bytes;
#define X(name) PFN_vk##name name;
    GPU_INSTANCE_FUNCTIONS(X)
    GPU_DEVICE_FUNCTIONS(X)
#undef X
} gpu;

/* True if the call succeeded; else it is logged with its VkResult, file and line. */
bool gpu_check(gpu *g, VkResult result, const char *call, const char *file, int line);
#define VK(g, call) gpu_check(g, (g)->call, #call, __FILE__, __LINE__)
/* What to return after a failed call. */
velum_result gpu_result(const gpu *g);
/* Whether the device is the processor. */
bool gpu_is_software(const gpu *g);

/* Loads the functions and reads the limits. */
velum_result gpu_init(gpu *g, const velum_vulkan_lend *lend, const log_sink *sink);
/* All images and buffers are gone by now. */
void gpu_finish(gpu *g);

typedef enum gpu_memory_kind {
    GPU_MEMORY_DEVICE,  /* device local */
    GPU_MEMORY_UPLOAD,  /* mapped, coherent, written in order */
    GPU_MEMORY_READBACK /* mapped, coherent, cached if possible */
} gpu_memory_kind;

typedef struct gpu_allocation {
    gpu_block *block;
    VkDeviceSize offset, size;
} gpu_allocation;

bool gpu_allocate(gpu *g, const VkMemoryRequirements *requirements, gpu_memory_kind kind, bool linear,
                  gpu_allocation *out);
void gpu_release(gpu *g, gpu_allocation *allocation);
VkDeviceMemory gpu_allocation_memory(const gpu_allocation *allocation);
void *gpu_allocation_mapped(const gpu_allocation *allocation);

typedef struct gpu_buffer {
    VkBuffer buffer;
    VkBufferView texels; /* see gpu_buffer_view */
    VkDeviceSize size;
    void *mapped;
    gpu_allocation allocation;
} gpu_buffer;

typedef struct gpu_image {
    VkImage image;
    VkImageView view;
    VkFormat format;
    VkExtent3D extent;
    uint32_t layers;
    bool general; /* its layout is GENERAL from the first recorded command on */
    bool is_storage;
    gpu_allocation allocation;
} gpu_image;

typedef struct gpu_image_desc {
    VkFormat format;
    VkImageType type;
    VkImageViewType view_type;
    VkExtent3D extent;
    uint32_t layers;
    VkImageUsageFlags usage;
} gpu_image_desc;

bool gpu_buffer_init(gpu *g, gpu_buffer *buffer, VkDeviceSize size, VkBufferUsageFlags usage, gpu_memory_kind kind);
/* What a device's texel buffers hold at least: rays of any view, one for 16 pixels. */
#define GPU_TEXELS_LEAST (1u << 25)
/* As texels of a format: so many bytes, or VK_WHOLE_SIZE. */
bool gpu_buffer_view(gpu *g, gpu_buffer *buffer, VkFormat format, VkDeviceSize bytes);
void gpu_buffer_finish(gpu *g, gpu_buffer *buffer);
bool gpu_image_init(gpu *g, gpu_image *image, const gpu_image_desc *desc);
/* One 2D layer that shaders write and sample. */
bool gpu_image_init_storage(gpu *g, gpu_image *image, VkFormat format, uint32_t width, uint32_t height);
void gpu_image_finish(gpu *g, gpu_image *image);

/* To GENERAL, once. Storage images are all zero then: filters read beyond what shaders have written, and 0 times NaN
 * is NaN. */
void gpu_image_make_general(gpu *g, VkCommandBuffer commands, gpu_image *image);
void gpu_barrier(gpu *g, VkCommandBuffer commands, VkPipelineStageFlags2 from, VkAccessFlags2 from_access,
                 VkPipelineStageFlags2 to, VkAccessFlags2 to_access);

/* What a device must have. */
const velum_vulkan_requirements *gpu_requirements(void);
/* The first thing that is missing, in words, or "" */
velum_result gpu_check_device(PFN_vkGetInstanceProcAddr get, VkInstance instance, VkPhysicalDevice device, char *reason,
                              uint32_t reason_size);

#endif
