#version 460
#extension GL_GOOGLE_include_directive : require
// The pixels that show one emitting surface, as the G-buffer says.
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/render/tone_map.h"

layout(set = 0, binding = 0) uniform sampler2D irradiance_image;
layout(set = 0, binding = 1) uniform sampler2D albedo_image;
layout(set = 0, binding = 2) uniform usampler2D surface_image;
layout(push_constant) uniform Constants { EmissionConstants draw; };

layout(location = 0) out vec4 out_colour;

void main() {
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
    if (texelFetch(surface_image, pixel, 0).r != draw.surface)
        discard;
    const vec3 reflected = unpack_albedo(texelFetch(albedo_image, pixel, 0)) * texelFetch(irradiance_image, pixel, 0).rgb;
    const vec3 radiance = reflected * (1.0 / 3.14159265358979) + draw.emission_exposure.rgb;
    out_colour = vec4(display_from_radiance(radiance, draw.emission_exposure.w), 1.0);
}
