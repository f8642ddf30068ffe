#version 460
#extension GL_GOOGLE_include_directive : require
// Adds to texels of refined light what they take of other texels' light (nearby_light.h).
#include "engine/core/shared_exponent.h"
#include "gi_module/many_light/nearby_light_shared.h"

layout(local_size_x = 64) in;
layout(set = 0, binding = 0) readonly buffer Rows { NearbyRow rows[]; };
layout(set = 0, binding = 1) readonly buffer Entries { NearbyEntry entries[]; };
layout(set = 0, binding = 2) uniform isamplerBuffer light; // sums of the round before, in steps
layout(set = 0, binding = 3) buffer Sums { ivec4 sums[]; };
layout(push_constant) uniform Constants { NearbyLightConstants constants; };

const float most_steps = 2e9;

void main() {
    const uint number = gl_WorkGroupID.y * constants.row_length + gl_GlobalInvocationID.x;
    if (gl_GlobalInvocationID.x >= constants.row_length || number >= constants.rows)
        return;
    const NearbyRow row = rows[number];
    vec3 nearby = unpack_shared_exponent(row.constant) * constant_steps;
    for (uint i = 0u; i < row.entries; ++i) {
        const NearbyEntry entry = entries[row.first_entry + i];
        nearby += unpack_shared_exponent(entry.weight) * vec3(texelFetch(light, int(entry.texel)).rgb);
    }
    const vec3 sum = min(vec3(sums[row.texel].rgb) + nearby, vec3(most_steps));
    sums[row.texel] = ivec4(ivec3(sum + 0.5), 0);
}
