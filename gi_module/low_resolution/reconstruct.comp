#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Upsamples the low-resolution picture (thesis sec. 4.3.3). An invocation processes a cell: the pixels between four
// low-resolution pixels. A pixel blends those of the four that lie on its own plane; if none does, or if they differ
// too much, it is marked to be lit again at full resolution.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/low_resolution/low_resolution_shared.h"
#include "gi_module/transport/flat_shading_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int scale = 4;
layout(constant_id = 1) const uint to_buffer = 0; // 1: the picture is written to a buffer, which is copied
layout(constant_id = 2) const uint repairs_contacts = 1;

// If the valid neighbours' bilinear weights sum up to less, the pixel lies beyond them, at a crease or a silhouette,
// and blending would extrapolate.
const float min_weight_sum = 0.3;
// The same where two surfaces meet in a corner: light falls off towards it, and neighbours farther from it are too
// bright, now more and now less along its line.
const float corner_weight_sum = 0.9;

// A surface that stands before another by less than this, in tolerances (about two low-resolution pixels in all),
// darkens it where they seem to meet: under a shelf, beside a frame.
const float contact_reach = 14.0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform samplerBuffer sums; // as texels: a CPU device reads them faster
layout(set = 0, binding = 4) writeonly uniform image2D output_image;
layout(set = 0, binding = 5) writeonly buffer CellMasks { uvec2 cell_masks[]; };
layout(set = 0, binding = 6) writeonly buffer Picture { uint picture_halves[]; };
layout(push_constant) uniform Constants { LowResolutionConstants constants; };

// On a plane, depth (near / distance along the view axis) is linear in screen space: three numbers describe the plane
// of a neighbour.
struct Neighbour {
    vec3 irradiance;
    vec2 normal; // octahedral
    uint packed_normal;
    bool flat_shaded; // its shading normal is that of its plane
    vec3 depth_plane; // depth at the cell's first pixel, and its change per pixel to the right and down
    float height;     // of the camera above the plane, m
    bool exists;
};

Neighbour neighbour_at(ivec2 low, vec2 first) {
    low = clamp(low, ivec2(0), ivec2(constants.low_width, constants.low_height) - 1);
    const uint group = uint(low.y) / pixel_group_side * constants.group_columns + uint(low.x) / pixel_group_side;
    const vec4 sum = texelFetch(sums, int(group * pixel_group_size + uint(low.y) % pixel_group_side * pixel_group_side + uint(low.x) % pixel_group_side));
    const ivec2 pixel = min(low * scale + scale / 2, ivec2(constants.width, constants.height) - 1);
    const float depth = texelFetch(depth_image, pixel, 0).r;
    const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
    Neighbour result;
    result.irradiance = max(sum.rgb, vec3(0.0));
    result.exists = sum.a > 0.0;
    result.packed_normal = normals.x;
    result.normal = unpackSnorm2x16(normals.x);
    const vec3 geometric_normal = unpack_normal(normals.y);
    const vec3 difference = unpack_normal(normals.x) - geometric_normal;
    result.flat_shaded = dot(difference, difference) < flat_shaded_limit;
    const vec3 to_point = camera_ray(camera, vec2(pixel) + 0.5) * (camera.position.w / max(depth, 1e-7));
    result.height = dot(geometric_normal, to_point);
    // near * dot(n, ray) / dot(n, point - camera), in screen coordinates.
    const float over = camera.position.w / (abs(result.height) > 1e-6 ? result.height : 1e-6);
    result.depth_plane = vec3(dot(geometric_normal, camera_ray(camera, first)),
                              dot(geometric_normal, camera.right.xyz) * 2.0 / camera.forward.w,
                              dot(geometric_normal, camera.down.xyz) * 2.0 / camera.right.w) * over;
    return result;
}

float brightness(vec3 irradiance) { return max(irradiance.r, max(irradiance.g, irradiance.b)); }

// Bilinear weights of the four at a pixel of the cell.
vec4 weights_at(vec2 pixel) {
    const vec2 place = pixel / float(scale);
    return vec4((1.0 - place.x) * (1.0 - place.y), place.x * (1.0 - place.y), (1.0 - place.x) * place.y, place.x * place.y);
}

vec3 blend(Neighbour neighbours[4], vec4 shares) {
    return neighbours[0].irradiance * shares[0] + neighbours[1].irradiance * shares[1] +
           neighbours[2].irradiance * shares[2] + neighbours[3].irradiance * shares[3];
}

// Whether the four lie on one plane, within `distance` (times depth) all over the cell, and have the same normal.
bool on_one_plane(Neighbour neighbours[4], float distance) {
    bool same = neighbours[0].flat_shaded && neighbours[0].exists;
    [[unroll]] for (int i = 1; i < 4; ++i) {
        const vec3 difference = neighbours[i].depth_plane - neighbours[0].depth_plane;
        const vec2 across = difference.yz * float(scale);
        const vec4 corners = abs(difference.x + vec4(0.0, across.x, across.y, across.x + across.y));
        same = same && neighbours[i].packed_normal == neighbours[0].packed_normal &&
               abs(neighbours[i].height) * max(max(corners.x, corners.y), max(corners.z, corners.w)) < distance;
    }
    return same;
}

// Whether, half a cell from a pixel that lies on a plane, a surface hides a part of that plane which is little further
// away. The shadow between them may be narrower than what lies between two low-resolution pixels. Where two surfaces
// only meet, the pixel is before the other one, and not behind it. `plane`, `height`: see Neighbour.
bool at_contact(ivec2 pixel, ivec2 inside, float depth, vec3 plane, float height, float tolerance) {
    const ivec2 last = ivec2(constants.width, constants.height) - 1;
    const vec3 place = camera_ray(camera, vec2(pixel) + 0.5) * (camera.position.w / max(depth, 1e-7));
    bool contact = false;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const ivec2 step = (i & 1) == 0 ? ivec2(i - 1, 0) : ivec2(0, i - 2);
        const ivec2 beside = clamp(pixel + (scale / 2) * step, ivec2(0), last);
        const float other = texelFetch(depth_image, beside, 0).r;
        const vec3 normal = unpack_normal(texelFetch(normals_image, beside, 0).g);
        const vec3 to_other = camera_ray(camera, vec2(beside) + 0.5) * (camera.position.w / max(other, 1e-7));
        const float before = height * (other - dot(plane, vec3(1.0, vec2(inside + beside - pixel))));
        contact = contact || (before > tolerance && before < contact_reach * tolerance &&
                              dot(normal, place - to_other) < 0.0);
    }
    return contact;
}

// Half-precision bits of a non-negative value, rounded down.
uint half_bits(float value) {
    const uint bits = floatBitsToUint(min(value, 65504.0));
    const uint small = floatBitsToUint(value + 0.5) - floatBitsToUint(0.5); // below 2^-14, halves have a fixed step
    return value < 6.1035156e-5 ? small : (bits - 0x38000000u) >> 13;
}

void store(ivec2 pixel, vec4 value) {
    if (to_buffer == 0) {
        imageStore(output_image, pixel, value);
        return;
    }
    const uint at = 2u * (uint(pixel.y) * constants.width + uint(pixel.x));
    picture_halves[at] = half_bits(value.r) | half_bits(value.g) << 16;
    picture_halves[at + 1u] = half_bits(value.b) | (value.a > 0.0 ? 0x3c000000u : 0u);
}

uvec2 with_bit(uvec2 mask, uint bit) {
    return bit < 32u ? uvec2(mask.x | 1u << bit, mask.y) : uvec2(mask.x, mask.y | 1u << (bit - 32u));
}

void main() {
    const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    if (cell.x >= int(constants.cell_columns) || cell.y >= int(constants.cell_rows))
        return;
    Neighbour neighbours[4];
    const ivec2 first = cell * scale - scale / 2;
    [[unroll]] for (int i = 0; i < 4; ++i)
        neighbours[i] = neighbour_at(cell - 1 + ivec2(i & 1, i >> 1), vec2(first) + 0.5);
    // Tolerance for surfaces that are not quite planar: a fraction of a low-resolution pixel's size, as a distance.
    const float pixel_size = length(camera.right.xyz) * 2.0 / camera.forward.w;
    const float tolerance = camera.position.w * (0.15 * float(scale) * pixel_size + 2e-4);
    vec4 bright, heights;
    bvec4 exists;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        bright[i] = brightness(neighbours[i].irradiance);
        heights[i] = abs(neighbours[i].height);
        exists[i] = neighbours[i].exists;
    }
    const float brightest = max(max(bright.x, bright.y), max(bright.z, bright.w));
    const float darkest = min(min(bright.x, bright.y), min(bright.z, bright.w));
    const bool all_differ = brightest - darkest > constants.contrast * brightest;

    // The common case: the pixel and all four neighbours lie on a flat surface. The neighbours' planes are the same
    // within half the tolerance, and the pixel is on it within the other half; its normal need not be read. The other
    // pixels are left to the loop after this one: a CPU device runs both sides of a branch, but a loop only while it
    // has work.
    const bool flat_cell = on_one_plane(neighbours, 0.5 * tolerance);
    const float height = max(max(heights.x, heights.y), max(heights.z, heights.w));
    const vec3 plane = neighbours[0].depth_plane;
    uvec2 again_mask = uvec2(0u), others = uvec2(0u);
    const vec2 picture = vec2(constants.width, constants.height);
    for (int y = 0; y < scale; y += 2) {
        [[unroll]] for (int x = 0; x < scale; x += 2) {
            // Four pixels at once, in the order of textureGather: below, below right, right, and the pixel itself.
            const vec4 depths = textureGather(depth_image, (vec2(first + ivec2(x, y)) + 1.0) / picture);
            [[unroll]] for (int i = 0; i < 4; ++i) {
                const ivec2 inside = ivec2(x + (i == 1 || i == 2 ? 1 : 0), y + (i < 2 ? 1 : 0));
                const ivec2 pixel = first + inside;
                if (any(lessThan(pixel, ivec2(0))) || pixel.x >= int(constants.width) ||
                    pixel.y >= int(constants.height))
                    continue;
                const bool on_plane = height * abs(dot(plane, vec3(1.0, vec2(inside))) - depths[i]) < 0.5 * tolerance;
                const bool easy = flat_cell && on_plane && depths[i] > 0.0;
                const uint bit = uint(inside.y * scale + inside.x);
                if (easy)
                    store(pixel, vec4(blend(neighbours, weights_at(vec2(inside))), 1.0));
                if (easy && all_differ)
                    again_mask = with_bit(again_mask, bit);
                if (!easy)
                    others = with_bit(others, bit);
            }
        }
    }
    if ((others.x | others.y) != 0u) do { // tested at its end, or it would run once more than needed
        const uint bit = uint(others.x != 0u ? findLSB(others.x) : 32 + findLSB(others.y));
        if (bit < 32u)
            others.x &= others.x - 1u;
        else
            others.y &= others.y - 1u;
        const ivec2 inside = ivec2(int(bit) % scale, int(bit) / scale);
        const ivec2 pixel = first + inside;
        const float depth = texelFetch(depth_image, pixel, 0).r;
        const uint packed_normal = texelFetch(normals_image, pixel, 0).r;
        const vec4 weights = weights_at(vec2(inside));
        // Distances in the octahedral encoding approximate angles: 1 is 55 to 90 degrees. Across a fold they are too
        // large, and the pixel is lit again.
        const vec2 normal = unpackSnorm2x16(packed_normal);
        vec4 before, apart; // how far before the neighbours' planes, times depth; squared distance of the normals
        bvec4 same_normal;
        [[unroll]] for (int i = 0; i < 4; ++i) {
            before[i] = heights[i] * (depth - dot(neighbours[i].depth_plane, vec3(1.0, vec2(inside))));
            apart[i] = dot(neighbours[i].normal - normal, neighbours[i].normal - normal);
            same_normal[i] = neighbours[i].packed_normal == packed_normal;
        }
        const bvec4 on_plane = lessThan(abs(before), vec4(tolerance));
        vec4 shares = weights;
        int own = 0; // a neighbour on the pixel's plane
        [[unroll]] for (int i = 1; i < 4; ++i)
            own = on_plane[i] && exists[i] ? i : own;
        bool contact = false;
        if (repairs_contacts != 0)
            contact = at_contact(pixel, inside, depth, neighbours[own].depth_plane, heights[own], tolerance);
        bool again = contact || all_differ;
        if (!(all(same_normal) && all(on_plane))) {
            const vec4 valid = vec4(on_plane) * vec4(lessThan(apart, vec4(constants.normal_limit))) * vec4(exists);
            shares = (weights + 1e-3) * valid;
            const float sum = shares.x + shares.y + shares.z + shares.w;
            const vec4 low = mix(vec4(1e30), bright, valid), high = bright * valid;
            const float highest = max(max(high.x, high.y), max(high.z, high.w));
            const float lowest = min(min(low.x, low.y), min(low.z, low.w));
            const vec4 beyond = mix(vec4(1e30), before, vec4(greaterThanEqual(before, vec4(tolerance))) * vec4(exists));
            const bool corner = min(min(beyond.x, beyond.y), min(beyond.z, beyond.w)) < contact_reach * tolerance;
            again = contact || sum < (corner ? corner_weight_sum : min_weight_sum) || highest - lowest > constants.contrast * highest;
            shares = sum == 0.0 ? weights : shares / sum; // in case there is no room to light it again
        }
        const bool surface = depth > 0.0;
        if (surface && again)
            again_mask = with_bit(again_mask, bit);
        store(pixel, surface ? vec4(blend(neighbours, shares), 1.0) : vec4(0.0));
    } while ((others.x | others.y) != 0u);
    cell_masks[uint(cell.y) * constants.cell_columns + uint(cell.x)] = again_mask;
}
