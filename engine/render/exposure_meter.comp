#version 460
#extension GL_GOOGLE_include_directive : require
// Luminance at points of a grid over the picture, before exposure.
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

layout(local_size_x = 8, local_size_y = 8) in;
layout(constant_id = 0) const uint textured_emission = 0;
layout(constant_id = 1) const uint sky_has_picture = 0;
layout(set = 0, binding = 0) uniform sampler2D irradiance_image;
layout(set = 0, binding = 1) uniform sampler2D albedo_image;
layout(set = 0, binding = 2) uniform usampler2D surface_image;
layout(set = 0, binding = 3) uniform sampler2D emission_image;
layout(set = 0, binding = 4) uniform sampler2D sky_image;
layout(set = 0, binding = 5) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 6) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 7) writeonly buffer Points { float points[]; };
layout(push_constant) uniform Constants { CompositionConstants constants; };

#include "engine/render/sky_radiance.glsl"

vec3 radiance_at(ivec2 pixel) {
    const uint surface = texelFetch(surface_image, pixel, 0).r;
    if (surface == 0u)
        return sky_radiance(pixel);
    if ((surface & surface_unlit) != 0u)
        return vec3(0.0); // whatever the exposure, it looks the same
    const vec3 albedo = unpack_albedo(texelFetch(albedo_image, pixel, 0));
    vec3 radiance = albedo * texelFetch(irradiance_image, pixel, 0).rgb * (1.0 / pi);
    if ((surface & surface_emits) != 0u)
        radiance += textured_emission != 0 ? texelFetch(emission_image, pixel, 0).rgb
                                           : rows[surface_row(surface)].emission.rgb;
    return radiance;
}

void main() {
    const uvec2 point = gl_GlobalInvocationID.xy;
    if (point.x >= meter_columns || point.y >= meter_rows)
        return;
    const vec2 place = (vec2(point) + 0.5) / vec2(meter_columns, meter_rows);
    const ivec2 pixel = ivec2(place * vec2(constants.width, constants.height));
    points[point.y * meter_columns + point.x] = dot(radiance_at(pixel), vec3(0.2126, 0.7152, 0.0722));
}
