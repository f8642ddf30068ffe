#include "assets/mesh_parts.h"

#include <cmath>

namespace sunfleck::assets {

void append(scene::Mesh& whole, const scene::Mesh& part, const mat4& transform) {
    const std::uint32_t first = std::uint32_t(whole.positions.size());
    const mat3 normals = normal_matrix(transform);
    for (const vec3 position : part.positions)
        whole.positions.push_back(vec3(transform * vec4(position, 1.0f)));
    for (const vec3 normal : part.normals)
        whole.normals.push_back(glm::normalize(normals * normal));
    for (const std::uint32_t index : part.indices)
        whole.indices.push_back(first + index);
}

void append_box(scene::Mesh& whole, vec3 lowest, vec3 highest) {
    append(whole, scene::make_box(highest - lowest), glm::translate(mat4(1.0f), 0.5f * (lowest + highest)));
}

namespace {

// A flat quad with its own vertices; corners are counter-clockwise seen from the front.
void append_quad(scene::Mesh& whole, vec3 a, vec3 b, vec3 c, vec3 d) {
    const std::uint32_t first = std::uint32_t(whole.positions.size());
    const vec3 across = glm::cross(c - a, d - b);
    const float length = glm::length(across);
    const vec3 normal = length > 0.0f ? across / length : vec3(0.0f, 1.0f, 0.0f);
    whole.positions.insert(whole.positions.end(), {a, b, c, d});
    whole.normals.insert(whole.normals.end(), 4, normal);
    for (const std::uint32_t k : {0u, 1u, 2u, 0u, 2u, 3u})
        whole.indices.push_back(first + k);
}

} // namespace

scene::Mesh make_arch(float width, float height, float depth, float opening, float springing, int segments) {
    scene::Mesh mesh;
    const float radius = 0.5f * opening, middle = 0.5f * width, side = middle - radius;
    append_box(mesh, vec3(0.0f), vec3(side, springing, depth));
    append_box(mesh, vec3(width - side, 0.0f, 0.0f), vec3(width, springing, depth));
    // Above: strips from the arch to the top, front and back, and the underside of the arch.
    const auto on_curve = [&](int i) {
        const float angle = pi * (1.0f - float(i) / float(segments));
        return vec2(middle + radius * std::cos(angle), springing + radius * std::sin(angle));
    };
    for (int i = 0; i < segments; ++i) {
        const vec2 a = on_curve(i), b = on_curve(i + 1);
        append_quad(mesh, vec3(a, depth), vec3(b, depth), vec3(b.x, height, depth), vec3(a.x, height, depth));
        append_quad(mesh, vec3(b, 0.0f), vec3(a, 0.0f), vec3(a.x, height, 0.0f), vec3(b.x, height, 0.0f));
        append_quad(mesh, vec3(a, 0.0f), vec3(b, 0.0f), vec3(b, depth), vec3(a, depth));
    }
    for (const float x : {0.0f, width - side})
        append_box(mesh, vec3(x, springing, 0.0f), vec3(x + side, height, depth));
    append_quad(mesh, vec3(side, height, depth), vec3(width - side, height, depth), vec3(width - side, height, 0.0f),
                vec3(side, height, 0.0f));
    return mesh;
}

scene::Mesh make_figure(float height, int segments) {
    scene::Mesh mesh;
    const auto at = [&](float x, float y, float z, float tilt = 0.0f) {
        return glm::rotate(glm::scale(mat4(1.0f), vec3(height)) * glm::translate(mat4(1.0f), vec3(x, y, z)), tilt,
                           vec3(0.0f, 0.0f, 1.0f));
    };
    append(mesh, scene::make_sphere(0.075f, segments, segments / 2), at(0.0f, 0.925f, 0.0f));
    append(mesh, scene::make_cylinder(0.10f, 0.34f, segments), at(0.0f, 0.66f, 0.0f));
    append(mesh, scene::make_sphere(0.105f, segments, segments / 2), at(0.0f, 0.83f, 0.0f));
    for (const float side : {-1.0f, 1.0f}) {
        append(mesh, scene::make_cylinder(0.045f, 0.5f, segments), at(0.06f * side, 0.25f, 0.0f));
        append(mesh, scene::make_cylinder(0.03f, 0.36f, segments), at(0.19f * side, 0.68f, 0.0f, 0.45f * side));
        append(mesh, scene::make_sphere(0.045f, segments, segments / 2), at(0.27f * side, 0.52f, 0.0f));
    }
    return mesh;
}

} // namespace sunfleck::assets
