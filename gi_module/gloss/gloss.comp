#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// What microfacets reflect towards the camera, from the same light samples (VPLs) and shadow maps as diffuse light.
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "gi_module/gloss/gloss_shared.h"
#include "gi_module/shadows/octahedral_map.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint light_class = light_class_surface;
layout(constant_id = 1) const uint maps = maps_texel_buffer;
layout(constant_id = 2) const uint filtered = 0;
layout(constant_id = 3) const uint map_bits = 16;
layout(constant_id = 4) const uint stale_maps = 0;
layout(constant_id = 5) const uint simplified_movers = 0;
layout(constant_id = 6) const uint has_colours = 0; // base colours and gloss are images, else those of the instance
layout(constant_id = 7) const uint has_gloss = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform usampler2D surface_image;
layout(set = 0, binding = 4) uniform sampler2D colour_image;
layout(set = 0, binding = 5) uniform sampler2D gloss_image;
layout(set = 0, binding = 6) uniform sampler2D irradiance_image;
layout(set = 0, binding = 7) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 8) uniform Lights { LightRow lights[lights_per_batch]; };
layout(set = 0, binding = 9) readonly buffer Table { vec2 table[]; };
layout(set = 0, binding = 10) uniform usamplerBuffer map_words;
layout(set = 0, binding = 11) buffer Sums { vec4 sums[]; };
layout(set = 0, binding = 12) writeonly uniform image2D output_image;
layout(push_constant) uniform Constants { GlossConstants constants; };

#include "gi_module/shadows/map_words.glsl"

float map_side() { return float(constants.map_resolution); }
float map_value(uint slot, ivec2 texel) {
    const int side = int(constants.map_resolution);
    const int place = (int(slot) * side + texel.y) * side + texel.x;
    return value_in_word(texelFetch(map_words, map_word(place)).r, place);
}
#include "gi_module/shadows/shadowed_light.glsl"

// Highlights of smoother surfaces would be less than a pixel.
const float least_alpha_squared = 1e-4;
// What is less than this share of a white surface's light is left out, untested.
const float least_share = 2e-4;

struct GlossyPixel {
    Pixel place;
    vec3 to_eye;
    Facets facets;
    float alpha_squared;
    float least; // radiance of one light that counts, W/(sr m2)
};

vec2 table_value(float row, float column) {
    const float r = min(floor(row), float(facet_roughnesses) - 2.0), c = min(floor(column), float(facet_cosines) - 2.0);
    const uint first = uint(r) * facet_columns + uint(c);
    return mix(mix(table[first], table[first + 1u], column - c),
               mix(table[first + facet_columns], table[first + facet_columns + 1u], column - c), row - r);
}

vec2 table_mean(float row) {
    const float r = min(floor(row), float(facet_roughnesses) - 2.0);
    const uint place = uint(r) * facet_columns + facet_cosines;
    return mix(table[place], table[place + facet_columns], row - r);
}

Facets facets_of(ivec2 pixel, InstanceRow row, vec2 gloss, float cosine) {
    vec3 colour = row.base_colour.rgb;
    if (has_colours != 0) {
        const vec3 root = texelFetch(colour_image, pixel, 0).rgb;
        colour = root * root;
    }
    const float index = uintBitsToFloat(row.material.w), root = (index - 1.0) / (index + 1.0);
    const float place = clamp(gloss.y, 0.0, 1.0) * float(facet_roughnesses - 1u);
    return make_facets(colour, gloss.x, row.material.w != 0u ? root * root : -1.0,
                       table_value(place, sqrt(clamp(cosine, 0.0, 1.0)) * float(facet_cosines - 1u)), table_mean(place));
}

// Direction to the light; w: square of its size as it is seen from there.
vec4 light_seen_from(LightRow light, vec3 position) {
    if (light_class == light_class_directional)
        return vec4(-light.normal_offset.xyz, light.position_bound.w * light.position_bound.w);
    const vec3 v = light.position_bound.xyz - position;
    const float squared_distance = max(dot(v, v), 1e-12);
    const float radius = light_class == light_class_surface ? light.tangent_scale.w : max(-light.position_bound.w, 0.0);
    return vec4(v * inversesqrt(squared_distance), radius * radius / squared_distance);
}

vec3 reflected_light(LightRow light, GlossyPixel pixel, float unshadowed) {
    const vec4 seen = light_seen_from(light, pixel.place.position);
    const float least_alpha = light_class == light_class_surface ? light.normal_offset.w : 0.0;
    const float alpha_squared = widened_alpha_squared(max(pixel.alpha_squared, least_alpha), seen.w);
    const vec3 reflected = light.intensity_slot.rgb * unshadowed *
                           facet_lobe(pixel.facets, alpha_squared, pixel.place.normal, pixel.to_eye, seen.xyz);
    float visibility = 0.0;
    if (max(reflected.r, max(reflected.g, reflected.b)) > pixel.least)
        visibility = maps != maps_none ? map_visibility(light, pixel.place) : 1.0;
    return reflected * visibility;
}

GlossyPixel find_pixel(ivec2 pixel, InstanceRow row) {
    const float depth = texelFetch(depth_image, pixel, 0).r;
    const uvec2 normals = texelFetch(normals_image, pixel, 0).rg;
    GlossyPixel result;
    result.place = Pixel(camera_position_at(camera, vec2(pixel) + 0.5, max(depth, 1e-7)), unpack_normal(normals.x),
                         unpack_normal(normals.y), (row.material.y & material_moves) != 0u ? 1.0 : 0.0);
    result.to_eye = normalize(camera.position.xyz - result.place.position);
    vec2 gloss = unpackUnorm2x16(row.material.z);
    if (has_gloss != 0)
        gloss = texelFetch(gloss_image, pixel, 0).rg;
    result.facets = facets_of(pixel, row, gloss, dot(result.place.normal, result.to_eye));
    const float alpha = gloss.y * gloss.y;
    result.alpha_squared = max(alpha * alpha, least_alpha_squared);
    const vec3 irradiance = texelFetch(irradiance_image, pixel, 0).rgb;
    result.least = least_share / 3.14159265 * max(irradiance.r, max(irradiance.g, irradiance.b));
    return result;
}

void light_pixel(ivec2 place, uint instance) {
    const ivec2 pixel = place + ivec2(constants.x, constants.y);
    const GlossyPixel surface = find_pixel(pixel, rows[instance]);
    const int own_sum = place.y * int(constants.width) + place.x;
    vec3 sum = vec3(0.0);
    if (constants.first_batch == 0u)
        sum = sums[own_sum].rgb;
    uint i = 0u;
    if (constants.light_count > 0u) do { // tested at its end: see light.comp
        const LightRow light = lights[i];
        const float unshadowed = unshadowed_factor(light, surface.place).unshadowed;
        if (unshadowed > 0.0)
            sum += reflected_light(light, surface, unshadowed);
    } while (++i < constants.light_count);
    if (constants.last_batch == 0u) {
        sums[own_sum] = vec4(sum, 0.0);
        return;
    }
    sum += surface.facets.repeated * texelFetch(irradiance_image, pixel, 0).rgb * (1.0 / 3.14159265);
    imageStore(output_image, pixel, vec4(min(sum, vec3(6e4)), surface.facets.base));
}

void main() {
    const ivec2 place = ivec2(gl_GlobalInvocationID.xy);
    if (place.x >= int(constants.width) || place.y >= int(constants.height))
        return;
    const uint surface =
        texelFetch(surface_image, place + ivec2(constants.x, constants.y), 0).r & surface_row_mask;
    const uint instance = max(surface, 1u) - 1u;
    const uvec4 material = rows[instance].material;
    const bool has_facets = material.w != 0u || (material.z & 0xffffu) != 0u;
    if (surface != 0u && has_facets && (material.y & material_unlit) == 0u)
        light_pixel(place, instance);
}
