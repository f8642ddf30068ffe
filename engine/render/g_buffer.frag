#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/core/octahedral.h"
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/pattern_shared.h"

// A pipeline for each: a CPU device runs both sides of every branch.
layout(constant_id = 0) const uint pattern_kind = pattern_none;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_previous;
layout(location = 3) in vec4 in_current;
layout(location = 4) flat in uint in_row;

layout(location = 0) out uvec2 out_normals; // x: shading normal, y: geometric normal (octahedral, 16 bits each)
layout(location = 1) out uint out_surface;  // row + 1, and what instance_shared.h marks
layout(location = 2) out vec4 out_albedo;
layout(location = 3) out vec2 out_motion;   // in units of the picture: where the point was, minus where it is
layout(location = 4) out vec4 out_emission; // radiance, W/(sr m2)

void main() {
    // Surfaces are two-sided: the geometric normal faces the camera, the shading normal is on its side.
    const vec3 to_camera = camera.position.xyz - in_position;
    vec3 geometric = normalize(cross(dFdx(in_position), dFdy(in_position)));
    if (dot(geometric, to_camera) < 0.0)
        geometric = -geometric;
    vec3 shading = normalize(in_normal);
    if (dot(shading, geometric) < 0.0)
        shading = -shading;
    out_normals = uvec2(pack_normal(shading), pack_normal(geometric));
    const vec4 emission = rows[in_row].emission;
    out_surface = (in_row + 1u) | (emission.w > 0.0 ? surface_area_light : 0u) |
                  (emission.r + emission.g + emission.b > 0.0 ? surface_emits : 0u) |
                  (rows[in_row].material.y != 0u ? surface_unlit : 0u);
    out_emission = vec4(emission.rgb, 1.0);
    vec3 albedo = rows[in_row].base_colour.rgb;
    if (pattern_kind != pattern_none) {
        const vec4 pattern = rows[in_row].pattern;
        const vec3 local = (rows[in_row].inverse_model * vec4(in_position, 1.0)).xyz;
        const vec3 local_normal = mat3(rows[in_row].inverse_model) * geometric;
        albedo = mix(albedo, pattern.rgb, pattern_share(pattern_kind, pattern.w, local, local_normal));
    }
    out_albedo = vec4(albedo, 1.0);
    out_motion = (in_previous.xy / in_previous.w - in_current.xy / in_current.w) * 0.5;
}
