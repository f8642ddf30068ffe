// Adds a technique's light to the picture. The including shader declares the image `picture`, which is read and
// written, so that GLSL requires its format.
#include "engine/scene/instance_shared.h"
#include "gi_module/light_sum/light_sum_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D depth_image;
layout(set = 0, binding = 1) uniform usampler2D surface_image;
layout(set = 0, binding = 2) uniform sampler2D layer;
layout(set = 0, binding = 3) readonly buffer Receivers { uint receivers[]; }; // kind, by instance row
layout(push_constant) uniform Constants { LightSumConstants constants; };

void main() {
    if (gl_GlobalInvocationID.x >= constants.width || gl_GlobalInvocationID.y >= constants.height)
        return;
    const ivec2 pixel = ivec2(constants.x + gl_GlobalInvocationID.x, constants.y + gl_GlobalInvocationID.y);
    if (constants.mode == light_sum_clear) {
        imageStore(picture, pixel, vec4(0.0, 0.0, 0.0, texelFetch(depth_image, pixel, 0).r > 0.0 ? 1.0 : 0.0));
        return;
    }
    const vec4 light = texelFetch(layer, pixel, 0);
    if (light.a <= 0.0)
        return;
    if (constants.mode == light_sum_replace) {
        imageStore(picture, pixel, light);
        return;
    }
    const uint row = texelFetch(surface_image, pixel, 0).r & surface_row_mask;
    if (row == 0u || (receivers[row - 1u] & constants.receivers) == 0u)
        return;
    const vec4 sum = imageLoad(picture, pixel);
    imageStore(picture, pixel, vec4(sum.rgb + light.rgb, sum.a));
}
