#version 460
// Alpha test: discards fragments in holes.
layout(set = 0, binding = 2) uniform sampler2D colour_texture;
layout(location = 0) in vec2 in_uv;
layout(location = 1) in vec2 in_alpha_cutoff;

void main() {
    if (texture(colour_texture, in_uv).a * in_alpha_cutoff.x < in_alpha_cutoff.y)
        discard;
}
