#version 460
// Vertices of Dear ImGui as five words each: position (pixels), texture coordinate, colour.
layout(set = 0, binding = 0) readonly buffer Vertices { uint words[]; };
layout(set = 0, binding = 1) readonly buffer Indices { uint indices[]; };
layout(push_constant) uniform Constants {
    vec2 scale; // pixels to -1..1
    vec2 white; // texture coordinate of a fully opaque texel
    uvec2 atlas; // texels
    uint first_index, first_vertex;
} constants;

layout(location = 0) out vec4 out_colour;
layout(location = 1) out vec2 out_coordinate;

void main() {
    const uint first = (indices[constants.first_index + gl_VertexIndex] + constants.first_vertex) * 5u;
    const vec2 position = vec2(uintBitsToFloat(words[first]), uintBitsToFloat(words[first + 1u]));
    out_coordinate = vec2(uintBitsToFloat(words[first + 2u]), uintBitsToFloat(words[first + 3u]));
    out_colour = unpackUnorm4x8(words[first + 4u]);
    gl_Position = vec4(position * constants.scale - 1.0, 0.0, 1.0);
}
