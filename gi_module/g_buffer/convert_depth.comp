#version 460
#extension GL_GOOGLE_include_directive : require
// Converts the depth of any perspective projection to near / distance along the view axis.
#include "gi_module/g_buffer/conversion_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D host_depth;
layout(set = 0, binding = 1) writeonly uniform image2D depth_image;
layout(push_constant) uniform Constants { DepthConversionConstants constants; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    const ivec2 size = ivec2(constants.width, constants.height);
    if (any(greaterThanEqual(pixel, size)))
        return;
    const float depth = texelFetch(host_depth, pixel, 0).r;
    const vec2 ndc = (vec2(pixel) + 0.5) / vec2(size) * 2.0 - 1.0;
    // Subtract the background first: with forward Z the difference is exact, while a sum with the offset would lose
    // digits.
    const float rest = (depth - constants.background) + constants.offset + dot(constants.slope, ndc);
    imageStore(depth_image, pixel, vec4(depth == constants.background ? 0.0 : max(rest * constants.scale, 0.0)));
}
