#version 460
// Leaves out what is a hole.
layout(set = 0, binding = 2) uniform sampler2D colour_texture;
layout(location = 0) in vec2 in_place;
layout(location = 1) in vec2 in_alpha_least;

void main() {
    if (texture(colour_texture, in_place).a * in_alpha_least.x < in_alpha_least.y)
        discard;
}
