#version 460
#extension GL_GOOGLE_include_directive : require
// What is drawn at a share of the pixels, as if it were blended: the mean of a square in which each threshold of the
// pattern (g_buffer_textured.frag) occurs once, over the surface itself and what lies behind it.
#include "engine/scene/instance_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(set = 0, binding = 0) uniform sampler2D picture;
layout(set = 0, binding = 1) uniform usampler2D surface_image;
layout(set = 0, binding = 2) uniform sampler2D depth_image;
layout(set = 0, binding = 3) writeonly uniform image2D target; // the rectangle, at its corner
layout(push_constant) uniform Constants {
    ivec2 corner, size; // of the rectangle
} constants;

const int side = 4;

bool is_stippled(ivec2 pixel) { return (texelFetch(surface_image, pixel, 0).r & surface_stippled) != 0u; }

void main() {
    const ivec2 inside = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(inside, constants.size)))
        return;
    const ivec2 pixel = constants.corner + inside;
    const ivec2 first = pixel - side / 2 + 1, last = textureSize(picture, 0) - 1;
    float nearest = 0.0; // of the stippled surface; depth is reversed
    for (int i = 0; i < side * side; ++i) {
        const ivec2 place = clamp(first + ivec2(i % side, i / side), ivec2(0), last);
        if (is_stippled(place))
            nearest = max(nearest, texelFetch(depth_image, place, 0).r);
    }
    vec4 result = texelFetch(picture, pixel, 0);
    if (nearest > 0.0 && (is_stippled(pixel) || texelFetch(depth_image, pixel, 0).r < nearest)) {
        vec4 sum = vec4(0.0);
        float behind = 0.0, count = 0.0;
        for (int i = 0; i < side * side; ++i) {
            const ivec2 place = clamp(first + ivec2(i % side, i / side), ivec2(0), last);
            const bool stippled = is_stippled(place);
            if (!stippled && texelFetch(depth_image, place, 0).r >= nearest)
                continue;
            const vec4 colour = texelFetch(picture, place, 0);
            sum += colour * colour; // about linear, as light adds up
            count += 1.0;
            behind += stippled ? 0.0 : 1.0;
        }
        // Where it lets nothing through, it is as sharp as any surface.
        if (behind > 0.0)
            result = sqrt(sum / count);
    }
    imageStore(target, inside, result);
}
