#version 460
#extension GL_GOOGLE_include_directive : require
// The ratio of refined light to that of the frame's own samples, by texel and channel. What neither reaches stays as it
// is.
#include "gi_module/many_light/light_maps_shared.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform isamplerBuffer own_sums;
layout(set = 0, binding = 1) uniform isamplerBuffer refined_sums;
layout(set = 0, binding = 2) writeonly buffer Ratios { uvec2 ratios[]; };
layout(push_constant) uniform Constants { RefinedLightConstants constants; };

const float largest_ratio = 64.0;
const float few_steps = 4.0; // of either sum: less is rounding

void main() {
    const uint texel = gl_WorkGroupID.y * constants.row_length + gl_GlobalInvocationID.x;
    if (gl_GlobalInvocationID.x >= constants.row_length || texel >= constants.texels)
        return;
    const vec3 own = vec3(texelFetch(own_sums, int(texel)).rgb), refined = vec3(texelFetch(refined_sums, int(texel)).rgb);
    const float rounding = few_steps * max(constants.own_steps, 1.0);
    const vec3 ratio = min((refined * constants.own_steps + rounding) / (own + rounding), largest_ratio);
    ratios[texel] = uvec2(packHalf2x16(ratio.rg), packHalf2x16(vec2(ratio.b, 0.0)));
}
