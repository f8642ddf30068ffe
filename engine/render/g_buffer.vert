#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_previous;
layout(location = 3) out vec4 out_current;
layout(location = 4) flat out uint out_row;

void main() {
    const uint row = gl_InstanceIndex;
    const vec4 world = rows[row].model * vec4(in_position, 1.0);
    out_position = world.xyz;
    out_normal = mat3(rows[row].normal_matrix) * in_normal;
    out_previous = camera.previous_view_projection * (rows[row].previous_model * vec4(in_position, 1.0));
    out_current = camera.view_projection * world;
    out_row = row;
    gl_Position = out_current;
}
