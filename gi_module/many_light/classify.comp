#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Light culling: merges the visibility rows of a pixel group's nodes into its two light lists for one batch of samples.
// One invocation per group, so that the lists are in the order of samples on every device.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/transport/light_row_shared.h"
#include "gi_module/visibility/surface_lookup_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint indirect = 0;   // 1: the number of pixel groups is in the commands
layout(constant_id = 1) const uint light_maps = 1; // this class of samples is in the light maps
layout(constant_id = 2) const uint visibility = 1; // 0: every sample is tested everywhere
layout(constant_id = 3) const uint phase = phase_plain;
layout(constant_id = 4) const uint first_batch = 1; // the first batch that lights the pixels
layout(constant_id = 5) const uint light_class = light_class_surface;

layout(set = 0, binding = 0) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 1) readonly buffer NodeOfEntry { uint entry_nodes[]; };
layout(set = 0, binding = 2) readonly buffer Nodes { NodeRow node_rows[]; };
layout(set = 0, binding = 3) readonly buffer Rows { uint rows[]; };
layout(set = 0, binding = 4) writeonly buffer Slots { uint entry_local_nodes[]; };
layout(set = 0, binding = 5) writeonly buffer Entries { uint light_list[]; };
layout(set = 0, binding = 6) writeonly buffer Counts { LightListCounts counts[]; };
layout(set = 0, binding = 7) readonly buffer Commands { uint commands[]; };
layout(set = 0, binding = 8) writeonly buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 9) readonly buffer RoughEntries { uint rough_entries[]; };
layout(set = 0, binding = 10) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 11) uniform sampler2D depth_image;
layout(set = 0, binding = 12) uniform usampler2D normals_image;
layout(set = 0, binding = 13) uniform Lights { LightRow light_rows[lights_per_batch]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

#include "gi_module/many_light/group_bounds.glsl"

vec3 normal_at(ivec2 pixel) { return unpack_normal(texelFetch(normals_image, pixel, 0).r); }

ivec2 pixel_of(uint entry) { return ivec2(pixels[entry] & 0xffffu, pixels[entry] >> 16); }

// The cone about the mean of all normals, whose sum is in bounds.axis.
void find_cone(uint group, inout PixelGroupBounds bounds) {
    const float size = length(bounds.axis);
    bounds.axis /= max(size, 1e-6);
    bounds.cosine = size > 0.0 ? 1.0 : -1.0;
    for (uint i = 0; i < pixel_group_size; ++i) {
        const uint entry = rough_entries[group * pixel_group_size + i];
        if (entry != no_pixel)
            bounds.cosine = min(bounds.cosine, dot(bounds.axis, normal_at(pixel_of(entry))));
    }
}

void main() {
    const uint group = gl_GlobalInvocationID.x;
    const uint group_count = indirect != 0 ? commands[command_totals + 2u] : constants.group_count;
    if (group >= group_count)
        return;
    uint group_nodes[other_nodes]; // by local node, including node_normal_differs
    [[unroll]] for (uint s = 0; s < other_nodes; ++s)
        group_nodes[s] = no_node;
    bool any_pixel = false, any_node = false;
    PixelGroupBounds bounds = no_bounds();
    for (uint i = 0; i < pixel_group_size; ++i) {
        const uint place = group * pixel_group_size + i;
        uint entry = place;
        if (phase == phase_rough)
            entry = rough_entries[place];
        bool exists = entry != no_pixel;
        entry = exists ? entry : 0u;
        exists = exists && (pixels[entry] & unlit_pixel) == 0u;
        uint node = exists ? entry_nodes[entry] : no_node;
        node = node == no_node ? no_node : node & ~node_baked;
        uint local_node = other_nodes;
        if (exists && node != no_node && visibility != 0) {
            [[unroll]] for (uint s = 0; s < other_nodes; ++s) {
                if (local_node == other_nodes && (group_nodes[s] == node || group_nodes[s] == no_node)) {
                    group_nodes[s] = node;
                    local_node = s;
                }
            }
        }
        any_pixel = any_pixel || exists;
        if (phase == phase_rough && exists) {
            const ivec2 pixel = pixel_of(entry);
            const vec3 position = camera_position_at(camera, vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).r);
            bounds.low = min(bounds.low, position);
            bounds.high = max(bounds.high, position);
            bounds.axis += normal_at(pixel);
        }
        any_node = any_node || (exists && local_node == other_nodes);
        entry_local_nodes[place] = local_node | (node != no_node && (node & node_mask) >= constants.first_mover ? entry_on_mover : 0u);
        // Pixels that are on no local node of their own are lit from zero, without their light map.
        if (local_node == other_nodes && first_batch != 0u && exists)
            sums[entry] = vec4(0.0, 0.0, 0.0, 1.0);
    }
    if (phase == phase_rough)
        find_cone(group, bounds);
    bool mapped[other_nodes];
    [[unroll]] for (uint s = 0; s < other_nodes; ++s)
        mapped[s] = light_maps != 0 && group_nodes[s] != no_node && (group_nodes[s] & node_normal_differs) == 0u && node_rows[min(group_nodes[s], constants.node_count - 1u)].first_texel != no_light_map;

    const uint first = group * constants.list_stride;
    uint tested = 0u, untested = 0u;
    const uint end = any_pixel ? constants.batch_first + constants.batch_count : constants.batch_first;
    for (uint word = constants.batch_first / pairs_per_word; word * pairs_per_word < end; ++word) {
        // Two bits per sample; the results use the lower bit of each pair.
        uint partial[other_nodes], none[other_nodes];
        uint any_partial = any_node ? 0x55555555u : 0u, any_free = 0u;
        [[unroll]] for (uint s = 0; s < other_nodes; ++s) {
            partial[s] = none[s] = 0u;
            if (group_nodes[s] != no_node) {
                const uint states = rows[(group_nodes[s] & node_mask) * constants.words_per_row + word];
                const uint low = states & 0x55555555u, high = (states >> 1) & 0x55555555u;
                partial[s] = high & ~low;
                none[s] = low & ~high;
                any_partial |= partial[s];
                if (!mapped[s])
                    any_free |= none[s];
            }
        }
        if ((any_partial | any_free) == 0u)
            continue;
        for (uint k = 0; k < pairs_per_word; ++k) {
            const uint sample_index = word * pairs_per_word + k;
            const uint bit = 1u << (2u * k);
            if (((any_partial | any_free) & bit) == 0u || sample_index < constants.batch_first || sample_index >= end)
                continue;
            uint tests = 1u << other_nodes, values = 0u;
            [[unroll]] for (uint s = 0; s < other_nodes; ++s) {
                const bool is_partial = (partial[s] & bit) != 0u;
                tests |= is_partial ? 1u << s : 0u;
                values |= (mapped[s] ? is_partial : (none[s] & bit) != 0u) ? 1u << s : 0u;
            }
            const uint in_batch = sample_index - constants.batch_first;
            if (phase == phase_rough && !may_light(light_rows[in_batch], bounds))
                continue;
            const uint element = in_batch | (values << list_values_shift) | (tests << list_tests_shift);
            if ((any_partial & bit) != 0u)
                light_list[first + tested++] = element;
            else
                light_list[first + constants.list_stride - 1u - untested++] = element;
        }
    }
    counts[group] = LightListCounts(tested, untested);
}
