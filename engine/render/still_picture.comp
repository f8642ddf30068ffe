#version 460
#extension GL_EXT_control_flow_attributes : require
#extension GL_GOOGLE_include_directive : require
// A picture in which nothing changes: the mean of one round of samples, whatever was shown before
// (temporal_enlargement.h).
layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint shows = 0; // 1: the mean is shown; 0: a frame is added
layout(set = 0, binding = 0, rgba8) uniform readonly image2D source;
layout(set = 0, binding = 1, rgba32f) uniform image2D sums; // rgb: weighed display values; a: their weights
layout(set = 0, binding = 2) uniform writeonly image2D target;
layout(push_constant) uniform Constants {
    ivec2 source_size, target_size;
    vec2 offset;
    uint first; // frame of the round: what was summed before does not count
} constants;

#include "engine/render/temporal_samples.glsl"

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, constants.target_size)))
        return;
    if (shows != 0) {
        const vec4 sum = imageLoad(sums, pixel);
        imageStore(target, pixel, vec4(sum.rgb / sum.a, 1.0));
        return;
    }
    const vec2 scale = vec2(constants.source_size) / vec2(constants.target_size);
    const vec2 place = (vec2(pixel) + 0.5) * scale;
    const ivec2 middle = clamp(ivec2(place), ivec2(0), constants.source_size - 1);
    vec3 colour[9];
    [[unroll]] for (int i = 0; i < 9; ++i)
        colour[i] = imageLoad(source, clamp(middle + ivec2(i % 3, i / 3) - 1, ivec2(0), constants.source_size - 1)).rgb;
    const vec4 now = sample_near(colour, vec2(middle) + 0.5 + constants.offset - place, scale);
    const vec4 before = constants.first != 0u ? vec4(0.0) : imageLoad(sums, pixel);
    imageStore(sums, pixel, before + vec4(now.rgb * now.a, now.a));
}
