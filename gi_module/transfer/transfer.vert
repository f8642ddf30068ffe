#version 460
#extension GL_GOOGLE_include_directive : require
// A mover with irradiance per vertex (thesis sec. 4.4.1: the pixel shader only interpolates).
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "gi_module/transfer/transfer_shared.h"

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 2) readonly buffer Irradiance { vec4 irradiance[]; }; // by vertex of the mesh
layout(push_constant) uniform Constants { TransferConstants constants; };

layout(location = 0) in vec3 in_position;
layout(location = 0) out vec3 out_irradiance;

void main() {
    gl_Position = camera.view_projection * (rows[constants.row].model * vec4(in_position, 1.0));
    out_irradiance = irradiance[gl_VertexIndex - constants.first_vertex].rgb;
}
