#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/scene/camera_shared.h"
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"

layout(constant_id = 1) const uint with_motion = 0;

layout(set = 0, binding = 0) uniform Camera { CameraRow camera; };
layout(set = 0, binding = 1) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 2) readonly buffer Materials { MaterialRow materials[]; };

layout(push_constant) uniform Constants { DrawConstants draw; };

layout(location = 0) in vec3 in_position;
layout(location = 1) in vec3 in_normal;
layout(location = 2) in vec4 in_coordinates;
layout(location = 3) in vec4 in_tangent;
layout(location = 4) in vec4 in_colour;

layout(location = 0) out vec3 out_position;
layout(location = 1) out vec3 out_normal;
layout(location = 2) out vec4 out_previous;
layout(location = 3) out vec4 out_current;
layout(location = 5) out vec4 out_tangent;
layout(location = 6) out vec4 out_colour;
// Places on the textures. Found here, not for each pixel: beside a triangle's edge a device may not read buffers, and
// the derivatives there would be wrong.
layout(location = 7) out vec4 out_colour_normal_place;
layout(location = 8) out vec4 out_emission_gloss_place;

#include "engine/render/draw_vertex.glsl"

void main() {
    out_position = world_position(in_position);
    out_normal = world_normal(in_normal);
    gl_Position = camera.view_projection * vec4(out_position, 1.0);
    write_motion();
    const uint material = rows[surface_row(draw.surface)].material.x;
    out_colour_normal_place = vec4(texture_place(materials[material].base_colour, in_coordinates),
                                   texture_place(materials[material].normal, in_coordinates));
    out_emission_gloss_place = vec4(texture_place(materials[material].emission, in_coordinates),
                                    texture_place(materials[material].metallic_roughness, in_coordinates));
    out_tangent = vec4(dot(draw.model[0].xyz, in_tangent.xyz), dot(draw.model[1].xyz, in_tangent.xyz),
                       dot(draw.model[2].xyz, in_tangent.xyz), in_tangent.w);
    out_colour = in_colour;
}
