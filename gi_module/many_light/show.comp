#version 460
#extension GL_GOOGLE_include_directive : require
// Debug views of the many-light system: false colours in place of the irradiance.
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/visibility/surface_lookup_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint view = show_tiles;

layout(set = 0, binding = 0) readonly buffer NodeOfEntry { uint entry_nodes[]; };
layout(set = 0, binding = 1) readonly buffer Rows { uint rows[]; };
layout(set = 0, binding = 2) readonly buffer Counts { LightListCounts counts[]; };
layout(set = 0, binding = 3) readonly buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 4) readonly buffer CellMasks { uvec2 cell_masks[]; };
layout(set = 0, binding = 5) readonly buffer Ages { uint ages[]; }; // by sample: frames since its map is stale
layout(set = 0, binding = 6) writeonly uniform image2D output_image;
layout(push_constant) uniform Constants { ManyLightConstants constants; };

vec3 heat(float x) { return clamp(vec3(2.0 * x, 2.0 - 2.0 * x, 1.0 - 4.0 * x), 0.0, 1.0); }

vec3 colour_of(uint number) {
    const uint h = number * 2654435761u;
    return vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
}

uint sample_count() { return min(uint(ages.length()), constants.state_words * pairs_per_word); }

uint state_of(uint node, uint i) {
    return (rows[node * constants.words_per_row + i / pairs_per_word] >> (i % pairs_per_word * 2u)) & 3u;
}

// Fractions of the samples. Red: shadow test needed; green: not needed; blue: blocked.
vec3 visibility(uint node) {
    vec3 count = vec3(0.0);
    for (uint i = 0; i < sample_count(); ++i) {
        const uint state = state_of(node, i);
        count += vec3(state == pair_partial, state == pair_none, state == pair_full);
    }
    const float all = max(count.r + count.g + count.b, 1.0);
    return count / all * 0.85 + colour_of(node) * 0.15;
}

// Mean age of the shadow maps that are needed here.
vec3 staleness(uint node) {
    float age = 0.0, tested = 0.0;
    for (uint i = 0; i < sample_count(); ++i) {
        if (state_of(node, i) == pair_partial) {
            age += min(float(ages[i]), 8.0);
            tested += 1.0;
        }
    }
    return heat(tested > 0.0 ? age / (tested * 8.0) : 0.0);
}

// Samples whose bit is set in one of the node's two rows of flags.
uint flagged(uint node, uint row) {
    uint count = 0u;
    const uint first = node * constants.words_per_row + constants.state_words + row * constants.flag_words;
    for (uint i = 0; i < constants.flag_words; ++i)
        count += uint(bitCount(rows[first + i]));
    return count;
}

vec3 share_of_samples(uint node) {
    uint count = 0u;
    if (view == show_mover_shadows || view == show_static_shadows)
        count = flagged(node, view == show_mover_shadows ? 0u : 1u);
    else
        for (uint i = 0; i < sample_count(); ++i) {
            const uint state = state_of(node, i);
            const bool counts = view == show_hidden          ? state == pair_full
                                : view == show_shadow_tests ? state == pair_partial
                                                            : state == pair_partial || state == pair_none;
            count += uint(counts);
        }
    return heat(float(count) / max(float(sample_count()), 1.0));
}

vec3 baked(uint node) {
    if ((node & node_baked) == 0u)
        return vec3(1.0, 0.15, 0.1);
    return vec3(0.1, 1.0, 4.0 * float(flagged(node & ~node_baked, 0u)) / max(float(sample_count()), 1.0));
}

void main() {
    const uvec2 pixel = gl_GlobalInvocationID.xy;
    if (pixel.x >= constants.width || pixel.y >= constants.height)
        return;
    const uvec2 low = min(pixel / constants.scale, uvec2(constants.low_width, constants.low_height) - 1u);
    const uint group = low.y / pixel_group_side * constants.group_columns + low.x / pixel_group_side;
    const uint entry = group * pixel_group_size + low.y % pixel_group_side * pixel_group_side + low.x % pixel_group_side;
    const uint node = entry_nodes[entry];
    vec3 colour = vec3(0.0);
    if (view == show_tiles) {
        const bool border = any(equal(pixel % (constants.scale * pixel_group_side), uvec2(0u)));
        colour = border ? vec3(0.0) : vec3(counts[group].tested, counts[group].untested, 0.0) / float(constants.list_stride);
    } else if (view == show_repaired) {
        const ivec2 cell = (ivec2(pixel) + int(constants.scale / 2u)) / int(constants.scale);
        const ivec2 inside = (ivec2(pixel) + int(constants.scale / 2u)) % int(constants.scale);
        const uint bit = uint(inside.y) * constants.scale + uint(inside.x);
        const uvec2 mask = cell_masks[uint(cell.y) * constants.cell_columns + uint(cell.x)];
        const bool again = ((bit < 32u ? mask.x >> bit : mask.y >> (bit - 32u)) & 1u) != 0u;
        colour = again ? vec3(1.0, 0.2, 0.6) : vec3(0.12);
    } else if (view == show_light_maps) {
        colour = sums[entry].rgb;
    } else if (view == show_baked) {
        colour = node == no_node ? vec3(0.1) : baked(node);
        colour *= 0.3 + 0.7 * clamp(sums[entry].g / (sums[entry].g + 1.0), 0.0, 1.0);
    } else if (node != no_node) {
        const uint known = node & node_mask;
        colour = view == show_visibility  ? visibility(known)
                 : view == show_staleness ? staleness(known)
                 : view == show_patches   ? colour_of(known)
                                          : share_of_samples(known);
    }
    imageStore(output_image, ivec2(pixel), vec4(colour, 1.0));
}
