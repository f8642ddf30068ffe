#version 460
#extension GL_GOOGLE_include_directive : require
// Texels that hardly any of the frame's samples reaches, such as those of a corner behind a pillar: as no ratio to nothing
// gives light, theirs is that to the texel of which they take most (nearby_light.h).
#include "gi_module/many_light/nearby_light_shared.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Rows { NearbyRow rows[]; };
layout(set = 0, binding = 1) readonly buffer Entries { NearbyEntry entries[]; };
layout(set = 0, binding = 2) uniform isamplerBuffer own_sums;
layout(set = 0, binding = 3) uniform isamplerBuffer refined_sums;
layout(set = 0, binding = 4) writeonly buffer Refined { uvec2 refined_texels[]; };
layout(push_constant) uniform Constants { NearbyLightConstants constants; };

#include "gi_module/many_light/refined_texel.glsl"

const float most_of_own = 8.0; // a larger ratio says that the texel's own samples are too few

float brightness(vec3 light) { return light.r + light.g + light.b; }

void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_GlobalInvocationID.x;
    if (gl_GlobalInvocationID.x >= constants.row_length || number >= constants.rows)
        return;
    const NearbyRow row = rows[number];
    const ivec3 refined = texelFetch(refined_sums, int(row.texel)).rgb;
    const float wanted = brightness(vec3(refined)) * constants.own_steps / most_of_own;
    if (brightness(vec3(texelFetch(own_sums, int(row.texel)).rgb)) >= wanted)
        return;
    float most = 0.0;
    uint source = row.texel;
    ivec3 own = ivec3(0);
    for (uint i = 0u; i < row.entries; ++i) {
        const NearbyEntry entry = entries[row.first_entry + i];
        const ivec3 there = texelFetch(own_sums, int(entry.texel)).rgb;
        const float taken = brightness(unpack_shared_exponent(entry.weight) * vec3(there));
        if (taken <= most || brightness(vec3(there)) < wanted)
            continue;
        most = taken;
        source = entry.texel;
        own = there;
    }
    if (most > 0.0)
        refined_texels[row.texel] = refined_texel(own, refined, constants.own_steps, source);
}
