#version 450
// As VulkanSceneGraph hands over its geometry and matrices.
layout(push_constant) uniform Matrices {
    mat4 projection;
    mat4 model_view;
};
layout(location = 0) in vec3 vertex;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 texture_coordinates;
layout(location = 3) in vec4 colour;
layout(location = 0) out vec3 view_normal;

void main() {
    gl_Position = projection * model_view * vec4(vertex, 1.0);
    view_normal = mat3(model_view) * normal; // scales are uniform here
}
