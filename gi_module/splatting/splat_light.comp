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
layout(constant_id = 3) const uint maps = 0;     // maps_none or maps_texel_buffer
layout(constant_id = 4) const uint filtered = 0;
layout(constant_id = 5) const uint glossy = 0; // the batch's lights have lobes; 2: or are beams
layout(constant_id = 6) const uint show = show_no_splats;
layout(constant_id = 7) const uint lists = 1; // 0: all lights of the batch reach all pixels
layout(constant_id = 8) const uint nodes = 0; // 1: groups have nodes and points, with the rest of all batches' light
layout(constant_id = 9) const uint blocks = 0; // 1: each block of a group has a list

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { PixelLightRow lights[splats_per_batch]; };
layout(set = 0, binding = 4) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 5) readonly buffer Masks { uint masks[]; };
layout(set = 0, binding = 6) buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 7) writeonly uniform image2D output_image;
layout(set = 0, binding = 8) uniform samplerBuffer map_texels;
layout(set = 0, binding = 9) readonly buffer Points { vec4 point_light[]; };
layout(set = 0, binding = 10) readonly buffer Patches { GroupPatches groups[]; };
layout(set = 0, binding = 11) readonly buffer Places { uint places[]; };
layout(set = 0, binding = 12) readonly buffer Blocks { uint block_masks[]; };
layout(push_constant) uniform Constants { SplattingConstants constants; };

const uint light_class = light_class_surface, map_bits = 16, stale_maps = 0, simplified_movers = 0;
float map_side() { return float(constants.map_side); }
float map_value(uint slot, ivec2 texel) {
    const int side = int(constants.map_side);
    return texelFetch(map_texels, (int(slot) * side + texel.y) * side + texel.x).r;
}
#include "gi_module/shadows/shadowed_light.glsl"

#include "gi_module/splatting/splat_factor.glsl"

// Eq. 3, as a factor of the intensity on the lobe's axis, with the lobe wider near the light, and clamped as diffuse ones.
float lobe_factor(PixelLightRow light, Pixel pixel) {
    const vec3 v = pixel.position - light.row.position_bound.xyz, normal = light.row.normal_offset.xyz;
    const float squared = max(dot(v, v), 1e-12), distance = sqrt(squared);
    const vec3 direction = v / distance;
    const bool faces = dot(pixel.geometric_normal, v) < 0.0 && dot(normal, v) > 0.0;
    const float cosine = faces ? max(-dot(pixel.normal, direction), 0.0) : 0.0;
    if (glossy == 2 && light.beam0.w > 0.0)
        return beam_density(light.lobe.xyz, light.beam0, light.beam1, light.beam2, v) * cosine * light.beam0.w;
    const float exponent = light.lobe.w, widened = widened_exponent(exponent, distance, light.extent.x);
    float factor = power_of_cosine(light.lobe.xyz, direction, widened) * cosine / squared;
    if (widened != exponent) {
        const float tilt = dot(light.lobe.xyz, normal);
        factor *= lobe_norm(widened, tilt) * light.beam1.w;
    }
    return min(factor, light.row.position_bound.w);
}

vec3 shown(vec3 total) {
    if (show == show_overdraw)
        return total / most_overdraw;
    if (show == show_splat_occlusion)
        return vec3(total.g > 0.0 ? total.r / total.g : 0.0);
    return max(total, vec3(shows_places(show) ? 0.04 : 0.0));
}

// Which of 32 lights of the batch to evaluate.
uint lights_of(uint group, uint word) {
    if (lists != 0)
        return masks[group * splat_mask_words + word];
    const uint left = constants.light_count - min(word * 32u, constants.light_count);
    return left >= 32u ? 0xffffffffu : (1u << left) - 1u;
}

// What the nodes of its patch, or its point, give a pixel.
vec3 interpolated(uint group, uint entry) {
    const uint place = places[entry] & ((1u << place_bits) - 1u), first = group * pixel_group_size, nodes_each = groups[group].nodes;
    if (place >= group_patches)
        return point_light[first + groups[group].patches * nodes_each + place - group_patches].rgb;
    const uvec2 own = uvec2(entry % pixel_group_side, entry % pixel_group_size / pixel_group_side);
    const vec2 at = groups[group].curved != 0u ? vec2(own) / 3.5 - 1.0 : (vec2(own) + 0.5) * (2.0 / float(pixel_group_side)) - 1.0;
    vec3 sum = vec3(0.0);
    [[unroll]] for (uint node = 0; node < tile_nodes; ++node) {
        const float weight = nodes_each == tile_nodes ? node_weight(node, at) : node < corner_nodes ? corner_weight(node, at) : 0.0;
        if (node < nodes_each)
            sum += weight * point_light[first + place * nodes_each + node].rgb;
    }
    return max(sum, vec3(0.0));
}

// Of an invocation's pixel: which of its group's, row after row or block after block.
uint entry_of(uint k) {
    const uint i = k * lanes + gl_LocalInvocationID.x;
    return blocks != 0 ? splat_block_entry(i / splat_block_pixels, i % splat_block_pixels) : i;
}

vec3 light_of(PixelLightRow light, Pixel pixel) {
    LightFactor factor = light_factor(light.row, pixel, true);
    factor.unshadowed = glossy != 0 ? lobe_factor(light, pixel) : softened_factor(light, pixel);
    return contribution(light.row, factor, pixel);
}

// By the list of its block. (A CPU's lanes go through a loop once more than it says, unless it ends at its foot.)
vec3 light_of_block(uint block, Pixel pixel) {
    vec3 sum = vec3(0.0);
    uint words = block_masks[block * splat_block_words];
    if (words != 0u)
        do {
            const uint word = uint(findLSB(words));
            words &= words - 1u;
            uint mask = block_masks[block * splat_block_words + 1u + word];
            do {
                sum += light_of(lights[word * 32u + uint(findLSB(mask))], pixel);
                mask &= mask - 1u;
            } while (mask != 0u);
        } while (words != 0u);
    return sum;
}

void main() {
    const uint group = gl_WorkGroupID.x;
    uint any = 0u;
    for (uint word = 0; word < splat_mask_words; ++word)
        any |= lights_of(group, word);
    if (to_image == 0 && nodes == 0 && any == 0u)
        return; // nothing to add
    Pixel surface[pixels_per_invocation];
    vec3 sum[pixels_per_invocation];
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint packed = pixels[group * pixel_group_size + entry_of(k)];
        const ivec2 inside = packed == no_pixel ? ivec2(0) : ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
        const float depth = texelFetch(depth_image, inside, 0).r;
        const uvec2 normals = texelFetch(normals_image, inside, 0).rg;
        surface[k].position = camera_position_at(camera, vec2(inside) + 0.5, max(depth, 1e-7));
        surface[k].normal = unpack_normal(normals.x);
        surface[k].geometric_normal = unpack_normal(normals.y);
        surface[k].on_mover = 0.0;
        sum[k] = vec3(0.0);
    }
    if (blocks != 0) {
        [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k)
            sum[k] = light_of_block(group * splat_blocks + (k * lanes + gl_LocalInvocationID.x) / splat_block_pixels, surface[k]);
    }
    for (uint word = 0; blocks == 0 && word < splat_mask_words; ++word) {
        uint mask = lights_of(group, word);
        while (mask != 0u) {
            const PixelLightRow light = lights[word * 32u + uint(findLSB(mask))];
            mask &= mask - 1u;
            [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k)
                sum[k] += light_of(light, surface[k]);
        }
    }
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint entry = group * pixel_group_size + entry_of(k);
        const uint packed = pixels[entry];
        const bool lit = (packed & unlit_pixel) == 0u;
        if (nodes != 0 && groups[group].patches + groups[group].points > 0u)
            sum[k] += interpolated(group, entry);
        const vec4 total = sums[entry] + vec4(lit ? sum[k] : vec3(0.0), 0.0);
        if (to_image == 0) {
            sums[entry] = total;
        } else if (packed != no_pixel) {
            const ivec2 pixel = ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
            imageStore(output_image, pixel, vec4(lit ? shown(total.rgb) : vec3(0.0), lit ? 1.0 : 0.0));
        }
    }
}
