/* Velum ABI, part 6: for hosts without Vulkan. Table "velum.standalone/1".
 *
 * Makes a device of its own (loading the Vulkan loader at run time) and returns pixels in host memory, over the same
 * code as "velum.vulkan/1". Calls block until the device is done. Eyes, views and shadow maps come from
 * "velum.engine/1"; begin_frame, end_frame and record calls are not legal on such an engine: render() stands for them.
 */
#ifndef VELUM_STANDALONE_H
#define VELUM_STANDALONE_H

#include "engine.h"

#ifdef __cplusplus
extern "C" {
#endif

enum { VELUM_DEVICE_AUTO = -1, VELUM_DEVICE_CPU = -2 };

typedef struct velum_standalone_desc {
    uint32_t struct_size;
    uint32_t flags;     /* VELUM_STANDALONE_VALIDATE */
    velum_world *world; /* must outlive the engine */
    velum_log_fn log;
    void *log_context;
    int32_t device; /* index of the physical device, VELUM_DEVICE_AUTO (a GPU if there is one), or _CPU */
    uint32_t reserved;
} velum_standalone_desc;
#define VELUM_STANDALONE_VALIDATE 0x1u /* with Khronos validation, messages go to the log; UNSUPPORTED if absent */

/* Pixels of one view, tightly packed rows, top first; each may be null. */
typedef struct velum_pixels {
    uint32_t struct_size;
    uint32_t flags; /* 0 */
    velum_view *view;
    const velum_view_frame *frame;
    float *luminance_rgb;     /* width * height * 3 */
    float *transmittance_rgb; /* width * height * 3 */
    float *distance_m;        /* width * height */
    const float *depth;       /* input, width * height, by frame->depth_convention; null: none */
    uint32_t width, height;   /* of the buffers: as the frame's sub-rectangle */
    float *variance;          /* width * height: variance of the mean luminance Y, (cd/m2)^2, not scaled; zeros but from
                                 VELUM_QUALITY_REFERENCE */
} velum_pixels;

typedef struct velum_standalone_api {
    uint32_t struct_size;
    uint32_t reserved;

    /* [control] */
    velum_result(VELUM_CALL *create_engine)(const velum_standalone_desc *desc, velum_engine **out);

    /* [render] One frame of all the given views of the given eyes. frame->submit_serial and completed_serial: 0. */
    velum_result(VELUM_CALL *render)(velum_engine *engine, const velum_frame_info *frame, const velum_eye_frame *eyes,
                                     uint32_t eye_count, uint32_t eye_stride, const velum_pixels *views,
                                     uint32_t view_count, uint32_t view_stride);

    /* [render] A shadow map into host memory: levels * texels * texels floats, level by level, rows of v. */
    velum_result(VELUM_CALL *render_shadow)(velum_engine *engine, const velum_frame_info *frame, velum_shadow *shadow,
                                            const velum_shadow_frame *shadow_frame, float *transmittance,
                                            uint64_t count);
} velum_standalone_api;

#define VELUM_STANDALONE_API_ID "velum.standalone/1"

#ifdef __cplusplus
}
#endif
#endif
