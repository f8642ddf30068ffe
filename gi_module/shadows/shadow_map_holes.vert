#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
// shadow_map.vert for alpha-masked surfaces, whose textures have holes.
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_map_shared.h"

layout(set = 0, binding = 0) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 1) readonly buffer Materials { MaterialRow materials[]; };

layout(location = 7) in vec4 in_coordinates;
layout(location = 8) in vec4 in_colour;

layout(location = 0) out vec2 out_uv;
layout(location = 1) out vec2 out_alpha_cutoff; // x: alpha of material and vertex; y: cutoff, below which is a hole

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[3];
};

#include "gi_module/shadows/shadow_projection.glsl"

void main() {
    const MaterialRow material = materials[rows[in_layer_face_row.y].material.x];
    out_uv = texture_place(material.base_colour, in_coordinates);
    // Alpha-blended surfaces cast shadows where they are at least half opaque.
    out_alpha_cutoff =
        vec2(material.factors.x * in_colour.a, material.factors.y >= 0.0 ? material.factors.y : 0.5);
    project_on_map();
}
