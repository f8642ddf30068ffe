#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/core/octahedral.h"
#include "engine/core/shader_language.h"
#include "engine/render/composition_shared.h"
#include "engine/render/tone_map.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

// All views, tone-mapped or scene-linear. The tone-mapped final picture has composition.frag.
layout(local_size_x = 8, local_size_y = 8) in;
// Emission has an image of its own, and is not the same all over a surface.
layout(constant_id = 0) const uint textured_emission = 0;
layout(constant_id = 1) const uint sky_has_picture = 0;
layout(set = 0, binding = 0) uniform sampler2D irradiance_image;
layout(set = 0, binding = 1) uniform sampler2D depth_image;
layout(set = 0, binding = 2) uniform usampler2D normals_image;
layout(set = 0, binding = 3) uniform usampler2D surface_image;
layout(set = 0, binding = 4) uniform sampler2D albedo_image;
layout(set = 0, binding = 5) uniform sampler2D motion_image;
layout(set = 0, binding = 6) uniform sampler2D emission_image;
layout(set = 0, binding = 7) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 8) writeonly uniform image2D output_image;
layout(set = 0, binding = 9) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 10) uniform sampler2D sky_image;
layout(set = 0, binding = 11) uniform sampler2D specular_image;
layout(push_constant) uniform Constants { CompositionConstants constants; };

#include "engine/render/sky_radiance.glsl"

vec3 surface_radiance(ivec2 pixel, uint surface) {
    const vec3 irradiance = texelFetch(irradiance_image, pixel, 0).rgb;
    const vec3 albedo = unpack_albedo(texelFetch(albedo_image, pixel, 0));
    vec3 radiance = albedo * irradiance * (1.0 / pi);
    if (constants.has_gloss != 0u && (surface & surface_glossy) != 0u) {
        const vec4 specular = texelFetch(specular_image, pixel, 0);
        radiance = specular.a * radiance + specular.rgb;
    }
    if ((surface & surface_emits) != 0u)
        radiance += textured_emission != 0 ? texelFetch(emission_image, pixel, 0).rgb
                                           : rows[surface_row(surface)].emission.rgb;
    if ((surface & surface_unlit) != 0u)
        radiance = radiance_from_display(albedo, constants.exposure);
    return radiance;
}

vec3 surface_colour(uint surface) {
    const uint h = (surface & surface_row_mask) * 2654435761u;
    return vec3(h & 255u, (h >> 8) & 255u, (h >> 16) & 255u) / 255.0;
}

void main() {
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (pixel.x >= int(constants.width) || pixel.y >= int(constants.height))
        return;
    const uint surface = texelFetch(surface_image, pixel, 0).r;
    const bool hit = surface != 0u;
    const bool emitter = (surface & surface_area_light) != 0u;
    vec4 value = vec4(0.0, 0.0, 0.0, hit ? 1.0 : 0.0);
    bool radiance = false;
    if (constants.view == view_final) {
        value.rgb = hit ? surface_radiance(pixel, surface) : sky_radiance(vec2(pixel) + 0.5);
        value.a = 1.0;
        radiance = true;
    } else if (constants.view == view_irradiance) {
        if (hit && !emitter)
            value.rgb = texelFetch(irradiance_image, pixel, 0).rgb;
        else
            value.a = 0.0;
        radiance = constants.tone_map != 0u;
        if (radiance)
            value.rgb /= pi;
    } else if (constants.view == view_false_colours) {
        value.rgb = texelFetch(irradiance_image, pixel, 0).rgb;
    } else if (constants.view == view_normals && hit) {
        value.rgb = unpack_normal(texelFetch(normals_image, pixel, 0).r) * 0.5 + 0.5;
    } else if (constants.view == view_albedo && hit) {
        value.rgb = unpack_albedo(texelFetch(albedo_image, pixel, 0));
    } else if (constants.view == view_depth && hit) {
        value.rgb = vec3(texelFetch(depth_image, pixel, 0).r);
    } else if (constants.view == view_surfaces && hit) {
        value.rgb = surface_colour(surface);
    } else if (constants.view == view_motion && hit) {
        value.rgb = vec3(texelFetch(motion_image, pixel, 0).rg * 10.0 + 0.5, 0.5);
    }
    if (constants.tone_map != 0u) {
        if (radiance)
            value.rgb = display_from_radiance(value.rgb, constants.exposure);
        else
            value.rgb = clamp(value.rgb, vec3(0.0), vec3(1.0));
        value.a = 1.0;
    }
    imageStore(output_image, pixel, value);
}
