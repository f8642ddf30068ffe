#include "engine/scene/procedural.h"

#include <cmath>
#include <functional>

namespace sunfleck::scene {
namespace {

void add_quad(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
    for (const std::uint32_t index : {a, b, c, a, c, d})
        mesh.indices.push_back(index);
}

// A rectangle's four corners with one flat normal: origin, origin + u, origin + u + v, origin + v.
void add_face(Mesh& mesh, vec3 origin, vec3 u, vec3 v) {
    const std::uint32_t first = std::uint32_t(mesh.positions.size());
    const vec3 normal = glm::normalize(glm::cross(u, v));
    for (const vec3 corner : {origin, origin + u, origin + u + v, origin + v}) {
        mesh.positions.push_back(corner);
        mesh.normals.push_back(normal);
    }
    add_quad(mesh, first, first + 1, first + 2, first + 3);
}

// A closed tube along curve(t), t in [0, 1), with circular sections.
Mesh make_tube(const std::function<vec3(float)>& curve, float radius, int segments, int sides) {
    Mesh mesh;
    const float step = 1e-3f;
    for (int i = 0; i < segments; ++i) {
        const float t = float(i) / float(segments);
        const vec3 centre = curve(t);
        const vec3 tangent = glm::normalize(curve(t + step) - curve(t - step));
        // A frame that closes on itself: the side axis points away from the curve's centre.
        const vec3 side = glm::normalize(glm::cross(tangent, glm::normalize(centre + vec3(0.0f, 1e-4f, 0.0f))));
        const vec3 up = glm::cross(side, tangent);
        for (int j = 0; j < sides; ++j) {
            const float angle = 2.0f * pi * float(j) / float(sides);
            const vec3 normal = std::cos(angle) * side + std::sin(angle) * up;
            mesh.positions.push_back(centre + radius * normal);
            mesh.normals.push_back(normal);
        }
    }
    const auto vertex = [&](int i, int j) { return std::uint32_t((i % segments) * sides + (j % sides)); };
    for (int i = 0; i < segments; ++i)
        for (int j = 0; j < sides; ++j)
            add_quad(mesh, vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1), vertex(i + 1, j));
    return mesh;
}

float surface_area(const Mesh& mesh) {
    double area = 0;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const vec3 a = mesh.positions[mesh.indices[i]];
        area += 0.5 * double(glm::length(glm::cross(mesh.positions[mesh.indices[i + 1]] - a,
                                                    mesh.positions[mesh.indices[i + 2]] - a)));
    }
    return float(area);
}

void scale_to_area(Mesh& mesh, float area) {
    const float factor = std::sqrt(area / surface_area(mesh));
    for (vec3& position : mesh.positions)
        position *= factor;
}

// Flips triangles whose winding disagrees with their normals.
void orient(Mesh& mesh) {
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
        const vec3 face = glm::cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
        if (glm::dot(face, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) < 0.0f)
            std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    }
}

} // namespace

Mesh make_rectangle(float width, float height, int columns, int rows) {
    Mesh mesh;
    mesh.name = "rectangle";
    for (int y = 0; y <= rows; ++y)
        for (int x = 0; x <= columns; ++x) {
            mesh.positions.emplace_back(width * (float(x) / float(columns) - 0.5f),
                                        height * (float(y) / float(rows) - 0.5f), 0.0f);
            mesh.normals.emplace_back(0.0f, 0.0f, 1.0f);
        }
    const auto vertex = [&](int x, int y) { return std::uint32_t(y * (columns + 1) + x); };
    for (int y = 0; y < rows; ++y)
        for (int x = 0; x < columns; ++x)
            add_quad(mesh, vertex(x, y), vertex(x + 1, y), vertex(x + 1, y + 1), vertex(x, y + 1));
    return mesh;
}

Mesh make_box(vec3 size) {
    Mesh mesh;
    mesh.name = "box";
    const vec3 h = 0.5f * size;
    const vec3 x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
    add_face(mesh, vec3(-h.x, -h.y, h.z), x, y);
    add_face(mesh, vec3(h.x, -h.y, -h.z), -x, y);
    add_face(mesh, vec3(h.x, -h.y, h.z), -z, y);
    add_face(mesh, vec3(-h.x, -h.y, -h.z), z, y);
    add_face(mesh, vec3(-h.x, h.y, h.z), x, -z);
    add_face(mesh, vec3(-h.x, -h.y, -h.z), x, z);
    return mesh;
}

Mesh make_room(vec3 size) {
    Mesh mesh = make_box(size);
    mesh.name = "room";
    for (vec3& normal : mesh.normals)
        normal = -normal;
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
        std::swap(mesh.indices[i + 1], mesh.indices[i + 2]);
    return mesh;
}

Mesh make_disc(float radius, int segments) {
    Mesh mesh;
    mesh.name = "disc";
    mesh.positions.emplace_back(0.0f);
    for (int i = 0; i < segments; ++i) {
        const float angle = 2.0f * pi * float(i) / float(segments);
        mesh.positions.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0f);
        mesh.indices.insert(mesh.indices.end(), {0u, std::uint32_t(i + 1), std::uint32_t((i + 1) % segments + 1)});
    }
    mesh.normals.assign(mesh.positions.size(), vec3(0, 0, 1));
    scale_to_area(mesh, pi * radius * radius);
    return mesh;
}

Mesh make_sphere(float radius, int segments, int rings) {
    Mesh mesh;
    mesh.name = "sphere";
    for (int ring = 0; ring <= rings; ++ring)
        for (int segment = 0; segment < segments; ++segment) {
            const float theta = pi * float(ring) / float(rings);
            const float phi = 2.0f * pi * float(segment) / float(segments);
            mesh.normals.emplace_back(std::sin(theta) * std::cos(phi), std::cos(theta),
                                      std::sin(theta) * std::sin(phi));
            mesh.positions.push_back(radius * mesh.normals.back());
        }
    const auto vertex = [&](int ring, int segment) { return std::uint32_t(ring * segments + segment % segments); };
    for (int ring = 0; ring < rings; ++ring)
        for (int segment = 0; segment < segments; ++segment) {
            if (ring > 0)
                mesh.indices.insert(mesh.indices.end(),
                                    {vertex(ring, segment), vertex(ring, segment + 1), vertex(ring + 1, segment)});
            if (ring < rings - 1)
                mesh.indices.insert(mesh.indices.end(), {vertex(ring, segment + 1), vertex(ring + 1, segment + 1),
                                                         vertex(ring + 1, segment)});
        }
    orient(mesh);
    scale_to_area(mesh, 4.0f * pi * radius * radius);
    return mesh;
}

Mesh make_cylinder(float radius, float height, int segments) {
    Mesh mesh;
    mesh.name = "cylinder";
    for (int i = 0; i < segments; ++i) {
        const float angle = 2.0f * pi * float(i) / float(segments);
        const vec3 normal(std::cos(angle), 0.0f, std::sin(angle));
        for (const float y : {-0.5f * height, 0.5f * height}) {
            mesh.positions.push_back(radius * normal + vec3(0.0f, y, 0.0f));
            mesh.normals.push_back(normal);
        }
    }
    for (int i = 0; i < segments; ++i) {
        const std::uint32_t a = std::uint32_t(i * 2), b = std::uint32_t((i + 1) % segments * 2);
        add_quad(mesh, a, a + 1, b + 1, b);
    }
    for (const float side : {-1.0f, 1.0f}) {
        const std::uint32_t centre = std::uint32_t(mesh.positions.size());
        mesh.positions.emplace_back(0.0f, side * 0.5f * height, 0.0f);
        mesh.normals.emplace_back(0.0f, side, 0.0f);
        for (int i = 0; i < segments; ++i) {
            const float angle = 2.0f * pi * float(i) / float(segments);
            mesh.positions.emplace_back(radius * std::cos(angle), side * 0.5f * height, radius * std::sin(angle));
            mesh.normals.emplace_back(0.0f, side, 0.0f);
            mesh.indices.insert(mesh.indices.end(), {centre, centre + 1 + std::uint32_t(i),
                                                     centre + 1 + std::uint32_t((i + 1) % segments)});
        }
    }
    orient(mesh);
    return mesh;
}

Mesh make_torus(float ring_radius, float tube_radius, int segments, int sides) {
    Mesh mesh =
        make_tube([=](float t) { return ring_radius * vec3(std::cos(2.0f * pi * t), 0.0f, std::sin(2.0f * pi * t)); },
                  tube_radius, segments, sides);
    mesh.name = "torus";
    orient(mesh);
    return mesh;
}

Mesh make_knot(float size, int segments, int sides) {
    const float scale = size / 3.6f; // the trefoil below reaches 3 from its axis, and its tube 0.6 more
    Mesh mesh = make_tube(
        [=](float t) {
            const float angle = 2.0f * pi * t;
            return 0.5f * scale *
                   vec3(std::sin(angle) + 2.0f * std::sin(2.0f * angle), -1.3f * std::sin(3.0f * angle),
                        std::cos(angle) - 2.0f * std::cos(2.0f * angle));
        },
        0.26f * scale, segments, sides);
    mesh.name = "knot";
    orient(mesh);
    compute_normals(mesh);
    return mesh;
}

Mesh make_area_light_mesh(const AreaLight& light) {
    switch (light.shape) {
    case AreaShape::rectangle:
        return make_rectangle(light.width, light.height);
    case AreaShape::disc:
        return make_disc(light.radius);
    case AreaShape::sphere:
        return make_sphere(light.radius);
    }
    return {};
}

void compute_normals(Mesh& mesh) {
    mesh.normals.assign(mesh.positions.size(), vec3(0.0f));
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const std::uint32_t* t = &mesh.indices[i];
        const vec3 weighted =
            glm::cross(mesh.positions[t[1]] - mesh.positions[t[0]], mesh.positions[t[2]] - mesh.positions[t[0]]);
        for (int corner = 0; corner < 3; ++corner)
            mesh.normals[t[corner]] += weighted;
    }
    for (vec3& normal : mesh.normals) {
        const float length = glm::length(normal);
        normal = length > 0.0f ? normal / length : vec3(0.0f, 1.0f, 0.0f);
    }
}

} // namespace sunfleck::scene
