#include "lent.h"

#include <stdlib.h>
#include <string.h>

#include "plugin/handle.h"
#include "plugin/standalone.h"

enum { TURNS = 4, VIEWS = 2 };

struct lent {
    fixture *f;
    standalone *s;
    gpu *g;
    uint32_t turns;
    VkCommandPool pool[TURNS];
    VkCommandBuffer commands[TURNS];
    VkFence fence[TURNS];
    bool pending[TURNS];
    gpu_image luminance[VIEWS], transmittance[VIEWS];
};

lent *lent_create(fixture *f, uint32_t frames_in_flight, uint32_t width, uint32_t height) {
    engine *e = handle_get(f->engine, HANDLE_ENGINE);
    assert_non_null(e);
    lent *l = calloc(1, sizeof *l);
    assert_non_null(l);
    l->f = f;
    l->s = e->owner;
    l->g = &e->g;
    l->turns = frames_in_flight;
    for (uint32_t i = 0; i < frames_in_flight; i++) {
        const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                              .queueFamilyIndex = l->s->family};
        const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
        assert_int_equal(l->s->CreateCommandPool(l->s->device, &pool, NULL, &l->pool[i]), VK_SUCCESS);
        const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                      .commandPool = l->pool[i],
                                                      .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                      .commandBufferCount = 1};
        assert_int_equal(l->s->AllocateCommandBuffers(l->s->device, &commands, &l->commands[i]), VK_SUCCESS);
        assert_int_equal(l->s->CreateFence(l->s->device, &fence, NULL, &l->fence[i]), VK_SUCCESS);
    }
    const gpu_image_desc image = {.format = VK_FORMAT_R16G16B16A16_SFLOAT,
                                  .type = VK_IMAGE_TYPE_2D,
                                  .view_type = VK_IMAGE_VIEW_TYPE_2D_ARRAY,
                                  .extent = {width, height, 1},
                                  .layers = 2,
                                  .usage = VK_IMAGE_USAGE_STORAGE_BIT};
    for (uint32_t i = 0; i < VIEWS; i++) {
        assert_true(gpu_image_init(l->g, &l->luminance[i], &image));
        assert_true(gpu_image_init(l->g, &l->transmittance[i], &image));
    }
    return l;
}

void lent_destroy(lent *l) {
    lent_wait(l);
    for (uint32_t i = 0; i < VIEWS; i++) {
        gpu_image_finish(l->g, &l->luminance[i]);
        gpu_image_finish(l->g, &l->transmittance[i]);
    }
    for (uint32_t i = 0; i < l->turns; i++) {
        l->s->DestroyCommandPool(l->s->device, l->pool[i], NULL);
        l->s->DestroyFence(l->s->device, l->fence[i], NULL);
    }
    free(l);
}

velum_vulkan_lend lent_desc(const lent *l) {
    return (velum_vulkan_lend){.struct_size = sizeof(velum_vulkan_lend),
                               .world = l->f->world,
                               .log = fixture_log,
                               .log_context = l->f,
                               .get_instance_proc_addr = l->s->get,
                               .instance = l->s->instance,
                               .physical_device = l->s->physical,
                               .device = l->s->device,
                               .api_version = VK_API_VERSION_1_3,
                               .queue_family = l->s->family,
                               .frames_in_flight = l->turns};
}

static void wait_turn(lent *l, uint32_t turn) {
    if (l->pending[turn]) {
        assert_int_equal(l->s->WaitForFences(l->s->device, 1, &l->fence[turn], VK_TRUE, UINT64_MAX), VK_SUCCESS);
        assert_int_equal(l->s->ResetFences(l->s->device, 1, &l->fence[turn]), VK_SUCCESS);
        l->pending[turn] = false;
    }
}

VkCommandBuffer lent_begin(lent *l, uint32_t turn) {
    const VkCommandBufferBeginInfo info = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO,
                                           .flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT};
    wait_turn(l, turn);
    assert_int_equal(l->s->ResetCommandPool(l->s->device, l->pool[turn], 0), VK_SUCCESS);
    assert_int_equal(l->s->BeginCommandBuffer(l->commands[turn], &info), VK_SUCCESS);
    return l->commands[turn];
}

void lent_submit(lent *l, uint32_t turn) {
    const VkSubmitInfo submit = {
        .sType = VK_STRUCTURE_TYPE_SUBMIT_INFO, .commandBufferCount = 1, .pCommandBuffers = &l->commands[turn]};
    assert_int_equal(l->s->EndCommandBuffer(l->commands[turn]), VK_SUCCESS);
    assert_int_equal(l->s->QueueSubmit(l->s->queue, 1, &submit, l->fence[turn]), VK_SUCCESS);
    l->pending[turn] = true;
}

void lent_wait(lent *l) {
    for (uint32_t i = 0; i < l->turns; i++) {
        wait_turn(l, i);
    }
}

velum_vulkan_images lent_images(lent *l, VkCommandBuffer commands, uint32_t index) {
    gpu_image_make_general(l->g, commands, &l->luminance[index]);
    gpu_image_make_general(l->g, commands, &l->transmittance[index]);
    return (velum_vulkan_images){.struct_size = sizeof(velum_vulkan_images),
                                 .luminance = l->luminance[index].view,
                                 .transmittance = l->transmittance[index].view,
                                 .format = VK_FORMAT_R16G16B16A16_SFLOAT,
                                 .width = l->luminance[index].extent.width,
                                 .height = l->luminance[index].extent.height,
                                 .layers = 2};
}

void lent_barrier(lent *l, VkCommandBuffer commands) {
    gpu_barrier(l->g, commands, VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT, VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT,
                VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT,
                VK_ACCESS_2_SHADER_STORAGE_WRITE_BIT | VK_ACCESS_2_SHADER_STORAGE_READ_BIT);
}
