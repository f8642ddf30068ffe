#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Every light sample (VPL), with its shadow map, at every pixel: thesis sec. 4.3, the equation of L(x) without A(x).
// This is the baseline that each optimisation must match in the picture and beat in time, so it is made as fast as we
// know how: the pixels of an invocation share each light's loads, and a batch has one class of lights, so the loop does
// not branch.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "gi_module/brute_force/brute_force_shared.h"
#include "gi_module/shadows/octahedral_map.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint pixels = 8;
layout(constant_id = 1) const uint light_class = light_class_surface;
layout(constant_id = 2) const uint maps = maps_texel_buffer;
layout(constant_id = 3) const uint filtered = 0;
layout(constant_id = 4) const uint count_clamped = 0;
layout(constant_id = 5) const uint storage_lights = 0;
layout(constant_id = 6) const uint map_bits = 16;

const uint stale_maps = 0, simplified_movers = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform Lights { LightRow uniform_lights[lights_per_batch]; };
layout(set = 0, binding = 4) readonly buffer StoredLights { LightRow stored_lights[]; };
layout(set = 0, binding = 5) uniform usamplerBuffer map_words;
layout(set = 0, binding = 6) readonly buffer MapWords { uint stored_map_words[]; };
layout(set = 0, binding = 7) buffer Accumulation { vec4 accumulation[]; }; // rgb: W/m2; a: luminance clamped off
layout(set = 0, binding = 8) writeonly uniform image2D output_image;
layout(set = 0, binding = 9) buffer ClampedSums { vec4 clamped_sums[]; }; // a work group: flux W, irradiance, pixels, area
layout(push_constant) uniform Constants { BruteForceConstants constants; };

shared vec4 group_sums[64];

#include "gi_module/shadows/map_words.glsl"

float map_value(uint slot, ivec2 texel) {
    const int resolution = int(constants.map_resolution);
    const int place = (int(slot) * resolution + texel.y) * resolution + texel.x;
    const int word = map_word(place);
    return value_in_word(maps == maps_texel_buffer ? texelFetch(map_words, word).r : stored_map_words[word], place);
}

float map_side() { return float(constants.map_resolution); }

#include "gi_module/shadows/shadowed_light.glsl"

// Area of the surface visible in a pixel, m2.
float pixel_area(Pixel pixel, vec2 centre) {
    const vec3 ray = camera_ray(camera, centre);
    const float distance_along = dot(pixel.position - camera.position.xyz, camera.axis.xyz);
    const float facing = max(abs(dot(pixel.geometric_normal, ray)), 1e-3);
    const float plane_area = 4.0 * length(camera.right.xyz) * length(camera.down.xyz) /
                             (camera.forward.w * camera.right.w);
    return distance_along * distance_along * plane_area / facing;
}

void main() {
    const int row = int(constants.first_row + gl_GlobalInvocationID.y);
    const int first_column = int(gl_WorkGroupID.x * kernel_lanes * pixels + gl_LocalInvocationID.x);
    Pixel surface[pixels];
    bool covered[pixels];
    vec3 sum[pixels];
    float clamped[pixels];
    bool any_covered = false;
    [[unroll]] for (uint k = 0; k < pixels; ++k) {
        const ivec2 pixel = ivec2(first_column + int(k * kernel_lanes), row);
        const ivec2 inside = min(pixel, ivec2(constants.width, constants.height) - 1);
        const float depth = texelFetch(depth_image, inside, 0).r;
        const uvec2 normals = texelFetch(normals_image, inside, 0).rg;
        covered[k] = depth > 0.0;
        any_covered = any_covered || covered[k];
        surface[k].position = camera_position_at(camera, vec2(inside) + 0.5, max(depth, 1e-7));
        surface[k].normal = unpack_normal(normals.x);
        surface[k].geometric_normal = unpack_normal(normals.y);
        surface[k].on_mover = 0.0;
        sum[k] = vec3(0.0);
        clamped[k] = 0.0;
        if (constants.first_batch == 0u && pixel == inside) {
            const vec4 before = accumulation[(row - int(constants.first_row)) * int(constants.width) + pixel.x];
            sum[k] = before.rgb;
            clamped[k] = before.a;
        }
    }
    if (any_covered) {
        for (uint i = 0; i < constants.light_count; ++i) {
            LightRow light;
            if (storage_lights != 0)
                light = stored_lights[i];
            else
                light = uniform_lights[i];
            [[unroll]] for (uint k = 0; k < pixels; ++k) {
                const LightFactor factor = light_factor(light, surface[k], true);
                sum[k] += light.intensity_slot.rgb * (factor.unshadowed * factor.visibility);
                if (count_clamped != 0)
                    clamped[k] += dot(light.intensity_slot.rgb, vec3(0.2126, 0.7152, 0.0722)) *
                                  (factor.clamped * factor.visibility);
            }
        }
    }
    vec4 sums = vec4(0.0);
    [[unroll]] for (uint k = 0; k < pixels; ++k) {
        const ivec2 pixel = ivec2(first_column + int(k * kernel_lanes), row);
        if (pixel.x < int(constants.width) && pixel.y < int(constants.height)) {
            if (constants.last_batch == 0u)
                accumulation[(row - int(constants.first_row)) * int(constants.width) + pixel.x] = vec4(sum[k], clamped[k]);
            else
                imageStore(output_image, pixel, covered[k] ? vec4(sum[k], 1.0) : vec4(0.0));
            if (count_clamped != 0 && covered[k]) {
                const float area = pixel_area(surface[k], vec2(pixel) + 0.5);
                sums += vec4(clamped[k] * area, clamped[k], 1.0, area);
            }
        }
    }
    if (count_clamped == 0 || constants.last_batch == 0u)
        return;
    // The same order of summation on every device: the first invocation adds up the sums of the work group.
    group_sums[gl_LocalInvocationIndex] = sums;
    barrier();
    if (gl_LocalInvocationIndex == 0) {
        vec4 total = vec4(0.0);
        for (int i = 0; i < 64; ++i)
            total += group_sums[i];
        clamped_sums[(constants.first_row / kernel_rows + gl_WorkGroupID.y) * constants.group_columns + gl_WorkGroupID.x] = total;
    }
}
