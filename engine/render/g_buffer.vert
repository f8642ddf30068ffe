#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

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

#include "engine/render/draw_vertex.glsl"

void main() {
    out_position = world_position(in_position);
    out_normal = world_normal(in_normal);
    gl_Position = camera.view_projection * vec4(out_position, 1.0);
    write_motion();
}
