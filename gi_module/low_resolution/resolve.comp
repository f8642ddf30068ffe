#version 460
#extension GL_GOOGLE_include_directive : require
// Writes a stage's sums to the picture, unless a contributor already does so in a pass of its own.
#include "gi_module/low_resolution/low_resolution_shared.h"

layout(local_size_x = 64) in;

layout(set = 0, binding = 0) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 1) readonly buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 2) writeonly uniform image2D output_image;
layout(push_constant) uniform Constants { LowResolutionConstants constants; };

void main() {
    const uint packed = pixels[gl_GlobalInvocationID.x];
    if (packed == no_pixel)
        return;
    const ivec2 pixel = ivec2(packed & 0xffffu, (packed >> 16) & 0x7fffu);
    if (pixel.x < int(constants.width) && pixel.y < int(constants.height))
        imageStore(output_image, pixel, vec4(max(sums[gl_GlobalInvocationID.x].rgb, vec3(0.0)), (packed & unlit_pixel) == 0u ? 1.0 : 0.0));
}
