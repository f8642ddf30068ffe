#version 460
#extension GL_GOOGLE_include_directive : require
// Which pixel lights of a batch may reach a pixel group: the list of a tile, as a mask. And which of those may reach each
// block of its pixels.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint counted = 0; // 1: the number of groups is known to the GPU alone
layout(constant_id = 1) const uint show = show_no_splats;
layout(constant_id = 2) const uint of_blocks = 0; // 1: an invocation is a block, 0: a group

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { PixelLightRow lights[splats_per_batch]; };
layout(set = 0, binding = 4) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 5) readonly buffer Commands { uint commands[]; };
layout(set = 0, binding = 6) buffer Masks { uint masks[]; };
layout(set = 0, binding = 7) writeonly buffer Blocks { uint block_masks[]; };
layout(push_constant) uniform Constants { SplattingConstants constants; };

#include "gi_module/splatting/splat_reach.glsl"

// Of an invocation's pixels.
GroupBounds bounds_of(uint index, out bool any) {
    GroupBounds bounds = GroupBounds(vec3(1e30), vec3(-1e30), vec3(1.0), vec3(-1.0));
    any = false;
    const uint group = of_blocks != 0 ? index / splat_blocks : index;
    for (uint i = 0; i < (of_blocks != 0 ? splat_block_pixels : pixel_group_size); ++i) {
        const uint entry = of_blocks != 0 ? splat_block_entry(index % splat_blocks, i) : i;
        const uint packed = pixels[group * pixel_group_size + entry];
        if ((packed & unlit_pixel) != 0u)
            continue;
        any = true;
        const ivec2 pixel = ivec2(packed & 0xffffu, packed >> 16);
        const vec3 position = camera_position_at(camera, vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).r);
        const vec3 normal = unpack_normal(texelFetch(normals_image, pixel, 0).r);
        bounds.low = min(bounds.low, position);
        bounds.high = max(bounds.high, position);
        bounds.normal_low = min(bounds.normal_low, normal);
        bounds.normal_high = max(bounds.normal_high, normal);
    }
    return bounds;
}

// Of 32 lights, those of the batch, or of the group.
uint candidates(uint index, uint word) {
    if (of_blocks != 0)
        return masks[index / splat_blocks * splat_mask_words + word];
    const uint left = constants.light_count - min(word * 32u, constants.light_count);
    return left >= 32u ? 0xffffffffu : (1u << left) - 1u;
}

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (of_blocks == 0 && index >= (counted != 0 ? commands[command_totals + 2u] : constants.group_count))
        return;
    bool any;
    const GroupBounds bounds = bounds_of(index, any);
    uint words = 0u;
    for (uint word = 0; word < splat_mask_words; ++word) {
        uint left = any ? candidates(index, word) : 0u, mask = 0u;
        // A CPU's lanes go through a loop once more than it says, unless it ends at its foot.
        if (left != 0u)
            do {
                const uint bit = left & (~left + 1u);
                left ^= bit;
                mask |= shows_places(show) || may_reach(lights[word * 32u + uint(findLSB(bit))], bounds) ? bit : 0u;
            } while (left != 0u);
        words |= mask != 0u ? 1u << word : 0u;
        if (of_blocks != 0)
            block_masks[index * splat_block_words + 1u + word] = mask;
        else
            masks[index * splat_mask_words + word] = mask;
    }
    if (of_blocks != 0)
        block_masks[index * splat_block_words] = words;
}
