#version 460
#extension GL_GOOGLE_include_directive : require
// The same light on every surface.
#include "tests/techniques/constant_light_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D depth_image;
layout(set = 0, binding = 1) writeonly uniform image2D target;
layout(push_constant) uniform Constants { ConstantLightConstants constants; };

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(constants.width) || pixel.y >= int(constants.height))
        return;
    if (texelFetch(depth_image, pixel, 0).r <= 0.0) {
        imageStore(target, pixel, vec4(0.0));
        return;
    }
    float left = constants.irradiance; // in [0, 1) after a turn
    for (uint turn = 0u; turn < constants.work; ++turn)
        left = fract(1.7 * left + 0.3);
    if (left == constants.never) // so that no compiler leaves the turns out
        return;
    const bool shows_surfaces = constants.show == constant_light_shows_surfaces;
    imageStore(target, pixel, vec4(shows_surfaces ? vec3(0.0, 1.0, 0.0) : vec3(constants.irradiance), 1.0));
}
