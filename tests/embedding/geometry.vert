#version 460
// The foreign program's geometry pass.
layout(push_constant) uniform Constants { mat4 view_projection; vec4 place_scale; uint surface; } constants;
layout(location = 0) in vec3 in_position;
layout(location = 0) out vec3 out_position;

void main() {
    out_position = in_position * constants.place_scale.w + constants.place_scale.xyz;
    gl_Position = constants.view_projection * vec4(out_position, 1.0);
}
