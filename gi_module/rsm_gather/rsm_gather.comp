#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Adds to the sums of a stage's pixels the light that each gathers from reflective shadow maps: of the texels around where
// it lies in a map itself. The pattern is the same for all pixels, so an invocation on a CPU lights several that share it.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/rsm_gather/rsm_gather_shared.h"

layout(constant_id = 0) const uint pixels_per_invocation = 8;
layout(constant_id = 1) const uint lanes = 8;
layout(local_size_x_id = 1) in;
layout(constant_id = 2) const uint to_image = 0; // 1: the sums go to the full picture

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Maps { GatherMapRow maps[gather_maps_per_batch]; };
layout(set = 0, binding = 4) readonly buffer Pattern { GatherSample pattern[]; };
layout(set = 0, binding = 5) readonly buffer Pixels { uint pixels[]; };
layout(set = 0, binding = 6) buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 7) writeonly uniform image2D output_image;
layout(set = 0, binding = 8) uniform usamplerBuffer places; // texels: a CPU device reads them faster
layout(set = 0, binding = 9) uniform usamplerBuffer lights;
layout(push_constant) uniform Constants { GatherConstants constants; };

// Patterns whose offsets are whole numbers take each texel once, if the place within a texel is never rounded up to 1.
const float largest_inside = 0.9998779;

struct Surface {
    vec3 position, normal, geometric_normal;
};

// What a texel gives a pixel, without the map's scale. See pixel_light_shared.h.
vec3 light_of(int index, float softer, Surface surface) {
    const uvec4 place = texelFetch(places, index);
    const uvec2 packed = texelFetch(lights, index).rg;
    const vec2 rest = unpackHalf2x16(packed.y);
    const vec3 v = surface.position - uintBitsToFloat(place.xyz);
    const float along = dot(unpack_normal(place.w), v);
    const bool faces = along > 0.0 && dot(surface.geometric_normal, v) < 0.0;
    const float facing = faces ? max(-dot(surface.normal, v), 0.0) : 0.0;
    return vec3(unpackHalf2x16(packed.x), rest.x) * softened_term(along, facing, dot(v, v), softer * rest.y);
}

void main() {
    const uint group = gl_WorkGroupID.x;
    Surface surfaces[pixels_per_invocation];
    vec3 sum[pixels_per_invocation];
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint packed = pixels[group * pixel_group_size + k * lanes + gl_LocalInvocationID.x];
        const ivec2 inside = packed == no_pixel ? ivec2(0) : ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
        const float depth = texelFetch(depth_image, inside, 0).r;
        const uvec2 normals = texelFetch(normals_image, inside, 0).rg;
        surfaces[k].position = camera_position_at(camera, vec2(inside) + 0.5, max(depth, 1e-7));
        surfaces[k].normal = unpack_normal(normals.x);
        surfaces[k].geometric_normal = unpack_normal(normals.y);
        sum[k] = vec3(0.0);
    }
    for (uint m = 0; m < constants.map_count; ++m) {
        const GatherMapRow map = maps[m];
        vec2 within[pixels_per_invocation];
        ivec2 texel[pixels_per_invocation];
        vec3 from_map[pixels_per_invocation];
        [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
            const vec2 place = place_in_map(map, surfaces[k].position) * float(map.side);
            texel[k] = ivec2(floor(place));
            within[k] = min(place - floor(place), vec2(largest_inside));
            from_map[k] = vec3(0.0);
        }
        const int last = int(map.side) - 1;
        for (uint s = 0; s < map.sample_count; ++s) {
            const GatherSample from = pattern[map.first_sample + s];
            [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
                const ivec2 at = (texel[k] + ivec2(floor(within[k] + from.offset))) & last;
                from_map[k] += from.weight * light_of(int(map.first_light) + at.y * int(map.side) + at.x, from.softness, surfaces[k]);
            }
        }
        [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k)
            sum[k] += constants.scale * map.origin_flux.w / pixel_light_pi * from_map[k];
    }
    [[unroll]] for (uint k = 0; k < pixels_per_invocation; ++k) {
        const uint entry = group * pixel_group_size + k * lanes + gl_LocalInvocationID.x;
        const uint packed = pixels[entry];
        const bool lit = (packed & unlit_pixel) == 0u;
        const vec4 total = sums[entry] + vec4(lit ? sum[k] : vec3(0.0), 0.0);
        if (to_image == 0) {
            sums[entry] = total;
        } else if (packed != no_pixel) {
            const ivec2 pixel = ivec2(packed & 0xffffu, (packed & ~unlit_pixel) >> 16);
            imageStore(output_image, pixel, vec4(lit ? total.rgb : vec3(0.0), lit ? 1.0 : 0.0));
        }
    }
}
