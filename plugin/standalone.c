#include "standalone.h"

#include <dlfcn.h>
#include <stdlib.h>
#include <string.h>

#include "handle.h"

enum { DEVICES_MAX = 16, FAMILIES_MAX = 32, LAYERS_MAX = 64 };

typedef union any_function {
    PFN_vkVoidFunction from;
    void *symbol;
    PFN_vkGetInstanceProcAddr GetInstanceProcAddr;
    PFN_vkCreateInstance CreateInstance;
    PFN_vkDestroyInstance DestroyInstance;
    PFN_vkEnumerateInstanceLayerProperties EnumerateInstanceLayerProperties;
    PFN_vkEnumeratePhysicalDevices EnumeratePhysicalDevices;
    PFN_vkGetPhysicalDeviceProperties GetPhysicalDeviceProperties;
    PFN_vkGetPhysicalDeviceQueueFamilyProperties GetPhysicalDeviceQueueFamilyProperties;
    PFN_vkCreateDevice CreateDevice;
    PFN_vkGetDeviceProcAddr GetDeviceProcAddr;
    PFN_vkCreateDebugUtilsMessengerEXT CreateDebugUtilsMessengerEXT;
    PFN_vkDestroyDebugUtilsMessengerEXT DestroyDebugUtilsMessengerEXT;
#define X(name) PFN_vk##name name;
    STANDALONE_FUNCTIONS(X)
#undef X
} any_function;

static any_function instance_function(const standalone *s, const char *name) {
    any_function f;
    f.from = s->get(s->instance, name);
    return f;
}

static void destroy_device(void *owner) {
    standalone *s = owner;
    if (s->device) {
        if (s->fence) {
            s->DestroyFence(s->device, s->fence, NULL);
        }
        if (s->pool) {
            s->DestroyCommandPool(s->device, s->pool, NULL);
        }
        s->DestroyDevice(s->device, NULL);
    }
    if (s->messenger) {
        s->DestroyDebugUtilsMessengerEXT(s->instance, s->messenger, NULL);
    }
    if (s->instance) {
        s->DestroyInstance(s->instance, NULL);
    }
    if (s->library) {
        dlclose(s->library);
    }
    free(s);
}

static VkBool32 VKAPI_PTR on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                     VkDebugUtilsMessageTypeFlagsEXT types,
                                     const VkDebugUtilsMessengerCallbackDataEXT *data, void *user) {
    (void)types;
    const standalone *s = user;
    bool error = (severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) != 0;
    log_write(&s->sink, error ? VELUM_LOG_PLUGIN_DEFECT : VELUM_LOG_WARNING, "validation", "%s", data->pMessage);
    return VK_FALSE;
}

static bool has_layer(standalone *s, const char *name) {
    VkLayerProperties layers[LAYERS_MAX];
    uint32_t count = LAYERS_MAX;
    any_function f;
    f.from = s->get(NULL, "vkEnumerateInstanceLayerProperties");
    if (!f.from || f.EnumerateInstanceLayerProperties(&count, layers) < 0) {
        return false;
    }
    for (uint32_t i = 0; i < count; i++) {
        if (strcmp(layers[i].layerName, name) == 0) {
            return true;
        }
    }
    return false;
}

static velum_result fail(const standalone *s, velum_result result, const char *text) {
    return log_fail(&s->sink, result, "engine", "create_engine: %s", text);
}

static velum_result create_instance(standalone *s, bool validate) {
    static const char *const layers[] = {"VK_LAYER_KHRONOS_validation"};
    static const char *const extensions[] = {"VK_EXT_debug_utils", "VK_EXT_validation_features"};
    static const VkValidationFeatureEnableEXT enables[] = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    any_function f;
    s->library = dlopen("libvulkan.so.1", RTLD_NOW | RTLD_LOCAL);
    if (!s->library) {
        return fail(s, VELUM_ERROR_UNSUPPORTED, "the Vulkan loader (libvulkan.so.1) is not installed");
    }
    f.symbol = dlsym(s->library, "vkGetInstanceProcAddr");
    s->get = f.GetInstanceProcAddr;
    f.from = s->get ? s->get(NULL, "vkCreateInstance") : NULL;
    if (!f.from) {
        return fail(s, VELUM_ERROR_UNSUPPORTED, "libvulkan.so.1 is no Vulkan loader");
    }
    if (validate && !has_layer(s, layers[0])) {
        return fail(s, VELUM_ERROR_UNSUPPORTED,
                    "VELUM_STANDALONE_VALIDATE: VK_LAYER_KHRONOS_validation is not installed");
    }
    const VkDebugUtilsMessengerCreateInfoEXT messenger = {
        .sType = VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT,
        .messageSeverity =
            VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT,
        .messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT,
        .pfnUserCallback = on_message,
        .pUserData = s};
    const VkValidationFeaturesEXT features = {.sType = VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT,
                                              .pNext = &messenger,
                                              .enabledValidationFeatureCount = 1,
                                              .pEnabledValidationFeatures = enables};
    const VkApplicationInfo application = {
        .sType = VK_STRUCTURE_TYPE_APPLICATION_INFO, .pApplicationName = "Velum", .apiVersion = VK_API_VERSION_1_3};
    const VkInstanceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO,
                                       .pNext = validate ? &features : NULL,
                                       .pApplicationInfo = &application,
                                       .enabledLayerCount = validate ? 1 : 0,
                                       .ppEnabledLayerNames = layers,
                                       .enabledExtensionCount = validate ? 2 : 0,
                                       .ppEnabledExtensionNames = extensions};
    VkResult result = f.CreateInstance(&info, NULL, &s->instance);
    if (result != VK_SUCCESS) {
        s->instance = VK_NULL_HANDLE;
        return log_fail(&s->sink, VELUM_ERROR_UNSUPPORTED, "engine",
                        "create_engine: vkCreateInstance failed (VkResult %d): is a Vulkan 1.3 driver installed?",
                        (int)result);
    }
    s->DestroyInstance = instance_function(s, "vkDestroyInstance").DestroyInstance;
    if (validate) {
        any_function create = instance_function(s, "vkCreateDebugUtilsMessengerEXT");
        s->DestroyDebugUtilsMessengerEXT =
            instance_function(s, "vkDestroyDebugUtilsMessengerEXT").DestroyDebugUtilsMessengerEXT;
        if (!create.from || create.CreateDebugUtilsMessengerEXT(s->instance, &messenger, NULL, &s->messenger) < 0) {
            s->messenger = VK_NULL_HANDLE;
            return fail(s, VELUM_ERROR_VULKAN, "vkCreateDebugUtilsMessengerEXT failed");
        }
    }
    return VELUM_OK;
}

static velum_result find_family(standalone *s) {
    VkQueueFamilyProperties families[FAMILIES_MAX];
    uint32_t count = FAMILIES_MAX;
    instance_function(s, "vkGetPhysicalDeviceQueueFamilyProperties")
        .GetPhysicalDeviceQueueFamilyProperties(s->physical, &count, families);
    for (s->family = 0; s->family < count; s->family++) {
        if (families[s->family].queueFlags & VK_QUEUE_COMPUTE_BIT) {
            return VELUM_OK;
        }
    }
    return fail(s, VELUM_ERROR_UNSUPPORTED, "the device has no compute queue");
}

static velum_result choose_device(standalone *s, int32_t wanted) {
    VkPhysicalDevice devices[DEVICES_MAX];
    uint32_t count = DEVICES_MAX;
    any_function enumerate = instance_function(s, "vkEnumeratePhysicalDevices");
    any_function properties = instance_function(s, "vkGetPhysicalDeviceProperties");
    if (enumerate.EnumeratePhysicalDevices(s->instance, &count, devices) < 0 || count == 0) {
        return fail(s, VELUM_ERROR_UNSUPPORTED, "there is no Vulkan device");
    }
    if (wanted >= 0 && (uint32_t)wanted >= count) {
        return log_fail(&s->sink, VELUM_ERROR_ARGUMENT, "engine",
                        "create_engine: desc.device: found %d, expected 0..%u", wanted, count - 1);
    }
    int best = -1;
    char reason[128] = "no CPU device";
    for (uint32_t i = 0; i < count; i++) {
        VkPhysicalDeviceProperties p;
        properties.GetPhysicalDeviceProperties(devices[i], &p);
        bool cpu = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_CPU;
        if ((wanted >= 0 && i != (uint32_t)wanted) || (wanted == VELUM_DEVICE_CPU && !cpu) ||
            gpu_check_device(s->get, s->instance, devices[i], reason, sizeof reason) < 0) {
            continue;
        }
        int rank = p.deviceType == VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU     ? 3
                   : p.deviceType == VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU ? 2
                   : cpu                                                    ? 0
                                                                            : 1;
        if (rank > best) {
            best = rank;
            s->physical = devices[i];
        }
    }
    if (best < 0) {
        return log_fail(&s->sink, VELUM_ERROR_UNSUPPORTED, "engine", "create_engine: no usable device: %s", reason);
    }
    return find_family(s);
}

static velum_result create_device(standalone *s) {
    const velum_vulkan_requirements *needs = gpu_requirements();
    VkPhysicalDeviceVulkan13Features features13 = *needs->features13;
    VkPhysicalDeviceFeatures2 features = {
        .sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, .pNext = &features13, .features = *needs->features};
    const float priority = 1.0f;
    const VkDeviceQueueCreateInfo queue = {.sType = VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO,
                                           .queueFamilyIndex = s->family,
                                           .queueCount = 1,
                                           .pQueuePriorities = &priority};
    const VkDeviceCreateInfo info = {.sType = VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO,
                                     .pNext = &features,
                                     .queueCreateInfoCount = 1,
                                     .pQueueCreateInfos = &queue};
    VkResult result = instance_function(s, "vkCreateDevice").CreateDevice(s->physical, &info, NULL, &s->device);
    if (result != VK_SUCCESS) {
        s->device = VK_NULL_HANDLE;
        return log_fail(&s->sink, VELUM_ERROR_VULKAN, "engine", "create_engine: vkCreateDevice failed (VkResult %d)",
                        (int)result);
    }
    any_function get = instance_function(s, "vkGetDeviceProcAddr");
    any_function f;
    bool all = true;
#define X(name)                                                                                                        \
    f.from = get.GetDeviceProcAddr(s->device, "vk" #name);                                                             \
    s->name = f.name;                                                                                                  \
    all = all && f.from;
    STANDALONE_FUNCTIONS(X)
#undef X
    if (!all) {
        return fail(s, VELUM_ERROR_VULKAN, "a Vulkan function is missing");
    }
    s->GetDeviceQueue(s->device, s->family, 0, &s->queue);
    const VkCommandPoolCreateInfo pool = {.sType = VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO,
                                          .queueFamilyIndex = s->family};
    const VkFenceCreateInfo fence = {.sType = VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    if (s->CreateCommandPool(s->device, &pool, NULL, &s->pool) < 0) {
        s->pool = VK_NULL_HANDLE;
        return fail(s, VELUM_ERROR_VULKAN, "vkCreateCommandPool failed");
    }
    const VkCommandBufferAllocateInfo commands = {.sType = VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO,
                                                  .commandPool = s->pool,
                                                  .level = VK_COMMAND_BUFFER_LEVEL_PRIMARY,
                                                  .commandBufferCount = 1};
    if (s->AllocateCommandBuffers(s->device, &commands, &s->commands) < 0) {
        return fail(s, VELUM_ERROR_VULKAN, "vkAllocateCommandBuffers failed");
    }
    if (s->CreateFence(s->device, &fence, NULL, &s->fence) < 0) {
        s->fence = VK_NULL_HANDLE;
        return fail(s, VELUM_ERROR_VULKAN, "vkCreateFence failed");
    }
    return VELUM_OK;
}

velum_result standalone_create(const velum_standalone_desc *desc, velum_engine **out) {
    log_sink sink = {0};
    checker check = {&sink, "engine", "create_engine", VELUM_OK};
    velum_standalone_desc d;
    if (!check_pointer(&check, "out", out) || !check_in(&check, "desc", &d, sizeof d, desc, V1_STANDALONE_DESC)) {
        return check.result;
    }
    sink = (log_sink){d.log, d.log_context};
    world *w = handle_get(d.world, HANDLE_WORLD);
    if (!check_flags(&check, "desc.flags", d.flags, VELUM_STANDALONE_VALIDATE) ||
        !check_zero(&check, "desc.reserved", d.reserved) ||
        !check_range(&check, "desc.device", d.device, VELUM_DEVICE_CPU, DEVICES_MAX)) {
        return check.result;
    }
    if (!w) {
        check_fail(&check, VELUM_ERROR_HANDLE, "desc.world: not a live world");
        return check.result;
    }
    standalone *s = calloc(1, sizeof *s);
    if (!s) {
        return log_fail(&sink, VELUM_ERROR_OUT_OF_MEMORY, "engine", "create_engine: no memory");
    }
    s->sink = sink;
    velum_result result = create_instance(s, d.flags & VELUM_STANDALONE_VALIDATE);
    result = result < 0 ? result : choose_device(s, d.device);
    result = result < 0 ? result : create_device(s);
    if (result >= 0) {
        const velum_vulkan_lend lend = {.struct_size = sizeof lend,
                                        .world = d.world,
                                        .log = d.log,
                                        .log_context = d.log_context,
                                        .get_instance_proc_addr = s->get,
                                        .instance = s->instance,
                                        .physical_device = s->physical,
                                        .device = s->device,
                                        .api_version = VK_API_VERSION_1_3,
                                        .queue_family = s->family,
                                        .frames_in_flight = 1};
        result = engine_create(&lend, w, false, out);
    }
    if (result < 0) {
        destroy_device(s);
        return result;
    }
    s->e = handle_get(*out, HANDLE_ENGINE);
    s->e->owner = s;
    s->e->release_owner = standalone_release;
    s->e->destroy_owner = destroy_device;
    return VELUM_OK;
}
