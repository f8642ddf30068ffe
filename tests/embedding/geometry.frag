#version 460
#extension GL_GOOGLE_include_directive : require
#include "engine/core/octahedral.h"
layout(push_constant) uniform Constants { mat4 view_projection; vec4 place_scale; uint surface; } constants;
layout(location = 0) in vec3 in_position;
layout(location = 0) out uvec2 out_normals;
layout(location = 1) out uint out_surface;

void main() {
    // Flat surfaces: both normals are that of the triangle. y runs down on the screen, so this one faces the camera.
    const vec3 normal = normalize(cross(dFdx(in_position), dFdy(in_position)));
    out_normals = uvec2(pack_normal(-normal));
    out_surface = constants.surface;
}
