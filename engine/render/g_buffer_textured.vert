#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 2) readonly buffer Materials { MaterialRow materials[]; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_coordinates;
layout(location = 3) in vec4 in_tangent;
layout(location = 4) in vec4 in_colour;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_previous;
layout(location = 3) out vec4 out_current;
layout(location = 4) flat out uint out_row;
layout(location = 5) out vec4 out_tangent;
layout(location = 6) out vec4 out_colour;
// Places on the textures. Found here, not for each pixel: beside a triangle's edge a device may not read buffers, and
// the derivatives there would be wrong.
layout(location = 7) out vec4 out_colour_normal_place;
layout(location = 8) out vec2 out_emission_place;

void main() {
    const uint row = gl_InstanceIndex;
    const vec4 world = rows[row].model * vec4(in_position, 1.0);
    out_position = world.xyz;
    out_normal = mat3(rows[row].normal_matrix) * in_normal;
    out_previous = camera.previous_view_projection * (rows[row].previous_model * vec4(in_position, 1.0));
    out_current = camera.view_projection * world;
    out_row = row;
    const uint material = rows[row].material.x;
    out_colour_normal_place = vec4(texture_place(materials[material].base_colour, in_coordinates),
                                   texture_place(materials[material].normal, in_coordinates));
    out_emission_place = texture_place(materials[material].emission, in_coordinates);
    out_tangent = vec4(mat3(rows[row].model) * in_tangent.xyz, in_tangent.w);
    out_colour = in_colour;
    gl_Position = out_current;
}
