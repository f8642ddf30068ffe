#include "gi_module/visibility/planar_faces.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <unordered_map>

namespace sunfleck::gi {
namespace {

constexpr double cosine_limit = 0.999999; // 0.08 degrees
constexpr std::size_t longest_outline = 16;

// For each vertex the first one at the same place.
std::vector<std::uint32_t> weld(const std::vector<vec3>& positions) {
    struct Less {
        bool operator()(const vec3& a, const vec3& b) const {
            return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
        }
    };
    std::map<vec3, std::uint32_t, Less> first;
    std::vector<std::uint32_t> result;
    for (std::uint32_t i = 0; i < positions.size(); ++i)
        result.push_back(first.emplace(positions[i], i).first->second);
    return result;
}

class Sets {
public:
    explicit Sets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0u); }
    std::uint32_t find(std::uint32_t i) {
        while (parent_[i] != i)
            i = parent_[i] = parent_[parent_[i]];
        return i;
    }
    // The lower number leads, so that the result does not depend on the order of joining.
    void join(std::uint32_t a, std::uint32_t b) {
        a = find(a);
        b = find(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::uint32_t> parent_;
};

struct Flat {
    double u, v;
    dvec3 point;
};

double turn(const Flat& a, const Flat& b, const Flat& c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

// Andrew's monotone chain, counter-clockwise.
Polygon hull_of(std::vector<Flat> points) {
    std::sort(points.begin(), points.end(),
              [](const Flat& a, const Flat& b) { return a.u != b.u ? a.u < b.u : a.v < b.v; });
    std::vector<Flat> hull;
    for (int side = 0; side < 2; ++side) {
        const std::size_t start = hull.size();
        for (const Flat& point : points) {
            while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), point) <= 1e-12)
                hull.pop_back();
            hull.push_back(point);
        }
        hull.pop_back();
        std::reverse(points.begin(), points.end());
    }
    Polygon polygon;
    for (const Flat& point : hull)
        polygon.push_back(point.point);
    return polygon;
}

} // namespace

FlatMesh find_planar_faces(const scene::Mesh& mesh, const mat4& matrix) {
    FlatMesh flat;
    flat.indices = mesh.indices;
    for (const vec3& position : mesh.positions)
        flat.positions.push_back(dvec3(vec3(matrix * vec4(position, 1.0f))));
    const std::vector<std::uint32_t> welded = weld(mesh.positions);
    const std::uint32_t count = std::uint32_t(mesh.triangle_count());
    const bool mirrored = glm::determinant(mat3(matrix)) < 0.0f;
    std::vector<dvec3> normals(count);
    std::vector<double> areas(count);
    struct Edge {
        std::uint32_t triangle;
        bool forward;
    };
    std::unordered_map<std::uint64_t, std::vector<Edge>> edges;
    for (std::uint32_t t = 0; t < count; ++t) {
        const dvec3 cross = glm::cross(flat.corner(t, 1) - flat.corner(t, 0), flat.corner(t, 2) - flat.corner(t, 0));
        const double length = glm::length(cross);
        areas[t] = 0.5 * length;
        if (!(length > 1e-16))
            continue;
        normals[t] = (mirrored ? -cross : cross) / length;
        for (int k = 0; k < 3; ++k) {
            const std::uint32_t a = welded[mesh.indices[t * 3 + std::uint32_t(k)]];
            const std::uint32_t b = welded[mesh.indices[t * 3 + std::uint32_t((k + 1) % 3)]];
            edges[(std::uint64_t(std::min(a, b)) << 32) | std::max(a, b)].push_back({t, a < b});
        }
    }
    Sets sets(count);
    flat.closed = !edges.empty();
    for (const auto& [key, users] : edges) {
        flat.closed = flat.closed && users.size() == 2 && users[0].forward != users[1].forward;
        for (std::size_t i = 1; i < users.size(); ++i)
            if (glm::dot(normals[users[0].triangle], normals[users[i].triangle]) > cosine_limit)
                sets.join(users[0].triangle, users[i].triangle);
    }
    std::vector<std::uint32_t> face_of(count, 0xffffffffu);
    for (std::uint32_t t = 0; t < count; ++t) {
        if (!(areas[t] > 1e-16))
            continue;
        std::uint32_t& face = face_of[sets.find(t)];
        if (face == 0xffffffffu) {
            face = std::uint32_t(flat.faces.size());
            flat.faces.push_back({normals[t], {}, 0.0});
        }
        flat.faces[face].triangles.push_back(t);
        flat.faces[face].area += areas[t];
        flat.area += areas[t];
    }
    return flat;
}

std::vector<Polygon> convex_pieces(const FlatMesh& mesh, const PlanarFace& face) {
    vec3 tangent, bitangent;
    orthonormal_basis(vec3(face.normal), tangent, bitangent);
    std::vector<Flat> points;
    std::vector<Polygon> triangles;
    for (const std::uint32_t t : face.triangles) {
        Polygon triangle;
        for (int k = 0; k < 3; ++k) {
            const dvec3 p = mesh.corner(t, k);
            triangle.push_back(p);
            points.push_back({glm::dot(p, dvec3(tangent)), glm::dot(p, dvec3(bitangent)), p});
        }
        if (glm::dot(area_vector(triangle), face.normal) < 0.0)
            std::swap(triangle[1], triangle[2]);
        triangles.push_back(std::move(triangle));
    }
    Polygon outline = hull_of(std::move(points));
    const bool convex = outline.size() >= 3 && outline.size() <= longest_outline &&
                        0.5 * glm::length(area_vector(outline)) <= face.area * (1.0 + 1e-6);
    if (!convex)
        return triangles;
    if (glm::dot(area_vector(outline), face.normal) < 0.0)
        std::reverse(outline.begin(), outline.end());
    return {outline};
}

} // namespace sunfleck::gi
