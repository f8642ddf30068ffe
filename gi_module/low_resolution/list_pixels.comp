#version 460
#extension GL_GOOGLE_include_directive : require
// Lists a stage's pixels and clears their sums, unless a contributor already does so in a pass of its own.
// Low-resolution pixels are subsampled from the full G-buffer: each takes the pixel in the middle of its block.
#include "gi_module/low_resolution/low_resolution_shared.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint from_list = 0; // 0: tiles of the low-resolution picture, 1: the pixels are given

layout(set = 0, binding = 0) uniform sampler2D depth_image;
layout(set = 0, binding = 1) buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 2) writeonly buffer Sums { vec4 sums[]; };
layout(push_constant) uniform Constants { LowResolutionConstants constants; };

void main() {
    const uint entry = gl_GlobalInvocationID.x;
    uint packed;
    if (from_list != 0) {
        packed = pixels[entry];
    } else {
        const uvec2 tile = uvec2(gl_WorkGroupID.x % constants.group_columns, gl_WorkGroupID.x / constants.group_columns);
        const uvec2 low = tile * pixel_group_side + uvec2(gl_LocalInvocationID.x % pixel_group_side, gl_LocalInvocationID.x / pixel_group_side);
        const uvec2 pixel = min(low * constants.scale + constants.scale / 2u, uvec2(constants.width, constants.height) - 1u);
        packed = low.x < constants.low_width && low.y < constants.low_height ? pixel.x | pixel.y << 16 : no_pixel;
    }
    bool lit = packed != no_pixel;
    if (lit)
        lit = texelFetch(depth_image, ivec2(packed & 0xffffu, (packed >> 16) & 0x7fffu), 0).r > 0.0;
    pixels[entry] = lit ? packed : packed | unlit_pixel;
    sums[entry] = vec4(0.0, 0.0, 0.0, lit ? 1.0 : 0.0);
}
