#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
// Draws occluders onto the faces of many shadow maps in one call.
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_map_shared.h"

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[3];
};

#include "gi_module/shadows/shadow_projection.glsl"

void main() { project_on_map(); }
