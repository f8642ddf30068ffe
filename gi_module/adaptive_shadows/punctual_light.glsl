#extension GL_EXT_control_flow_attributes : require
// Light straight from suns, point lights and spots, with shadows from tiles of maps: added to the pixels of the listed
// blocks. As in brute_force.comp, the pixels of an invocation share each light's loads, and a pass has one kind of
// lights. The including shader declares the image `picture`, which is read and written, so that GLSL requires its format.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/adaptive_shadows/adaptive_shadows_shared.h"
#include "gi_module/shadows/octahedral_map.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint map_kind = map_of_sphere;
layout(constant_id = 1) const uint maps = maps_texel_buffer; // or maps_none
layout(constant_id = 2) const uint pixels = 8;               // lit by an invocation, which share the loads of lights

const uint light_class = map_kind == map_of_directions ? light_class_directional : light_class_point;
const uint filtered = 1, map_bits = 32, stale_maps = 0, simplified_movers = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { TileLight lights[lights_per_pass]; };
layout(set = 0, binding = 4) readonly buffer Table { uint table[]; };
layout(set = 0, binding = 5) uniform usamplerBuffer map_words;
layout(set = 0, binding = 6) readonly buffer Blocks { LitBlock lit_blocks[]; };
layout(push_constant) uniform Constants { PunctualConstants constants; };

float map_side() { return float(tile_side); }
float map_value(uint slot, ivec2 texel) {
    return uintBitsToFloat(texelFetch(map_words, (int(slot) * int(tile_side) + texel.y) * int(tile_side) + texel.x).r);
}

#include "gi_module/shadows/shadowed_light.glsl"

// Where a receiver lies on a light's map, and what its depth is compared by; see octahedral_map.h.
struct Receiver {
    vec3 place; // map coordinates, stored value
    vec3 normal; // geometric, in light space
    float plane_distance;
    float bias, reach; // of the map with `side` texels
};

Receiver receiver_of(TileLight light, Pixel pixel, float side) {
    const vec3 v = pixel.position - light.row.position_bound.xyz;
    const vec3 d = to_light_space(light.row, v);
    Receiver receiver;
    receiver.normal = to_light_space(light.row, pixel.geometric_normal);
    if (light_class == light_class_directional) {
        receiver.place = vec3(d.xy * light.row.tangent_scale.w, 1.0 - d.z * light.row.normal_offset.w);
        receiver.plane_distance = 0.0;
        receiver.bias = orthographic_bias(side, -receiver.normal.z);
        receiver.reach = orthographic_bias(side, 1.0);
        return receiver;
    }
    const float scale = light.row.position_bound.w;
    const vec3 place = map_kind == map_of_cone ? cone_map(d, scale) : sphere_map(d);
    const float reach = map_kind == map_of_cone ? cone_texel_reach(side, scale) : sphere_texel_reach(side);
    receiver.plane_distance = -dot(pixel.geometric_normal, v);
    receiver.place = vec3(place.xy, shadow_near * place.z);
    receiver.bias = perspective_bias(reach, receiver.plane_distance, place.z);
    receiver.reach = reach * receiver.place.z;
    return receiver;
}

// Value of the receiver's plane at map coordinates.
float plane_value(TileLight light, Receiver receiver, vec2 uv) {
    if (light_class == light_class_directional)
        return orthographic_plane_value(receiver.place.z, receiver.normal, uv - receiver.place.xy);
    const vec3 centre =
        map_kind == map_of_cone ? cone_direction(uv, light.row.position_bound.w) : sphere_direction(uv);
    return value_on_plane(receiver.normal, receiver.plane_distance, centre);
}

vec2 map_place(TileLight light, Pixel pixel) {
    const vec3 d = to_light_space(light.row, pixel.position - light.row.position_bound.xyz);
    if (light_class == light_class_directional)
        return d.xy * light.row.tangent_scale.w;
    return (map_kind == map_of_cone ? cone_map(d, light.row.position_bound.w) : sphere_map(d)).xy;
}

// 0 to 1. A place for which no tile has been drawn yet is dark.
float tile_visibility(TileLight light, Pixel pixel) {
    const vec2 at = clamp(map_place(light, pixel) * 0.5 + 0.5, vec2(0.0), vec2(0.9999999));
    const ivec2 cell = ivec2(at * float(light.table_side));
    const uint entry = table[light.table_first + uint(cell.y) * light.table_side + uint(cell.x)];
    if (entry == 0u)
        return 0.0;
    const uint slot = (entry & ((1u << tile_level_shift) - 1u)) - 1u;
    const int tiles = 1 << int(entry >> tile_level_shift);
    const ivec2 tile = cell * tiles / int(light.table_side);
    const float side = float(tiles * int(tile_inner));
    const Receiver receiver = receiver_of(light, pixel, side);
    const vec2 position = at * side - 0.5;
    const vec2 corner = floor(position);
    // Beyond the map's edges a tile holds nothing, so those texels have no vote.
    const ivec2 texel = ivec2(corner) - tile * int(tile_inner) + int(tile_border);
    const int first = (int(slot) * int(tile_side) + texel.y) * int(tile_side) + texel.x;
    const float step = 2.0 / side;
    const vec2 uv = (corner + 0.5) * step - 1.0;
    vec4 lit, vote, values;
    [[unroll]] for (int i = 0; i < 4; ++i) {
        const float on_plane = plane_value(light, receiver, uv + step * vec2(i & 1, i >> 1));
        values[i] = uintBitsToFloat(texelFetch(map_words, first + (i & 1) + (i >> 1) * int(tile_side)).r);
        const vec2 result = texel_vote(on_plane, receiver.place.z, shadow_filter_window * receiver.bias,
                                       shadow_filter_slack * receiver.reach, depth_step(map_bits), values[i]);
        lit[i] = result.x;
        vote[i] = result.y;
    }
    const vec2 inside = position - corner;
    const float share = count_votes(lit, vote, inside);
    // A sun shines along walls of single sheets, where four texels show two of them: what lies between would be lit.
    if (light_class == light_class_directional)
        return share;
    return surface_votes(values, inside, receiver.place.z, receiver.reach, depth_step(map_bits), share);
}

void main() {
    const LitBlock listed = lit_blocks[map_kind * list_stride(constants.block_count) +
                                        gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x];
    const uint block = listed.block;
    const int row = int(block / constants.block_columns * block_rows + gl_LocalInvocationID.y);
    const int first_column = int(block % constants.block_columns * 8u * pixels + gl_LocalInvocationID.x);
    const ivec2 last = ivec2(constants.width, constants.height) - 1;
    Pixel surface[pixels];
    bool covered[pixels];
    vec3 sum[pixels];
    [[unroll]] for (uint k = 0; k < pixels; ++k) {
        const ivec2 pixel = min(ivec2(first_column + int(k) * 8, row), last);
        const float depth = texelFetch(depth_image, pixel, 0).r;
        const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
        covered[k] = depth > 0.0;
        surface[k] = Pixel(camera_position_at(camera, vec2(pixel) + 0.5, max(depth, 1e-7)), unpack_normal(normals.x),
                           unpack_normal(normals.y), 0.0);
        sum[k] = imageLoad(picture, pixel).rgb;
    }
    uint rest = listed.lights; // at least one
    do { // tested at its end: see light.comp
        const TileLight light = lights[findLSB(rest)];
        [[unroll]] for (uint k = 0; k < pixels; ++k) {
            const float unshadowed = unshadowed_factor(light.row, surface[k]).unshadowed;
            float visibility = 1.0;
            if (maps != maps_none)
                visibility = tile_visibility(light, surface[k]);
            sum[k] += light.row.intensity_slot.rgb * (unshadowed * visibility);
        }
        rest &= rest - 1u;
    } while (rest != 0u);
    [[unroll]] for (uint k = 0; k < pixels; ++k) {
        const ivec2 pixel = ivec2(first_column + int(k) * 8, row);
        if (covered[k] && pixel.x <= last.x && pixel.y <= last.y)
            imageStore(picture, pixel, vec4(sum[k], 1.0));
    }
}
