#version 460
#extension GL_GOOGLE_include_directive : require
// Puts what was drawn over the irradiance, which may be an image of the host's that nothing can be drawn on.
#include "gi_module/transfer/transfer_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D drawn;
layout(set = 0, binding = 1) writeonly uniform image2D irradiance;
layout(push_constant) uniform Constants { TransferMergeConstants constants; };

void main() {
    if (gl_GlobalInvocationID.x >= constants.width || gl_GlobalInvocationID.y >= constants.height)
        return;
    const ivec2 pixel = ivec2(constants.x + gl_GlobalInvocationID.x, constants.y + gl_GlobalInvocationID.y);
    const vec4 value = texelFetch(drawn, pixel, 0);
    if (value.a > 0.0)
        imageStore(irradiance, pixel, value);
}
