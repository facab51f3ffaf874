#version 460
#extension GL_GOOGLE_include_directive : require
/* Mean over the pixels of the standard error of their luminance over the greater of their luminance and 1 % of the
 * picture's mean. One work group, in a fixed order. */
#include "shared/reference.h"
layout(local_size_x = VELUM_REFERENCE_GROUP) in;
layout(set = 1, binding = VELUM_BIND_VIEW, std140) uniform view_uniform {
    velum_view_block view;
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_PIXELS, std430) readonly buffer pixels_buffer {
    velum_reference_pixel pixels[];
};
layout(set = 1, binding = VELUM_BIND_REFERENCE_ERROR, std430) buffer error_buffer {
    float slice[VELUM_SLICE_WORDS];
};

shared float part[VELUM_REFERENCE_GROUP];

float sum_of_parts() {
    barrier();
    float sum = 0.0;
    for (int i = 0; i < VELUM_REFERENCE_GROUP; ++i) {
        sum += part[i];
    }
    barrier();
    return sum;
}

void main() {
    uint count = view.size.x * view.size.y;
    uint lane = gl_LocalInvocationIndex;
    float sum = 0.0;
    for (uint i = lane; i < count; i += VELUM_REFERENCE_GROUP) {
        sum += max(dot(pixels[i].light.rgb, VELUM_LUMINANCE_OF), 0.0);
    }
    part[lane] = sum;
    float least = 0.01 * sum_of_parts() / float(count);
    sum = 0.0;
    for (uint i = lane; i < count; i += VELUM_REFERENCE_GROUP) {
        float n = pixels[i].light.w;
        float error = n > 1.0 ? sqrt(max(pixels[i].through.w, 0.0) / (n * (n - 1.0))) : 0.0;
        float luminance = max(dot(pixels[i].light.rgb, VELUM_LUMINANCE_OF), least);
        sum += luminance > 0.0 ? error / luminance : 0.0;
    }
    part[lane] = sum;
    float all = sum_of_parts();
    if (lane == 0u) {
        slice[VELUM_SLICE_ERROR] = all / float(count);
    }
}
