#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Adds the light of a batch of pixel lights (eq. 2 of the paper) to the sums of a stage's pixels. As in the other kernels
// of the kind, an invocation on a CPU lights several pixels, which share each light's loads.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(constant_id = 0) const uint pixels_per_invocation = 8;
layout(constant_id = 1) const uint lanes = 8;
layout(local_size_x_id = 1) in;
layout(constant_id = 2) const uint to_image = 0; // 1: the sums go to the full picture

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { PixelLightRow lights[splats_per_batch]; };
layout(set = 0, binding = 4) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 5) readonly buffer Masks { uint masks[]; };
layout(set = 0, binding = 6) buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 7) writeonly uniform image2D output_image;
layout(push_constant) uniform Constants { SplattingConstants constants; };

const uint light_class = light_class_surface, maps = 0, filtered = 0, map_bits = 16, stale_maps = 0, simplified_movers = 0;
float map_side() { return 1.0; }
float map_value(uint slot, ivec2 texel) { return 0.0; }
#include "gi_module/shadows/shadowed_light.glsl"

void main() {
    const uint group = gl_WorkGroupID.x;
    uint any = 0u;
    for (uint word = 0; word < splat_mask_words; ++word)
        any |= masks[group * splat_mask_words + word];
    if (to_image == 0 && any == 0u)
        return; // nothing to add
    Pixel surface[pixels_per_invocation];
    vec3 sum[pixels_per_invocation];
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint entry = group * pixel_group_size + k * lanes + gl_LocalInvocationID.x;
        const uint packed = pixels[entry];
        const ivec2 inside = packed == no_pixel ? ivec2(0) : ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
        const float depth = texelFetch(depth_image, inside, 0).r;
        const uvec2 normals = texelFetch(normals_image, inside, 0).rg;
        surface[k].position = camera_position_at(camera, vec2(inside) + 0.5, max(depth, 1e-7));
        surface[k].normal = unpack_normal(normals.x);
        surface[k].geometric_normal = unpack_normal(normals.y);
        surface[k].on_mover = 0.0;
        sum[k] = vec3(0.0);
    }
    for (uint word = 0; word < splat_mask_words; ++word) {
        uint mask = masks[group * splat_mask_words + word];
        while (mask != 0u) {
            const PixelLightRow light = lights[word * 32u + uint(findLSB(mask))];
            mask &= mask - 1u;
            [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k)
                sum[k] += light.row.intensity_slot.rgb * light_factor(light.row, surface[k], false).unshadowed;
        }
    }
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint entry = group * pixel_group_size + k * lanes + gl_LocalInvocationID.x;
        const uint packed = pixels[entry];
        const bool lit = (packed & unlit_pixel) == 0u;
        const vec4 total = sums[entry] + vec4(lit ? sum[k] : vec3(0.0), 0.0);
        if (to_image == 0) {
            sums[entry] = total;
        } else if (packed != no_pixel) {
            const ivec2 pixel = ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
            imageStore(output_image, pixel, vec4(lit ? max(total.rgb, vec3(0.0)) : vec3(0.0), lit ? 1.0 : 0.0));
        }
    }
}
