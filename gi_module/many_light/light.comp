#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Lights the pixels of a pixel group from its light lists: samples (VPLs) that need a shadow test, then those that do
// not. As in brute_force.comp, an invocation on a CPU lights several pixels, which share each sample's loads.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/transport/light_row_shared.h"

layout(constant_id = 0) const uint pixels_per_invocation = 8;
layout(constant_id = 1) const uint light_class = light_class_surface;
layout(constant_id = 2) const uint maps = maps_texel_buffer;
layout(constant_id = 3) const uint filtered = 0;
layout(constant_id = 4) const uint map_bits = 16;
layout(constant_id = 5) const uint to_image = 0; // 1: the sums go to the full picture
layout(constant_id = 6) const uint lanes = 8;
layout(local_size_x_id = 6) in;
layout(constant_id = 7) const uint stale_maps = 0;
layout(constant_id = 8) const uint phase = phase_plain;
layout(constant_id = 9) const uint simplified_movers = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { LightRow light_rows[lights_per_batch]; };
layout(set = 0, binding = 4) uniform usamplerBuffer map_words;
layout(set = 0, binding = 5) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 6) readonly buffer Slots { uint entry_local_nodes[]; };
layout(set = 0, binding = 7) readonly buffer Entries { uint light_list[]; };
layout(set = 0, binding = 8) readonly buffer Counts { LightListCounts counts[]; };
layout(set = 0, binding = 9) buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 10) writeonly uniform image2D output_image;
layout(set = 0, binding = 11) uniform usamplerBuffer static_map_words;
layout(set = 0, binding = 12) readonly buffer RoughEntries { uint rough_entries[]; };
layout(set = 0, binding = 13) readonly buffer Ratios { uvec2 ratios[]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

#include "gi_module/shadows/map_words.glsl"

float map_side() { return float(constants.map_resolution); }
bool use_static_maps = false; // a constant wherever a map is read, so that it is folded
float map_value(uint slot, ivec2 texel) {
    const int side = int(constants.map_resolution);
    const int place = (int(slot) * side + texel.y) * side + texel.x;
    const int word = map_word(place);
    return value_in_word(use_static_maps ? texelFetch(static_map_words, word).r : texelFetch(map_words, word).r, place);
}
#include "gi_module/shadows/shadowed_light.glsl"

// Fraction of a sample's light that movers block from a pixel, in addition to static geometry.
float mover_occlusion(LightRow light, Pixel pixel, float visibility) {
    use_static_maps = true;
    const float before = map_visibility(light, pixel);
    use_static_maps = false;
    return max(before - visibility, 0.0);
}

// Whether the samples' light is scaled by pixel (refined_light.h). Not a kernel of its own: that would be compiled in the
// middle of a game.
bool is_refined() { return phase != phase_plain && constants.refined_share > 0.0; }

void main() {
    const uint group = gl_WorkGroupID.x;
    const LightListCounts count = counts[group];
    if (to_image == 0 && count.tested + count.untested == 0u)
        return; // nothing to add
    Pixel surface[pixels_per_invocation];
    vec4 sum[pixels_per_invocation];
    uint local_node[pixels_per_invocation], entry_of[pixels_per_invocation];
    ivec2 place[pixels_per_invocation];
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint i = group * pixel_group_size + k * lanes + gl_LocalInvocationID.x;
        entry_of[k] = i;
        if (phase == phase_rough)
            entry_of[k] = rough_entries[i];
        const uint entry = entry_of[k] != no_pixel ? entry_of[k] : 0u;
        const uint packed = pixels[entry];
        place[k] = packed != no_pixel ? ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16) : ivec2(-1);
        const ivec2 inside = max(place[k], ivec2(0));
        const float depth = texelFetch(depth_image, inside, 0).r;
        const uvec2 normals = texelFetch(normals_image, inside, 0).rg;
        surface[k].position = camera_position_at(camera, vec2(inside) + 0.5, max(depth, 1e-7));
        surface[k].normal = unpack_normal(normals.x);
        surface[k].geometric_normal = unpack_normal(normals.y);
        local_node[k] = entry_local_nodes[i] & (entry_on_mover - 1u);
        surface[k].on_mover = (entry_local_nodes[i] & entry_on_mover) != 0u ? 1.0 : 0.0;
        if (phase == phase_baked && (entry_local_nodes[i] & entry_is_baked) == 0u)
            surface[k].normal = vec3(0.0); // so that no sample lights it
        sum[k] = is_refined() ? vec4(0.0) : sums[entry];
    }
    // Loops are tested at their ends: a CPU device runs the body of others once more than they ask for.
    const uint first = group * constants.list_stride;
    uint i = 0u;
    if (count.tested > 0u) do {
        const uint element = light_list[first + i];
        const LightRow light = light_rows[element & list_sample_mask];
        [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
            const LightFactor factor = light_factor(light, surface[k], true);
            if (phase == phase_baked) {
                sum[k].rgb -= light.intensity_slot.rgb * (factor.unshadowed * mover_occlusion(light, surface[k], factor.visibility));
            } else {
                const float value = float((element >> (local_node[k] + list_values_shift)) & 1u);
                const bool tests = ((element >> (local_node[k] + list_tests_shift)) & 1u) != 0u;
                sum[k].rgb += light.intensity_slot.rgb * (factor.unshadowed * (tests ? factor.visibility - value : value));
            }
        }
    } while (++i < count.tested);
    const uint last = first + constants.list_stride - 1u;
    i = 0u;
    if (count.untested > 0u) do {
        const uint element = light_list[last - i];
        const LightRow light = light_rows[element & list_sample_mask];
        [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
            if (phase == phase_baked) { // static geometry does not block it
                const LightFactor factor = light_factor(light, surface[k], true);
                sum[k].rgb -= light.intensity_slot.rgb * (factor.unshadowed * (1.0 - factor.visibility));
            } else {
                const float value = float((element >> (local_node[k] + list_values_shift)) & 1u);
                sum[k].rgb += light.intensity_slot.rgb * (unshadowed_factor(light, surface[k]).unshadowed * value);
            }
        }
    } while (++i < count.untested);
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        if (is_refined()) {
            const uint entry = entry_of[k] != no_pixel ? entry_of[k] : 0u;
            const uvec2 ratio = ratios[entry];
            sum[k] = sums[entry] + vec4(sum[k].rgb * vec3(unpackHalf2x16(ratio.x), unpackHalf2x16(ratio.y).x), 0.0);
        }
        // Slightly more may be subtracted than the interpolated light map holds: never below zero.
        if (to_image != 0) {
            if (place[k].x >= 0)
                imageStore(output_image, place[k], sum[k].a > 0.0 ? vec4(max(sum[k].rgb, vec3(0.0)), 1.0) : vec4(0.0));
        } else if (entry_of[k] != no_pixel) {
            sums[entry_of[k]] = sum[k];
        }
    }
}
