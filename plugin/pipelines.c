#include <pthread.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "engine.h"
#include "shared/reference.h"

/* After the headers: they need uint32_t. */
#include "air.spv.h"
#include "due.spv.h"
#include "finer.spv.h"
#include "gather.spv.h"
#include "glow.spv.h"
#include "light.spv.h"
#include "light_fringed.spv.h"
#include "light_volume_fill.spv.h"
#include "light_volume_spread.spv.h"
#include "light_volume_sun.spv.h"
#include "march.spv.h"
#include "march_fringed.spv.h"
#include "march_study.spv.h"
#include "march_study_fringed.spv.h"
#include "near.spv.h"
#include "reference.spv.h"
#include "reference_error.spv.h"
#include "reference_fringed.spv.h"
#include "reference_resolve.spv.h"
#include "reference_resolve_layered.spv.h"
#include "resolve.spv.h"
#include "resolve_layered.spv.h"
#include "shadow.spv.h"
#include "shadow_fringed.spv.h"
#include "sky.spv.h"

enum { PIPELINE_THREADS_MOST = 8 };

/* What stands before the driver's data in a blob, so that a foreign or damaged one is found out by us. */
typedef struct cache_header {
    char magic[8];
    uint32_t vendor, device, driver, reserved;
    uint8_t uuid[VK_UUID_SIZE];
    uint64_t size, sum;
} cache_header;

/* FNV-1a (Fowler, Noll & Vo 1991). */
static uint64_t sum_of(const uint8_t *bytes, uint64_t size) {
    uint64_t h = 0xcbf29ce484222325u;
    for (uint64_t i = 0; i < size; i++) {
        h = (h ^ bytes[i]) * 0x100000001b3u;
    }
    return h;
}

static cache_header header_of(const gpu *g, const void *data, uint64_t size) {
    cache_header header = {.magic = "VELUMPC",
                           .vendor = g->properties.vendorID,
                           .device = g->properties.deviceID,
                           .driver = g->properties.driverVersion,
                           .size = size,
                           .sum = sum_of(data, size)};
    memcpy(header.uuid, g->properties.pipelineCacheUUID, sizeof header.uuid);
    return header;
}

static bool blob_is_ours(const gpu *g, const void *blob, uint64_t size) {
    cache_header header, own;
    if (!blob || size < sizeof header) {
        return false;
    }
    memcpy(&header, blob, sizeof header);
    if (header.size != size - sizeof header) {
        return false;
    }
    own = header_of(g, (const char *)blob + sizeof header, header.size);
    return memcmp(&own, &header, sizeof header) == 0;
}

velum_result pipelines_get_cache(pipelines *p, gpu *g, void *data, uint64_t *size) {
    size_t own = 0;
    if (!VK(g, GetPipelineCacheData(g->device, p->cache, &own, NULL))) {
        return gpu_result(g);
    }
    if (!data) {
        *size = own + sizeof(cache_header);
        return VELUM_OK;
    }
    if (*size < own + sizeof(cache_header)) {
        return log_fail(g->sink, VELUM_ERROR_ARGUMENT, "engine",
                        "get_pipeline_cache: size: found %llu, expected at least %llu", (unsigned long long)*size,
                        (unsigned long long)(own + sizeof(cache_header)));
    }
    char *bytes = (char *)data + sizeof(cache_header);
    if (!VK(g, GetPipelineCacheData(g->device, p->cache, &own, bytes))) {
        return gpu_result(g);
    }
    cache_header header = header_of(g, bytes, own);
    memcpy(data, &header, sizeof header);
    *size = own + sizeof header;
    return VELUM_OK;
}

enum { U = VK_DESCRIPTOR_TYPE_UNIFORM_BUFFER_DYNAMIC, B = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER };
enum { T = VK_DESCRIPTOR_TYPE_COMBINED_IMAGE_SAMPLER, I = VK_DESCRIPTOR_TYPE_STORAGE_IMAGE };
enum { X = VK_DESCRIPTOR_TYPE_UNIFORM_TEXEL_BUFFER };

static bool create_set_layout(gpu *g, const int *types, uint32_t count, VkDescriptorSetLayout *out) {
    VkDescriptorSetLayoutBinding
        bindings[VELUM_BIND_COUNT > VELUM_BIND_VIEW_COUNT ? VELUM_BIND_COUNT : VELUM_BIND_VIEW_COUNT];
    for (uint32_t i = 0; i < count; i++) {
        bindings[i] = (VkDescriptorSetLayoutBinding){.binding = i,
                                                     .descriptorType = (VkDescriptorType)types[i],
                                                     .descriptorCount = 1,
                                                     .stageFlags = VK_SHADER_STAGE_COMPUTE_BIT};
    }
    VkDescriptorSetLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO, .bindingCount = count, .pBindings = bindings};
    return VK(g, CreateDescriptorSetLayout(g->device, &info, NULL, out));
}

static bool create_layout(gpu *g, const VkDescriptorSetLayout *sets, uint32_t count, VkPipelineLayout *out) {
    VkPipelineLayoutCreateInfo info = {
        .sType = VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO, .setLayoutCount = count, .pSetLayouts = sets};
    return VK(g, CreatePipelineLayout(g->device, &info, NULL, out));
}

static bool create_sampler(gpu *g, VkFilter filter, VkSamplerAddressMode address, VkSampler *out) {
    VkSamplerCreateInfo info = {.sType = VK_STRUCTURE_TYPE_SAMPLER_CREATE_INFO,
                                .magFilter = filter,
                                .minFilter = filter,
                                .mipmapMode = VK_SAMPLER_MIPMAP_MODE_NEAREST,
                                .addressModeU = address,
                                .addressModeV = address,
                                .addressModeW = address};
    return VK(g, CreateSampler(g->device, &info, NULL, out));
}

static bool is_of(pass which, pass first) {
    return which >= first && which < first + PASS_VARIANTS;
}

static bool is_volume_fill(pass which) {
    return which >= PASS_VOLUME_FILL && which < PASS_VOLUME_SUN;
}

static bool is_resolve(pass which) {
    return which >= PASS_RESOLVE && which < PASS_REFERENCE;
}

VkPipelineLayout pipelines_layout(const pipelines *p, pass which) {
    if (which >= PASS_DUE && which < PASS_SHADOW) {
        return p->layout_view;
    }
    if (which >= PASS_SHADOW && which < PASS_RESOLVE) {
        return p->layout_shadow;
    }
    if (is_resolve(which)) {
        return p->layout_view;
    }
    switch (which) {
    case PASS_REFERENCE:
    case PASS_REFERENCE_FRINGED:
    case PASS_REFERENCE_RESOLVE:
    case PASS_REFERENCE_RESOLVE_LAYERED:
    case PASS_REFERENCE_ERROR: return p->layout_reference;
    default: return p->layout_engine;
    }
}

uint32_t pipelines_reference_lanes(const gpu *g) {
    return gpu_is_software(g) ? 8 : VELUM_REFERENCE_GROUP;
}

/* Constants of shaders: 0 of weather.glsl; invocations of the tracer's group; its slots, its air; 4 of
 * cloud_hit.glsl; 5, 7 and 8 of resolve.comp, 8 of gather.comp too, 6 of moved.glsl; 9 of segments.glsl; 10 of
 * uneven.glsl; 11 of resolve.comp; 12 of air_light.glsl; 13 of near.glsl. */
typedef struct variant {
    VkBool32 more;
    uint32_t lanes, slots, turns;
    VkBool32 air, closes, ground, depth, moves, keeps, segmented, uneven, aside, fog;
} variant;

/* The first of its variants. */
static pass family_of(pass which) {
    return is_of(which, PASS_MARCH)          ? PASS_MARCH
           : is_of(which, PASS_MARCH_UNEVEN) ? PASS_MARCH_UNEVEN
           : is_of(which, PASS_LIGHT)        ? PASS_LIGHT
           : is_volume_fill(which)           ? PASS_VOLUME_FILL
           : is_of(which, PASS_MARCH_STUDY)  ? PASS_MARCH_STUDY
           : is_of(which, PASS_SHADOW)       ? PASS_SHADOW
           : is_resolve(which)               ? PASS_RESOLVE
                                             : which;
}

static uint32_t variant_of(pass which) {
    return (uint32_t)which - (uint32_t)family_of(which);
}

/* Writes nothing of either: several threads may be in it. */
static VkResult make_variant(const pipelines *p, const gpu *g, pass which, const variant *values, VkPipeline *out) {
    static const struct {
        const uint32_t *words;
        size_t bytes;
    } shaders[PASS_COUNT] = {
        [PASS_AIR] = {velum_air_spv, sizeof velum_air_spv},
        [PASS_GLOW] = {velum_glow_spv, sizeof velum_glow_spv},
        [PASS_SKY] = {velum_sky_spv, sizeof velum_sky_spv},
        [PASS_SKY_FOG] = {velum_sky_spv, sizeof velum_sky_spv},
        [PASS_DUE] = {velum_due_spv, sizeof velum_due_spv},
        [PASS_FINER] = {velum_finer_spv, sizeof velum_finer_spv},
        [PASS_NEAR] = {velum_near_spv, sizeof velum_near_spv},
        [PASS_NEAR_DEPTH] = {velum_near_spv, sizeof velum_near_spv},
        [PASS_VOLUME_FILL] = {velum_light_volume_fill_spv, sizeof velum_light_volume_fill_spv},
        [PASS_VOLUME_SUN] = {velum_light_volume_sun_spv, sizeof velum_light_volume_sun_spv},
        [PASS_VOLUME_SPREAD] = {velum_light_volume_spread_spv, sizeof velum_light_volume_spread_spv},
        [PASS_MARCH] = {velum_march_spv, sizeof velum_march_spv},
        [PASS_MARCH + PASS_FRINGED] = {velum_march_fringed_spv, sizeof velum_march_fringed_spv},
        [PASS_MARCH_UNEVEN] = {velum_march_spv, sizeof velum_march_spv},
        [PASS_MARCH_UNEVEN + PASS_FRINGED] = {velum_march_fringed_spv, sizeof velum_march_fringed_spv},
        [PASS_LIGHT] = {velum_light_spv, sizeof velum_light_spv},
        [PASS_LIGHT + PASS_FRINGED] = {velum_light_fringed_spv, sizeof velum_light_fringed_spv},
        [PASS_GATHER] = {velum_gather_spv, sizeof velum_gather_spv},
        [PASS_GATHER_KEEPS] = {velum_gather_spv, sizeof velum_gather_spv},
        [PASS_MARCH_STUDY] = {velum_march_study_spv, sizeof velum_march_study_spv},
        [PASS_MARCH_STUDY + PASS_FRINGED] = {velum_march_study_fringed_spv, sizeof velum_march_study_fringed_spv},
        [PASS_SHADOW] = {velum_shadow_spv, sizeof velum_shadow_spv},
        [PASS_SHADOW + PASS_FRINGED] = {velum_shadow_fringed_spv, sizeof velum_shadow_fringed_spv},
        [PASS_RESOLVE] = {velum_resolve_spv, sizeof velum_resolve_spv},
        [PASS_RESOLVE + PASS_LAYERED] = {velum_resolve_layered_spv, sizeof velum_resolve_layered_spv},
        [PASS_REFERENCE] = {velum_reference_spv, sizeof velum_reference_spv},
        [PASS_REFERENCE_FRINGED] = {velum_reference_fringed_spv, sizeof velum_reference_fringed_spv},
        [PASS_REFERENCE_RESOLVE] = {velum_reference_resolve_spv, sizeof velum_reference_resolve_spv},
        [PASS_REFERENCE_RESOLVE_LAYERED] = {velum_reference_resolve_layered_spv,
                                            sizeof velum_reference_resolve_layered_spv},
        [PASS_REFERENCE_ERROR] = {velum_reference_error_spv, sizeof velum_reference_error_spv}};
    const VkSpecializationMapEntry entries[] = {{0, offsetof(variant, more), sizeof values->more},
                                                {1, offsetof(variant, lanes), sizeof values->lanes},
                                                {2, offsetof(variant, slots), sizeof values->slots},
                                                {3, offsetof(variant, air), sizeof values->air},
                                                {4, offsetof(variant, closes), sizeof values->closes},
                                                {5, offsetof(variant, ground), sizeof values->ground},
                                                {6, offsetof(variant, depth), sizeof values->depth},
                                                {7, offsetof(variant, moves), sizeof values->moves},
                                                {8, offsetof(variant, keeps), sizeof values->keeps},
                                                {9, offsetof(variant, segmented), sizeof values->segmented},
                                                {10, offsetof(variant, uneven), sizeof values->uneven},
                                                {11, offsetof(variant, aside), sizeof values->aside},
                                                {12, offsetof(variant, fog), sizeof values->fog},
                                                {13, offsetof(variant, turns), sizeof values->turns}};
    const VkSpecializationInfo constants = {sizeof entries / sizeof entries[0], entries, sizeof *values, values};
    _Static_assert((int)PASS_FRINGED == (int)PASS_LAYERED, "variants with code of their own");
    const pass code = (pass)(family_of(which) + (variant_of(which) & PASS_FRINGED));
    VkShaderModuleCreateInfo module_info = {.sType = VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO,
                                            .codeSize = shaders[code].bytes,
                                            .pCode = shaders[code].words};
    VkShaderModule module = VK_NULL_HANDLE;
    VkResult result = g->CreateShaderModule(g->device, &module_info, NULL, &module);
    if (result < 0) {
        return result;
    }
    VkComputePipelineCreateInfo info = {.sType = VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO,
                                        .stage = {.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO,
                                                  .stage = VK_SHADER_STAGE_COMPUTE_BIT,
                                                  .module = module,
                                                  .pName = "main",
                                                  .pSpecializationInfo = &constants},
                                        .layout = pipelines_layout(p, which)};
    result = g->CreateComputePipelines(g->device, p->cache, 1, &info, NULL, out);
    g->DestroyShaderModule(g->device, module, NULL);
    return result;
}

static VkResult make_pipeline(pipelines *p, const gpu *g, pass which) {
    const uint32_t kind = variant_of(which);
    const bool resolves = is_resolve(which);
    const bool has_depth = resolves && kind & PASS_DEPTH;
    const bool moves = resolves && kind & PASS_MOVES;
    const variant values = {.more = !resolves && kind & PASS_MIXED,
                            .lanes = pipelines_reference_lanes(g),
                            .turns = !moves               ? VELUM_TURNS_ASKED
                                     : kind & PASS_STANDS ? VELUM_TURNS_SOME
                                                          : VELUM_TURNS_NONE,
                            .closes = !resolves && (kind & PASS_CLOSED || is_of(which, PASS_MARCH_STUDY)),
                            .ground = resolves && kind & PASS_GROUND,
                            .depth = which == PASS_NEAR_DEPTH || has_depth,
                            .moves = moves,
                            .keeps = which == PASS_GATHER_KEEPS || (resolves && !has_depth && kind & PASS_KEEPS),
                            .aside = has_depth && kind & PASS_ASIDE,
                            .fog = which != PASS_SKY,
                            .segmented = is_of(which, PASS_SHADOW) && shadow_segments(g) > 1,
                            .uneven = is_of(which, PASS_MARCH_UNEVEN) || is_of(which, PASS_MARCH_STUDY) ||
                                      (is_of(which, PASS_SHADOW) && kind & PASS_UNEVEN)};
    return make_variant(p, g, which, &values, &p->pipeline[which]);
}

/* Pipelines that several threads make side by side: drivers take most of an engine's start for them. */
typedef struct pipeline_list {
    pipelines *p;
    const gpu *g;
    pass which[PASS_COUNT];
    uint32_t count;
    atomic_uint next;
    atomic_int result; /* VkResult: a failed one, if any has failed */
} pipeline_list;

static void *make_listed(void *argument) {
    pipeline_list *list = argument;
    for (uint32_t i = atomic_fetch_add(&list->next, 1); i < list->count; i = atomic_fetch_add(&list->next, 1)) {
        VkResult result = make_pipeline(list->p, list->g, list->which[i]);
        if (result < 0) {
            atomic_store(&list->result, result);
            break;
        }
    }
    return NULL;
}

static bool create_listed(pipeline_list *list, gpu *g) {
    pthread_t helpers[PIPELINE_THREADS_MOST - 1];
    uint32_t helper_count = 0;
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    sigset_t all, before;
    sigfillset(&all);
    static const int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGTRAP, SIGSYS, SIGABRT};
    for (size_t i = 0; i < sizeof faults / sizeof faults[0]; i++) {
        sigdelset(&all, faults[i]);
    }
    /* The host's signals are for the host's threads, but for a fault of their own. */
    pthread_sigmask(SIG_SETMASK, &all, &before);
    while (helper_count < PIPELINE_THREADS_MOST - 1 && helper_count + 1 < processors &&
           helper_count + 1 < list->count && pthread_create(&helpers[helper_count], NULL, make_listed, list) == 0) {
        helper_count++;
    }
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    make_listed(list);
    for (uint32_t i = 0; i < helper_count; i++) {
        pthread_join(helpers[i], NULL);
    }
    return gpu_check(g, (VkResult)atomic_load(&list->result), "CreateComputePipelines", __FILE__, __LINE__);
}

/* Those that are made with the first eye that wants them, and those that nothing asks for. */
static bool is_left_out(pass which, bool arrays) {
    const uint32_t kind = variant_of(which);
    const bool lights = is_of(which, PASS_MARCH) || is_of(which, PASS_MARCH_UNEVEN) || is_of(which, PASS_LIGHT);
    return is_of(which, PASS_MARCH_STUDY) || (which >= PASS_VOLUME_FILL && which <= PASS_VOLUME_SPREAD) ||
           (lights && kind & PASS_FRINGED && !(kind & PASS_CLOSED)) ||
           (is_resolve(which) && ((kind & PASS_LAYERED && !arrays) || (kind & PASS_STANDS && !(kind & PASS_MOVES)) ||
                                  (kind & PASS_KEEPS && kind & PASS_MOVES && !(kind & PASS_DEPTH))));
}

bool pipelines_need(pipelines *p, gpu *g, const pass *needed, uint32_t count) {
    pipeline_list list = {.p = p, .g = g};
    for (uint32_t i = 0; i < count; i++) {
        if (!p->pipeline[needed[i]]) {
            list.which[list.count++] = needed[i];
        }
    }
    return list.count == 0 || create_listed(&list, g);
}

/* Before a frame needs them. Mesa's software device compiles at a pipeline's first dispatch: made earlier, it costs as
 * much and saves nothing. */
static bool make_early(pipelines *p, gpu *g, const pass *which, uint32_t count) {
    return gpu_is_software(g) || pipelines_need(p, g, which, count);
}

VkPipeline pipelines_tracer(pipelines *p, gpu *g, bool mixes, bool air, uint32_t slots, bool fringed) {
    if (p->tracer_count == TRACERS_MAX - 1) {
        mixes = air = true;
        slots = (1u << VELUM_SLOT_COUNT) - 1;
        fringed = true;
    }
    const uint32_t key = slots | (uint32_t)mixes << 8 | (uint32_t)air << 9 | (uint32_t)fringed << 10;
    for (uint32_t i = 0; i < p->tracer_count; i++) {
        if (p->tracer_key[i] == key) {
            return p->tracer[i];
        }
    }
    const variant values = {
        .more = mixes, .lanes = pipelines_reference_lanes(g), .turns = VELUM_TURNS_ASKED, .slots = slots, .air = air};
    const VkResult result =
        make_variant(p, g, fringed ? PASS_REFERENCE_FRINGED : PASS_REFERENCE, &values, &p->tracer[p->tracer_count]);
    if (!gpu_check(g, result, "CreateComputePipelines", __FILE__, __LINE__)) {
        return VK_NULL_HANDLE;
    }
    p->tracer_key[p->tracer_count] = key;
    return p->tracer[p->tracer_count++];
}

velum_result pipelines_init(pipelines *p, gpu *g, const void *blob, uint64_t blob_size, bool arrays) {
    static const int engine_types[VELUM_BIND_COUNT] = {U, B, T, T, T, T, T, I, T, I, T, I, T, U, T, B};
    static const int view_types[VELUM_BIND_VIEW_COUNT] = {U, I, I, T, T, T, T, I, I, I, I,
                                                          I, T, B, B, B, B, B, X, X, X};
    static const int shadow_types[2] = {U, I};
    *p = (pipelines){0};
    bool known = blob_is_ours(g, blob, blob_size);
    if (blob && !known) {
        log_write(g->sink, VELUM_LOG_INFO, "engine",
                  "create_engine: the pipeline cache is damaged or of another device, driver or version; not used");
    }
    VkPipelineCacheCreateInfo cache = {.sType = VK_STRUCTURE_TYPE_PIPELINE_CACHE_CREATE_INFO,
                                       .initialDataSize = known ? blob_size - sizeof(cache_header) : 0,
                                       .pInitialData = known ? (const char *)blob + sizeof(cache_header) : NULL};
    bool ok = VK(g, CreatePipelineCache(g->device, &cache, NULL, &p->cache)) &&
              create_set_layout(g, engine_types, VELUM_BIND_COUNT, &p->set_engine) &&
              create_set_layout(g, view_types, VELUM_BIND_VIEW_COUNT, &p->set_view) &&
              create_set_layout(g, shadow_types, 2, &p->set_shadow);
    VkDescriptorSetLayout view_sets[2] = {p->set_engine, p->set_view};
    VkDescriptorSetLayout shadow_sets[2] = {p->set_engine, p->set_shadow};
    ok = ok && create_layout(g, view_sets, 1, &p->layout_engine) && create_layout(g, view_sets, 2, &p->layout_view) &&
         create_layout(g, shadow_sets, 2, &p->layout_shadow) &&
         create_sampler(g, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, &p->linear) &&
         create_sampler(g, VK_FILTER_LINEAR, VK_SAMPLER_ADDRESS_MODE_REPEAT, &p->repeat) &&
         create_sampler(g, VK_FILTER_NEAREST, VK_SAMPLER_ADDRESS_MODE_CLAMP_TO_EDGE, &p->nearest);
    pass which[PASS_COUNT];
    uint32_t count = 0;
    for (uint32_t i = 0; i < PASS_REFERENCE; i++) {
        if (!is_left_out((pass)i, arrays)) {
            which[count++] = (pass)i;
        }
    }
    ok = ok && make_early(p, g, which, count);
    if (!ok) {
        pipelines_finish(p, g);
        return gpu_result(g);
    }
    return VELUM_OK;
}

velum_result pipelines_add_study(pipelines *p, gpu *g) {
    pass which[PASS_VARIANTS + PASS_VOLUME_SPREAD - PASS_VOLUME_FILL + 1];
    uint32_t count = 0;
    for (int i = PASS_VOLUME_FILL; i <= PASS_VOLUME_SPREAD; i++) {
        which[count++] = (pass)i;
    }
    for (uint32_t kind = 0; kind < PASS_VARIANTS; kind++) {
        if (!(kind & PASS_CLOSED)) {
            which[count++] = (pass)(PASS_MARCH_STUDY + kind);
        }
    }
    return make_early(p, g, which, count) ? VELUM_OK : gpu_result(g);
}

velum_result pipelines_add_reference(pipelines *p, gpu *g) {
    /* By the numbers of shared/reference.h and of VELUM_BIND_*: view, paths, pixels, bounds, noise, variance, error;
     * two that nothing uses; luminance, transmittance, distance, depth, counters. */
    static const int types[VELUM_BIND_REFERENCE_COUNT] = {U, B, B, B, B, I, B, B, B, I, I, I, T, B};
    bool ok = p->set_reference || create_set_layout(g, types, VELUM_BIND_REFERENCE_COUNT, &p->set_reference);
    const VkDescriptorSetLayout sets[2] = {p->set_engine, p->set_reference};
    ok = ok && (p->layout_reference || create_layout(g, sets, 2, &p->layout_reference));
    static const pass which[] = {PASS_REFERENCE_RESOLVE, PASS_REFERENCE_RESOLVE_LAYERED, PASS_REFERENCE_ERROR};
    ok = ok && pipelines_need(p, g, which, sizeof which / sizeof which[0]);
    return ok ? VELUM_OK : gpu_result(g);
}

void pipelines_finish(pipelines *p, gpu *g) {
    if (!g->DestroyPipeline) {
        return;
    }
    for (uint32_t i = 0; i < PASS_COUNT; i++) {
        g->DestroyPipeline(g->device, p->pipeline[i], NULL);
    }
    for (uint32_t i = 0; i < p->tracer_count; i++) {
        g->DestroyPipeline(g->device, p->tracer[i], NULL);
    }
    g->DestroySampler(g->device, p->linear, NULL);
    g->DestroySampler(g->device, p->repeat, NULL);
    g->DestroySampler(g->device, p->nearest, NULL);
    g->DestroyPipelineLayout(g->device, p->layout_engine, NULL);
    g->DestroyPipelineLayout(g->device, p->layout_view, NULL);
    g->DestroyPipelineLayout(g->device, p->layout_shadow, NULL);
    g->DestroyPipelineLayout(g->device, p->layout_reference, NULL);
    g->DestroyDescriptorSetLayout(g->device, p->set_reference, NULL);
    g->DestroyDescriptorSetLayout(g->device, p->set_engine, NULL);
    g->DestroyDescriptorSetLayout(g->device, p->set_view, NULL);
    g->DestroyDescriptorSetLayout(g->device, p->set_shadow, NULL);
    g->DestroyPipelineCache(g->device, p->cache, NULL);
    *p = (pipelines){0};
}
