#version 460
// The same for a G-buffer of another shape: the world-space normal as three numbers.
layout(push_constant) uniform Constants { mat4 view_projection; vec4 place_scale; uint surface; } constants;
layout(constant_id = 0) const bool unsigned_format = false;
layout(location = 0) in vec3 in_position;
layout(location = 0) out vec4 out_normal;
layout(location = 1) out uint out_surface;

void main() {
    const vec3 normal = -normalize(cross(dFdx(in_position), dFdy(in_position)));
    out_normal = vec4(unsigned_format ? 0.5 * normal + 0.5 : normal, 0.0);
    out_surface = constants.surface;
}
