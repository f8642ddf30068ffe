#version 460
#extension GL_GOOGLE_include_directive : require
// What each pixel group shows, as a tile of level 0 (splat_tiles.comp makes the others): boxes around its pixels, the flat
// pieces of surface among them, and points for the pixels that belong to none, which share one where they are alike.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/splatting/splatting_shared.h"

layout(local_size_x = 8) in;
layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 4) writeonly buffer Tiles { SplatTile tiles[]; };
layout(set = 0, binding = 5) writeonly buffer Patches { GroupPatches groups[]; };
layout(set = 0, binding = 6) buffer Places { uint places[]; };
layout(push_constant) uniform Constants { SplattingConstants constants; };
#include "gi_module/splatting/splat_tile.glsl"

// A piece is worth its nodes from so many pixels on: fewer are a few points. Seeds that are tried; what is left then is
// points.
const uint least_pixels = 24u, most_seeds = 12u;
// Of a surface that bends: differences from what its nodes interpolate to, as flat_normals and flat_positions.
const float bent_normals = 2.5e-3, bent_positions = 0.03;

struct Shown {
    vec3 position, normal, geometric;
};
Shown shown_at(uint packed) {
    const ivec2 pixel = ivec2(packed & 0xffffu, packed >> 16);
    const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
    return Shown(camera_position_at(camera, vec2(pixel) + 0.5, texelFetch(depth_image, pixel, 0).r),
                 unpack_normal(normals.x), unpack_normal(normals.y));
}
bool has(uvec2 set, uint i) { return ((i < 32u ? set.x : set.y) >> (i & 31u) & 1u) != 0u; }
uvec2 bit_of(uint i) { return i < 32u ? uvec2(1u << i, 0u) : uvec2(0u, 1u << (i - 32u)); }
uint count_of(uvec2 set) { return uint(bitCount(set.x) + bitCount(set.y)); }
uint first_of(uvec2 set) { return uint(set.x != 0u ? findLSB(set.x) : 32 + findLSB(set.y)); }

// The pixels of a set that are on one plane with a pixel of it.
uvec2 on_plane(uint first_entry, uvec2 set, Shown seed, float size) {
    uvec2 found = uvec2(0u);
    for (uint i = 0; i < pixel_group_size; ++i) {
        if (!has(set, i))
            continue;
        const Shown other = shown_at(pixels[first_entry + i]);
        const vec3 turn = other.normal - seed.normal, mesh = other.geometric - seed.geometric;
        if (dot(turn, turn) <= flat_normals && dot(mesh, mesh) <= flat_normals &&
            abs(dot(seed.normal, other.position - seed.position)) <= flat_positions * size)
            found |= bit_of(i);
    }
    return found;
}

// Between two pixels that are next to each other, or at one.
Shown node_of(uint first_entry, uint node) {
    const vec2 at = 3.5 * node_place(node) + 3.5;
    const uvec2 low = uvec2(floor(at)), high = uvec2(ceil(at));
    const Shown a = shown_at(pixels[first_entry + low.y * 8u + low.x]), b = shown_at(pixels[first_entry + high.y * 8u + high.x]);
    return Shown(0.5 * (a.position + b.position), normalize(a.normal + b.normal), normalize(a.geometric + b.geometric));
}

bool is_bent(uint first_entry, float size) {
    Shown nodes[tile_nodes];
    for (uint node = 0; node < tile_nodes; ++node)
        nodes[node] = node_of(first_entry, node);
    bool fits = true;
    for (uint i = 0; i < pixel_group_size; ++i) {
        const vec2 place = vec2(i % 8u, i / 8u) / 3.5 - 1.0;
        Shown expected = Shown(vec3(0.0), vec3(0.0), vec3(0.0));
        for (uint node = 0; node < tile_nodes; ++node) {
            const float weight = node_weight(node, place);
            expected.position += weight * nodes[node].position;
            expected.normal += weight * nodes[node].normal;
        }
        const Shown own = shown_at(pixels[first_entry + i]);
        const vec3 turn = own.normal - normalize(expected.normal), away = own.position - expected.position;
        fits = fits && dot(turn, turn) <= bent_normals && dot(away, away) <= bent_positions * bent_positions * size * size;
    }
    return fits;
}

// Pixels that share a point: how far their normals differ (squared length), and how far apart they are, in widths of a
// pixel there.
const float alike_normals = 1e-2, alike_widths = 5.0;

float pixel_width(uint packed, vec3 position) {
    const vec2 pixel = vec2(packed & 0xffffu, packed >> 16) + 0.5;
    const vec3 ray = camera_ray(camera, pixel), next = camera_ray(camera, pixel + vec2(float(constants.scale), 0.0));
    return distance(ray, next) * distance(position, camera.position.xyz) / length(ray);
}

// Of a set, the pixels that share a point with the first.
uvec2 like_first(uint first_entry, uvec2 set, inout float apart) {
    const uint first = first_of(set);
    const Shown seed = shown_at(pixels[first_entry + first]);
    const float most = alike_widths * pixel_width(pixels[first_entry + first], seed.position);
    uvec2 found = bit_of(first);
    for (uint k = first + 1u; k < pixel_group_size; ++k) {
        if (!has(set, k))
            continue;
        const Shown other = shown_at(pixels[first_entry + k]);
        const vec3 turn = other.normal - seed.normal, away = other.position - seed.position;
        if (dot(turn, turn) > alike_normals || dot(away, away) > most * most)
            continue;
        found |= bit_of(k);
        apart = max(apart, length(away));
    }
    return found;
}

// The pixel of a set that is nearest to its middle.
uint middle_of(uvec2 set) {
    vec2 sum = vec2(0.0);
    for (uint i = 0; i < pixel_group_size; ++i)
        sum += has(set, i) ? vec2(i % 8u, i / 8u) : vec2(0.0);
    sum /= float(count_of(set));
    uint middle = 0u;
    float least = 1e30;
    for (uint i = 0; i < pixel_group_size; ++i) {
        const vec2 away = vec2(i % 8u, i / 8u) - sum;
        if (has(set, i) && dot(away, away) < least) {
            least = dot(away, away);
            middle = i;
        }
    }
    return middle;
}

void add_patch(inout GroupPatches group, Shown seed, vec4 sphere) {
    group.plane[group.patches] = vec4(seed.normal, dot(seed.normal, seed.position));
    group.geometric[group.patches] = vec4(seed.geometric, 0.0);
    group.sphere[group.patches] = sphere;
    ++group.patches;
}

// Divides the group's lit pixels into patches and points.
void divide(inout GroupPatches group, uint first_entry, uvec2 lit, SplatTile tile, uvec2 place) {
    const float size = distance(tile.low.xyz, tile.high.xyz);
    uvec2 left = lit, alone = uvec2(0u);
    for (uint seeds = 0; seeds < most_seeds && (left.x | left.y) != 0u && group.patches < group_patches; ++seeds) {
        const uint i = first_of(left);
        const Shown seed = shown_at(pixels[first_entry + i]);
        const uvec2 found = on_plane(first_entry, left, seed, size);
        const vec4 sphere = sphere_of(vec4(seed.normal, dot(seed.normal, seed.position)), place);
        const bool worth = count_of(found) >= least_pixels && sphere.w >= 0.0;
        for (uint k = 0; worth && k < pixel_group_size; ++k)
            if (has(found, k))
                places[first_entry + k] = group.patches;
        if (worth)
            add_patch(group, seed, sphere);
        else
            alone |= found;
        left &= ~found;
    }
    left |= alone;
    if (count_of(lit) == pixel_group_size && count_of(left) >= least_pixels && is_bent(first_entry, size)) {
        group.patches = 0u;
        group.curved = 1u;
        add_patch(group, node_of(first_entry, 0u), vec4(0.5 * (tile.low.xyz + tile.high.xyz), 0.5 * size));
        for (uint k = 0; k < pixel_group_size; ++k)
            places[first_entry + k] = 0u;
        left = uvec2(0u);
    }
    for (; (left.x | left.y) != 0u; ++group.points) {
        const uvec2 found = like_first(first_entry, left, group.apart.x);
        for (uint k = 0; k < pixel_group_size; ++k)
            if (has(found, k))
                places[first_entry + k] |= group_patches + group.points;
        places[first_entry + group.points] |= middle_of(found) << place_bits;
        left &= ~found;
    }
}

void main() {
    const uint index = gl_GlobalInvocationID.x;
    if (index >= constants.columns * constants.rows)
        return;
    const uint first_entry = index * pixel_group_size;
    SplatTile tile = no_tile;
    uvec2 lit = uvec2(0u);
    for (uint i = 0; i < pixel_group_size; ++i) {
        places[first_entry + i] = 0u;
        const uint packed = pixels[first_entry + i];
        if ((packed & unlit_pixel) != 0u)
            continue;
        lit |= bit_of(i);
        const Shown shown = shown_at(packed);
        tile.low = vec4(min(tile.low.xyz, shown.position), 1.0);
        tile.high = max(tile.high, vec4(shown.position, 0.0));
        tile.normal_low = min(tile.normal_low, vec4(shown.normal, 0.0));
        tile.normal_high = max(tile.normal_high, vec4(shown.normal, 0.0));
    }
    GroupPatches group;
    group.patches = group.points = group.curved = 0u;
    group.apart = vec4(0.0);
    divide(group, first_entry, lit, tile, tile_place(0u, index));
    group.nodes = group.patches == 1u && group.points == 0u ? tile_nodes : corner_nodes;
    if (waves_of(group.patches, group.nodes, group.points) > group_waves)
        group.patches = group.points = 0u;
    if (group.patches == 1u && group.points == 0u && group.curved == 0u) {
        tile.plane = group.plane[0];
        tile.geometric = group.geometric[0];
        tile.sphere = group.sphere[0];
    }
    groups[index] = group;
    tiles[index] = tile;
}
