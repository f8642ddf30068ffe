#version 460
#extension GL_GOOGLE_include_directive : require
// The ratio of refined light to that of the frame's own samples, by texel and channel. What neither reaches stays as it
// is.
#include "gi_module/many_light/light_maps_shared.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform isamplerBuffer own_sums;
layout(set = 0, binding = 1) uniform isamplerBuffer refined_sums;
layout(set = 0, binding = 2) writeonly buffer Refined { uvec2 refined_texels[]; };
layout(push_constant) uniform Constants { RefinedLightConstants constants; };

#include "gi_module/many_light/refined_texel.glsl"

void main() {
    const uint texel = gl_WorkGroupID.y * constants.row_length + gl_GlobalInvocationID.x;
    if (gl_GlobalInvocationID.x >= constants.row_length || texel >= constants.texels)
        return;
    refined_texels[texel] = refined_texel(texelFetch(own_sums, int(texel)).rgb, texelFetch(refined_sums, int(texel)).rgb,
                                          constants.own_steps, texel);
}
