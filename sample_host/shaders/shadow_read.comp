#version 460
// A shadow map's texels, as floats in a buffer: level by level, rows of v.
layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2DArray map;
layout(set = 0, binding = 1, std430) writeonly buffer Texels {
    float transmittance[];
} texels;

void main() {
    ivec3 at = ivec3(gl_GlobalInvocationID);
    ivec3 size = textureSize(map, 0);
    if (all(lessThan(at, size))) {
        texels.transmittance[(at.z * size.y + at.y) * size.x + at.x] = texelFetch(map, at, 0).r;
    }
}
