#version 460
#extension GL_GOOGLE_include_directive : require
// Which pixel lights of a batch may reach a pixel group: the list of a tile, as a mask. A light is left out only if it
// gives none of the group's pixels any light: they are behind its surface or it behind theirs; or none above the
// threshold: they are outside of the ellipsoid that the paper bounds it by, or farther away than they face it.
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

// Boxes around the positions and the normals of a group's pixels.
struct GroupBounds {
    vec3 low, high;
    vec3 normal_low, normal_high;
};

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

const float angle_margin = 1e-3; // rad, more than what is lost in acos near 1

// The most that a light can give a receiver in a box, W/m2. `along`: greatest part of the way to it along the light's
// normal; `facing`: the same along the receivers' normals.
float most_irradiance(PixelLightRow light, vec3 centre, vec3 half_size, float along, float facing) {
    const float peak = max(max(light.row.intensity_slot.r, light.row.intensity_slot.g), light.row.intensity_slot.b);
    const vec3 gap = max(abs(centre) - half_size, vec3(0.0));
    const float squared = dot(gap, gap);
    if (light.lobe.w <= 1.0)
        return peak * softened_term(along, facing, squared, light.extent.x);
    const float distance = sqrt(squared), to_centre = length(centre), radius = length(half_size);
    if (distance <= 0.0 || to_centre <= radius)
        return 1e30; // beside the light
    // Where lobes widen: the widest of the box for the angle, the narrowest for the peak.
    const float exponent = light.lobe.w, tilt = dot(light.lobe.xyz, light.row.normal_offset.xyz);
    const float widest = widened_exponent(exponent, distance, light.extent.x);
    const float narrowest = widened_exponent(exponent, to_centre + radius, light.extent.x);
    const float peak_scale = narrowest < exponent ? lobe_norm(narrowest, tilt) / lobe_norm(exponent, tilt) : 1.0;
    const float angle = acos(clamp(dot(light.lobe.xyz, centre) / to_centre, -1.0, 1.0)) - asin(radius / to_centre) - angle_margin;
    const float cosine = max(cos(max(angle, 0.0)), 0.0);
    return peak * peak_scale * pow(cosine, widest) * min(facing / distance, 1.0) / squared;
}

bool may_reach(PixelLightRow light, GroupBounds bounds) {
    const vec3 position = light.row.position_bound.xyz, normal = light.row.normal_offset.xyz;
    const vec3 centre = 0.5 * (bounds.low + bounds.high) - position, half_size = 0.5 * (bounds.high - bounds.low);
    const float forward = dot(normal, centre) + dot(abs(normal), half_size);
    if (forward <= 0.0)
        return false;
    // The greatest scalar product of a normal and a way to the light.
    const vec3 near = position - bounds.low, far = position - bounds.high;
    const vec3 most = max(max(bounds.normal_low * near, bounds.normal_low * far),
                          max(bounds.normal_high * near, bounds.normal_high * far));
    const float facing = most.x + most.y + most.z;
    if (facing <= 0.0)
        return false;
    if (light.extent.y < 0.0)
        return true;
    if (most_irradiance(light, centre, half_size, forward, facing) < constants.least)
        return false;
    // Along the lobe's axis and across it, the point of the box's surroundings that is deepest in the ellipsoid.
    const float along = dot(light.lobe.xyz, centre), size = length(half_size);
    const float across = sqrt(max(dot(centre, centre) - along * along, 0.0));
    const vec2 outside = max(vec2(abs(along - light.extent.y) - dot(abs(light.lobe.xyz), half_size), across - size), 0.0) /
                         max(light.extent.zw, vec2(1e-12));
    return dot(outside, outside) <= 1.0;
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
