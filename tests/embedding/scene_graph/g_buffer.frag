#version 450
layout(set = 0, binding = 0) uniform Material {
    vec4 diffuse;
    uvec4 surface;
    mat3 view_to_world;
};
layout(location = 0) in vec3 view_normal;
layout(location = 0) out vec4 normal;
layout(location = 1) out uint surface_id;
layout(location = 2) out vec4 albedo;

void main() {
    normal = vec4(normalize(view_to_world * view_normal), 0.0);
    surface_id = surface.x;
    albedo = vec4(diffuse.rgb, 1.0);
}
