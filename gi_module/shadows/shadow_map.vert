#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_ARB_shader_viewport_layer_array : require
// Draws occluders onto the faces of many shadow maps in one call: the instance says which map (a layer of the staging
// image), which face and which occluder. Thesis sec. 4.2.2, with instances in place of four passes a map.
#include "engine/scene/instance_shared.h"
#include "gi_module/shadows/octahedral_map.h"
#include "gi_module/shadows/shadow_map_shared.h"

layout(set = 0, binding = 0) readonly buffer Rows { InstanceRow rows[]; };
layout(set = 0, binding = 1) readonly buffer Jobs { ShadowJob jobs[]; };
layout(set = 0, binding = 2) readonly buffer Lights { LightRow lights[]; }; // by layer
layout(push_constant) uniform Constants { ShadowConstants constants; };

layout(location = 0) in vec3 in_position;

out gl_PerVertex {
    vec4 gl_Position;
    float gl_ClipDistance[3];
};

#include "gi_module/shadows/shadow_projection.glsl"

void main() {
    const ShadowJob job = jobs[gl_InstanceIndex];
    project_on_map(job, (rows[job.row].model * vec4(in_position, 1.0)).xyz);
}
