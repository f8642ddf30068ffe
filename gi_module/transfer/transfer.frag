#version 460
#extension GL_GOOGLE_include_directive : require
// Keeps only fragments where the G-buffer shows this mover, and this layer of it.
#include "engine/scene/instance_shared.h"
#include "gi_module/transfer/transfer_shared.h"

layout(set = 0, binding = 3) uniform sampler2D depth_image;
layout(set = 0, binding = 4) uniform usampler2D surface_image;
layout(push_constant) uniform Constants { TransferConstants constants; };

layout(location = 0) in vec3 in_irradiance;
layout(location = 0) out vec4 out_irradiance;

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const uint surface = texelFetch(surface_image, pixel, 0).r;
    const float depth = texelFetch(depth_image, pixel, 0).r;
    if ((surface & surface_row_mask) != constants.row + 1u ||
        abs(gl_FragCoord.z - depth) > transfer_depth_tolerance * depth)
        discard;
    out_irradiance = vec4(in_irradiance, 1.0);
}
