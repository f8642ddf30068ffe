#include "gi_module/visibility/planar_faces.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace sunfleck::gi {
namespace {

constexpr double cosine_limit = 0.999999; // 0.08 degrees
constexpr std::size_t longest_outline = 16;

// For each vertex the first one at the same place.
std::vector<std::uint32_t> weld(const std::vector<vec3>& positions) {
    std::vector<std::uint32_t> order(positions.size()), result(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t i, std::uint32_t k) {
        const vec3 &a = positions[i], &b = positions[k];
        return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z != b.z ? a.z < b.z : i < k;
    });
    std::uint32_t first = 0;
    for (const std::uint32_t i : order) {
        if (positions[i] != positions[first] || i == order.front())
            first = i;
        result[i] = first;
    }
    return result;
}

// A triangle at an edge, whose vertices' numbers are the key.
struct EdgeUse {
    std::uint64_t key;
    std::uint32_t triangle;
    bool forward;
    bool operator<(const EdgeUse& other) const {
        return key != other.key ? key < other.key : triangle < other.triangle;
    }
};

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

constexpr std::uint32_t nowhere = 0xffffffffu;

// `face_of`: each triangle's face, or nowhere. The faces know how many triangles they have.
void sort_by_face(FlatMesh& flat, std::span<const std::uint32_t> face_of) {
    std::uint32_t sum = 0;
    for (PlanarFace& face : flat.faces) {
        face.first = sum;
        sum += std::exchange(face.count, 0);
    }
    flat.by_face.resize(sum);
    for (std::uint32_t t = 0; t < face_of.size(); ++t)
        if (face_of[t] != nowhere) {
            PlanarFace& face = flat.faces[face_of[t]];
            flat.by_face[face.first + face.count++] = t;
        }
}

} // namespace

FlatMesh find_planar_faces(const scene::Mesh& mesh, const mat4& matrix) {
    FlatMesh flat;
    flat.indices = mesh.indices;
    flat.positions.reserve(mesh.positions.size());
    for (const vec3& position : mesh.positions)
        flat.positions.push_back(dvec3(vec3(matrix * vec4(position, 1.0f))));
    const std::vector<std::uint32_t> welded = weld(mesh.positions);
    const std::uint32_t count = std::uint32_t(mesh.triangle_count());
    const bool mirrored = glm::determinant(mat3(matrix)) < 0.0f;
    std::vector<dvec3> normals(count);
    std::vector<double> areas(count);
    std::vector<EdgeUse> edges;
    edges.reserve(std::size_t(count) * 3);
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
            edges.push_back({(std::uint64_t(std::min(a, b)) << 32) | std::max(a, b), t, a < b});
        }
    }
    Sets sets(count);
    flat.closed = !edges.empty();
    std::sort(edges.begin(), edges.end());
    for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
        for (end = first + 1; end < edges.size() && edges[end].key == edges[first].key; ++end)
            if (glm::dot(normals[edges[first].triangle], normals[edges[end].triangle]) > cosine_limit)
                sets.join(edges[first].triangle, edges[end].triangle);
        flat.closed = flat.closed && end == first + 2 && edges[first].forward != edges[first + 1].forward;
    }
    std::vector<std::uint32_t> face_of(count, nowhere), face_of_set(count, nowhere);
    for (std::uint32_t t = 0; t < count; ++t) {
        if (!(areas[t] > 1e-16))
            continue;
        std::uint32_t& face = face_of_set[sets.find(t)];
        if (face == nowhere) {
            face = std::uint32_t(flat.faces.size());
            flat.faces.push_back({normals[t]});
        }
        face_of[t] = face;
        ++flat.faces[face].count;
        flat.faces[face].area += areas[t];
        flat.area += areas[t];
    }
    sort_by_face(flat, face_of);
    return flat;
}

std::vector<Polygon> convex_pieces(const FlatMesh& mesh, const PlanarFace& face) {
    vec3 tangent, bitangent;
    orthonormal_basis(vec3(face.normal), tangent, bitangent);
    std::vector<Flat> points;
    std::vector<Polygon> triangles;
    for (const std::uint32_t t : mesh.triangles(face)) {
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
