/* The smallest Vulkan device that runs one compute shader over an array of words and reads an array of words back. */
#ifndef VELUM_TESTS_COMPUTE_H
#define VELUM_TESTS_COMPUTE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <vulkan/vulkan.h>

/* Bindings of set 0. A shader uses what it needs. */
enum {
    COMPUTE_BIND_INPUT,   /* storage, words */
    COMPUTE_BIND_OUTPUT,  /* storage, words */
    COMPUTE_BIND_UNIFORM, /* the input again, as uniform block */
    COMPUTE_BIND_TEXTURE_0,
    COMPUTE_BIND_TEXTURE_1,
    COMPUTE_BIND_COUNT
};
#define COMPUTE_TEXTURES 2
#define COMPUTE_GROUP 64 /* local size in x of every shader; its push constant is the number of invocations */

typedef struct compute_device {
    VkInstance instance;
    VkPhysicalDevice physical;
    VkDevice device;
    VkQueue queue;
    uint32_t family;
    VkCommandPool pool;
    VkSampler sampler; /* linear, repeating */
    VkPhysicalDeviceMemoryProperties memory;
    char name[VK_MAX_PHYSICAL_DEVICE_NAME_SIZE];
    bool processor; /* a software device */
    bool lent;      /* instance and device are another's */
} compute_device;

typedef struct compute_texture {
    VkImage image;
    VkDeviceMemory memory;
    VkImageView view;
} compute_texture;

typedef struct compute_job {
    const uint32_t *spirv;
    size_t spirv_bytes;
    const void *input;
    size_t input_bytes;
    void *output;
    size_t output_bytes;
    uint32_t invocations;
    const compute_texture *textures[COMPUTE_TEXTURES];
    uint32_t repeats; /* 0: once; else so often, of which the quickest is timed */
    double seconds;   /* out */
} compute_job;

/* A processor first, so that tests are alike on all machines; environment VELUM_TEST_DEVICE: index of another. */
bool compute_open(compute_device *device, char reason[256]);
/* On a device that another has made, of Vulkan 1.3 with maintenance4. */
bool compute_borrow(compute_device *device, VkInstance instance, VkPhysicalDevice physical, VkDevice lent,
                    uint32_t family);
void compute_close(compute_device *device);

bool compute_filters(const compute_device *device, VkFormat format); /* linear filter of a sampled 3D image */
bool compute_texture_create(compute_device *device, VkFormat format, uint32_t side, const void *texels, size_t bytes,
                            compute_texture *texture);
/* A 2D array, all layers in one block. */
bool compute_array_create(compute_device *device, VkFormat format, uint32_t side, uint32_t layers, const void *texels,
                          size_t bytes, compute_texture *texture);
void compute_texture_destroy(compute_device *device, compute_texture *texture);

bool compute_run(compute_device *device, compute_job *job);

#endif
