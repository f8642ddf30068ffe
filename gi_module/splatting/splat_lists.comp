#version 460
#extension GL_GOOGLE_include_directive : require
// Which pixel lights of a batch may reach a pixel group: the list of a tile, as a mask.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint counted = 0; // 1: the number of groups is known to the GPU alone
layout(constant_id = 1) const uint show = show_no_splats;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { PixelLightRow lights[splats_per_batch]; };
layout(set = 0, binding = 4) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 5) readonly buffer Commands { uint commands[]; };
layout(set = 0, binding = 6) writeonly buffer Masks { uint masks[]; };
layout(push_constant) uniform Constants { SplattingConstants constants; };

#include "gi_module/splatting/splat_reach.glsl"

GroupBounds bounds_of(uint group, out bool any) {
    GroupBounds bounds = GroupBounds(vec3(1e30), vec3(-1e30), vec3(1.0), vec3(-1.0));
    any = false;
    for (uint i = 0; i < pixel_group_size; ++i) {
        const uint packed = pixels[group * pixel_group_size + i];
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

void main() {
    const uint group = gl_GlobalInvocationID.x;
    const uint group_count = counted != 0 ? commands[command_totals + 2u] : constants.group_count;
    if (group >= group_count)
        return;
    bool any;
    const GroupBounds bounds = bounds_of(group, any);
    for (uint word = 0; word < splat_mask_words; ++word) {
        uint mask = 0u;
        const uint first = word * 32u, end = any ? min(first + 32u, constants.light_count) : first;
        for (uint i = first; i < end; ++i)
            mask |= shows_places(show) || may_reach(lights[i], bounds) ? 1u << (i - first) : 0u;
        masks[group * splat_mask_words + word] = mask;
    }
}
