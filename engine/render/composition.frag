#version 460
#extension GL_GOOGLE_include_directive : require
// The tone-mapped final picture, with as few reads a pixel as there can be: on a CPU device they are what it costs.
// Surfaces whose emission has no texture are drawn over it (composition_emission.frag).
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/render/tone_map.h"
#include "engine/scene/camera_shared.h"

layout(constant_id = 0) const uint textured_emission = 0; // emission has an image
layout(constant_id = 1) const uint sky_has_picture = 0;

layout(set = 0, binding = 0) uniform sampler2D irradiance_image;
layout(set = 0, binding = 1) uniform sampler2D albedo_image;
layout(set = 0, binding = 2) uniform sampler2D emission_image;
layout(set = 0, binding = 3) uniform sampler2D sky_image;
layout(set = 0, binding = 4) uniform Camera { CameraRow camera; };
layout(push_constant) uniform Constants { CompositionConstants constants; };

layout(location = 0) out vec4 out_colour;

#include "engine/render/sky_radiance.glsl"

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const vec4 texel = texelFetch(albedo_image, pixel, 0);
    const vec3 albedo = unpack_albedo(texel);
    vec3 radiance = albedo * texelFetch(irradiance_image, pixel, 0).rgb * (1.0 / pi);
    if (textured_emission != 0)
        radiance += texelFetch(emission_image, pixel, 0).rgb;
    const vec3 shown = shown_from_radiance(texel.a > albedo_of_nothing ? radiance : sky_radiance(pixel), constants.exposure);
    const bool unlit = abs(texel.a - albedo_unlit) < 0.25; // the base colour itself
    out_colour = vec4(srgb_from_linear_colour(unlit ? albedo : shown), 1.0);
}
