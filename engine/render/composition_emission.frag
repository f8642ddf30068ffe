#version 460
#extension GL_GOOGLE_include_directive : require
// The pixels that show one emitting surface, as the G-buffer says.
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/render/tone_map.h"

layout(constant_id = 2) const uint alpha_is_brightness = 0;
layout(constant_id = 3) const uint has_glare = 0;

layout(set = 0, binding = 0) uniform sampler2D irradiance_image;
layout(set = 0, binding = 1) uniform sampler2D albedo_image;
layout(set = 0, binding = 2) uniform usampler2D surface_image;
layout(set = 0, binding = 4) uniform sampler2D glare_image;
layout(push_constant) uniform Constants { EmissionConstants draw; };

layout(location = 0) out vec4 out_colour;

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (texelFetch(surface_image, pixel, 0).r != draw.surface)
        discard;
    const vec3 reflected = unpack_albedo(texelFetch(albedo_image, pixel, 0)) * texelFetch(irradiance_image, pixel, 0).rgb;
    vec3 radiance = reflected * (1.0 / 3.14159265358979);
    if (has_glare == 0) {
        radiance += draw.emission_exposure.rgb;
    } else {
        const vec2 place = gl_FragCoord.xy / vec2(textureSize(surface_image, 0));
        radiance += (1.0 - draw.glare_share) * draw.emission_exposure.rgb +
                    textureLod(glare_image, place, 0.0).rgb * (draw.glare_share / float(glare_levels));
    }
    const vec3 colour = display_from_radiance(radiance, draw.emission_exposure.w);
    out_colour = vec4(colour, alpha_is_brightness != 0 ? display_brightness(colour) : 1.0);
}
