#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// The full picture from the low-resolution one (thesis sec. 4.3.3). An invocation handles a cell: the pixels between
// four low-resolution pixels. A pixel takes the blend of those of the four that lie on its own plane; where none does,
// or those that do differ too much, it is marked to be lit again.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/many_light/many_light_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const int scale = 4;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) readonly buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 4) writeonly uniform image2D output_image;
layout(set = 0, binding = 5) writeonly buffer CellMasks { uvec2 cell_masks[]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

// On a plane, depth (near / distance along the view) is linear in the picture: a neighbour's plane is three numbers.
struct Neighbour {
    vec3 irradiance;
    vec3 normal;
    uint packed_normal;
    vec3 depth_plane; // depth at the cell's first pixel, and what a pixel to the right and one down add
    float height;     // of the camera over the plane, m
    bool exists;
};

Neighbour neighbour_at(ivec2 low, vec2 first) {
    low = clamp(low, ivec2(0), ivec2(constants.low_width, constants.low_height) - 1);
    const uint group = uint(low.y) / group_side * constants.group_columns + uint(low.x) / group_side;
    const vec4 sum = sums[group * group_pixels + uint(low.y) % group_side * group_side + uint(low.x) % group_side];
    const ivec2 pixel = min(low * scale + scale / 2, ivec2(constants.width, constants.height) - 1);
    const float depth = texelFetch(depth_image, pixel, 0).r;
    const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
    Neighbour result;
    result.irradiance = max(sum.rgb, vec3(0.0));
    result.exists = sum.a > 0.0;
    result.packed_normal = normals.x;
    result.normal = unpack_normal(normals.x);
    const vec3 geometric_normal = unpack_normal(normals.y);
    const vec3 to_point = camera_ray(camera, vec2(pixel) + 0.5) * (camera.position.w / max(depth, 1e-7));
    result.height = dot(geometric_normal, to_point);
    // near * dot(n, ray) / dot(n, point - camera), in the picture's coordinates.
    const float over = camera.position.w / (abs(result.height) > 1e-6 ? result.height : 1e-6);
    result.depth_plane = vec3(dot(geometric_normal, camera_ray(camera, first)),
                              dot(geometric_normal, camera.right.xyz) * 2.0 / camera.forward.w,
                              dot(geometric_normal, camera.down.xyz) * 2.0 / camera.right.w) * over;
    return result;
}

float brightness(vec3 irradiance) { return max(irradiance.r, max(irradiance.g, irradiance.b)); }

void main() {
    const ivec2 cell = ivec2(gl_GlobalInvocationID.xy);
    if (cell.x >= int(constants.cell_columns) || cell.y >= int(constants.cell_rows))
        return;
    Neighbour neighbours[4];
    const ivec2 first = cell * scale - scale / 2;
    [[unroll]] for (int i = 0; i < 4; ++i)
        neighbours[i] = neighbour_at(cell - 1 + ivec2(i & 1, i >> 1), vec2(first) + 0.5);
    // Tolerance for surfaces that are not quite planes: a part of a low-resolution pixel's size, in units of distance.
    const float pixel_size = length(camera.right.xyz) * 2.0 / camera.forward.w;
    const float tolerance = camera.position.w * (0.15 * float(scale) * pixel_size + 2e-4);
    float darkest = 1e30, brightest = 0.0;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        darkest = min(darkest, brightness(neighbours[i].irradiance));
        brightest = max(brightest, brightness(neighbours[i].irradiance));
    }
    const bool all_differ = brightest - darkest > constants.contrast * brightest;
    uvec2 mask = uvec2(0u);
    for (int y = 0; y < scale; ++y) {
        [[unroll]] for (int x = 0; x < scale; ++x) {
            const ivec2 pixel = first + ivec2(x, y);
            if (any(lessThan(pixel, ivec2(0))) || pixel.x >= int(constants.width) || pixel.y >= int(constants.height))
                continue;
            const float depth = texelFetch(depth_image, pixel, 0).r;
            if (depth <= 0.0) {
                imageStore(output_image, pixel, vec4(0.0));
                continue;
            }
            const uint packed_normal = texelFetch(normals_image, pixel, 0).r;
            const vec2 place = vec2(x, y) / float(scale);
            const vec4 weights = vec4((1.0 - place.x) * (1.0 - place.y), place.x * (1.0 - place.y),
                                      (1.0 - place.x) * place.y, place.x * place.y);
            vec4 off_plane; // distance from the neighbours' planes, times depth
            bvec4 same_normal;
            [[unroll]] for (int i = 0; i < 4; ++i) {
                off_plane[i] = abs(neighbours[i].height * (dot(neighbours[i].depth_plane, vec3(1.0, x, y)) - depth));
                same_normal[i] = neighbours[i].packed_normal == packed_normal;
            }
            vec3 value;
            bool again;
            // Most pixels lie on a flat surface with all four neighbours: equal normals are equal bits.
            if (all(same_normal) && all(lessThan(off_plane, vec4(tolerance)))) {
                value = neighbours[0].irradiance * weights[0] + neighbours[1].irradiance * weights[1] +
                        neighbours[2].irradiance * weights[2] + neighbours[3].irradiance * weights[3];
                again = all_differ;
            } else {
                value = vec3(0.0);
                vec3 best = vec3(0.0);
                float weight_sum = 0.0, low = 1e30, high = 0.0, nearest = 1e30;
                const vec3 normal = unpack_normal(packed_normal);
                [[unroll]] for (int i = 0; i < 4; ++i) {
                    const bool valid = neighbours[i].exists && off_plane[i] < tolerance &&
                                       dot(neighbours[i].normal, normal) > constants.normal_cosine;
                    const float weight = valid ? weights[i] + 1e-3 : 0.0;
                    value += neighbours[i].irradiance * weight;
                    weight_sum += weight;
                    if (valid) {
                        low = min(low, brightness(neighbours[i].irradiance));
                        high = max(high, brightness(neighbours[i].irradiance));
                    }
                    const float distance_to = neighbours[i].exists ? off_plane[i] - 1e-6 * weights[i] : 1e29;
                    if (distance_to < nearest) {
                        nearest = distance_to;
                        best = neighbours[i].irradiance;
                    }
                }
                again = weight_sum == 0.0 || high - low > constants.contrast * high;
                value = weight_sum > 0.0 ? value / weight_sum : best; // `best`: in case it is not lit again after all
            }
            if (again) {
                const uint bit = uint(y * scale + x);
                if (bit < 32u)
                    mask.x |= 1u << bit;
                else
                    mask.y |= 1u << (bit - 32u);
            }
            imageStore(output_image, pixel, vec4(value, 1.0));
        }
    }
    cell_masks[uint(cell.y) * constants.cell_columns + uint(cell.x)] = mask;
}
