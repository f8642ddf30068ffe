#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
// shadow_map.vert for surfaces with holes: their textures say where.
#include "engine/scene/instance_shared.h"
#include "engine/scene/material_shared.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_map_shared.h"

layout(set = 0, binding = 0) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 1) readonly buffer Materials { MaterialRow materials[]; };
layout(push_constant) uniform Constants { ShadowConstants constants; };

layout(location = 6) in vec4 in_coordinates;
layout(location = 7) in vec4 in_colour;

layout(location = 0) out vec2 out_place;
layout(location = 1) out vec2 out_alpha_least; // alpha of material and vertex; below the second is a hole

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[3];
};

#include "gi_module/shadows/shadow_projection.glsl"

void main() {
    const MaterialRow material = materials[rows[in_layer_face_row.y].material.x];
    out_place = texture_place(material.base_colour, in_coordinates);
    // What blends casts the shadow of what is at least half there.
    out_alpha_least =
        vec2(material.factors.x * in_colour.a, material.factors.y >= 0.0 ? material.factors.y : 0.5);
    project_on_map();
}
