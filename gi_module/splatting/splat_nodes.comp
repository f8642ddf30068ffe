#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// The light of a batch at the nodes of a level's tiles: of the lights that are smooth over the tile, and what the larger
// tile around it has at these places. An invocation is a node, at level 0 one node or point after the other.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(constant_id = 0) const uint lanes = 8;
layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint maps = 0; // maps_none or maps_texel_buffer
layout(constant_id = 2) const uint filtered = 0;
layout(constant_id = 3) const uint show = show_no_splats;
layout(constant_id = 4) const uint of_groups = 0; // 1: level 0

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform Lights { PixelLightRow lights[splats_per_batch]; };
layout(set = 0, binding = 2) readonly buffer Tiles { SplatTile tiles[]; };
layout(set = 0, binding = 3) readonly buffer Smooth { uint smooth_masks[]; };
layout(set = 0, binding = 4) buffer Nodes { vec4 node_light[]; };
layout(set = 0, binding = 5) uniform samplerBuffer map_texels;
layout(set = 0, binding = 6) uniform sampler2D depth_image;
layout(set = 0, binding = 7) uniform usampler2D normals_image;
layout(set = 0, binding = 8) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 9) readonly buffer Patches { GroupPatches groups[]; };
layout(set = 0, binding = 10) readonly buffer Places { uint places[]; };
layout(set = 0, binding = 11) buffer Points { vec4 point_light[]; }; // 64 for each group; of all batches
layout(push_constant) uniform Constants { SplattingConstants constants; };
#include "gi_module/splatting/splat_tile.glsl"

const uint light_class = light_class_surface, map_bits = 16, stale_maps = 0, simplified_movers = 0;
float map_side() { return float(constants.map_side); }
float map_value(uint slot, ivec2 texel) {
    const int side = int(constants.map_side);
    return texelFetch(map_texels, (int(slot) * side + texel.y) * side + texel.x).r;
}
#include "gi_module/shadows/shadowed_light.glsl"
#include "gi_module/splatting/splat_factor.glsl"

// Of the larger tile around this one, at a node of this one.
vec3 from_above(uvec2 tile, uint node) {
    const uint above = tile_at(constants.level + 1u, tile / 2u);
    const vec2 place = 0.5 * node_place(node) + vec2(tile & 1u) - 0.5;
    vec3 sum = vec3(0.0);
    [[unroll]] for (uint i = 0; i < tile_nodes; ++i)
        sum += node_weight(i, place) * node_light[above * tile_nodes + i].rgb;
    return sum;
}

Pixel pixel_at(uint packed) {
    const ivec2 pixel = ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
    const float depth = texelFetch(depth_image, pixel, 0).r;
    const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
    return Pixel(camera_position_at(camera, vec2(pixel) + 0.5, max(depth, 1e-7)), unpack_normal(normals.x),
                 unpack_normal(normals.y), 0.0);
}

Pixel on_plane(vec4 plane, vec4 geometric, uvec2 tile, uint node) {
    const vec3 ray = tile_ray(constants.level, tile, node_place(node));
    return Pixel(camera.position.xyz + ray * plane_distance(plane, ray), plane.xyz, geometric.xyz, 0.0);
}

// Of a group that bends: in the middle of two pixels, or at one.
Pixel on_bend(uint group, uint node) {
    const vec2 at = 3.5 * node_place(node) + 3.5;
    const uvec2 low = uvec2(floor(at)), high = uvec2(ceil(at));
    const Pixel a = pixel_at(pixels[group * pixel_group_size + low.y * 8u + low.x]);
    const Pixel b = pixel_at(pixels[group * pixel_group_size + high.y * 8u + high.x]);
    return Pixel(0.5 * (a.position + b.position), normalize(a.normal + b.normal),
                 normalize(a.geometric_normal + b.geometric_normal), 0.0);
}

// A node of a patch, or a point.
Pixel of_slot(uint group, uint slot, uvec2 place) {
    const uint nodes = groups[group].nodes, all = groups[group].patches * nodes;
    slot = min(slot, all + groups[group].points - 1u);
    if (slot < all)
        return groups[group].curved != 0u
                   ? on_bend(group, slot)
                   : on_plane(groups[group].plane[slot / nodes], groups[group].geometric[slot / nodes], place, slot % nodes);
    return pixel_at(pixels[group * pixel_group_size + (places[group * pixel_group_size + slot - all] >> place_bits)]);
}

vec3 light_at(Pixel surface, uint tile) {
    vec3 sum = vec3(0.0);
    for (uint word = 0; word < splat_mask_words; ++word) {
        uint mask = smooth_masks[tile * splat_mask_words + word];
        while (mask != 0u) {
            const PixelLightRow light = lights[word * 32u + uint(findLSB(mask))];
            mask &= mask - 1u;
            LightFactor factor = light_factor(light.row, surface, true);
            factor.unshadowed = softened_factor(light, surface);
            sum += contribution(light.row, factor, surface);
        }
    }
    return sum;
}

// A pixel's share of nodes, for the view that counts them.
float share(float nodes) { return show == show_overdraw ? nodes / float(pixel_group_size << (2u * constants.level)) : 1.0; }

void main() {
    const uint index = gl_GlobalInvocationID.x / tile_nodes, node = gl_GlobalInvocationID.x % tile_nodes;
    if (index >= tiles_of_level(constants.columns, constants.rows, constants.level))
        return;
    const uvec2 place = tile_place(constants.level, index);
    const uint own = tile_at(constants.level, place);
    if (of_groups != 0) {
        const uint waves = waves_of(groups[own].patches, groups[own].nodes, groups[own].points);
        const bool in_tile = tiles[own].sphere.w >= 0.0; // and in the larger one
        for (uint wave = 0; wave < waves; ++wave) {
            const uint point = own * pixel_group_size + wave * tile_nodes + node;
            vec3 sum = light_at(of_slot(own, wave * tile_nodes + node, place), own) * share(float(waves * tile_nodes));
            sum += in_tile ? from_above(place, node) : vec3(0.0);
            point_light[point] = vec4(sum + (constants.first != 0u ? vec3(0.0) : point_light[point].rgb), 0.0);
        }
        return;
    }
    vec3 sum = vec3(0.0);
    if (tiles[own].sphere.w >= 0.0) {
        sum = light_at(on_plane(tiles[own].plane, tiles[own].geometric, place, node), own) * share(float(tile_nodes));
        if (constants.level + 1u < tile_levels)
            sum += from_above(place, node);
    }
    node_light[own * tile_nodes + node] = vec4(sum, 0.0);
}
