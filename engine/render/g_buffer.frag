#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/core/octahedral.h"
#include "engine/render/composition_shared.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/pattern_shared.h"

// A pipeline for each: a CPU device runs both sides of every branch.
layout(constant_id = 0) const uint pattern_kind = pattern_none;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };

layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_previous;
layout(location = 3) in vec4 in_current;
layout(location = 4) in vec3 in_local;
layout(location = 5) in flat vec4 in_pattern;

layout(location = 0) out uvec2 out_normals; // x: shading normal, y: geometric normal (octahedral, 16 bits each)
layout(location = 1) out uint out_surface;  // row + 1, and what instance_shared.h marks
layout(location = 2) out vec4 out_albedo;
layout(location = 3) out vec2 out_motion;   // in units of the picture: where the point was, minus where it is
layout(location = 4) out vec4 out_emission; // radiance, W/(sr m2)
layout(location = 5) out vec2 out_gloss;    // metallic, roughness

#include "engine/render/pattern_albedo.glsl"

void main() {
    // Surfaces are two-sided: the geometric normal faces the camera, the shading normal is on its side.
    const vec3 to_camera = camera.position.xyz - in_position;
    vec3 geometric = cross(dFdx(in_position), dFdy(in_position)); // of any length: the octahedral map takes directions
    if (dot(geometric, to_camera) < 0.0)
        geometric = -geometric;
    const vec3 shading = dot(in_normal, geometric) < 0.0 ? -in_normal : in_normal;
    out_normals = uvec2(pack_normal(shading), pack_normal(geometric));
    out_surface = draw.surface;
    out_emission = vec4(draw.emission.rgb, 1.0);
    out_gloss = unpackUnorm2x16(draw.gloss);
    out_albedo = pack_albedo(pattern_albedo(in_local, in_pattern), (draw.surface & surface_unlit) != 0u,
                             (draw.surface & surface_glossy) != 0u);
    out_motion = (in_previous.xy / in_previous.w - in_current.xy / in_current.w) * 0.5;
}
