#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Light culling for a pixel group whose pixels use baked light: samples of one batch whose light meets a mover on its
// way to any of the group's nodes, and that a mover may shadow in the sphere around the pixels. Samples that static
// geometry may block, too, come first; the rest is filled in from the end. One invocation per group, as in
// classify.comp.
#include "engine/scene/camera_shared.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/transport/light_row_shared.h"
#include "gi_module/visibility/shadow_cone_shared.h"
#include "gi_module/visibility/surface_lookup_shared.h"

layout(local_size_x = 8) in;
layout(constant_id = 0) const uint indirect = 0; // 1: the number of pixel groups is in the commands

layout(set = 0, binding = 0) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 1) readonly buffer NodeOfEntry { uint entry_nodes[]; };
layout(set = 0, binding = 2) readonly buffer Rows { uint rows[]; };
layout(set = 0, binding = 3) buffer Slots { uint entry_local_nodes[]; };
layout(set = 0, binding = 4) writeonly buffer Entries { uint light_list[]; };
layout(set = 0, binding = 5) writeonly buffer Counts { LightListCounts counts[]; };
layout(set = 0, binding = 6) readonly buffer Commands { uint commands[]; };
layout(set = 0, binding = 7) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 8) uniform sampler2D depth_image;
layout(set = 0, binding = 9) uniform Lights { LightRow light_rows[lights_per_batch]; };
layout(set = 0, binding = 10) readonly buffer Movers { vec4 movers[]; }; // bounding spheres of those that cast shadows
layout(push_constant) uniform Constants { ManyLightConstants constants; };

// If the pixels are on more nodes, every sample is put on the list: conservative, only slower.
const uint max_nodes = 16u;
const uint max_words = lights_per_batch / 32u + 1u;

// Whether a mover, where it is or where the sample's stale map may still show it, may shadow any of the group's pixels.
bool may_be_shadowed(LightRow light, vec3 centre, float radius) {
    bool found = constants.mover_count > max_culled_movers;
    for (uint i = 0; i < constants.mover_count && !found; ++i)
        found = shadow_cone_distance(light.position_bound.xyz, centre, radius, movers[i].xyz) <= movers[i].w + light.bitangent.w;
    return found;
}

void main() {
    const uint group = gl_GlobalInvocationID.x;
    const uint group_count = indirect != 0 ? commands[command_totals + 2u] : constants.group_count;
    if (group >= group_count)
        return;
    uint nodes[max_nodes];
    uint node_count = 0u, last = no_node;
    bool more = false;
    for (uint i = 0; i < pixel_group_size; ++i) {
        const uint entry = group * pixel_group_size + i;
        const uint node = (pixels[entry] & unlit_pixel) == 0u ? entry_nodes[entry] : no_node;
        const bool is_baked = node != no_node && (node & node_baked) != 0u;
        entry_local_nodes[entry] = is_baked ? entry_is_baked : 0u;
        if (!is_baked || node == last)
            continue;
        last = node;
        bool known = false;
        for (uint k = 0; k < node_count; ++k)
            known = known || nodes[k] == (node & node_mask);
        if (!known && node_count < max_nodes)
            nodes[node_count++] = node & node_mask;
        else
            more = more || !known;
    }
    const uint end = constants.batch_first + constants.batch_count;
    const uint first_word = constants.batch_first / 32u;
    uint meets[max_words], blocked[max_words];
    bool any_meets = false;
    for (uint i = 0; i < max_words; ++i) {
        const uint word = first_word + i;
        meets[i] = blocked[i] = more && word * 32u < end ? 0xffffffffu : 0u;
        for (uint k = 0; k < node_count && word * 32u < end; ++k) {
            const uint flags = nodes[k] * constants.words_per_row + constants.state_words + word;
            meets[i] |= rows[flags];
            blocked[i] |= rows[flags + constants.flag_words];
        }
        any_meets = any_meets || meets[i] != 0u;
    }
    vec3 low = vec3(1e30), high = vec3(-1e30);
    for (uint i = 0; i < (any_meets ? pixel_group_size : 0u); ++i) {
        const uint entry = group * pixel_group_size + i;
        if (entry_local_nodes[entry] != entry_is_baked)
            continue;
        const ivec2 pixel = ivec2(pixels[entry] & 0xffffu, pixels[entry] >> 16);
        const vec3 position = camera_position_at(camera, vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).r);
        low = min(low, position);
        high = max(high, position);
    }
    const vec3 centre = 0.5 * (low + high);
    const float radius = 0.5 * length(high - low) * 1.0001 + 1e-4;
    const uint first = group * constants.list_stride;
    uint tested = 0u, untested = 0u;
    for (uint i = 0; i < (any_meets ? max_words : 0u); ++i) {
        uint left = meets[i];
        if (left != 0u) do { // tested at its end: see light.comp
            const uint bit = uint(findLSB(left));
            const uint sample_index = (first_word + i) * 32u + bit;
            left &= left - 1u;
            if (sample_index < constants.batch_first || sample_index >= end)
                continue;
            const uint in_batch = sample_index - constants.batch_first;
            if (!may_be_shadowed(light_rows[in_batch], centre, radius))
                continue;
            if ((blocked[i] >> bit & 1u) != 0u)
                light_list[first + tested++] = in_batch;
            else
                light_list[first + constants.list_stride - 1u - untested++] = in_batch;
        } while (left != 0u);
    }
    counts[group] = LightListCounts(tested, untested);
}
