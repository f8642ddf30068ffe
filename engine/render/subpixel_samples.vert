#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"
// What no pixel of the picture shows is moved out of the view.

layout(constant_id = 0) const uint has_holes = 0;
layout(constant_id = 1) const uint pattern_kind = 0;
layout(constant_id = 2) const uint is_textured = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Shown { uint shown[]; }; // by row
layout(set = 0, binding = 2) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 3) readonly buffer Materials { MaterialRow materials[]; };
layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec4 in_coordinates;
layout(location = 2) in vec4 in_colour;

layout(location = 0) out vec2 out_place; // on the colour's texture
layout(location = 1) out vec4 out_colour;
layout(location = 2) out vec3 out_local; // this and the next: pattern_albedo.glsl
layout(location = 3) out flat vec4 out_pattern;

#include "engine/render/draw_position.glsl"

void main() {
    const uint row = surface_row(draw.surface);
    gl_Position = shown[row] != 0u ? camera.view_projection * vec4(world_position(in_position), 1.0) : vec4(2.0, 2.0, 0.5, 1.0);
    out_local = pattern_kind != 0 ? in_position : vec3(0.0);
    out_pattern = pattern_kind != 0 ? rows[row].pattern : vec4(0.0);
    out_place = vec2(0.0);
    out_colour = vec4(1.0);
    if (has_holes != 0 || is_textured != 0) {
        out_place = texture_place(materials[rows[row].material.x].base_colour, in_coordinates);
        out_colour = in_colour;
    }
}
