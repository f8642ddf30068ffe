#version 460
#extension GL_GOOGLE_include_directive : require
// What shines in a block of pixels, as their mean: emitting surfaces and the sky, without what they light.
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint textured_emission = 0;
layout(constant_id = 1) const uint sky_has_picture = 0;
layout(set = 0, binding = 0) uniform usampler2D surface_image;
layout(set = 0, binding = 1) uniform sampler2D emission_image;
layout(set = 0, binding = 2) uniform sampler2D sky_image;
layout(set = 0, binding = 3) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 4) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 5) writeonly uniform image2D target;
layout(push_constant) uniform Constants { CompositionConstants constants; };

#include "engine/render/sky_radiance.glsl"

vec3 shining(ivec2 pixel, uint surface) {
    return textured_emission != 0 ? texelFetch(emission_image, pixel, 0).rgb : rows[surface_row(surface)].emission.rgb;
}

void main() {
    const ivec2 block = ivec2(gl_GlobalInvocationID.xy), size = ivec2(constants.width, constants.height);
    const ivec2 first = block * int(glare_block);
    if (any(greaterThanEqual(first, size)))
        return;
    const ivec2 end = min(first + int(glare_block), size);
    vec3 sum = vec3(0.0);
    float sky_pixels = 0.0;
    for (int y = first.y; y < end.y; ++y)
        for (int x = first.x; x < end.x; ++x) {
            const uint surface = texelFetch(surface_image, ivec2(x, y), 0).r;
            if (surface == 0u)
                sky_pixels += 1.0;
            if ((surface & (surface_emits | surface_unlit)) == surface_emits)
                sum += shining(ivec2(x, y), surface);
        }
    // A sky is nearly the same all over a block: one look-up, in its middle.
    if (sky_pixels > 0.0)
        sum += sky_pixels * sky_radiance(0.5 * vec2(first + end));
    const ivec2 pixels = end - first;
    imageStore(target, block, vec4(min(sum / float(pixels.x * pixels.y), vec3(60000.0)), 1.0));
}
