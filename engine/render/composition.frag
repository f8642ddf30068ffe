#version 460
#extension GL_GOOGLE_include_directive : require
// The tone-mapped final picture, with as few reads a pixel as there can be: on a CPU device they are what it costs.
// Surfaces whose emission has no texture are drawn over it (composition_emission.frag), and so is a sky with a picture,
// by this shader again, on the pixels that show it.
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/render/tone_map.h"
#include "engine/scene/camera_shared.h"

layout(constant_id = 0) const uint textured_emission = 0; // emission has an image
layout(constant_id = 1) const uint sky_has_picture = 0;
layout(constant_id = 2) const uint alpha_is_brightness = 0;
layout(constant_id = 3) const uint has_glare = 0;

layout(set = 0, binding = 0) uniform sampler2D irradiance_image;
layout(set = 0, binding = 1) uniform sampler2D albedo_image;
layout(set = 0, binding = 2) uniform sampler2D emission_image;
layout(set = 0, binding = 3) uniform sampler2D sky_image;
layout(set = 0, binding = 4) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 5) uniform sampler2D glare_image;
layout(set = 0, binding = 6) uniform sampler2D specular_image; // see CompositionInput
layout(push_constant) uniform Constants { CompositionConstants constants; };

layout(location = 0) out vec4 out_colour;

#include "engine/render/sky_radiance.glsl"

vec3 glare(vec2 place) {
    return textureLod(glare_image, place, 0.0).rgb * (constants.glare_share / float(glare_levels));
}

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    const vec4 texel = texelFetch(albedo_image, pixel, 0);
    const vec3 albedo = unpack_albedo(texel);
    vec3 radiance = albedo * texelFetch(irradiance_image, pixel, 0).rgb * (1.0 / pi);
    if (constants.has_gloss != 0u && abs(texel.a - albedo_glossy) < albedo_step) {
        const vec4 specular = texelFetch(specular_image, pixel, 0);
        radiance = specular.a * radiance + specular.rgb;
    }
    // What shines is scattered by a share, and what others scatter is added.
    const float kept = has_glare != 0 ? 1.0 - constants.glare_share : 1.0;
    if (textured_emission != 0)
        radiance += kept * texelFetch(emission_image, pixel, 0).rgb;
    radiance = texel.a > albedo_of_nothing ? radiance : kept * sky_radiance(gl_FragCoord.xy);
    if (has_glare != 0)
        radiance += glare(gl_FragCoord.xy / vec2(constants.width, constants.height));
    const vec3 shown = shown_from_radiance(radiance, constants.exposure);
    const bool unlit = abs(texel.a - albedo_unlit) < albedo_step; // the base colour itself
    const vec3 colour = srgb_from_linear_colour(unlit ? albedo : shown);
    out_colour = vec4(colour, alpha_is_brightness != 0 ? display_brightness(colour) : 1.0);
}
