#version 460
#extension GL_GOOGLE_include_directive : require
// L = L_host T + L_velum, exposed, tone-mapped, encoded; and the line of figures over it.
#include "host_arguments.h"
#include "tone_map.h"

layout(local_size_x = HOST_GROUP_SIZE, local_size_y = HOST_GROUP_SIZE) in;
layout(set = 0, binding = HOST_BINDING_VIEW, std140) uniform View {
    HOST_VIEW_ARGUMENTS
} view;
layout(set = 0, binding = HOST_BINDING_COLOUR, rgba32f) uniform readonly image2D colour_image;
layout(set = 0, binding = HOST_BINDING_LUMINANCE) uniform sampler2D luminance_image;
layout(set = 0, binding = HOST_BINDING_TRANSMITTANCE) uniform sampler2D transmittance_image;
layout(set = 0, binding = HOST_BINDING_PICTURE, rgba8) uniform writeonly image2D picture_image;
// Rows of 8 bits, one bit a pixel: bits[row * columns + column].
layout(set = 0, binding = HOST_BINDING_OVERLAY, std430) readonly buffer Overlay {
    uint bits[];
} overlay;

vec3 with_overlay(vec3 colour, ivec2 pixel) {
    int columns = int(view.region_part.w), scale = int(view.wood_part.w);
    ivec2 at = (pixel - 4 * scale) / scale;
    ivec2 size = ivec2(columns * 8, 8);
    if (columns == 0 || pixel.x < 2 * scale || pixel.y < 2 * scale || at.x > size.x + 1 || at.y > size.y + 1) {
        return colour;
    }
    bool lit = false;
    if (pixel.x >= 4 * scale && pixel.y >= 4 * scale && at.x < size.x && at.y < size.y) {
        uint row = overlay.bits[(at.x >> 3) * 2 + (at.y >> 2)] >> (8 * (at.y & 3));
        lit = ((row >> (7 - (at.x & 7))) & 1u) != 0u;
    }
    return lit ? vec3(0.95) : 0.35 * colour;
}

// White as a camera set to daylight sees it: what faces a sun 45 degrees high through clear air, and the sky around it,
// comes out grey. Fixed, so that mornings stay warm.
const vec3 daylight_balance = vec3(0.93, 1.0, 1.11);

// Less than half a code either way, evenly spread over neighbours (Jimenez 2014, interleaved gradient noise). Added to
// codes before they are rounded: clear sky, fog and the inside of cloud change by less than a code over many pixels, and
// would show bands.
float dither(ivec2 pixel) {
    return fract(52.9829189 * fract(dot(vec2(pixel), vec2(0.06711056, 0.00583715)))) * 0.99 - 0.495;
}

void main() {
    ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(view.field_cell.w) || pixel.y >= int(view.tuft_cell.w)) {
        return;
    }
    vec3 host = imageLoad(colour_image, pixel).rgb;
    vec3 added = texelFetch(luminance_image, pixel, 0).rgb * view.wood_cell.w;
    vec3 through = texelFetch(transmittance_image, pixel, 0).rgb;
    vec3 exposed = min((host * through + added) * daylight_balance * view.region_cell.w, vec3(1e6));
    vec3 code = vec3(tone_map(exposed.r, exposed.g, exposed.b, 0), tone_map(exposed.r, exposed.g, exposed.b, 1),
                     tone_map(exposed.r, exposed.g, exposed.b, 2));
    vec3 dithered = code + dither(pixel) / 255.0;
    imageStore(picture_image, pixel, vec4(with_overlay(dithered, pixel), 1.0));
}
