#version 460
#extension GL_GOOGLE_include_directive : require
// Fills pixel groups: the pixel of each entry, the node that it lies on, and the light of its light map. Low-resolution
// pixels are subsampled from the full G-buffer (thesis sec. 4.3.3): each takes the pixel in the middle of its block.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "gi_module/charts/curved_charts_shared.h"
#include "gi_module/many_light/many_light_shared.h"
#include "gi_module/visibility/surface_lookup_shared.h"

layout(local_size_x = 64) in;
layout(constant_id = 0) const uint from_list = 0; // 0: tiles of the low-resolution picture, 1: listed pixels
layout(constant_id = 1) const uint light_maps = 1;
layout(constant_id = 2) const uint baked = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform usampler2D surface_image;
// Tables as texel buffers, which a CPU device reads faster than storage buffers; as uints, since reading floats may
// change bits that are no float.
layout(set = 0, binding = 4) uniform usamplerBuffer instances; // SurfaceInstances
layout(set = 0, binding = 5) uniform usamplerBuffer charts;    // SurfaceCharts
layout(set = 0, binding = 6) uniform usamplerBuffer cells;
layout(set = 0, binding = 7) uniform usamplerBuffer node_rows; // NodeRows
layout(set = 0, binding = 8) buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 9) writeonly buffer NodeOfEntry { uint entry_nodes[]; };
layout(set = 0, binding = 10) writeonly buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 11) readonly buffer LightMaps { ivec4 light_map_texels[]; };
layout(set = 0, binding = 12) uniform samplerBuffer baked_texels;
layout(set = 0, binding = 13) uniform samplerBuffer curved_rows; // CurvedChartRows
layout(set = 0, binding = 14) uniform usamplerBuffer refined_texels;
layout(set = 0, binding = 15) writeonly buffer Ratios { uvec2 ratios[]; };
layout(push_constant) uniform Constants { ManyLightConstants constants; };

#include "gi_module/many_light/refined_texel.glsl"

// Where light is evaluated by pixel, what a texel lacks says less of it.
const float least_rough_ratio = 0.5, most_rough_ratio = 2.0;

// Not a kernel of its own: that would be compiled in the middle of a game.
bool is_refined() { return constants.refined_share > 0.0; }

// The chart without its cells.
SurfaceChart chart_plane_at(uint i) {
    SurfaceChart chart;
    const int first = int(i) * 4;
    chart.plane = uintBitsToFloat(texelFetch(charts, first));
    chart.u_axis = uintBitsToFloat(texelFetch(charts, first + 1));
    chart.v_axis = uintBitsToFloat(texelFetch(charts, first + 2));
    return chart;
}

SurfaceInstance instance_at(uint i) {
    const uvec4 numbers = texelFetch(instances, int(i) * 2), rest = texelFetch(instances, int(i) * 2 + 1);
    return SurfaceInstance(numbers.x, numbers.y, numbers.z, numbers.w, uintBitsToFloat(rest.xyz), rest.w);
}

NodeRow node_row_at(uint i) {
    const uvec4 numbers = texelFetch(node_rows, int(i) * 2 + 1);
    return NodeRow(uintBitsToFloat(texelFetch(node_rows, int(i) * 2)), numbers.x, numbers.y, numbers.z, numbers.w);
}

uint find_node(SurfaceInstance instance, vec3 position, vec3 geometric_normal) {
    bool found = false;
    SurfaceChart chart;
    const uint end = instance.first_chart + instance.chart_count;
    uint i = instance.first_chart;
    if (i < end) do { // tested at its end: see light.comp
        chart = chart_plane_at(i);
        if (on_chart(chart, position, geometric_normal)) {
            const uvec4 grid = texelFetch(charts, int(i) * 4 + 3);
            chart.first_cell = grid.x;
            chart.columns = grid.y;
            chart.rows = grid.z;
            chart.cut_sides = grid.w;
            found = !beyond_cut(chart, position);
        }
    } while (++i < end && !found);
    return found ? texelFetch(cells, int(chart_cell(chart, position))).r : box_node(instance, position);
}

// Position in a patch's grid of texels.
struct TexelPlace {
    uint first; // of the four around it
    vec2 weight;
};

TexelPlace texel_place(NodeRow row, vec3 position) {
    const SurfaceChart chart = chart_plane_at(row.chart);
    const vec2 place = vec2(dot(chart.u_axis.xyz, position) + chart.u_axis.w, dot(chart.v_axis.xyz, position) + chart.v_axis.w);
    const vec2 texel = clamp((place - row.place.xy) / row.place.zw, 0.0, 1.0) * vec2(row.columns - 1u, row.rows - 1u);
    const uvec2 corner = uvec2(min(texel, vec2(row.columns - 2u, row.rows - 2u)));
    return TexelPlace(row.first_texel + corner.y * row.columns + corner.x, texel - vec2(corner));
}

// Bilinear within the patch; neighbouring patches have equal values on their border if the same samples light them.
vec3 light_map(NodeRow row, TexelPlace place) {
    const uint first = place.first;
    const vec3 low = mix(vec3(light_map_texels[first].xyz), vec3(light_map_texels[first + 1u].xyz), place.weight.x);
    const vec3 high = mix(vec3(light_map_texels[first + row.columns].xyz),
                          vec3(light_map_texels[first + row.columns + 1u].xyz), place.weight.x);
    return mix(low, high, place.weight.y) / constants.fixed_point;
}

// Light of the samples of the frame, and what is shown of it: refined.
struct BakedLight {
    vec3 light;
    vec3 refined;
};

// From the texels `first`, `below` and those to their right.
BakedLight interpolated(int first, int below, vec2 weight) {
    const int texels[4] = int[4](first, first + 1, below, below + 1);
    const float weights[4] = float[4]((1.0 - weight.x) * (1.0 - weight.y), weight.x * (1.0 - weight.y),
                                      (1.0 - weight.x) * weight.y, weight.x * weight.y);
    BakedLight baked = BakedLight(vec3(0.0), vec3(0.0));
    for (int i = 0; i < 4; ++i) {
        const RefinedTexel texel = to_refined_texel(texelFetch(refined_texels, texels[i]).rg);
        const vec3 light = texelFetch(baked_texels, texels[i]).rgb;
        const vec3 refined = texelFetch(baked_texels, texel.source).rgb * texel.ratio;
        baked.light += weights[i] * light;
        baked.refined += weights[i] * mix(light, refined, constants.refined_share);
    }
    return baked;
}

// By what light is scaled that is evaluated by pixel: all of it where it is rough, else what movers take away.
vec3 ratio_of(BakedLight baked, bool rough) {
    const vec3 ratio = baked.refined / max(baked.light, 1e-30);
    const vec3 bounded = rough ? clamp(ratio, least_rough_ratio, most_rough_ratio) : min(ratio, largest_ratio);
    return mix(vec3(1.0), bounded, greaterThan(baked.light, vec3(0.0)));
}

// And what is added to it where it is rough: even light, which hardly any of the frame's samples give.
vec3 remainder_of(BakedLight baked, bool rough) {
    return rough ? max(baked.refined - most_rough_ratio * baked.light, 0.0) : vec3(0.0);
}

vec3 interpolated_light(int first, int below, vec2 weight) {
    const vec3 low = mix(texelFetch(baked_texels, first).rgb, texelFetch(baked_texels, first + 1).rgb, weight.x);
    const vec3 high = mix(texelFetch(baked_texels, below).rgb, texelFetch(baked_texels, below + 1).rgb, weight.x);
    return mix(low, high, weight.y);
}

// `rough`: its light is not to be used.
BakedLight baked_light(NodeRow row, TexelPlace place, out bool rough) {
    const int first = int(place.first), below = first + int(row.columns);
    rough = texelFetch(baked_texels, first).a != 0.0;
    if (is_refined())
        return interpolated(first, below, place.weight);
    const vec3 light = interpolated_light(first, below, place.weight);
    return BakedLight(light, light);
}

// The same on a curved surface, from the chart that its normal selects. Points that are not on the chart's surface are
// rough, too.
BakedLight curved_light(uint first_chart, vec3 position, vec3 geometric_normal, out bool rough) {
    const uint direction = curved_direction(geometric_normal);
    const int chart = int(first_chart + direction) * 2;
    const vec4 chart_place = texelFetch(curved_rows, chart), size = texelFetch(curved_rows, chart + 1);
    const vec3 point = curved_place(direction, position) - chart_place.xyz;
    const vec2 texel = point.xy * chart_place.w;
    const vec2 corner = clamp(floor(texel), vec2(0.0), max(size.xy - 2.0, 0.0));
    const vec2 weight = texel - corner;
    const int first = int(size.z) + int(corner.y) * int(size.x) + int(corner.x), below = first + int(size.x);
    const float height = texelFetch(baked_texels, first).a;
    const bool inside = size.x > 0.0 && abs(weight.x - 0.5) <= 0.5 && abs(weight.y - 0.5) <= 0.5;
    rough = !(inside && abs(point.z * size.w - height) <= curved_point_span * size.w / chart_place.w);
    if (is_refined() && inside)
        return interpolated(first, below, weight);
    const vec3 light = interpolated_light(first, below, weight);
    return BakedLight(light, light);
}

void main() {
    const uint entry = gl_WorkGroupID.x * pixel_group_size + gl_LocalInvocationID.x;
    ivec2 pixel;
    bool exists;
    if (from_list != 0) {
        const uint packed = pixels[entry];
        exists = packed != no_pixel;
        pixel = exists ? ivec2(packed & 0xffffu, packed >> 16) : ivec2(0);
    } else {
        const uint column = (gl_WorkGroupID.x % constants.group_columns) * pixel_group_side + gl_LocalInvocationID.x % pixel_group_side;
        const uint row = (gl_WorkGroupID.x / constants.group_columns) * pixel_group_side + gl_LocalInvocationID.x / pixel_group_side;
        exists = column < constants.low_width && row < constants.low_height;
        pixel = min(ivec2(column, row) * int(constants.scale) + int(constants.scale / 2u),
                    ivec2(constants.width, constants.height) - 1);
    }
    const float depth = texelFetch(depth_image, pixel, 0).r;
    const uint surface = texelFetch(surface_image, pixel, 0).r;
    const bool in_picture = exists;
    exists = exists && surface != 0u;
    uint node = no_node;
    vec3 sum = vec3(0.0), ratio = vec3(1.0), remainder = vec3(0.0);
    if (exists) {
        const vec3 position = camera_position_at(camera, vec2(pixel) + 0.5, depth);
        const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
        const vec3 geometric_normal = unpack_normal(normals.g);
        const SurfaceInstance instance = instance_at(surface_row(surface));
        node = find_node(instance, position, geometric_normal);
        bool curved = false; // or smooth-shaded
        if (light_maps != 0 && node != no_node) {
            const NodeRow row = node_row_at(node);
            if (row.first_texel != no_light_map) {
                const TexelPlace place = texel_place(row, position);
                const vec3 difference = unpack_normal(normals.r) - geometric_normal;
                // Texels are lit with the patch's normal.
                const bool differs = dot(difference, difference) >= flat_shaded_limit;
                bool rough = true;
                if (baked != 0) {
                    const BakedLight light = baked_light(row, place, rough);
                    sum = light.refined;
                    ratio = ratio_of(light, rough);
                    remainder = remainder_of(light, rough);
                }
                node |= differs ? node_normal_differs : rough ? 0u : node_baked;
                curved = differs && baked != 0 && instance.first_curved_chart != no_node;
                if (rough)
                    sum = light_map(row, place) * ratio;
                if (differs)
                    sum = remainder = vec3(0.0);
            } else {
                curved = baked != 0 && instance.first_curved_chart != no_node;
            }
        }
        if (curved) {
            bool rough;
            const BakedLight light = curved_light(instance.first_curved_chart, position, geometric_normal, rough);
            node |= rough ? 0u : node_baked;
            sum = rough ? vec3(0.0) : light.refined;
            ratio = ratio_of(light, rough);
            remainder = remainder_of(light, rough);
        }
    }
    if (from_list == 0)
        pixels[entry] = in_picture ? uint(pixel.x) | (uint(pixel.y) << 16) | (exists ? 0u : unlit_pixel) : no_pixel;
    entry_nodes[entry] = node;
    sums[entry] = vec4(sum + remainder, exists ? 1.0 : 0.0);
    if (is_refined())
        ratios[entry] = uvec2(packHalf2x16(ratio.rg), packHalf2x16(vec2(ratio.b, 0.0)));
}
