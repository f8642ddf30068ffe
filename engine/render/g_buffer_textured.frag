#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/core/octahedral.h"
#include "engine/render/composition_shared.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"

// Masked and blended surfaces have a pipeline of their own: `discard` keeps others from early depth tests.
layout(constant_id = 0) const uint has_holes = 0;
layout(constant_id = 2) const uint writes_extras = 0; // emission and gloss

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 2) readonly buffer Materials { MaterialRow materials[]; };
layout(set = 0, binding = 3) uniform sampler2D colour_texture;
layout(set = 0, binding = 4) uniform sampler2D normal_texture;
layout(set = 0, binding = 5) uniform sampler2D emission_texture;
layout(set = 0, binding = 6) uniform sampler2D gloss_texture; // green: roughness, blue: metallic

layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_previous;
layout(location = 3) in vec4 in_current;
layout(location = 5) in vec4 in_tangent;
layout(location = 6) in vec4 in_colour;
layout(location = 7) in vec4 in_colour_normal_place;
layout(location = 8) in vec4 in_emission_gloss_place;

layout(location = 0) out uvec2 out_normals; // see g_buffer.frag
layout(location = 1) out uint out_surface;
layout(location = 2) out vec4 out_albedo;
layout(location = 3) out vec2 out_motion;
layout(location = 4) out vec4 out_emission;
layout(location = 5) out vec2 out_gloss;

// A threshold for each pixel of a 4x4 square, all different and evenly spread: what lets half of the light through is
// drawn at half of the pixels (B. Bayer, 1973).
float dot_threshold(ivec2 pixel) {
    const int x = pixel.x & 3, y = pixel.y & 3;
    const int fine = ((x ^ y) & 1) * 2 + (y & 1), coarse = (((x ^ y) >> 1) & 1) * 2 + ((y >> 1) & 1);
    return (float(fine * 4 + coarse) + 0.5) / 16.0;
}

void main() {
    // All textures are read before anything is discarded or branched.
    const vec4 colour = texture(colour_texture, in_colour_normal_place.xy) * in_colour;
    const vec3 bump_texel = texture(normal_texture, in_colour_normal_place.zw).xyz;
    vec3 emission_texel = vec3(1.0), gloss_texel = vec3(1.0);
    if (writes_extras != 0) {
        emission_texel = texture(emission_texture, in_emission_gloss_place.xy).rgb;
        gloss_texel = texture(gloss_texture, in_emission_gloss_place.zw).rgb;
    }
    const vec4 factors = materials[rows[surface_row(draw.surface)].material.x].factors;
    if (has_holes != 0) {
        const float alpha = colour.a * factors.x;
        const float least = factors.y >= 0.0 ? factors.y : dot_threshold(ivec2(gl_FragCoord.xy));
        if (alpha < least)
            discard;
    }
    const vec3 to_camera = camera.position.xyz - in_position;
    vec3 geometric = normalize(cross(dFdx(in_position), dFdy(in_position)));
    if (dot(geometric, to_camera) < 0.0)
        geometric = -geometric;
    vec3 shading = normalize(in_normal);
    if (factors.z != 0.0) {
        vec3 bump = bump_texel * 2.0 - 1.0;
        bump.xy *= factors.z;
        const vec3 tangent = normalize(in_tangent.xyz - dot(in_tangent.xyz, shading) * shading + vec3(1e-12));
        const vec3 bitangent = cross(shading, tangent) * (in_tangent.w < 0.0 ? -1.0 : 1.0);
        // On the back of a sheet, what is up stays up: all of the normal turns round below.
        shading = normalize(bump.x * tangent + bump.y * bitangent + max(bump.z, 0.05) * shading);
    }
    if (dot(normalize(in_normal), geometric) < 0.0)
        shading = -shading;
    // A bumped normal that leans behind the surface is brought back to its edge.
    const float lean = dot(shading, geometric);
    if (lean < 0.02)
        shading = normalize(shading + (0.02 - lean) * geometric);
    out_normals = uvec2(pack_normal(shading), pack_normal(geometric));
    vec3 emission = draw.emission.rgb;
    if (factors.w != 0.0)
        emission *= emission_texel;
    out_emission = vec4(emission, 1.0);
    out_gloss = unpackUnorm2x16(draw.gloss) * gloss_texel.bg;
    out_surface = draw.surface;
    out_albedo = pack_albedo(base_colour_of(draw) * colour.rgb, (draw.surface & surface_unlit) != 0u,
                             (draw.surface & surface_glossy) != 0u);
    out_motion = (in_previous.xy / in_previous.w - in_current.xy / in_current.w) * 0.5;
}
