#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

layout(constant_id = 0) const uint pattern_kind = 0;
layout(constant_id = 1) const uint with_motion = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };
layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_previous;
layout(location = 3) out vec4 out_current;
layout(location = 4) out vec3 out_local; // this and the next: pattern_albedo.glsl
layout(location = 5) out flat vec4 out_pattern;

#include "engine/render/draw_vertex.glsl"

void main() {
    out_position = world_position(in_position);
    out_normal = world_normal(in_normal);
    gl_Position = camera.view_projection * vec4(out_position, 1.0);
    write_motion();
    out_local = pattern_kind != 0 ? in_position : vec3(0.0);
    out_pattern = pattern_kind != 0 ? rows[surface_row(draw.surface)].pattern : vec4(0.0);
}
